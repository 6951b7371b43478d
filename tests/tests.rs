//! The integration tests, one binary: each module says what it holds. A new test goes into the module of the thing that
//! a user would see break; helpers that two modules need go into `common`.

/// What a file must say so that every program plays it alike: keys apart, floats, two keys a channel, what other clips move.
mod alike;
/// Row order of `src/lib.rs`, names in their places, shape of files.
mod architecture;
/// The articulated body: standing, shoved, helped, repeated.
mod articulated;
/// The audit on baked and captured clips, with faults planted and without.
mod audit;
/// `surefoot audit` at the shell: text, JSON, table, page, waivers, many files.
mod audit_cli;
/// Faults planted into captures; the benches use it too.
mod audit_faults;
/// The audit against measured forces.
mod audit_forces;
/// Faults by kind and clip, for the test and the bench.
mod audit_grid;
/// Base clips: stands and walks that a reaction starts from and returns to.
mod base;
/// Base clips that stand, by the articulated body.
mod base_body;
mod base_lanes;
/// `surefoot batch`: as `bake` makes each, whatever the jobs, chunks, kills; failures, merged files, bad sweeps.
mod batch;
/// Baked shoves beside the hand-keyed hits of the same rig; draws them where it is told to.
mod beside;
/// Height, masses and soles of real rigs and of the built-in one.
mod bodies;
/// The program at the shell: exit codes, words, files.
mod cli;
/// The program about itself: help, topics, completions, manual pages, schemas, what follows the demo.
mod cli_help;
/// Stands and walks on ground that is not level: what the feet hold, and props.
mod clip_ground;
mod common;
/// Corrections: planted faults that go, frames and files that stay.
mod correct;
/// Corrected curves, for other programs to play.
mod correct_played;
/// What a corrected clip that was baked here tells of itself.
mod correct_told;
/// Where third-party rigs and clips are, and which tests want them.
mod data;
/// Every command, link and example of README, of the other pages and of the topics.
mod documents;
/// The folder that their commands run in.
mod documents_folder;
/// What in a document is a command.
mod documents_lines;
/// What stands beside a clip for an engine: written whole, run where it can be.
mod engines;
/// Baked files: the source kept whole, read again, by the Khronos validator, three.js.
mod export;
/// The same for rigs that nobody here made: slip, keys, the Khronos validator.
mod export_real;
/// FBX rigs that are read, and what is baked onto them.
mod fbx_in;
/// FBX files that are written, read back by ufbx.
mod fbx_out;
/// FBX files as text.
mod fbx_text;
/// The run that the library's documentation shows.
mod first_run;
/// The kinds of file at the shell: skeleton and clip alone, no contact nodes, who carries the travel.
mod forms;
/// What the `gltf` crate refuses, loses or panics on, and is read here.
mod gltf_crate;
/// The controller on slopes, stairs, gaps, rolling ground and a turning platform.
mod ground;
/// Files that are broken, malicious or of another kind.
mod hostile;
/// How few keys a clip needs, its bytes, and readers that drop tangents.
mod keys;
/// Balls, boxes, and how long a recovery takes.
mod lanes;
/// Any lane on any ground by the articulated body, drawn together.
mod led_anywhere;
/// The articulated body crouched: walks, and crouches in the midst of other lanes.
mod led_crouch;
/// The articulated body walking, turning and on one foot on slopes, gaps and uneven ground, shoved.
mod led_ends;
mod led_ground;
/// Turns on the spot by both drives, and deep crouches.
mod led_lanes;
/// The articulated body in shoes: toe joints at half the foot's length, and feet that are long for their legs.
mod led_shod;
/// The articulated body walking over kerbs and on stairs.
mod led_stairs;
/// The articulated body walking on level ground: steps alike, and shoves of the paper's range.
mod led_walks;
/// Legs of any length.
mod legs;
/// Slip, sole, joints, ZMP and the rest of the limits, on shoves of every rig.
mod limits;
/// Rigs x directions x impulses, and the table of what came out; `benches/limits.rs` prints it.
mod limits_grid;
/// Loops: seams, travel, names, what has no cycle.
mod looped;
/// What the measures say of a walk over force plates.
mod measure;
/// Grounds of triangles: kerbs, ramps, steps, ledges, walls.
mod mesh_drawn;
mod mesh_ground;
/// Their files: broken ones, where they are found, how fast they answer.
mod mesh_led;
mod mesh_level;
/// The articulated body in the mirror: a scenario and its mirror image.
mod mirrored;
/// Clips of every kind: sizes, ways, feet, writing back.
mod mocap;
/// Clips made by hand, broken and malicious ones.
mod mocap_files;
/// Bodies that are none, and numbers far from a person's, with the articulated body at the shell.
mod odd_bodies;
/// Bodies of tests that draw them.
mod people;
/// Contact sheets of real rigs.
mod picture;
/// Clips of the articulated body are its runs: joints, outcome, footfalls.
mod played;
/// Walks as fast as people walk, and faster.
mod quick_walks;
/// The articulated body: falls, balls, grounds, breakdowns.
mod ragdoll;
/// The articulated body walking.
mod ragdoll_walk;
/// Joints within their ranges on steep ground and in crouches, the kinematic drive's.
mod ranges;
/// What trunk, head and arms do of a push: delays, where it struck, mirror images, seeds, breath.
mod reaction;
/// What the articulated body recovers from without looking ahead: held-out shoves, each of another person.
mod recoveries;
/// Clips on other bodies: directions, held feet, knees.
mod retarget;
/// `surefoot retarget` at the shell: files, words, what it refuses.
mod retarget_cli;
/// Clips x bodies and what came out, for the test and the bench.
mod retarget_grid;
/// Soles of a mesh whose weights are wrong on one side.
mod rig_soles;
/// Rigs made from others or from nothing: scales, axes, skins, naming conventions, lacking bones, overrides.
mod rig_variants;
/// Real rigs: bones, height, heading, unit.
mod rigs;
/// The schemas of clips and audits: the keys that are written, and no others.
mod schemas;
/// The paper's seven cases by both drives, and step lengths on slopes.
mod seven;
/// Their scenarios and what is measured; `benches/seven_cases.rs` prints and draws all.
mod seven_grid;
/// The program at a shell of the test's own.
mod shell;
/// Soles in plan: apart and uncrossed.
mod soles;
/// On one foot, and crouched.
mod stances;
/// The controller: standing, recovering, stepping.
mod stepper;
/// The studio: driven without a window, by label.
#[cfg(feature = "studio")]
mod studio;
/// The studio's audit desk: flags, jumps, decisions, what is saved; its pictures.
#[cfg(feature = "studio")]
mod studio_audit;
/// The studio's batch view: a grid by label, bytes as `surefoot batch`, bad values, cancelling, pictures.
#[cfg(feature = "studio")]
mod studio_batch;
/// The studio's plots: seeking, choosing, pictures.
#[cfg(feature = "studio")]
mod studio_plots;
/// Pictures of the studio without a window.
#[cfg(feature = "studio")]
mod studio_seen;
/// The studio's viewport: pictures without a window, pushes by hand, costs.
#[cfg(feature = "studio")]
mod studio_viewport;
/// The studio's other views in its own window.
#[cfg(feature = "studio")]
mod studio_views;
/// Rigs and motions made by hand for the modules above.
mod synthetic;
/// The paper's variants of the stepper, by the keys of a scenario.
mod variants;
/// VRM animations: the specification, the same pose, read back.
mod vrma;
/// The same on characters, for three-vrm.
mod vrma_play;
/// The scenarios of walks.
mod walk_grid;
/// Walking: speeds, the paper's cases, pushes, turns, sizes.
mod walking;
/// Walks as clips, on rigs of several builds.
mod walks;

//! Surefoot: reactive stepping and balance, baked into glTF animation clips.
//!
//! START HERE. A file imports only from rows above its own in this table (`tests/architecture.rs` checks it):
//!
//! | row | folders | knows |
//! |---|---|---|
//! | 0 | [`maths`] | glam only: pendulum formulae, springs, curves, filters, hulls, two-bone IK |
//! | 1 | [`model`], [`dynamics`] | plain data: humanoid roles, body, pose, clip, contacts, scenario, report; how a tree of rigid links moves |
//! | 2 | [`rig`], [`measure`] | glTF and VRM files to [`rig::Rig`]; measures of a motion: slip, ZMP, residual, pops |
//! | 3 | [`mocap`], [`stepper`], [`whole_body`] | clip files (BVH, FBX, glTF, VRMA) and retargeting; the low-dimensional controller; the pose for a centre of mass and two feet |
//! | 4 | [`ragdoll`] | the articulated body: links, world, the torques that follow the controller's plan |
//! | 5 | [`sim`], [`audit`] | the fixed-step session that runs the stepper or the articulated body under a scenario and records a trace; captures to findings |
//! | 6 | [`bake`], [`correct`] | trace to clip, alone or over a base clip: foot curves, reach, ZMP filter, root motion, key reduction; findings to a corrected clip |
//! | 7 | [`export`], [`picture`] | bytes of GLB, VRMA, FBX, events, engine helpers; contact sheets, plots, pages of audits |
//! | 8 | [`batch`] | sweep to plan to clips side by side; records, manifest, near-duplicates, jobs for farms |
//! | 9 | [`disk`] | files on the disk: which are meant, what is in them; written whole or not at all |
//! | 10 | [`cli`], `studio` | the command line; the window |
//!
//! Beside `src/`: `rigs/` holds the built-in rig and the tables of bone names, `exports/` the format of what is written and a gallery, `tests/`
//! what spans several folders (tests/README.md says which test to run after which change).
//!
//! A bake from end to end, as the command line does it (without the files):
//!
//! ```
//! use surefoot::bake::{BakeOptions, bake};
//! use surefoot::model::{Scenario, report::Outcome};
//! use surefoot::{export, rig};
//!
//! let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound)); // the built-in rig is one file
//! let rig = rig::load_bytes("builtin", rig::mannequin::BUILTIN, &alone, None)?;
//! let baked = bake(&rig, &Scenario::demo(), &BakeOptions::default())?; // shoved from the left, 60 N s
//! assert_eq!(baked.report.outcome, Outcome::Step);
//! let glb = export::glb(&rig, &[(baked.clip, baked.report)])?.bytes;
//! assert_eq!(&glb[..4], b"glTF");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Spaces. **Scenario space** is metres, Y up, Z the rig's forward (so X is its left), origin on the ground under the
//! rig; rows 1 to 6 use it unless a name says otherwise. **Document space** is the source file's
//! own glTF world; [`rig::Rig::document_from_scenario`] maps to it. Angles are radians, times seconds, forces newtons;
//! degrees appear only in files and on screen.

pub mod audit;
pub mod bake;
pub mod batch;
pub mod cli;
pub mod correct;
pub mod disk;
pub mod dynamics;
pub mod export;
pub mod maths;
pub mod measure;
pub mod mocap;
pub mod model;
pub mod picture;
pub mod ragdoll;
pub mod rig;
pub mod sim;
pub mod stepper;
#[cfg(feature = "studio")]
pub mod studio;
pub mod whole_body;

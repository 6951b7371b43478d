//! The issue's own limits on baked clips, held on a part of the grid (`cargo bench --bench limits` prints all of it), and
//! what any bake must keep: the same bytes twice, mirrored pushes mirrored, seeds that differ, a stand that stands.

#![expect(clippy::print_stdout, reason = "the table, and what was skipped")]

use crate::common::builtin;
use crate::limits_grid::{EIGHT, LIMITS, Measured, Sum, faults, grid, head, rigs, row, shove};
use glam::DVec3;
use surefoot::bake::{BakeOptions, Baked, RootMotion, bake};
use surefoot::export::glb;
use surefoot::model::Body;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::Scenario;
use surefoot::rig::Rig;

/// Least share of clips that hold a limit: of the built-in rig, and of the third-party rigs together. The goal is 1
/// everywhere; what is less is how far it is reached today, rounded down.
const REACHED: [(&str, f64, f64); 14] = [
    ("slip<2mm", 1.0, 1.0),
    ("speed<10", 1.0, 1.0),
    ("sink<5mm", 1.0, 1.0),
    ("float<5mm", 1.0, 1.0),
    ("knee<0", 1.0, 1.0),
    ("limits", 0.83, 0.71),  // goal 1; ankles of crossing legs at lift and landing, short legs
    ("pops", 1.0, 0.96),     // goal 1; short legs, one knee of m2m
    ("legs>8cm", 1.0, 0.95), // goal 1; crossover steps of short legs and of mannequiny, worst 0.4 cm
    ("zmp>95%", 0.95, 0.97), // goal 1; worst 94 and 84 % inside
    ("out<3cm", 1.0, 0.98),  // goal 1; worst 3.4 cm
    ("ratio", 0.75, 0.73),   // goal 1; weak pushes of short legs under 0.6, 100 Ns backwards up to 1.33
    ("step<60", 1.0, 1.0),
    ("rests", 1.0, 0.98), // goal 1
    ("stands", 1.0, 1.0),
];

/// Built of boxes without feet or toes: in the table, not among what must hold but for standing up.
const FOOTLESS: &str = "sketchbook_boxman";

fn baked(rig: &Rig, scenario: &Scenario) -> Baked {
    bake(rig, scenario, &BakeOptions::default()).expect("the simulation holds")
}

fn still(seed: u64) -> Scenario {
    Scenario { title: "still".into(), duration: 4.0, seed, push: Vec::new(), pull: Vec::new(), ..Scenario::demo() }
}

#[test]
fn baked_clips_hold_the_limits() {
    let mut all: Vec<Measured> = Vec::new();
    let mut builtin = None;
    println!("{}", head());
    for (name, rig) in rigs() {
        let clips = if name == "builtin" {
            grid(&rig, &EIGHT, &[20.0, 60.0, 100.0])
        } else {
            grid(&rig, &[0.0, 90.0, 180.0, 315.0], &[60.0, 100.0])
        };
        println!("{}\n    {}", row(&name, &clips), faults(&clips));
        if builtin.is_none() {
            builtin = Some(Sum::of(&clips));
        } else if name == FOOTLESS {
            assert!(clips.iter().all(|clip| clip.outcome != Outcome::Fall), "{name} falls");
        } else {
            all.extend(clips);
        }
    }
    println!("{}", row("third party", &all));
    let (builtin, all) = (builtin.expect("the built-in rig is always there"), Sum::of(&all));
    // Over contacts, not clips: goal 1 mm, reached.
    for (whose, slip) in [("builtin", builtin.slip[0]), ("third party", all.slip[0])] {
        assert!(slip <= 1.0, "{whose}: 95th percentile of slip {slip} mm");
    }
    let mut failed = Vec::new();
    for (name, of_builtin, of_all) in REACHED {
        for (whose, sum, least) in [("builtin", &builtin, of_builtin), ("third party", &all, of_all)] {
            let at = LIMITS.iter().position(|limit| limit.0 == name).expect("a guard names a limit");
            if sum.passes[at] < least - 1e-9 {
                failed.push(format!("{whose}: {name} in {:.3} of the clips, was {least:.3}", sum.passes[at]));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
    assert_eq!(LIMITS.map(|limit| limit.0), REACHED.map(|reached| reached.0), "every limit has its guard");
}

#[test]
fn the_same_shove_twice_is_the_same_bytes() {
    for (name, rig) in rigs().into_iter().take(3) {
        let scenario = shove(&rig.body, 45.0, 60.0);
        let bytes = || {
            let baked = baked(&rig, &scenario);
            glb(&rig, &[(baked.clip, baked.report)]).expect("can be written").bytes
        };
        let (once, again) = (bytes(), bytes());
        assert!(once == again, "{name}: {} and {} bytes", once.len(), again.len());
    }
}

/// The joint on the other side, one a joint; `None` for a body that is not the same on both sides within 0.02 mm (a knee
/// near straight moves by a hundred times what its leg's length differs).
pub fn twins(body: &Body) -> Option<Vec<usize>> {
    let twin = |joint: usize| {
        let other = body.joint(body.joints[joint].role.mirrored())?;
        let (here, there) = (body.joints[joint].rest, body.joints[other].rest);
        ((here.x + there.x).abs() < 2e-5 && (here - there).with_x(0.0).length() < 2e-5).then_some(other)
    };
    (0..body.joints.len()).map(twin).collect()
}

/// m, the farthest that a joint is from its twin's mirror image.
pub fn apart(ours: &[DVec3], theirs: &[DVec3], twins: &[usize]) -> f64 {
    let off = |(joint, place): (usize, &DVec3)| (theirs[twins[joint]] * DVec3::new(-1.0, 1.0, 1.0)).distance(*place);
    ours.iter().enumerate().map(off).fold(0.0, f64::max)
}

#[test]
fn a_mirrored_push_gives_the_mirrored_clip() {
    let mut seen = 0;
    for (name, rig) in rigs() {
        let Some(twins) = twins(&rig.body) else {
            println!("{name}: not the same on both sides");
            continue;
        };
        seen += 1;
        for direction in [45.0, 90.0, 135.0] {
            let one = baked(&rig, &shove(&rig.body, direction, 60.0));
            let other = baked(&rig, &shove(&rig.body, 360.0 - direction, 60.0));
            let (mut ours, mut theirs) = (rig.sampler(&one.clip), rig.sampler(&other.clip));
            let (mut motion, mut clip) = (0.0_f64, 0.0_f64);
            for tick in 0..=240 {
                let time = 4.0 * f64::from(tick) / 240.0;
                let pose = |baked: &Baked| baked.performance.timeline.pose_at(time).positions(&rig.body);
                motion = motion.max(apart(&pose(&one), &pose(&other), &twins));
                clip = clip.max(apart(&ours.sample(time).positions, &theirs.sample(time).positions, &twins));
            }
            println!("{name} towards {direction}: motion {:.4} mm, keys {:.3} mm", 1000.0 * motion, 1000.0 * clip);
            assert!(motion < 1e-3, "{name} {direction}: {motion} m off");
            // Goal 1 mm; reached on all rigs but mannequiny, 7.0 mm at a knee: there a difference of a micrometre makes
            // the key reduction decide otherwise on one side.
            assert!(clip < if name == "gdquest_mannequiny" { 8e-3 } else { 1e-3 }, "{name} {direction}: {clip} m off");
        }
    }
    assert!(seen >= 1, "the built-in rig is the same on both sides");
}

#[test]
fn an_in_place_clip_is_measured_on_keys_and_not_on_the_poses_behind_them() {
    let rig = builtin();
    let scenario = shove(&rig.body, 0.0, 60.0);
    let told = |root| {
        let options = BakeOptions { root, ..BakeOptions::default() };
        bake(&rig, &scenario, &options).expect("the simulation holds").report.plausibility
    };
    let (with, without) = (told(RootMotion::Root), told(RootMotion::InPlace));
    assert!(with.slip_max_mm > 0.01, "keys slip a little: {} mm", with.slip_max_mm);
    assert_eq!(with.slip_max_mm, without.slip_max_mm, "the same motion");
}

#[test]
fn two_seeds_make_two_clips() {
    let rig = &builtin();
    let scenario = shove(&rig.body, 90.0, 60.0);
    let seeded = |seed: u64| bake(rig, &scenario, &BakeOptions { seed: Some(seed), ..BakeOptions::default() });
    let (one, other) = (seeded(1).expect("it bakes"), seeded(2).expect("it bakes"));
    let (mut ours, mut theirs) = (rig.sampler(&one.clip), rig.sampler(&other.clip));
    let hand = rig.body.joint(surefoot::model::Role::LeftHand).expect("a hand");
    let apart = (0..=120)
        .map(|tick| f64::from(tick) / 30.0)
        .map(|time| ours.sample(time).positions[hand].distance(theirs.sample(time).positions[hand]))
        .fold(0.0, f64::max);
    assert!(apart > 0.005, "the hand is {apart} m apart at most");
}

#[test]
fn standing_for_four_seconds_does_not_move_at_all() {
    for (name, rig) in rigs() {
        let baked = baked(&rig, &still(3));
        assert_eq!(baked.report.outcome, Outcome::Still, "{name}");
        assert_eq!(baked.report.steps, 0, "{name}");
        let mut sampler = rig.sampler(&baked.clip);
        let first = sampler.sample(0.0);
        for tick in 0..=480 {
            let now = sampler.sample(f64::from(tick) / 120.0);
            assert!(now.hips == first.hips, "{name}: the hips move by {} m", now.hips.distance(first.hips));
        }
    }
}

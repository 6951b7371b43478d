//! A body that reacts: when trunk, arms and head start and how far they go, how it matters where a push struck, that mirrored pushes
//! give mirrored turns, that seeds differ, and the breath of who stands still. Degrees from the pose before the push.

#![expect(clippy::print_stdout, reason = "the tables, and what was skipped")]

use crate::common::builtin;
use crate::data;
use crate::limits::twins;
use crate::limits_grid::THIRD_PARTY;
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;
use std::sync::Arc;
use surefoot::bake::{BakeOptions, Baked, Base, Performance, bake, perform};
use surefoot::maths::quat::{rotation_vector, yaw_of};
use surefoot::model::report::Outcome;
use surefoot::model::scenario::{Direction, Push, Scenario};
use surefoot::model::{BodyPose, Capture, Role, scenario_text};
use surefoot::rig::Rig;

/// s, when the pushes start.
const START: f64 = 1.0;
/// s between samples.
const DT: f64 = 1.0 / 120.0;

/// The built-in rig, or one of the third-party ones where those are there; `None` where they are not.
#[track_caller]
fn rig(name: &str) -> Option<Rig> {
    if name == "builtin" {
        return Some(builtin());
    }
    let file = THIRD_PARTY.iter().find(|file| file.split('.').next() == Some(name)).expect("a rig of the list");
    Some(surefoot::rig::load(&data::more()?.join("rigs").join(file)).expect("the rig loads"))
}

/// So many Ns of the reference body, within that time (s), at a bone, towards a heading (degrees).
fn pushed(rig: &Rig, at: Role, towards: f64, impulse: f64, seconds: f64) -> Scenario {
    let size = rig.body.mass / 89.5 * (rig.body.leg_length / 0.83).sqrt();
    let toward = Direction::Heading(towards.to_radians());
    let push = Push { start: START, duration: seconds, force: impulse * size / seconds, toward, at };
    Scenario { duration: 5.0, seed: 3, push: vec![push], ..Scenario::default() }
}

/// Turns of the upper body over time, each from its own at the push's start; rotation vectors in degrees, scenario axes.
pub struct Seen {
    pub trunk: Vec<DVec3>,
    pub pelvis: Vec<DVec3>,
    pub head: Vec<DVec3>,
    pub arms: [Vec<DVec3>; 2], // to the trunk
    pub twist: Vec<f64>,       // of the trunk on the pelvis, left positive
}

impl Seen {
    fn of(rig: &Rig, performance: &Performance) -> Seen {
        let timeline = &performance.timeline;
        Seen::over(rig, [START, timeline.duration()], START, &mut |time| timeline.pose_at(time))
    }

    /// Of any motion, over that span (s), from the pose at `rest` (s).
    pub fn over(rig: &Rig, [start, until]: [f64; 2], rest: f64, pose: &mut dyn FnMut(f64) -> BodyPose) -> Seen {
        let rest = pose(rest);
        let times = (0..).map(|tick| start + f64::from(tick) * DT).take_while(|time| *time < until);
        let poses: Vec<BodyPose> = times.map(pose).collect();
        let joint = |role| rig.body.joint(role);
        let trunk = [Role::UpperChest, Role::Chest, Role::Spine].into_iter().find_map(joint).expect("a spine");
        let of = |joint: usize, parent: Option<usize>| -> Vec<DVec3> {
            let turn = |pose: &BodyPose| {
                parent.map_or(pose.turns[joint], |parent| pose.turns[parent].inverse() * pose.turns[joint])
            };
            let first = turn(&rest).inverse();
            poses.iter().map(|pose| rotation_vector(turn(pose) * first) * 360.0 / TAU).collect()
        };
        let twist = |pose: &BodyPose| (yaw_of(pose.turns[trunk]) - yaw_of(pose.turns[0])).to_degrees();
        let arm = |role| of(joint(role).expect("an arm"), Some(trunk));
        Seen {
            trunk: of(trunk, None),
            pelvis: of(0, None),
            head: of(joint(Role::Head).expect("a head"), None),
            arms: [arm(Role::LeftUpperArm), arm(Role::RightUpperArm)],
            twist: poses.iter().map(twist).collect(),
        }
    }
}

/// Degrees and s of the greatest one.
pub fn peak(series: &[DVec3]) -> (f64, f64) {
    let sizes = series.iter().enumerate().map(|(tick, turn)| (turn.length(), tick as f64 * DT));
    sizes.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
}

/// s until it is more than a degree; infinite where it never is.
pub fn delay(series: &[DVec3]) -> f64 {
    series.iter().position(|turn| turn.length() > 1.0).map_or(f64::INFINITY, |tick| tick as f64 * DT)
}

/// s until less than a tenth of the peak, or a degree, is left.
pub fn settles(series: &[DVec3]) -> f64 {
    let left = (0.1 * peak(series).0).max(1.0);
    series.iter().rposition(|turn| turn.length() > left).map_or(0.0, |tick| tick as f64 * DT)
}

/// What of them leans, without what turns about the vertical.
pub fn leaning(series: &[DVec3]) -> Vec<DVec3> {
    series.iter().map(|turn| turn.with_y(0.0)).collect()
}

fn at(seconds: f64) -> usize {
    (seconds / DT).round() as usize
}

#[test]
fn trunk_arms_and_head_react_with_a_persons_delays_and_sizes() {
    println!(
        "  Ns    to |  1 deg after s: trunk arms  head | against the fall | peak deg at s: trunk       arms        head pitch roll | settle s"
    );
    let rig = builtin();
    let mut trunks = Vec::new();
    for impulse in [20.0, 60.0, 100.0] {
        for towards in 0..8 {
            let towards = 45.0 * f64::from(towards);
            let scenario = pushed(&rig, Role::Chest, towards, impulse, 0.2);
            let seen = Seen::of(&rig, &perform(&rig.body, &scenario, 3).expect("it runs"));
            // Arms that only dangle, to tell what a body does of itself.
            let mut limp = scenario.clone();
            limp.character.style.arms = 0.0;
            let limp = Seen::of(&rig, &perform(&rig.body, &limp, 3).expect("it runs"));
            let active = [0, 1].map(|side: usize| {
                let apart = seen.arms[side].iter().zip(&limp.arms[side]).map(|(one, other)| *one - *other);
                let apart: Vec<DVec3> = apart.collect();
                let starts = 0.05 * peak(&apart).0;
                apart.iter().position(|turn| turn.length() > starts).map_or(f64::INFINITY, |tick| tick as f64 * DT)
            });
            let active = active[0].min(active[1]);
            let arms = if peak(&seen.arms[0]).0 > peak(&seen.arms[1]).0 { &seen.arms[0] } else { &seen.arms[1] };
            let ((trunk, trunk_at), (arm, arm_at)) = (peak(&leaning(&seen.trunk)), peak(arms));
            let pitch = seen.head.iter().map(|turn| turn.x.abs()).fold(0.0, f64::max);
            let roll = seen.head.iter().map(|turn| turn.z.abs()).fold(0.0, f64::max);
            println!(
                "{impulse:>4} {towards:>5} | {:>20.2} {:>5.2} {:>5.2} | {active:>16.2} | {trunk:>20.1} {trunk_at:.2} {arm:>6.1} {arm_at:.2} {pitch:>11.1} {roll:>4.1} | {:.2} {:.2} {:.2}",
                delay(&seen.trunk),
                delay(arms),
                delay(&seen.head),
                settles(&seen.trunk),
                settles(arms),
                settles(&seen.head)
            );
            let what = format!("{impulse} Ns towards {towards}");
            assert!(
                (0.10..=if impulse < 50.0 { 0.25 } else { 0.20 }).contains(&active),
                "{what}: the arms rise after {active} s"
            );
            assert!((0.02..=0.12).contains(&delay(&seen.trunk)), "{what}: the push itself moves the trunk");
            assert!((0.18..=0.35).contains(&trunk_at), "{what}: the trunk turns back after {trunk_at} s");
            assert!(arm_at > trunk_at, "{what}: arms come after the trunk");
            assert!(
                pitch.hypot(roll) < 0.35 * trunk + 0.1,
                "{what}: the head leans by {pitch} and {roll}, the trunk by {trunk}"
            );
            assert!(settles(&seen.trunk) < 1.8 && settles(arms) < 2.6, "{what}: does not come to rest");
            trunks.push((impulse, trunk, arm));
        }
    }
    let mean = |impulse: f64, of: fn(&(f64, f64, f64)) -> f64| {
        let those: Vec<f64> = trunks.iter().filter(|row| row.0 == impulse).map(of).collect();
        those.iter().sum::<f64>() / those.len() as f64
    };
    let [small, middle, large] =
        [20.0, 60.0, 100.0].map(|impulse| (mean(impulse, |row| row.1), mean(impulse, |row| row.2)));
    assert!((3.0..6.0).contains(&small.0) && (10.0..15.0).contains(&middle.0) && (15.0..22.0).contains(&large.0));
    assert!(small.1 < 16.0 && middle.1 > 2.0 * small.1 && large.1 > 1.1 * middle.1, "{small:?} {middle:?} {large:?}");
}

#[test]
fn what_was_struck_goes_first() {
    println!("at            to | trunk lean, yaw | head lean on it | hips lean | twist, 0.22 s after the push began");
    let rig = builtin();
    let row = |role: Role, towards: f64| {
        let scenario = pushed(&rig, role, towards, 60.0, 0.2);
        let seen = Seen::of(&rig, &perform(&rig.body, &scenario, 3).expect("it runs"));
        let now = at(0.22);
        // Along the push: forwards positive where it goes forwards.
        let sign = towards.to_radians().cos();
        let [trunk, head, pelvis] = [&seen.trunk, &seen.head, &seen.pelvis].map(|series| sign * series[now].x);
        let yaw = seen.trunk[now].y;
        println!(
            "{:<13} {towards:>3} | {trunk:>6.1} {yaw:>6.1} | {:>13.1} | {pelvis:>9.1} | {:>5.1}",
            role.name(),
            head - trunk,
            seen.twist[now]
        );
        (trunk, head - trunk, pelvis, seen.twist[now], yaw)
    };
    for towards in [0.0, 180.0] {
        let [head, chest, hips] = [Role::Head, Role::Chest, Role::Hips].map(|role| row(role, towards));
        let [left, right] = [Role::LeftUpperArm, Role::RightUpperArm].map(|role| row(role, towards));
        row(Role::LeftShoulder, towards);
        row(Role::LeftHand, towards);
        row(Role::LeftUpperLeg, towards);
        assert!(head.1 > 6.0, "a struck head goes ahead of the trunk: {head:?}");
        assert!(chest.0 > 10.0 && chest.1 < -6.0, "a struck chest leaves the head behind: {chest:?}");
        assert!(hips.0 < -4.0 && hips.2 > hips.0 + 5.0, "struck hips leave the chest behind: {hips:?}");
        let away = -towards.to_radians().cos();
        assert!(left.3 * away > 10.0, "a push at the left shoulder turns it away: {left:?}");
        assert!((left.3 + right.3).abs() < 2.0, "and at the right one the other way: {left:?} {right:?}");
        assert!(chest.3.abs() < 2.0 && head.3.abs() < 2.0, "one in the middle does not");
    }
}

#[test]
fn quick_and_slow_pushes_of_one_impulse_look_different() {
    let rig = builtin();
    let seen = |seconds: f64| {
        Seen::of(&rig, &perform(&rig.body, &pushed(&rig, Role::Chest, 180.0, 40.0, seconds), 3).expect("it runs"))
    };
    let (quick, slow) = (seen(0.05), seen(0.6));
    let ((far, soon), (near, late)) = (peak(&leaning(&quick.trunk)), peak(&leaning(&slow.trunk)));
    println!("40 Ns in 0.05 s: {far:.1} degrees at {soon:.2} s; in 0.6 s: {near:.1} at {late:.2} s");
    assert!(far > 1.5 * near && soon + 0.15 < late, "{far} at {soon} and {near} at {late}");
}

/// The mirror image of a turn, left and right exchanged.
fn mirrored(turn: DQuat) -> DQuat {
    DQuat::from_xyzw(turn.x, -turn.y, -turn.z, turn.w)
}

/// Degrees, the farthest that a joint's turn in the one clip is from its twin's mirror image in the other: of the baked keys.
fn apart(rig: &Rig, one: &Baked, other: &Baked, twins: &[usize]) -> f64 {
    let (mut ours, mut theirs) = (rig.sampler(&one.clip), rig.sampler(&other.clip));
    let mut worst = 0.0_f64;
    for tick in 0..=(one.clip.duration * 60.0) as usize {
        let time = tick as f64 / 60.0;
        let (here, there) = (ours.sample(time), theirs.sample(time));
        for (joint, twin) in twins.iter().enumerate() {
            worst = worst.max(here.turns[joint].angle_between(mirrored(there.turns[*twin])).to_degrees());
        }
    }
    worst
}

fn baked(rig: &Rig, scenario: &Scenario, base: Option<&Arc<Base>>) -> Baked {
    bake(rig, scenario, &BakeOptions { base: base.cloned(), ..BakeOptions::default() }).expect("it bakes")
}

#[test]
fn a_mirrored_push_turns_every_joint_to_the_mirror_image() {
    for name in ["builtin", "m2m_human_base_animations", "kaykit_Knight"] {
        let Some(rig) = rig(name) else { continue };
        let twins = twins(&rig.body).expect("it is the same on both sides");
        for (at, towards, impulse, breathing) in [
            (Role::Chest, 90.0, 60.0, 0.0),
            (Role::LeftUpperArm, 160.0, 60.0, 0.5),
            (Role::LeftHand, 45.0, 100.0, 1.0),
            (Role::RightUpperLeg, 20.0, 20.0, 0.5),
        ] {
            let mut scenario = pushed(&rig, at, towards, impulse, 0.15);
            scenario.character.breathing = breathing;
            let mut other = pushed(&rig, at.mirrored(), 360.0 - towards, impulse, 0.15);
            other.character.breathing = breathing;
            let off = apart(&rig, &baked(&rig, &scenario, None), &baked(&rig, &other, None), &twins);
            println!("{name}: {impulse} Ns at {} towards {towards}: {off:.4} degrees", at.name());
            assert!(off < 0.1, "{name} {towards}: {off} degrees");
            // What is no mirror image is seen as such.
            let same = apart(&rig, &baked(&rig, &scenario, None), &baked(&rig, &scenario, None), &twins);
            assert!(same > 3.0, "{name}: {same}");
        }
    }
}

/// A clip that stands with both forearms up and nods, the same on both sides.
fn guard(rig: &Rig) -> Arc<Base> {
    let still = baked(rig, &Scenario::default(), None).performance.timeline.pose_at(0.0);
    let raised = |joint: usize| {
        let mut here = Some(joint);
        while let Some(joint) = here {
            if matches!(rig.body.joints[joint].role, Role::LeftLowerArm | Role::RightLowerArm) {
                return true;
            }
            here = rig.body.joints[joint].parent;
        }
        false
    };
    let (mut positions, mut turns) = (Vec::new(), Vec::new());
    for frame in 0..=60 {
        let nod = DQuat::from_rotation_x(0.03 * (TAU * f64::from(frame) / 60.0).sin());
        let mut pose = still.clone();
        for (joint, turn) in pose.turns.iter_mut().enumerate() {
            if raised(joint) {
                *turn = DQuat::from_rotation_x(-1.2) * *turn;
            }
            if rig.body.joints[joint].role == Role::Head {
                *turn = nod * *turn;
            }
        }
        positions.extend(pose.positions(&rig.body));
        turns.extend(pose.turns);
    }
    let capture = Capture {
        name: "guard".into(),
        fps: 30.0,
        body: rig.body.clone(),
        positions,
        turns,
        units_to_metres: 1.0,
        up: "Y".into(),
        confidence: 1.0,
        method: String::new(),
        notes: Vec::new(),
        pushes: Vec::new(),
    };
    Arc::new(Base::new(&capture).expect("it is a stand"))
}

#[test]
fn over_a_symmetric_base_clip_too_and_it_ends_as_the_base_breathing_or_not() {
    for name in ["builtin", "m2m_human_base_animations"] {
        let Some(rig) = rig(name) else { continue };
        let twins = twins(&rig.body).expect("it is the same on both sides");
        let base = guard(&rig);
        for (at, towards, impulse) in [(Role::Chest, 90.0, 60.0), (Role::LeftUpperArm, 170.0, 40.0)] {
            let mut scenario = pushed(&rig, at, towards, impulse, 0.2);
            scenario.character.breathing = 0.5;
            scenario.duration = 6.0;
            let mut other = pushed(&rig, at.mirrored(), 360.0 - towards, impulse, 0.2);
            (other.character, other.duration) = (scenario.character, 6.0);
            let (one, other) = (baked(&rig, &scenario, Some(&base)), baked(&rig, &other, Some(&base)));
            let off = apart(&rig, &one, &other, &twins);
            let ends = one.report.base.as_ref().expect("it says where it comes from");
            println!("{name} {}: {off:.4} degrees; ends {:.3} and {:.3}", at.name(), ends.first_deg, ends.last_deg);
            assert!(off < 0.1, "{name}: {off} degrees");
            assert!(ends.first_deg < 0.1 && ends.last_deg < 0.1, "{name}: {} {}", ends.first_deg, ends.last_deg);
            // Hands and fingers are where the base has them: with the forearm.
            let mut sampler = rig.sampler(&one.clip);
            let first = sampler.sample(0.0);
            let bend = |turns: &[DQuat], joint: usize, parent: usize| turns[parent].inverse() * turns[joint];
            for tick in 0..=180 {
                let now = sampler.sample(f64::from(tick) / 30.0);
                for (joint, parent) in
                    rig.body.joints.iter().enumerate().filter_map(|(j, known)| Some((j, known.parent?)))
                {
                    let named = rig.body.joints[joint].role.name();
                    if ["Hand", "Thumb", "Index", "Middle", "Ring", "Little"].iter().any(|part| named.contains(part)) {
                        let off = bend(&now.turns, joint, parent).angle_between(bend(&first.turns, joint, parent));
                        assert!(off.to_degrees() < 0.3, "{name}: {named} by {} degrees", off.to_degrees());
                    }
                }
            }
        }
    }
}

#[test]
fn two_seeds_differ_by_degrees_and_not_by_much() {
    let rig = builtin();
    let seen = |seed: u64| {
        Seen::of(&rig, &perform(&rig.body, &pushed(&rig, Role::Chest, 90.0, 60.0, 0.2), seed).expect("it runs"))
    };
    let seeds: Vec<Seen> = (1..=6).map(seen).collect();
    for (index, one) in seeds.iter().enumerate() {
        for other in &seeds[index + 1..] {
            let apart = |one: &[DVec3], other: &[DVec3]| {
                one.iter().zip(other).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max)
            };
            let arms = apart(&one.arms[0], &other.arms[0]).max(apart(&one.arms[1], &other.arms[1]));
            assert!((0.5..20.0).contains(&arms), "arms {arms} degrees apart");
            assert!(apart(&one.trunk, &other.trunk) < 4.0, "one person, another day");
        }
    }
}

#[test]
fn who_is_told_to_breathe_does_and_keeps_his_feet() {
    let scenario = scenario_text::parse("still.toml", "duration = 8.0\nseed = 5\n[character]\nbreathing = 0.5\n");
    let scenario = scenario.expect("the key is known");
    for name in ["builtin", "m2m_human_base_animations", "gdquest_mannequiny"] {
        let Some(rig) = rig(name) else { continue };
        let clip = baked(&rig, &scenario, None);
        let spine = [Role::UpperChest, Role::Chest, Role::Spine].into_iter();
        let chest = spine.filter_map(|role| rig.body.joint(role)).next().expect("a spine");
        let arm = rig.body.joint(Role::LeftUpperArm).expect("an arm");
        let mut sampler = rig.sampler(&clip.clip);
        let (first, last) = (sampler.sample(0.0), sampler.sample(8.0));
        let off = |one: &DQuat, other: &DQuat| one.angle_between(*other).to_degrees();
        let ends = first.turns.iter().zip(&last.turns).map(|(one, other)| off(one, other)).fold(0.0, f64::max);
        let mut moved = |joint: usize| {
            let times = (0..=240).map(|tick| f64::from(tick) / 30.0);
            times.map(|time| off(&sampler.sample(time).turns[joint], &first.turns[joint])).fold(0.0, f64::max)
        };
        let (chest, arm) = (moved(chest), moved(arm));
        let told = &clip.report.plausibility;
        println!(
            "{name}: chest {chest:.2}, arm {arm:.2}, ends {ends:.3} degrees; slip {:.2} mm, ZMP {:.0} %",
            told.slip_max_mm,
            100.0 * told.zmp_inside
        );
        assert!((0.5..3.0).contains(&chest) && (0.5..3.0).contains(&arm), "{name}: {chest} {arm}");
        assert!(ends < 0.05, "{name}: it ends {ends} degrees from where it starts");
        assert!(told.slip_max_mm < 1.0 && clip.report.steps == 0 && clip.report.outcome == Outcome::Still, "{name}");
        let mut other = scenario.clone();
        other.seed = 6;
        let theirs = baked(&rig, &other, None);
        let mut theirs = rig.sampler(&theirs.clip);
        assert!(off(&theirs.sample(4.0).turns[0], &sampler.sample(4.0).turns[0]) > 0.01, "seeds differ");
    }
}

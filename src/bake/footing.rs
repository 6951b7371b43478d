//! Plants as a sole can stand on them, and how high the ground carries the body. Ground frame, metres.
//!
//! A sole is stiff: on rolling ground it stands on the plane that lies best under it, on stairs on one tread, out of the
//! riser before or behind it.

use super::perform::Performance;
use super::timeline::Timeline;
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::measure::joints::LegAngles;
use crate::model::lie::plane_of;
use crate::model::scenario::GroundKind;
use crate::model::{Body, FootShape, Side, Terrain};
use crate::stepper::{Physique, Plant, Step, StepKind};
use crate::whole_body::solve::Solved;
use glam::{DVec2, DVec3};

/// s, standard deviation of the smoothing of the ground's height under the body.
const SMOOTHING: f64 = 0.2;
/// How far the lower foot counts for more: 0 both alike, 1 it alone. A leg bends more easily than it grows.
const LOWER: f64 = 0.7;
/// m, that a sole keeps from a riser.
const RISER_GAP: f64 = 0.01;

/// Part of the leg by which the pressure may be beside the other foot's sole for the trailing one to leave.
const SLACK: f64 = 0.03;
/// s, least time that both feet are down.
const LEAST_DOUBLE: f64 = 0.03;
/// s, least time that a foot stands that steps twice running: as long as it takes to lie flat.
const LEAST_STAND: f64 = 0.085;

/// The plants of a run on the ground.
pub fn grounded(body: &Body, terrain: &Terrain, start: &[Plant; 2], steps: &[Step]) -> ([Plant; 2], Vec<Step>) {
    let on = |side: Side, plant: &Plant| plant_on(&body.feet[side as usize], terrain, plant);
    let steps = steps.iter().map(|step| Step { from: on(step.side, &step.from), to: on(step.side, &step.to), ..*step });
    (Side::BOTH.map(|side| on(side, &start[side as usize])), steps.collect())
}

/// The steps with each lift as soon as the pressure has gone over to the foot that landed last: what trails on after that
/// carries nothing, and holds the body down and its ankles bent. Walkers keep their own time. `cop`: the pressure's place,
/// (x, z), every `dt` s; `scale`: times relative to the reference body.
pub fn sooner(steps: &[Step], physique: &Physique, cop: &[DVec2], dt: f64, scale: f64) -> Vec<Step> {
    let mut sooner = steps.to_vec();
    for (number, step) in steps.iter().enumerate() {
        let others = steps[..number].iter().rev().find(|other| other.side != step.side && other.land <= step.lift);
        let (Some(other), false) = (others, step.kind == StepKind::Walk) else { continue };
        let ahead = DVec2::new(real::sin(other.to.yaw), real::cos(other.to.yaw));
        let carries = |time: f64| {
            let Some(cop) = cop.get((time / dt).round() as usize) else { return true };
            let from = *cop - DVec2::new(other.to.ankle.x, other.to.ankle.z);
            let along = from.dot(ahead);
            let across = from.dot(DVec2::new(ahead.y, -ahead.x)).abs();
            let slack = SLACK * physique.leg_length;
            (physique.heel - slack..=physique.tip + slack).contains(&along) && across <= physique.half_width + slack
        };
        // A foot that steps twice running must have come down from the first of the two.
        let own = steps[..number].iter().rev().find(|own| own.side == step.side);
        let stood = own.map_or(f64::NEG_INFINITY, |own| own.land + LEAST_STAND * scale);
        let least = (other.land + LEAST_DOUBLE * scale).max(stood).min(step.lift);
        let mut lift = step.lift;
        while lift - dt >= least && carries(lift - dt) {
            lift -= dt;
        }
        sooner[number].lift = lift;
    }
    sooner
}

/// Parts of the leg: a foot that crosses nearer to the other's line than the first lands at least as far as the second before or behind
/// the other, if it takes no more than the third to bring it there.
const CROSSES: [f64; 3] = [0.1, 0.302, 0.063];

/// Plants of feet that cross, with room between the shanks; on ground that is not flat, where it is as level there.
pub(super) fn roomier(body: &Body, terrain: &Terrain, start: &[Plant; 2], steps: &mut [Step], physique: &Physique) {
    let [near, room, most] = CROSSES.map(|part| part * physique.leg_length);
    for number in 0..steps.len() {
        let step = steps[number];
        let others = steps[..number].iter().rfind(|other| other.side != step.side && other.land <= step.land);
        let other = others.map_or(start[step.side.other() as usize], |other| other.to);
        let ahead = DVec3::new(real::sin(other.yaw), 0.0, real::cos(other.yaw));
        let apart = step.to.ankle - other.ankle;
        let beside = step.side.sign() * (apart.x * ahead.z - apart.z * ahead.x);
        let before = apart.dot(ahead);
        if step.kind == StepKind::Walk || beside > near || before.abs() < room - most {
            continue;
        }
        let more = ahead * (before.signum() * (room - before.abs()).max(0.0));
        let moved = Plant { ankle: step.to.ankle + more, ..step.to };
        if !terrain.is_flat() && !as_level(&body.feet[step.side as usize], terrain, &moved) {
            continue;
        }
        steps[number].to.ankle += more;
        if let Some(next) = steps[number + 1..].iter_mut().find(|next| next.side == step.side) {
            next.from.ankle += more;
        }
    }
}

/// s, how long before a lift an ankle counts as of a foot that leaves.
const LEAVING: f64 = 0.06;
/// s, the most by which a foot leaves sooner for its ankle, and where its leg does not reach it.
const SOONER: [f64; 2] = [0.04, 0.12];
/// rad, by how much an ankle must be out of its range for that.
const STRAINED: f64 = 0.8 * std::f64::consts::PI / 180.0;
/// m, the same of a leg's reach.
const SHORT: f64 = 1e-3;

/// Lets trailing feet leave a tick sooner that are out of their ankle's range or their leg's reach at the last: the pressure is as
/// good as gone from them then; walkers' where the ground is `uneven`. Whether any does. Call it a few times over; `solved`: the poses of the present curves.
pub(super) fn spare_legs(
    timeline: &mut Timeline,
    legs: &LegAngles,
    solved: &[Solved],
    scale: f64,
    uneven: bool,
) -> bool {
    let dt = timeline.dt;
    let mut any = false;
    for side in Side::BOTH {
        let ranges = legs.ranges(side);
        for number in 0..timeline.feet.feet[side as usize].swings.len() {
            let [own, other] = [side, side.other()].map(|side| &timeline.feet.feet[side as usize].swings);
            let swing = own[number];
            let landed = other.iter().rfind(|other| other.land <= swing.lift);
            let Some(landed) = landed.filter(|_| swing.held <= 0.0) else { continue };
            let stood = number.checked_sub(1).map(|last| own[last].land + own[last].settle.max(LEAST_STAND * scale));
            let least = (landed.land + LEAST_DOUBLE * scale).max(stood.unwrap_or(f64::NEG_INFINITY));
            let at_last = |index: &usize| {
                let time = *index as f64 * dt;
                time <= swing.lift && *index < solved.len() && !timeline.feet.is_clips(side, time)
            };
            let strained = |index: usize| {
                legs.at(&solved[index].pose, side).is_some_and(|angles| {
                    (2..4)
                        .any(|axis| !(ranges[axis][0] - STRAINED..=ranges[axis][1] + STRAINED).contains(&angles[axis]))
                })
            };
            let from = |span: f64| ((swing.lift - span * scale) / dt).ceil().max(0.0) as usize;
            let may = |most: f64| swing.lift - dt >= least.max(swing.planned - most * scale);
            let leaves = (may(if uneven { SOONER[1] } else { SOONER[0] })
                && (uneven || !swing.walks)
                && (from(LEAVING)..).take_while(at_last).any(strained))
                || may(SOONER[1])
                    && (from(SOONER[1])..).take_while(at_last).any(|index| solved[index].short[side as usize] > SHORT);
            if leaves {
                timeline.feet.feet[side as usize].swings[number].lift -= dt;
                any = true;
            }
        }
    }
    any
}

/// Is the whole sole carried there by ground that lies as the plant does?
fn as_level(foot: &FootShape, terrain: &Terrain, plant: &Plant) -> bool {
    let at = DVec2::new(plant.ankle.x, plant.ankle.z);
    let points: Vec<DVec2> = sole(foot, plant).collect();
    terrain.lie(at, &points).is_some_and(|lie| {
        lie.held >= 1.0 && (lie.height - plant.ankle.y).abs() < 1e-3 && lie.normal.dot(plant.normal) > 1.0 - 1e-6
    })
}

fn plant_on(foot: &FootShape, terrain: &Terrain, plant: &Plant) -> Plant {
    let at = DVec2::new(plant.ankle.x, plant.ankle.z);
    let here =
        |at: DVec2, height: f64, normal: DVec3| Plant { ankle: DVec3::new(at.x, height, at.y), normal, ..*plant };
    match terrain.kind {
        GroundKind::Flat => *plant,
        GroundKind::Slope { .. } | GroundKind::Gaps { .. } | GroundKind::Platform { .. } => {
            let spot = terrain.spot(at);
            here(at, spot.height, spot.normal)
        }
        GroundKind::Stairs { .. } => {
            let mut heights: Vec<f64> = sole(foot, plant).map(|offset| terrain.spot(at + offset).height).collect();
            heights.sort_by(f64::total_cmp);
            let tread = heights[heights.len() / 2];
            // Out of the riser that it would stick in: back from one ahead, on from one behind.
            let stuck = |shift: f64| {
                sole(foot, plant).any(|offset| terrain.spot(at + offset + DVec2::Y * shift).height > tread + 1e-6)
            };
            let shifts = (0..30).flat_map(|step| [-0.005 * f64::from(step), 0.005 * f64::from(step)]);
            let free = shifts.into_iter().find(|shift| !stuck(*shift)).unwrap_or(0.0);
            let free = if free == 0.0 { 0.0 } else { free + RISER_GAP * free.signum() };
            here(at + DVec2::Y * free, tread, DVec3::Y)
        }
        GroundKind::Uneven { .. } => {
            let points: Vec<DVec3> = sole(foot, plant)
                .map(|offset| DVec3::new(offset.x, terrain.spot(at + offset).height, offset.y))
                .collect();
            let Some([height, x, z]) = plane_of(&points) else {
                let spot = terrain.spot(at);
                return here(at, spot.height, spot.normal);
            };
            here(at, height, DVec3::new(-x, 1.0, -z).normalize())
        }
        GroundKind::Mesh { .. } => {
            let points: Vec<DVec2> = sole(foot, plant).collect();
            // Over nothing at all it stays as high as it was set.
            terrain.lie(at, &points).map_or(*plant, |lie| here(at, lie.height, lie.normal))
        }
    }
}

/// m, points of a sole from the ankle's shadow, (x, z), as it would lie on level ground.
fn sole<'a>(foot: &'a FootShape, plant: &Plant) -> impl Iterator<Item = DVec2> + 'a {
    let ahead = DVec2::new(real::sin(plant.yaw), real::cos(plant.yaw));
    let left = DVec2::new(ahead.y, -ahead.x);
    (0..=8).flat_map(move |along| {
        let along = foot.heel + (foot.tip - foot.heel) * f64::from(along) / 8.0;
        [-1.0, 0.0, 1.0].map(|across| ahead * along + left * (across * foot.half_width))
    })
}

/// m, how high the ground is under the body of a performance, an entry a tick: between its feet, on stairs as on a ramp.
pub fn heights(performance: &Performance) -> Vec<f64> {
    let Performance { timeline, trace, .. } = performance;
    if timeline.terrain.is_flat() {
        return Vec::new();
    }
    let steps: Vec<Step> = trace.steps.iter().copied().chain(trace.aloft.filter(|_| trace.lost.is_none())).collect();
    let (start, steps) = grounded(&timeline.body, &timeline.terrain, &trace.start, &steps);
    let run = (timeline.dt, timeline.com.len());
    carried(&timeline.body, &timeline.terrain, &start, &steps, run, 0.0)
}

/// m, how much higher than on level ground the feet carry the body, an entry a tick: the mean of both ankles, smooth in time.
pub fn bases(body: &Body, terrain: &Terrain, start: &[Plant; 2], steps: &[Step], dt: f64, count: usize) -> Vec<f64> {
    if terrain.is_flat() {
        return vec![0.0; count];
    }
    carried(body, terrain, start, steps, (dt, count), LOWER)
}

/// The same; `lower`: how far the lower foot counts for more.
fn carried(
    body: &Body,
    terrain: &Terrain,
    start: &[Plant; 2],
    steps: &[Step],
    (dt, count): (f64, usize),
    lower: f64,
) -> Vec<f64> {
    let height = |side: Side, time: f64| {
        let foot = &body.feet[side as usize];
        let turn = terrain.turn(time);
        let ankle = |plant: &Plant| (turn * (plant.ankle + plant.normal * foot.ankle_height)).y - foot.ankle_height;
        let last = steps.iter().rev().find(|step| step.side == side && step.lift <= time);
        last.map_or(ankle(&start[side as usize]), |step| {
            let share = smooth3((time - step.lift) / (step.land - step.lift).max(1e-6));
            ankle(&step.from) + (ankle(&step.to) - ankle(&step.from)) * share
        })
    };
    let carried = |time: f64| {
        let [left, right] = Side::BOTH.map(|side| height(side, time));
        0.5 * (left + right) - 0.5 * lower * (left - right).abs()
    };
    let raw: Vec<f64> = (0..count).map(|index| carried(index as f64 * dt)).collect();
    let reach = (3.0 * SMOOTHING / dt).ceil() as isize;
    let last = count as isize - 1;
    let at = |index: isize| raw[index.clamp(0, last) as usize];
    let weights: Vec<f64> =
        (-reach..=reach).map(|off| real::exp(-0.5 * (off as f64 * dt / SMOOTHING).powi(2))).collect();
    let total: f64 = weights.iter().sum();
    (0..=last)
        .map(|index| (-reach..=reach).zip(&weights).map(|(off, weight)| weight * at(index + off)).sum::<f64>() / total)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario::Ground;

    fn ground(kind: GroundKind) -> Terrain {
        Terrain::new(&Ground { kind, ..Ground::default() })
    }

    fn foot() -> FootShape {
        use glam::DQuat;
        FootShape {
            ankle: 0,
            toe: None,
            level: DQuat::IDENTITY,
            toe_level: DQuat::IDENTITY,
            ankle_height: 0.08,
            forward: DVec2::Y,
            heel: -0.07,
            ball: 0.12,
            tip: 0.19,
            half_width: 0.045,
            rear_sole: Vec::new(),
            front_sole: Vec::new(),
        }
    }

    #[test]
    fn a_foot_that_steps_twice_running_lands_before_it_leaves_again() {
        let at = |x: f64| Plant::level(DVec3::new(x, 0.0, 0.0), 0.0);
        let step = |side, lift, land, from, to| Step {
            kind: StepKind::Corrective,
            side,
            lift,
            land,
            from: at(from),
            to: at(to),
        };
        // The pressure is on the right foot all the while: nothing but its own landing holds the left one back.
        let steps = [
            step(Side::Right, 0.7, 1.0, -0.1, -0.3),
            step(Side::Left, 1.3, 1.7, 0.1, 0.3),
            step(Side::Left, 1.8, 2.1, 0.3, 0.0),
        ];
        let physique = Physique {
            mass: 89.5,
            com_height: 0.96,
            leg_length: 0.83,
            hip_height: 0.9,
            ankle_height: 0.08,
            stance_width: 0.2,
            com_forward: 0.04,
            toe_out: 0.0,
            heel: -0.07,
            tip: 0.19,
            stance: None,
            half_width: 0.045,
        };
        let on_the_right = vec![DVec2::new(-0.3, 0.05); 300];
        let sooner = sooner(&steps, &physique, &on_the_right, 0.01, 1.0);
        assert!(sooner[1].lift < 1.1, "it trails on until {} s", sooner[1].lift);
        assert!(sooner[2].lift > 1.7 + 0.08 && sooner[2].lift <= 1.8, "it leaves at {} s", sooner[2].lift);
    }

    #[test]
    fn a_sole_on_stairs_is_on_one_tread_and_out_of_the_riser() {
        let terrain = ground(GroundKind::Stairs { rise: 0.17, tread: 0.3, count: 4 });
        for index in 0..120 {
            let plant = Plant::level(DVec3::new(0.1, 0.0, 0.7 + 0.01 * f64::from(index)), 0.1);
            let set = plant_on(&foot(), &terrain, &plant);
            let at = DVec2::new(set.ankle.x, set.ankle.z);
            assert!((set.ankle.z - plant.ankle.z).abs() < 0.15, "{plant:?} {set:?}");
            for offset in sole(&foot(), &set) {
                assert!(terrain.spot(at + offset).height <= set.ankle.y + 1e-9, "{plant:?}: it sticks in a riser");
            }
            let carried = sole(&foot(), &set).filter(|o| terrain.spot(at + *o).height > set.ankle.y - 1e-9).count();
            assert!(carried >= 9, "{plant:?}: a third of the sole at least is on its tread: {carried} of 27");
        }
    }

    #[test]
    fn a_sole_lies_within_millimetres_of_rolling_ground() {
        let terrain = ground(GroundKind::Uneven { height: 0.05, wavelength: 1.5, seed: 9 });
        for index in 0..50 {
            let plant = Plant::level(DVec3::new(0.13 * f64::from(index), 0.0, -0.07 * f64::from(index)), 0.3);
            let set = plant_on(&foot(), &terrain, &plant);
            let at = DVec2::new(set.ankle.x, set.ankle.z);
            for offset in sole(&foot(), &set) {
                let plane = set.ankle.y - (offset.x * set.normal.x + offset.y * set.normal.z) / set.normal.y;
                let off = (plane - terrain.spot(at + offset).height).abs();
                assert!(off < 8e-3, "{off}");
            }
        }
    }

    #[test]
    fn a_foot_that_crosses_lands_clear_of_the_other_shank_and_leaves_from_there() {
        let physique = Physique::REFERENCE;
        let at = |x: f64, z: f64| Plant::level(DVec3::new(x, 0.0, z), 0.0);
        let step =
            |side, lift: f64, from, to| Step { kind: StepKind::Corrective, side, lift, land: lift + 0.3, from, to };
        let start = [at(0.09, 0.0), at(-0.09, 0.0)];
        let crossed = |z: f64| {
            let mut steps = [
                step(Side::Right, 0.1, start[1], at(0.27, z)),
                step(Side::Left, 0.5, start[0], at(0.45, z)),
                step(Side::Right, 0.9, at(0.27, z), at(0.26, z)),
            ];
            roomier(&crate::measure::fixture::body(), &Terrain::flat(), &start, &mut steps, &physique);
            steps
        };
        let steps = crossed(0.20);
        let room = CROSSES[1] * physique.leg_length;
        assert!((steps[0].to.ankle.z - room).abs() < 1e-9 && steps[2].from == steps[0].to, "{:?}", steps[0]);
        assert!(steps[1].to == at(0.45, 0.20) && steps[2].to == at(0.26, 0.20), "beside each other feet need none");
        assert!((crossed(-0.22)[0].to.ankle.z + room).abs() < 1e-9, "behind the other likewise");
        assert!(crossed(0.10)[0].to == at(0.27, 0.10), "nothing is moved far");
    }
}

//! One foot as an exact function of time: flat, heel off, swing, heel or ball strike, flat. Metres, radians, in the ground's frame.
//!
//! A foot is flat on the plane of its plant. In contact it turns about a point that does not move (ball: the toe joint; heel: the
//! rearmost sole point), and in the air that same pivot flies from plant to plant: so nothing slides, and position and speed are
//! continuous at lift. Pitch is positive with the heel up. Where a rig has no toes the foot turns about the tip of its sole.

use super::clearance::{self, Raise};
use super::contacts::FootContact;
use super::heels::{Heel, MOST_PITCH as MOST_RAISED};
use super::swing::{Extra, Swing};
use crate::maths::curve::{bump, smooth3, trapezoid};
use crate::maths::quat::wrap_angle;
use crate::maths::real;
use crate::model::scenario::GroundKind;
use crate::model::{Body, Side, Terrain, report::Part};
use crate::stepper::{Physique, Plant, Step};
use crate::whole_body::solve::FootTarget;
use glam::{DQuat, DVec2, DVec3};

/// m, from which height on a step is one of stairs.
const STAIR: f64 = 0.05;
/// Moments of a swing at which the ground under it is looked at, and m that it may be off a plane: what a millimetre's raise is not worth.
const LOOKS: u32 = 16;
const PLANE: f64 = 1e-3;
/// Part of the leg: a foot that goes down a riser by more leaves it with its heel down, or the leg folds up behind.
const MOST_DOWN: f64 = 0.5;
/// rad, how far the heel of a foot in contact comes up at most.
pub(super) const MOST_PITCH: f64 = 45.0 * std::f64::consts::PI / 180.0;
/// rad, the farthest that a foot turns out of its curve for its ankle.
const MOST_EXTRA: f64 = 40.0 * std::f64::consts::PI / 180.0;
/// Part of a swing in which toes take up the roll of their foot.
const TOES_ROLL: f64 = 0.25;
/// m, by which the edge of a sole that rolls may sink, and the roll (rad) that may cost it.
const EDGE_SINK: f64 = 0.0025;
/// rad.
const EDGE_ROLL: f64 = 3.0 * std::f64::consts::PI / 180.0;

/// One foot.
#[derive(Clone, Debug)]
pub(super) struct FootPath {
    start: Plant,
    pub(super) still_until: f64, // s, no heel comes up before
    pub(super) swings: Vec<Swing>,
    level: DQuat,              // turn from rest that levels the sole, pointing along rest_yaw
    toe_level: DQuat,          // the same for the toes
    rest_yaw: f64,             // rad
    pivot: DVec3,              // toe joint (or tip) from the ankle, levelled, foot pointing along +Z
    heel: DVec3,               // rearmost sole point likewise
    soles: Vec<(DVec3, bool)>, // levelled sole vertices from the ankle, and whether they move with the toes
    ankle_height: f64,         // m
    leg: f64,                  // m
    has_toe: bool,
    pub(super) extra: Extra,
    pub(super) raised: Heel,
}

impl FootPath {
    pub(super) fn new(
        body: &Body,
        physique: &Physique,
        side: Side,
        start: &[Plant; 2],
        steps: &[Step],
        still_until: f64,
        scale: f64,
    ) -> FootPath {
        let shape = &body.feet[side as usize];
        let rest_yaw = real::atan2(shape.forward.x, shape.forward.y);
        let levelled = |offset: DVec3| DQuat::from_rotation_y(-rest_yaw) * (shape.level * offset);
        let pivot = match shape.toe {
            Some(toe) => levelled(body.joints[toe].rest - body.joints[shape.ankle].rest),
            None => DVec3::new(0.0, -shape.ankle_height, shape.tip),
        };
        let mut soles: Vec<(DVec3, bool)> = shape.rear_sole.iter().map(|vertex| (levelled(*vertex), false)).collect();
        let yaw_away = DQuat::from_rotation_y(-rest_yaw);
        soles.extend(shape.front_sole.iter().map(|vertex| match shape.toe {
            Some(toe) => {
                let joint = body.joints[toe].rest - body.joints[shape.ankle].rest;
                (levelled(joint) + yaw_away * (shape.toe_level * (*vertex - joint)), true)
            }
            None => (levelled(*vertex), false),
        }));
        let mut path = FootPath {
            start: start[side as usize],
            still_until,
            swings: Vec::new(),
            level: shape.level,
            toe_level: shape.toe_level,
            rest_yaw,
            pivot,
            heel: levelled(shape.heel_point()),
            soles,
            ankle_height: shape.ankle_height,
            leg: physique.leg_length,
            has_toe: shape.toe.is_some(),
            extra: Extra::default(),
            raised: Heel::default(),
        };
        let own: Vec<&Step> = steps.iter().filter(|step| step.side == side).collect();
        for (index, step) in own.iter().enumerate() {
            // s, how long before its lift the heel may come up: not before anybody pushed, nor just after it came down.
            let room = match index.checked_sub(1) {
                Some(previous) => 0.4 * (step.lift - own[previous].land),
                None => step.lift - still_until,
            };
            let after = own.get(index + 1).map_or(f64::INFINITY, |next| next.lift);
            let other = plant_at(start, steps, side.other(), 0.5 * (step.lift + step.land));
            path.swings.push(Swing::new(step, room.max(0.0), after, &other, physique, scale));
        }
        path
    }

    /// The foot with its ankle there; `foot` and `toe` are turns of the levelled foot that points along +Z.
    fn pose(&self, ankle: DVec3, yaw: f64, foot: DQuat, toe: DQuat) -> FootTarget {
        let from_rest = DQuat::from_rotation_y(-self.rest_yaw);
        FootTarget {
            ankle,
            foot: foot * from_rest * self.level,
            toe: toe * from_rest * self.toe_level,
            yaw,
            soft: 0.0,
            bend: None,
            swivel: 0.0,
        }
    }

    fn flat_ankle(&self, plant: &Plant) -> DVec3 {
        plant.ankle + plant.normal * self.ankle_height
    }

    /// In the ground's frame.
    pub(super) fn at(&self, time: f64, terrain: &Terrain) -> FootTarget {
        let up = self.raised.at(time);
        let flat = |plant: &Plant| {
            let level = turned(plant, 0.0);
            if up <= 0.0 {
                return self.pose(self.flat_ankle(plant), plant.yaw, level, level);
            }
            let turn = turned(plant, up);
            let ankle = self.flat_ankle(plant) + level * self.pivot - turn * self.pivot;
            self.pose(ankle, plant.yaw, turn, if self.has_toe { level } else { turn })
        };
        let Some(swing) = self.swings.iter().rev().find(|swing| time > swing.lift - swing.heel_off) else {
            return flat(&self.start);
        };
        if time >= swing.land + swing.settle {
            return flat(&swing.to);
        }
        let [pitch, roll] = self.extra.at(time);
        let pitch = swing.pitch(time) + pitch + up;
        let on = |plant: &Plant, held: DVec3, toes_flat: bool| {
            let level = turned(plant, 0.0);
            let turn = turned(plant, pitch) * DQuat::from_rotation_z(roll);
            let ankle = self.flat_ankle(plant) + level * held - turn * held;
            self.pose(ankle, plant.yaw, turn, if toes_flat { level } else { turn })
        };
        if time <= swing.lift {
            on(&swing.from, self.pivot, true)
        } else if time < swing.land {
            self.flight(swing, time, terrain)
        } else if swing.strike < 0.0 {
            on(&swing.to, self.heel, false)
        } else {
            on(&swing.to, self.pivot, true)
        }
    }

    /// The extra turns that no contact forbids.
    pub(super) fn room(&self, time: f64, dt: f64) -> [[f64; 2]; 2] {
        const NONE: [[f64; 2]; 2] = [[0.0; 2]; 2];
        let Some(swing) = self.swings.iter().rev().find(|swing| time > swing.lift - swing.heel_off) else {
            return NONE;
        };
        let flat_from = if swing.strike == 0.0 { swing.land } else { swing.land + swing.settle };
        if time <= swing.lift - swing.heel_off + dt || time >= flat_from - dt {
            return NONE;
        }
        let pitch = swing.pitch(time);
        if time > swing.lift && time < swing.land {
            let free = [-MOST_EXTRA, MOST_EXTRA];
            return [free, free];
        }
        if time >= swing.land && swing.strike < 0.0 {
            return [[0.0; 2], self.rolls(self.heel, pitch)];
        }
        // A foot that its turn lays flatter rolls less.
        let turned = (pitch + self.extra.at(time)[0]).clamp(0.0, pitch.max(0.0));
        [[-pitch.max(0.0), (MOST_PITCH - pitch).max(0.0)], self.rolls(self.pivot, turned)]
    }

    /// rad, the pitch that a foot has then on its ball or flat beside what its heel is up for its ankle, `Some(None)` in the air; `None` on its
    /// heel, which stays down. `dt`: s that it stays away from there.
    pub(super) fn heel_room(&self, time: f64, dt: f64) -> Option<Option<f64>> {
        let Some(swing) = self.swings.iter().rev().find(|swing| time > swing.lift - swing.heel_off) else {
            return Some(Some(0.0));
        };
        let next = self.swings.iter().find(|swing| time < swing.land);
        if next.is_some_and(|next| risen(next) < -MOST_DOWN * self.leg) {
            return None;
        }
        if swing.strike < 0.0 && time > swing.land - dt && time < swing.land + swing.settle + dt {
            None
        } else if time > swing.lift && time < swing.land {
            Some(None)
        } else if time >= swing.land + swing.settle {
            Some(Some(0.0))
        } else {
            Some(Some(swing.pitch(time) + self.extra.at(time)[0]))
        }
    }

    /// rad, the pitch that a foot in the air has then, and how much of its way is behind it, from 0 to 1.
    pub(super) fn aloft(&self, time: f64) -> (f64, f64) {
        let swing = self.swings.iter().rev().find(|swing| time > swing.lift);
        swing.map_or((0.0, 0.0), |swing| (swing.pitch(time) + self.extra.at(time)[0], swing.along(time)))
    }

    /// How far the foot rolls either way about a point of it before its sole's edge sinks too deep.
    fn rolls(&self, about: DVec3, pitch: f64) -> [f64; 2] {
        let most = |way: f64| {
            let deep = |roll: f64| {
                let turn = DQuat::from_rotation_x(pitch) * DQuat::from_rotation_z(way * roll);
                let own = self.soles.iter().filter(|(_, with_toe)| !with_toe);
                own.map(|(vertex, _)| (turn * (*vertex - about)).y).fold(f64::INFINITY, f64::min)
            };
            let floor = deep(0.0).min(-self.ankle_height - about.y) - EDGE_SINK;
            let (mut low, mut high) = (0.0, MOST_EXTRA);
            for _ in 0..8 {
                let middle = 0.5 * (low + high);
                if deep(middle) < floor { high = middle } else { low = middle }
            }
            low
        };
        [-most(-1.0), most(1.0)]
    }

    /// In the air: no part of the sole goes under the ground on the way.
    fn flight(&self, swing: &Swing, time: f64, terrain: &Terrain) -> FootTarget {
        let mut target = self.flown(swing, time, terrain);
        // Edges and bumps are cleared by the raise; of a mesh's it may leave a centimetre.
        if !matches!(terrain.kind, GroundKind::Stairs { .. } | GroundKind::Uneven { .. }) {
            let roll = self.extra.at(time)[1];
            let mut points = Vec::with_capacity(self.soles.len());
            self.sole_points(&target, &mut points);
            let over = |point: &DVec3| point.y - terrain.spot(DVec2::new(point.x, point.z)).height;
            let lowest = points.iter().map(over).fold(f64::INFINITY, f64::min);
            target.ankle.y += (-lowest - EDGE_SINK.min(EDGE_SINK * roll.abs() / EDGE_ROLL)).max(0.0);
        }
        target
    }

    /// The same whatever the ground under it.
    pub(super) fn flown(&self, swing: &Swing, time: f64, terrain: &Terrain) -> FootTarget {
        let u = swing.along(time);
        let [extra, roll] = self.extra.at(time);
        let raised = self.raised.at(time);
        let pitch = swing.pitch(time) + extra + raised;
        let rolled = DQuat::from_rotation_z(roll);
        let go = trapezoid(u);
        let yaw = swing.from.yaw + wrap_angle(swing.to.yaw - swing.from.yaw) * go;
        let first = self.flat_ankle(&swing.from) + turned(&swing.from, 0.0) * self.pivot;
        let level = turned(&swing.to, 0.0);
        let last = self.flat_ankle(&swing.to)
            + if swing.strike < 0.0 {
                let rolled = DQuat::from_rotation_z(self.extra.at(swing.land)[1]);
                level * self.heel + turned(&swing.to, swing.landing_pitch(time)) * rolled * (self.pivot - self.heel)
            } else {
                level * self.pivot
            };
        let (over, up) = match terrain.kind {
            GroundKind::Stairs { .. } if (last.y - first.y).abs() > STAIR => {
                clearance::stair(u, last.y > first.y).into()
            }
            GroundKind::Mesh { .. } if risen(swing).abs() > STAIR => clearance::stair(u, risen(swing) > 0.0).into(),
            _ => (go, go),
        };
        let mut pivot = first + (last - first) * DVec3::new(over, up, over) + swing.aside * bump(u);
        pivot.y += swing.clearance * bump(u + 0.2 * u * (1.0 - u));
        pivot.y += swing.raise.at(u);
        // The toes straighten over most of the swing, and are flat again for a strike with the ball.
        let mut straight = smooth3(u / 0.8);
        if swing.strike >= 0.0 {
            // A foot that lands with its heel as high as it left hardly straightens them.
            straight *= (1.0 - smooth3((u - 0.4) / 0.6)) * (1.0 - swing.strike / swing.peak.max(swing.strike + 1e-9));
        }
        let normal = swing.from.normal.lerp(swing.to.normal, go).normalize_or(DVec3::Y);
        let between = Plant { ankle: pivot, yaw, normal };
        let turn = turned(&between, pitch) * rolled;
        // Toes lie flat as they leave, and where they land first.
        let lands = if swing.strike < 0.0 { 1.0 } else { smooth3((1.0 - u) / TOES_ROLL) };
        let toes_rolled = DQuat::from_rotation_z(roll * smooth3(u / TOES_ROLL) * lands);
        let toes = if raised > 0.0 { (pitch * straight).max(pitch - MOST_RAISED) } else { pitch * straight };
        let toe = if self.has_toe { turned(&between, toes) * toes_rolled } else { turn };
        let ankle = pivot - turn * self.pivot;
        let mut target = self.pose(ankle, yaw, turn, toe);
        target.soft = bump(u).sqrt();
        target
    }

    /// Is the ground under a swing the plane of both its plants? Then nothing is in the way.
    pub(super) fn over_a_plane(&self, swing: &Swing, terrain: &Terrain) -> bool {
        let mut points = Vec::with_capacity(self.soles.len());
        let off = |point: &DVec3, plant: &Plant| {
            let spot = terrain.spot(DVec2::new(point.x, point.z));
            let from = DVec3::new(point.x, spot.height, point.z) - plant.ankle;
            if spot.holds { from.dot(plant.normal).abs() } else { f64::INFINITY }
        };
        (0..=LOOKS).all(|index| {
            let u = f64::from(index) / f64::from(LOOKS);
            let flown = Swing { raise: Raise::NONE, ..*swing };
            self.sole_points(&self.flown(&flown, swing.lift + (swing.land - swing.lift) * u, terrain), &mut points);
            points.iter().all(|point| off(point, &swing.from) < PLANE && off(point, &swing.to) < PLANE)
        })
    }

    /// m, the sole's vertices of a target.
    pub(super) fn sole_points(&self, target: &FootTarget, points: &mut Vec<DVec3>) {
        let rest = DQuat::from_rotation_y(self.rest_yaw);
        let foot = target.foot * self.level.inverse() * rest;
        let toe = target.toe * self.toe_level.inverse() * rest;
        let pivot = target.ankle + foot * self.pivot;
        points.clear();
        points.extend(self.soles.iter().map(|(vertex, with_toe)| match with_toe {
            true => pivot + toe * (*vertex - self.pivot),
            false => target.ankle + foot * *vertex,
        }));
    }

    pub(super) fn contacts(&self, side: Side, end: f64, contacts: &mut Vec<FootContact>) {
        let mut push = |part, start: f64, stop: f64, plant: Plant| {
            let stop = stop.min(end);
            if stop - start > 1e-6 {
                // A ball that holds on as the heel comes up or goes down holds once.
                let last = contacts.last_mut().filter(|last| {
                    self.raised.is_up() && last.side == side && last.part == part && start - last.end < 1e-6
                });
                match last {
                    Some(last) => last.end = stop,
                    None => contacts.push(FootContact { side, part, start, end: stop, plant }),
                }
            }
        };
        let flat = |push: &mut dyn FnMut(Part, f64, f64, Plant), from: f64, to: f64, plant: Plant| {
            let mut at = from;
            for [start, stop] in self.raised.spans(from, to) {
                push(Part::Flat, at, start, plant);
                push(Part::Ball, start, stop, plant);
                at = stop;
            }
            push(Part::Flat, at, to, plant);
        };
        let mut flat_from = 0.0;
        let mut plant = self.start;
        for swing in &self.swings {
            flat(&mut push, flat_from, swing.lift - swing.heel_off, plant);
            push(Part::Ball, swing.lift - swing.heel_off, swing.lift, plant);
            plant = swing.to;
            let part = if swing.strike < 0.0 { Part::Heel } else { Part::Ball };
            flat_from = if swing.strike == 0.0 { swing.land } else { swing.land + swing.settle };
            push(part, swing.land, flat_from, plant);
        }
        flat(&mut push, flat_from, end, plant);
    }
}

/// m, by how much a swing goes up beyond what the planes of its plants say: over a riser and not along a slope.
fn risen(swing: &Swing) -> f64 {
    let way = swing.to.ankle - swing.from.ankle;
    let grade = |plant: &Plant| -(plant.normal.x * way.x + plant.normal.z * way.z) / plant.normal.y.max(0.1);
    way.y - 0.5 * (grade(&swing.from) + grade(&swing.to))
}

/// The levelled foot that points along +Z, set on the plane of a plant and pitched, rad.
pub(super) fn turned(plant: &Plant, pitch: f64) -> DQuat {
    tilt(plant.normal) * DQuat::from_rotation_y(plant.yaw) * DQuat::from_rotation_x(pitch)
}

/// From level to a plane with that normal.
fn tilt(normal: DVec3) -> DQuat {
    if normal == DVec3::Y { DQuat::IDENTITY } else { DQuat::from_rotation_arc(DVec3::Y, normal) }
}

/// Where a foot stands (or will land) at a time.
fn plant_at(start: &[Plant; 2], steps: &[Step], side: Side, time: f64) -> Plant {
    steps.iter().rev().find(|step| step.side == side && step.lift <= time).map_or(start[side as usize], |step| step.to)
}

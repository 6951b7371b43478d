//! Feet as exact functions of time: flat, heel off, swing, heel or ball strike, flat. Scenario space, metres, radians.
//!
//! A foot in contact turns about a point that does not move (ball: the toe joint; heel: the rearmost sole point), and in
//! the air that same pivot flies from plant to plant: so nothing slides, and position and speed are continuous at lift.
//! Pitch is positive with the heel up. Where a rig has no toes the foot turns about the tip of its sole. Flat ground.

use super::contacts::FootContact;
use crate::maths::curve::{bump, smooth3, smooth5, trapezoid};
use crate::maths::quat::wrap_angle;
use crate::model::{Body, Side, report::Part};
use crate::stepper::{Physique, Plant, Step, StepKind};
use crate::whole_body::Anatomy;
use crate::whole_body::solve::{FootTarget, Solved};
use glam::{DQuat, DVec2, DVec3};

/// rad/s, mean speed at which a heel comes up (a smaller body's too, frames being what they are): faster, and toes and
/// ankle snap.
const FASTEST_ROLL: f64 = 1.05;
/// s, by how much a heel that lands after its ball begins to come down before the ball lands.
const LEAD: f64 = 0.05;

/// rad, dorsiflexion past which the heel comes up: a little inside of the ankle's range of 30 degrees.
const DORSIFLEXION: f64 = 26.0 * std::f64::consts::PI / 180.0;
/// s, the longest that a foot stays on its ball after landing: longer, and the weight behind it has nothing to stand on.
const LONGEST_SETTLE: f64 = 0.16;
/// Part of the way from ankle to ball that the pressure must be past before the heel may rise early.
const WEIGHT_AHEAD: f64 = 0.6;
/// rad, dorsiflexion with which a foot may land.
const LANDING_FLEXION: f64 = 16.0 * std::f64::consts::PI / 180.0;
/// rad.
const MOST_PITCH: f64 = 45.0 * std::f64::consts::PI / 180.0;

/// Both feet over a whole run.
#[derive(Clone, Debug)]
pub struct FootCurves {
    feet: [FootPath; 2],
}

/// One foot.
#[derive(Clone, Debug)]
struct FootPath {
    start: Plant,
    still_until: f64, // s, no heel comes up before
    swings: Vec<Swing>,
    level: DQuat,              // turn from rest that levels the sole, pointing along rest_yaw
    toe_level: DQuat,          // the same for the toes
    rest_yaw: f64,             // rad
    pivot: DVec3,              // toe joint (or tip) from the ankle, levelled, foot pointing along +Z
    heel: DVec3,               // rearmost sole point likewise
    soles: Vec<(DVec3, bool)>, // levelled sole vertices from the ankle, and whether they move with the toes
    ankle_height: f64,         // m
    has_toe: bool,
}

/// A step with its roll. Times in s.
#[derive(Clone, Copy, Debug)]
struct Swing {
    lift: f64,
    land: f64,
    heel_off: f64, // how long before `lift` the heel comes up
    settle: f64,   // how long after `land` the foot is flat
    peak_after: f64,
    peak: f64,    // rad, largest pitch, a little after lift
    strike: f64,  // rad, pitch at landing: below 0 heel first, over 0 ball first
    onward: bool, // it goes forwards: the weight is on the ball before it leaves
    clearance: f64,
    aside: DVec3, // horizontal detour at mid-swing, m
    from: Plant,
    to: Plant,
}

impl FootCurves {
    /// From the steps that were taken. `still_until`: no heel comes up before (s). `scale`: times relative to the
    /// reference body.
    pub fn new(
        body: &Body,
        physique: &Physique,
        start: &[Plant; 2],
        steps: &[Step],
        still_until: f64,
        scale: f64,
    ) -> FootCurves {
        let feet = Side::BOTH.map(|side| FootPath::new(body, physique, side, start, steps, still_until, scale));
        FootCurves { feet }
    }

    /// Where a foot is.
    pub fn at(&self, side: Side, time: f64) -> FootTarget {
        self.feet[side as usize].at(time)
    }

    /// How free a foot is to leave its curve: 0 planted, 1 in mid-swing.
    pub fn freedom(&self, side: Side, time: f64) -> f64 {
        let path = &self.feet[side as usize];
        path.swings
            .iter()
            .find(|swing| time > swing.lift && time < swing.land)
            .map_or(0.0, |swing| bump((time - swing.lift) / (swing.land - swing.lift)).sqrt())
    }

    /// s since the foot last landed; infinite before its first step.
    pub fn since_landing(&self, side: Side, time: f64) -> f64 {
        let swings = &self.feet[side as usize].swings;
        swings.iter().rev().find(|swing| swing.land <= time).map_or(f64::INFINITY, |swing| time - swing.land)
    }

    /// Lets heels come up (and stay up after a backward landing) where an ankle would bend past its range.
    /// `solved`: the poses of the present curves, `dt` s apart; `cop`: the centre of pressure then, (x, z). Call it a few times over.
    pub fn ease_ankles(&mut self, body: &Body, anatomy: &Anatomy, solved: &[Solved], cop: &[DVec2], dt: f64) {
        for side in Side::BOTH {
            let leg = &anatomy.legs[side as usize];
            let shank = body.joints[leg.lower].rest - body.joints[leg.foot].rest;
            let path = &mut self.feet[side as usize];
            // rad, how far the shank leans forwards over the foot.
            let lean = |index: usize, yaw: f64| {
                let up = DQuat::from_rotation_y(-yaw) * (solved[index].pose.turns[leg.lower] * shank);
                up.z.atan2(up.y)
            };
            // m, how far the pressure is ahead of the middle of a foot's ball: a heel under the weight stays down.
            let ball = body.feet[side as usize].ball;
            let ahead = |index: usize, plant: &Plant| {
                let from_ankle = cop[index.min(cop.len() - 1)] - DVec2::new(plant.ankle.x, plant.ankle.z);
                from_ankle.dot(DVec2::new(plant.yaw.sin(), plant.yaw.cos())) - WEIGHT_AHEAD * ball
            };
            for number in 0..path.swings.len() {
                let before = number
                    .checked_sub(1)
                    .map_or(path.still_until, |last| path.swings[last].land + path.swings[last].settle);
                let after = path.swings.get(number + 1).map_or(f64::INFINITY, |next| next.lift - next.heel_off);
                let ticks = |from: f64, to: f64| {
                    let last = ((to / dt).floor().max(0.0) as usize).min(solved.len().saturating_sub(1));
                    (from / dt).ceil().max(0.0) as usize..=last
                };
                let swing = &mut path.swings[number];
                for index in ticks(before, swing.lift) {
                    let time = index as f64 * dt;
                    let forwards = lean(index, swing.from.yaw);
                    let pitch = swing.pitch(time);
                    if swing.onward && ahead(index, &swing.from) > 0.0 && forwards - pitch > DORSIFLEXION {
                        swing.heel_off = swing.heel_off.max((swing.lift - time + 0.05).min(swing.lift - before));
                        swing.peak = swing.peak.max((forwards - DORSIFLEXION + 0.10).min(MOST_PITCH));
                    }
                }
                // The leg lands as its shank leans: reaching ahead heel first, under the body flat, behind it ball first.
                let landing = *ticks(swing.land, swing.land).end();
                let least = lean(landing, swing.to.yaw) - LANDING_FLEXION;
                if swing.strike < least {
                    swing.strike = if least.abs() < 2_f64.to_radians() { 0.0 } else { least.min(MOST_PITCH) };
                }
                if swing.strike >= 0.0 {
                    for index in ticks(swing.land, (swing.land + 0.6).min(after)) {
                        let time = index as f64 * dt;
                        let excess = lean(index, swing.to.yaw) - swing.pitch(time) - DORSIFLEXION;
                        if excess > 0.0 {
                            swing.strike = (swing.strike + 0.5 * excess).min(MOST_PITCH);
                            swing.settle = swing
                                .settle
                                .max((time - swing.land + 0.04).min(after - swing.land).min(LONGEST_SETTLE));
                        }
                    }
                }
            }
        }
    }

    /// All contacts up to `end`, in order of start, left before right.
    pub fn contacts(&self, end: f64) -> Vec<FootContact> {
        let mut contacts = Vec::new();
        for side in Side::BOTH {
            self.feet[side as usize].contacts(side, end, &mut contacts);
        }
        contacts.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.side.cmp(&b.side)));
        contacts
    }
}

impl FootPath {
    fn new(
        body: &Body,
        physique: &Physique,
        side: Side,
        start: &[Plant; 2],
        steps: &[Step],
        still_until: f64,
        scale: f64,
    ) -> FootPath {
        let shape = &body.feet[side as usize];
        let rest_yaw = shape.forward.x.atan2(shape.forward.y);
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
            has_toe: shape.toe.is_some(),
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
        }
    }

    fn flat_ankle(&self, plant: &Plant) -> DVec3 {
        plant.ankle + DVec3::Y * self.ankle_height
    }

    fn at(&self, time: f64) -> FootTarget {
        let flat = |plant: &Plant| {
            let turn = turned(plant.yaw, 0.0);
            self.pose(self.flat_ankle(plant), plant.yaw, turn, turn)
        };
        let Some(swing) = self.swings.iter().rev().find(|swing| time > swing.lift - swing.heel_off) else {
            return flat(&self.start);
        };
        if time >= swing.land + swing.settle {
            return flat(&swing.to);
        }
        let pitch = swing.pitch(time);
        let on = |plant: &Plant, held: DVec3, toes_flat: bool| {
            let level = turned(plant.yaw, 0.0);
            let turn = turned(plant.yaw, pitch);
            let ankle = self.flat_ankle(plant) + level * held - turn * held;
            self.pose(ankle, plant.yaw, turn, if toes_flat { level } else { turn })
        };
        if time <= swing.lift {
            on(&swing.from, self.pivot, true)
        } else if time < swing.land {
            self.flight(swing, time, pitch)
        } else if swing.strike < 0.0 {
            on(&swing.to, self.heel, false)
        } else {
            on(&swing.to, self.pivot, true)
        }
    }

    fn flight(&self, swing: &Swing, time: f64, pitch: f64) -> FootTarget {
        let u = (time - swing.lift) / (swing.land - swing.lift);
        let go = trapezoid(u);
        let yaw = swing.from.yaw + wrap_angle(swing.to.yaw - swing.from.yaw) * go;
        let first = self.flat_ankle(&swing.from) + turned(swing.from.yaw, 0.0) * self.pivot;
        let level = turned(swing.to.yaw, 0.0);
        let last = self.flat_ankle(&swing.to)
            + if swing.strike < 0.0 {
                level * self.heel + turned(swing.to.yaw, swing.strike) * (self.pivot - self.heel)
            } else {
                level * self.pivot
            };
        let mut pivot = first + (last - first) * go + swing.aside * bump(u);
        pivot.y += swing.clearance * bump(u + 0.2 * u * (1.0 - u));
        // The toes straighten over most of the swing, and are flat again for a strike with the ball.
        let mut straight = smooth3(u / 0.85);
        if swing.strike >= 0.0 {
            // A foot that lands with its heel as high as it left hardly straightens them.
            straight *= (1.0 - smooth3((u - 0.4) / 0.6)) * (1.0 - swing.strike / swing.peak.max(swing.strike + 1e-9));
        }
        let turn = turned(yaw, pitch);
        let toe = if self.has_toe { turned(yaw, pitch * straight) } else { turn };
        let ankle = pivot - turn * self.pivot;
        let mut target = self.pose(ankle, yaw, turn, toe);
        // No part of the sole goes under the ground on the way.
        let lowest = self
            .soles
            .iter()
            .map(
                |(vertex, with_toe)| {
                    if *with_toe { pivot.y + (toe * (*vertex - self.pivot)).y } else { ankle.y + (turn * *vertex).y }
                },
            )
            .fold(f64::INFINITY, f64::min);
        target.ankle.y += (-lowest).max(0.0);
        target.soft = bump(u).sqrt();
        target
    }

    fn contacts(&self, side: Side, end: f64, contacts: &mut Vec<FootContact>) {
        let mut push = |part, start: f64, stop: f64, plant: Plant| {
            let stop = stop.min(end);
            if stop - start > 1e-6 {
                contacts.push(FootContact { side, part, start, end: stop, plant });
            }
        };
        let mut flat_from = 0.0;
        let mut plant = self.start;
        for swing in &self.swings {
            push(Part::Flat, flat_from, swing.lift - swing.heel_off, plant);
            push(Part::Ball, swing.lift - swing.heel_off, swing.lift, plant);
            plant = swing.to;
            let part = if swing.strike < 0.0 { Part::Heel } else { Part::Ball };
            flat_from = if swing.strike == 0.0 { swing.land } else { swing.land + swing.settle };
            push(part, swing.land, flat_from, plant);
        }
        push(Part::Flat, flat_from, end, plant);
    }
}

impl Swing {
    /// Chooses the roll of a step: `room` bounds the time of the heel's rise, `after` is the foot's next lift, `other` the stance foot.
    fn new(step: &Step, room: f64, after: f64, other: &Plant, physique: &Physique, scale: f64) -> Swing {
        let travel = step.to.ankle - step.from.ankle;
        let yaw = 0.5 * (step.from.yaw + step.to.yaw);
        let leg = physique.leg_length;
        let forward = (travel.x * yaw.sin() + travel.z * yaw.cos()) / leg;
        let distance = travel.length() / leg;
        let calm = step.kind == StepKind::Comfort;
        let duration = step.land - step.lift;
        // Forwards the foot rolls off its toes; sideways and back it is picked up.
        let peak =
            if calm { 14.0 } else { 12.0 + 40.0 * forward.clamp(0.0, 0.8) + 8.0 * (distance - forward.abs()).max(0.0) };
        // A foot that is to go back has the weight on its heel: it is picked up flat.
        let backward = (-forward / 0.15).clamp(0.0, 1.0);
        let peak = peak + (9.0 - peak) * backward;
        let heel_off = (1.0 - 0.35 * backward)
            * ((if calm { 0.15 } else { 0.13 + 0.05 * forward.clamp(0.0, 1.0) }) * scale).min(room);
        let peak_after = (0.085 * scale).min(0.3 * duration);
        let strike = if forward > 0.12 {
            -(30.0 * (forward - 0.05)).min(18.0)
        } else if forward < -0.10 {
            (40.0 * (-forward - 0.05)).min(12.0)
        } else {
            0.0
        };
        // Flat again two or three frames after landing; from the ball a little later.
        let settle = ((if strike > 0.0 { 0.15 } else { 0.085 }) * scale).min(0.35 * (after - step.land).max(0.0));
        Swing {
            lift: step.lift,
            land: step.land,
            heel_off,
            settle,
            peak_after,
            onward: forward > 0.1,
            peak: peak.to_radians().min(FASTEST_ROLL / scale.max(1.0) * (heel_off + peak_after)),
            strike: strike.to_radians(),
            clearance: leg * (0.045 + 0.05 * distance.min(1.0)),
            aside: detour(step, other, physique),
            from: step.from,
            to: step.to,
        }
    }

    /// Pitch that the heel's rise alone gives.
    fn rise(&self, time: f64) -> f64 {
        self.peak * smooth5((time - self.lift + self.heel_off) / (self.heel_off + self.peak_after))
    }

    /// Pitch at a time between heel off and flat.
    fn pitch(&self, time: f64) -> f64 {
        let (start, top) = (self.lift - self.heel_off, self.lift + self.peak_after);
        if time <= start {
            0.0
        } else if time <= top && (self.strike <= self.peak || time <= self.lift) {
            self.rise(time)
        } else {
            let turn = self.land - if self.strike > 0.0 { LEAD.min(0.25 * (self.land - top)) } else { 0.0 };
            if time <= turn {
                let more = self.strike - self.peak;
                if more > 0.0 {
                    // A heel that lands higher than it left rises all the way.
                    self.rise(time) + more * smooth3((time - self.lift) / (turn - self.lift))
                } else {
                    self.peak + more * smooth5((time - top) / (turn - top))
                }
            } else {
                self.strike * (1.0 - smooth3((time - turn) / (self.land - turn + self.settle).max(1e-9)))
            }
        }
    }
}

/// A levelled foot that points along +Z, turned to a heading and pitched, rad.
fn turned(yaw: f64, pitch: f64) -> DQuat {
    DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(pitch)
}

/// How far the path bends away from a stance foot that stands near it: at least 0.14 leg lengths of gap, m.
fn detour(step: &Step, other: &Plant, physique: &Physique) -> DVec3 {
    let (from, to) = (step.from.ankle, step.to.ankle);
    let path = DVec3::new(to.x - from.x, 0.0, to.z - from.z);
    let length = path.length();
    if length < 1e-6 {
        return DVec3::ZERO;
    }
    let along = path / length;
    let across = DVec3::new(along.z, 0.0, -along.x);
    let rel = other.ankle - from;
    let u = rel.dot(along) / length;
    if !(0.1..=0.9).contains(&u) {
        return DVec3::ZERO;
    }
    let gap = -rel.dot(across); // where the path lies from the stance foot, along `across`
    // A foot that passes ahead of the other (or behind it) must clear its length, not its width alone.
    let lengthwise = across.dot(DVec3::new(other.yaw.sin(), 0.0, other.yaw.cos())).abs();
    let least = (0.15 * physique.leg_length).max(0.14 * physique.leg_length + physique.tip * lengthwise);
    // Keep to the side of the stance foot where the swing foot belongs.
    let own = step.side.sign() * across.dot(DVec3::new(other.yaw.cos(), 0.0, -other.yaw.sin())).signum();
    let sign = if gap.abs() > 0.02 * physique.leg_length { gap.signum() } else { own };
    let missing = least - gap * sign;
    if missing > 0.0 { across * (sign * missing / bump(u).max(0.3)) } else { DVec3::ZERO }
}

/// Where a foot stands (or will land) at a time.
fn plant_at(start: &[Plant; 2], steps: &[Step], side: Side, time: f64) -> Plant {
    steps.iter().rev().find(|step| step.side == side && step.lift <= time).map_or(start[side as usize], |step| step.to)
}

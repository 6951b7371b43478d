//! A foot of a clip beside its run: what it holds still while it stands, and how it comes there and goes from there.
//!
//! The ground's frame, m, rad, s. In a contact the foot is where the contact says; before and after, what it differs by from the run
//! comes and goes within a moment, without a jump in place or speed.

use super::super::contacts::FootContact;
use super::leg::Foot;
use crate::maths::quat::rotation_vector;
use crate::measure::support::held_points;
use crate::model::{Body, Plant, Side, report::Part};
use glam::{DQuat, DVec3};

/// s, in which a held foot comes to where it is held, and goes on from there.
pub(super) const FADES: f64 = 0.05;
/// rad that the toes of a foot that is held flat may be beside the run's: a little under what any joint may.
const TOES: f64 = 1.5 * std::f64::consts::PI / 180.0;
/// s, to either side of a contact's end: what tells how fast the run moves there.
const SLOPE: f64 = 2e-3;

/// What a foot holds from one tick to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hold {
    pub(super) part: Part,
    pub(super) from: usize,
    pub(super) to: usize,
    /// Where the foot stands flat: at the time, before it or after.
    pub(super) plant: Plant,
    /// As it stands flat.
    pub(super) flat: Foot,
    /// m, the point that a ball or a heel holds.
    pub(super) point: DVec3,
    lead: Ease,
    trail: Ease,
}

/// What a foot differs by from its run at an end of a contact, and how fast that changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ease {
    place: [DVec3; 2], // m, m/s; ankle
    foot: [DVec3; 2],  // rad, rad/s
    toe: [DVec3; 2],
    over: [f64; 2], // s, for the place and for the turns
}

/// A foot and what it holds, rising in time.
#[derive(Clone, Debug)]
pub(super) struct Held {
    holds: Vec<Hold>,
    dt: f64,
    offsets: [DVec3; 2], // m at rest, from the ankle to the points of heel and ball
}

impl Hold {
    pub(super) fn new(part: Part, [from, to]: [usize; 2], plant: Plant, flat: Foot, point: DVec3) -> Hold {
        Hold { part, from, to, plant, flat, point, lead: Ease::default(), trail: Ease::default() }
    }
}

/// m at rest, from the ankle to the point that a heel or a ball holds, as far as it goes with the foot.
pub(super) fn point_of(body: &Body, side: Side, part: Part) -> DVec3 {
    let ankle = body.feet[side as usize].ankle;
    let last = held_points(body, side, part).last().copied();
    last.map_or(DVec3::ZERO, |point| body.joints[point.joint].rest + point.offset - body.joints[ankle].rest)
}

impl Held {
    pub(super) fn new(body: &Body, side: Side, dt: f64, holds: Vec<Hold>) -> Held {
        Held { holds, dt, offsets: [Part::Heel, Part::Ball].map(|part| point_of(body, side, part)) }
    }

    /// What it holds at a time.
    pub(super) fn holding(&self, time: f64) -> Option<&Hold> {
        let within = |hold: &&Hold| self.start(hold) - 1e-9 <= time && time <= self.end(hold) + 1e-9;
        self.holds.iter().find(within)
    }

    /// Whether it is anywhere but in its run then.
    pub(super) fn acts(&self, time: f64) -> bool {
        self.holds.iter().any(|hold| {
            let [lead, trail] = [&hold.lead, &hold.trail].map(|ease| ease.over[0].max(ease.over[1]));
            self.start(hold) - lead < time + 1e-9 && time - 1e-9 < self.end(hold) + trail
        })
    }

    /// Whether it is on its way into a hold or out of one then, or in its first or last two ticks.
    pub(super) fn changes(&self, time: f64) -> bool {
        let edge = 2.0 * self.dt;
        let within = |hold: &Hold| self.start(hold) + edge <= time && time <= self.end(hold) - edge;
        self.acts(time) && !self.holds.iter().any(within)
    }

    fn start(&self, hold: &Hold) -> f64 {
        hold.from as f64 * self.dt
    }

    fn end(&self, hold: &Hold) -> f64 {
        hold.to as f64 * self.dt
    }

    /// Where the foot is, whose run has it there at that time.
    pub(super) fn at(&self, run: &Foot, time: f64) -> Foot {
        let holding = self.holding(time);
        if let Some(hold) = holding.filter(|hold| hold.part == Part::Flat) {
            return Foot { toe: toes(run.toe, hold.flat.toe), ..hold.flat };
        }
        let mut by = [DVec3::ZERO; 3];
        for hold in &self.holds {
            for (ease, passed) in [(&hold.lead, self.start(hold) - time), (&hold.trail, time - self.end(hold))] {
                for (sum, ([value, rate], over)) in by.iter_mut().zip(ease.parts()) {
                    *sum += left(*value, *rate, passed, over);
                }
            }
        }
        let [place, foot, toe] = by;
        let foot = DQuat::from_scaled_axis(foot) * run.foot;
        let toe = DQuat::from_scaled_axis(toe) * run.toe;
        let ankle = match holding {
            Some(hold) => hold.point - foot * self.offsets[usize::from(hold.part == Part::Ball)],
            None => run.ankle + place,
        };
        Foot { ankle, foot, toe }
    }

    /// Lets what came before and after its contacts go.
    pub(super) fn let_go(&mut self) {
        for hold in &mut self.holds {
            (hold.lead, hold.trail) = (Ease::default(), Ease::default());
        }
    }

    /// Finds how it comes to each contact and goes from it; `run`: where the run has the foot at a time.
    pub(super) fn ease(&mut self, run: &dyn Fn(f64) -> Foot) {
        self.let_go();
        // Turns first: where an ankle is over a ball or a heel depends on them.
        for turns in [true, false] {
            let mut eased = self.holds.clone();
            for (index, hold) in eased.iter_mut().enumerate().filter(|(_, hold)| !turns || hold.part == Part::Flat) {
                let (start, end) = (self.start(hold), self.end(hold));
                let counts = |other: &&Hold| !turns || other.part == Part::Flat;
                let before = self.holds[..index].iter().rev().find(counts).map(|other| self.end(other));
                let after = self.holds[index + 1..].iter().find(counts).map(|other| self.start(other));
                let room = [before.map_or(FADES, |end| start - end), after.map_or(FADES, |start| start - end)];
                let step = SLOPE.min(0.5 * (end - start));
                let lead = self.off(run, start, start + step, hold.lead);
                let trail = self.off(run, end, end - step, hold.trail);
                for (ease, found, room) in [(&mut hold.lead, lead, room[0]), (&mut hold.trail, trail, room[1])] {
                    let over = room.min(FADES);
                    if turns {
                        *ease = Ease { foot: found.foot, toe: found.toe, over: [ease.over[0], over], ..*ease };
                    } else {
                        *ease = Ease { place: found.place, over: [over, ease.over[1]], ..*ease };
                    }
                }
            }
            self.holds = eased;
        }
    }

    /// What it differs by at an end of a contact, by how much that changes away from there.
    fn off(&self, run: &dyn Fn(f64) -> Foot, end: f64, inside: f64, was: Ease) -> Ease {
        let by = |time: f64| {
            let there = run(time);
            let held = self.at(&there, time);
            [
                held.ankle - there.ankle,
                rotation_vector(held.foot * there.foot.inverse()),
                rotation_vector(held.toe * there.toe.inverse()),
            ]
        };
        let (here, inner) = (by(end), by(inside));
        let step = (end - inside).abs().max(1e-6);
        let rate = |part: usize| [here[part], (here[part] - inner[part]) / step];
        Ease { place: rate(0), foot: rate(1), toe: rate(2), ..was }
    }

    /// The contacts.
    pub(super) fn contacts(&self, side: Side) -> impl Iterator<Item = FootContact> + '_ {
        self.holds.iter().map(move |hold| FootContact {
            side,
            part: hold.part,
            start: self.start(hold),
            end: self.end(hold),
            plant: hold.plant,
        })
    }
}

/// Toes as the run's are, level where they nearly are: who lands on his toes, or stands with a little off them, stands on the rest of his sole.
fn toes(run: DQuat, level: DQuat) -> DQuat {
    let far = level.angle_between(run);
    if far <= TOES { level } else { level.slerp(run, 1.0 - TOES / far) }
}

impl Ease {
    fn parts(&self) -> [(&[DVec3; 2], f64); 3] {
        [(&self.place, self.over[0]), (&self.foot, self.over[1]), (&self.toe, self.over[1])]
    }
}

/// What is left of a value that changes at that rate where it is let go, so long ago: none of it, and at rest, after `over`.
pub(super) fn left(value: DVec3, rate: DVec3, passed: f64, over: f64) -> DVec3 {
    if passed <= 0.0 || passed >= over {
        return if passed.abs() <= 1e-9 && over > 0.0 { value } else { DVec3::ZERO };
    }
    let u = passed / over;
    value * (1.0 + u * u * (2.0 * u - 3.0)) + rate * (over * u * (1.0 - u) * (1.0 - u))
}

//! One cycle without a seam: each moment is mixed from the stride and the one before it, all the first at the start and all the second
//! at the end, so that the end is the start, and its every rate too.
//!
//! The body goes over evenly all the cycle long; a foot only while both strides have it in the air, so that what it holds it holds.
//! Scenario space, metres, seconds; the clip is put to the origin, facing +Z.

use super::cycle::{Cycle, airs, covers};
use crate::bake::BakeError;
use crate::bake::contacts::FootContact;
use crate::bake::perform::Performance;
use crate::bake::played::leg::{Foot, reach};
use crate::bake::timeline::Timeline;
use crate::maths::curve::smooth5;
use crate::maths::quat::wrap_angle;
use crate::measure::KnownPush;
use crate::model::load::Form;
use crate::model::{BodyPose, Load, Plant, Side};
use crate::stepper::Step;
use crate::whole_body::{ArmAngles, FootTarget, PoseTarget, Solver};
use glam::{DQuat, DVec2, DVec3};

/// s, the least time in the air in which a foot can go over from one stride to the other.
const LEAST: f64 = 0.06;
/// m: a stand nearer to where it began stays there.
const STAYS: f64 = 0.05;
/// rad: who faces ahead to within this is not turned.
const AHEAD: f64 = 1e-3;

/// A cycle as a motion.
pub(super) struct Looped<'a> {
    /// Which.
    pub cycle: Cycle,
    /// Where it is put.
    pub place: Place,
    /// m, the way of a cycle, as it is put.
    pub travel: DVec3,
    /// Cut at both ends, as they are put.
    pub contacts: Vec<FootContact>,
    /// Steps of a cycle.
    pub steps: Vec<Step>,
    timeline: &'a Timeline,
    pushes: Vec<KnownPush>,
    over: [Option<[f64; 2]>; 2], // s, in which each foot goes over
}

/// Where a motion is put: turned about +Y after `from` is brought to the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub turn: DQuat,
    pub yaw: f64,
    pub from: DVec3,
}

impl Place {
    /// A point of the performance.
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.turn * (point - self.from)
    }

    fn pose(&self, pose: BodyPose) -> BodyPose {
        BodyPose {
            hips: self.point(pose.hips),
            turns: pose.turns.iter().map(|turn| (self.turn * *turn).normalize()).collect(),
        }
    }

    fn plant(&self, plant: &Plant) -> Plant {
        Plant {
            ankle: self.point(plant.ankle),
            yaw: wrap_angle(plant.yaw + self.yaw),
            normal: self.turn * plant.normal,
        }
    }
}

impl<'a> Looped<'a> {
    /// Of a performance.
    pub fn new(performance: &'a Performance, cycle: Cycle) -> Result<Looped<'a>, BakeError> {
        let Cycle { start, period, .. } = cycle;
        let mut over = [None; 2];
        for side in Side::BOTH {
            let flies = |from: f64| -> Vec<[f64; 2]> {
                airs(&performance.contacts, side, from, from + period)
                    .iter()
                    .map(|air| air.map(|time| time - from))
                    .collect()
            };
            let (own, before) = (flies(start), flies(start - period));
            if own.is_empty() && before.is_empty() {
                continue;
            }
            let both = own.iter().flat_map(|a| before.iter().map(|b| [a[0].max(b[0]), a[1].min(b[1])]));
            let longest = both.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
            let Some(window) = longest.filter(|window| window[1] - window[0] > LEAST.min(0.2 * period)) else {
                let why = "two strides on end do not lift their feet at the same times. Give the walk more time to become steady";
                return Err(BakeError::NoCycle { why: why.into() });
            };
            over[side as usize] = Some(window);
        }
        let timeline = &performance.timeline;
        let mut looped = Looped {
            cycle,
            place: Place { turn: DQuat::IDENTITY, yaw: 0.0, from: DVec3::ZERO },
            travel: cycle.travel,
            contacts: Vec::new(),
            steps: Vec::new(),
            timeline,
            pushes: performance.pushes.clone(),
            over,
        };
        looped.place = looped.placed(performance);
        looped.travel = looped.place.turn * cycle.travel;
        looped.contacts = looped.held(&performance.contacts);
        let within = |step: &&Step| step.land > start + 1e-6 && step.land <= start + period + 1e-6;
        looped.steps = performance.trace.steps.iter().filter(within).copied().collect();
        Ok(looped)
    }

    /// The pose at a time of the cycle.
    pub fn pose_at(&self, time: f64) -> BodyPose {
        self.place.pose(self.performed(time))
    }

    /// What the hands hold over so many cycles.
    pub fn loads(&self, cycles: usize) -> Vec<Load> {
        let Cycle { start, period, .. } = self.cycle;
        let held = |load: &&Load| load.mass_at(start) > 0.0 || load.mass_at(start + 0.5 * period) > 0.0;
        let one = |load: &Load| {
            let inside =
                load.mass.iter().map(|point| point[0] - start).filter(|time| *time > 1e-6 && *time < period - 1e-6);
            let times: Vec<f64> = inside.chain([period]).collect();
            let mut mass = vec![[0.0, load.mass_at(start)]];
            for cycle in 0..cycles {
                let again = times.iter().map(|time| [cycle as f64 * period + time, load.mass_at(start + time)]);
                mass.extend(again);
            }
            let changes: Vec<f64> = (load.forms.iter().map(|form| form.time - start))
                .filter(|time| *time > 1e-6 && *time < period - 1e-6)
                .chain([period])
                .collect();
            let mut forms = vec![Form { time: 0.0, ..load.form_at(start) }];
            for cycle in 0..cycles {
                let again = |time: &f64| Form { time: cycle as f64 * period + time, ..load.form_at(start + time) };
                forms.extend(changes.iter().map(again));
            }
            Load { mass, forms, span: [-1.0, cycles as f64 * period + 1.0], ..load.clone() }
        };
        self.timeline.loads.iter().filter(held).map(one).collect()
    }

    /// What pushes all the while, over so many cycles.
    pub fn pushes(&self, cycles: usize) -> Vec<KnownPush> {
        let Cycle { start, period, .. } = self.cycle;
        let lasting = self.pushes.iter().filter(|push| covers(push, start - period, start + period));
        let end = cycles as f64 * period;
        lasting.map(|push| KnownPush { start: 0.0, end, force: self.place.turn * push.force, ..*push }).collect()
    }

    /// Where it goes: a stand that has stayed where it was stays; else to the origin, the mean of its hips as at rest.
    fn placed(&self, performance: &Performance) -> Place {
        let Timeline { body, terrain, over, com, dt, .. } = self.timeline;
        let Cycle { start, period, travel, walks, .. } = self.cycle;
        let first = com.first().copied().unwrap_or_default();
        let now = self.timeline.com_at(start);
        if !walks && DVec2::new(now.x - first.x, now.z - first.z).length() < STAYS {
            return self.place;
        }
        let tick = performance.trace.ticks.get((start / dt).round() as usize);
        let facing = tick.map_or(0.0, |tick| tick.facing);
        let yaw = if over.is_some() || !terrain.is_flat() || facing.abs() < AHEAD { 0.0 } else { -facing };
        let turn = DQuat::from_rotation_y(yaw);
        let mut mean = DVec3::ZERO;
        for part in 0..16 {
            let share = f64::from(part) / 16.0;
            mean += (self.performed(share * period).hips - travel * share) / 16.0;
        }
        let rest = body.joints[0].rest;
        let from = mean - turn.inverse() * DVec3::new(rest.x, 0.0, rest.z);
        let height = terrain.spot(DVec2::new(from.x, from.z)).height;
        Place { turn, yaw, from: DVec3::new(from.x, height, from.z) }
    }

    /// The contacts of the stride until a foot goes over, of the one before it from then on.
    fn held(&self, contacts: &[FootContact]) -> Vec<FootContact> {
        let Cycle { start, period, travel, .. } = self.cycle;
        let mut list = Vec::new();
        for side in Side::BOTH {
            let turns = self.over[side as usize].map_or(f64::INFINITY, |[from, to]| 0.5 * (from + to));
            for (later, way, first) in [(start, DVec3::ZERO, true), (start - period, travel, false)] {
                for contact in contacts.iter().filter(|contact| contact.side == side) {
                    let [from, to] = [contact.start - later, contact.end - later].map(|time| time.clamp(0.0, period));
                    if to - from < 1e-6 || (0.5 * (from + to) < turns) != first {
                        continue;
                    }
                    let plant = Plant { ankle: contact.plant.ankle + way, ..contact.plant };
                    list.push(FootContact { start: from, end: to, plant: self.place.plant(&plant), ..*contact });
                }
            }
        }
        list.sort_by(|a, b| (a.side as usize).cmp(&(b.side as usize)).then(a.start.total_cmp(&b.start)));
        list
    }

    fn performed(&self, time: f64) -> BodyPose {
        let Timeline { body, anatomy, over, .. } = self.timeline;
        let (now, before) = (self.cycle.start + time, self.cycle.start + time - self.cycle.period);
        let share = smooth5(time / self.cycle.period);
        if self.timeline.played.is_some() {
            return self.replayed(now, before, share, time);
        }
        let target = self.target(now, before, share, time);
        let mut solver = Solver::new(body, anatomy);
        match over {
            None => solver.solve(&target),
            Some(over) => {
                let base = over.pose(now).between(&over.pose(before), share);
                solver.solve_over(&target, Some((over.neutral(), &base)))
            }
        }
        .pose
    }

    /// Of a run that is played: its links' poses at both times, and each foot of the one or the other.
    fn replayed(&self, now: f64, before: f64, share: f64, time: f64) -> BodyPose {
        let Timeline { body, anatomy, .. } = self.timeline;
        let travel = self.cycle.travel;
        let (a, b) = (self.timeline.pose_at(now), self.timeline.pose_at(before));
        let mut pose = BodyPose {
            hips: a.hips.lerp(b.hips + travel, share),
            turns: a.turns.iter().zip(&b.turns).map(|(a, b)| a.slerp(*b, share)).collect(),
        };
        let (of_a, of_b) = (a.positions(body), b.positions(body));
        let positions = pose.positions(body);
        for side in Side::BOTH {
            let over = self.over[side as usize].map_or(0.0, |[from, to]| smooth5((time - from) / (to - from)));
            let (a, b) = (Foot::of(body, &a, &of_a, side), Foot::of(body, &b, &of_b, side));
            let wanted = Foot {
                ankle: a.ankle.lerp(b.ankle + travel, over),
                foot: a.foot.slerp(b.foot, over),
                toe: a.toe.slerp(b.toe, over),
            };
            reach(body, anatomy, &mut pose, &positions, (side, None), &wanted);
        }
        pose
    }

    fn target(&self, now: f64, before: f64, share: f64, time: f64) -> PoseTarget {
        let (a, b) = (self.timeline.target_at(now), self.timeline.target_at(before));
        let feet = Side::BOTH.map(|side| {
            let over = self.over[side as usize].map_or(0.0, |[from, to]| smooth5((time - from) / (to - from)));
            foot(&a.feet[side as usize], &b.feet[side as usize], self.cycle.travel, over)
        });
        let hold = match (a.hold, b.hold) {
            (Some(mut hold), Some(other)) => {
                hold.mass = mix(hold.mass, other.mass, share);
                hold.weight = mix(hold.weight, other.weight, share);
                hold.lean = mix(hold.lean, other.lean, share);
                Some(hold)
            }
            (hold, _) => hold,
        };
        PoseTarget {
            com: a.com.lerp(b.com + self.cycle.travel, share),
            pelvis: a.pelvis.slerp(b.pelvis, share),
            chest: a.chest.slerp(b.chest, share),
            head: a.head.slerp(b.head, share),
            arms: [0, 1].map(|side| arm(&a.arms[side], &b.arms[side], share)),
            feet,
            hold,
        }
    }
}

fn mix(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}

fn arm(a: &ArmAngles, b: &ArmAngles, share: f64) -> ArmAngles {
    ArmAngles {
        raise: mix(a.raise, b.raise, share),
        abduct: mix(a.abduct, b.abduct, share),
        inward: mix(a.inward, b.inward, share),
        elbow: mix(a.elbow, b.elbow, share),
        curl: mix(a.curl, b.curl, share),
    }
}

fn foot(a: &FootTarget, b: &FootTarget, travel: DVec3, share: f64) -> FootTarget {
    let b = FootTarget { ankle: b.ankle + travel, ..*b };
    if share <= 0.0 {
        return *a;
    }
    if share >= 1.0 {
        return b;
    }
    FootTarget {
        ankle: a.ankle.lerp(b.ankle, share),
        foot: a.foot.slerp(b.foot, share),
        toe: a.toe.slerp(b.toe, share),
        yaw: a.yaw + wrap_angle(b.yaw - a.yaw) * share,
        soft: mix(a.soft, b.soft, share),
        swivel: mix(a.swivel, b.swivel, share),
        bend: match (a.bend, b.bend) {
            (Some(from), Some(to)) => Some(mix(from, to, share)),
            (from, to) => {
                if share < 0.5 {
                    from
                } else {
                    to
                }
            }
        },
    }
}

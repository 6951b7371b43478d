//! A run as it is shown over the base clip that it started from. Scenario space, m, s.
//!
//! Until something strikes the body the clip's own pose is shown, its feet where they first stand. From then on the run is: what it
//! differs by at that moment is let go, and joints that no link turns about go on with the clip. A foot is where the run has it, each of
//! its stands moved as a whole: the first to where the clip stands, the last to where it stands again. In the last second the rest is led
//! back into the clip, laid where the feet are. Where they are too far from how they stand in it, the clip ends as the run does, and a
//! note says so.

use super::leg::{self, Foot};
use super::{Played, Run, bound};
use crate::bake::base::Stood;
use crate::bake::base::stand::{MOST_MOVED, MOST_TURNED, left_over};
use crate::bake::contacts::FootContact;
use crate::maths::curve::{sample, smooth3};
use crate::maths::quat::{wrap_angle, yaw_of};
use crate::maths::real;
use crate::model::{Body, BodyPose, Plant, Side, report::Part};
use crate::whole_body::Anatomy;
use crate::whole_body::stand::foot_yaw;
use glam::{DQuat, DVec3};

/// s, in which what the run differs by from the clip when it is struck is let go.
const LETS_GO: f64 = 0.4;
/// s after the first strike until which a foot's first contact of the run may begin for it to be the one that it has stood in all along.
const BEGINS: f64 = 0.15;
/// m, rad: a foot that is farther from where it first stood has moved.
const MOVED: f64 = 5e-3;
const TURNED: f64 = 1.0 * std::f64::consts::PI / 180.0;
/// Part of its length that a leg uses at most.
const STRAIGHTEST: f64 = 0.9995;
/// s, over which a body that must be lower for a leg to reach comes to be so.
pub(super) const LOWERS: f64 = 0.15;

/// The clip under a run.
#[derive(Clone, Debug)]
pub(super) struct Laid {
    stood: Stood,
    owners: Vec<usize>, // of each joint: the joint that its link turns about
    struck: f64,        // s
    first: [Foot; 2],   // as the clip's feet stand at first
    off: Vec<DQuat>,    // what the run's joints lacked when it was struck
    off_hips: DVec3,    // m
    home: Option<Home>,
    stands: [Vec<Moved>; 2],
    lowered: Vec<f64>, // m, a tick
    contacts: Vec<FootContact>,
}

/// Where the clip is at the end, and when the way there begins.
#[derive(Clone, Copy, Debug)]
struct Home {
    turn: DQuat,
    place: DVec3, // m, of what is at the origin in the clip
    busy: f64,    // s
    end: f64,     // s
}

/// A foot's stand, moved.
#[derive(Clone, Copy, Debug)]
struct Moved {
    from: f64,
    to: f64,
    by: Rigid,
}

/// A motion of a rigid foot; toes have a turn of their own.
#[derive(Clone, Copy, Debug)]
struct Rigid {
    turn: DQuat,
    toe: DQuat,
    offset: DVec3,
}

impl Rigid {
    const NONE: Rigid = Rigid { turn: DQuat::IDENTITY, toe: DQuat::IDENTITY, offset: DVec3::ZERO };

    /// From one way that a foot is to another.
    fn between(from: &Foot, to: &Foot) -> Rigid {
        let turn = (to.foot * from.foot.inverse()).normalize();
        let toe = (to.toe * from.toe.inverse()).normalize();
        Rigid { turn, toe, offset: to.ankle - turn * from.ankle }
    }

    fn of(&self, foot: &Foot) -> Foot {
        Foot {
            ankle: self.turn * foot.ankle + self.offset,
            foot: (self.turn * foot.foot).normalize(),
            toe: (self.toe * foot.toe).normalize(),
        }
    }
}

impl Home {
    /// How much of the way there is over, 0 to 1.
    fn share(&self, time: f64) -> f64 {
        1.0 - left_over(time, self.busy, self.end)
    }

    fn of(&self, foot: &Foot) -> Foot {
        Foot { ankle: self.turn * foot.ankle + self.place, foot: self.turn * foot.foot, toe: self.turn * foot.toe }
    }
}

/// s, when the body is first struck, and when the last of that and of its steps is over; whether it keeps its balance.
pub(super) struct Course {
    pub(super) struck: f64,
    pub(super) busy: f64,
    pub(super) stands: bool,
}

impl Laid {
    /// Of a run over that clip.
    pub(super) fn new(played: &Played, run: &Run, stood: Stood, course: &Course) -> Laid {
        let body = run.body;
        let end = played.stands as f64 * played.dt;
        let struck = course.struck.min(end);
        let clip = stood.base.at(struck).pose;
        let first = Side::BOTH.map(|side| {
            let pose = &stood.base.at(0.0).pose;
            Foot::of(body, pose, &pose.positions(body), side)
        });
        let mut laid = Laid {
            owners: owners(body, run.joints),
            struck,
            first,
            off: Vec::new(),
            off_hips: DVec3::ZERO,
            home: None,
            stands: [Vec::new(), Vec::new()],
            lowered: Vec::new(),
            contacts: Vec::new(),
            stood,
        };
        let own = played.held_pose(body, run.anatomy, run.terrain, struck);
        let shown = with_clip(&laid.owners, &own, &clip);
        laid.off = clip.turns.iter().zip(&shown.turns).map(|(clip, own)| *clip * own.inverse()).collect();
        laid.off_hips = clip.hips - own.hips;
        laid.stand(played, run, course, end);
        laid.lower(played, run, end);
        laid
    }

    /// Finds where the stands of the feet are, and what of them is a contact.
    fn stand(&mut self, played: &Played, run: &Run, course: &Course, end: f64) {
        let body = run.body;
        let foot_at = |side: Side, time: f64| {
            let pose = played.held_pose(body, run.anatomy, run.terrain, time);
            Foot::of(body, &pose, &pose.positions(body), side)
        };
        let contacts: [Vec<FootContact>; 2] = Side::BOTH.map(|side| {
            let own = played.held[side as usize].contacts(side);
            own.filter(|contact| contact.end > self.struck).collect()
        });
        let until = Side::BOTH.map(|side| {
            let begins = contacts[side as usize].first().map_or(self.struck, |contact| contact.start);
            if begins <= self.struck + BEGINS { begins.max(self.struck) } else { self.struck }
        });
        let start = Side::BOTH.map(|side| {
            let by = Rigid::between(&foot_at(side, until[side as usize]), &self.first[side as usize]);
            Moved { from: f64::NEG_INFINITY, to: until[side as usize], by }
        });
        let last = Side::BOTH.map(|side| foot_at(side, end));
        let stands = contacts.each_ref().map(|own| own.last().is_none_or(|contact| contact.end > end - 0.05));
        self.home = (course.stands && stands == [true; 2]).then(|| self.laid_on(body, &start, &last)).flatten();
        if course.stands && stands != [true; 2] {
            self.stood
                .notes
                .push("it is not back in the base clip when it ends: give the scenario more duration".into());
        }
        if let Some(home) = &mut self.home {
            (home.busy, home.end) = (course.busy, end);
        }
        for side in Side::BOTH {
            let stood = &run.stood[side as usize];
            let of = |contact: &FootContact| {
                let middle = 0.5 * (contact.start + contact.end);
                stood.iter().position(|[_, to]| middle <= *to + 1e-9).unwrap_or(stood.len().saturating_sub(1))
            };
            let mut moved = vec![start[side as usize]];
            let own = &contacts[side as usize];
            let home = self.home.map(|home| Rigid::between(&last[side as usize], &home.of(&self.first[side as usize])));
            for (index, contact) in own.iter().enumerate() {
                let stand = of(contact);
                let by = match home {
                    Some(home) if index + 1 == own.len() => home,
                    Some(home) if stand > 0 && stand + 1 == stood.len() => home,
                    _ if stand == 0 => start[side as usize].by,
                    _ => Rigid::NONE,
                };
                let from = if index == 0 && contact.start <= self.struck + BEGINS { 0.0 } else { contact.start };
                moved.push(Moved { from: contact.start, to: contact.end, by });
                let plant = match (stand, self.home) {
                    (0, _) => self.stood.feet[side as usize].plant,
                    _ => moved_plant(&contact.plant, &by),
                };
                self.contacts.push(FootContact { start: from, plant, ..*contact });
            }
            if own.first().is_none_or(|contact| contact.start > self.struck + BEGINS) && self.struck > 0.0 {
                let plant = self.stood.feet[side as usize].plant;
                self.contacts.push(FootContact { side, part: Part::Flat, start: 0.0, end: self.struck, plant });
            }
            if let Some(by) = home {
                moved.push(Moved { from: end, to: f64::INFINITY, by });
            }
            self.stands[side as usize] = moved;
        }
        self.contacts.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.side.cmp(&b.side)));
    }

    /// Where the clip lies on these last feet, if that is near enough.
    fn laid_on(&mut self, body: &Body, start: &[Moved; 2], last: &[Foot; 2]) -> Option<Home> {
        let moved = Side::BOTH.map(|side| {
            let now = start[side as usize].by.of(&last[side as usize]);
            let first = &self.first[side as usize];
            let far = (now.ankle - first.ankle).with_y(0.0).length();
            far > MOVED || yaw_of(now.foot * first.foot.inverse()).abs() > TURNED
        });
        let mut home = Home { turn: DQuat::IDENTITY, place: DVec3::ZERO, busy: 0.0, end: 0.0 };
        if moved == [true; 2] {
            let yaw = |vector: DVec3| real::atan2(vector.x, vector.z);
            let feet = Side::BOTH.map(|side| {
                let [now, then] = [&last[side as usize], &self.first[side as usize]];
                wrap_angle(foot_yaw(body, side, now.foot) - foot_yaw(body, side, then.foot))
            });
            let [now, then] = [last, &self.first].map(|feet| yaw(feet[0].ankle - feet[1].ankle));
            let turned = feet[0] + 0.5 * wrap_angle(feet[1] - feet[0]);
            let turned = turned + 0.5 * wrap_angle(wrap_angle(now - then) - turned);
            home.turn = DQuat::from_rotation_y(turned);
            let [now, then] = [last, &self.first].map(|feet| 0.5 * (feet[0].ankle + feet[1].ankle));
            home.place = (now - home.turn * then).with_y(0.0);
        }
        let off = Side::BOTH.map(|side| {
            let wanted = home.of(&self.first[side as usize]);
            let now = &last[side as usize];
            let yaw = wrap_angle(foot_yaw(body, side, wanted.foot) - foot_yaw(body, side, now.foot));
            ((wanted.ankle - now.ankle).with_y(0.0).length(), yaw.abs())
        });
        let far = off[0].0.max(off[1].0);
        if far > MOST_MOVED * body.leg_length || off[0].1.max(off[1].1) > MOST_TURNED {
            self.stood.notes.push(format!(
                "it does not come back to the base clip: its feet stand {:.0} cm from where the clip has them",
                100.0 * far
            ));
            return None;
        }
        Some(home)
    }

    /// The pose before its feet are put where they stand, and where they are in the run.
    fn unplanted(&self, run: &BodyPose, time: f64) -> BodyPose {
        let clip = self.stood.base.at(time).pose;
        if time <= self.struck {
            return clip;
        }
        let left = 1.0 - smooth3((time - self.struck) / LETS_GO);
        let mut pose = with_clip(&self.owners, run, &clip);
        if left > 0.0 {
            for (turn, off) in pose.turns.iter_mut().zip(&self.off) {
                *turn = (DQuat::IDENTITY.slerp(*off, left) * *turn).normalize();
            }
            pose.hips += self.off_hips * left;
        }
        let Some(home) = &self.home else { return pose };
        let share = home.share(time);
        if share > 0.0 {
            for (turn, clip) in pose.turns.iter_mut().zip(&clip.turns) {
                *turn = turn.slerp(home.turn * *clip, share).normalize();
            }
            pose.hips = pose.hips.lerp(home.turn * clip.hips + home.place, share);
        }
        pose
    }

    /// Where a foot is that the run has there at a time.
    fn foot(&self, run: &Foot, side: Side, time: f64) -> Foot {
        let moved = &self.stands[side as usize];
        if moved.first().is_none_or(|first| time <= first.to) {
            return self.first[side as usize];
        }
        let before = moved.iter().rev().find(|stand| stand.from <= time + 1e-9);
        let after = moved.iter().find(|stand| stand.from > time + 1e-9);
        let Some(before) = before else { return *run };
        let here = before.by.of(run);
        if time <= before.to + 1e-9 {
            return here;
        }
        let (there, share) = match after {
            Some(after) => (after.by.of(run), smooth3((time - before.to) / (after.from - before.to).max(1e-3))),
            None => (*run, smooth3((time - before.to) / LETS_GO)),
        };
        Foot {
            ankle: here.ankle.lerp(there.ankle, share),
            foot: here.foot.slerp(there.foot, share),
            toe: here.toe.slerp(there.toe, share),
        }
    }

    /// The pose at a time, of a run that is so then.
    pub(super) fn pose(&self, body: &Body, anatomy: &Anatomy, run: &BodyPose, time: f64) -> BodyPose {
        let mut pose = self.unplanted(run, time);
        pose.hips.y -= if self.lowered.is_empty() { 0.0 } else { sample(&self.lowered, self.dt(), time) };
        let (own, positions) = (run.positions(body), pose.positions(body));
        for side in Side::BOTH {
            let wanted = self.foot(&Foot::of(body, run, &own, side), side, time);
            leg::reach(body, anatomy, &mut pose, &positions, (side, None), &wanted);
        }
        bound(body, pose)
    }

    fn dt(&self) -> f64 {
        crate::sim::SimulateOptions::default().dt
    }

    /// Lowers the body where a leg does not reach its foot otherwise.
    fn lower(&mut self, played: &Played, run: &Run, end: f64) {
        let (body, dt) = (run.body, self.dt());
        let need = |tick: usize| {
            let time = (tick as f64 * dt).min(end);
            let own = played.held_pose(body, run.anatomy, run.terrain, time);
            let pose = self.unplanted(&own, time);
            let own_positions = own.positions(body);
            let feet = Side::BOTH.map(|side| self.foot(&Foot::of(body, &own, &own_positions, side), side, time));
            too_high(body, run.anatomy, &pose, &feet)
        };
        let needs: Vec<f64> = (0..played.run.len()).map(need).collect();
        // Both ends are the clip's.
        let home = self.home.is_some();
        self.lowered = lowered(&needs, dt, &|time| if home { smooth3((end - time) / LOWERS) } else { 1.0 });
    }

    /// What the feet hold, in order of start, left before right.
    pub(super) fn contacts(&self) -> &[FootContact] {
        &self.contacts
    }

    /// The clip, and what there is to say.
    pub(super) fn stood(&self) -> &Stood {
        &self.stood
    }
}

/// The run's pose with the clip's own turns of what no link turns about.
pub(super) fn with_clip(owners: &[usize], run: &BodyPose, clip: &BodyPose) -> BodyPose {
    let turn = |joint: usize| {
        let owner = owners[joint];
        if owner == joint {
            run.turns[joint]
        } else {
            (run.turns[owner] * clip.turns[owner].inverse() * clip.turns[joint]).normalize()
        }
    };
    BodyPose { hips: run.hips, turns: (0..run.turns.len()).map(turn).collect() }
}

/// m, by how much a body is too high for its legs to reach these feet.
pub(super) fn too_high(body: &Body, anatomy: &Anatomy, pose: &BodyPose, feet: &[Foot; 2]) -> f64 {
    let positions = pose.positions(body);
    let short = |side: Side| {
        let leg = &anatomy.legs[side as usize];
        let far = positions[leg.upper] - feet[side as usize].ankle;
        let long = STRAIGHTEST * leg.length();
        let level = far.with_y(0.0).length_squared();
        far.y - (long * long - level).max(0.0).sqrt()
    };
    short(Side::Left).max(short(Side::Right)).max(0.0)
}

/// m, how far a body goes down that is to be so much lower at each tick of `dt` s: not at all at first, and so much of it at the end.
pub(super) fn lowered(needs: &[f64], dt: f64, ends: &dyn Fn(f64) -> f64) -> Vec<f64> {
    let reach = (LOWERS / dt).round() as usize;
    let around = |values: &[f64], at: usize| [at.saturating_sub(reach), (at + reach).min(values.len() - 1)];
    let most: Vec<f64> = (0..needs.len())
        .map(|at| {
            let [from, to] = around(needs, at);
            needs[from..=to].iter().copied().fold(0.0, f64::max)
        })
        .collect();
    let mean = |at: usize| {
        let [from, to] = around(&most, at);
        most[from..=to].iter().sum::<f64>() / (to - from + 1) as f64
    };
    (0..needs.len()).map(|at| mean(at) * (smooth3(at as f64 * dt / LOWERS) * ends(at as f64 * dt))).collect()
}

/// Of each joint the joint that its link turns about.
pub(super) fn owners(body: &Body, joints: &[usize]) -> Vec<usize> {
    let owner = |joint: usize| {
        let mut at = Some(joint);
        while let Some(joint) = at {
            if joints.contains(&joint) {
                return joint;
            }
            at = body.joints[joint].parent;
        }
        0
    };
    (0..body.joints.len()).map(owner).collect()
}

fn moved_plant(plant: &Plant, by: &Rigid) -> Plant {
    let ankle = (by.turn * plant.ankle + by.offset).with_y(plant.ankle.y);
    Plant { ankle, yaw: plant.yaw + yaw_of(by.turn), ..*plant }
}

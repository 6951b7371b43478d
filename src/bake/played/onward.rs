//! A run as it is shown over the base clip that walks and that it was struck in. Scenario space, m, s.
//!
//! Until something strikes the body the clip is shown. From then on the run is, laid so that the foot that stands is where the clip has
//! it: what it differs by at that moment is let go, joints that no link turns about go on with the clip, and feet leave the clip and come
//! back to it as over the stepper's run ([`Walked`]): each in a swing. The foot that stands while the other one comes back rolls off as in
//! the clip, where it stands.

use super::hold;
use super::joined::{Both, Joined};
use super::landing::{LATE, Landing, leg_foot};
use super::leg::{self, Foot};
use super::over::{LOWERS, lowered, owners, too_high, with_clip};
use super::{BETWEEN_TICKS, Played, Run, bound};
use crate::bake::base::again::RollOff;
use crate::bake::base::gait::blended;
use crate::bake::base::{FootOffset, Walked};
use crate::bake::contacts::FootContact;
use crate::maths::curve::{sample, smooth3};
use crate::model::report::Part;
use crate::model::{Body, BodyPose, Side};
use crate::stepper::Step;
use crate::whole_body::stand::foot_yaw;
use crate::whole_body::{Anatomy, FootTarget};
use glam::{DQuat, DVec3};

/// s, in which what the run differs by from the clip when it is struck is let go.
const LETS_GO: f64 = 0.5;
/// The same of its place: to the side that is as far as the clip's feet stand closer together, and would be seen as a blow.
const HIPS: f64 = 0.8;
/// s after balance is lost, in which feet come to be where the falling body has them.
const FALLS: f64 = 0.3;

/// The clip under a run.
#[derive(Clone, Debug)]
pub(super) struct Onward {
    walked: Walked,
    owners: Vec<usize>, // of each joint: the joint that its link turns about
    dt: f64,
    struck: f64,          // s
    lost: f64,            // s, from when on it falls
    off: Vec<[DVec3; 2]>, // rad and rad/s: what the run's joints lacked when it was struck
    off_hips: [DVec3; 2], // m and m/s
    lands: [Option<Landing>; 2],
    joined: [Joined; 2],
    rolls: [Option<Rolled>; 2],
    lowered: Vec<f64>, // m, a tick
    contacts: Vec<FootContact>,
}

/// A foot that rolls off as in the clip, and as the run has it when it begins to.
type Rolled = (RollOff, FootTarget);

impl Onward {
    /// Of a run over that clip, with the steps that it took: struck at the first time (s), the last blow over at the second; `stands`: it
    /// keeps its balance.
    pub(super) fn new(
        played: &Played,
        run: &Run,
        mut walked: Walked,
        steps: &[Step],
        (struck, busy, stands): (f64, f64, bool),
    ) -> Onward {
        let (body, dt) = (run.body, played.dt);
        let end = played.stands as f64 * dt;
        let (struck, busy) = (struck.min(end), if stands { busy } else { f64::INFINITY });
        walked.plan(&mut steps.to_vec(), (struck, busy, end), body);
        let own = |side: Side, time: f64| target(body, side, &played.held_pose(body, run.anatomy, run.terrain, time));
        let com = |time: f64| {
            let pose = played.held_pose(body, run.anatomy, run.terrain, time);
            pose.centre_of_mass(body, &pose.positions(body))
        };
        walked.lay_on(&com);
        let lands = Side::BOTH.map(|side| {
            let held = played.held[side as usize].contacts(side).find(|contact| contact.end > struck + dt);
            Landing::new((body, side), &walked, struck, dt, held, &|time| own(side, time))
        });
        let joined = Side::BOTH.map(|side| {
            let landing = lands[side as usize];
            let from = landing.map_or(struck, |landing| landing.from);
            // One that lands within a tick stands.
            let swings = steps.iter().filter(|step| step.side == side && step.land > from + dt + 1e-9);
            let swings: Vec<[f64; 2]> = swings.map(|step| [step.lift, step.land]).collect();
            let bears = landing.is_some() || walked.bearing(side, struck).is_some();
            let clip = |time: f64| match &landing {
                Some(landing) => landing.foot(&walked, side, time),
                None => walked.gait.foot(side, time),
            };
            let lies = landing.is_some() || walked.bearing(side, struck) == Some(Part::Flat);
            let leaves = swings.first().map_or(f64::INFINITY, |swing| swing[0]);
            let own_flat = played.held[side as usize].contacts(side);
            let own_flat = own_flat.filter(|own| own.part == Part::Flat && own.end > from && own.start < leaves);
            let flat = own_flat.map(|own| own.end).fold(None, |_, end| Some(end)).filter(|_| lies);
            let both = Both { clip: &clip, run: &|time| own(side, time), bears, flat, swings: &swings };
            Joined::new(body, side, &both, from, dt)
        });
        let rolls = Side::BOTH.map(|side| {
            let mut roll = walked.roll_off(side)?;
            // One that lands a little later than the other one lifts rolls off from then on.
            let held = played.held[side as usize].contacts(side);
            let begins =
                held.filter(|own| own.start < roll.lands - LATE).last().map_or(roll.from, |own| own.start + dt);
            let from = roll.from.max(begins);
            roll.from = from;
            Some((roll, own(side, from)))
        });
        let mut onward = Onward {
            owners: owners(body, run.joints),
            dt,
            struck,
            lost: if stands { f64::INFINITY } else { end },
            off: Vec::new(),
            off_hips: [DVec3::ZERO; 2],
            lands,
            joined,
            rolls,
            lowered: Vec::new(),
            contacts: Vec::new(),
            walked,
        };
        onward.differ(played, run);
        onward.hold(played, end);
        onward.lower(played, run, end);
        onward
    }

    /// Sees what the run differs by when it is struck, and how fast that changes.
    fn differ(&mut self, played: &Played, run: &Run) {
        let apart = |time: f64| {
            let time = time.max(0.0);
            let clip = self.walked.gait.at(time).pose;
            let own = played.held_pose(run.body, run.anatomy, run.terrain, time);
            let shown = with_clip(&self.owners, &own, &clip);
            let turns = clip.turns.iter().zip(&shown.turns);
            let turns: Vec<DQuat> = turns.map(|(clip, own)| *clip * own.inverse()).collect();
            (clip.hips - own.hips, turns)
        };
        let (hips, turns) = apart(self.struck);
        let (hips_before, turns_before) = apart(self.struck - self.dt);
        let axis = |turn: DQuat| if turn.w < 0.0 { (-turn).to_scaled_axis() } else { turn.to_scaled_axis() };
        let rate = |(now, before): (&DQuat, &DQuat)| [axis(*now), axis(*now * before.inverse()) / self.dt];
        self.off = turns.iter().zip(&turns_before).map(rate).collect();
        self.off_hips = [hips, (hips - hips_before) / self.dt];
    }

    /// What the feet hold: the clip's, the run's, the clip's again.
    fn hold(&mut self, played: &Played, end: f64) {
        for side in Side::BOTH {
            let mut list = Vec::new();
            let from = self.lands[side as usize].map_or(self.struck, |landing| landing.from);
            match &self.lands[side as usize] {
                Some(landing) => landing.contacts(&self.walked, side, &mut list),
                None => self.walked.gait.contacts(side, 0.0, self.struck, DVec3::ZERO, 0.0, &mut list),
            }
            let own = played.held[side as usize].contacts(side).filter(|contact| contact.end > from);
            let mut own: Vec<FootContact> = own.collect();
            self.settle(&mut own, side);
            if let Some((roll, _)) = &self.rolls[side as usize] {
                own.retain(|contact| contact.start < roll.from);
                let stands = own.last().is_some_and(|last| last.end > roll.from);
                let plant = own.last().map_or(roll.fall.plant, |last| last.plant);
                own.iter_mut().for_each(|contact| contact.end = contact.end.min(roll.ball.max(roll.from)));
                let start = own.last().map_or(roll.from, |last| last.end.max(roll.from));
                if stands {
                    own.push(FootContact { side, part: roll.fall.parts[1], start, end: roll.lift, plant });
                }
            }
            let until = self.walked.leaves(side).unwrap_or(end);
            own.iter_mut().for_each(|contact| contact.end = contact.end.min(until));
            for contact in own.into_iter().filter(|contact| contact.end > contact.start + 1e-4) {
                match list.last_mut() {
                    // It goes on standing as it stood.
                    Some(last) if (contact.start - last.end).abs() < 1e-6 && last.part == contact.part => {
                        last.end = contact.end;
                    }
                    _ => list.push(contact),
                }
            }
            self.walked.contacts_again(side, end, &mut list);
            self.contacts.extend(list);
        }
        self.contacts.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.side.cmp(&b.side)));
    }

    /// What a foot holds until it is as the run has it: what both hold, its ball where the heel of one of them is up. Where the run's turns
    /// about its heel, both hold nothing.
    fn settle(&self, own: &mut Vec<FootContact>, side: Side) {
        let settled = self.joined[side as usize].settled();
        let (from, bears) = match self.lands[side as usize] {
            Some(landing) => (landing.flat(), Some(Part::Flat)),
            None => (self.struck, self.walked.bearing(side, self.struck).filter(|part| *part != Part::Heel)),
        };
        let soon = self.joined[side as usize].from() + self.dt;
        let pieces = own.iter().filter(|piece| piece.start < settled && piece.part != Part::Heel);
        let both: Vec<FootContact> = bears.map_or(Vec::new(), |bears| {
            let shown = |piece: &FootContact| FootContact {
                part: if bears == piece.part { bears } else { Part::Ball },
                start: if piece.start <= soon { from } else { piece.start },
                end: piece.end.min(settled),
                ..*piece
            };
            pieces.map(shown).collect()
        });
        own.iter_mut().for_each(|contact| contact.start = contact.start.max(settled));
        own.retain(|contact| contact.end > contact.start);
        own.splice(0..0, both);
    }

    /// The pose before its feet are put where they are.
    fn unplanted(&self, run: &BodyPose, time: f64) -> BodyPose {
        if time <= self.struck {
            return self.walked.gait.at(time).pose;
        }
        let mut pose = with_clip(&self.owners, run, &self.walked.frame(time).pose);
        let since = time - self.struck;
        if since < HIPS {
            for (turn, [off, rate]) in pose.turns.iter_mut().zip(&self.off) {
                *turn = (DQuat::from_scaled_axis(hold::left(*off, *rate, since, LETS_GO)) * *turn).normalize();
            }
            let [off, rate] = self.off_hips;
            pose.hips += hold::left(off, rate, since, HIPS);
        }
        let left = self.walked.left_over(time);
        let Some(clip) = self.walked.taken_up(time).filter(|_| left < 1.0) else { return pose };
        if left <= 0.0 {
            return clip;
        }
        BodyPose {
            hips: clip.hips.lerp(pose.hips, left),
            turns: clip.turns.iter().zip(&pose.turns).map(|(clip, own)| clip.slerp(*own, left)).collect(),
        }
    }

    /// Where a foot is that the run has there at a time.
    fn foot(&self, body: &Body, run: &BodyPose, side: Side, time: f64) -> Foot {
        let own = target(body, side, run);
        let mut shown = match &self.lands[side as usize] {
            Some(landing) if self.struck < time && time < landing.from => {
                return leg_foot(&landing.foot(&self.walked, side, time));
            }
            _ => self.joined[side as usize].of(&own, time),
        };
        if let Some((roll, stood)) = self.rolls[side as usize].as_ref().filter(|(roll, _)| time > roll.from) {
            let share = smooth3((time - roll.from) / (roll.lands - roll.from).max(self.dt));
            let rolled = self.walked.rolled_off(body, roll, stood, time);
            shown = FootOffset::between(body, side, &shown, &rolled).on(&shown, share);
        }
        let shown = self.walked.foot(side, time, &shown);
        let shown = blended(&shown, &own, smooth3((time - self.lost) / FALLS));
        leg_foot(&shown)
    }

    /// The pose at a time, of a run that is so then.
    pub(super) fn pose(&self, body: &Body, anatomy: &Anatomy, run: &BodyPose, time: f64) -> BodyPose {
        let mut pose = self.unplanted(run, time);
        pose.hips.y -= if self.lowered.is_empty() { 0.0 } else { sample(&self.lowered, self.dt, time) };
        let positions = pose.positions(body);
        let ahead = pose.turns[0] * DVec3::Z;
        for side in Side::BOTH {
            let wanted = self.foot(body, run, side, time);
            leg::reach(body, anatomy, &mut pose, &positions, (side, Some(ahead)), &wanted);
        }
        bound(body, pose)
    }

    /// Lowers the body where a leg does not reach its foot otherwise.
    fn lower(&mut self, played: &Played, run: &Run, end: f64) {
        // Between ticks, too: a foot that lands there is the farthest off then.
        let need = |piece: usize| {
            let time = (piece as f64 * self.dt / BETWEEN_TICKS as f64).min(end);
            let own = played.held_pose(run.body, run.anatomy, run.terrain, time);
            let feet = Side::BOTH.map(|side| self.foot(run.body, &own, side, time));
            too_high(run.body, run.anatomy, &self.unplanted(&own, time), &feet)
        };
        let needs: Vec<f64> = (0..played.run.len() * BETWEEN_TICKS).map(need).collect();
        let most = |pieces: &[f64]| pieces.iter().copied().fold(0.0, f64::max);
        let needs: Vec<f64> = needs.chunks(BETWEEN_TICKS).map(most).collect();
        let home = self.walked.ends_in_clip(end);
        self.lowered = lowered(&needs, self.dt, &|time| if home { smooth3((end - time) / LOWERS) } else { 1.0 });
    }

    /// What the feet hold, in order of start, left before right.
    pub(super) fn contacts(&self) -> &[FootContact] {
        &self.contacts
    }

    /// s, from when to when it is not the clip; and from when to when it is the run alone.
    pub(super) fn away(&self) -> [[f64; 2]; 2] {
        let [lifts, lands] = self.walked.way_back_over().unwrap_or([f64::INFINITY; 2]);
        [[self.struck, lands], [self.struck + HIPS, lifts]]
    }

    /// s, from when to when a foot touches what the run's touches.
    pub(super) fn touches(&self, side: Side) -> [f64; 2] {
        let joined = &self.joined[side as usize];
        let bears = self.lands[side as usize].is_some() || self.walked.bearing(side, self.struck).is_some();
        let from = if bears { joined.from() } else { joined.settled() };
        [from, self.walked.leaves(side).unwrap_or(f64::INFINITY)]
    }

    /// The clip, and what there is to say.
    pub(super) fn walked(&self) -> &Walked {
        &self.walked
    }
}

fn target(body: &Body, side: Side, pose: &BodyPose) -> FootTarget {
    let foot = Foot::of(body, pose, &pose.positions(body), side);
    FootTarget {
        ankle: foot.ankle,
        foot: foot.foot,
        toe: foot.toe,
        yaw: foot_yaw(body, side, foot.foot),
        soft: 0.0,
        bend: None,
        swivel: 0.0,
    }
}

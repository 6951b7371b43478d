//! Both feet over a whole run, as exact functions of time. Scenario space, metres, radians.
//!
//! Each is a `FootPath` in the ground's frame; here they are on the ground, which may turn, over a base clip where there is one, and
//! in the legs, whose ankles let a heel come up.

use super::clearance::Raise;
use super::contacts::FootContact;
use super::feet_based::Based;
use super::foot_path::{FootPath, MOST_PITCH, turned};
use super::swing::Extra;
use crate::maths::curve::bump;
use crate::maths::real;
use crate::model::scenario::GroundKind;
use crate::model::{Body, Side, Terrain, report::Part};
use crate::stepper::{Physique, Plant, Step};
use crate::whole_body::Anatomy;
use crate::whole_body::solve::{FootTarget, Solved};
use glam::{DVec2, DVec3};

/// rad, dorsiflexion past which the heel comes up: a little inside of the ankle's range of 30 degrees.
const DORSIFLEXION: f64 = 26.0 * std::f64::consts::PI / 180.0;
/// rad, the same of a walker, whose heel leaves sooner.
const WALKING_DORSIFLEXION: f64 = 13.0 * std::f64::consts::PI / 180.0;
/// s, the longest that a foot stays on its ball after landing: longer, and the weight behind it has nothing to stand on.
const LONGEST_SETTLE: f64 = 0.16;
/// s, the same while the pressure is ahead of [`HEEL_FREE`].
const FREE_SETTLE: f64 = 0.30;
/// Part of the way from ankle to ball that the pressure must be past for a heel that landed last to stay up.
const HEEL_FREE: f64 = 0.3;
/// Part of the way from ankle to ball that the pressure must be past before the heel may rise early.
const WEIGHT_AHEAD: f64 = 0.6;
/// rad, dorsiflexion with which a foot may land.
const LANDING_FLEXION: f64 = 16.0 * std::f64::consts::PI / 180.0;

/// Both feet over a whole run.
#[derive(Clone, Debug)]
pub struct FootCurves {
    pub(super) feet: [FootPath; 2],
    pub(super) terrain: Terrain,
    pub(super) base: Based,
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
        terrain: &Terrain,
    ) -> FootCurves {
        let feet = Side::BOTH.map(|side| FootPath::new(body, physique, side, start, steps, still_until, scale));
        let mut curves = FootCurves { feet, terrain: terrain.clone(), base: Based::Not };
        curves.clear_the_ground();
        curves
    }

    /// Where a foot is.
    pub fn at(&self, side: Side, time: f64) -> FootTarget {
        let mut target = self.feet[side as usize].at(time, &self.terrain);
        match &self.base {
            Based::Not => {}
            Based::Stand(base) => target = base[side as usize].0.on(&target, self.as_in_base(side, time)),
            Based::Walk(walked) => target = walked.foot(side, time, &target),
        }
        if !self.terrain.moves() {
            return target;
        }
        let turn = self.terrain.turn(time);
        let ahead = turn * DVec3::new(real::sin(target.yaw), 0.0, real::cos(target.yaw));
        FootTarget {
            ankle: turn * target.ankle,
            foot: turn * target.foot,
            toe: turn * target.toe,
            yaw: real::atan2(ahead.x, ahead.z),
            ..target
        }
    }

    /// What a foot turns beside its curve, to be read and set.
    pub(super) fn extra(&mut self, side: Side) -> &mut Extra {
        &mut self.feet[side as usize].extra
    }

    /// rad, least and greatest turn beside its curve that a foot's contact leaves it then, in pitch and in roll; `dt`: s that it stays
    /// away from where it is flat.
    pub(super) fn room(&self, side: Side, time: f64, dt: f64) -> [[f64; 2]; 2] {
        self.feet[side as usize].room(time, dt)
    }

    /// Raises the swings over a mesh again, for feet that were turned since.
    pub(super) fn clear_a_mesh(&mut self) {
        if matches!(self.terrain.kind, GroundKind::Mesh { .. }) {
            self.clear_the_ground();
        }
    }

    /// Raises the swings over what lies between their plants.
    pub(super) fn clear_the_ground(&mut self) {
        let FootCurves { feet, terrain, .. } = self;
        let mesh = matches!(terrain.kind, GroundKind::Mesh { .. });
        if !mesh && !matches!(terrain.kind, GroundKind::Stairs { .. } | GroundKind::Uneven { .. }) {
            return;
        }
        for path in feet {
            for number in 0..path.swings.len() {
                path.swings[number].raise = Raise::NONE;
                let swing = path.swings[number];
                if mesh && path.over_a_plane(&swing, terrain) {
                    continue;
                }
                let way = swing.to.ankle - swing.from.ankle;
                let way = DVec2::new(way.x, way.z).normalize_or_zero();
                path.swings[number].raise = Raise::over(terrain, way, swing.clearance, &|u, points| {
                    let time = swing.lift + (swing.land - swing.lift) * u;
                    path.sole_points(&path.flown(&swing, time, terrain), points);
                });
            }
        }
    }

    /// How free a foot is to leave its curve: 0 planted, 1 in mid-swing.
    pub fn freedom(&self, side: Side, time: f64) -> f64 {
        if self.is_clips(side, time) {
            return 0.0;
        }
        let path = &self.feet[side as usize];
        path.swings
            .iter()
            .find(|swing| time > swing.lift && time < swing.land)
            .map_or(0.0, |swing| bump(swing.along(time)).sqrt())
    }

    /// Lets heels come up (and stay up after a backward landing) where an ankle would bend past its range.
    /// `solved`: the poses of the present curves, `dt` s apart; `cop`: the centre of pressure then, (x, z). Call it a few times over.
    pub fn ease_ankles(&mut self, body: &Body, anatomy: &Anatomy, solved: &[Solved], cop: &[DVec2], dt: f64) {
        for side in Side::BOTH {
            let leg = &anatomy.legs[side as usize];
            let shank = body.joints[leg.lower].rest - body.joints[leg.foot].rest;
            let path = &mut self.feet[side as usize];
            let terrain = &self.terrain;
            // rad, how far the shank leans forwards over the flat foot.
            let lean = |index: usize, plant: &Plant| {
                let foot = terrain.turn(index as f64 * dt) * turned(plant, 0.0);
                let up = foot.inverse() * (solved[index].pose.turns[leg.lower] * shank);
                real::atan2(up.z, up.y)
            };
            // m, how far the pressure is ahead of the middle of a foot's ball: a heel under the weight stays down.
            let ball = body.feet[side as usize].ball;
            let ahead = |index: usize, plant: &Plant| {
                let ankle = terrain.turn(index as f64 * dt) * plant.ankle;
                let from_ankle = cop[index.min(cop.len() - 1)] - DVec2::new(ankle.x, ankle.z);
                from_ankle.dot(DVec2::new(real::sin(plant.yaw), real::cos(plant.yaw))) - WEIGHT_AHEAD * ball
            };
            let heel_free = |index: usize, plant: &Plant| ahead(index, plant) > (HEEL_FREE - WEIGHT_AHEAD) * ball;
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
                    let forwards = lean(index, &swing.from);
                    let pitch = swing.pitch(time);
                    let most = if swing.walks { WALKING_DORSIFLEXION } else { DORSIFLEXION };
                    if swing.onward && ahead(index, &swing.from) > 0.0 && forwards - pitch > most {
                        swing.heel_off = swing.heel_off.max((swing.lift - time + 0.05).min(swing.lift - before));
                        swing.peak = swing.peak.max((forwards - most + 0.10).min(MOST_PITCH));
                    }
                }
                // The leg lands as its shank leans: reaching ahead heel first, under the body flat, behind it ball first.
                let landing = *ticks(swing.land, swing.land).end();
                let least = lean(landing, &swing.to) - LANDING_FLEXION;
                if swing.strike < least {
                    swing.strike = if least.abs() < 2_f64.to_radians() { 0.0 } else { least.min(MOST_PITCH) };
                }
                if swing.strike >= 0.0 {
                    for index in ticks(swing.land, (swing.land + 0.6).min(after)) {
                        let time = index as f64 * dt;
                        let excess = lean(index, &swing.to) - swing.pitch(time) - DORSIFLEXION;
                        if excess > 0.0 {
                            swing.strike = (swing.strike + 0.5 * excess).min(MOST_PITCH);
                            let longest = if heel_free(index, &swing.to) { FREE_SETTLE } else { LONGEST_SETTLE };
                            swing.settle =
                                swing.settle.max((time - swing.land + 0.06).min(after - swing.land).min(longest));
                        }
                    }
                }
            }
        }
        self.clear_the_ground();
        self.join(body);
    }

    /// All contacts up to `end`, in order of start, left before right.
    pub fn contacts(&self, end: f64) -> Vec<FootContact> {
        let mut contacts = Vec::new();
        for side in Side::BOTH {
            let from = contacts.len();
            self.feet[side as usize].contacts(side, end, &mut contacts);
            if let Based::Walk(walked) = &self.base {
                let own: Vec<FootContact> = contacts.drain(from..).collect();
                contacts.extend(walked.contacts(side, &own, end));
            }
            if matches!(&self.base, Based::Stand(base) if base[side as usize].1) {
                for contact in &mut contacts[from..] {
                    let middle = 0.5 * (contact.start + contact.end);
                    if contact.part == Part::Flat && self.as_in_base(side, middle) == 1.0 {
                        contact.part = Part::Ball;
                    }
                }
            }
        }
        contacts.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.side.cmp(&b.side)));
        contacts
    }
}

//! What the parts of the body should do, as accelerations, and the corners that can bear. Scenario space, SI.

use super::control::{Controller, Swing};
use super::dynamics::{Acceleration, LegMap, Wrench};
use super::figure::{Figure, Freedom, Part};
use super::forces::Corner;
use super::guide;
use super::kerb;
use super::ranges::leaning;
use super::slope;
use super::sole::POINTS;
use super::swing::{self, LANDS};
use super::{flat, short};
use crate::maths::curve::smooth3;
use crate::maths::quat::{wrap_angle, yaw_of};
use crate::model::{Side, Terrain};
use glam::{DQuat, DVec2, DVec3};

/// Share of a leg's length by which it is shortened on ground that leans by a right angle.
const STEEP: f64 = 0.3;
/// rad, how far a shove may turn a body for good. 16 people's 24 clips each, shoves of 100 to 180 Ns: 89 % stand with this bound, 88 % with
/// twice as much and 89 % with none, but with none some end turned by 40 to 130 degrees.
const TURNED: f64 = 0.25;

/// m at legs of 0.83 m, at most so much higher goes a foot whose toes hang down in a step against a fall where they are not lifted.
const CLEARS: f64 = 0.015;
/// Shares of a swing against a fall in which the height for hanging toes is gained and lost. A foot behind the body points down by 30 degrees:
/// without that height its toes touch while it is still on its way, at 3 m/s. In 240 shoves of who stands feet slide so that it is seen 174 times
/// then; 138 times with it, 116 times with toes that lie level too. Lost later (0.4), a few more fall of who is shoved hard in a walk.
const HANGS: [f64; 2] = [0.3, 0.7];
/// m/s at legs of 0.83 m: who falls no faster than the first lifts and levels toes that point down, faster than the second not at all. Of 256 people
/// shoved by 150 to 200 Ns 75 % stood with toes lifted at any speed, 85 % so; by 200 to 250 Ns 34 and 41 % (with other steps than now).
const HURRIED: [f64; 2] = [1.1, 1.5];

impl Controller {
    /// The middle of what bears, (x, z).
    pub(super) fn support_middle(&self, figure: &Figure) -> DVec2 {
        match (self.swing, self.shifting) {
            (Some(swing), _) => self.sole_middle(figure, swing.side.other()),
            (_, Some((side, _))) => self.sole_middle(figure, side.other()),
            _ => self.at_rest(0.5 * (self.sole_middle(figure, Side::Left) + self.sole_middle(figure, Side::Right))),
        }
    }

    /// Where it is to face: whoever steps lets himself be turned, a little; who is led faces where he is led.
    pub(super) fn face(&mut self) {
        if self.guide.is_none() && self.swing.is_some() {
            let faces = yaw_of(self.states[0].turn * self.tilted().inverse());
            self.heading += 0.03 * wrap_angle(faces - self.heading);
            self.heading = self.facing + wrap_angle(self.heading - self.facing).clamp(-TURNED, TURNED);
        }
    }

    /// m, the pelvis's height: the stand's, or less where a leg would not reach.
    pub(super) fn wanted_height(&self, figure: &Figure, terrain: &Terrain, floor: f64) -> f64 {
        let pelvis = self.states[0];
        let [arrives, carries] = [false, true].map(|carries| self.leg_used(terrain, carries));
        let floor = self.guide.map_or(floor, |guide| guide.floor);
        let mut height = self.pelvis_height + floor - self.tuning.crouch * self.size - self.lower + self.raised();
        // On steep ground the knees are bent beforehand: a step down it must find ground.
        let uphill = self.faces_up(terrain);
        let crouch = STEEP * (1.0 - terrain.spot(flat(pelvis.origin)).normal.y);
        for side in Side::BOTH {
            let [hip, knee, ankle] = figure.legs[side as usize];
            let length = figure.links[knee].anchor.length() + figure.links[ankle].anchor.length();
            let hip_at = self.states[hip].origin;
            let over = hip_at.y - pelvis.origin.y;
            let (foot, reach) = match self.swing {
                Some(swing) if swing.side == side => {
                    let left = (swing.start + swing.time - self.time).max(0.0);
                    let goal = swing.target - self.ahead(side, swing.yaw);
                    let drift = flat(self.motion.velocity) * left;
                    let lands = self.under_sole(figure, terrain, side, goal, swing.yaw) + figure.ankle_height;
                    let kerb = self.guided && self.steps_over(terrain, &swing);
                    let y = if kerb { lands } else { self.states[ankle].origin.y.min(lands) };
                    let early = if kerb { kerb::REACHES } else { 0.05 };
                    (DVec3::new(goal.x - drift.x, y, goal.y - drift.y), arrives + early * left / swing.time)
                }
                _ => {
                    // Who is at ease stands as in the stand, almost straight.
                    let ease = ((self.time - self.alarmed) / self.size.sqrt() - 0.5).clamp(0.0, 1.0);
                    let alarmed = if self.swing.is_some() { carries } else { self.tuning.reach[0] };
                    let used = alarmed + (self.tuning.at_ease - alarmed).max(0.0) * ease - crouch;
                    let used = if self.swing.is_none() { slope::straightened(used, uphill) } else { used };
                    (self.states[ankle].origin, used)
                }
            };
            let away = (flat(hip_at) - flat(foot)).length();
            let reach = reach * length;
            let above = (reach * reach - away * away).max(0.09 * length * length).sqrt();
            height = height.min(foot.y + above - over);
        }
        height.max(floor + 0.72 * self.pelvis_height - self.lower)
    }

    /// What a foot's link should do.
    pub(super) fn foot_task(&self, figure: &Figure, terrain: &Terrain, side: Side) -> Acceleration {
        let foot = figure.legs[side as usize][2];
        let state = &self.states[foot];
        let tuning = &self.tuning;
        match self.swing {
            Some(swing) if swing.side == side => {
                let spot = self.lies(figure, terrain, side, flat(swing.reference.at), swing.yaw);
                let flat = DQuat::from_rotation_arc(DVec3::Y, spot.normal) * DQuat::from_rotation_y(swing.yaw);
                let (level, spin, _) = self.heeds(figure, side, flat, tuning.margin[1] - leaning(terrain));
                let goal = self.swing_goal(figure, &swing, [flat, level], spot.normal);
                // Never so far that the knee would be straight: there a leg cannot be steered.
                let [hip, knee, ankle] = figure.legs[side as usize];
                let length = figure.links[knee].anchor.length() + figure.links[ankle].anchor.length();
                let hip = self.states[hip].origin;
                let goal = hip + (goal - hip).clamp_length_max(self.stretches(&swing) * length);
                let velocity = self.motion.origin_velocity(foot);
                let error = short(level * state.turn.inverse());
                let asked = swing.reference.acceleration
                    + (goal - state.origin) * tuning.foot[0]
                    + (swing.reference.velocity - velocity) * tuning.foot[1];
                let [stiff, damp] = self.foot_turn((self.time - swing.start) / swing.time);
                // A foot that could not stop in time would be carried over the one that stands.
                let brakes = if asked.with_y(0.0).dot(velocity) < 0.0 { tuning.brakes } else { 1.0 };
                Acceleration {
                    linear: asked.clamp_length_max(tuning.foot_most[0] * brakes),
                    angular: (error * stiff + (spin + spot.normal * swing.spin - state.spin) * damp)
                        .clamp_length_max(tuning.foot_most[1]),
                }
            }
            _ => {
                let spot = self.stood_on(figure, terrain, side);
                let sole = &self.soles[side as usize];
                let tilt = short(sole.wanted * state.turn.inverse());
                let tilt = tilt - spot.normal * tilt.dot(spot.normal);
                // A sole that came off goes back down; one that is not as wanted turns about where it stands.
                let corners = sole.points.iter().take(figure.stiff_sole(side).len()).enumerate();
                let plane = self.plane_under(figure, terrain, side);
                let height = |(index, corner): (usize, &DVec3)| {
                    let at = figure.carried(&self.states, side, index, *corner);
                    at.y - self.borne_by(terrain, &plane, flat(at))
                };
                let low = corners.map(height).fold(f64::INFINITY, f64::min);
                let gap = low.clamp(-0.002, 0.1);
                let back = spot.normal * ((gap + 0.001).max(0.0) * tuning.settle);
                let goes = (sole.spin - state.spin) * (sole.gives * tuning.follows);
                let angular = (tilt * tuning.level + goes - state.spin * tuning.hold).clamp_length_max(400.0);
                let held = -self.motion.origin_velocity(foot) * tuning.hold - back;
                Acceleration {
                    linear: held.clamp_length_max(100.0) + angular.cross(state.origin - sole.pivot),
                    angular,
                }
            }
        }
    }

    /// m, where the ankle of a swinging foot is to be that is turned so and would lie flat with the turn `level`: over its reference, and what
    /// is lowest of its sole clears the ground as it would if it lay level.
    pub(super) fn swing_goal(&self, figure: &Figure, swing: &Swing, [level, turn]: [DQuat; 2], up: DVec3) -> DVec3 {
        let corners = figure.soles[swing.side as usize].iter();
        let lowest = corners.map(|corner| (turn * *corner).dot(up)).fold(0.0, f64::min);
        let share = (self.time - swing.start) / (LANDS * swing.time);
        let (aloft, most) = match self.guided {
            true if self.treads => (swing::aloft(share, kerb::HANGS), kerb::CLEARS),
            true => (swing::aloft(share, guide::HANGS), guide::CLEARS),
            false if self.on_open_ground() => {
                (swing::aloft(share, HANGS), CLEARS + (guide::CLEARS - CLEARS) * self.unhurried())
            }
            false => (swing::lift(share)[0], CLEARS),
        };
        let off = self.over_ball(figure, swing.side, level, turn);
        let under = (-lowest - figure.ankle_height - off.y).clamp(0.0, most * self.size);
        swing.reference.at + off + DVec3::Y * (figure.ankle_height + under * aloft)
    }

    /// How little who steps against a fall is in a hurry: then he lifts toes that point down, 0 to 1. Who is on his way lifts them at any speed.
    pub(super) fn unhurried(&self) -> f64 {
        if self.going != DVec2::ZERO {
            return 1.0;
        }
        let speed = flat(self.motion.velocity).length() / self.size.sqrt();
        1.0 - smooth3((speed - HURRIED[0]) / (HURRIED[1] - HURRIED[0]))
    }

    /// Share of its length that a swinging leg may use now.
    pub(super) fn stretches(&self, swing: &Swing) -> f64 {
        let begun = if self.guided { guide::bends((self.time - swing.start) / swing.time) } else { 1.0 };
        1.0 - (1.0 - self.tuning.stretch) * begun
    }

    /// All links' accelerations for one of the pelvis; the wrench that they take.
    pub(super) fn spread(
        &mut self,
        figure: &Figure,
        legs: &[LegMap; 2],
        feet: &[Acceleration; 2],
        root: &Acceleration,
        trunk: DVec3,
    ) -> Wrench {
        let count = figure.links.len();
        self.accelerations.clear();
        self.accelerations.resize(count, Acceleration::default());
        self.accelerations[0] = *root;
        for side in 0..2 {
            let [hip, knee, ankle] = figure.legs[side];
            let shank = self.states[knee].turn;
            let held = shank * DVec3::Y;
            let held = held * held.dot(self.relative[ankle]);
            let [a, b, c] = legs[side].solve(figure, &self.motion, root, &feet[side], held);
            for (link, relative) in [(hip, a), (knee, b), (ankle, c)] {
                let parent = figure.links[link].parent.unwrap_or(0);
                self.accelerations[link] = self.motion.child(figure, link, &self.accelerations[parent], relative);
            }
        }
        for index in 1..count {
            let link = &figure.links[index];
            match link.part {
                Part::Thigh(_) | Part::Shank(_) | Part::Foot(_) => {}
                // Flat on the ground or along with the foot: as light as they are it is one to the rest.
                Part::Toes(_) => {
                    let parent = link.parent.unwrap_or(0);
                    let along = self.motion.child(figure, index, &self.accelerations[parent], DVec3::ZERO);
                    self.accelerations[index] = along;
                }
                Part::Trunk if self.tuning.apart => {
                    let parent = self.accelerations[0];
                    let still = self.motion.child(figure, index, &parent, DVec3::ZERO);
                    self.accelerations[index] = Acceleration { angular: trunk, ..still };
                }
                _ => {
                    let parent = link.parent.unwrap_or(0);
                    let relative = match link.freedom {
                        Freedom::Hinge { axis, .. } => {
                            let axis = self.states[parent].turn * axis;
                            axis * axis.dot(self.relative[index])
                        }
                        _ => self.relative[index],
                    };
                    self.accelerations[index] = self.motion.child(figure, index, &self.accelerations[parent], relative);
                }
            }
        }
        self.motion.wrench(figure, &self.accelerations)
    }

    /// Corners of the feet that bear, named.
    pub(super) fn corners(&self, figure: &Figure, terrain: &Terrain) -> Vec<(usize, Corner)> {
        let mut corners = Vec::with_capacity(2 * POINTS);
        let moving = self.swing.is_some() || self.guide.is_some();
        for side in Side::BOTH {
            if self.swing.is_some_and(|swing| swing.side == side) {
                continue;
            }
            let leaves = self.leaving.is_some_and(|(leaving, _)| leaving == side)
                || self.guide.is_some_and(|guide| guide.leaves == Some(side));
            let dear = if leaves { 30.0 } else { 1.0 };
            let [a, b, .., y, z] = figure.soles[side as usize];
            let middle = 0.25 * (a + b + y + z);
            let points = if self.treads { self.soles[side as usize].points } else { figure.soles[side as usize] };
            for (index, corner) in points.iter().enumerate() {
                let corner = middle + (*corner - middle) * self.tuning.inside;
                let at = figure.carried(&self.states, side, index, corner);
                let spot = terrain.spot(flat(at));
                let lifted = self.soles[side as usize].lifted[index] / self.size;
                if at.y - spot.height < 0.02 * self.size && lifted < self.tuning.lifted[0] {
                    let dear = dear * (1.0 + lifted * self.tuning.lifted[1]);
                    let corner = Corner {
                        at,
                        normal: spot.normal,
                        foot: side as usize,
                        dear,
                        least: if moving || self.shifting.is_some() { 0.0 } else { self.tuning.least / POINTS as f64 },
                    };
                    corners.push((side as usize * POINTS + index, corner));
                }
            }
        }
        corners
    }
}

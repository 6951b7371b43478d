//! What the law knows of the ranges of the ankles: where one ends, its sole gives way. Radians from the stand, scenario space, SI.
//!
//! As people do it when the body goes on over a foot: the sole turns with the shank about the edge that stays on the ground (the heel rises),
//! and only that edge bears.

use super::control::Controller;
use super::figure::Figure;
use super::guide::Guide;
use super::kerb;
use super::ranges::leaning;
use super::sole::POINTS;
use super::{flat, short};
use crate::maths::curve::smooth3;
use crate::maths::quat::yaw_of;
use crate::maths::real;
use crate::model::{Side, Terrain};
use glam::{DQuat, DVec3};

/// rad, by which a sole has given way where it follows its shank in full.
const HEEDS: f64 = 0.04;
/// Lengths of soles, of the leg's, from which on they are long for it and where they are so in full, and rad past its range's end from which
/// on such a sole gives way. Measured on a body with feet of 1.1 legs, which fell over them at 60 N s; people's are 0.3 to 0.36.
const LONG: [f64; 2] = [0.45, 0.75];
const BROAD: f64 = 0.1;

/// m, as how much lifted what is over a gap or a lower tread counts: more than any foot.
pub(super) const OVER: f64 = 1e3;

/// How a sole is to lie.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sole {
    /// The foot's turn that is wanted: flat on the ground, or as near to it as the ankle goes.
    pub(super) wanted: DQuat,
    /// The turn of a foot that lies flat as this one points.
    pub(super) level: DQuat,
    /// rad/s, how it is wanted to turn.
    pub(super) spin: DVec3,
    /// How much it gives way, 0 to 1.
    pub(super) gives: f64,
    /// m, how much higher each corner is then than the lowest.
    pub(super) lifted: [f64; POINTS],
    /// m, about which point it turns.
    pub(super) pivot: DVec3,
    /// m, its points in the foot's frame, drawn in to what of the ground is under them.
    pub(super) points: [DVec3; POINTS],
}

/// The swing of what hangs down in the stand, as a turn about a level axis.
fn swing(relative: DQuat) -> DVec3 {
    let bone = relative * DVec3::NEG_Y;
    let axis = DVec3::NEG_Y.cross(bone);
    axis.normalize_or_zero() * real::atan2(axis.length(), -bone.y)
}

/// Least and most swing about x and z for ranges of flexion (of a limb: about -x) and of turning outwards (of a left one: about z).
fn ends(flexion: [f64; 2], outward: [f64; 2], side: Side) -> [[f64; 2]; 2] {
    let about_z = if side == Side::Left { outward } else { [-outward[1], -outward[0]] };
    [[-flexion[1], -flexion[0]], about_z]
}

/// A swing that is within ends, by a margin.
fn within(swing: DVec3, [x, z]: [[f64; 2]; 2], margin: f64) -> DVec3 {
    let held = |value: f64, [low, high]: [f64; 2]| {
        let (low, high) = ((low + margin).min(0.0), (high - margin).max(0.0));
        value.clamp(low, high)
    };
    DVec3::new(held(swing.x, x), 0.0, held(swing.z, z))
}

/// The turn of a foot nearest to `turn` that leaves its swing against the shank within ends, by a margin.
fn held(shank: DQuat, turn: DQuat, ends: [[f64; 2]; 2], margin: f64) -> DQuat {
    let relative = shank.inverse() * turn;
    let swung = swing(relative);
    let kept = within(swung, ends, margin);
    if kept == swung {
        return turn;
    }
    let twist = DQuat::from_scaled_axis(swung).inverse() * relative;
    shank * DQuat::from_scaled_axis(kept) * twist
}

/// The turn and the spin (rad/s) of a foot that bends at its toes: while these lie on the ground its heel rises about their hinge alone. Feet
/// that point outwards have it askew: raised about what is across the body, 0.4 rad roll them by 0.04 rad that the ground does not give, and
/// the law's torques are 20 N m off.
fn hinged(across: DVec3, level: DQuat, wanted: DQuat, spin: DVec3) -> (DQuat, DVec3) {
    let pitch = short(wanted * level.inverse()).dot(across);
    if pitch <= 0.0 {
        return (wanted, spin);
    }
    (DQuat::from_axis_angle(across, pitch) * level, across * across.dot(spin))
}

impl Controller {
    /// A foot's turn nearest to that one that its ankle's range less a margin (rad) allows, rad/s by which it then follows its shank, and how
    /// much it gives way, 0 to 1.
    pub(super) fn heeds(&self, figure: &Figure, side: Side, turn: DQuat, margin: f64) -> (DQuat, DVec3, f64) {
        let shank = &self.states[figure.legs[side as usize][1]];
        let [.., flexion, inversion] = figure.leg_ranges[side as usize];
        let ends = ends(flexion, [-inversion[1], -inversion[0]], side);
        let wanted = match self.stance.as_ref().map(|stance| DQuat::from_rotation_y(stance.splay[side as usize])) {
            // Ranges are about the foot's own axes.
            Some(out) => held(shank.turn * out, turn * out, ends, margin) * out.inverse(),
            None => held(shank.turn, turn, ends, margin),
        };
        let tilt = short(wanted * turn.inverse());
        let gives = smooth3(tilt.length() / HEEDS);
        let about = tilt.normalize_or_zero();
        (wanted, about * (about.dot(shank.spin) * gives), gives)
    }

    /// m, how far off an ankle is whose foot, turned so, stands on its ball where it would lie flat with the turn `level`; none but
    /// where feet stand on their balls.
    pub(super) fn over_ball(&self, figure: &Figure, side: Side, level: DQuat, turn: DQuat) -> DVec3 {
        let ball = figure.ball(side);
        (level * ball - turn * ball) * self.on_balls()
    }

    /// How far a foot is one that stands on its ball, 0 to 1: uphill both, in a walk of long strides that whose heel is up.
    fn on_ball(&self, side: Side) -> f64 {
        let rises = |guide: &Guide| guide.heel.is_some_and(|(foot, pitch)| foot == side && pitch > 0.0);
        self.guide.filter(rises).map_or(0.0, |guide| guide.strides).max(self.on_balls())
    }

    /// m, where a foot's ankle is; where feet stand on their balls, where it would be if this one lay flat instead.
    pub fn laid_flat(&self, figure: &Figure, side: Side) -> DVec3 {
        let state = &self.states[figure.legs[side as usize][2]];
        let (ball, level) = (figure.ball(side), self.soles[side as usize].level);
        state.origin - (level * ball - state.turn * ball) * self.on_ball(side)
    }

    /// How the sole of a foot that bears is to lie.
    pub(super) fn sole(&self, figure: &Figure, terrain: &Terrain, side: Side) -> Sole {
        let [.., foot] = figure.legs[side as usize];
        let state = &self.states[foot];
        let normal = self.stood_on(figure, terrain, side).normal;
        let level = DQuat::from_rotation_arc(state.turn * DVec3::Y, normal) * state.turn;
        // Feet that are long for their legs are stood on flat: the way over their tips is too far.
        let corners = self.drawn_in(figure, terrain, side);
        let long = (figure.sole_share(side) - LONG[0]) / (LONG[1] - LONG[0]);
        let margin = self.tuning.margin[0] - leaning(terrain) - BROAD * long.clamp(0.0, 1.0);
        let heel = self.guide.and_then(|guide| guide.heel).filter(|(foot, pitch)| *foot == side && *pitch > 0.0);
        // Toes stay where they are as the heel rises.
        let stiff = figure.stiff_sole(side).len();
        // Uphill and down flights. Elsewhere the law's constants were found with heels that rise square to the body: with hinges a walk over
        // gaps falls.
        let hinge = stiff < POINTS && self.on_balls() > 0.0;
        let across =
            if hinge { level * figure.heel_axis(side) } else { DQuat::from_rotation_y(yaw_of(state.turn)) * DVec3::X };
        let raised = heel.map_or(level, |(_, pitch)| DQuat::from_axis_angle(across, pitch) * level);
        let (mut wanted, mut spin, gives) = self.heeds(figure, side, raised, margin);
        if hinge {
            (wanted, spin) = hinged(across, level, wanted, spin);
        }
        let heights = corners.map(|corner| (wanted * corner).dot(normal));
        let lowest = heights[..stiff].iter().copied().fold(f64::INFINITY, f64::min);
        let mut lifted = heights.map(|height| (height - lowest).max(0.0));
        // It turns about what is lowest now and stays so.
        let at: [DVec3; POINTS] =
            std::array::from_fn(|index| figure.carried(&self.states, side, index, corners[index]));
        // What is over a gap or a lower tread bears nothing.
        let plane = self.plane_under(figure, terrain, side);
        for (at, lifted) in at.iter().zip(&mut lifted).filter(|_| terrain.has_edges()) {
            let spot = terrain.spot(flat(*at));
            if !spot.holds || spot.height < plane(flat(*at)) - kerb::LOWER * self.size {
                *lifted = OVER;
            }
        }
        let over: [f64; POINTS] = std::array::from_fn(|index| {
            let height = at[index].y - self.borne_by(terrain, &plane, flat(at[index]));
            if index < stiff { height + lifted[index] } else { f64::INFINITY }
        });
        let low = over.iter().copied().fold(f64::INFINITY, f64::min);
        let bearing = over.map(|height| (1.0 - (height - low) / (0.01 * self.size)).max(0.0));
        let weight: f64 = bearing.iter().sum();
        let about =
            (0..stiff).map(|index| figure.pivot(&self.states, side, index).unwrap_or(at[index]) * bearing[index]);
        let pivot = about.sum::<DVec3>() / weight.max(1e-9);
        Sole { wanted, level, spin, gives, lifted, pivot, points: corners }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ankle that flexes from -0.9 to 0.4 and turns inwards from -0.3 to 0.5.
    fn ankle(side: Side) -> [[f64; 2]; 2] {
        ends([-0.9, 0.4], [-0.5, 0.3], side)
    }

    #[test]
    fn a_flat_foot_stays_flat_within_its_ankle_s_range() {
        for (lean, yaw) in [(0.3, 0.0), (0.3, 0.5), (-0.7, 0.2)] {
            let flat = DQuat::from_rotation_y(yaw);
            let shank = flat * DQuat::from_rotation_x(lean);
            assert_eq!(held(shank, flat, ankle(Side::Left), 0.05), flat, "{lean} {yaw}");
        }
    }

    #[test]
    fn a_heel_rises_by_what_the_shank_leans_on_past_the_end() {
        for side in Side::BOTH {
            let shank = DQuat::from_rotation_x(0.6);
            let turned = short(held(shank, DQuat::IDENTITY, ankle(side), 0.05));
            assert!(turned.distance(DVec3::X * 0.25) < 1e-9, "{side:?}: {turned}");
        }
    }

    #[test]
    fn an_edge_rises_on_the_side_that_the_shank_leans_away_from() {
        // Both shanks lean to the left: the left foot's sole comes to face outwards of its shank, the right one's inwards.
        let shank = DQuat::from_rotation_z(-0.6);
        for (side, past) in [(Side::Left, 0.3), (Side::Right, 0.1)] {
            let turned = short(held(shank, DQuat::IDENTITY, ankle(side), 0.0));
            assert!(turned.distance(DVec3::NEG_Z * past) < 1e-9, "{side:?}: {turned}");
        }
    }

    #[test]
    fn a_heel_rises_about_the_hinge_of_toes_that_point_outwards() {
        let across = DQuat::from_rotation_y(0.1) * DVec3::X;
        let shank = DQuat::from_rotation_x(0.9);
        let free = held(shank, DQuat::IDENTITY, ankle(Side::Left), 0.0);
        let (wanted, spin) = hinged(across, DQuat::IDENTITY, free, DVec3::X);
        assert!((wanted * across).distance(across) < 1e-9, "the toes stay");
        assert!((free * across).distance(across) > 0.03, "they would not");
        assert!(short(wanted).dot(across) > 0.45 && spin.cross(across).length() < 1e-9, "{wanted} {spin}");
    }

    #[test]
    fn soles_that_lie_flat_or_tip_back_are_left_as_they_are() {
        for tips in [0.0, -0.2] {
            let turn = DQuat::from_rotation_x(tips);
            assert_eq!(hinged(DVec3::X, DQuat::IDENTITY, turn, DVec3::Z), (turn, DVec3::Z));
        }
    }
}

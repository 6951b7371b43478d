//! How a led foot gets over an edge of the ground: up before it travels, there before it comes down. Scenario space, SI.

use super::control::{Controller, Swing};
use super::figure::Figure;
use super::flat;
use super::lying::RISES;
use super::sole::{BALL, POINTS, TIP};
use crate::model::{Side, Terrain};
use glam::{DQuat, DVec2, DVec3};

/// m at legs of 0.83 m: ground by so much lower than under a sole's middle does not bear the rest of it.
pub(super) const LOWER: f64 = 0.02;
/// Share of a leg's length that it may use in excess at the start of a swing that lands on another tread: with less the pelvis drops to
/// where the landing leg reaches as soon as the foot leaves.
pub(super) const REACHES: f64 = 0.2;
/// m at legs of 0.83 m, at most so much higher goes a foot whose toes hang down: a knee that bends for a kerb leans the shank by more than
/// the ankle's range. With 0.06, as on the level, toes catch on the edge: of 20 walks up 5 cm none kept its feet, with this 17.
pub(super) const CLEARS: f64 = 0.15;
/// Shares of a swing in which that height is gained and lost.
pub(super) const HANGS: [f64; 2] = [0.2, 0.4];
/// m: ground that rises by less over a line is a plane.
const EVEN: f64 = 1e-6;
/// m at legs of 0.83 m: less is no step.
const LEVEL: f64 = 0.01;
/// Shares of a swing: before which a foot on its way up travels only if it is over the edge, at which it is over its place, and at which it
/// is highest; up and down.
const UP: [f64; 3] = [0.3, 0.945, 0.42];
const DOWN: [f64; 3] = [0.04, 0.7, 0.45];
/// Times the usual, how high over the edge a foot goes that steps up.
const HIGHER: f64 = 1.5;
/// Parts of the way at which the ground is asked.
const PARTS: i32 = 8;
/// How often the way from a point over an edge to the ball is halved to find the edge: to 0.1 mm.
const HALVES: u32 = 10;

/// A swing over an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Shares of the swing from which on it travels and at which it is over its place.
    pub(super) travels: [f64; 2],
    /// The share at which it is highest.
    pub(super) highest: f64,
    /// m, the highest ground on the way, and how high over it the foot goes.
    pub(super) over: f64,
    pub(super) lift: f64,
}

impl Controller {
    /// m, the points of a sole in its foot's frame: those over a lower tread are drawn in to the edge.
    pub(super) fn drawn_in(&self, figure: &Figure, terrain: &Terrain, side: Side) -> [DVec3; POINTS] {
        let mut points = figure.soles[side as usize];
        if !self.treads {
            return points;
        }
        let plane = self.plane_under(figure, terrain, side);
        // m, over which of the ground's heights under a point the sole's own ground lies by as much as bears it
        let over = |index: usize, point: DVec3| {
            let at = figure.carried(&self.motion.states, side, index, point);
            terrain.spot_under(at, RISES * self.size).height - plane(flat(at)) + LOWER * self.size
        };
        // The ball first: where it is over the edge itself, the heel is what bears.
        for index in (BALL..TIP).chain(0..BALL).chain(TIP..POINTS) {
            let inner = if (BALL..TIP).contains(&index) { index % 2 } else { BALL + index % 2 };
            let (out, ball) = (points[index], points[inner]);
            if over(index, out) >= 0.0 {
                continue;
            }
            let (mut inside, mut outside) = (1.0, 0.0);
            for _ in 0..HALVES {
                let middle = 0.5 * (inside + outside);
                *(if over(index, out.lerp(ball, middle)) >= 0.0 { &mut inside } else { &mut outside }) = middle;
            }
            points[index] = out.lerp(ball, inside);
        }
        points
    }

    /// m, where the points of a sole that stands are.
    pub(super) fn bearing_points(&self, figure: &Figure, side: Side) -> [DVec3; POINTS] {
        if !self.treads {
            return figure.sole_at(&self.motion.states, side);
        }
        let points = self.soles[side as usize].points;
        std::array::from_fn(|index| figure.carried(&self.motion.states, side, index, points[index]))
    }

    /// m, the height of the ground under a foot: on treads, under its sole's middle.
    pub(super) fn under_sole(&self, figure: &Figure, terrain: &Terrain, side: Side, ankle: DVec2, yaw: f64) -> f64 {
        if terrain.has_treads() {
            return terrain.spot(ankle + self.ahead(side, yaw)).height;
        }
        self.lies(figure, terrain, side, ankle, yaw).height
    }

    /// Does a swing go over an edge of the ground, or may it?
    pub(super) fn steps_over(&self, terrain: &Terrain, swing: &Swing) -> bool {
        if !terrain.is_mesh() {
            return terrain.has_treads();
        }
        let from = flat(swing.from) + self.ahead(swing.side, swing.yaw);
        let (way, far) = ((swing.target - from).normalize_or_zero(), swing.target.distance(from));
        far > 0.0 && terrain.edge(from, way, far).is_some()
    }

    /// The way of a led foot that is to stand at another height (m) than it stood; of one against a fall, if it goes up a tread.
    pub(super) fn over_kerb(
        &self,
        figure: &Figure,
        terrain: &Terrain,
        swing: &Swing,
        (stands, ground): (DVec2, f64),
    ) -> Option<Way> {
        let rises = ground - swing.from.y;
        let least = LEVEL * self.size;
        let other = if self.guided { rises.abs() >= least } else { rises > least && terrain.has_treads() };
        if !other || !self.steps_over(terrain, swing) {
            return None;
        }
        let over = highest(figure, terrain, swing, stands);
        let up = rises > 0.0;
        let [travels, arrives, highest] = if up { UP } else { DOWN };
        let above = swing.reference.at.y > over + LEVEL * self.size;
        let travels = if up && above { 0.0 } else { travels };
        let lift = if over > swing.from.y + LEVEL * self.size { HIGHER } else { 1.0 } * swing.lift;
        Some(Way { travels: [travels, arrives], highest, over, lift })
    }
}

/// m, how far the ground between where a foot stood and where it is to stand rises over the straight line from one to the other.
pub(super) fn crest(terrain: &Terrain, swing: &Swing, (stands, ground): (DVec2, f64)) -> f64 {
    let from = flat(swing.from);
    let stood = terrain.spot(from).height;
    let over = (1..PARTS).map(|part| {
        let share = f64::from(part) / f64::from(PARTS);
        terrain.spot(from.lerp(stands, share)).height - (stood + (ground - stood) * share)
    });
    over.fold(0.0, |most, over| if over > most + EVEN { over } else { most })
}

/// m, the highest ground under a sole on its way from where its reference is.
fn highest(figure: &Figure, terrain: &Terrain, swing: &Swing, stands: DVec2) -> f64 {
    let turn = DQuat::from_rotation_y(swing.yaw);
    let here = flat(swing.reference.at);
    let corners = figure.soles[swing.side as usize].iter().map(|corner| flat(turn * *corner));
    let places = corners
        .flat_map(|corner| (0..=PARTS).map(move |part| here.lerp(stands, f64::from(part) / f64::from(PARTS)) + corner));
    places.map(|at| terrain.spot(at).height).fold(f64::NEG_INFINITY, f64::max)
}

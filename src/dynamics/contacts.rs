//! What the links touch: points with a normal, a gap and friction, against what stands or moves by itself, or a loose body; and welds of
//! a loose body to a link. World axes, SI units.

use super::factor::Vector;
use super::loose::Loose;
use super::rows::Kind;
use super::state::Articulation;
use super::tree::DEEPEST;
use glam::DVec3;

/// m, so deep a contact may be without being pushed out; and the share of what is deeper that a step takes back, at m/s at most.
const SLOP: f64 = 0.001;
const BACK: f64 = 0.15;
const BACK_AT_MOST: f64 = 1.0;
/// Share of a weld's gap that a step takes back.
const CLOSES: f64 = 0.4;
/// m: farther off at the end of the step than that, as things go, it is no contact.
const MISSED: f64 = 0.004;
/// m/s, slower things do not bounce.
const BOUNCES: f64 = 0.5;
/// Names of welds, apart from those of contacts and limits.
const KEYS: u32 = 1 << 29;

/// A place where something may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The link.
    pub link: usize,
    /// Names it from step to step, under 2^27.
    pub key: u32,
    /// m.
    pub at: DVec3,
    /// Towards the link, a unit vector.
    pub normal: DVec3,
    /// m, how far they are apart; under 0 inside each other.
    pub gap: f64,
    /// Coulomb's coefficient.
    pub friction: f64,
    /// Share of the closing speed that it parts with.
    pub bounce: f64,
    /// m/s, of what is touched, where that is no loose body.
    pub surface: DVec3,
    /// The loose body that it touches.
    pub other: Option<usize>,
}

/// A loose body fixed to a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weld {
    /// The link.
    pub link: usize,
    /// The loose body.
    pub body: usize,
    /// m, the joint in the link's frame and in the body's.
    pub at: [DVec3; 2],
    /// The body's turn in the link's frame.
    pub turn: glam::DQuat,
}

/// What was given at a contact in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// Which.
    pub touch: Touch,
    /// N s, on the link; the loose body got the opposite.
    pub impulse: DVec3,
}

impl Articulation {
    /// A row's direction on a link's chain: along `way` at a point, or about it; and how fast `free` goes along it.
    fn on_chain(&self, link: usize, way: DVec3, point: Option<DVec3>, free: &Vector) -> ([f64; DEEPEST], f64) {
        let last = self.tree.last[link];
        let (mut j, mut goes) = ([0.0; DEEPEST], 0.0);
        let turned = point.map_or(way, |point| (point - self.origin[0]).cross(way));
        let way = if point.is_some() { way } else { DVec3::ZERO };
        for (value, freedom) in j.iter_mut().zip(&self.tree.chain[last]).take(self.tree.depth[last] + 1) {
            let freedom = usize::from(*freedom);
            *value = self.moves[freedom].dot(way) + self.turns[freedom].dot(turned);
            goes += *value * free[freedom];
        }
        (j, goes)
    }

    /// Adds three rows for each contact that this step of `dt` s reaches. Returns in `kept` which those are.
    pub(super) fn add_contacts(
        &mut self,
        touches: &[Touch],
        loose: &[Loose],
        (free, dt): (&Vector, f64),
        kept: &mut Vec<(usize, usize)>,
    ) {
        kept.clear();
        for (index, touch) in touches.iter().enumerate() {
            let far = touch.other.map(|body| (body, &loose[body]));
            let apart =
                |way: DVec3| -touch.surface.dot(way) - far.map_or(0.0, |(_, body)| body.motion_at(touch.at).dot(way));
            let near = |way: DVec3| {
                let (j, goes) = self.on_chain(touch.link, way, Some(touch.at), free);
                ((self.tree.last[touch.link], j), goes + apart(way))
            };
            let (normal, closing) = near(touch.normal);
            if touch.gap > 0.0 && touch.gap + closing * dt > MISSED {
                continue;
            }
            let bounced = if -closing > BOUNCES { -closing * touch.bounce } else { 0.0 };
            let target = if touch.gap > 0.0 && touch.bounce == 0.0 {
                -touch.gap / dt
            } else {
                ((-touch.gap - SLOP).max(0.0) * BACK / dt).min(BACK_AT_MOST).max(bounced)
            };
            let (a, b) = touch.normal.any_orthonormal_pair();
            let (first, second) = (near(a), near(b));
            let reach = |way: DVec3| far.map(|(body, other)| (body, other.reach(way, touch.at).map(|value| -value)));
            let tools = (&self.tree, &self.factors);
            let key = touch.key * 4;
            kept.push((index, self.rows.rows.len()));
            self.rows.add(tools, Kind::Normal, key, normal, reach(touch.normal), target - closing, touch.friction);
            self.rows.add(tools, Kind::Across, key + 1, first.0, reach(a), -first.1, 0.0);
            self.rows.add(tools, Kind::Across, key + 2, second.0, reach(b), -second.1, 0.0);
        }
    }

    /// Adds six rows for each weld.
    pub(super) fn add_welds(&mut self, welds: &[Weld], loose: &[Loose], (free, dt): (&Vector, f64)) {
        for (index, weld) in welds.iter().enumerate() {
            let body = &loose[weld.body];
            let turn = self.turn[weld.link];
            let near = self.origin[weld.link] + turn * weld.at[0];
            let far = body.place + body.turn * weld.at[1];
            let wrong = (turn * weld.turn) * body.turn.inverse();
            let wrong = if wrong.w < 0.0 { -wrong } else { wrong }.to_scaled_axis();
            for (way, axis) in DVec3::AXES.into_iter().enumerate() {
                let last = self.tree.last[weld.link];
                let (j, goes) = self.on_chain(weld.link, axis, Some(near), free);
                let (k, turns) = self.on_chain(weld.link, axis, None, free);
                let key = KEYS + 8 * index as u32 + way as u32;
                let tools = (&self.tree, &self.factors);
                let goes = goes - body.motion_at(far).dot(axis);
                let back = (far - near).dot(axis) * CLOSES / dt;
                let reach = body.reach(axis, far).map(|value| -value);
                self.rows.add(tools, Kind::Weld, key, (last, j), Some((weld.body, reach)), back - goes, 0.0);
                let turns = turns - body.spin.dot(axis);
                let back = -wrong.dot(axis) * CLOSES / dt;
                let twist = body.twist(axis).map(|value| -value);
                self.rows.add(tools, Kind::Weld, key + 4, (last, k), Some((weld.body, twist)), back - turns, 0.0);
            }
        }
    }

    /// What the contacts in `kept` were given.
    pub(super) fn collect(&self, touches: &[Touch], kept: &[(usize, usize)], met: &mut Vec<Met>) {
        for (index, row) in kept {
            let touch = touches[*index];
            let (a, b) = touch.normal.any_orthonormal_pair();
            let [n, p, q] = [0, 1, 2].map(|next| self.rows.rows[row + next].impulse);
            if n > 0.0 {
                met.push(Met { touch, impulse: touch.normal * n + a * p + b * q });
            }
        }
    }
}

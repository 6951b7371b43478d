//! What the links touch: points with a normal, a gap and friction, against what stands or moves by itself, or a loose body; and welds of
//! a loose body to a link. World axes, SI units.

use super::factor::Vector;
use super::loose::Loose;
use super::rows::{Asked, Kind, Ways};
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
    /// Directions on a link's chain: along each way at a point, or about it.
    fn on_chain<const N: usize>(&self, link: usize, ways: [DVec3; N], point: Option<DVec3>) -> Ways<N> {
        let last = self.tree.last[link];
        let mut on = [[0.0; N]; DEEPEST];
        let arm = point.map(|point| point - self.origin[0]);
        let chain = &self.tree.chain[last];
        for e in 0..=self.tree.depth[last].min(DEEPEST - 1) {
            let freedom = usize::from(chain[e]);
            let turns = self.turns[freedom];
            let moves = match arm {
                Some(arm) => self.moves[freedom] + turns.cross(arm),
                None => turns,
            };
            for way in 0..N {
                on[e][way] = moves.dot(ways[way]);
            }
        }
        on
    }

    /// m/s at the root's origin and rad/s: how a link would go with those speeds of the freedoms.
    fn goes(&self, link: usize, speeds: &Vector) -> (DVec3, DVec3) {
        let last = self.tree.last[link];
        let (mut moves, mut turns) = (DVec3::ZERO, DVec3::ZERO);
        for freedom in &self.tree.chain[last][..=self.tree.depth[last]] {
            let freedom = usize::from(*freedom);
            moves += self.moves[freedom] * speeds[freedom];
            turns += self.turns[freedom] * speeds[freedom];
        }
        (moves, turns)
    }

    /// Adds a row for each contact that this step of `dt` s reaches. Returns in `kept` which those are.
    pub(super) fn add_contacts(
        &mut self,
        touches: &[Touch],
        loose: &[Loose],
        (free, dt): (&Vector, f64),
        kept: &mut Vec<(usize, usize)>,
    ) {
        kept.clear();
        let mut mover = None;
        for (index, touch) in touches.iter().enumerate() {
            let (moves, turns) = match mover {
                Some((link, goes)) if link == touch.link => goes,
                _ => self.goes(touch.link, free),
            };
            mover = Some((touch.link, (moves, turns)));
            let far = touch.other.map(|body| (body, &loose[body]));
            let surface = touch.surface + far.map_or(DVec3::ZERO, |(_, body)| body.motion_at(touch.at));
            let goes = moves + turns.cross(touch.at - self.origin[0]) - surface;
            let closing = goes.dot(touch.normal);
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
            let ways = [touch.normal, a, b];
            let near = self.on_chain(touch.link, ways, Some(touch.at));
            let reach = |other: &Loose| ways.map(|way| other.reach(way, touch.at).map(|value| -value));
            let far = far.map(|(body, other)| (body, reach(other)));
            let wanted = [target - closing, -goes.dot(a), -goes.dot(b)];
            kept.push((index, self.rows.contacts()));
            let asked = Asked { key: touch.key, near, last: self.tree.last[touch.link], far, wanted };
            self.rows.add_contact((&self.tree, &self.factors), touch.friction, &asked);
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
            let (moves, turns) = self.goes(weld.link, free);
            let moves = moves + turns.cross(near - self.origin[0]) - body.motion_at(far);
            let turns = turns - body.spin;
            for (way, axis) in DVec3::AXES.into_iter().enumerate() {
                let key = KEYS + 8 * index as u32 + way as u32;
                let along = (far - near) * (CLOSES / dt) - moves;
                let about = -wrong * (CLOSES / dt) - turns;
                for (key, point, reach, wanted) in [
                    (key, Some(near), body.reach(axis, far), along.dot(axis)),
                    (key + 4, None, body.twist(axis), about.dot(axis)),
                ] {
                    let far = Some((weld.body, [reach.map(|value| -value)]));
                    let near = self.on_chain(weld.link, [axis], point);
                    let asked = Asked { key, near, last: self.tree.last[weld.link], far, wanted: [wanted] };
                    self.rows.add((&self.tree, &self.factors), Kind::Weld, &asked);
                }
            }
        }
    }

    /// What the contacts in `kept` were given.
    pub(super) fn collect(&self, touches: &[Touch], kept: &[(usize, usize)], met: &mut Vec<Met>) {
        for (index, contact) in kept {
            let touch = touches[*index];
            let (a, b) = touch.normal.any_orthonormal_pair();
            let [n, p, q] = self.rows.given(*contact);
            if n > 0.0 {
                met.push(Met { touch, impulse: touch.normal * n + a * p + b * q });
            }
        }
    }
}

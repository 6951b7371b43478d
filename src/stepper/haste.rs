//! On the way up a flight, steps of a body that is ahead of its way, or beside it: a foot leaves as soon as ξ is over the other one, lands
//! the sooner the farther ahead ξ runs, and the wider the farther aside. With pressure at p ξ goes away from it by e^(ωt) (seed.md).
//! Scenario space, metres, seconds.

use super::climb::{BESIDE, Scene};
use super::support::{Support, Tread};
use super::{State, Swing};
use crate::maths::real;
use glam::DVec2;

/// m of the reference body: so far ahead of where it is held over the foot in front ξ is for the other foot to leave at once.
const AHEAD: f64 = 0.01;
/// m of the reference body: it does not while ξ is farther to that other foot's side than a wide step makes up for.
const ASIDE: f64 = 0.1;
/// m of the reference body: a foot is down when ξ is still so far behind where it is held over it.
const BEHIND: f64 = 0.05;
/// s of the reference body, the shortest swing: in a shorter one toes catch on the riser.
const BRIEFEST: f64 = 0.5;
/// m of the reference body: a foot lands so far outside of where ξ will be; and so much wider than usual at most.
const OUTSIDE: f64 = 0.03;
/// As [`OUTSIDE`] says.
const WIDEST: f64 = 0.2;

impl Scene<'_> {
    /// With both feet down: is ξ so far ahead that the foot behind is to leave now?
    pub(super) fn runs(&self, state: &State) -> bool {
        let size = self.params.size;
        let off = state.xi() - self.over;
        let behind = state.feet[self.side as usize].ankle.z <= self.stance.ankle.z + BESIDE * size;
        !state.climb.down && behind && off.x * self.side.sign() < ASIDE * size && off.y > AHEAD * size
    }

    /// The swing, to land in time and where ξ goes.
    pub(super) fn in_time(&self, state: &State, swing: &Swing, dt: f64) -> Swing {
        let (left, gone) = (swing.land - state.time, state.time - swing.lift);
        let least = (BRIEFEST * self.params.tempo - gone).max(dt);
        let lasts = self.lasts(state, swing).max(least);
        let land = if lasts < left { state.time + (lasts / dt).round().max(1.0) * dt } else { swing.land };
        let mut next = Swing { land, ..*swing };
        next.to.ankle.x = self.aside(state, &next);
        next
    }

    /// s until ξ is over where that foot is to stand, the pressure as far ahead under the other one as it can be.
    fn lasts(&self, state: &State, swing: &Swing) -> f64 {
        let xi = state.xi();
        let tip = self.bears_at(xi + DVec2::Y).y;
        let (far, gone) = (self.middle(state, &swing.to, self.side).y - BEHIND * self.params.size - tip, xi.y - tip);
        if gone <= 0.0 { f64::INFINITY } else { real::ln((far / gone).max(1.0)) / state.omega() }
    }

    /// m, x where that foot lands: outside of where ξ will be, the pressure as far to its side under the other one as it can be.
    fn aside(&self, state: &State, swing: &Swing) -> f64 {
        let (sign, xi) = (self.side.sign(), state.xi());
        let inner = self.bears_at(xi + DVec2::X * sign).x * sign;
        let grown = real::exp(state.omega() * (swing.land - state.time).max(0.0));
        let lands = inner + (xi.x * sign - inner).max(0.0) * grown;
        let usual = self.stance.ankle.x * sign + self.across();
        sign * (lands + OUTSIDE * self.params.size).clamp(usual, usual + WIDEST * self.params.size)
    }

    /// m, (x, z): the place nearest to that one where the sole that stands can bear.
    fn bears_at(&self, place: DVec2) -> DVec2 {
        Support::one(self.params, self.physique, &self.stance, Tread::Whole, 0.5 * self.params.margin).nearest(place)
    }
}

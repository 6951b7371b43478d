//! How a walk comes to a stand. Ground plane (x, z), SI units.
//!
//! The paper's last step lands where its pendulum stops (equation 2), in a stride, and another one brings the feet together. People brake over
//! two or three steps and set the last foot beside the other. So does a body of links: once ξ is within the sole that carries it, pressure
//! under ξ brings it to a stand (Koolen 2012, a capture point within the support), and the foot that then swings has only to come beside.

use super::{Params, Physique, State, ground, support};
use crate::maths::pendulum;
use crate::model::Side;
use glam::DVec2;

/// Shares of a sole from the ankle on, ahead and behind, within which ξ is when the last foot leaves: of who still goes at `FAST` m/s (at legs
/// of 0.83 m), and of who stands. With 0.55 and 0.75 m2m_rig_human steps again a second later; with 0.4 a body whose ξ is at 0.42 of its sole
/// in a gait on the spot never stops.
const WITHIN: [f64; 2] = [0.5, 0.7];
const FAST: f64 = 0.4;
/// s at legs of 0.83 m, how long that step is in the air at most. In 0.45 s ξ has swung so far aside that feet end 0.3 m apart.
const BRINGS: f64 = 0.38;
/// m at legs of 0.83 m, by which the ankle that lands is outside of ξ at least: with 0.02 and 0.06 more of them step again.
const OUTSIDE: f64 = 0.04;
/// Sine over cosine of the way that it goes: who goes more to the side than that comes to a stand as the paper's.
const ASIDE: f64 = 0.5;
/// m of the reference body: a foot that would land so little ahead of the other, or behind it, lands beside it.
const NEAR: [f64; 2] = [0.05, 0.12];

/// Does it stop by setting a foot beside the other? Edges and treads say themselves where feet go.
pub fn able(params: &Params, state: &State) -> bool {
    params.fits && params.rolls && state.gait.longest.is_infinite()
}

/// Can it come to a stand on the other foot while `side` is set beside it?
pub fn closes(params: &Params, physique: &Physique, state: &State, side: Side) -> bool {
    let goes = state.gait.velocity;
    let straight = goes.dot(state.aside()).abs() <= ASIDE * goes.dot(state.ahead).abs();
    let xi = state.xi() - ground(state.feet[side.other() as usize].ankle);
    let speed = ground(state.velocity).length() * params.tempo / params.size;
    let share = WITHIN[1] + (WITHIN[0] - WITHIN[1]) * (speed / FAST).min(1.0);
    let (ahead, inward) = (xi.dot(state.ahead), xi.dot(state.aside()) * side.sign());
    able(params, state) && straight && inward > 0.0 && share * physique.heel < ahead && ahead < share * physique.tip
}

/// s, the time for which a foot that was to swing for `single` s swings to come beside the other.
pub fn time(params: &Params, single: f64) -> f64 {
    single.min(BRINGS * params.tempo)
}

/// Where the ankle of the last step lands, for a centre of mass that is at `com` with `velocity` then. `stance` is where the other foot's
/// ankle is and how it is turned (rad), `ways` are the unit vectors ahead and out to the side that steps, `height` (m) is equation 2's h and
/// `roll` (m) how far ahead of the ankle the pressure is at the end of a step.
pub fn landing(
    params: &Params,
    state: &State,
    stance: (DVec2, f64),
    (com, velocity): (DVec2, DVec2),
    ways: (DVec2, DVec2),
    (height, roll): (f64, f64),
) -> DVec2 {
    let ((rear, yaw), (ahead, out)) = (stance, ways);
    let distance = pendulum::step_distance(velocity.length(), 0.0, height, state.gait.rise); // equation 2
    let stop = com + velocity.normalize_or_zero() * distance;
    // while the weight comes over from the rear foot, the fall goes on
    let late = rear + support::forward(yaw) * roll;
    let stop = stop + (stop - late) * (params.transfer / (1.0 - params.transfer));
    let ankle = stop + out * (0.5 * params.width) - ahead * params.com_forward;
    if state.gait.closes {
        let wide = (ankle - rear).dot(out).min((stop - rear).dot(out) + OUTSIDE * params.size);
        return rear + out * wide.max(params.width);
    }
    let past = (ankle - rear).dot(ahead);
    let going = velocity.dot(ahead).signum();
    let near = past * going < NEAR[0] * params.size && past * going > -NEAR[1] * params.size;
    if near { ankle - ahead * past } else { ankle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Terrain;
    use crate::stepper::Style;
    use glam::DVec3;

    /// A body that stands with its left foot 0.4 m ahead and `speed` m/s left, its ξ `ahead` m ahead of that foot's ankle and amid the feet.
    fn braked(ahead: f64, speed: f64) -> (Params, Physique, State) {
        let physique = Physique::REFERENCE;
        let params = Params::embodied(&physique, &Style::default());
        let mut state = State::standing(&params, &physique, &Terrain::flat(), DVec2::ZERO, 0.0);
        state.feet[0].ankle.z += 0.4;
        state.velocity = DVec3::Z * speed;
        state.com.z += state.feet[0].ankle.z + ahead - state.xi().y;
        (params, physique, state)
    }

    #[test]
    fn who_has_xi_within_the_sole_that_carries_him_sets_the_other_foot_beside_it() {
        for (ahead, speed, wanted) in [(0.05, 0.5, true), (0.2, 0.5, false), (-0.1, 0.5, false), (0.05, 0.0, true)] {
            let (params, physique, state) = braked(ahead, speed);
            assert_eq!(closes(&params, &physique, &state, Side::Right), wanted, "{ahead} m ahead at {speed} m/s");
        }
        let (params, physique, mut state) = braked(0.05, 0.5);
        state.gait.velocity = DVec2::X * 0.3;
        assert!(!closes(&params, &physique, &state, Side::Right), "who goes aside does not");
    }

    #[test]
    fn the_last_foot_comes_down_beside_the_other_and_outside_of_xi() {
        let (params, physique, mut state) = braked(0.05, 0.5);
        let (rear, out) = (ground(state.feet[0].ankle), -state.aside());
        for aside in [0.0, 0.1, 0.2] {
            let com = rear + out * aside;
            let ways = (state.ahead, out);
            state.gait.closes = true;
            let at = landing(&params, &state, (rear, 0.0), (com, DVec2::ZERO), ways, (physique.com_height, 0.0)) - rear;
            assert!(at.dot(state.ahead).abs() < 1e-9, "beside: {at}");
            assert!(at.dot(out) >= aside.max(params.width), "ξ is {aside} m out: {at}");
        }
    }
}

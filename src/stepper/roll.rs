//! The pressure's way in the gait: its roll under the feet, ankle feedback around it, the weight shift before the first
//! step. Ground plane (x, z), metres.

use super::gait::{self, Rhythm};
use super::support::{Support, Tread};
use super::walk::{Phase, omega, rhythm_now};
use super::{Params, Physique, State, StepKind, footfall, ground, pace, push_off, support, turn};
use crate::maths::real;
use crate::model::{Side, Terrain};
use glam::DVec2;

/// The centre of pressure during this tick; `None` where the gait is not in charge of it.
pub fn pressure(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, dt: f64) -> Option<DVec2> {
    let gait = state.gait;
    let stance = state.feet[gait.side.other() as usize];
    let toe = support::forward(stance.yaw);
    match gait.phase {
        Phase::Rest => return None,
        Phase::Start => return Some(prepare(params, physique, state, dt)),
        Phase::Single if state.swing.is_none_or(|swing| swing.kind != StepKind::Walk) => return None,
        Phase::Double if !params.rolls => return Some(state.cop),
        Phase::Single if !params.rolls => return Some(contact(params, state, gait.side.other())),
        Phase::Single | Phase::Double => {}
    }
    let rhythm = rhythm_now(params, physique, state);
    let length = (gait.until - gait.since).max(dt);
    let single = gait.phase == Phase::Single;
    let runs = if single { rhythm.run * length } else { length };
    let share = |time: f64, of: f64| ((time - gait.since) / of).clamp(0.0, 1.0);
    let end = ground(stance.ankle) + toe * rhythm.roll[usize::from(single)];
    let now = gait.from.lerp(end, share(state.time, runs));
    let left_over = (gait.until - state.time).max(0.0);
    let planned = state.gait.next.filter(|_| footfall::fits(params, terrain, state));
    let swings = planned.map_or(rhythm.step - rhythm.double, |(_, time)| time);
    let times = if single { (0.0, left_over) } else { (left_over, swings) };
    let wanted = feedback(params, physique, terrain, state, &rhythm, now, times);
    let shift = gait.shift + (wanted - gait.shift) * (1.0 - real::exp(-dt / params.lag));
    state.gait.shift = shift;
    let half = state.time + 0.5 * dt;
    let roll = gait.from.lerp(end, share(half, runs));
    let fading = ((1.0 - share(half, length)) / 0.3).min(1.0);
    let at = roll + shift * fading;
    if !single {
        return Some(state.inset.nearest(at));
    }
    Some(Support::one(params, physique, &stance, Tread::Whole, params.margin).nearest(at))
}

/// Share of its feedback that a walk of long strides does without. Of 20 drawn walks of 0.7 to 1.4 m/s at 130 steps a minute 7 are more than 5 % off
/// their speed with all of it, 2 with half of it and a pelvis that comes down in time, and the mean score is 0.98, not 0.91.
const SPARED: f64 = 0.5;

/// How far the pressure should be off its roll for the step to come out as a steady one would.
fn feedback(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &State,
    rhythm: &Rhythm,
    now: DVec2,
    (wait, time): (f64, f64),
) -> DVec2 {
    let gait = &state.gait;
    let omega = omega(params, physique);
    let (com, velocity) = footfall::touchdown(params, physique, state, rhythm, (gait.side, now), (wait, time));
    let xi = com + velocity / omega;
    let suits = steady_xi(params, physique, state, rhythm, gait.side, wait + time);
    let planned = state.swing.map(|swing| ground(swing.to.ankle)).or(gait.next.map(|next| next.0));
    let suits = match planned.filter(|_| footfall::fits(params, terrain, state)) {
        Some(ankle) => {
            // as far as that landing, and as wide as a steady one: a late step would be ever wider
            let rear = ground(state.feet[gait.side.other() as usize].ankle);
            let steady = rear + pace::aimed(state) * rhythm.step + state.aside() * (gait.side.sign() * rhythm.width);
            let ankle = ankle - state.aside() * (ankle - steady).dot(state.aside());
            footfall::pivot(params, physique, state, rhythm, gait.side, wait + time).xi_for(rear, ankle)
        }
        None => suits,
    };
    let mut error = xi - suits;
    if gait.last {
        let stance = ground(state.feet[gait.side.other() as usize].ankle);
        let middle = stance + state.aside() * (0.5 * gait.side.sign() * params.width);
        let off = xi - middle - state.ahead * params.com_forward;
        let way = ground(state.velocity).normalize_or_zero();
        let (aside, behind) = (off.dot(state.aside()), off.dot(state.ahead) * way.dot(state.ahead).signum());
        let behind = if gait.closes { behind } else { behind.min(0.0) };
        error = state.aside() * aside + state.ahead * (behind * way.dot(state.ahead).signum());
    }
    let gain = params.walk_gain * (1.0 - SPARED * push_off::strides(params, physique, state));
    error * (gain / (real::exp(omega * (wait + time).max(0.2 * params.tempo)) - 1.0))
}

/// ξ at the touchdown, `time` s from now, of a step as long and as wide as the steady ones.
fn steady_xi(params: &Params, physique: &Physique, state: &State, rhythm: &Rhythm, side: Side, time: f64) -> DVec2 {
    let rear = ground(state.feet[side.other() as usize].ankle);
    let turned = turn::turned_in(state, time);
    let across = turn::rotated(state.aside(), turned) * (side.sign() * rhythm.width);
    let ankle = if state.gait.spot {
        turn::around(params, physique, state, side).0
    } else {
        rear + turn::rotated(pace::aimed(state), turned) * rhythm.step + across
    };
    footfall::pivot(params, physique, state, rhythm, side, time).xi_for(rear, ankle)
}

/// Where the bare pendulum touches the ground.
pub fn contact(params: &Params, state: &State, side: Side) -> DVec2 {
    let foot = &state.feet[side as usize];
    ground(foot.ankle) + support::forward(foot.yaw) * params.com_forward
}

/// s of the reference body, how long before the first step the pressure goes to the foot that stands: of a turn on the spot, of a walk.
const OVER: [f64; 2] = [0.12, 0.16];

/// The pressure that brings the weight over the stance foot and forward of it, first away from it.
fn prepare(params: &Params, physique: &Physique, state: &State, dt: f64) -> DVec2 {
    let gait = &state.gait;
    let left_over = (gait.until - state.time).max(0.0);
    if left_over <= OVER[usize::from(!gait.spot)] * params.tempo {
        let share = (dt / left_over.max(dt)).min(1.0);
        return state.cop + (contact(params, state, gait.side.other()) - state.cop) * share;
    }
    let pivot = state.inset.nearest(to_lift(params, physique, state, gait.side, left_over));
    state.cop + (pivot - state.cop) * (1.0 - real::exp(-dt / params.lag))
}

/// m, (x, z), where the pressure has to be, held or not, for a first step of `side` to leave `left_over` s from now as a steady one would.
fn to_lift(params: &Params, physique: &Physique, state: &State, side: Side, left_over: f64) -> DVec2 {
    let omega = omega(params, physique);
    let rhythm = &rhythm_now(params, physique, state);
    let stance = &state.feet[side.other() as usize];
    let early = contact(params, state, side.other());
    let late = ground(stance.ankle) + support::forward(stance.yaw) * rhythm.roll[1];
    let over = OVER[usize::from(!state.gait.spot)] * params.tempo;
    let single = (rhythm.step - rhythm.double).min(params.brief);
    let landing = steady_xi(params, physique, state, rhythm, side, left_over + single);
    let [one, two] = gait::rolled(omega, 0.0, single, rhythm.run);
    let at_lift = landing * real::exp(-omega * single) + early * one + late * two;
    let hold = left_over - over;
    let kept = real::exp(-omega * hold);
    let [one, two] = gait::weights(omega, hold, over);
    let xi = state.xi() + footfall::lean(params, physique, state);
    (xi - at_lift * real::exp(-omega * left_over) - early * two) / (1.0 - kept + one)
}

/// s of the reference body, in how long a walk may begin after a shove.
const SOONEST: [f64; 5] = [0.2, 0.26, 0.32, 0.38, 0.44];

/// The foot with which a walk begins soonest, and in how long (s) the weight can be off it; `None` where it takes as long as ever.
pub fn soonest(params: &Params, physique: &Physique, state: &State) -> Option<(Side, f64)> {
    let out = |(side, time): (Side, f64)| state.inset.outside(to_lift(params, physique, state, side, time));
    SOONEST.into_iter().find_map(|time| {
        let [left, right] = Side::BOTH.map(|side| (side, time * params.tempo));
        let best = if out(right) < out(left) { right } else { left };
        (out(best) < 0.0).then_some(best)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stepper::Style;

    #[test]
    fn a_walk_begins_the_sooner_the_nearer_the_weight_is_to_the_foot_that_stays() {
        let physique = Physique::REFERENCE;
        let params = Params::embodied(&physique, &Style::default());
        let begun = |aside: f64| {
            let mut state = State::standing(&params, &physique, &Terrain::flat(), DVec2::ZERO, 0.0);
            state.gait.velocity = state.ahead * 0.3;
            state.com.x = aside * state.feet[0].ankle.x;
            soonest(&params, &physique, &state)
        };
        for (aside, leaves) in [(0.8, Side::Right), (-0.8, Side::Left)] {
            let (side, time) = begun(aside).expect("the weight is almost over that foot");
            assert_eq!(side, leaves, "the other foot stays");
            let amid = begun(0.1 * aside).map_or(STANDS * params.tempo, |(_, time)| time);
            assert!(time < amid, "{time} s, and {amid} s from amid the feet");
        }
    }

    /// s, what a walk takes to begin that nothing hurries.
    const STANDS: f64 = 0.5;
}

//! The speed that is held: what ground and forces take from each step or give to it, found from step to step.
//!
//! The paper biases its step length by the leg's length error "so the motion remains perpetual": what springs and dampers
//! take from a step shows in the speed. Here the speed itself says: the velocity that the footholds are reckoned for is the commanded one
//! and the sum of what the steps so far lacked. Ground plane (x, z), SI units.

use super::{Params, Physique, State, ground};
use crate::maths::pendulum::GRAVITY;
use glam::DVec2;

/// Share of a step's lack of speed that the next one makes up for: less than what would come and go about it.
const GAIN: f64 = 0.35;
/// Share of the commanded speed by which it is corrected at most.
const MOST: f64 = 0.5;
/// The same, the most that one step counts for: what is farther off was disturbed, and recovering is not keeping a pace.
const DISTURBED: f64 = 0.15;

/// Share of the weight from which on a force lasts that is worth a correction: 18 N on 89.5 kg.
const FORCED: f64 = 0.02;
/// Cosine of the lean of ground that counts as level: a tenth of a degree.
const LEVEL: f64 = 1.0 - 1.5e-6;

/// What is remembered of the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    /// m/s, added to the commanded velocity along the way.
    pub trim: f64,
    /// m, s and m/s: where the centre of mass was at the last landing, when, and what was commanded; `None` before the first.
    last: Option<(DVec2, f64, DVec2)>,
}

/// A step of the gait has landed. On the level, and where no force lasts, the closed form holds the speed by itself; where treads or gaps
/// choose the footholds, they set the pace too: soles that both lie level stand on one or the other.
pub fn landed(params: &Params, physique: &Physique, state: &mut State) {
    // nothing of a bare pendulum's gives way to a force: its closed form balances that
    let heavy = state.gait.lasting.length() > FORCED * physique.mass * GRAVITY;
    let forced = heavy && params.trims && params.leg_change && state.gait.longest.is_infinite();
    if !forced && state.feet.iter().all(|foot| foot.normal.y > LEVEL) {
        state.gait.pace = Pace::default();
        return;
    }
    let (com, now, wanted) = (ground(state.com), state.time, state.gait.velocity);
    let speed = wanted.length();
    let pace = &mut state.gait.pace;
    let steady = |before: DVec2| before.distance(wanted) < 0.05 * speed;
    if let Some((place, time, before)) = pace.last
        && steady(before)
        && speed > 0.1 * params.size / params.tempo
        && now > time
    {
        let lack = speed - (com - place).dot(wanted / speed) / (now - time);
        let lack = lack.clamp(-DISTURBED * speed, DISTURBED * speed);
        pace.trim = (pace.trim + GAIN * lack).clamp(-MOST * speed, MOST * speed);
    }
    pace.last = Some((com, now, wanted));
}

/// m/s, the velocity that footholds are reckoned for.
pub fn aimed(state: &State) -> DVec2 {
    let wanted = state.gait.velocity;
    wanted + wanted.normalize_or_zero() * state.gait.pace.trim
}

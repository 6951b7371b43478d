//! The plan for a body that moves by itself: the same decisions as [`super::tick`]'s, from a state that is measured.
//!
//! [`super::tick`] integrates its own pendulum and lands its own feet. Here the centre of mass, the feet and which of them stand come
//! from a body of links and torques; what comes out is in [`State`]: the swing (which foot, where to, when), the pressure wanted
//! and where the pelvis is to point. Only what is meant is planned (to go, to turn, to stand on one foot): what a fall asks for is
//! the body's own law's, and the plan gives up where a foothold is out of reach. Scenario space, SI units.

use super::rise::Carried;
use super::{Inputs, Params, Physique, State, Step, StepKind, Style};
use super::{
    balance, climb, control, decide, footfall, foothold, footing, grip, ground, rise, roll, stand, swing, walk,
};
use crate::maths::real;
use crate::model::{Side, Terrain};
use glam::DVec3;

/// Share of a swing after which the body's law could not send the foot elsewhere.
const LATE: f64 = 0.8;

/// What a body is found to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// m, centre of mass.
    pub com: DVec3,
    /// m/s; so that ξ = com + velocity / ω is the body's, its angular momentum counted in.
    pub velocity: DVec3,
    /// m, where the ankles are, and rad, where the feet point.
    pub feet: [(DVec3, f64); 2],
    /// Which of them stand.
    pub stands: [bool; 2],
    /// N, what pushes it.
    pub force: DVec3,
}

impl Params {
    /// The tuning of a plan that a body of links follows. An error of ξ grows by e^(ωT) in a step of T s, and such a body makes errors:
    /// it steps quicker than people, with less time on both feet, and holds ξ harder. Found by walks of 60 s and by shoves of walkers.
    pub fn embodied(physique: &Physique, style: &Style) -> Params {
        let own = Params::new(physique, style);
        let pace = own.size / own.tempo;
        Params {
            // with 95 and 110 every third walk at 0.5 m/s is given up: its steps are ever wider
            cadence: [104.0, 126.5, 152.0, 172.0],
            double: 0.45,
            walk_gain: 0.6,
            roll_ahead: 0.01 * own.size,
            lift_height: 0.55 * own.lift_height,
            retarget: 1.2 * pace,
            step_width: 1.2 * own.step_width,
            stumble: 0.2 * own.size,
            even: 0.7,    // with all of it a body limps: every step makes up for the one before, too much
            trims: false, // who leads the body asks for what it lacks (`sim::pilot`): both at once run away from each other
            // Who leans by all of it against a force that lasts goes the faster the harder it is dragged back: of 200 drawn walks
            // under 60 to 80 N 180 are within 5 % of their speed and 4 fall; with this 197, and none does.
            pull: 0.8 * own.pull,
            fits: true,
            // With lower bounds (0.15 m for `stumble`, 0.12 here and 0.5 for `wide`) the plan gives more walks up and the law stops them, with
            // higher ones (0.3 and 0.6) more toes are dragged.
            midair: 0.2 * own.size,
            wide: 1.2 * own.step_width + 0.43 * own.size,
            // who steps sideways closes his feet no nearer than his legs may come
            step_gap: own.step_gap.max(0.125 * own.size),
            most_across: -own.step_gap, // who is not lost lands his foot on its own side
            rolled: 0.8,
            margin: 0.5 * own.margin,
            least_swing: 1.2 * own.least_swing,
            ..own
        }
    }
}

/// One tick of `dt` s of the plan for a body that does what is measured. A step that the body finished is returned.
pub fn follow(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &mut State,
    (inputs, measured): (&Inputs, &Measured),
    dt: f64,
) -> Option<Step> {
    take_in(physique, state, measured, terrain);
    let landed = land(params, physique, terrain, state, measured, dt);
    if state.swing.is_none() {
        state.hold(params, physique);
    }
    rest(params, state, dt);
    let inputs = &Inputs { force: measured.force, ..*inputs };
    control::perceive(params, physique, state, inputs, dt);
    if climb::goes(params, physique, terrain, state, inputs) {
        if landed.is_some() {
            climb::landed(state);
        }
        climb::tick(params, physique, terrain, state, inputs, dt);
        climb::give_up(params, state);
        state.tick += 1;
        state.time = state.tick as f64 * dt;
        return landed;
    }
    let inputs = &climb::ended(params, physique, terrain, state, inputs);
    state.gait.grip = grip::longest(params, physique, state);
    walk::steer(params, physique, terrain, state, inputs, dt);
    let inputs = &walk::halted(state, inputs);
    rise::foresee(params, physique, terrain, state);
    rise::follow(params, physique, terrain, state, dt);
    if state.swing.is_none() {
        let busy = state.gait.phase == walk::Phase::Rest && stand::both_down(params, physique, state, inputs).0;
        if !busy {
            walk::both_down(params, physique, terrain, state, inputs, dt);
        }
    }
    stand::hold(params, physique, terrain, state, inputs, dt);
    decide::replan(params, physique, terrain, state, dt);
    give_up(params, physique, terrain, state, dt);
    match roll::pressure(params, physique, terrain, state, dt) {
        Some(cop) => state.cop = cop,
        None => {
            let wanted = stand::pressure(params, physique, state);
            let wanted = wanted.unwrap_or_else(|| balance::pressure(params, physique, state));
            state.cop += (wanted - state.cop) * (1.0 - real::exp(-dt / params.lag));
        }
    }
    state.tick += 1;
    state.time = state.tick as f64 * dt;
    landed
}

/// A step in the air that a shove has put out of reach is left to the body's own law while the foot can still be sent elsewhere.
fn give_up(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, dt: f64) {
    let Some(swing) = state.swing.filter(|swing| swing.kind == StepKind::Walk) else { return };
    let shoved = state.shoved < params.tempo;
    let off = || footfall::replan(params, physique, terrain, &footfall::let_go(state), &swing, dt).0.off;
    if shoved && swing.off > params.midair && swing::phase(&swing, state.time) < LATE && off() > params.midair {
        state.swing = None;
        state.gait.phase = walk::Phase::Rest;
    }
}

/// The body's own law is at work: the plan keeps up with where the body is and waits.
pub fn wait(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, measured: &Measured, dt: f64) {
    control::shoved(physique, state, ground(measured.force), dt);
    state.swing = None;
    state.intent = None;
    state.one = super::OneFoot::default();
    state.climb = climb::Climb::default();
    let velocity = ground(measured.velocity);
    state.gait = super::Gait { velocity, ..super::Gait::still(state.gait.side) };
    take_in(physique, state, measured, terrain);
    state.carried = Carried::still(rise::under(state, ground(state.com)));
    state.hold(params, physique);
    state.cop = foothold::middle(params, state.ahead, foothold::ankles(state));
    (state.calm, state.settled, state.recovering) = (0.0, 0.0, 0.0);
    state.tick += 1;
    state.time = state.tick as f64 * dt;
}

/// Is the plan in charge: does it go, turn, or stand on one foot?
pub fn leads(state: &State) -> bool {
    let planned = state.swing.is_some_and(|swing| matches!(swing.kind, StepKind::Walk | StepKind::Held));
    planned || state.swing.is_none() && (state.gait.phase != walk::Phase::Rest || state.one.stance.is_some())
}

/// The foot that is about to leave the ground, within `soon` s.
pub fn leaves(state: &State, soon: f64) -> Option<Side> {
    let gait = &state.gait;
    let goes = matches!(gait.phase, walk::Phase::Double | walk::Phase::Start) && state.swing.is_none();
    (goes && gait.until - state.time < soon).then_some(gait.side)
}

/// m, the centre of pressure, on the ground.
pub fn pressure(state: &State) -> DVec3 {
    DVec3::new(state.cop.x, rise::under_pressure(state, state.cop), state.cop.y)
}

/// m, how high a foot that is held up is to be now; `None` of a foot that steps.
pub fn held_height(params: &Params, state: &State) -> Option<f64> {
    let swing = state.swing.filter(|swing| swing.kind == StepKind::Held)?;
    Some(stand::height(params, &swing, state.time))
}

fn take_in(physique: &Physique, state: &mut State, measured: &Measured, terrain: &Terrain) {
    state.acceleration = DVec3::ZERO;
    (state.com, state.velocity) = (measured.com, measured.velocity);
    for side in Side::BOTH {
        let (ankle, yaw) = measured.feet[side as usize];
        let plant = footing::beneath(terrain, physique, ankle, (yaw, state.time));
        state.feet[side as usize] = plant;
        if state.planted(side) {
            state.held[side as usize] = footing::to_ground(&plant, terrain.turn(state.time));
        }
    }
}

/// Ends the swing where the body's foot stands; a foot that is late is waited for.
fn land(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &mut State,
    measured: &Measured,
    dt: f64,
) -> Option<Step> {
    let mut swing = state.swing?;
    if measured.stands[swing.side as usize] && state.time > swing.lift + 1.5 * dt {
        return Some(control::landed(params, physique, terrain, state, &swing));
    }
    if swing.land < state.time + dt {
        swing.land = state.time + dt;
        state.gait.until = swing.land;
        state.swing = Some(swing);
    }
    None
}

/// The clocks of rest, of a body that is measured.
fn rest(params: &Params, state: &mut State, dt: f64) {
    let slow = state.velocity.length() < 0.12 * params.size / params.tempo;
    let held = slow && state.swing.is_none() && state.outline.outside(state.xi()) <= 0.0;
    state.calm = if held { state.calm + dt } else { 0.0 };
}

//! The fixed-step session: the stepper under pushes, tick by tick, and the trace of a whole run. Scenario space, SI units.
//!
//! A studio keeps a [`Session`] and pushes a live character; a bake calls [`simulate_pushes`] and gets the trace.

use super::{Script, TickState, Trace};
use crate::maths::spring::Spring;
use crate::model::scenario::Feet;
use crate::model::{Side, Terrain};
use crate::stepper::follow::{self, Measured};
use crate::stepper::support;
use crate::stepper::{
    self, Inputs, Params, Phase, Physique, State, Step, Style, TickOutput, footing, ground, push_off, walk,
};
use glam::{DQuat, DVec2, DVec3};

/// s after the end, when a foot that is held up would come down.
const HOLDS_ON: f64 = 2.0;
/// The share of the leg by which who walks is shortened in a crouch from which on no stride is long.
const CROUCHED: f64 = 0.05;
/// The share of the leg by which the deepest crouch shortens it.
pub(super) const DEEPEST: f64 = 0.6;
/// s, the length of a tick.
pub const TICK: f64 = 0.01;

/// A force that acts for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SessionPush {
    /// s.
    pub start: f64,
    /// s.
    pub duration: f64,
    /// N, in scenario space; where it `turns`, for a character that faces +Z.
    pub force: DVec3,
    /// Its direction is the character's own: turned by the way that it faces when the push starts.
    pub turns: bool,
    /// m, its point of attack over the centre of mass.
    pub arm: f64,
}

/// How to run the stepper; the articulated body has options of its own ([`super::ArticulatedOptions`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulateOptions {
    /// s; it goes on to the next tick.
    pub duration: f64,
    /// s, at most so much longer if the character is not at rest by then.
    pub extra: f64,
    /// The character's dials.
    pub style: Style,
    /// s, the length of a tick.
    pub dt: f64,
}

impl Default for SimulateOptions {
    fn default() -> SimulateOptions {
        SimulateOptions { duration: 4.0, extra: 8.0, style: Style::default(), dt: TICK }
    }
}

/// A live character.
#[derive(Clone, Debug)]
pub struct Session {
    params: Params,
    physique: Physique,
    terrain: Terrain,
    state: State,
    dt: f64,
    last: TickState,
    style: Style,
    whole: Physique,
    crouch: Spring,
    stoop: f64, // m, how much lower its centre of mass is than its hips are, for the lean of its trunk
    embodied: bool,
    balls: Option<f64>, // m, as in the parameters
    patience: f64,
}

impl Session {
    /// At rest, the ankles' middle over the origin, facing +Z.
    pub fn new(physique: &Physique, terrain: &Terrain, style: &Style, dt: f64) -> Session {
        let params = Params::new(physique, style);
        let state = State::standing(&params, physique, terrain, params.stance.middle, 0.0);
        let mut session = Session {
            params,
            physique: *physique,
            terrain: terrain.clone(),
            state,
            dt,
            last: still(&state),
            style: *style,
            whole: *physique,
            crouch: Spring::default(),
            stoop: 0.0,
            embodied: false,
            balls: None,
            patience: 1.0,
        };
        session.last = session.record(&Inputs::default());
        session
    }

    /// The same, to plan for a body of links ([`Self::follow`]) whose feet, if they bend, have their balls so far ahead of
    /// the ankles, m.
    pub fn embodied(physique: &Physique, terrain: &Terrain, style: &Style, balls: Option<f64>, dt: f64) -> Session {
        let mut session = Session { embodied: true, balls, ..Session::new(physique, terrain, style, dt) };
        session.adapt();
        session
    }

    /// One tick of the plan for a body that does what is measured; see [`follow::follow`].
    pub fn follow(&mut self, intent: &Inputs, measured: &Measured) -> Option<Step> {
        let (params, terrain) = (&self.params, &self.terrain);
        follow::follow(params, &self.physique, terrain, &mut self.state, (intent, measured), self.dt)
    }

    /// Gives up sooner or later than usual: times what is usual.
    pub fn be_patient(&mut self, patience: f64) {
        if self.patience != patience {
            self.patience = patience;
            self.adapt();
        }
    }

    /// One tick in which the body's own law is at work.
    pub fn wait(&mut self, measured: &Measured) {
        follow::wait(&self.params, &self.physique, &self.terrain, &mut self.state, measured, self.dt);
    }

    /// rad, where the pelvis points whatever was planned.
    pub fn face(&mut self, facing: f64) {
        self.state.facing = facing;
        self.state.ahead = support::forward(facing);
    }

    /// From now on its trunk leans so that its centre of mass is so much lower, m, than its hips are by themselves.
    pub fn stoop(&mut self, by: f64) {
        if self.stoop != by {
            self.stoop = by;
            self.adapt();
        }
    }

    /// m, how much lower it is than it stands.
    pub fn lowered(&self) -> f64 {
        self.crouch.x * self.whole.leg_length
    }

    /// s, the length of a tick.
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// m/s, what a metre per second of a body with legs of 0.83 m is for this one.
    pub fn pace(&self) -> f64 {
        self.params.size / self.params.tempo
    }

    /// The foot that swings or is next, what share of its step is over, and the step's time, s.
    pub fn stride(&self) -> (Side, f64, f64) {
        let (params, gait) = (&self.params, &self.state.gait);
        let rhythm = walk::rhythm_now(params, &self.physique, &self.state);
        let begun = if gait.phase == Phase::Single { gait.since - rhythm.double } else { gait.since };
        (gait.side, (self.state.time - begun) / rhythm.step, rhythm.step)
    }

    /// How long its strides are for its speed, 0 to 1.
    pub fn strides(&self) -> f64 {
        push_off::strides(&self.params, &self.physique, &self.state)
    }

    /// The foot whose heel is to rise now on level ground, and how far, rad.
    pub fn heel(&self) -> Option<(Side, f64)> {
        push_off::heel(&self.params, &self.physique, &self.state)
    }

    /// One tick with that intent under those pushes (those that are acting by their times).
    pub fn step(&mut self, intent: &Inputs, pushes: &[SessionPush]) -> TickOutput {
        self.bend_to(intent.crouch);
        let inputs = acting(*intent, pushes, self.state.time, self.dt);
        let output = stepper::tick(&self.params, &self.physique, &self.terrain, &mut self.state, &inputs, self.dt);
        self.last = self.record(&inputs);
        output
    }

    /// From now on with those measures: what it carries weighs more or less. All that is tuned to a body follows.
    pub fn set_physique(&mut self, physique: &Physique) {
        if *physique != self.whole {
            self.whole = *physique;
            self.adapt();
        }
    }

    /// Starts that low already: only before the first tick.
    pub fn crouched(&mut self, amount: f64) {
        if self.state.tick == 0 && amount > 0.0 {
            self.crouch.x = amount.min(DEEPEST);
            self.adapt();
            self.state = State::standing(&self.params, &self.physique, &self.terrain, self.params.stance.middle, 0.0);
            self.last = self.record(&Inputs::default());
        }
    }

    /// Goes as low as is wanted, in about half a second: to the controller it is a body with shorter legs.
    pub fn bend_to(&mut self, amount: f64) {
        let amount = amount.clamp(0.0, DEEPEST);
        if self.crouch.x == amount && self.crouch.v == 0.0 {
            return;
        }
        let tempo = (self.whole.com_height / 0.96).max(0.0).sqrt();
        self.crouch.step(amount, 6.0 / tempo.max(1e-3), 0.95, self.dt);
        if (self.crouch.x - amount).abs() < 1e-5 && self.crouch.v.abs() < 1e-4 {
            self.crouch = Spring { x: amount, v: 0.0 };
        }
        self.adapt();
    }

    fn adapt(&mut self) {
        let lower = self.crouch.x * self.whole.leg_length;
        self.physique = Physique {
            com_height: self.whole.com_height - lower - self.stoop,
            hip_height: self.whole.hip_height - lower,
            leg_length: self.whole.leg_length - lower,
            ..self.whole
        };
        let tuned = if self.embodied { Params::embodied } else { Params::new };
        let params = tuned(&self.physique, &self.style);
        let (stumble, midair) = (self.patience * params.stumble, self.patience * params.midair);
        let upright = (1.0 - self.crouch.x / CROUCHED).max(0.0);
        self.params = Params { stumble, midair, balls: self.balls, upright, ..params };
    }

    /// The controller's state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Its tuning.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// The tick that ended now.
    pub fn tick_state(&self) -> &TickState {
        &self.last
    }

    /// Fixes the directions of pushes that are the character's own and start in the coming tick (or did before).
    pub fn resolve(&self, pushes: &mut [SessionPush]) {
        for push in pushes.iter_mut().filter(|push| push.turns && push.start < self.state.time + self.dt - 1e-9) {
            push.force = DQuat::from_rotation_y(self.state.facing) * push.force;
            push.turns = false;
        }
    }

    fn record(&self, inputs: &Inputs) -> TickState {
        let crouched = self.lowered();
        TickState {
            xi: self.state.xi(),
            push: inputs.force,
            push_moment: inputs.moment,
            crouched,
            ..still(&self.state)
        }
    }
}

/// Runs a standing character on flat ground under pushes.
pub fn simulate_pushes(physique: &Physique, pushes: &[SessionPush], options: &SimulateOptions) -> Trace {
    simulate(physique, &Script::standing(pushes), options)
}

/// Runs to the end: the asked duration, and on until at rest (at most `extra` s) unless it is told to walk on or
/// to stand on one foot; it stops where balance is lost.
pub fn simulate(physique: &Physique, script: &Script, options: &SimulateOptions) -> Trace {
    let physique = script.physiques.first().unwrap_or(physique);
    let mut session = Session::new(physique, &script.terrain, &options.style, options.dt);
    session.crouched(script.intent(0.0).crouch);
    let start = session.state.held;
    let planned = ticks_in(options.duration, options.dt);
    let most = planned + ticks_in(options.extra, options.dt);
    let mut ticks = Vec::with_capacity(planned.min(100_000) + 1);
    let mut steps = Vec::new();
    let mut pushes = script.pushes.clone();
    ticks.push(*session.tick_state());
    let settle = 0.5;
    while ticks.len() <= most {
        let intent = script.intent(session.state.time);
        let done = session.state.rest >= settle && session.state.intent.is_none();
        let goes_on = intent.stand != Feet::Both || intent.walk.is_some_and(|walk| walk != DVec2::ZERO);
        if ticks.len() > planned && (done || goes_on) {
            break;
        }
        if let Some(physique) = script.physiques.get(ticks.len()).or(script.physiques.last()) {
            session.set_physique(physique);
        }
        session.resolve(&mut pushes);
        let output = session.step(&intent, &pushes);
        ticks.push(*session.tick_state());
        steps.extend(output.landed);
        if output.lost {
            break;
        }
    }
    session.resolve(&mut pushes);
    let aloft = session.state.swing.map(|swing| {
        let land = if swing.land.is_finite() { swing.land } else { session.state.time + HOLDS_ON };
        Step {
            side: swing.side,
            kind: swing.kind,
            lift: session.state.one.lifted.unwrap_or(swing.lift),
            land,
            from: session.state.held[swing.side as usize],
            to: footing::to_ground(&swing.to, script.terrain.turn(land)),
        }
    });
    Trace { dt: options.dt, ticks, steps, aloft, pushes, start, lost: session.state.lost, rest: session.state.rest }
}

/// Whole ticks that cover that time; a day at most.
fn ticks_in(time: f64, dt: f64) -> usize {
    (time / dt - 1e-9).ceil().clamp(0.0, 8.64e6) as usize
}

/// The sum of what acts during the tick from `time`: a push that covers part of it counts by that part.
fn acting(intent: Inputs, pushes: &[SessionPush], time: f64, dt: f64) -> Inputs {
    let mut inputs = intent;
    for push in pushes {
        let from = push.start.max(time);
        let to = (push.start + push.duration).min(time + dt);
        let share = ((to - from) / dt).clamp(0.0, 1.0);
        let share = if share < 1e-9 { 0.0 } else { share };
        inputs.force += push.force * share;
        inputs.moment += (DVec3::Y * push.arm).cross(push.force) * share;
    }
    inputs
}

fn still(state: &State) -> TickState {
    TickState {
        com: state.com,
        velocity: state.velocity,
        acceleration: state.acceleration,
        xi: ground(state.com),
        cop: state.cop,
        push: DVec3::ZERO,
        push_moment: DVec3::ZERO,
        feet: state.feet,
        planted: crate::model::Side::BOTH.map(|side| state.planted(side)),
        facing: state.facing,
        walk: state.gait.velocity,
        gait: state.gait.phase,
        barred: state.gait.barred,
        crouched: 0.0,
    }
}

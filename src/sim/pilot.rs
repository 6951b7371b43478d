//! The stepper's plan leads the articulated body: it is fed the links' own state and hands on what the law is to do. Scenario space, SI.

use super::run::Course;
use super::session::Session;
use crate::maths::quat::yaw_of;
use crate::model::Side;
use crate::ragdoll::{Controller, Guide, Wish};
use crate::stepper::follow::{self, Measured};
use crate::stepper::{Inputs, Phase, Style, steep, walk};
use glam::{DVec2, DVec3};

/// m/s on legs of 0.83 m, the fastest walk that is asked of the plan: with 1.85 its feet slide.
pub const FASTEST: f64 = 1.65;
/// Times the usual, how high feet go on ground with gaps: of 25 seeded walks without search 18 keep their feet, as high as usual 9. A foot
/// that a long step has left behind a gap catches on the ground otherwise.
const HIGHER: f64 = 2.0;
/// Times the usual, how high feet go on a flight that is climbed, over what of it they step over: with 1 and with 2 they scuff more often.
const CLIMBS: f64 = 1.25;
/// s before a foot leaves, from when on the other one takes its weight.
const SOON: f64 = 0.03;
/// s for which the law must have been at ease before the plan leads again out of a stand where the ground is not flat, at legs of 0.83 m:
/// without it legs of 1.08 m walk up 19 degrees at three quarters of their speed.
const AT_EASE: f64 = 0.4;

/// s at such legs after a shove, from when on it leads again between two of the law's steps: with 0.3 more of 192 walks halt.
const CALM: f64 = 0.6;

/// s at legs of 0.83 m, over which its speed is seen, and what was asked of it too: else what it lacks while it speeds up is gathered, and
/// it then goes 3 to 6 % too fast for ten seconds. 1/s, how fast what it lacks is gathered; m/s, the most that is made up for of who walks
/// backwards or sideways (with 0.5 five of 25 drawn walks sideways fall, with 0.3 two) and ahead (with 0.3 walks of 1.5 m/s are 9 % too slow).
const SEEN: f64 = 0.6;
const GATHERS: f64 = 0.3;
const MOST: [f64; 2] = [0.3, 0.5];
/// s at legs of 0.83 m, for which the plan's speed must have been the same: what a body lags behind while it speeds up is no lack. Between 2.5
/// and 5 s 20 drawn walks of five bodies are 8 % too fast in the mean without it, 4 % with it; with 1.5 s brisk ones of others are 10 to 20 %
/// too slow. Not where there are treads or gaps: with 1.5 s 7 of 48 who are shoved amid flights up fall, not 1.
const SETTLES: f64 = 0.5;
/// 1/s and m/s: a speed that changes by more than this share, of no less than that.
const CHANGES: f64 = 0.3;
/// As [`CHANGES`] says.
const SLOW: f64 = 0.1;
/// s at legs of 0.83 m: without ankle feedback, for each m/s that it lacks the pressure is so far (m) behind where the plan has it, which
/// speeds up the whole step. By asking for more speed alone such walks are 14 % too slow at 0.9 m/s.
const BEHIND: f64 = 0.3;
/// The same with ankle feedback, and m/s at legs of 0.83 m from which on it is so and from which on in full: by asking for more speed alone
/// the built-in body goes at 1.11 m/s where 1.2 is asked for. In slow walks up a flight it is in the way.
const ROLLED: f64 = 0.15;
const HURRIES: [f64; 2] = [0.8, 1.1];

/// m/s at legs of 0.83 m, how fast the pelvis goes down into a crouch and up again.
const SINKS: f64 = 0.2;

/// The plan of a body.
#[derive(Clone, Debug)]
pub(super) struct Pilot {
    session: Session,
    led: bool,
    /// m/s, what walks lack of the speed that is asked for, summed up; how fast it went lately, and was to go, (x, z).
    lacks: DVec2,
    mean: DVec2,
    asked: DVec2,
    /// m/s, (x, z), what the plan goes at, and s, since when that is the same.
    meant: DVec2,
    steady: f64,
}

impl Pilot {
    /// At rest, as the body stands at first.
    pub(super) fn new(course: &Course, style: &Style, dt: f64) -> Pilot {
        let mut session = Session::embodied(course.physique, course.terrain, style, course.figure.balls_ahead(), dt);
        session.crouched(course.crouched());
        let [lacks, mean, asked, meant] = [DVec2::ZERO; 4];
        Pilot { session, led: false, lacks, mean, asked, meant, steady: 0.0 }
    }

    /// The plan for the coming tick: sets what guides the law, or that nothing does.
    pub(super) fn lead(&mut self, course: &Course, control: &mut Controller, inputs: &Inputs, force: DVec3) {
        self.session.bend_to(inputs.crouch.min(course.deepest));
        if course.goes && course.terrain.is_flat() {
            self.session.stoop(control.stoops(course.figure));
        }
        let most = SINKS * self.session.pace() * self.session.dt();
        control.lower += (self.session.lowered() - control.lower).clamp(-most, most);
        control.going = inputs.walk.unwrap_or_default();
        let measured = measure(course, control, self.session.state().omega(), force);
        let walking = self.session.state().gait.velocity.length() > 0.3;
        let busy = control.occupied();
        control.went = match self.gait() {
            Some((_, velocity)) => velocity.length(),
            None if busy => control.went,
            None => control.went.min(flat(control.report.velocity).length()),
        };
        let leans = !course.terrain.is_flat();
        let shaken = leans && !self.led && !walking && control.at_ease() < AT_EASE * control.tempo();
        if busy && !self.goes_on(course, control, inputs) || shaken {
            return self.stand_by(control, &measured);
        }
        let inputs = self.made_up(inputs, control);
        self.session.be_patient(control.tuning.patience);
        self.session.follow(&inputs, &measured);
        let state = self.session.state();
        self.led = follow::leads(state);
        if busy && !self.led {
            return self.stand_by(control, &measured);
        }
        control.guide = self.led.then(|| self.guide(course));
        if !self.led {
            control.look(self.session.state().facing);
        }
    }

    /// May the plan lead on from where a step against a fall would begin now? The law's own steps, that keep some of who walks' speed, can go
    /// on and on: of 260 walks of base clips that were shoved four went on so to the end of the clip. Not on treads, whose edges the law's steps keep from.
    fn goes_on(&self, course: &Course, control: &Controller, inputs: &Inputs) -> bool {
        let calm = self.session.state().shoved > CALM * control.tempo();
        let goes = inputs.walk.is_some_and(|walk| walk != DVec2::ZERO);
        calm && goes && !course.terrain.has_treads() && control.steps_off(self.session.dt())
    }

    /// Nothing is asked of the plan: it is where the body is.
    pub(super) fn rest(&mut self, course: &Course, control: &mut Controller, force: DVec3) {
        let measured = measure(course, control, self.session.state().omega(), force);
        self.stand_by(control, &measured);
    }

    /// The law is at work: the plan waits.
    fn stand_by(&mut self, control: &mut Controller, measured: &Measured) {
        self.session.wait(measured);
        control.tuning.patience = control.character.patience; // it has given up: next time as ever
        self.led = false;
        control.guide = None;
        self.mean = flat(control.report.velocity);
        self.asked = self.mean;
        self.session.face(control.looks());
    }

    /// What is asked of the plan for the body to go as fast as is asked of it: what it has been slower by is added.
    fn made_up(&mut self, inputs: &Inputs, control: &Controller) -> Inputs {
        let (state, dt) = (self.session.state(), self.session.dt());
        let (tempo, pace) = (control.tempo(), self.session.pace());
        let Some(walk) = inputs.walk.filter(|walk| *walk != DVec2::ZERO) else {
            (self.lacks, self.asked) = (DVec2::ZERO, self.mean);
            return *inputs;
        };
        let share = (dt / (SEEN * tempo)).min(1.0);
        self.mean += (flat(control.report.velocity) - self.mean) * share;
        let meant = state.gait.velocity - self.lacks;
        self.asked += (if state.climb.on { self.mean } else { meant } - self.asked) * share;
        let changes = (meant - self.meant).length() > CHANGES * meant.length().max(SLOW * pace) * dt;
        self.steady = if changes { 0.0 } else { self.steady + dt };
        self.meant = meant;
        let steady = (self.steady > SETTLES * tempo || state.gait.timed) && !state.climb.on;
        if steady && matches!(state.gait.phase, Phase::Single | Phase::Double) {
            let ahead = walk.normalize().dot(state.ahead).max(0.0);
            let most = MOST[0] + (MOST[1] - MOST[0]) * ahead;
            self.lacks = (self.lacks + (self.asked - self.mean) * (GATHERS * dt)).clamp_length_max(most * tempo);
        }
        let walk = walk.clamp_length_max(FASTEST.min(steep::fastest(state, walk.normalize())) * pace);
        Inputs { walk: Some(walk + self.lacks), ..*inputs }
    }

    fn guide(&self, course: &Course) -> Guide {
        let (state, params) = (self.session.state(), self.session.params());
        let lift = match (state.climb.on, course.terrain.has_gaps()) {
            (_, true) => params.lift_height * HIGHER,
            (true, _) => params.lift_height * CLIMBS,
            _ => steep::lift(params, course.physique, state),
        };
        let swing = state.swing.map(|swing| Wish {
            side: swing.side,
            ankle: DVec2::new(swing.to.ankle.x, swing.to.ankle.z),
            yaw: swing.to.yaw - course.start[swing.side as usize].yaw,
            left: swing.land - state.time,
            lift,
            height: follow::held_height(params, state),
        });
        let gait = &state.gait;
        let steps = matches!(gait.phase, Phase::Single | Phase::Double);
        let behind = if steps { self.behind() } else { DVec2::ZERO };
        let stride = steps.then(|| self.session.stride());
        Guide {
            pressure: follow::pressure(state) - DVec3::new(behind.x, 0.0, behind.y),
            floor: state.carried.height,
            climbs: state.carried.rate,
            heading: state.facing,
            velocity: gait.velocity,
            lean: state.climb.lean,
            heel: state.climb.heel.or_else(|| self.session.heel()).or_else(|| steep::heel(params, state)),
            spot: gait.spot,
            ends: gait.last,
            swing,
            leaves: follow::leaves(state, SOON),
            stride,
            strides: if steps { self.session.strides() } else { 0.0 },
            in_time: steps && !state.climb.on && !gait.spot && walk::in_time(params, state),
            balls: if state.climb.down { 1.0 } else { steep::share(params, state) },
        }
    }

    /// m, (x, z): how far behind where the plan has it the pressure is to be, where it stays in one place, for the body to catch up with
    /// the speed that is asked for.
    fn behind(&self) -> DVec2 {
        let (state, params) = (self.session.state(), self.session.params());
        let speed = state.gait.velocity.length() / self.session.pace();
        let [from, to] = HURRIES;
        let share = if params.rolls { ROLLED * ((speed - from) / (to - from)).clamp(0.0, 1.0) } else { BEHIND };
        state.ahead * (self.lacks.dot(state.ahead) * share * params.tempo)
    }

    /// Is something in its way that no step crosses?
    pub(super) fn barred(&self) -> bool {
        self.session.state().gait.barred
    }

    /// Where in the gait it is and what velocity (m/s) it follows, where it leads.
    pub(super) fn gait(&self) -> Option<(Phase, DVec2)> {
        let gait = &self.session.state().gait;
        self.led.then_some((gait.phase, gait.velocity - self.lacks))
    }
}

fn flat(v: DVec3) -> DVec2 {
    DVec2::new(v.x, v.z)
}

/// What the body is found to do; `rate` is its pendulum's, 1/s.
fn measure(course: &Course, control: &Controller, rate: f64, force: DVec3) -> Measured {
    let (figure, states) = (course.figure, control.states());
    let (com, velocity) = control.motion_of(rate);
    let feet = Side::BOTH.map(|side| {
        let state = states[figure.legs[side as usize][2]];
        (control.laid_flat(figure, side), yaw_of(state.turn) + course.start[side as usize].yaw)
    });
    let stands = Side::BOTH.map(|side| control.swing.is_none_or(|swing| swing.side != side));
    Measured { com, velocity, feet, stands, force }
}

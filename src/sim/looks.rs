//! How a copy of the body looks while it is run on: what of the measures of a clip can be seen of links. Scenario space, SI.

use super::run::{Course, Run, Ticked};
use crate::measure::gate::{LEAST_LEGS, LONGEST_HOVER};
use crate::measure::{legs, pops, scuff};
use crate::model::{Side, Terrain};
use glam::{DQuat, DVec3};

/// Share of the body's weight under which a foot is not on the ground.
const PRESSED: f64 = 0.01;
/// m at legs of 0.83 m, what a copy must keep between its legs: well over what the gate asks, for nearer than that calves touch.
const APART: f64 = 0.1;
/// m at such legs, what a walker must keep, whose legs pass each other at 9 cm: half a centimetre over what the gate asks for.
const CLEAR: f64 = LEAST_LEGS + 0.005;
/// m at such legs, what feet may slide in all: what one sees at a glance is a third of a foot.
const SLIDES: f64 = 0.1;
/// rad, how far the trunk may lean: people lean by 26 degrees or so at most where they keep their feet after 150 Ns.
const UPRIGHT: f64 = 0.6;
/// What a second in the air costs, a metre that legs are too near to each other, a metre that feet slide and a radian of leaning.
const HOVERS: f64 = 40.0;
const CROSSED: f64 = 60.0;
const SLID: f64 = 5.0;
const LEANS: f64 = 4.0;
/// s, a frame of those that pops are looked for in.
const FRAME: f64 = 0.03;

/// What has been seen so far.
#[derive(Clone)]
pub(super) struct Looks {
    dt: f64,
    /// N s in a tick.
    least: f64,
    hover: f64,
    /// s, the longest in the air.
    longest: f64,
    /// m at legs of 0.83 m ([`legs::size`]), the nearest that the legs came to each other.
    nearest: f64,
    /// m at such legs, how far feet slid.
    slid: f64,
    /// rad, how far the trunk leaned from upright at most.
    leaned: f64,
    /// s, the ground then, and where the points of both soles were: a tick ago.
    before: Option<(f64, Terrain, [Vec<DVec3>; 2])>,
    turns: [Vec<DQuat>; 6],
}

impl Looks {
    pub(super) fn new(course: &Course, dt: f64) -> Looks {
        Looks {
            dt,
            least: PRESSED * course.figure.mass * 9.81 * dt,
            hover: 0.0,
            longest: 0.0,
            nearest: f64::INFINITY,
            slid: 0.0,
            leaned: 0.0,
            before: None,
            turns: Default::default(),
        }
    }

    /// The tick at `time` more.
    pub(super) fn see(&mut self, course: &Course, run: &Run, ticked: &Ticked, time: f64) {
        let size = course.figure.leg_length / 0.83;
        let states = run.control.states();
        let [left, right] = course.figure.legs.map(|leg| leg.map(|link| states[link].origin));
        self.nearest = self.nearest.min(legs::distance(&left, &right) / legs::size(course.body));
        self.leaned = self.leaned.max((states[course.figure.trunk].turn * DVec3::Y).angle_between(DVec3::Y));
        let soles = Side::BOTH.map(|side| course.figure.sole_at(states, side).to_vec());
        if let Some((when, ground, before)) = &self.before {
            let presses = ticked.pressed.map(|foot| foot >= self.least);
            self.hover = if presses == [false; 2] { self.hover + self.dt } else { 0.0 };
            self.longest = self.longest.max(self.hover);
            let turned = course.terrain.turn(time) * course.terrain.turn(*when).inverse();
            for side in (0..2).filter(|side| presses[*side]) {
                self.slid += scuff::way_over((&before[side], &soles[side]), (ground, &ticked.ground), turned) / size;
            }
        }
        self.before = Some((time, ticked.ground.clone(), soles));
        for (turns, link) in self.turns.iter_mut().zip(course.figure.legs.as_flattened()) {
            let parent = course.figure.links[*link].parent.unwrap_or(0);
            turns.push(states[parent].turn.inverse() * states[*link].turn);
        }
    }

    /// What it costs so far, jumps apart: 0 where nobody minds.
    pub(super) fn cost(&self) -> f64 {
        let hovers = (self.longest - LONGEST_HOVER).max(0.0);
        let crossed = (APART - self.nearest).max(0.0);
        let slid = (self.slid - SLIDES).max(0.0);
        let leans = (self.leaned - UPRIGHT).max(0.0);
        HOVERS * hovers + CROSSED * crossed + SLID * slid + LEANS * leans
    }

    /// Whether it has gone on as nobody does, also of who walks: in the air, or with its legs in each other.
    pub(super) fn absurd(&self) -> bool {
        self.longest > LONGEST_HOVER || self.nearest < CLEAR
    }

    /// How often a joint of the legs jumps from one frame to the next.
    pub(super) fn jumps(&self) -> usize {
        let frame = ((FRAME / self.dt).round() as usize).max(1);
        let of = |turns: &Vec<DQuat>| {
            let framed = |phase: usize| turns.iter().skip(phase).step_by(frame).copied().collect::<Vec<_>>();
            (0..frame).map(|phase| pops::jumps(&framed(phase), pops::POP_LEAST, 1).len()).max().unwrap_or(0)
        };
        self.turns.iter().map(of).sum()
    }
}

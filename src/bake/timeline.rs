//! A run as functions of time: centre of mass, upper body and feet, joined into a pose at any moment.
//!
//! Series stand on the session's ticks (10 ms) and are read between them by cubics; feet are exact. Scenario space, SI.
//! The passes of `reach` and `balance` change `shift` and `lowering` only: what the stepper said stays beside them.

use super::base::Over;
use super::carried::{self, Carried};
use super::feet::FootCurves;
use crate::maths::curve::{sample, smooth3};
use crate::maths::quat::rotation_vector;
use crate::model::{Body, BodyPose, Load, Side, Terrain};
use crate::sim::articulated::UpperPose;
use crate::whole_body::reaction::{UPPER, UpperAngles, upper_turns};
use crate::whole_body::solve::Solved;
use crate::whole_body::{Anatomy, ArmAngles, FootTarget, PoseTarget, Solver};
use glam::{DQuat, DVec3};
use rayon::prelude::*;

/// s, in which a fall's poses are joined to those before.
const JOINED: f64 = 0.25;

/// Everything that a pose is made of, over the run.
#[derive(Clone, Debug)]
pub struct Timeline {
    /// Who moves.
    pub body: Body,
    /// Its chains.
    pub anatomy: Anatomy,
    /// s between entries of the series.
    pub dt: f64,
    /// s, the first disturbance: the passes change nothing before it.
    pub still_until: f64,
    /// s, when disturbances begin: what comes of them shows no sooner.
    pub surprises: Vec<f64>,
    /// m, centre of mass as the stepper has it, at the standing height (what it must sink is the reach envelope's).
    pub com: Vec<DVec3>,
    /// m, what the balance filter adds to it.
    pub shift: Vec<DVec3>,
    /// m, by how much the reach envelope lowers it; under 0 where a walker rises over a straight leg.
    pub lowering: Vec<f64>,
    /// 0 standing to 1 walking.
    pub walking: Vec<f64>,
    /// rad, bends of the knees, left and right; a leg in the air takes them, a planted one bends as it must. Empty: none does.
    pub bends: [Vec<f64>; 2],
    /// rad, how far the ankles' range turns the knees about the lines from hip to ankle, left and right. Empty: not at all.
    pub swivels: [Vec<f64>; 2],
    /// rad, what the hips' range adds to the pelvis: forward tilt, and list to the right. Empty: nothing.
    pub pelvis: [Vec<f64>; 2],
    /// Upper body and pelvis.
    pub upper: Vec<UpperAngles>,
    /// Upper body and pelvis as an articulated body moved them, instead of `upper`; empty where none did.
    pub drawn: Vec<UpperPose>,
    /// Poses after the last entry, `dt` apart, of a body that falls; empty where none does.
    pub fallen: Vec<BodyPose>,
    /// Both feet.
    pub feet: FootCurves,
    /// What they stand on.
    pub terrain: Terrain,
    /// The base clip that all this is laid over.
    pub over: Option<Over>,
    /// When the hands hold what.
    pub carried: Vec<Carried>,
    /// The boxes in them, one each.
    pub loads: Vec<Load>,
}

impl Timeline {
    /// s, the end of it all.
    pub fn duration(&self) -> f64 {
        self.stands() + self.fallen.len() as f64 * self.dt
    }

    /// s, the time of the last entry of the series: from there on it falls, or ends.
    pub fn stands(&self) -> f64 {
        (self.com.len() - 1) as f64 * self.dt
    }

    /// Goes on after the last entry as an articulated body falls, whose poses stand on the same times from 0 on: what the two
    /// differ by where they meet is let go within a moment.
    pub fn fall(&mut self, poses: &[BodyPose]) {
        let last = self.com.len() - 1;
        let Some(met) = poses.get(last) else { return };
        let pose = self.pose_at(self.stands());
        let hips = pose.hips - met.hips;
        let turns: Vec<DVec3> =
            pose.turns.iter().zip(&met.turns).map(|(drawn, real)| rotation_vector(*drawn * real.inverse())).collect();
        self.fallen = poses[last + 1..]
            .iter()
            .enumerate()
            .map(|(index, real)| {
                let left = 1.0 - smooth3((index + 1) as f64 * self.dt / JOINED);
                let turn = |(real, by): (&DQuat, &DVec3)| (DQuat::from_scaled_axis(*by * left) * *real).normalize();
                BodyPose { hips: real.hips + hips * left, turns: real.turns.iter().zip(&turns).map(turn).collect() }
            })
            .collect();
    }

    /// Ends it at an entry.
    pub fn cut(&mut self, last: usize) {
        self.com.truncate(last + 1);
        self.shift.truncate(last + 1);
        self.lowering.truncate(last + 1);
        self.walking.truncate(last + 1);
        self.bends
            .iter_mut()
            .chain(&mut self.swivels)
            .chain(&mut self.pelvis)
            .for_each(|series| series.truncate(last + 1));
        self.upper.truncate(last + 1);
        self.drawn.truncate(last + 1);
    }

    /// The target at one entry.
    pub fn target(&self, index: usize) -> PoseTarget {
        let com = self.com[index] + self.shift[index] - DVec3::Y * self.lowering[index];
        self.assemble(com, &self.upper[index], index as f64 * self.dt)
    }

    /// The target at any time.
    pub fn target_at(&self, time: f64) -> PoseTarget {
        let com = sample(&self.com, self.dt, time) + sample(&self.shift, self.dt, time)
            - DVec3::Y * sample(&self.lowering, self.dt, time);
        let mut upper = [0.0; UPPER];
        let last = self.upper.len() - 1;
        let place = (time / self.dt).clamp(0.0, last as f64);
        let first = (place.floor() as usize).saturating_sub(1);
        let window: Vec<UpperAngles> = (first..(first + 4)).map(|index| self.upper[index.min(last)]).collect();
        for (entry, value) in upper.iter_mut().enumerate() {
            let series = [window[0][entry], window[1][entry], window[2][entry], window[3][entry]];
            *value = sample(&series, 1.0, place - first as f64);
        }
        self.assemble(com, &upper, time)
    }

    /// Poses at every entry, and what each solve reports. An entry's is its own affair: within a pool of threads they are shared
    /// out, and come out the same.
    pub fn solve_all(&self) -> Vec<Solved> {
        let solver = || Solver::new(&self.body, &self.anatomy);
        let solve =
            |solver: &mut Solver, index: usize| self.solved(solver, &self.target(index), index as f64 * self.dt);
        if rayon::current_thread_index().is_some() {
            (0..self.com.len()).into_par_iter().map_init(solver, solve).collect()
        } else {
            let mut solver = solver();
            (0..self.com.len()).map(|index| solve(&mut solver, index)).collect()
        }
    }

    /// The pose at any time.
    pub fn pose_at(&self, time: f64) -> BodyPose {
        let past = (time - self.stands()) / self.dt;
        if let (Some(last), true) = (self.fallen.len().checked_sub(1), past > 1e-9) {
            let index = (past.ceil() as usize - 1).min(last);
            let share = (past - index as f64).clamp(0.0, 1.0);
            let to = &self.fallen[index];
            let from = match index.checked_sub(1) {
                Some(before) => self.fallen[before].clone(),
                None => self.pose_at(self.stands()),
            };
            return BodyPose {
                hips: from.hips.lerp(to.hips, share),
                turns: from.turns.iter().zip(&to.turns).map(|(from, to)| from.slerp(*to, share)).collect(),
            };
        }
        self.solved(&mut Solver::new(&self.body, &self.anatomy), &self.target_at(time), time).pose
    }

    /// The pose for a target, laid over the base clip where there is one.
    fn solved(&self, solver: &mut Solver, target: &PoseTarget, time: f64) -> Solved {
        match &self.over {
            None => solver.solve(target),
            Some(over) => solver.solve_over(target, Some((over.neutral(), &over.pose(time)))),
        }
    }

    /// The articulated body's upper body at a time, between its ticks by slerp.
    fn drawn_at(&self, time: f64) -> Option<(DQuat, DQuat, DQuat, [ArmAngles; 2])> {
        let last = self.drawn.len().checked_sub(1)?;
        let place = (time / self.dt).clamp(0.0, last as f64);
        let (a, b) = (&self.drawn[place.floor() as usize], &self.drawn[place.ceil() as usize]);
        let share = place.fract();
        let between = |from: f64, to: f64| from + (to - from) * share;
        let arms = [0, 1].map(|side| {
            let (a, b) = (&a.arms[side], &b.arms[side]);
            ArmAngles {
                raise: between(a.raise, b.raise),
                abduct: between(a.abduct, b.abduct),
                inward: between(a.inward, b.inward),
                elbow: between(a.elbow, b.elbow),
                curl: between(a.curl, b.curl),
            }
        });
        Some((a.pelvis.slerp(b.pelvis, share), a.chest.slerp(b.chest, share), a.head.slerp(b.head, share), arms))
    }

    fn assemble(&self, com: DVec3, upper: &UpperAngles, time: f64) -> PoseTarget {
        let (pelvis, chest, head, arms) = self.drawn_at(time).unwrap_or_else(|| upper_turns(upper));
        let feet = Side::BOTH.map(|side| {
            let bends = &self.bends[side as usize];
            let free = !bends.is_empty() && self.feet.freedom(side, time) > 0.0;
            let swivels = &self.swivels[side as usize];
            let swivel = if swivels.is_empty() { 0.0 } else { sample(swivels, self.dt, time) };
            FootTarget { bend: free.then(|| sample(bends, self.dt, time)), swivel, ..self.feet.at(side, time) }
        });
        let [tilt, list] = [0, 1]
            .map(|axis| if self.pelvis[axis].is_empty() { 0.0 } else { sample(&self.pelvis[axis], self.dt, time) });
        let pelvis = pelvis * DQuat::from_rotation_x(tilt) * DQuat::from_rotation_z(list);
        let target = PoseTarget { com, pelvis, chest, head, arms, feet, hold: None };
        match carried::hold(&self.carried, &self.loads, time) {
            Some(hold) => target.holding(hold),
            None => target,
        }
    }
}

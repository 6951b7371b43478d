//! A run as functions of time: centre of mass, upper body and feet, joined into a pose at any moment.
//!
//! Series stand on the session's ticks (10 ms) and are read between them by cubics; feet are exact. Scenario space, SI.
//! The passes of `reach` and `balance` change `shift` and `lowering` only: what the stepper said stays beside them.

use super::base::Over;
use super::carried::{self, Carried};
use super::feet::FootCurves;
use super::played::Played;
use crate::maths::curve::sample;
use crate::model::{Body, BodyPose, Load, Side, Terrain};
use crate::stepper::{Physique, Plant, Step};
use crate::whole_body::reaction::{UPPER, UpperAngles, upper_turns};
use crate::whole_body::solve::Solved;
use crate::whole_body::{Anatomy, FootTarget, PoseTarget, Solver};
use glam::{DQuat, DVec3};
use rayon::prelude::*;

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
    /// Both feet, by their steps.
    pub feet: FootCurves,
    /// What is shown instead of all that where an articulated body moves: its run. The series but `com` are empty then.
    pub played: Option<Played>,
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
    /// Of an articulated body's run, whose centre of mass (m) is known at its ticks and whose feet took those steps.
    pub(super) fn played(
        body: &Body,
        anatomy: Anatomy,
        (dt, com): (f64, Vec<DVec3>),
        (physique, start, steps): (&Physique, &[Plant; 2], &[Step]),
        terrain: &Terrain,
        played: Played,
    ) -> Timeline {
        let scale = (physique.com_height / 0.96).sqrt();
        Timeline {
            body: body.clone(),
            anatomy,
            dt,
            still_until: 0.0,
            surprises: Vec::new(),
            com,
            shift: Vec::new(),
            lowering: Vec::new(),
            walking: Vec::new(),
            bends: Default::default(),
            swivels: Default::default(),
            pelvis: Default::default(),
            upper: Vec::new(),
            feet: FootCurves::new(body, physique, start, steps, 0.0, scale, terrain),
            played: Some(played),
            terrain: terrain.clone(),
            over: None,
            carried: Vec::new(),
            loads: Vec::new(),
        }
    }

    /// s, the end of it all.
    pub fn duration(&self) -> f64 {
        self.played.as_ref().map_or(self.stands(), Played::duration)
    }

    /// Whether it goes on after the last entry, as a fall.
    pub fn falls(&self) -> bool {
        self.played.as_ref().is_some_and(Played::falls)
    }

    /// s, the time of the last entry of the series: from there on it falls, or ends.
    pub fn stands(&self) -> f64 {
        (self.com.len() - 1) as f64 * self.dt
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

    /// m, the centre of mass at any time until the last entry.
    pub fn com_at(&self, time: f64) -> DVec3 {
        if self.played.is_some() { sample(&self.com, self.dt, time) } else { self.target_at(time).com }
    }

    /// m, the centre of mass at every entry, and on through a fall.
    pub fn centres(&self) -> Vec<DVec3> {
        let Some(played) = &self.played else {
            let moved = self.com.iter().zip(&self.shift).zip(&self.lowering);
            return moved.map(|((com, shift), lowering)| *com + *shift - DVec3::Y * *lowering).collect();
        };
        let fallen = played.fallen().iter().map(|pose| pose.centre_of_mass(&self.body, &pose.positions(&self.body)));
        self.com.iter().copied().chain(fallen).collect()
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
        if let Some(played) = &self.played {
            return played.pose_at(&self.body, &self.anatomy, &self.terrain, time);
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

    fn assemble(&self, com: DVec3, upper: &UpperAngles, time: f64) -> PoseTarget {
        let (pelvis, chest, head, arms) = upper_turns(upper);
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

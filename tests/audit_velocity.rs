//! What the velocity term adds: the audit's detector of steps, and the same one that sees a foothold against the centre of mass alone.
//!
//! Both are fitted to clean clips in the same way and then set to the same number of false events there, so that neither is the stricter
//! one. What is printed is how many planted faults each of them finds, and how many false events it really has.

#![allow(dead_code)] // the benchmark uses it, the tests do not

use crate::audit_faults::Planted;
use crate::audit_grid::{Clip, Fault, Found, at_touchdown, each};
use glam::DVec2;
use rayon::prelude::*;
use surefoot::audit::placement::{self, Taken};
use surefoot::audit::stages::{Stages, with_stages};
use surefoot::audit::{AuditOptions, Mark, audit, foot_name};
use surefoot::model::Capture;
use surefoot::model::findings::Rule;

/// A detector of steps with limits that were fitted to clean clips.
#[derive(Clone, Copy, Debug)]
pub struct Detector {
    /// Footholds against ξ and the model's offset, as the audit sees them; else against the centre of mass.
    velocity: bool,
    population: DVec2,
    /// m, forward and sideways.
    pub placed: DVec2,
}

/// [with the velocity, without it], for so many false events in these clean clips.
pub fn pair(clips: &[&Clip], allowed: usize) -> [Detector; 2] {
    [true, false].map(|velocity| Detector::fit(clips, velocity, allowed))
}

/// Flags of foot-placement in clean clips by the audit itself.
pub fn own_flags(clips: &[&Clip]) -> usize {
    let of = |clip: &&Clip| {
        let found = audit(&clip.capture, &AuditOptions::default());
        found.flags.iter().filter(|flag| flag.rule == Rule::FootPlacement).count()
    };
    clips.par_iter().map(of).sum()
}

/// What clips last together.
pub fn minutes(clips: &[&Clip]) -> f64 {
    clips.iter().map(|clip| clip.capture.frames() as f64 / clip.capture.fps / 60.0).sum()
}

impl Detector {
    /// The population's mean, and limits in proportion to the errors that people make (their 95th percentiles), as narrow as that many
    /// false events let them be.
    fn fit(clips: &[&Clip], velocity: bool, allowed: usize) -> Detector {
        let bare = Detector { velocity, population: DVec2::ZERO, placed: DVec2::splat(f64::MAX) };
        let rests: Vec<Vec<DVec2>> = clips
            .par_iter()
            .map(|clip| bare.steps(&clip.capture, |stages, taken| rests(&taken, stages.track.size())))
            .collect();
        let all: Vec<DVec2> = rests.into_iter().flatten().collect();
        let population = all.iter().copied().sum::<DVec2>() / all.len().max(1) as f64;
        let bare = Detector { population, ..bare };
        let errors: Vec<DVec2> = clips.par_iter().flat_map(|clip| bare.errors(&clip.capture)).map(DVec2::abs).collect();
        let p95 = |axis: usize| {
            let mut list: Vec<f64> = errors.iter().map(|error| error[axis]).collect();
            list.sort_by(f64::total_cmp);
            list.get(list.len() * 19 / 20).copied().unwrap_or(1.0)
        };
        let spread = DVec2::new(p95(0), p95(1));
        let at = |scale: f64| Detector { placed: spread * scale, ..bare };
        let scale = (8..160).map(|step| f64::from(step) * 0.05).find(|scale| at(*scale).flagged(clips) <= allowed);
        at(scale.unwrap_or(8.0))
    }

    /// A clip's steps as it sees them.
    fn steps<T>(&self, capture: &Capture, look: impl FnOnce(&Stages, Vec<Taken>) -> T) -> T {
        let seen = |judged: &placement::Judged| match self.velocity {
            true => judged.taken,
            false => placement::without_velocity(&judged.taken),
        };
        let look = |stages: &Stages| look(stages, stages.judged.iter().map(seen).collect());
        with_stages(capture, None, look).expect("a clip of the lab has frames")
    }

    fn errors(&self, capture: &Capture) -> Vec<DVec2> {
        self.steps(capture, |stages, taken| {
            let judged = placement::judge_by(&stages.track, &taken, self.population, self.placed);
            judged.iter().map(|judged| judged.error / stages.track.size()).collect()
        })
    }

    /// The steps that it flags.
    fn flags(&self, capture: &Capture) -> Vec<Mark> {
        self.steps(capture, |stages, taken| {
            let judged = placement::judge_by(&stages.track, &taken, self.population, self.placed);
            placement::marks(&stages.feet, &judged)
        })
    }

    /// How many steps it flags in these clips.
    pub fn flagged(&self, clips: &[&Clip]) -> usize {
        clips.par_iter().map(|clip| self.flags(&clip.capture).len()).sum()
    }

    /// Plants a fault in every clip and asks it.
    pub fn ask(&self, clips: &[&Clip], fault: &Fault) -> Found {
        let say = |_: &Clip, planted: &Planted| {
            let hit = |mark: &Mark| at_touchdown(mark.start, mark.side.map(foot_name), planted);
            (self.flags(&planted.capture).iter().any(hit), (0, 0, 0))
        };
        each(clips, &fault.plant, say)
    }
}

fn rests(taken: &[Taken], size: f64) -> Vec<DVec2> {
    taken.iter().map(|step| step.rest / size).collect()
}

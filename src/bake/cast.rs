//! Who plays a scenario: a body, over its base clip if any, with what it carries and what is asked of it; and the stepper's runs of
//! it. Scenario space, SI.

use super::BakeError;
use super::base::{Base, Over, over::whole};
use super::carried::{self, Carried};
use super::perform::style;
use super::throws::{self, Ball};
use crate::measure::{KnownPush, PushPoint};
use crate::model::scenario::Scenario;
use crate::model::{Body, Load};
use crate::sim::{Script, SessionPush, SimulateOptions, Trace, simulate};
use crate::stepper::Physique;
use crate::whole_body::{Anatomy, Solver, stand};
use glam::DVec3;
use std::sync::Arc;

/// A push, and whether its direction turns with the body.
type Pushed = (KnownPush, bool);

/// All that a run of the stepper starts from.
pub(super) struct Cast<'a> {
    pub(super) body: &'a Body,
    pub(super) scenario: &'a Scenario,
    pub(super) anatomy: Anatomy,
    pub(super) over: Option<Over>,
    pub(super) physique: Physique,
    pub(super) carried: Vec<Carried>,
    pub(super) loads: Vec<Load>,
    pub(super) options: SimulateOptions,
    script: Script,
}

impl<'a> Cast<'a> {
    pub(super) fn new(body: &'a Body, scenario: &'a Scenario, base: Option<&Arc<Base>>) -> Result<Cast<'a>, BakeError> {
        let anatomy = Anatomy::new(body);
        let over = base.map(|base| Over::new(base, body, &anatomy, scenario)).transpose()?;
        let natural = stand::physique(body, &anatomy);
        let physique = over.as_ref().map_or(natural, |over| over.physique(&natural));
        let (carried, loads) = carried::carried(body, &anatomy, scenario);
        let options =
            SimulateOptions { duration: scenario.duration, style: style(scenario), ..SimulateOptions::default() };
        let most = ((options.duration + options.extra) / options.dt).ceil() as usize + 2;
        let mut physiques = carried::physiques(body, &anatomy, (&carried, &loads), options.dt, most);
        physiques.iter_mut().for_each(|one| *one = laden(&physique, &natural, one));
        let mut script = Script { physiques, ..Script::of(scenario, Vec::new()) };
        if let Some(Over::Walk(walked)) = &over {
            script.walk = vec![walked.lane()];
        }
        Ok(Cast { body, scenario, anatomy, over, physique, carried, loads, options, script })
    }

    /// The stand at a tick: what is carried moves it.
    pub(super) fn physique_at(&self, index: usize) -> &Physique {
        self.script.physiques.get(index).unwrap_or(&self.physique)
    }

    /// The run under those pushes, in a base walk's own steps until the first.
    pub(super) fn first_run(&self, pushes: &[Pushed]) -> Trace {
        match &self.over {
            Some(Over::Walk(walked)) => {
                let whole = whole(self.scenario, self.options.dt);
                let from = pushes.iter().map(|(push, _)| push.start).fold(whole, f64::min);
                walked.walk_on(from, &self.options, pushes, &|options, pushes| self.run(options, pushes))
            }
            _ => self.run(&self.options, pushes),
        }
    }

    /// Throws what the scenario throws: a ball that hits pushes too, and the run is another from there on.
    pub(super) fn throw(&self, seed: u64, pushes: &mut Vec<Pushed>, trace: &mut Trace) -> Vec<Ball> {
        let mut balls = Vec::new();
        for toss in &throws::tosses(self.scenario, seed) {
            let index = (toss.arrives / trace.dt).round() as usize;
            let Some(tick) = trace.ticks.get(index) else { break };
            let measures = self.physique_at(index);
            let ground = tick.feet[0].ankle.y.min(tick.feet[1].ankle.y);
            let com = DVec3::new(tick.com.x, ground + measures.com_height, tick.com.z);
            let target = stand::stand_target(self.body, &tick.feet, com, tick.facing);
            let hold = carried::hold(&self.carried, &self.loads, toss.arrives);
            let target = hold.map_or(target, |hold| target.holding(hold));
            let solved = Solver::new(self.body, &self.anatomy).solve(&target);
            let holds = |span: [f64; 2]| span[0] <= toss.arrives && toss.arrives <= span[1];
            let ball = toss.meet(&throws::Standing {
                body: self.body,
                pose: &solved.pose,
                velocity: tick.velocity,
                facing: tick.facing,
                mass: measures.mass,
                load: self.loads.iter().find(|load| holds(load.span)),
            });
            if let Some(hit) = &ball.hit {
                pushes.push((hit.push, false));
                pushes.sort_by(|a, b| a.0.start.total_cmp(&b.0.start));
                // What was before does not change: the next ball meets a body that this one has pushed.
                *trace = self.run(&self.options, pushes);
            }
            balls.push(ball);
        }
        balls
    }

    fn run(&self, options: &SimulateOptions, pushes: &[Pushed]) -> Trace {
        let standing = Solver::new(self.body, &self.anatomy).solve(&stand::natural_stand(self.body, &self.physique));
        let positions = standing.pose.positions(self.body);
        // What is carried lifts the centre of mass.
        let height = |time: f64| {
            let tick = (time / options.dt).round() as usize;
            let physiques = &self.script.physiques;
            physiques.get(tick).or(physiques.last()).unwrap_or(&self.physique).com_height
        };
        let pushes = pushes.iter().map(|(push, turns)| SessionPush {
            start: push.start,
            duration: push.end - push.start,
            force: push.force,
            turns: *turns,
            arm: match push.at {
                PushPoint::Joint(joint) => positions[joint].y - height(push.start),
                PushPoint::Segment(joint, offset) => {
                    (positions[joint] + standing.pose.turns[joint] * offset).y - height(push.start)
                }
                _ => 0.0,
            },
        });
        simulate(&self.physique, &Script { pushes: pushes.collect(), ..self.script.clone() }, options)
    }
}

/// Who stands like that, laden as the one who is `natural` by himself is then.
fn laden(stands: &Physique, natural: &Physique, laden: &Physique) -> Physique {
    Physique {
        mass: laden.mass,
        com_height: stands.com_height + (laden.com_height - natural.com_height),
        hip_height: stands.hip_height + (laden.hip_height - natural.hip_height),
        ..*stands
    }
}

//! Trace to clip: the passes that see the whole run before the first key is written.
//!
//! stepper run -> foot curves and upper-body springs -> poses -> reach envelope and balance filter, a few times over ->
//! keys -> the clip read back as an engine reads it and measured. Scenario space until the keys. No file is touched.

pub mod balance;
pub mod contacts;
pub mod feet;
pub mod keys;
pub mod reach;
pub mod report;
pub mod root_motion;
pub mod timeline;

use crate::maths::seed::Seed;
use crate::measure::{KnownPush, PushPoint};
use crate::model::scenario::{Feature, Scenario};
use crate::model::{Body, Clip, ClipReport, Role};
use crate::rig::Rig;
use crate::sim::session::{SessionPush, SimulateOptions, simulate_pushes};
use crate::sim::{TickState, Trace};
use crate::stepper::Physique;
use crate::whole_body::reaction::{Personality, Reaction, Senses};
use crate::whole_body::{Anatomy, stand};
use contacts::FootContact;
use root_motion::RootMode;
use timeline::Timeline;

/// How to bake.
#[derive(Clone, Debug, PartialEq)]
pub struct BakeOptions {
    /// Name of the clip; the scenario's title, made safe, where none is given.
    pub name: Option<String>,
    /// Keys a second.
    pub fps: f64,
    /// Instead of the scenario's seed.
    pub seed: Option<u64>,
    /// Where the travel goes.
    pub root: RootMode,
}

/// A baked clip and what is known of it.
#[derive(Clone, Debug)]
pub struct Baked {
    /// Keys on the rig's nodes.
    pub clip: Clip,
    /// What the clip says about itself.
    pub report: ClipReport,
    /// The run behind it.
    pub trace: Trace,
    /// Foot contacts in scenario space.
    pub contacts: Vec<FootContact>,
    /// The pushes as they acted.
    pub pushes: Vec<KnownPush>,
    /// The stand that the stepper knew.
    pub physique: Physique,
    /// For a person: what is not as asked.
    pub warnings: Vec<String>,
}

/// Why there is no clip.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// The scenario asks for what this version cannot do.
    #[error("{what} is not available yet: this version bakes pushes and pulls of a standing character on flat ground. Remove {remedy} and bake again")]
    NotAvailable {
        /// What was asked.
        what: String,
        /// What to take out.
        remedy: String,
    },
    /// The simulation broke down.
    #[error("the simulation broke down at {time:.2} s: {what} is not a finite number. Please report the rig and the scenario")]
    BrokeDown {
        /// s.
        time: f64,
        /// What became infinite.
        what: &'static str,
    },
}

/// Passes of reach envelope and balance filter.
const PASSES: usize = 5;

/// Runs the scenario on the rig and bakes the clip.
pub fn bake(rig: &Rig, scenario: &Scenario, options: &BakeOptions) -> Result<Baked, BakeError> {
    let body = &rig.body_for(scenario.character.mass);
    let anatomy = Anatomy::new(body);
    let physique = stand::physique(body, &anatomy);
    let pushes = known_pushes(body, scenario);
    let trace = run(body, &anatomy, &physique, scenario, &pushes);
    check(&trace)?;
    let seed = options.seed.unwrap_or(scenario.seed);
    let scale = (physique.com_height / 0.96).sqrt();
    let mut timeline = Timeline {
        body,
        anatomy: &anatomy,
        dt: trace.dt,
        com: trace.ticks.iter().map(|tick| tick.com).collect(),
        shift: vec![glam::DVec3::ZERO; trace.ticks.len()],
        lowering: vec![0.0; trace.ticks.len()],
        upper: upper_body(&trace, &physique, seed, scenario.character.style.arms),
        feet: feet::FootCurves::new(body, &physique, &trace.start, &trace.steps, scale),
    };
    let duration = timeline.duration();
    let contacts = timeline.feet.contacts(duration);
    let held = contacts::held(&contacts);
    for pass in 0..PASSES {
        let solved = timeline.solve_all();
        reach::lower_into_reach(&mut timeline, &solved, scale);
        if pass > 0 {
            let poses: Vec<_> = solved.into_iter().map(|solved| solved.pose).collect();
            balance::pass(&mut timeline, &poses, &held, &pushes);
        }
    }
    let solved = timeline.solve_all();
    reach::lower_into_reach(&mut timeline, &solved, scale);

    let name = options.name.clone().unwrap_or_else(|| safe_name(&scenario.title));
    let clip = keys::keyed_clip(&keys::KeyInput {
        rig,
        name: &name,
        fps: options.fps,
        duration,
        pose_at: &|time| timeline.pose_at(time),
        contacts: &contacts,
        root: options.root,
    });
    let (report, warnings) = report::report(&report::ReportInput {
        rig,
        body,
        clip: &clip,
        trace: &trace,
        contacts: &contacts,
        pushes: &pushes,
        scenario,
        seed,
        root: options.root,
    });
    Ok(Baked { clip, report, trace, contacts, pushes, physique, warnings })
}

/// The scenario's pushes and pulls as forces on joints of the body, in order of start.
fn known_pushes(body: &Body, scenario: &Scenario) -> Vec<KnownPush> {
    let mut pushes: Vec<KnownPush> = scenario
        .push
        .iter()
        .chain(&scenario.pull)
        .map(|push| KnownPush {
            start: push.start,
            end: push.end().min(scenario.duration),
            force: push.toward.unit(0.0) * push.force,
            at: PushPoint::Joint(nearest_joint(body, push.at)),
        })
        .collect();
    pushes.sort_by(|a, b| a.start.total_cmp(&b.start));
    pushes
}

/// The joint of that role, or of the nearest role up the body that it has.
pub fn nearest_joint(body: &Body, role: Role) -> usize {
    let mut role = Some(role);
    while let Some(wanted) = role {
        if let Some(joint) = body.joint(wanted) {
            return joint;
        }
        role = wanted.parent();
    }
    0
}

fn run(body: &Body, anatomy: &Anatomy, physique: &Physique, scenario: &Scenario, pushes: &[KnownPush]) -> Trace {
    let plants = stand::natural_plants(physique.stance_width, physique.com_forward);
    let com = glam::DVec3::Y * physique.com_height;
    let standing = crate::whole_body::Solver::new(body, anatomy).solve(&stand::stand_target(body, &plants, com, 0.0));
    let positions = standing.pose.positions(body);
    let pushes: Vec<SessionPush> = pushes
        .iter()
        .map(|push| SessionPush {
            start: push.start,
            duration: push.end - push.start,
            force: push.force,
            arm: match push.at {
                PushPoint::Joint(joint) => positions[joint].y - physique.com_height,
                _ => 0.0,
            },
        })
        .collect();
    let options = SimulateOptions { duration: scenario.duration, ..SimulateOptions::for_character(&scenario.character) };
    simulate_pushes(physique, &pushes, &options)
}

fn check(trace: &Trace) -> Result<(), BakeError> {
    for (index, tick) in trace.ticks.iter().enumerate() {
        let time = index as f64 * trace.dt;
        if !tick.com.is_finite() {
            return Err(BakeError::BrokeDown { time, what: "the centre of mass" });
        }
        if !tick.feet.iter().all(|foot| foot.ankle.is_finite()) {
            return Err(BakeError::BrokeDown { time, what: "a foot" });
        }
    }
    Ok(())
}

fn upper_body(
    trace: &Trace,
    physique: &Physique,
    seed: u64,
    arms_dial: f64,
) -> Vec<crate::whole_body::reaction::UpperAngles> {
    let mut draw = Seed::new(seed);
    let mut one = || draw.range(-1.0, 1.0);
    let personality = Personality {
        arms_gain: one(),
        far_arm: one(),
        arms_delay: one(),
        trunk_gain: one(),
        head_gain: one(),
        elbow: one(),
    };
    let mut reaction = Reaction::new(physique, personality, arms_dial);
    let senses = |tick: &TickState| Senses {
        acceleration: tick.acceleration,
        push: tick.push,
        xi: tick.xi,
        feet: tick.feet,
        planted: tick.planted,
        facing: tick.facing,
    };
    trace.ticks.iter().map(|tick| reaction.tick(&senses(tick), trace.dt)).collect()
}

/// A clip name that engines take: letters, digits, `_` and `-`; never at its ends the words that Godot loops by.
pub fn safe_name(title: &str) -> String {
    let mut name = String::new();
    for character in title.chars() {
        if character.is_alphanumeric() || character == '-' {
            name.push(character);
        } else if !name.is_empty() && !name.ends_with('_') {
            name.push('_');
        }
    }
    let name = name.trim_end_matches('_').to_string();
    let lower = name.to_lowercase();
    if name.is_empty() {
        "Reaction".into()
    } else if ["loop", "cycle"].iter().any(|word| lower.starts_with(word) || lower.ends_with(word)) {
        format!("Bake_{name}_clip")
    } else {
        name
    }
}

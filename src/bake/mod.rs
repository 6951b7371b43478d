//! Trace to clip: the passes that see the whole run before the first key is written.
//!
//! [`perform`] makes the motion on the body; [`keys`] turns it into keys on the rig's nodes; [`report`] reads the clip back
//! as an engine would and says what it measured. Scenario space until the keys. No file is touched here.

mod ankles;
mod apart;
pub mod auto;
mod balance;
pub mod base;
mod beyond;
mod care;
pub mod carried;
mod cast;
mod chain;
mod clearance;
pub mod contacts;
mod converge;
mod curved;
pub mod feet;
mod feet_based;
mod foot_path;
pub mod footing;
pub mod gated;
mod heels;
mod key_times;
pub mod keys;
mod knees;
mod leverage;
mod looped;
pub mod obeys;
pub mod perform;
pub mod played;
pub mod props;
pub mod pushes;
pub mod ragdoll;
mod reach;
mod report;
pub mod retargeted;
pub mod root_motion;
mod slant;
pub(crate) mod spline;
mod straight;
mod swing;
pub mod throws;
pub mod timeline;
mod track;
mod unplayed;

pub use auto::{Choice, Fall};
pub use base::{Base, BaseError};
pub use keys::Curves;
pub use perform::{Performance, perform, perform_by};
pub use ragdoll::{Drive, Helped};
pub use root_motion::RootMotion;

use crate::measure::Findings;
use crate::model::scenario::{GroundKind, Scenario};
use crate::model::{Body, Clip, ClipReport, Prop, Terrain};
use crate::rig::Rig;
use crate::sim::Ahead;
use glam::DVec2;
use std::borrow::Cow;
use std::sync::Arc;

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
    pub root: RootMotion,
    /// Who moves the body.
    pub drive: Drive,
    /// What it starts from and returns to, on the body that is baked.
    pub base: Option<Arc<Base>>,
    /// Only a cycle of it, without a seam.
    pub looped: bool,
    /// How its keys are joined. Cycles and clips over a captured base are joined by straight lines all the same.
    pub curves: Curves,
    /// How far the articulated body looks ahead for a way to keep its feet: 0 (not at all) to 3 (minutes).
    pub effort: u8,
}

/// A baked clip and what is known of it.
#[derive(Clone, Debug)]
pub struct Baked {
    /// Keys on the rig's nodes.
    pub clip: Clip,
    /// What the clip says about itself.
    pub report: ClipReport,
    /// The motion behind it.
    pub performance: Performance,
    /// All that was measured on the clip; the report holds a part.
    pub findings: Option<Findings>,
    /// What stands and moves beside the body: the ground first, then boxes and balls.
    pub props: Vec<Prop>,
    /// For a person: what is not as asked.
    pub warnings: Vec<String>,
    /// Why its drive was chosen, where that was left to the tool.
    pub choice: Option<Choice>,
}

/// Why there is no clip.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// The simulation broke down.
    #[error("the simulation broke down at {time:.2} s: {what}. Please report the rig and the scenario")]
    BrokeDown {
        /// s.
        time: f64,
        /// What became infinite, flew away or came apart.
        what: String,
    },
    /// The articulated body was thrown about faster or farther than any body is.
    #[error(
        "the ragdoll cannot go on at {time:.2} s: {what}. Give a body of {mass:.1} kg less of a push, or more mass \
         ([character] mass), or bake with `--drive stepper`; if body and push are as people know them, please report both"
    )]
    Overdone {
        /// s.
        time: f64,
        /// What became infinite, flew away or came apart.
        what: String,
        /// kg.
        mass: f64,
    },
    /// The base clip cannot be one.
    #[error(transparent)]
    Base(#[from] base::BaseError),
    /// There is no cycle in the motion.
    #[error("there is no cycle to loop: {why}")]
    NoCycle {
        /// And what would give one.
        why: String,
    },
    /// There is nothing to stand on.
    #[error("[ground]: {what}")]
    NoGround {
        /// What of it is missing, and what would be right.
        what: String,
    },
    /// The articulated body cannot play that yet.
    #[error("the ragdoll cannot play {parts} yet; bake with `--drive stepper`")]
    Unplayed {
        /// What of the scenario.
        parts: String,
    },
}

impl Default for BakeOptions {
    fn default() -> BakeOptions {
        BakeOptions {
            name: None,
            fps: 30.0,
            seed: None,
            root: RootMotion::Root,
            drive: Drive::Stepper,
            base: None,
            looped: false,
            curves: Curves::Linear,
            effort: 1,
        }
    }
}

/// Runs the scenario on the rig and bakes the clip.
pub fn bake(rig: &Rig, scenario: &Scenario, options: &BakeOptions) -> Result<Baked, BakeError> {
    if let GroundKind::Mesh { file, surface, .. } = &scenario.ground.kind {
        let lacks = match surface {
            None => Some("was not read: lay its triangles into the scenario's ground first"),
            Some(_) if !Terrain::new(&scenario.ground).spot(DVec2::ZERO).holds => Some("has nothing under the start"),
            Some(_) => None,
        };
        if let Some(lacks) = lacks {
            return Err(BakeError::NoGround { what: format!("{file} {lacks}") });
        }
    }
    match options.drive {
        Drive::Auto(helped) => auto::bake(rig, scenario, options, helped),
        drive => bake_by(rig, scenario, options, drive),
    }
}

/// Bakes with that drive.
fn bake_by(rig: &Rig, scenario: &Scenario, options: &BakeOptions, drive: Drive) -> Result<Baked, BakeError> {
    match drive {
        Drive::Ragdoll(helped) => gated::bake(rig, scenario, options, helped),
        drive => once(rig, scenario, options, (drive, Ahead::default())),
    }
}

/// Bakes once with that drive.
fn once(
    rig: &Rig,
    scenario: &Scenario,
    options: &BakeOptions,
    (drive, ahead): (Drive, Ahead),
) -> Result<Baked, BakeError> {
    let scale = scenario.character.leg_scale;
    let rig = &if scale == 1.0 { Cow::Borrowed(rig) } else { Cow::<Rig>::Owned(rig.with_leg_scale(scale)) };
    let body: Body = match scenario.character.mass {
        Some(mass) => rig.body.with_mass(mass),
        None => rig.body.clone(),
    };
    let seed = options.seed.unwrap_or(scenario.seed);
    let act = |scenario: &Scenario| perform::perform_over(&body, scenario, seed, (drive, ahead), options.base.as_ref());
    let alone = matches!(drive, Drive::Stepper) && options.base.is_none() && !options.looped;
    let longer = beyond::farther(scenario, &body).filter(|_| alone);
    // Who loses balance, be it after the clip's end, is played as he was told.
    let longer = longer.map(|longer| act(&longer)).transpose()?.filter(|longer| longer.trace.lost.is_none());
    let performance = match longer {
        Some(longer) => beyond::cut(longer, scenario),
        None => act(scenario)?,
    };
    if options.looped {
        return looped::bake(rig, scenario, options, performance, seed);
    }
    let name = options.name.clone().unwrap_or_else(|| safe_name(&scenario.title));
    let timeline = &performance.timeline;
    let heights = footing::heights(&performance);
    // A captured base trembles between its frames: curves through them would show it as kicks.
    let curves = if timeline.over.is_some() { Curves::Linear } else { options.curves };
    let keyed = |root_motion: RootMotion| {
        let input = keys::KeyInput {
            rig,
            name: &name,
            fps: options.fps,
            duration: timeline.duration(),
            pose: &|time| timeline.pose_at(time),
            contacts: &performance.contacts,
            root_motion,
            curves,
        };
        let height = |time: f64| interpolated(&heights, timeline.dt, time);
        keys::keyed_clip_on(&input, &|time| timeline.terrain.turn(time), &height)
    };
    let mut clip = keyed(options.root);
    if let Some(over) = &performance.timeline.over {
        base::add(&mut clip, rig, over.base());
    }
    // Feet of a clip without its travel slide by design: what can be measured is the same motion keyed with it.
    let travelling = (options.root == RootMotion::InPlace).then(|| keyed(RootMotion::Root));
    let measured = travelling.as_ref().unwrap_or(&clip);
    let input =
        report::ReportInput { rig, clip: measured, performance: &performance, scenario, seed, root: options.root };
    let (report, findings, warnings) = report::report(&input);
    let mut props = props::ground(&performance.timeline);
    props.extend(carried::props(&performance.timeline));
    props.extend(match &performance.articulated {
        Some(driven) => throws::flown(&performance.timeline, &driven.run.balls, &performance.balls),
        None => throws::props(&performance.timeline, &performance.balls),
    });
    Ok(Baked { clip, report, performance, findings, props, warnings, choice: None })
}

/// The value at a time of even samples, straight lines between.
fn interpolated(samples: &[f64], dt: f64, time: f64) -> f64 {
    let Some(last) = samples.len().checked_sub(1) else { return 0.0 };
    let place = (time / dt.max(1e-9)).clamp(0.0, last as f64);
    let index = place as usize;
    let next = samples[(index + 1).min(last)];
    samples[index] + (next - samples[index]) * (place - index as f64)
}

/// A clip name that engines take: letters, digits, `_` and `-`; never at its ends the words that Godot loops by.
pub fn safe_name(title: &str) -> String {
    let name = safe_letters(title);
    let lower = name.to_lowercase();
    if name.is_empty() {
        "Reaction".into()
    } else if ["loop", "cycle"].iter().any(|word| lower.starts_with(word) || lower.ends_with(word)) {
        format!("Bake_{name}_clip")
    } else {
        name
    }
}

/// What of a title engines take.
pub fn safe_letters(title: &str) -> String {
    let mut name = String::new();
    for character in title.chars() {
        if character.is_alphanumeric() || character == '-' {
            name.push(character);
        } else if !name.is_empty() && !name.ends_with('_') {
            name.push('_');
        }
    }
    name.trim_end_matches('_').to_string()
}

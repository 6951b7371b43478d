//! The base clip under a reaction, whichever kind it is.

use super::{Base, BaseError, BaseFrame, Stood, Walked};
use crate::maths::quat::wrap_angle;
use crate::model::scenario::{GroundKind, Scenario};
use crate::model::{Body, Physique, Plant};
use crate::sim::SimulateOptions;
use crate::stepper::Step;
use crate::whole_body::reaction::UpperAngles;
use crate::whole_body::{Anatomy, BasePose, Neutral};
use glam::{DQuat, DVec3};
use std::sync::Arc;

/// The entry of an upper body's angles that is where it faces.
const FACING: usize = 6;

/// A base clip that is laid under a reaction.
#[derive(Clone, Debug)]
pub enum Over {
    /// One that stands.
    Stand(Box<Stood>),
    /// One that walks.
    Walk(Box<Walked>),
}

impl Over {
    /// Measures a clip for a bake of a scenario.
    pub fn new(base: &Arc<Base>, body: &Body, anatomy: &Anatomy, scenario: &Scenario) -> Result<Over, BaseError> {
        if body.feet.iter().any(|foot| !body.joints[foot.ankle].animated) {
            let what =
                "is to play on a rig without foot bones, whose soles turn with the shanks: that is not done yet".into();
            return Err(BaseError::Unfit { name: base.name.clone(), what });
        }
        if !base.walks {
            return Stood::new(base.clone(), body, anatomy).map(|stood| Over::Stand(Box::new(stood)));
        }
        let busy = [
            (!scenario.walk.is_empty(), "[[walk]]"),
            (!scenario.turn.is_empty(), "[[turn]]"),
            (!scenario.stand.is_empty(), "[[stand]]"),
            (!scenario.crouch.is_empty(), "[[crouch]]"),
            (!scenario.throw.is_empty(), "[[throw]]"),
            (!scenario.carry.is_empty(), "[[carry]]"),
            (scenario.ground.kind != GroundKind::Flat, "[ground] that is not flat"),
        ];
        if let Some((_, part)) = busy.iter().find(|(is, _)| *is) {
            let what = format!("walks, and over a walk {part} is not played: pushes and pulls are");
            return Err(BaseError::Unfit { name: base.name.clone(), what });
        }
        Walked::new(base.clone(), body, anatomy, whole(scenario, SimulateOptions::default().dt))
            .map(|walked| Over::Walk(Box::new(walked)))
    }

    /// Who the stepper knows.
    pub fn physique(&self, physique: &Physique) -> Physique {
        match self {
            Over::Stand(stood) => stood.physique(physique),
            Over::Walk(_) => *physique,
        }
    }

    /// How much of the reaction is left at a time: `busy` (s) is when the last landing and the last disturbance are over.
    pub fn left(&self, time: f64, busy: f64, end: f64) -> f64 {
        match self {
            Over::Stand(_) => super::stand::left_over(time, busy, end),
            Over::Walk(walked) => walked.left_over(time),
        }
    }

    /// Lays the path of the centre of mass and the upper body's angles over the clip. `ground`: plants at first, steps, and the facing at
    /// the end, rad.
    pub fn lay(
        &self,
        com: &mut Vec<DVec3>,
        upper: &mut [UpperAngles],
        left: &[f64],
        dt: f64,
        (start, steps, facing): (&[Plant; 2], &[Step], f64),
    ) {
        match self {
            Over::Stand(stood) => {
                let last = com[com.len() - 1];
                let off = (stood.rests(start, steps, facing) - last) * DVec3::new(1.0, 0.0, 1.0);
                for (index, com) in com.iter_mut().enumerate() {
                    // The clip's own sway turns with the body.
                    let turned = DQuat::from_rotation_y(upper.get(index).map_or(facing, |angles| angles[FACING]));
                    *com += turned * stood.sway(index as f64 * dt) + off * (1.0 - left[index]);
                }
                for (angles, left) in upper.iter_mut().zip(left) {
                    scale(angles, *left);
                }
            }
            Over::Walk(walked) => {
                *com = walked.path(com, dt);
                for (index, angles) in upper.iter_mut().enumerate() {
                    let shows = walked.shows(index as f64 * dt);
                    scale(angles, shows);
                    let facing = walked.gait.facing;
                    angles[FACING] = facing + wrap_angle(angles[FACING] - facing) * shows;
                }
            }
        }
    }

    /// What a reaction is measured from.
    pub fn neutral(&self) -> &Neutral {
        match self {
            Over::Stand(stood) => &stood.neutral,
            Over::Walk(walked) => &walked.neutral,
        }
    }

    /// What is laid under the reaction at a time, s.
    pub fn pose(&self, time: f64) -> BasePose {
        match self {
            Over::Stand(stood) => stood.pose(time),
            Over::Walk(walked) => walked.pose(time),
        }
    }

    /// The clip's own frame then.
    pub fn frame(&self, time: f64) -> BaseFrame {
        match self {
            Over::Stand(stood) => stood.base.at(time),
            Over::Walk(walked) => walked.frame(time),
        }
    }

    /// The clip.
    pub fn base(&self) -> &super::Base {
        match self {
            Over::Stand(stood) => &stood.base,
            Over::Walk(walked) => &walked.base,
        }
    }

    /// How far out a leg reaches in the clip, in leg lengths.
    pub fn reach(&self, side: crate::model::Side) -> f64 {
        match self {
            Over::Stand(stood) => stood.reach[side as usize],
            Over::Walk(walked) => walked.gait.reach[side as usize],
        }
    }

    /// Sentences for a person.
    pub fn notes(&self) -> &[String] {
        match self {
            Over::Stand(stood) => &stood.notes,
            Over::Walk(walked) => &walked.notes,
        }
    }
}

/// s, how long a bake of that is, in whole ticks of `dt` s.
pub(in crate::bake) fn whole(scenario: &Scenario, dt: f64) -> f64 {
    (scenario.duration / dt).round() * dt
}

/// All but where it faces.
fn scale(angles: &mut UpperAngles, by: f64) {
    angles.iter_mut().enumerate().filter(|(entry, _)| *entry != FACING).for_each(|(_, angle)| *angle *= by);
}

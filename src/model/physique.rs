//! What the controller and the pose solver share: the measures of a standing body, and a foot set on the ground.
//!
//! Scenario space, SI units.

use super::Side;
use glam::{DVec2, DVec3};

/// What the controller needs to know of a body, measured in its natural stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Physique {
    /// kg.
    pub mass: f64,
    /// m, centre of mass over the ground in the natural stand.
    pub com_height: f64,
    /// m, hip to ankle along the straight leg.
    pub leg_length: f64,
    /// m, hip joint over the ground in the natural stand.
    pub hip_height: f64,
    /// m, ankle joint over the ground.
    pub ankle_height: f64,
    /// m, ankle to ankle in the natural stand.
    pub stance_width: f64,
    /// m, how far the centre of mass is ahead of the ankles' line in the natural stand.
    pub com_forward: f64,
    /// rad, outward turn of each foot in the natural stand.
    pub toe_out: f64,
    /// m, sole from the ankle along the foot: rearmost point (negative).
    pub heel: f64,
    /// m, foremost point.
    pub tip: f64,
    /// m, half of the sole's width.
    pub half_width: f64,
    /// How it stands at rest, where that is not the natural stand: feet side by side.
    pub stance: Option<Stance>,
}

/// How a body stands at rest. Ground plane as it faces: (left, ahead), m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Where the middle of the ankles is at first, (x, z).
    pub middle: DVec2,
    /// The left ankle, from the right one.
    pub apart: DVec2,
    /// The centre of mass, from the middle of the ankles.
    pub over: DVec2,
    /// rad, how far each foot is turned from where the body faces; the left is positive about +Y.
    pub yaws: [f64; 2],
}

/// A foot set on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    /// m, the ground point under the ankle joint.
    pub ankle: DVec3,
    /// rad, where the foot points, about +Y from +Z towards +X (left).
    pub yaw: f64,
    /// Unit vector out of the ground under it.
    pub normal: DVec3,
}

impl Plant {
    /// On level ground.
    pub fn level(ankle: DVec3, yaw: f64) -> Plant {
        Plant { ankle, yaw, normal: DVec3::Y }
    }
}

impl Physique {
    /// The body that constants are stated for, and that others are scaled from: 89.5 kg, legs of 0.83 m (the paper's character).
    pub const REFERENCE: Physique = Physique {
        mass: 89.5,
        com_height: 0.96,
        leg_length: 0.83,
        hip_height: 0.90,
        ankle_height: 0.08,
        stance_width: 0.18,
        com_forward: 0.045,
        toe_out: 0.1,
        heel: -0.07,
        tip: 0.18,
        half_width: 0.045,
        stance: None,
    };

    /// rad, how far a foot is turned from where the body faces when it stands at rest; to the left is positive.
    pub fn points(&self, side: Side) -> f64 {
        self.stance.map_or(side.sign() * self.toe_out, |stance| stance.yaws[side as usize])
    }

    /// m, ankle to ankle in the natural stand (0.18 m for a leg of 0.83 m); wide hips and wide shoes stand wider.
    pub fn natural_width(leg_length: f64, hip_width: f64, half_width: f64) -> f64 {
        (STANCE_WIDTH * leg_length).max(0.85 * hip_width).max(2.3 * half_width)
    }
}

/// Ankle to ankle, in leg lengths.
const STANCE_WIDTH: f64 = 0.217;

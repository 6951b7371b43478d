//! The ground as a surface: how high it is, how it leans, where it holds a foot. Scenario space, metres, radians.
//!
//! [`Terrain::spot`] answers in the **ground frame**: scenario space but for the platform, whose frame turns about the origin
//! as [`Terrain::turn`] says. Analytic and without memory, so that stepper, clip, measure and picture see the same ground.

use super::scenario::{Ground, GroundKind};
use crate::maths::seed::Seed;
use glam::{DQuat, DVec2, DVec3};

/// m ahead of the origin, where stairs and gaps begin.
pub const FIRST: f64 = 1.0;
/// m, side of the square platform.
pub const PLATFORM_SIDE: f64 = 3.0;
/// Plane waves in uneven ground.
const WAVES: usize = 6;

/// A ground that can be asked about.
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain {
    /// Its shape.
    pub kind: GroundKind,
    /// Coulomb coefficient.
    pub friction: f64,
    waves: [Wave; WAVES],
}

/// One plane wave of uneven ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Wave {
    along: DVec2, // rad/m
    phase: f64,
    height: f64, // m
}

/// The ground at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// m.
    pub height: f64,
    /// Unit vector out of the ground.
    pub normal: DVec3,
    /// False over a gap.
    pub holds: bool,
}

impl Terrain {
    /// The ground of a scenario.
    pub fn new(ground: &Ground) -> Terrain {
        let mut waves = [Wave::default(); WAVES];
        if let GroundKind::Uneven { height, wavelength, seed } = ground.kind {
            let mut draw = Seed::new(seed);
            for (index, wave) in waves.iter_mut().enumerate() {
                let angle = (index as f64 + draw.between(-0.4, 0.4)) * std::f64::consts::PI / WAVES as f64;
                let length = wavelength * draw.between(0.8, 1.6);
                *wave = Wave {
                    along: DVec2::new(angle.sin(), angle.cos()) * (std::f64::consts::TAU / length),
                    phase: draw.between(0.0, std::f64::consts::TAU),
                    height: 0.5 * height / WAVES as f64 * 1.8,
                };
            }
        }
        Terrain { kind: ground.kind.clone(), friction: ground.friction, waves }
    }

    /// The plane y = 0 with friction 1.
    pub fn flat() -> Terrain {
        Terrain::new(&Ground::default())
    }

    /// Is it the plane y = 0 for good?
    pub fn is_flat(&self) -> bool {
        self.kind == GroundKind::Flat
    }

    /// Does it turn under the feet?
    pub fn moves(&self) -> bool {
        matches!(self.kind, GroundKind::Platform { .. })
    }

    /// The ground at (x, z) in the ground frame.
    pub fn spot(&self, at: DVec2) -> Spot {
        let level = |height: f64| Spot { height, normal: DVec3::Y, holds: true };
        match self.kind {
            GroundKind::Flat | GroundKind::Platform { .. } => level(0.0),
            GroundKind::Slope { angle } => {
                Spot { height: at.y * angle.tan(), normal: DVec3::new(0.0, angle.cos(), -angle.sin()), holds: true }
            }
            GroundKind::Stairs { rise, tread, count } => {
                let climbed = if at.y < FIRST { 0.0 } else { ((at.y - FIRST) / tread).floor() + 1.0 };
                level(rise * climbed.min(f64::from(count)))
            }
            GroundKind::Gaps { width, spacing } => {
                let into = (at.y - FIRST).rem_euclid(spacing);
                Spot { holds: at.y < FIRST || into >= width, ..level(0.0) }
            }
            GroundKind::Uneven { .. } => {
                let (mut height, mut lean) = (0.0, DVec2::ZERO);
                for wave in &self.waves {
                    let (sin, cos) = (wave.along.dot(at) + wave.phase).sin_cos();
                    // level under the start, so that everybody stands well
                    height += wave.height * (sin - wave.phase.sin());
                    lean += wave.along * (wave.height * cos);
                }
                Spot { height, normal: DVec3::new(-lean.x, 1.0, -lean.y).normalize(), holds: true }
            }
        }
    }

    /// How the ground frame is turned about the origin at a time: identity for everything but a platform.
    pub fn turn(&self, time: f64) -> DQuat {
        let GroundKind::Platform { pitch, roll } = &self.kind else { return DQuat::IDENTITY };
        DQuat::from_rotation_z(along(roll, time)) * DQuat::from_rotation_x(-along(pitch, time))
    }
}

/// The value at a time of (s, value) points, straight lines between, constant beyond the ends; 0 where there are none.
fn along(points: &[[f64; 2]], time: f64) -> f64 {
    let after = points.partition_point(|point| point[0] <= time);
    match (after.checked_sub(1).and_then(|before| points.get(before)), points.get(after)) {
        (Some(before), Some(next)) => {
            before[1] + (next[1] - before[1]) * (time - before[0]) / (next[0] - before[0]).max(1e-9)
        }
        (Some(only), None) | (None, Some(only)) => only[1],
        (None, None) => 0.0,
    }
}

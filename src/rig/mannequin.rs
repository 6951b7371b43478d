//! The built-in rig: an artist's mannequin of 1.7 m and 89.5 kg with the paper's 36 degrees of freedom, as GLB bytes.
//!
//! Metres, Y up, facing +Z, on the ground; arms 40 degrees off the body; joints named as VRM 1.0 names them, every one
//! without rotation of its own. `scenes[0].extras.surefoot.mass_kg` holds the mass, and each joint's
//! `extras.surefoot.limits_deg` its range. The same options give the same bytes. Surface in
//! [`super::mannequin_shape`], bytes in [`super::mannequin_document`].

use super::{mannequin_document, mannequin_shape};
use crate::maths::real;
use crate::model::Role;
use glam::DVec3;

/// The checked-in rig: `mannequin(&MannequinOptions::default())`.
pub const BUILTIN: &[u8] = include_bytes!("../../rigs/mannequin.glb");

/// Height of the proportions below, m.
const HEIGHT: f64 = 1.70;
/// Hip joint and ankle over the ground in them, m: between, the legs stretch.
const HIP: f64 = 0.91;
const ANKLE: f64 = 0.08;
/// kg at that height; others go with the square.
const MASS: f64 = 89.5;

/// What can be varied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MannequinOptions {
    /// m, with legs of ordinary length. Clamped to 0.1 to 10.
    pub height: f64,
    /// Length of the legs, hip to ankle, over their ordinary length: the height changes with them, the rest of the body
    /// does not. Clamped to 0.3 to 3.
    pub leg_scale: f64,
    /// kg; `None` for 89.5 at 1.7 m, with the square of the height.
    pub mass: Option<f64>,
}

impl Default for MannequinOptions {
    fn default() -> Self {
        MannequinOptions { height: HEIGHT, leg_scale: 1.0, mass: None }
    }
}

/// The rig as a GLB file.
pub fn mannequin(options: &MannequinOptions) -> Vec<u8> {
    let clean = |value: f64, low: f64, high: f64, default: f64| {
        if value.is_finite() { value.clamp(low, high) } else { default }
    };
    let scale = clean(options.height, 0.1, 10.0, HEIGHT) / HEIGHT;
    let leg_scale = clean(options.leg_scale, 0.3, 3.0, 1.0);
    let mass = options.mass.filter(|mass| mass.is_finite() && *mass > 0.0).unwrap_or(MASS * scale * scale);
    let fit = |place: DVec3| {
        let above_ankle = (place.y - ANKLE).clamp(0.0, HIP - ANKLE);
        DVec3::new(place.x, place.y + above_ankle * (leg_scale - 1.0), place.z) * scale
    };
    let bones = skeleton();
    let mut surface = mannequin_shape::surface(&bones);
    for place in &mut surface.positions {
        *place = fit(*place);
    }
    surface.shade();
    let fitted: Vec<Bone> = bones.into_iter().map(|bone| Bone { place: fit(bone.place), ..bone }).collect();
    mannequin_document::glb(&fitted, &surface, mass)
}

/// Ranges of motion: its name, from, to, degrees.
type Limits = &'static [(&'static str, f64, f64)];

/// A joint of the skeleton.
#[derive(Clone, Debug)]
pub(super) struct Bone {
    /// Its name in the file; for all but the root its role's.
    pub name: &'static str,
    /// Index of its parent, smaller than its own.
    pub parent: Option<usize>,
    /// m, scenario space.
    pub place: DVec3,
    /// Degrees from the neutral stand (arms down, legs straight): (motion, from, to), usual ranges of motion of an adult.
    pub limits: Limits,
}

/// Index of a joint by its role's name.
pub(super) fn bone(bones: &[Bone], role: Role) -> usize {
    bones.iter().position(|bone| bone.name == role.name()).unwrap_or(0)
}

/// Unit: down the left arm at rest.
pub(super) fn arm_direction() -> DVec3 {
    let off_body = 40f64.to_radians();
    DVec3::new(real::sin(off_body), -real::cos(off_body), 0.0)
}

/// Where the left arm begins, m.
pub(super) const SHOULDER: DVec3 = DVec3::new(0.170, 1.364, -0.013);

/// Root, trunk, and both sides.
fn skeleton() -> Vec<Bone> {
    use Role::*;
    const WAIST: Limits = &[("flexion", -25.0, 60.0), ("side", -30.0, 30.0), ("twist", -35.0, 35.0)];
    const NECK: Limits = &[("flexion", -60.0, 60.0), ("side", -45.0, 45.0), ("twist", -75.0, 75.0)];
    const SHOULDER_RANGE: Limits = &[("flexion", -50.0, 170.0), ("abduction", -40.0, 160.0), ("rotation", -80.0, 80.0)];
    const ELBOW: Limits = &[("flexion", 0.0, 145.0)];
    const WRIST: Limits = &[("flexion", -70.0, 75.0), ("deviation", -20.0, 35.0)];
    const HIP_RANGE: Limits = &[("flexion", -30.0, 125.0), ("abduction", -30.0, 45.0), ("rotation", -45.0, 45.0)];
    const KNEE: Limits = &[("flexion", 0.0, 150.0)];
    const ANKLE_RANGE: Limits = &[("dorsiflexion", -50.0, 30.0), ("inversion", -20.0, 30.0)];
    const TOES: Limits = &[("extension", -30.0, 60.0)];

    let mut bones: Vec<Bone> = vec![Bone { name: "root", parent: None, place: DVec3::ZERO, limits: &[] }];
    let put = |bones: &mut Vec<Bone>, role: Role, place: DVec3, limits: Limits| {
        let parent = role.parent().map_or(0, |parent| bone(bones, parent));
        bones.push(Bone { name: role.name(), parent: Some(parent), place, limits });
    };
    for (role, y, z, limits) in [
        (Hips, 0.955, 0.0, &[][..]),
        (Spine, 1.05, -0.004, WAIST),
        (Chest, 1.17, -0.008, &[]),
        (UpperChest, 1.28, -0.012, &[]),
        (Neck, 1.425, -0.018, NECK),
        (Head, 1.505, 0.002, &[]),
    ] {
        put(&mut bones, role, DVec3::new(0.0, y, z), limits);
    }
    let down = arm_direction();
    let on_arm = |along: f64, ahead: f64, inwards: f64| {
        let out = DVec3::new(-down.y, down.x, 0.0);
        SHOULDER + down * along + DVec3::Z * ahead - out * inwards
    };
    let left: [(Role, DVec3, Limits); 15] = [
        (LeftShoulder, DVec3::new(0.03, 1.385, -0.008), &[]),
        (LeftUpperArm, SHOULDER, SHOULDER_RANGE),
        (LeftLowerArm, on_arm(0.285, -0.002, 0.0), ELBOW),
        (LeftHand, on_arm(0.535, 0.0, 0.0), WRIST),
        (LeftUpperLeg, DVec3::new(0.09, HIP, 0.0), HIP_RANGE),
        (LeftLowerLeg, DVec3::new(0.09, 0.495, 0.004), KNEE),
        (LeftFoot, DVec3::new(0.09, ANKLE, -0.012), ANKLE_RANGE),
        (LeftToes, DVec3::new(0.09, 0.024, 0.112), TOES),
        (LeftThumbMetacarpal, on_arm(0.555, 0.026, 0.008), &[]),
        (LeftThumbProximal, on_arm(0.590, 0.051, 0.018), &[]),
        (LeftThumbDistal, on_arm(0.612, 0.062, 0.024), &[]),
        (LeftMiddleProximal, on_arm(0.625, 0.0, 0.002), &[]),
        (LeftMiddleIntermediate, on_arm(0.661, 0.0, 0.004), &[]),
        (LeftMiddleDistal, on_arm(0.685, 0.0, 0.007), &[]),
        (LeftEye, DVec3::ZERO, &[]),
    ];
    let left = &left[..14];
    for (role, place, limits) in left {
        put(&mut bones, *role, *place, limits);
    }
    for (role, place, limits) in left {
        put(&mut bones, role.mirrored(), DVec3::new(-place.x, place.y, place.z), limits);
    }
    bones
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `SUREFOOT_WRITE_MANNEQUIN=1 cargo test --lib the_checked_in_rig` writes it anew.
    #[test]
    fn the_checked_in_rig_is_what_the_generator_makes() {
        let bytes = mannequin(&MannequinOptions::default());
        if std::env::var_os("SUREFOOT_WRITE_MANNEQUIN").is_some() {
            let path = concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/mannequin.glb");
            std::fs::write(path, &bytes).expect("rigs/ can be written");
            return;
        }
        assert_eq!(bytes.len(), BUILTIN.len());
        assert!(bytes == BUILTIN, "rigs/mannequin.glb is stale: see this test's comment");
    }
}

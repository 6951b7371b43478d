//! The curves of a take: for every bone its translation (cm), rotation (degrees) and, where it changes or differs from rest, its scale.

use super::euler;
use super::skeleton::Skeleton;
use super::take::Take;
use crate::rig::Trs;
use glam::DVec3;

/// cm, degrees or factor: values nearer to each other are the same.
const SAME: f64 = 1e-6;

/// Three curves of one property of one bone.
#[derive(Clone, Debug)]
pub struct Animated {
    /// Into the bones.
    pub bone: usize,
    /// "T", "R" or "S", as FBX programs call the node of such curves.
    pub short: &'static str,
    /// The property that they move.
    pub property: &'static str,
    /// X, Y, Z: frames and values. Two keys where nothing changes.
    pub curves: [Vec<(usize, f32)>; 3],
}

/// All of a take, bone by bone.
pub fn curves(skeleton: &Skeleton, take: &Take) -> Vec<Animated> {
    let mut all = Vec::new();
    for (index, bone) in skeleton.bones.iter().enumerate() {
        let locals = || take.frames.iter().map(|locals| &locals[index]);
        let mut add = |short, property, values: &[DVec3]| {
            let curve = |axis: usize| keys(values.iter().map(|value| value[axis]));
            all.push(Animated { bone: index, short, property, curves: [0, 1, 2].map(curve) });
        };
        add("T", "Lcl Translation", &locals().map(|local| local.translation).collect::<Vec<_>>());
        let mut before = rest_angles(&bone.rest);
        let turned = |local: &Trs| {
            before = euler::nearest(local.rotation, before);
            before
        };
        add("R", "Lcl Rotation", &locals().map(turned).collect::<Vec<_>>());
        let scales: Vec<DVec3> = locals().map(|local| local.scale).collect();
        if scales.iter().any(|scale| (*scale - bone.rest.scale).abs().max_element() > SAME) {
            add("S", "Lcl Scaling", &scales);
        }
    }
    all
}

/// Degrees: a bone's rotation at rest.
pub fn rest_angles(rest: &Trs) -> DVec3 {
    euler::nearest(rest.rotation, DVec3::ZERO)
}

/// A key a frame; the first and the last alone where all are the same.
fn keys(values: impl Iterator<Item = f64>) -> Vec<(usize, f32)> {
    let keys: Vec<(usize, f64)> = values.enumerate().collect();
    let Some((_, first)) = keys.first() else { return Vec::new() };
    let still = keys.iter().all(|(_, value)| (value - first).abs() <= SAME);
    let last = keys.len() - 1;
    let kept = keys.iter().filter(|(frame, _)| !still || *frame == 0 || *frame == last);
    kept.map(|(frame, value)| (*frame, *value as f32)).collect()
}

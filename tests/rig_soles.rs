//! Soles of a mesh whose weights are wrong on one side: measured again as the other's mirror image.

use super::rig_variants::{load_document, nothing};
use glam::DVec3;
use serde_json::json;
use surefoot::model::{FootShape, Role};
use surefoot::rig::mannequin::BUILTIN;
use surefoot::rig::{Document, Rig, inspect_text};

/// The built-in rig, the vertices of a part of one foot that hang on the shank in front of `ahead` (m before the ankle) or behind it.
fn with_a_torn_foot(side: &str, ahead: f64, in_front: bool) -> Rig {
    let mut document = Document::parse("builtin.glb", BUILTIN, &nothing).unwrap_or_else(|error| panic!("{error}"));
    let plain = load_document(&document).expect("the built-in rig");
    let role = |name: &str| Role::from_name(&format!("{side}{name}")).expect("a role");
    let joints = document.json["skins"][0]["joints"].as_array().expect("joints").clone();
    let joint = |name: &str| {
        joints.iter().position(|node| *node == json!(plain.mapping.bones[&role(name)])).expect("a joint") as u8
    };
    let (shank, foot, toes) = (joint("LowerLeg"), joint("Foot"), joint("Toes"));
    let ankle = plain.body.joints[plain.body.joint(role("Foot")).expect("an ankle")].rest;
    let start =
        |accessor: usize| document.json["bufferViews"][accessor]["byteOffset"].as_u64().expect("an offset") as usize;
    let (places, indices) = (start(0), start(2));
    let count = document.json["accessors"][0]["count"].as_u64().expect("a count") as usize;
    let bytes = &mut document.buffers[0];
    for vertex in 0..count {
        let at = places + 12 * vertex + 8;
        let z = f64::from(f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]));
        let torn = (z - ankle.z > ahead) == in_front;
        for slot in bytes[indices + 4 * vertex..indices + 4 * vertex + 4].iter_mut() {
            if torn && (*slot == foot || *slot == toes) {
                *slot = shank;
            }
        }
    }
    load_document(&document).expect("a rig")
}

#[test]
fn a_sole_unlike_the_other_by_a_quarter_is_the_others_mirror_image() {
    let whole = super::common::builtin();
    assert!(!whole.mapping.warnings.iter().any(|warning| warning.contains("mirror")), "{:?}", whole.mapping.warnings);
    for (side, other, ahead, in_front) in
        [("right", "left", 0.02, true), ("left", "right", 0.02, true), ("right", "left", 0.06, false)]
    {
        let rig = with_a_torn_foot(side, ahead, in_front);
        let what = format!("{side} {ahead}: {:?}", rig.mapping.warnings);
        let told = format!("the {other} one is used mirrored for the {side} foot too");
        assert!(rig.mapping.warnings.iter().any(|warning| warning.contains(&told)), "{what}");
        assert!(inspect_text(&rig).contains(&told), "{what}");
        assert!(rig.mapping.confidence < whole.mapping.confidence, "{what}");
        for (foot, wanted) in rig.body.feet.iter().zip(&whole.body.feet) {
            let sizes = |foot: &FootShape| [foot.heel, foot.ball, foot.tip, foot.half_width, foot.ankle_height];
            for (found, wanted) in sizes(foot).into_iter().zip(sizes(wanted)) {
                assert!((found - wanted).abs() < 1e-6, "{what}: {found} instead of {wanted}");
            }
            assert_eq!((foot.ankle, foot.toe), (wanted.ankle, wanted.toe), "{what}");
        }
        let points = |side: usize| {
            let foot = &rig.body.feet[side];
            foot.rear_sole.iter().chain(&foot.front_sole).copied().collect::<Vec<_>>()
        };
        let image: Vec<_> = points(0).into_iter().map(|point| DVec3::new(-point.x, point.y, point.z)).collect();
        assert_eq!(image, points(1), "{what}");
    }
}

#[test]
fn a_sole_that_differs_by_less_than_a_quarter_stays_as_it_was_measured() {
    // The foremost vertices hang on the shank.
    let rig = with_a_torn_foot("right", 0.185, true);
    let length = |side: usize| rig.body.feet[side].tip - rig.body.feet[side].heel;
    assert!(!rig.mapping.warnings.iter().any(|warning| warning.contains("mirror")), "{:?}", rig.mapping.warnings);
    assert!(length(1) < 0.97 * length(0) && length(1) > 0.8 * length(0), "{} and {}", length(0), length(1));
}

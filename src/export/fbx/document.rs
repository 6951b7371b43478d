//! An FBX 7.4 document: settings, objects, connections. Centimetres, Y up, +Z ahead; nothing of a clock in it.
//!
//! Objects are a model and an attribute a bone, the bind pose, and one animation stack with one layer. Identities are numbers in the
//! order of writing: the same take gives the same bytes.

use super::curves::{Animated, rest_angles};
use super::element::{Element, Value, properties, property};
use super::skeleton::{Bone, Skeleton};
use super::take::Take;
use glam::{DAffine3, DVec3};

/// FBX counts time in these parts of a second (KTime).
const TICKS: i64 = 46_186_158_000;
/// Version 7.4, which every reader of binary FBX knows.
const VERSION: i32 = 7400;
/// The time of creation in every file, and the identity that the SDK computes from it.
const CREATED: &str = "1970-01-01 10:00:00:000";
const FILE_ID: [u8; 16] =
    [0x28, 0xb3, 0x2a, 0xeb, 0xb6, 0x24, 0xcc, 0xc2, 0xbf, 0xc8, 0xb0, 0x2a, 0xa9, 0x2b, 0xfc, 0xf1];
/// Flags of a key (KeyAttrFlags): straight lines to the next (4), with what the SDK says of tangents nobody uses.
const STRAIGHT: i32 = 0x4 | 0x100 | 0x2000 | 0x4000;
/// Identity of the scene.
const DOCUMENT: i64 = 1_000_000;
/// Identity of the first bone; the others follow.
const MODELS: i64 = 2_000_000;
/// The same of their attributes.
const ATTRIBUTES: i64 = 3_000_000;
/// Identity of the bind pose.
const POSE: i64 = 4_000_000;
/// Of the animation stack.
const STACK: i64 = 5_000_000;
/// Of its layer.
const LAYER: i64 = 6_000_000;
/// Of the first node of curves: its three curves follow, then the next.
const CURVES: i64 = 7_000_000;

/// The records of a file. `name`: of the take; `animated`: its curves.
pub fn document(name: &str, skeleton: &Skeleton, take: &Take, animated: &[Animated]) -> Vec<Element> {
    let creator = concat!("surefoot ", env!("CARGO_PKG_VERSION"));
    let end = time(take.frames.len().saturating_sub(1), take);
    vec![
        header(creator),
        Element::one("FileId", Value::Bytes(FILE_ID.to_vec())),
        Element::one("CreationTime", CREATED),
        Element::one("Creator", creator),
        settings(take, end),
        documents(name),
        Element::new("References", Vec::new()),
        definitions(skeleton, animated),
        objects(name, skeleton, take, animated, end),
        connections(skeleton, animated),
        takes(name, end),
    ]
}

/// KTime of a frame.
fn time(frame: usize, take: &Take) -> i64 {
    let rate = (take.fps.round() as i64).max(1); // every rate of a take is whole, and divides a second's ticks
    frame as i64 * (TICKS / rate)
}

fn header(creator: &str) -> Element {
    let stamp =
        [("Version", 1000), ("Year", 1970), ("Month", 1), ("Day", 1), ("Hour", 10), ("Minute", 0), ("Second", 0)];
    let stamp = stamp.into_iter().chain([("Millisecond", 0)]).map(|(name, number)| Element::one(name, number));
    let text = |name: &str, value: &str| property(name, "KString", "", "", vec![value.into()]);
    let application = ["Original|ApplicationName", "LastSaved|ApplicationName"].map(|name| text(name, "surefoot"));
    Element::new("FBXHeaderExtension", Vec::new()).with([
        Element::one("FBXHeaderVersion", 1003),
        Element::one("FBXVersion", VERSION),
        Element::one("EncryptionType", 0),
        Element::new("CreationTimeStamp", Vec::new()).with(stamp),
        Element::one("Creator", creator),
        Element::new("SceneInfo", vec![object("GlobalInfo", "SceneInfo"), "UserData".into()]).with([
            Element::one("Type", "UserData"),
            Element::one("Version", 100),
            properties(application),
        ]),
    ])
}

fn settings(take: &Take, end: i64) -> Element {
    let int = |name: &str, value: i32| property(name, "int", "Integer", "", vec![value.into()]);
    let number = |name: &str, value: f64| property(name, "double", "Number", "", vec![value.into()]);
    let moment = |name: &str, value: i64| property(name, "KTime", "Time", "", vec![value.into()]);
    Element::new("GlobalSettings", Vec::new()).with([
        Element::one("Version", 1000),
        properties([
            int("UpAxis", 1),
            int("UpAxisSign", 1),
            int("FrontAxis", 2),
            int("FrontAxisSign", 1),
            int("CoordAxis", 0),
            int("CoordAxisSign", 1),
            int("OriginalUpAxis", 1),
            int("OriginalUpAxisSign", 1),
            number("UnitScaleFactor", 1.0),
            number("OriginalUnitScaleFactor", 1.0),
            property("TimeMode", "enum", "", "", vec![take.time_mode.into()]),
            moment("TimeSpanStart", 0),
            moment("TimeSpanStop", end),
            number("CustomFrameRate", -1.0),
        ]),
    ])
}

fn documents(name: &str) -> Element {
    Element::new("Documents", Vec::new()).with([
        Element::one("Count", 1),
        Element::new("Document", vec![DOCUMENT.into(), "Scene".into(), "Scene".into()]).with([
            properties([
                property("SourceObject", "object", "", "", Vec::new()),
                property("ActiveAnimStackName", "KString", "", "", vec![name.into()]),
            ]),
            Element::one("RootNode", 0_i64),
        ]),
    ])
}

/// How many objects of each kind there are.
fn definitions(skeleton: &Skeleton, animated: &[Animated]) -> Element {
    let (bones, moved) = (skeleton.bones.len() as i32, animated.len() as i32);
    let kinds = [
        ("GlobalSettings", 1),
        ("NodeAttribute", bones),
        ("Model", bones),
        ("Pose", 1),
        ("AnimationStack", 1),
        ("AnimationLayer", 1),
        ("AnimationCurveNode", moved),
        ("AnimationCurve", 3 * moved),
    ];
    let total: i32 = kinds.iter().map(|(_, count)| count).sum();
    Element::new("Definitions", Vec::new())
        .with([Element::one("Version", 100), Element::one("Count", total)])
        .with(kinds.map(|(kind, count)| Element::one("ObjectType", kind).with([Element::one("Count", count)])))
}

fn objects(name: &str, skeleton: &Skeleton, take: &Take, animated: &[Animated], end: i64) -> Element {
    let bones = &skeleton.bones;
    let moment = |name: &str, value: i64| property(name, "KTime", "Time", "", vec![value.into()]);
    let stack =
        Element::new("AnimationStack", vec![STACK.into(), object(name, "AnimStack"), "".into()]).with([properties([
            moment("LocalStart", 0),
            moment("LocalStop", end),
            moment("ReferenceStart", 0),
            moment("ReferenceStop", end),
        ])]);
    // Assimp asks a layer for fields.
    let weight = property("Weight", "Number", "", "A", vec![100.0.into()]);
    let layer = Element::new("AnimationLayer", vec![LAYER.into(), object("BaseLayer", "AnimLayer"), "".into()])
        .with([properties([weight])]);
    Element::new("Objects", Vec::new())
        .with(bones.iter().enumerate().map(|(index, bone)| attribute(index, bone)))
        .with(bones.iter().enumerate().map(|(index, bone)| model(index, bone)))
        .with([bind_pose(bones), stack, layer])
        .with(animated.iter().enumerate().flat_map(|(index, one)| curves(index, one, take)))
}

/// A name as binary FBX has it: with its class behind a zero and a one.
fn object(name: &str, class: &str) -> Value {
    Value::Text(format!("{name}\0\x01{class}"))
}

fn attribute(index: usize, bone: &Bone) -> Element {
    let (kind, flags) = if bone.is_null { ("Null", "Null") } else { ("LimbNode", "Skeleton") };
    let id = ATTRIBUTES + index as i64;
    let fields = vec![id.into(), object(&bone.name, "NodeAttribute"), kind.into()];
    let size = property("Size", "double", "Number", "", vec![1.0.into()]);
    Element::new("NodeAttribute", fields).with([properties([size]), Element::one("TypeFlags", flags)])
}

fn model(index: usize, bone: &Bone) -> Element {
    let kind = if bone.is_null { "Null" } else { "LimbNode" };
    let vector = |name: &str, value: DVec3| property(name, name, "", "A", value.to_array().map(Value::F64).to_vec());
    let fields = vec![(MODELS + index as i64).into(), object(&bone.name, "Model"), kind.into()];
    Element::new("Model", fields).with([
        Element::one("Version", 232),
        properties([
            property("RotationActive", "bool", "", "", vec![1.into()]),
            property("InheritType", "enum", "", "", vec![1.into()]), // a parent's scale acts on what is in it
            property("ScalingMax", "Vector3D", "Vector", "", [0.0; 3].map(Value::F64).to_vec()),
            property("DefaultAttributeIndex", "int", "Integer", "", vec![0.into()]),
            vector("Lcl Translation", bone.rest.translation),
            vector("Lcl Rotation", rest_angles(&bone.rest)),
            vector("Lcl Scaling", bone.rest.scale),
        ]),
        Element::one("Shading", Value::Bool(true)),
        Element::one("Culling", "CullingOff"),
    ])
}

fn bind_pose(bones: &[Bone]) -> Element {
    let node = |(index, bone): (usize, &Bone)| {
        Element::new("PoseNode", Vec::new()).with([
            Element::one("Node", MODELS + index as i64),
            Element::one("Matrix", Value::F64s(matrix(&bone.bind_global))),
        ])
    };
    Element::new("Pose", vec![POSE.into(), object("BindPose", "Pose"), "BindPose".into()])
        .with([
            Element::one("Type", "BindPose"),
            Element::one("Version", 100),
            Element::one("NbPoseNodes", bones.len() as i32),
        ])
        .with(bones.iter().enumerate().map(node))
}

/// Column by column.
fn matrix(affine: &DAffine3) -> Vec<f64> {
    glam::DMat4::from(*affine).to_cols_array().to_vec()
}

/// The node of three curves and the curves.
fn curves(index: usize, animated: &Animated, take: &Take) -> Vec<Element> {
    let id = CURVES + 4 * index as i64;
    let first = |axis: usize| animated.curves[axis].first().map_or(0.0, |(_, value)| f64::from(*value));
    let axes = ["d|X", "d|Y", "d|Z"];
    let values = (0..3).map(|axis| property(axes[axis], "Number", "", "A", vec![first(axis).into()]));
    let fields = vec![id.into(), object(animated.short, "AnimCurveNode"), "".into()];
    let mut all = vec![Element::new("AnimationCurveNode", fields).with([properties(values)])];
    for (axis, keys) in animated.curves.iter().enumerate() {
        let fields = vec![(id + 1 + axis as i64).into(), object("", "AnimCurve"), "".into()];
        all.push(Element::new("AnimationCurve", fields).with([
            Element::one("Default", first(axis)),
            Element::one("KeyVer", 4008),
            Element::one("KeyTime", Value::I64s(keys.iter().map(|(frame, _)| time(*frame, take)).collect())),
            Element::one("KeyValueFloat", Value::F32s(keys.iter().map(|(_, value)| *value).collect())),
            Element::one("KeyAttrFlags", Value::I32s(vec![STRAIGHT])),
            Element::one("KeyAttrDataFloat", Value::F32s(vec![0.0; 4])),
            Element::one("KeyAttrRefCount", Value::I32s(vec![keys.len() as i32])),
        ]));
    }
    all
}

fn connections(skeleton: &Skeleton, animated: &[Animated]) -> Element {
    let link = |child: i64, parent: i64| Element::new("C", vec!["OO".into(), child.into(), parent.into()]);
    let moves = |child: i64, parent: i64, property: &str| {
        Element::new("C", vec!["OP".into(), child.into(), parent.into(), property.into()])
    };
    let mut all = Vec::new();
    for (index, bone) in skeleton.bones.iter().enumerate() {
        let index = index as i64;
        all.push(link(MODELS + index, bone.parent.map_or(0, |parent| MODELS + parent as i64)));
        all.push(link(ATTRIBUTES + index, MODELS + index));
    }
    all.push(link(LAYER, STACK));
    for (index, one) in animated.iter().enumerate() {
        let id = CURVES + 4 * index as i64;
        all.push(link(id, LAYER));
        all.push(moves(id, MODELS + one.bone as i64, one.property));
        all.extend((1..).zip(["d|X", "d|Y", "d|Z"]).map(|(axis, part)| moves(id + axis, id, part)));
    }
    Element::new("Connections", Vec::new()).with(all)
}

/// The list of takes that readers of older files look at.
fn takes(name: &str, end: i64) -> Element {
    let span = |field: &'static str| Element::new(field, vec![0_i64.into(), end.into()]);
    Element::new("Takes", Vec::new()).with([
        Element::one("Current", name),
        Element::one("Take", name).with([
            Element::one("FileName", format!("{name}.tak")),
            span("LocalTime"),
            span("ReferenceTime"),
        ]),
    ])
}

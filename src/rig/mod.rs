//! A glTF, VRM or FBX file as a [`Rig`]: its document kept whole, the humanoid found in it, and the body to simulate.
//!
//! The way of a file: bytes -> [`document`] (JSON and buffers, checked) -> nodes and bind pose -> roles (VRM extension,
//! name tables of `rigs/names/`, geometry, override file) -> [`Body`] in scenario space.

pub mod accessor;
pub mod animate;
pub mod bind;
pub mod body;
pub mod clips;
pub mod document;
pub mod entry;
pub mod error;
pub mod fbx;
mod flanks;
mod flesh;
pub mod geometry;
pub mod images;
pub mod inspect;
mod leg_scale;
pub mod level;
pub mod load;
pub mod mannequin;
mod mannequin_document;
mod mannequin_mesh;
mod mannequin_shape;
pub mod mapping;
pub mod mesh;
pub mod names;
pub mod nodes;
pub mod overrides;
mod sampler;
mod segments;
mod skin;
mod sole;
mod sole_frame;
mod sole_plane;
mod sole_twin;
pub mod space;
pub mod vrm;

pub use error::{Fault, RigError};
pub use inspect::{inspect_json, inspect_text};
pub use load::{load, load_bytes, load_with, skeleton};

use crate::model::{Body, Role};
use glam::{DQuat, DVec2, DVec3};
use std::collections::BTreeMap;

/// A loaded humanoid rig.
#[derive(Clone, Debug)]
pub struct Rig {
    /// The source, whole.
    pub document: Document,
    /// One a node of the document, same index.
    pub nodes: Vec<RigNode>,
    /// The body in scenario space.
    pub body: Body,
    /// (body joints) the node that each joint is; `None` where it was extrapolated.
    pub joint_nodes: Vec<Option<usize>>,
    /// Metres, Y up, Z forward -> the document's own world.
    pub document_from_scenario: Similarity,
    /// How the bones were found.
    pub mapping: Mapping,
    /// What is drawn, at bind pose, for soles, segment sizes and pictures.
    pub mesh: Vec<MeshPart>,
    /// Nodes that a clip must hold scaled, and by which factor: see [`Rig::with_leg_scale`]. Empty for a rig as it was loaded.
    pub leg_scales: BTreeMap<usize, f64>,
}

/// The source document: its JSON as it stands in the file and its buffers, resolved.
#[derive(Clone, Debug)]
pub struct Document {
    /// The glTF JSON, key order kept.
    pub json: serde_json::Value,
    /// One a buffer of the document: the bytes that its uri, or the GLB's BIN chunk, holds.
    pub buffers: Vec<Vec<u8>>,
    /// Whether buffer 0 is the GLB's own (has no uri).
    pub glb_buffer: bool,
    /// Images decoded for pictures, by image index; `None` where it could not be read (never an error).
    pub images: Vec<Option<image::RgbaImage>>,
    /// The files of images that lie beside the document (a relative uri), by image index: they move into an exported GLB.
    pub image_files: Vec<Option<Vec<u8>>>,
}

/// A node: local transforms relative to its parent, document units.
#[derive(Clone, Debug)]
pub struct RigNode {
    /// Its name.
    pub name: Option<String>,
    /// Index of the parent node.
    pub parent: Option<usize>,
    /// Indices of the children, in the document's order.
    pub children: Vec<usize>,
    /// Local transform as the file has it.
    pub local: Trs,
    /// Local transform in the bind pose (from the inverse bind matrices; equal to `local` where no skin says otherwise).
    pub bind: Trs,
    /// The file gives a `matrix`: it cannot be animated as it stands.
    pub has_matrix: bool,
    /// The mesh that it draws.
    pub mesh: Option<usize>,
    /// The skin that it draws it with.
    pub skin: Option<usize>,
}

/// Translation, rotation, scale: T * R * S.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "plain")]
pub struct Trs {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
}

/// `document = translation + rotation * (scale * scenario)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// Document units a metre (100 for a file in centimetres).
    pub scale: f64,
    /// Scenario axes to document axes.
    pub rotation: DQuat,
    /// Document units.
    pub translation: DVec3,
}

/// Which bones were found, how, and how sure that is.
#[derive(Clone, Debug)]
pub struct Mapping {
    /// "vrm1", "vrm0", "names: Mixamo", "geometry", with "+ override" where a file beside the rig spoke.
    pub method: String,
    /// 0..1.
    pub confidence: f64,
    /// Role to node.
    pub bones: BTreeMap<Role, usize>,
    /// Sentences for a person.
    pub warnings: Vec<String>,
    /// The document's up axis, as in "+Y".
    pub up: String,
    /// The document's forward axis, as in "+Z".
    pub forward: String,
}

/// A triangle mesh as it hangs on the rig: scenario space, metres, at the bind pose.
#[derive(Clone, Debug, Default)]
pub struct MeshPart {
    /// m.
    pub positions: Vec<DVec3>,
    /// Unit; empty where the file has none.
    pub normals: Vec<DVec3>,
    /// (vertices) or empty.
    pub uvs: Vec<DVec2>,
    /// (vertices) four (node index, weight), weights summing to 1. A rigid mesh has its node with weight 1.
    pub weights: Vec<[(usize, f64); 4]>,
    /// Three a triangle.
    pub indices: Vec<u32>,
    /// Linear RGBA base colour.
    pub base_color: [f32; 4],
    /// Index into `Document::images`.
    pub base_texture: Option<usize>,
}

impl Trs {
    /// No transform.
    pub const IDENTITY: Trs = Trs { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };

    /// As an affine matrix.
    pub fn affine(&self) -> glam::DAffine3 {
        glam::DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

impl Similarity {
    /// A point of scenario space in the document's world.
    pub fn point(&self, scenario: DVec3) -> DVec3 {
        self.translation + self.rotation * (scenario * self.scale)
    }

    /// A point of the document's world in scenario space.
    pub fn inverse_point(&self, document: DVec3) -> DVec3 {
        (self.rotation.inverse() * (document - self.translation)) / self.scale
    }

    /// A global turn in scenario axes as one in document axes.
    pub fn turn(&self, scenario: DQuat) -> DQuat {
        self.rotation * scenario * self.rotation.inverse()
    }

    /// The inverse of [`Self::turn`].
    pub fn inverse_turn(&self, document: DQuat) -> DQuat {
        self.rotation.inverse() * document * self.rotation
    }
}

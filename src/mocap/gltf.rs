//! Clips of glTF, GLB, VRM and VRMA documents.
//!
//! Where the document draws a body, the rig loader says who moves: rest from the inverse bind matrices, soles from the mesh. Where it
//! draws none (a bare skeleton, a VRM animation), or its rest pose is nobody's, the motion itself shows the rest pose: see
//! [`super::skeleton`]. Frames are read off the tracks at the rate that the keys show.

use super::skeleton::{Recording, Said, settle_unit, stand};
use super::{MocapError, Options, Reading, frames, rate};
use crate::model::capture::ToldPush;
use crate::model::{Capture, Role};
use crate::rig::clips::{Tracks, names_in, read_tracks};
use crate::rig::document::Resolve;
use crate::rig::nodes::{globals, order, read_nodes};
use crate::rig::space::{Landmarks, nearest_axis};
use crate::rig::{Document, Fault, Rig, RigError, RigNode, bind, load_bytes};
use glam::DVec3;
use std::sync::Arc;

/// Nodes of a document that draws no body.
const MOST_NODES: usize = 20_000;

/// A document that was read.
#[derive(Clone, Debug)]
pub struct Gltf {
    /// Whole.
    pub document: Arc<Document>,
    nodes: Vec<RigNode>,
    rig: Option<Rig>, // where it draws a body
}

impl Gltf {
    /// Reads a document. `resolve` reads what it points to.
    pub fn open(name: &str, bytes: &[u8], resolve: &Resolve, overrides: Option<&str>) -> Result<Gltf, MocapError> {
        match load_bytes(name, bytes, resolve, overrides) {
            Ok(mut rig) if !rig.mesh.is_empty() => {
                // The sampler asks for the document and nodes alone.
                let document = Arc::new(std::mem::replace(&mut rig.document, empty()));
                return Ok(Gltf { document, nodes: rig.nodes.clone(), rig: Some(rig) });
            }
            Ok(_) | Err(RigError::MissingBones { .. } | RigError::NotHumanoid { .. }) => {}
            Err(RigError::WrongKind { what, .. }) if what.contains("VRM animation") => {}
            Err(error) => return Err(error.into()),
        }
        let document = Document::parse(name, bytes, resolve)?;
        let mut nodes = read_nodes(&document).map_err(|fault| fault.in_file(name))?;
        if nodes.len() > MOST_NODES {
            let what = format!("{} nodes: over {MOST_NODES} are too many for a skeleton", nodes.len());
            return Err(Fault::new("nodes", what).in_file(name).into());
        }
        let skins = bind::read_skins(&document, &nodes).map_err(|fault| fault.in_file(name))?;
        bind::set_bind_pose(&mut nodes, &skins);
        Ok(Gltf { document: Arc::new(document), nodes, rig: None })
    }

    /// The clips' names; what has none is called by its index.
    pub fn names(&self) -> Vec<String> {
        let named = |(index, name): (usize, String)| if name.is_empty() { format!("animation {index}") } else { name };
        names_in(&self.document).into_iter().enumerate().map(named).collect()
    }

    /// The document's nodes.
    pub fn nodes(&self) -> &[RigNode] {
        &self.nodes
    }

    /// Reads one clip.
    pub fn read(&self, file: &str, index: usize, said: &Said, options: &Options) -> Result<Reading, MocapError> {
        let tracks = read_tracks(&self.document, self.nodes.len(), index)
            .map_err(|fault| MocapError::Rig(fault.in_file(file)))?;
        let clip = self.names().swap_remove(index);
        let Some((start, end)) = tracks.span() else {
            return Err(MocapError::NoClip { file: file.into(), what: format!("clip \"{clip}\" moves no node") });
        };
        let fps = options.fps.or_else(|| told_rate(&self.document, index)).unwrap_or_else(|| {
            rate::of_keys(tracks.list.iter().map(|track| track.times.as_slice()), start).unwrap_or(rate::DEFAULT)
        });
        let keys = tracks.list.iter().map(|track| track.times.len()).max().unwrap_or(0);
        let frames = rate::frames(end - start, fps, keys).ok_or_else(|| MocapError::Malformed {
            file: file.into(),
            place: format!("animations[{index}]"),
            what: format!("lasts {:.0} s: too long for its {keys} keys", end - start),
        })?;
        let local = |frame: usize, node: usize| tracks.local(node, start + frame as f64 / fps, &self.nodes[node].local);
        let recording = Recording {
            names: self.nodes.iter().map(|node| node.name.clone().unwrap_or_default()).collect(),
            parents: self.nodes.iter().map(|node| node.parent).collect(),
            order: order(&self.nodes),
            zero: self.nodes.iter().map(|node| node.bind).collect(),
            fps,
            frames,
            local: &local,
            unit: 1.0,
            up: Some(DVec3::Y),
            extensions: self.document.json.get("extensions"),
        };
        let (rig, up) = match &self.rig {
            Some(rig) => {
                let up = said.up.unwrap_or_else(|| self.up(rig, &tracks, start, end));
                let mut rig = rig.clone();
                if said.unit.is_some() {
                    settle_unit(&mut rig, 1.0, said.unit);
                }
                (rig, up)
            }
            None => stand(file, &recording, said)?,
        };
        let mut capture = frames::read(&clip, &recording, &rig, up);
        capture.notes.extend(tracks.notes);
        capture.pushes = pushes(&self.document, index, start, &capture);
        Ok(Reading { capture, rig, start, frame_up: up })
    }

    /// +Y, unless both rest pose and motion lie across it.
    fn up(&self, rig: &Rig, tracks: &Tracks, start: f64, end: f64) -> DVec3 {
        let at_rest: Vec<DVec3> = globals(&self.nodes, |node| node.bind).iter().map(|at| at.translation).collect();
        let by_rest = Landmarks::of(&rig.mapping.bones, &at_rest).map_or(DVec3::Y, |marks| marks.body_up());
        if by_rest.y > 0.6 {
            return DVec3::Y;
        }
        let order = order(&self.nodes);
        let shown: DVec3 = (0..=8)
            .filter_map(|at| {
                let time = start + (end - start) * f64::from(at) / 8.0;
                let mut places = vec![glam::DAffine3::IDENTITY; self.nodes.len()];
                for &node in &order {
                    let above = self.nodes[node].parent.map_or(glam::DAffine3::IDENTITY, |parent| places[parent]);
                    places[node] = above * tracks.local(node, time, &self.nodes[node].local).affine();
                }
                let places: Vec<DVec3> = places.iter().map(|place| place.translation).collect();
                Some(Landmarks::of(&rig.mapping.bones, &places)?.body_up() / 9.0)
            })
            .sum();
        if shown.y > 0.2 { DVec3::Y } else { nearest_axis(shown) }
    }
}

/// Hz: the rate at which a clip was baked here; keys at the edges of contacts do not tell it.
fn told_rate(document: &Document, index: usize) -> Option<f64> {
    let told = document.list("animations").get(index)?.pointer("/extras/surefoot/fps")?.as_f64()?;
    (told.is_finite() && (1.0..=1000.0).contains(&told)).then_some(told)
}

/// The disturbances that a clip which was baked here tells in its extras.
fn pushes(document: &Document, index: usize, start: f64, capture: &Capture) -> Vec<ToldPush> {
    let told = document.list("animations").get(index).and_then(|clip| clip.pointer("/extras/surefoot/disturbances"));
    let list = told.and_then(serde_json::Value::as_array).map(Vec::as_slice).unwrap_or_default();
    let number =
        |value: Option<&serde_json::Value>| value.and_then(serde_json::Value::as_f64).filter(|it| it.is_finite());
    list.iter()
        .filter_map(|push| {
            let force = push.get("force")?.as_array()?;
            let axis = |at: usize| number(force.get(at));
            let role = push.get("bone").and_then(serde_json::Value::as_str).and_then(Role::from_name);
            Some(ToldPush {
                start: number(push.get("start"))? - start,
                end: number(push.get("end"))? - start,
                force: DVec3::new(axis(0)?, axis(1)?, axis(2)?),
                joint: role.and_then(|role| capture.body.joint(role)),
            })
        })
        .collect()
}

fn empty() -> Document {
    Document {
        json: serde_json::Value::Null,
        buffers: Vec::new(),
        glb_buffer: false,
        images: Vec::new(),
        image_files: Vec::new(),
    }
}

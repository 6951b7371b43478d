//! The mesh of a clip's own file in the poses of the clip, and of its correction.
//!
//! In: the file's rig, the clip's tracks, new local transforms of nodes. Out: node transforms in clip space (metres, Y up, the file's own
//! origin and heading), as a 3D view skins with. Between frames of a correction locals are blended.

use crate::correct::locals::Edits;
use crate::maths::quat::shortest_arc;
use crate::mocap::Reading;
use crate::picture::{NodeTransforms, transforms_of_locals};
use crate::rig::clips::{Tracks, read_tracks};
use crate::rig::{Rig, Trs};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// A rig with a clip of its file.
#[derive(Clone, Debug)]
pub struct Skinned {
    /// With its mesh.
    pub rig: Arc<Rig>,
    tracks: Tracks,
    /// s in the file at which frame 0 stands.
    start: f64,
    fps: f64,
    /// What stands over the document's roots, so that poses come out in clip space.
    root: DAffine3,
}

impl Skinned {
    /// The clip of that index; `None` where the rig has no mesh or is another than the clip's.
    pub fn of(rig: Arc<Rig>, clip: usize, reading: &Reading) -> Option<Skinned> {
        let drawn = rig.mesh.iter().any(|part| !part.indices.is_empty());
        if !drawn || rig.nodes.len() != reading.rig.nodes.len() {
            return None;
        }
        let tracks = read_tracks(&rig.document, rig.nodes.len(), clip).ok()?;
        // The unit may be one that a person said: the clip's rig knows it.
        let to_clip = DAffine3::from_scale_rotation_translation(
            DVec3::splat(1.0 / reading.rig.document_from_scenario.scale),
            shortest_arc(reading.frame_up, DVec3::Y),
            DVec3::ZERO,
        );
        let own = &rig.document_from_scenario;
        let document =
            DAffine3::from_scale_rotation_translation(DVec3::splat(own.scale), own.rotation, own.translation);
        let (start, fps) = (reading.start, reading.capture.fps);
        Some(Skinned { root: document * to_clip, rig, tracks, start, fps })
    }

    /// The nodes at a time (s from frame 0), corrected where there are edits.
    pub fn pose(&self, time: f64, edits: Option<&Edits>) -> NodeTransforms {
        let at = (time * self.fps).max(0.0);
        let (frame, share) = (at.floor() as usize, at.fract());
        let edited = |frame: usize, node: usize| edits.and_then(|edits| edits.get(&(frame, node)));
        let locals: Vec<Trs> = (0..self.rig.nodes.len())
            .map(|node| {
                let rest = &self.rig.nodes[node].local;
                let read = |frame: f64| self.tracks.local(node, self.start + frame / self.fps, rest);
                match (edited(frame, node), edited(frame + 1, node)) {
                    (None, None) => read(at),
                    (from, to) => {
                        let from = from.copied().unwrap_or_else(|| read(frame as f64));
                        let to = to.copied().unwrap_or_else(|| read(frame as f64 + 1.0));
                        Trs {
                            translation: from.translation.lerp(to.translation, share),
                            rotation: from.rotation.slerp(to.rotation, share),
                            scale: from.scale.lerp(to.scale, share),
                        }
                    }
                }
            })
            .collect();
        transforms_of_locals(&self.rig, &locals, self.root)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{BakeOptions, bake};
    use crate::disk::resolve;
    use crate::mocap::{self, Options};
    use crate::model::Scenario;
    use crate::rig::load_bytes;

    #[test]
    fn the_mesh_stands_where_the_clip_has_the_body() {
        let builtin = resolve::builtin_rig().expect("loads");
        let baked = bake(&builtin, &Scenario::demo(), &BakeOptions::default()).expect("bakes");
        let bytes = crate::export::glb(&builtin, &[(baked.clip, baked.report)]).expect("writes").bytes;
        let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        let file = mocap::read("demo.glb", &bytes, &alone, None).expect("a clip file");
        let reading = file.reading(0, &Options::default()).expect("a clip");
        let rig = Arc::new(load_bytes("demo.glb", &bytes, &alone, None).expect("a rig"));
        let skinned = Skinned::of(Arc::clone(&rig), 0, &reading).expect("a mesh");
        for frame in [0, 20, 45] {
            let nodes = skinned.pose(frame as f64 / reading.capture.fps, None);
            for (joint, node) in rig.joint_nodes.iter().enumerate() {
                let Some(node) = node else { continue };
                let stands = nodes[*node].transform_point3(rig.body.joints[joint].rest);
                let meant = reading.capture.at(frame)[joint];
                assert!(stands.distance(meant) < 1e-4, "frame {frame} joint {joint}: {stands} {meant}");
            }
        }
    }

    #[test]
    fn an_edit_counts_in_its_frame_and_fades_to_its_neighbours() {
        let rig = Arc::new(resolve::builtin_rig().expect("loads"));
        let node = rig.joint_nodes[0].expect("hips");
        let skinned = Skinned {
            rig: Arc::clone(&rig),
            tracks: Tracks::default(),
            start: 0.0,
            fps: 10.0,
            root: DAffine3::IDENTITY,
        };
        let mut moved = rig.nodes[node].local;
        moved.translation += DVec3::X;
        let edits = Edits::from([((2, node), moved)]);
        let way = |time: f64| {
            let (was, is) = (skinned.pose(time, None)[node], skinned.pose(time, Some(&edits))[node]);
            (is.translation - was.translation).length()
        };
        let whole = way(0.2);
        assert!(whole > 0.5 && (way(0.15) - 0.5 * whole).abs() < 1e-9 && way(0.1) < 1e-12 && way(0.35) < 1e-12);
    }
}

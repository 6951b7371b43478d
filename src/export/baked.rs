//! A baked clip as the files that are written for it: the rig's document with the clip, a VRM animation or an FBX, and the events beside.

use super::{ExportError, events_json, fbx, glb_with_root, only_animation, vrma};
use crate::bake::{Baked, RootMotion};
use crate::model::{Clip, ClipReport, FileKind, Prop, Target};
use crate::rig::Rig;
use crate::rig::animate::RootCarrier;

/// Which files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// What kind of file.
    pub kind: FileKind,
    /// Ground, boxes and balls too, as animated nodes; a VRM animation and an FBX have none.
    pub props: bool,
    /// The node that carries root motion as a joint of the skins.
    pub root_joint: bool,
    /// Skeleton and clip alone: see [`only_animation`].
    pub only_animation: bool,
    /// Without the two nodes that show the contacts.
    pub no_contact_nodes: bool,
}

impl Form {
    /// A clip without what the form leaves out.
    pub fn clip(&self, clip: &Clip) -> Clip {
        let mut clip = clip.clone();
        let shows = |target: Target| matches!(target, Target::ContactLeft | Target::ContactRight);
        clip.channels.retain(|channel| !self.no_contact_nodes || !shows(channel.target));
        clip
    }

    /// A file without what the form leaves out; `names`: of the clips that were made.
    pub fn file(&self, file: Vec<u8>, names: &[String]) -> Result<Vec<u8>, ExportError> {
        match self.only_animation {
            true => only_animation(&file, &|_, name| names.iter().any(|made| made == name)),
            false => Ok(file),
        }
    }
}

/// The bytes of a baked file and of what stands beside it.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The rig's document with the clip in it, a VRM animation or an FBX.
    pub file: Vec<u8>,
    /// `{ clip name: report }`.
    pub events: Vec<u8>,
    /// The name that the clip got.
    pub name: String,
    /// What had to change in the source's own values, or could not be said.
    pub changes: Vec<String>,
}

/// Makes the files of what was baked.
pub fn baked(rig: &Rig, baked: &Baked, form: Form) -> Result<Exported, ExportError> {
    let props = if form.props { &baked.props[..] } else { &[] };
    exported(rig, (&baked.clip, &baked.report), props, form)
}

/// Makes the files of a clip and its report; `props`: things beside the body, which a GLB holds.
pub fn exported(
    rig: &Rig,
    (clip, report): (&Clip, &ClipReport),
    props: &[Prop],
    form: Form,
) -> Result<Exported, ExportError> {
    if form.kind == FileKind::Fbx {
        let made = fbx(rig, clip, report)?;
        let events = events_json([(made.name.as_str(), &made.report)])?;
        return Ok(Exported { file: made.bytes, events, name: made.name, changes: made.changes });
    }
    if form.kind == FileKind::Vrma {
        let name = clip.name.clone();
        let made = vrma(rig, clip, report)?;
        let events = events_json([(name.as_str(), &made.report)])?;
        return Ok(Exported { file: made.bytes, events, name, changes: made.losses });
    }
    let clips = [(form.clip(clip), report.clone())];
    let file = glb_with_root(rig, &clips, props, form.root_joint.then(|| root_target(rig)))?;
    let bytes = form.file(file.bytes, &file.names)?;
    let name = file.names.into_iter().next().unwrap_or_else(|| clip.name.clone());
    let events = events_json([(name.as_str(), report)])?;
    Ok(Exported { file: bytes, events, name, changes: file.changes })
}

/// What carries root motion under `--root root`: a node of the rig, or the one that is put over its scene.
pub fn root_target(rig: &Rig) -> Target {
    match RootMotion::Root.carrier(rig) {
        RootCarrier::Node(node) => Target::Node(node),
        _ => Target::NewRoot,
    }
}

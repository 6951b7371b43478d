//! What a base clip moves beside the body: capes, props, twist bones, tails. Their local tracks go into the baked clip as they are.
//!
//! Only nodes of the rig's own clip that no joint drives and that carry none that one does: what is over the hips is the root motion's.
//! Document space, the node's own units. Leaves out scales and morph targets.

use super::Base;
use crate::bake::keys::NEAREST;
use crate::model::{Channel, Clip, Interpolation, KeyValues, Target};
use crate::rig::Rig;
use crate::rig::animate::Poser;
use crate::rig::clips::{Tracks, read_tracks};

/// Of the value's own unit (of a rotation: of a unit quaternion): what differs by less is the same.
const SAME: f32 = 2e-5;

/// Adds the tracks to a clip that was baked over `base`, whose own clip of the rig has that index.
pub fn add(clip: &mut Clip, rig: &Rig, base: &Base) {
    let Some(own) = base.own else { return };
    let Ok(tracks) = read_tracks(&rig.document, rig.nodes.len(), own) else { return };
    let start = tracks.span().map_or(0.0, |span| span.0);
    let poser = Poser::new(rig);
    let mut carries = vec![false; rig.nodes.len()];
    for node in rig.parents_first().into_iter().rev() {
        carries[node] |= poser.drives()[node].is_some();
        if let (true, Some(parent)) = (carries[node], rig.nodes[node].parent) {
            carries[parent] = true;
        }
    }
    for node in (0..rig.nodes.len()).filter(|node| !carries[*node] && tracks.moves(*node)) {
        let moved = clip.channels.iter().any(|channel| channel.target == Target::Node(node));
        if !moved {
            clip.channels.extend(channels(rig, &tracks, node, base, start, clip));
        }
    }
}

/// Translation and rotation of one node over the baked clip, where they differ from what the node holds.
fn channels(rig: &Rig, tracks: &Tracks, node: usize, base: &Base, start: f64, clip: &Clip) -> Vec<Channel> {
    let rest = &rig.nodes[node].local;
    let count = (clip.duration * base.fps).ceil() as usize;
    let inner = (0..count).map(|key| key as f64 / base.fps).filter(|time| *time < clip.duration - NEAREST);
    let times: Vec<f64> = inner.chain([clip.duration]).collect();
    let locals: Vec<_> = times.iter().map(|time| tracks.local(node, start + base.wrapped(*time), rest)).collect();
    let translations: Vec<[f32; 3]> = locals.iter().map(|local| local.translation.as_vec3().to_array()).collect();
    let mut rotations: Vec<[f32; 4]> = locals.iter().map(|local| local.rotation.as_quat().to_array()).collect();
    for key in 1..rotations.len() {
        let dot: f32 = rotations[key].iter().zip(&rotations[key - 1]).map(|(a, b)| a * b).sum();
        if dot < 0.0 {
            rotations[key].iter_mut().for_each(|value| *value = -*value);
        }
    }
    let size = translations.iter().flatten().fold(1.0_f32, |most, value| most.max(value.abs()));
    let mut list = Vec::new();
    let held = rest.translation.as_vec3().to_array();
    if translations.iter().any(|value| differs(value, &held, SAME * size)) {
        let keys = thinned(&translations, SAME * size);
        list.push(channel(node, &times, &keys, KeyValues::Translation(picked(&translations, &keys))));
    }
    let held = rest.rotation.as_quat().to_array();
    let other = held.map(|value| -value);
    if rotations.iter().any(|value| differs(value, &held, SAME) && differs(value, &other, SAME)) {
        let keys = thinned(&rotations, SAME);
        list.push(channel(node, &times, &keys, KeyValues::Rotation(picked(&rotations, &keys))));
    }
    list
}

fn channel(node: usize, times: &[f64], keys: &[usize], values: KeyValues) -> Channel {
    let times = keys.iter().map(|key| times[*key] as f32).collect();
    Channel { target: Target::Node(node), times, values, interpolation: Interpolation::Linear }
}

fn differs<const N: usize>(one: &[f32; N], other: &[f32; N], most: f32) -> bool {
    one.iter().zip(other).any(|(one, other)| (one - other).abs() > most)
}

/// First and last key, and those at which a value begins or ends to hold or changes its way.
fn thinned<const N: usize>(values: &[[f32; N]], most: f32) -> Vec<usize> {
    let last = values.len() - 1;
    if values.iter().all(|value| !differs(value, &values[0], most)) {
        return vec![0];
    }
    let straight = |key: usize| {
        let middle: [f32; N] = std::array::from_fn(|axis| 0.5 * (values[key - 1][axis] + values[key + 1][axis]));
        !differs(&values[key], &middle, 0.25 * most)
    };
    (0..=last).filter(|key| *key == 0 || *key == last || !straight(*key)).collect()
}

fn picked<const N: usize>(values: &[[f32; N]], keys: &[usize]) -> Vec<[f32; N]> {
    keys.iter().map(|key| values[*key]).collect()
}

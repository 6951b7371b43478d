//! The keys of a cycle: a root that goes at one speed, ends that are the same, and the cycle said over.
//!
//! The keys come with all travel in the hips. Taking a straight line out of what is interpolated by straight lines leaves every moment
//! where it was. Node-local spaces, document units.

use crate::bake::RootMotion;
use crate::model::{Channel, Clip, Interpolation, KeyValues, Target};
use crate::rig::Rig;
use crate::rig::animate::{Poser, RootCarrier, RootMove};
use glam::{DQuat, DVec3};

/// A clip whose travel is in the hips, with it where `mode` wants it. `travel`: m, scenario space, over the clip.
pub(super) fn laid(clip: &Clip, rig: &Rig, mode: RootMotion, travel: DVec3) -> Clip {
    let poser = Poser::new(rig);
    let carrier = mode.carrier(rig);
    let mut clip = clip.clone();
    let duration = clip.duration;
    for channel in clip.channels.iter_mut().filter(|channel| channel.interpolation == Interpolation::Linear) {
        let Target::Node(node) = channel.target else { continue };
        if channel.times.len() < 2 {
            continue;
        }
        let goes = poser.drives()[node].is_some_and(|drive| drive.translate)
            && !is_under(rig, node, &|above| poser.drives()[above].is_some());
        let carried = match carrier {
            RootCarrier::None => false,
            RootCarrier::New => poser.under_new_root(node),
            RootCarrier::Node(root) => is_under(rig, node, &|above| above == root),
        };
        let way = if goes { poser.parent_rest(node).matrix3.inverse() * travel } else { DVec3::ZERO };
        match &mut channel.values {
            KeyValues::Translation(keys) => {
                if carried {
                    for (key, time) in keys.iter_mut().zip(&channel.times) {
                        let place = DVec3::from(key.map(f64::from)) - way * (f64::from(*time) / duration);
                        *key = place.as_vec3().to_array();
                    }
                }
                let rest = if carried { DVec3::ZERO } else { way };
                let end = (DVec3::from(keys[0].map(f64::from)) + rest).as_vec3().to_array();
                if let Some(last) = keys.last_mut() {
                    *last = end;
                }
            }
            KeyValues::Rotation(keys) => {
                let first = keys[0];
                if let Some(last) = keys.last_mut() {
                    let same = first.iter().zip(last.iter()).map(|(a, b)| a * b).sum::<f32>() >= 0.0;
                    *last = if same { first } else { first.map(|part| 0.0 - part) };
                }
            }
            KeyValues::Scale(_) => {}
        }
    }
    carry(&mut clip, &poser, (mode, carrier), travel);
    clip
}

/// Adds the root's own channel.
fn carry(clip: &mut Clip, poser: &Poser, (mode, carrier): (RootMotion, RootCarrier), travel: DVec3) {
    if mode == RootMotion::InPlace {
        return;
    }
    let (target, ends) = match carrier {
        RootCarrier::None => return,
        RootCarrier::New => {
            let at = |translation: DVec3| poser.new_root(&RootMove { rotation: DQuat::IDENTITY, translation }).0;
            (Target::NewRoot, [at(DVec3::ZERO), at(travel)])
        }
        RootCarrier::Node(node) => {
            let rest = poser.reference()[node].translation;
            (Target::Node(node), [rest, rest + poser.parent_rest(node).matrix3.inverse() * travel])
        }
    };
    let is = |channel: &Channel| channel.target == target && matches!(channel.values, KeyValues::Translation(_));
    clip.channels.retain(|channel| !is(channel));
    let keys: Vec<[f32; 3]> = ends.iter().map(|end| end.as_vec3().to_array().map(|part| part + 0.0)).collect();
    let stays = keys[0] == keys[1];
    let channel = Channel {
        target,
        times: if stays { vec![0.0] } else { vec![0.0, clip.duration as f32] },
        values: KeyValues::Translation(if stays { vec![keys[0]] } else { keys }),
        interpolation: Interpolation::Linear,
    };
    let at = clip.channels.iter().position(|other| other.target >= target).unwrap_or(clip.channels.len());
    clip.channels.insert(at, channel);
}

fn is_under(rig: &Rig, node: usize, what: &dyn Fn(usize) -> bool) -> bool {
    let mut at = rig.nodes[node].parent;
    for _ in 0..rig.nodes.len() {
        match at {
            Some(above) if what(above) => return true,
            Some(above) => at = rig.nodes[above].parent,
            None => return false,
        }
    }
    false
}

/// The clip so many times over, each going on where the last one ended. Steps are left out.
pub(super) fn repeated(clip: &Clip, times: usize) -> Clip {
    let again = |channel: &Channel| {
        let last = channel.times.len() - 1;
        let mut list = channel.clone();
        for round in 1..times {
            let later = (round as f64 * clip.duration) as f32;
            list.times.extend(channel.times[1..].iter().map(|time| time + later));
            match (&mut list.values, &channel.values) {
                (KeyValues::Translation(list), KeyValues::Translation(keys)) => {
                    let way = [0, 1, 2].map(|axis| (keys[last][axis] - keys[0][axis]) * round as f32);
                    list.extend(keys[1..].iter().map(|key| [0, 1, 2].map(|axis| key[axis] + way[axis])));
                }
                (KeyValues::Rotation(list), KeyValues::Rotation(keys)) => {
                    let dot = list[list.len() - 1].iter().zip(&keys[0]).map(|(a, b)| a * b).sum::<f32>();
                    list.extend(keys[1..].iter().map(|key| if dot < 0.0 { key.map(|part| -part) } else { *key }));
                }
                (KeyValues::Scale(list), KeyValues::Scale(keys)) => list.extend(&keys[1..]),
                _ => {}
            }
        }
        list
    };
    let moving = clip
        .channels
        .iter()
        .filter(|channel| channel.interpolation == Interpolation::Linear && !channel.times.is_empty());
    Clip { channels: moving.map(again).collect(), duration: clip.duration * times as f64, ..clip.clone() }
}

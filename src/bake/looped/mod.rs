//! A seamless cycle of a performed motion: a stride of a steady walk, or a stretch of a stand.
//!
//! [`cycle`] finds it, [`motion`] makes its ends one, [`travel`] gives its keys a root that goes at one speed, [`told`] says what came
//! of it, measured over the cycle three times. Scenario space until the keys. It leaves out walks that turn, and ground that does not
//! go on as it began (stairs, gaps, rolling ground, platforms).

mod cycle;
mod motion;
mod told;
mod travel;

use super::keys::{Curves, KeyInput, keyed_clip};
use super::{BakeError, BakeOptions, Baked, RootMotion, base, carried, props, safe_letters};
use crate::bake::Performance;
use crate::model::props::Prop;
use crate::model::scenario::Scenario;
use crate::rig::{Rig, clips};
use cycle::Cycle;
use motion::Looped;

/// What a clip's name ends in for Godot to loop it.
const MARK: &str = "_loop";
/// Cycles that are baked at most, to find one that nothing pops in.
const MOST_TRIED: usize = 6;
/// rad and m: what moves by less is still.
const STILL: [f64; 2] = [0.1 * std::f64::consts::PI / 180.0, 1e-3];

/// Bakes a cycle of a performance.
pub(super) fn bake(
    rig: &Rig,
    scenario: &Scenario,
    options: &BakeOptions,
    performance: Performance,
    seed: u64,
) -> Result<Baked, BakeError> {
    let cycles = cycle::find(&performance, options.fps).map_err(|why| BakeError::NoCycle { why })?;
    // Strides differ by what was mended in each: what counts is what the clip shows.
    let mut best: Option<(usize, Baked)> = None;
    let mut refused = None;
    for cycle in cycles.into_iter().take(MOST_TRIED) {
        let baked = match bake_one(rig, scenario, options, &performance, (cycle, seed)) {
            Ok(baked) => baked,
            Err(error) => {
                refused = Some(error);
                continue;
            }
        };
        let pops = baked.findings.as_ref().map_or(usize::MAX, |found| found.joints.pops.len());
        if best.as_ref().is_none_or(|(least, _)| pops < *least) {
            best = Some((pops, baked));
        }
        if pops == 0 {
            break;
        }
    }
    let none = || BakeError::NoCycle { why: "the motion has no cycle".into() };
    best.map(|(_, baked)| baked).ok_or_else(|| refused.unwrap_or_else(none))
}

/// Bakes that cycle.
fn bake_one(
    rig: &Rig,
    scenario: &Scenario,
    options: &BakeOptions,
    performance: &Performance,
    (cycle, seed): (Cycle, u64),
) -> Result<Baked, BakeError> {
    let looped = Looped::new(performance, cycle)?;
    let name = name(options.name.as_deref(), &scenario.title, &clips::clip_names(rig));
    let input = KeyInput {
        rig,
        name: &name,
        fps: options.fps,
        duration: looped.cycle.period,
        pose: &|time| looped.pose_at(time),
        contacts: &looped.contacts,
        root_motion: RootMotion::Hips,
        curves: Curves::Linear,
    };
    let whole = keyed_clip(&input);
    let laid = |mode: RootMotion| {
        let mut clip = travel::laid(&whole, rig, mode, looped.travel);
        if let Some(over) = &performance.timeline.over {
            base::add(&mut clip, rig, over.base());
        }
        clip
    };
    let clip = laid(options.root);
    // Feet of a clip without its travel slide by design: what can be measured is the same motion with it.
    let travelling = (options.root == RootMotion::InPlace).then(|| laid(RootMotion::Root));
    let input = told::Told { rig, scenario, seed, root: options.root, performance, looped: &looped };
    let (report, findings, mut warnings) = told::tell(&input, &clip, travelling.as_ref().unwrap_or(&clip));
    if still(&looped) {
        warnings.push("nothing moves in the loop: a stand that is left alone is still".into());
    }
    let props = beside(performance, &looped, options.root);
    Ok(Baked { clip, report, performance: performance.clone(), findings, props, warnings, choice: None })
}

/// A name that no clip of the rig has and that Godot loops by.
fn name(wanted: Option<&str>, title: &str, taken: &[String]) -> String {
    let name = wanted.map_or_else(|| safe_letters(title), str::to_owned);
    let plain = {
        let lower = name.to_lowercase();
        let cut = ["_loop", "-loop", " loop", "loop"]
            .iter()
            .find(|mark| lower.ends_with(**mark))
            .map_or(0, |mark| mark.len());
        // Lower case may have another length: then the name is left as it is.
        if lower.len() == name.len() { &name[..name.len() - cut] } else { name.as_str() }
    };
    let plain = if plain.is_empty() { "Cycle" } else { plain };
    let numbered = (2..).map(|number| format!("{plain}_{number}{MARK}"));
    std::iter::once(format!("{plain}{MARK}"))
        .chain(numbered)
        .find(|name| !taken.contains(name))
        .expect("numbers do not run out")
}

/// Whether nothing moves in it.
fn still(looped: &Looped) -> bool {
    let first = looped.pose_at(0.0);
    (1..16).all(|part| {
        let pose = looped.pose_at(looped.cycle.period * f64::from(part) / 16.0);
        let turned = pose.turns.iter().zip(&first.turns).map(|(a, b)| a.angle_between(*b)).fold(0.0, f64::max);
        turned < STILL[0] && pose.hips.distance(first.hips) < STILL[1]
    })
}

/// The ground, and the boxes in the hands.
fn beside(performance: &Performance, looped: &Looped, root: RootMotion) -> Vec<Prop> {
    let timeline = &performance.timeline;
    let mut list = props::ground(timeline);
    for key in list.iter_mut().flat_map(|prop| &mut prop.keys) {
        key.translation = looped.place.point(key.translation);
        key.rotation = looped.place.turn * key.rotation;
    }
    let (loads, period) = (looped.loads(1), looped.cycle.period);
    list.extend(carried::boxes(&timeline.body, &loads, period, &|time| {
        let mut pose = looped.pose_at(time);
        if root == RootMotion::InPlace {
            pose.hips -= looped.travel * (time / period);
        }
        pose
    }));
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_is_named_so_that_godot_loops_it_and_nothing_is_renamed() {
        let taken = ["Walk_loop".to_owned(), "Walk_2_loop".to_owned()];
        assert_eq!(name(None, "walk, slowly", &taken), "walk_slowly_loop");
        assert_eq!(name(Some("Walk"), "", &taken), "Walk_3_loop");
        assert_eq!(name(Some("Run_Loop"), "", &taken), "Run_loop");
        assert_eq!(name(None, "Loop", &taken), "Cycle_loop");
        assert_eq!(name(None, "", &[]), "Cycle_loop");
    }
}

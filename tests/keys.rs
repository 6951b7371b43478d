//! How few keys a baked clip needs, what they take in a file, and what is left of them in a reader that drops tangents.
//!
//! Shoves of `limits_grid`. Frames x channels are of all channels that a clip writes; beside them stand those that move.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::common::builtin;
use crate::limits_grid::{Measured, grid, grid_by, rigs, shove};
use crate::synthetic::held;
use surefoot::bake::{BakeOptions, Baked, Curves, bake};
use surefoot::model::report::Outcome;
use surefoot::model::{Channel, Clip, Interpolation, KeyValues, Target};
use surefoot::rig::Rig;

/// Rigs with fingers and toes.
const WHOLE: [&str; 3] = ["builtin", "m2m_human_male", "gdquest_mannequiny"];

fn mean(clips: &[Measured], value: fn(&Measured) -> f64) -> f64 {
    clips.iter().map(value).sum::<f64>() / clips.len() as f64
}

fn spline() -> BakeOptions {
    BakeOptions { curves: Curves::Spline, ..BakeOptions::default() }
}

#[test]
fn a_fifth_of_the_frames_are_keys_where_splines_join_them() {
    for (name, rig) in rigs().into_iter().filter(|(name, _)| WHOLE.contains(&name.as_str())) {
        let mut clips = grid_by(&rig, &[0.0, 90.0, 180.0, 315.0], &[20.0, 60.0, 100.0], &spline());
        clips.retain(|clip| clip.outcome != Outcome::Fall);
        let (share, moving) = (mean(&clips, |clip| clip.keys.share), mean(&clips, |clip| clip.keys.moving));
        let most = clips.iter().map(|clip| clip.keys.moving).fold(0.0, f64::max);
        let [all, move_] = clips[0].keys.channels;
        println!(
            "{name}: {all} channels, {move_} move; {:.1} % keys, {:.1} % of what moves, {:.1} at most",
            100.0 * share,
            100.0 * moving,
            100.0 * most
        );
        // The fifth is of the clips together; the wildest of the built-in rig, which has few channels that rest, is over it.
        assert!(share < 0.18 && moving < 0.19 && most < 0.27, "{name}: {share} {moving} {most}");
    }
}

#[test]
fn a_second_of_a_shove_takes_under_twelve_kilobytes_of_keys() {
    for (name, rig) in rigs().into_iter().filter(|(name, _)| WHOLE.contains(&name.as_str())) {
        let mut clips = grid(&rig, &[0.0, 90.0, 180.0, 315.0], &[20.0, 60.0, 100.0]);
        clips.retain(|clip| clip.outcome != Outcome::Fall);
        let rate = mean(&clips, |clip| clip.keys.rate / 1e3);
        let most_rate = clips.iter().map(|clip| clip.keys.rate / 1e3).fold(0.0, f64::max);
        let added = mean(&clips, |clip| clip.keys.added as f64);
        let most_added = clips.iter().map(|clip| clip.keys.added).max().unwrap_or(0);
        println!(
            "{name}: {rate:.1} kB/s, {most_rate:.1} at most; {:.1} kB a clip, {:.1} at most",
            added / 1e3,
            most_added as f64 / 1e3
        );
        assert!(rate < 12.0, "{name}: {rate} kB/s");
        assert!(added < 48e3 && most_added < 60_000, "{name}: {added} {most_added}");
    }
}

/// Slip of planted points, m, at eight times the frame rate.
fn slip(rig: &Rig, baked: &Baked, clip: &Clip) -> f64 {
    let mut sampler = rig.sampler(clip);
    let mut worst: f64 = 0.0;
    for contact in &baked.performance.contacts {
        let start = held(rig, &sampler.sample(contact.start), contact);
        for tick in 0..=((contact.end - contact.start) * 240.0).ceil() as usize {
            let time = (contact.start + tick as f64 / 240.0).min(contact.end);
            let now = held(rig, &sampler.sample(time), contact);
            worst = start.iter().zip(&now).map(|(a, b)| a.distance(*b)).fold(worst, f64::max);
        }
    }
    worst
}

/// As Blender's importer takes a clip: the values alone, joined by curves of continuous acceleration that are level at both ends.
fn without_tangents(clip: &Clip) -> Clip {
    let mut clip = clip.clone();
    for channel in clip.channels.iter_mut().filter(|channel| channel.interpolation == Interpolation::Cubic) {
        match &mut channel.values {
            KeyValues::Translation(numbers) | KeyValues::Scale(numbers) => evened(&channel.times, numbers),
            KeyValues::Rotation(numbers) => evened(&channel.times, numbers),
        }
    }
    clip
}

/// Overwrites tangents by those of the smooth curve: relaxed until they stay.
fn evened<const N: usize>(times: &[f32], numbers: &mut [[f32; N]]) {
    let last = times.len() - 1;
    let values: Vec<[f64; N]> = numbers.chunks_exact(3).map(|key| key[1].map(f64::from)).collect();
    let seconds = |at: usize| f64::from(times[at + 1]) - f64::from(times[at]);
    let mut slopes = vec![[0.0; N]; times.len()];
    for _ in 0..200 {
        for at in 1..last {
            let [before, after] = [seconds(at - 1), seconds(at)];
            slopes[at] = std::array::from_fn(|part| {
                let [from, here, to] = [values[at - 1][part], values[at][part], values[at + 1][part]];
                let secants = (here - from) / before.powi(2) + (to - here) / after.powi(2);
                let around = slopes[at - 1][part] / before + slopes[at + 1][part] / after;
                (3.0 * secants - around) / (2.0 / before + 2.0 / after)
            });
        }
    }
    for (key, slope) in numbers.chunks_exact_mut(3).zip(slopes) {
        (key[0], key[2]) = (slope.map(|part| part as f32), slope.map(|part| part as f32));
    }
}

#[test]
fn a_reader_that_drops_tangents_and_smooths_keeps_the_feet_too() {
    for (name, rig) in rigs().into_iter().filter(|(name, _)| WHOLE.contains(&name.as_str())) {
        for (direction, impulse) in [(0.0, 80.0), (90.0, 60.0)] {
            let baked = bake(&rig, &shove(&rig.body, direction, impulse), &spline()).expect("it bakes");
            let drawn = without_tangents(&baked.clip);
            let (exact, smoothed) = (slip(&rig, &baked, &baked.clip), slip(&rig, &baked, &drawn));
            let (mut ours, mut theirs) = (rig.sampler(&baked.clip), rig.sampler(&drawn));
            let off = (0..480)
                .map(|tick| f64::from(tick) / 120.0)
                .flat_map(|time| {
                    let (ours, theirs) = (ours.sample(time).positions, theirs.sample(time).positions);
                    ours.iter().zip(&theirs).map(|(a, b)| a.distance(*b)).collect::<Vec<f64>>()
                })
                .fold(0.0, f64::max);
            println!(
                "{name} {impulse} Ns towards {direction}: slip {:.2} mm, without tangents {:.2} mm; joints {:.1} mm off at most",
                1e3 * exact,
                1e3 * smoothed,
                1e3 * off
            );
            assert!(exact < 0.5e-3 && smoothed < 0.5e-3 && off < 0.1e-3, "{name}: {exact} {smoothed} {off} m");
        }
    }
}

#[test]
fn feet_slip_where_the_hips_lose_three_of_four_keys() {
    // The planted extreme: what the tests above measure can fail.
    let rig = builtin();
    let baked = bake(&rig, &shove(&rig.body, 90.0, 60.0), &spline()).expect("it bakes");
    let hips = Target::Node(rig.hips_node());
    let mut thinned = baked.clip.clone();
    let thin = |channel: &mut Channel| {
        let keep = |key: &usize| key.is_multiple_of(4);
        let KeyValues::Translation(numbers) = &channel.values else { return };
        let kept: Vec<usize> = (0..channel.times.len()).filter(keep).collect();
        let numbers = kept.iter().flat_map(|key| numbers[3 * key..3 * key + 3].to_vec()).collect();
        channel.times = kept.iter().map(|key| channel.times[*key]).collect();
        channel.values = KeyValues::Translation(numbers);
    };
    thinned.channels.iter_mut().filter(|channel| channel.target == hips).for_each(thin);
    assert!(slip(&rig, &baked, &thinned) > 1e-3, "{}", slip(&rig, &baked, &thinned));
}

#[test]
fn what_no_mass_and_no_foot_hangs_from_is_joined_by_straight_lines_and_what_carries_is_not() {
    let rig = builtin();
    let baked = bake(&rig, &shove(&rig.body, 90.0, 60.0), &spline()).expect("it bakes");
    let of = |node: usize| {
        let turns = |channel: &&Channel| {
            channel.target == Target::Node(node) && matches!(channel.values, KeyValues::Rotation(_))
        };
        baked.clip.channels.iter().find(turns).expect("it turns")
    };
    assert_eq!(of(rig.hips_node()).interpolation, Interpolation::Cubic);
    let foot = rig.joint_nodes[rig.body.feet[0].ankle].expect("it has a foot");
    assert_eq!(of(foot).interpolation, Interpolation::Cubic);
    let thumb = rig.body.joint(surefoot::model::Role::LeftThumbDistal).and_then(|joint| rig.joint_nodes[joint]);
    assert_eq!(of(thumb.expect("it has thumbs")).interpolation, Interpolation::Linear);
}

//! The audit on whole clips: our own bakes of the built-in rig, with and without planted faults, and captured ones.
//!
//! Bakes go the way of a file: written as a GLB, read again as any clip is. What is held on third parties' captures is the held-out third
//! of them (see `audit_grid`), at slightly under what is reached.

use crate::audit_faults::{self as faults, Way};
use crate::audit_forces::{measured, median_size};
use crate::audit_grid::{Kind, ask, clean, clips, faults as rows, slow_clips, walks};
use crate::common::builtin;
use crate::data;
use crate::rig_variants::nothing;
use std::sync::OnceLock;
use surefoot::audit::{AuditOptions, audit};
use surefoot::bake::{BakeOptions, Baked, RootMotion, bake};
use surefoot::maths::seed::Seed;
use surefoot::mocap::{Options, read};
use surefoot::model::findings::{Findings, Flag, Rule};
use surefoot::model::{Capture, Side, scenario_text};

const WALK: &str =
    "title = \"walk\"\nduration = 7.0\n[[walk]]\nstart = 0.5\nspeed = 1.1\n[[walk]]\nstart = 5.5\nspeed = 0.0\n";

/// Baked, written, read again.
fn baked(text: &str, options: &BakeOptions) -> (Baked, Capture) {
    let rig = builtin();
    let scenario = scenario_text::parse("made", text).expect("a scenario");
    let baked = bake(&rig, &scenario, options).expect("it bakes");
    let file = surefoot::export::glb(&rig, &[(baked.clip.clone(), baked.report.clone())]).expect("it is written");
    let clips = read("baked.glb", &file.bytes, &nothing, None).expect("it is read again");
    let index = clips.find(&baked.clip.name).expect("the clip is in it");
    let capture = clips.capture(index, &Options::default()).expect("a capture");
    (baked, capture)
}

/// The walk, at 60 frames a second.
fn walk() -> &'static (Baked, Capture) {
    static WALKED: OnceLock<(Baked, Capture)> = OnceLock::new();
    WALKED.get_or_init(|| baked(WALK, &BakeOptions { fps: 60.0, ..BakeOptions::default() }))
}

fn said(capture: &Capture) -> Findings {
    audit(capture, &AuditOptions::default())
}

fn told(found: &Findings) -> Vec<String> {
    let flags =
        found.flags.iter().map(|flag| format!("{}..{} {}: {}", flag.start, flag.end, flag.rule.name(), flag.why));
    flags.chain(found.clip_flags.iter().map(|flag| flag.why.clone())).collect()
}

fn shove(newtons: f64, toward: &str) -> String {
    format!(
        "title = \"shove\"\nduration = 5.0\nseed = 3\n[[push]]\nstart = 0.6\nduration = 0.2\nforce = {newtons}\ntoward = \"{toward}\"\n"
    )
}

#[test]
fn a_baked_walk_is_clean() {
    let found = said(&walk().1);
    assert!(told(&found).is_empty(), "{:?}", told(&found));
    assert!(found.abstained.is_empty(), "{:?}", found.abstained);
    assert!(found.steps.len() >= 7, "{}", found.steps.len());
}

#[test]
fn a_baked_walks_steps_are_found_when_the_bake_says_they_come() {
    let (baked, capture) = walk();
    let found = said(capture);
    let downs: Vec<(&str, f64)> = Side::BOTH
        .into_iter()
        .flat_map(|side| {
            // Parts of one stance follow each other at once; a stance begins where none was before.
            let own: Vec<_> = baked.report.contacts.iter().filter(|contact| contact.foot == side).collect();
            let begins = |start: f64| !own.iter().any(|other| other.start < start && other.end > start - 0.05);
            let name = if side == Side::Left { "left" } else { "right" };
            let starts: Vec<f64> =
                own.iter().map(|contact| contact.start).filter(|start| *start > 0.1 && begins(*start)).collect();
            starts.into_iter().map(move |start| (name, start))
        })
        .collect();
    assert!(downs.len() >= 7, "{downs:?}");
    let mut errors: Vec<f64> = Vec::new();
    for (foot, time) in &downs {
        let own = found.contacts.iter().filter(|contact| contact.foot == *foot && contact.start > 0);
        let near =
            own.map(|contact| contact.start as f64 / capture.fps - time).min_by(|a, b| a.abs().total_cmp(&b.abs()));
        errors.push(near.expect("the foot comes down somewhere"));
    }
    assert!(errors.iter().all(|error| error.abs() < 0.05), "{downs:?} {errors:?}");
    assert!(median_size(&errors) <= 0.034, "{errors:?}");
}

#[test]
fn a_plant_of_a_baked_walk_that_is_moved_is_told_with_foot_and_way() {
    let clean = &walk().1;
    for (way, word) in [(Way::Forward, "ahead"), (Way::Backward, "behind"), (Way::Inward, "in"), (Way::Outward, "out")]
    {
        let mut right = 0;
        for seed in 0..4 {
            let planted = faults::moved_plant(clean, way, 0.25, &mut Seed::new(seed)).expect("a step to move");
            let found = said(&planted.capture);
            let flag = found.flags.iter().find(|flag| {
                flag.rule == Rule::FootPlacement && flag.start <= planted.span.1 && flag.end >= planted.span.0
            });
            let Some(flag) = flag else { continue };
            let mut landed = found.contacts.iter().filter(|contact| contact.start.abs_diff(flag.start) <= 3);
            assert!(landed.any(|contact| Some(contact.foot) == flag.foot), "{flag:?}");
            right += usize::from(flag.why.contains(&format!("too far {word}")));
        }
        assert!(right >= 3, "{word}: {right} of 4");
    }
}

#[test]
fn other_faults_of_a_baked_walk_are_told_by_their_rules() {
    let clean = &walk().1;
    for fault in rows().into_iter().filter(|row| row.rule != Rule::FootPlacement) {
        let mut found = 0;
        for seed in 0..4 {
            let planted = (fault.plant)(clean, &mut Seed::new(seed)).expect("room for it");
            let flags = said(&planted.capture).flags;
            found += usize::from(
                flags
                    .iter()
                    .any(|flag| flag.rule == fault.rule && flag.start <= planted.span.1 && flag.end >= planted.span.0),
            );
        }
        assert!(found >= 3, "{}: {found} of 4", fault.name);
    }
}

#[test]
fn a_baked_walk_at_six_tenths_of_its_speed_is_told() {
    let found = said(&faults::slow_clip(&walk().1, 0.6).capture);
    assert!(
        found.clip_flags.iter().any(|flag| flag.rule == Rule::Timing && flag.why.contains("slower")),
        "{:?}",
        told(&found)
    );
}

#[test]
fn a_baked_walk_in_place_is_not_judged() {
    let (_, capture) = baked(WALK, &BakeOptions { root: RootMotion::InPlace, ..BakeOptions::default() });
    let found = said(&capture);
    assert!(told(&found).is_empty(), "{:?}", told(&found));
    assert_eq!((found.abstained.len(), found.abstained[0].start, found.abstained[0].end), (1, 0, found.frames - 1));
}

#[test]
fn a_stand_and_a_shove_that_is_swayed_out_are_clean() {
    for text in ["title = \"stand\"\nduration = 4.0\n".to_owned(), shove(60.0, "right")] {
        let (baked, capture) = baked(&text, &BakeOptions::default());
        let found = said(&capture);
        assert_eq!(baked.report.steps, 0);
        assert!(told(&found).is_empty() && found.abstained.is_empty(), "{:?}", told(&found));
    }
}

#[test]
fn shoves_that_the_clip_tells_of_are_clean_and_without_that_word_they_are_told_while_they_last() {
    let mut pushed = 0;
    for (newtons, toward) in [(200.0, "front"), (200.0, "left"), (300.0, "right"), (350.0, "back"), (400.0, "front")] {
        let (baked, mut capture) = baked(&shove(newtons, toward), &BakeOptions::default());
        assert!(baked.report.steps >= 2, "{newtons} N {toward}");
        let found = said(&capture);
        assert!(found.flags.is_empty() && found.clip_flags.is_empty(), "{newtons} N {toward}: {:?}", told(&found));
        assert!(!std::mem::take(&mut capture.pushes).is_empty(), "the clip tells its disturbances");
        let found = said(&capture);
        let of_the_hand = |flag: &Flag| flag.rule == Rule::Balance && flag.start >= 16 && flag.end <= 32; // 0.6 s to 0.8 s at 30 Hz
        assert!(found.flags.iter().all(of_the_hand), "{newtons} N {toward}: {:?}", told(&found));
        assert!(found.clip_flags.is_empty(), "{:?}", told(&found));
        pushed += found.flags.len();
    }
    assert!((1..=5).contains(&pushed), "a push of 400 N is out of any support: {pushed}");
}

#[test]
fn units_of_a_file_change_nothing_but_the_places_words() {
    let Some(data) = data::folder() else { return };
    let text = std::fs::read_to_string(data.join("audit/walk_active_005.bvh")).expect("a clip");
    let read = |text: &str| {
        let file = read("clip.bvh", text.as_bytes(), &nothing, None).expect("a BVH");
        file.capture(0, &Options::default()).expect("a capture")
    };
    let (centimetres, metres) = (read(&text), read(&scaled(&text, 0.01)));
    assert!((metres.units_to_metres / centimetres.units_to_metres - 100.0).abs() < 1e-6);
    let plant =
        |capture: &Capture| faults::moved_plant(capture, Way::Outward, 0.25, &mut Seed::new(1)).expect("a step");
    let (one, two) = (said(&plant(&centimetres).capture), said(&plant(&metres).capture));
    assert!(!one.flags.is_empty());
    let lines = |found: &Findings| -> Vec<_> {
        found.flags.iter().map(|flag| (flag.start, flag.end, flag.rule, flag.foot)).collect()
    };
    assert_eq!(lines(&one), lines(&two));
}

/// A BVH whose lengths are in another unit: offsets, and the channels that are positions (six channels on every joint).
fn scaled(text: &str, factor: f64) -> String {
    let mut positions: Vec<bool> = Vec::new();
    let mut lines: Vec<String> = Vec::new();
    let mut motion = false;
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let times = |word: &str| format!("{:.9}", word.parse::<f64>().expect("a number") * factor);
        match words.first() {
            Some(&"OFFSET") => {
                lines.push(format!("OFFSET {} {} {}", times(words[1]), times(words[2]), times(words[3])))
            }
            Some(&"CHANNELS") => {
                positions.extend(words[2..].iter().map(|word| word.ends_with("position")));
                lines.push(line.to_owned());
            }
            Some(&"Frame") => {
                motion = true;
                lines.push(line.to_owned());
            }
            Some(_) if motion => {
                let row = words.iter().zip(&positions);
                let row: Vec<String> =
                    row.map(|(word, place)| if *place { times(word) } else { (*word).to_owned() }).collect();
                lines.push(row.join(" "));
            }
            _ => lines.push(line.to_owned()),
        }
    }
    lines.join("\n")
}

#[test]
fn held_out_captures_keep_what_is_reached() {
    let Some(data) = data::folder() else { return };
    let (_, held) = clips(&data);
    let of = |kind: Kind| clean(&held, kind, true);
    let walking = [of(Kind::Walk), of(Kind::Turn)];
    let events: usize = walking.iter().map(|clean| clean.events).sum();
    let minutes: f64 = walking.iter().map(|clean| clean.minutes).sum();
    assert!(events as f64 / minutes <= 1.0, "{events} in {minutes} minutes: {:?}", walking);
    assert!(walking.iter().all(|clean| clean.share() <= 0.02 && clean.abstained() <= 0.2 && clean.clip_flags == 0));
    assert!(of(Kind::Run).a_minute() <= 2.0, "{:?}", of(Kind::Run));
    let walks = walks(&held);
    for row in rows() {
        let found = ask(&walks, &row);
        assert!(found.planted >= 40, "{}: {}", row.name, found.planted);
        if let Some(wanted) = row.wanted {
            assert!(
                found.recall() >= wanted,
                "{}: {} of {wanted}, missed {:?}",
                row.name,
                found.recall(),
                found.missed
            );
        }
        if let Some(wanted) = row.wanted_f1 {
            assert!(found.f1() >= wanted, "{}: {} of {wanted}", row.name, found.f1());
        }
    }
    assert!(slow_clips(&walks).recall() >= 0.9);
}

#[test]
fn tuned_clips_keep_what_is_reached() {
    let Some(data) = data::folder() else { return };
    let (tuned, _) = clips(&data);
    // Keyed clips: what cannot be judged is one word of the whole clip, and little of that.
    let keyed = clean(&tuned, Kind::Other, false);
    assert!(keyed.clips > 80 && keyed.a_minute() <= 1.0 && keyed.clip_flags <= 4, "{keyed:?}");
    for captured in Kind::ALL.map(|kind| clean(&tuned, kind, true)) {
        assert_eq!(captured.clip_flags, 0, "{captured:?}");
    }
    let walks = walks(&tuned);
    for row in rows().iter().filter(|row| matches!(row.rule, Rule::Float | Rule::Penetration | Rule::Balance)) {
        let found = ask(&walks, row);
        assert!(found.recall() >= 0.95, "{}: {}, missed {:?}", row.name, found.recall(), found.missed);
    }
    let slow = slow_clips(&walks);
    assert!(slow.recall() >= 0.9, "{} missed {:?}", slow.recall(), slow.missed);
}

#[test]
fn a_walk_over_force_plates_touches_down_and_accelerates_as_the_plates_say() {
    let Some(data) = data::folder() else { return };
    let found = measured(&data).expect("the measured walk");
    assert_eq!((found.touch_downs.len(), found.lift_offs.len()), (2, 2));
    assert!(median_size(&found.touch_downs) <= 0.02, "{found:?}");
    assert!(found.force <= 0.05, "{found:?}");
    // Goals: 0.02 s and 0.04 m.
    assert!(median_size(&found.lift_offs) <= 0.045, "{found:?}");
    assert!(found.zmp <= 0.056, "{found:?}");
}

//! A clip's motion to findings: which frames no balanced person could have produced.
//!
//! The way of a clip: capture -> [`track`] (centre of mass, feet) -> [`contacts`] (floor, contacts, steps) -> [`domain`] (where the
//! pendulum applies) -> the rules, each a file of its own, that leave marks -> [`Findings`]. Clip space, SI; limits are for a leg of 0.83 m
//! and scale with the body.

pub mod balance;
pub mod contacts;
pub mod domain;
#[cfg(test)]
pub(crate) mod fixture;
pub mod flight;
pub mod keyed;
pub mod placement;
pub mod sole;
pub mod stages;
pub mod timing;
pub mod track;
mod verdict;

pub use domain::Domain;
pub use verdict::{foot_name, part};

use crate::model::findings::{Findings, Flag, Rule};
use crate::model::{Capture, Side};
use stages::{Stages, with_stages};

/// What a person may set.
#[derive(Clone, Debug, Default)]
pub struct AuditOptions {
    /// m over the file's zero: where the floor is, if the feet shall not tell.
    pub floor: Option<f64>,
    /// Rules that are not asked.
    pub without: Vec<Rule>,
}

/// Judges a clip.
pub fn audit(capture: &Capture, options: &AuditOptions) -> Findings {
    let mut findings = verdict::empty(capture);
    with_stages(capture, options.floor, |stages| judge(stages, options, &mut findings));
    findings
}

fn judge(stages: &Stages, options: &AuditOptions, findings: &mut Findings) {
    let Stages { track, feet, domain, balance, judged, keyed } = stages;
    let mut marks = placement::marks(feet, judged);
    marks.extend(sole::marks(track, feet).into_iter().filter(|mark| match mark.rule {
        Rule::Float => domain.walks_in(mark.start, mark.end),
        // In the strides about a flight both feet are fast, and a frame's error of a contact is a hand's breadth.
        Rule::Drift => domain.mostly_walks_in(mark.start, mark.end),
        _ => domain.stands_in(mark.start, mark.end),
    }));
    marks.extend(balance::marks(track, balance, domain));
    marks.extend(balance::unanswered(track, feet, domain));
    marks.extend(flight::marks(track, feet).into_iter().filter(|mark| domain.stands_in(mark.start, mark.end)));
    marks.retain(|mark| !options.without.contains(&mark.rule));
    marks.sort_by_key(|mark| (mark.start, mark.end, mark.rule));
    findings.flags = marks.iter().map(Mark::flag).collect();
    let whole = keyed.and_then(|keyed| keyed.mark(track));
    findings.clip_flags.extend(whole.filter(|_| !options.without.contains(&Rule::Balance)));
    let clock = timing::clock(track, feet, domain, judged.len());
    findings.clip_flags.extend(clock.and_then(timing::mark).filter(|_| !options.without.contains(&Rule::Timing)));
    findings.steps = judged.iter().map(|judged| verdict::step(feet, judged)).collect();
    findings.contacts = verdict::contacts(track, feet);
    findings.abstained = domain.abstained();
    findings.confidence *= verdict::trust(feet, domain);
}

/// A flag in the making.
#[derive(Clone, Debug)]
pub struct Mark {
    /// First frame.
    pub start: usize,
    /// Last frame.
    pub end: usize,
    /// Which rule.
    pub rule: Rule,
    /// Of one foot.
    pub side: Option<Side>,
    /// As in [`Flag`].
    pub measured: f64,
    /// As in [`Flag`].
    pub predicted: f64,
    /// m, by how much.
    pub delta: f64,
    /// m, from where on it is told.
    pub limit: f64,
    /// A sentence.
    pub why: String,
}

impl Mark {
    fn flag(&self) -> Flag {
        Flag {
            start: self.start,
            end: self.end,
            rule: self.rule,
            foot: self.side.map(foot_name),
            // Half at the limit, nearing 1 the farther it is.
            severity: (1.0 - 0.5 * self.limit / self.delta.max(self.limit)).clamp(0.0, 1.0),
            measured: self.measured,
            predicted: self.predicted,
            delta_m: self.delta,
            why: self.why.clone(),
        }
    }
}

/// Spans of frames, first and last, in which something holds.
pub fn spans(frames: usize, holds: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut spans: Vec<(usize, usize)> = Vec::new();
    for frame in (0..frames).filter(|frame| holds(*frame)) {
        match spans.last_mut() {
            Some(last) if last.1 + 1 == frame => last.1 = frame,
            _ => spans.push((frame, frame)),
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::fixture::{Gait, jump, mirrored, move_plant, resized, seat, stand, walk};
    use super::*;
    use crate::measure::fixture as made;
    use glam::{DQuat, DVec3};
    use proptest::prelude::*;

    fn said(capture: &Capture) -> Findings {
        audit(capture, &AuditOptions::default())
    }

    fn json(findings: &Findings) -> String {
        serde_json::to_string(findings).expect("findings are JSON")
    }

    /// A walk whose seventh step is 20 cm too far out.
    fn spoiled() -> (Capture, Side) {
        let gait = Gait::default();
        let mut capture = walk(gait);
        let side = gait.foothold(7).0;
        move_plant(&mut capture, side, (180, 210), 20, DVec3::X * 0.2 * side.sign());
        (capture, side)
    }

    #[test]
    fn nothing_is_told_of_what_a_pendulum_does() {
        for capture in [
            walk(Gait::default()),
            walk(Gait { fps: 30.0, floor: 0.8, slope: glam::DVec2::new(0.0, 0.015), ..Gait::default() }),
            walk(Gait { rise: 0.15, ..Gait::default() }),
            stand(4.0),
            jump(0.45, 1.0),
            seat(3.0),
        ] {
            let found = said(&capture);
            assert!(found.flags.is_empty() && found.clip_flags.is_empty(), "{:?} {:?}", found.flags, found.clip_flags);
        }
    }

    #[test]
    fn a_mirrored_clip_has_mirrored_flags() {
        let (capture, _) = spoiled();
        let (right, left) = (said(&capture), said(&mirrored(&capture)));
        assert!(!right.flags.is_empty());
        let told = |found: &Findings, swapped: bool| -> Vec<(usize, usize, Rule, Option<&'static str>, i64)> {
            let other = |foot: &'static str| if (foot == "left") == swapped { "right" } else { "left" };
            let line = |flag: &Flag| {
                (flag.start, flag.end, flag.rule, flag.foot.map(other), (flag.delta_m * 1e4).round() as i64)
            };
            found.flags.iter().map(line).collect()
        };
        assert_eq!(told(&right, false), told(&left, true));
    }

    #[test]
    fn a_body_of_half_or_twice_the_size_has_the_same_flags() {
        let (capture, side) = spoiled();
        let found = said(&capture);
        assert!(found.flags.iter().any(|flag| flag.rule == Rule::FootPlacement && flag.foot == Some(foot_name(side))));
        for scale in [0.5, 2.0] {
            let other = said(&resized(&capture, scale));
            let told = |found: &Findings| -> Vec<(Rule, Option<&'static str>)> {
                found.flags.iter().map(|flag| (flag.rule, flag.foot)).collect()
            };
            assert_eq!(told(&found), told(&other), "{scale}");
            for (one, two) in found.flags.iter().zip(&other.flags) {
                assert!(
                    one.start.abs_diff(two.start) <= 3 && one.end.abs_diff(two.end) <= 3,
                    "{scale}: {one:?} {two:?}"
                );
                assert!((two.delta_m / scale - one.delta_m).abs() < 0.03, "{scale}: {one:?} {two:?}");
            }
        }
    }

    #[test]
    fn a_pose_before_the_motion_is_left_out() {
        let mut capture = walk(Gait::default());
        let joints = capture.body.joints.len();
        for joint in 0..joints {
            capture.positions[joint] = capture.body.joints[joint].rest + DVec3::new(0.6, 0.3, -0.4);
        }
        let found = said(&capture);
        assert!(found.flags.is_empty(), "{:?}", found.flags);
        assert_eq!((found.abstained[0].start, found.abstained[0].end), (0, 0));
        assert!(found.abstained[0].why.contains("pose"));
    }

    #[test]
    fn the_same_capture_gives_the_same_bytes_and_a_rule_left_out_says_nothing() {
        let (capture, _) = spoiled();
        assert_eq!(json(&said(&capture)), json(&said(&capture.clone())));
        let without = AuditOptions { without: vec![Rule::FootPlacement], ..AuditOptions::default() };
        assert!(audit(&capture, &without).flags.iter().all(|flag| flag.rule != Rule::FootPlacement));
    }

    #[test]
    fn severities_are_shares_and_spans_lie_in_the_clip() {
        let (capture, _) = spoiled();
        for flag in said(&capture).flags {
            assert!((0.5..=1.0).contains(&flag.severity) && flag.start <= flag.end && flag.end < capture.frames());
        }
    }

    #[test]
    fn a_clip_of_no_frames_says_nothing() {
        let mut capture = stand(1.0);
        capture.positions.clear();
        capture.turns.clear();
        assert_eq!(said(&capture).frames, 0);
    }

    /// A capture of so many frames whose joints are anywhere; with all of them in one place, or legs of no length, if told.
    fn wild(frames: usize, seed: u64, reach: f64, fps: f64, kind: u8) -> Capture {
        let mut body = made::body();
        let mut seed = crate::maths::seed::Seed::new(seed);
        if kind == 1 {
            body.joints.iter_mut().for_each(|joint| joint.rest = DVec3::ZERO);
            body.leg_length = 0.0;
            body.height = 0.0;
        }
        let mut capture = stand(0.02);
        (capture.fps, capture.body) = (fps, body.clone());
        let joints = body.joints.len();
        let mut any = |reach: f64| {
            DVec3::new(seed.between(-reach, reach), seed.between(-reach, reach), seed.between(-reach, reach))
        };
        capture.positions = match kind {
            2 => vec![DVec3::new(3.0, 2.0, 1.0); frames * joints],
            _ => (0..frames * joints).map(|_| any(reach)).collect(),
        };
        capture.turns = (0..frames * joints).map(|_| DQuat::from_scaled_axis(any(4.0))).collect();
        capture
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]
        #[test]
        fn no_motion_breaks_it(
            frames in 1_usize..90,
            seed in any::<u64>(),
            reach in prop_oneof![Just(1e-9), Just(0.1), Just(3.0), Just(1e6), Just(1e150)],
            fps in prop_oneof![Just(0.5), Just(24.0), Just(30.0), Just(120.005), Just(1000.0)],
            kind in 0_u8..3,
        ) {
            let found = said(&wild(frames, seed, reach, fps, kind));
            prop_assert_eq!(found.frames, frames);
            for flag in &found.flags {
                prop_assert!(flag.start <= flag.end && flag.end < frames);
                prop_assert!((0.0..=1.0).contains(&flag.severity), "{:?}", flag);
            }
            for span in &found.abstained {
                prop_assert!(span.start <= span.end && span.end < frames);
            }
        }
    }
}

//! What a person leaves as it is: flags that no repair answers and by which none is judged. Frames count from 0.
//!
//! A flag is meant by its rule, its foot and its frames, so that it is found again when other repairs moved its ends a little.

use super::CorrectOptions;
use crate::model::findings::{Findings, Flag, Rule};
use std::borrow::Cow;

/// Flags of a rule that a span of frames meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Which rule.
    pub rule: Rule,
    /// "left" or "right"; `None` is of both feet or of neither, and meets any.
    pub foot: Option<&'static str>,
    /// First frame.
    pub start: usize,
    /// Last.
    pub end: usize,
}

impl Target {
    /// Of one flag.
    pub fn of(flag: &Flag) -> Target {
        Target { rule: flag.rule, foot: flag.foot, start: flag.start, end: flag.end }
    }

    /// Whether both may mean the same flag.
    pub fn meets(&self, other: &Target) -> bool {
        let feet = self.foot.is_none() || other.foot.is_none() || self.foot == other.foot;
        self.rule == other.rule && feet && self.start <= other.end && other.start <= self.end
    }
}

impl CorrectOptions {
    /// Whether that flag stays as it is.
    pub fn leaves(&self, flag: &Flag) -> bool {
        self.leave.iter().any(|target| target.meets(&Target::of(flag)))
    }
}

/// What there is to do.
pub fn open<'a>(findings: &'a Findings, options: &CorrectOptions) -> Cow<'a, Findings> {
    if options.leave.is_empty() {
        return Cow::Borrowed(findings);
    }
    let mut open = findings.clone();
    open.flags.retain(|flag| !options.leaves(flag));
    Cow::Owned(open)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::fixture::{Gait, shift_all, walk};
    use crate::correct::{Corrected, correct};
    use crate::model::Capture;
    use glam::DVec3;

    /// Frames that hover and frames that sink, far apart.
    const HOVERS: (usize, usize) = (100, 125);
    const SINKS: (usize, usize) = (230, 255);

    fn spoiled() -> Capture {
        let mut capture = walk(Gait::default());
        for ((start, end), by) in [(HOVERS, 0.06), (SINKS, -0.06)] {
            for frame in start - 10..=end + 10 {
                let beside = start.saturating_sub(frame).max(frame.saturating_sub(end));
                shift_all(&mut capture, frame, DVec3::Y * by * (1.0 - beside as f64 / 10.0));
            }
        }
        capture
    }

    fn without(capture: &Capture, leave: Vec<Target>) -> Corrected {
        correct(capture, &CorrectOptions { leave, ..CorrectOptions::default() })
    }

    fn same(one: &Capture, other: &Capture, frame: usize) -> bool {
        one.at(frame) == other.at(frame) && one.turns_at(frame) == other.turns_at(frame)
    }

    #[test]
    fn a_repair_that_is_left_out_leaves_its_frames_to_the_bit_and_the_others_are_done() {
        let capture = spoiled();
        let all = without(&capture, Vec::new());
        assert!(all.after.flags.is_empty(), "{:?}", all.after.flags);
        let (hovers, others): (Vec<_>, Vec<_>) = all.done.iter().partition(|done| done.start < 170);
        assert!(!hovers.is_empty() && !others.is_empty(), "{:?}", all.done);
        let leave: Vec<Target> = hovers.iter().flat_map(|done| done.answers.clone()).collect();
        let some = without(&capture, leave);
        assert_eq!(some.done, others.into_iter().cloned().collect::<Vec<_>>());
        for frame in 0..capture.frames() {
            let meant = if frame < 170 { &capture } else { &all.capture };
            assert!(same(&some.capture, meant, frame), "frame {frame}");
        }
        let left = |corrected: &Corrected| corrected.after.flags.iter().filter(|flag| flag.start < 170).count();
        assert!(left(&some) > 0 && left(&all) == 0);
        assert!(some.notes.is_empty(), "what was left on purpose is no failure: {:?}", some.notes);
    }

    #[test]
    fn all_left_out_is_the_source() {
        let capture = spoiled();
        let leave = without(&capture, Vec::new()).before.flags.iter().map(Target::of).collect();
        let none = without(&capture, leave);
        assert!(none.done.is_empty() && none.changed.is_empty());
        assert!(none.capture.positions == capture.positions && none.capture.turns == capture.turns);
    }

    #[test]
    fn what_meets_nothing_changes_nothing() {
        let capture = spoiled();
        let elsewhere = Target { rule: Rule::Ballistic, foot: None, start: 0, end: 400 };
        let (all, some) = (without(&capture, Vec::new()), without(&capture, vec![elsewhere]));
        assert!(all.capture.positions == some.capture.positions && all.done == some.done);
    }

    #[test]
    fn a_target_meets_its_rule_and_foot_where_frames_are_shared() {
        let target = |rule, foot, start, end| Target { rule, foot, start, end };
        let slide = target(Rule::FootSlide, Some("left"), 10, 20);
        assert!(slide.meets(&target(Rule::FootSlide, Some("left"), 20, 30)));
        assert!(slide.meets(&target(Rule::FootSlide, None, 0, 10)));
        assert!(!slide.meets(&target(Rule::FootSlide, Some("right"), 10, 20)));
        assert!(!slide.meets(&target(Rule::Float, Some("left"), 10, 20)));
        assert!(!slide.meets(&target(Rule::FootSlide, Some("left"), 21, 30)));
    }
}

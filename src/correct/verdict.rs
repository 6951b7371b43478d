//! Whether a repair stays: the audit is asked again, and what did not make its span cleaner goes back to what it was.
//!
//! Flags are weighed by how far they are beyond their limit. A flag in a place where the source had none is never accepted. Flags that a
//! person leaves as they are do not count, neither for a repair nor against it.

use super::posing::Piece;
use super::{CorrectOptions, Done, Fix, Target};
use crate::audit::audit;
use crate::model::Capture;
use crate::model::findings::{Findings, Flag, Rule};

/// Frames beside a repair in which it answers for what the audit finds.
const BESIDE: usize = 12;
/// A repair must take away that share of what was found in its span.
const CLEANER: f64 = 0.2;

/// Rules that tell of the same thing.
const KIN: [[Rule; 2]; 2] = [[Rule::FootSlide, Rule::Drift], [Rule::Penetration, Rule::Float]];
/// Frames that a repair may make the audit abstain from.
const SILENT: usize = 3;

/// How much more another rule's flags may weigh after a repair.
const PAID: f64 = 1.2;

/// Tries fixes that do not meet; those that stay.
pub fn apply(
    capture: &mut Capture,
    after: &mut Findings,
    known: &Findings,
    fixes: Vec<Fix>,
    options: &CorrectOptions,
) -> Vec<Done> {
    if fixes.is_empty() {
        return Vec::new();
    }
    struct Tried {
        was: Piece,
        done: Done,
    }
    let mut tried: Vec<Tried> = Vec::new();
    for fix in fixes {
        let (start, end) = (fix.piece.start, fix.piece.end());
        let answers: Vec<Target> = fix.flags.iter().map(Target::of).collect();
        let Some(Target { rule, foot, .. }) = answers.first().copied() else { continue };
        let was = fix.piece.swap(capture);
        let done = Done { start, end, rule, foot, moved_m: fix.moved, what: fix.what, held: fix.held, answers };
        tried.push(Tried { was, done });
    }
    let counting =
        |flags: &[Flag]| -> Vec<Flag> { flags.iter().filter(|flag| !options.leaves(flag)).cloned().collect() };
    let before = counting(&after.flags);
    loop {
        let found = audit(capture, &options.audit);
        let flags = counting(&found.flags);
        let strange: Vec<&Flag> = flags.iter().filter(|flag| !flag_is_known(flag, known)).collect();
        let bad = |tried: &Tried| {
            let zone = (tried.done.start.saturating_sub(BESIDE), tried.done.end + BESIDE);
            let worth = |flags: &[Flag]| cost(&overlapping(flags, zone));
            let raised = strange.iter().any(|flag| overlap((flag.start, flag.end), zone));
            // Silence is no cure: frames that the audit does not judge any more count as they did.
            let silent = unjudged(&found, zone) > unjudged(after, zone) + SILENT;
            // No rule may pay for another.
            let kin = |one: Rule, other: Rule| {
                one == other || KIN.iter().any(|kin| kin.contains(&one) && kin.contains(&other))
            };
            let worse = Rule::ALL.into_iter().filter(|rule| !kin(*rule, tried.done.rule)).any(|rule| {
                let of = |flags: &[Flag]| -> f64 {
                    let own = overlapping(flags, zone).into_iter().filter(|flag| kin(flag.rule, rule));
                    cost(&own.collect::<Vec<_>>())
                };
                of(&flags) > of(&before) + PAID
            });
            raised || silent || worse || worth(&flags) > (1.0 - CLEANER) * worth(&before)
        };
        let (mut back, kept): (Vec<Tried>, Vec<Tried>) = tried.into_iter().partition(bad);
        tried = kept;
        // A new flag that is nobody's neighbour, or a new one of the whole clip: the last repair has to go.
        let whole = found.clip_flags.iter().any(|flag| known.clip_flags.iter().all(|other| other.rule != flag.rule));
        if back.is_empty() && (whole || !strange.is_empty() || cost(&flags) > cost(&before)) {
            back.extend(tried.pop());
        }
        if back.is_empty() {
            *after = found;
            return tried.into_iter().map(|tried| tried.done).collect();
        }
        for one in back {
            one.was.swap(capture);
        }
        if tried.is_empty() {
            return Vec::new();
        }
    }
}

/// Frames of a zone that the audit abstains from.
fn unjudged(findings: &Findings, zone: (usize, usize)) -> usize {
    let shared =
        |span: &crate::model::findings::Abstained| (span.end.min(zone.1) + 1).saturating_sub(span.start.max(zone.0));
    findings.abstained.iter().map(shared).sum()
}

/// What flags weigh together: each how many times it is beyond its limit.
pub fn cost(flags: &[Flag]) -> f64 {
    flags.iter().map(|flag| (0.5 / (1.0 - flag.severity).max(0.05)).clamp(1.0, 10.0)).sum()
}

/// Whether the source had a flag there.
pub fn flag_is_known(flag: &Flag, known: &Findings) -> bool {
    known.flags.iter().any(|other| overlap((flag.start, flag.end), (other.start, other.end)))
}

fn overlapping(flags: &[Flag], zone: (usize, usize)) -> Vec<Flag> {
    flags.iter().filter(|flag| overlap((flag.start, flag.end), zone)).cloned().collect()
}

fn overlap(a: (usize, usize), b: (usize, usize)) -> bool {
    a.0 <= b.1 && b.0 <= a.1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flag(start: usize, end: usize, severity: f64) -> Flag {
        let (measured, predicted, delta_m, why) = (0.0, 0.0, 0.0, String::new());
        Flag { start, end, rule: Rule::Balance, foot: None, severity, measured, predicted, delta_m, why }
    }

    #[test]
    fn flags_weigh_by_how_far_they_are_beyond_their_limit() {
        assert!((cost(&[flag(0, 1, 0.5)]) - 1.0).abs() < 1e-12, "at the limit");
        assert!((cost(&[flag(0, 1, 0.75), flag(4, 5, 0.5)]) - 3.0).abs() < 1e-12, "twice the limit, and another");
        assert!(cost(&[flag(0, 1, 1.0)]) <= 10.0, "bounded");
    }

    #[test]
    fn spans_overlap_where_they_share_a_frame() {
        assert!(overlap((3, 5), (5, 9)) && overlap((5, 9), (3, 5)) && !overlap((3, 5), (6, 9)));
    }
}

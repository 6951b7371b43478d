//! Whether a repair stays: the audit is asked again, and what did not make its span cleaner goes back to what it was.
//!
//! Flags are weighed by how far they are beyond their limit. A flag in a place where the source had none is never accepted.

use super::posing::Piece;
use super::{Done, Fix};
use crate::audit::{AuditOptions, audit};
use crate::model::Capture;
use crate::model::findings::{Findings, Flag};

/// Frames beside a repair in which it answers for what the audit finds.
const BESIDE: usize = 12;
/// A repair must take away that share of what was found in its span.
const CLEANER: f64 = 0.2;

/// Frames that a repair may make the audit abstain from.
const SILENT: usize = 3;

/// Tries fixes that do not meet; those that stay.
pub fn apply(
    capture: &mut Capture,
    after: &mut Findings,
    known: &Findings,
    fixes: Vec<Fix>,
    options: &AuditOptions,
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
        let was = fix.piece.swap(capture);
        let Flag { rule, foot, .. } = fix.flag;
        tried.push(Tried {
            was,
            done: Done { start, end, rule, foot, moved_m: fix.moved, what: fix.what, held: fix.held },
        });
    }
    let before = after.flags.clone();
    loop {
        let found = audit(capture, options);
        let strange: Vec<&Flag> = found.flags.iter().filter(|flag| !flag_is_known(flag, known)).collect();
        let bad = |tried: &Tried| {
            let zone = (tried.done.start.saturating_sub(BESIDE), tried.done.end + BESIDE);
            let worth = |flags: &[Flag]| cost(&overlapping(flags, zone));
            let raised = strange.iter().any(|flag| overlap((flag.start, flag.end), zone));
            // Silence is no cure: frames that the audit does not judge any more count as they did.
            let silent = unjudged(&found, zone) > unjudged(after, zone) + SILENT;
            raised || silent || worth(&found.flags) > (1.0 - CLEANER) * worth(&before)
        };
        let (mut back, kept): (Vec<Tried>, Vec<Tried>) = tried.into_iter().partition(bad);
        tried = kept;
        // A new flag that is nobody's neighbour: the last repair has to go.
        if back.is_empty() && (!strange.is_empty() || cost(&found.flags) > cost(&before)) {
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

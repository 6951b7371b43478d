//! Hover: how long neither foot is in contact, by the contacts that a clip claims. Seconds.
//!
//! A true free fall counts too: nothing in a scenario asks for a jump. What comes after a fall does not.

use super::HeldContact;

/// s, what two contacts may lie apart and still follow on one another.
const SAME: f64 = 2e-6;

/// The time without any contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hover {
    /// s, all of it.
    pub total: f64,
    /// s, the longest at a stretch.
    pub longest: f64,
    /// s, when the longest begins.
    pub time: f64,
}

/// From 0 to `end` (s).
pub fn hover(contacts: &[HeldContact], end: f64) -> Hover {
    let mut spans: Vec<(f64, f64)> = contacts.iter().map(|contact| (contact.start, contact.end)).collect();
    // Neither side of a comparison with what is not a number holds.
    spans.retain(|(start, end)| start <= end);
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut found = Hover::default();
    let mut until = 0.0_f64;
    for (start, stop) in spans.into_iter().chain([(end, end)]) {
        let gap = start.min(end) - until;
        if gap > SAME {
            found.total += gap;
            if gap > found.longest {
                (found.longest, found.time) = (gap, until);
            }
        }
        until = until.max(stop);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::fixture::flat;
    use super::*;
    use crate::model::Side;

    #[test]
    fn only_the_time_that_no_foot_covers_is_hover() {
        let contacts = [
            flat(Side::Right, 0.6, 1.0),
            flat(Side::Left, 0.0, 0.5),
            flat(Side::Left, 0.9, 1.4),
            flat(Side::Right, 1.7, 1.8),
        ];
        let found = hover(&contacts, 2.0);
        assert!((found.total - 0.6).abs() < 1e-12, "0.1, 0.3 and 0.2 s: {found:?}");
        assert!((found.longest - 0.3).abs() < 1e-12 && found.time == 1.4, "{found:?}");
        assert!((hover(&contacts, 1.5).total - 0.2).abs() < 1e-12, "what lies past the end does not count");
        assert_eq!(hover(&[], 1.0), Hover { total: 1.0, longest: 1.0, time: 0.0 });
        assert_eq!(hover(&[flat(Side::Left, 0.0, 0.5), flat(Side::Right, 0.5, 9.0)], 1.0), Hover::default());
    }

    #[test]
    fn contacts_that_are_no_spans_carry_nobody() {
        for value in [f64::NAN, f64::INFINITY] {
            assert_eq!(hover(&[flat(Side::Left, value, 0.5)], 1.0).total, 1.0);
        }
        assert_eq!(hover(&[flat(Side::Left, f64::NEG_INFINITY, f64::INFINITY)], 1.0), Hover::default());
    }
}

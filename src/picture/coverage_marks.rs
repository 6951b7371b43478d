//! Pushes as single marks around a character, fanned out where several share a place; hollow and joined by a line to the
//! earlier one where they look like it. px.

use super::coverage::{CoveragePoint, Dial, plain};
use super::text::escaped;
use super::verdict::Verdict;
use crate::maths::real;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// px, a mark's radius at most and at least.
const LARGEST: f64 = 6.0;
const SMALLEST: f64 = 2.2;

/// Draws the marks of those points, each with the direction (degrees) in which it lies.
pub(super) fn draw(svg: &mut String, points: &[CoveragePoint], own: &[(usize, f64)], dial: &Dial) {
    // Points of one place: by half degrees and by thousandths of the plot.
    let mut places: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (index, direction) in own {
        let share = points[*index].impulse_ns / dial.most;
        let key = ((direction * 2.0).round() as i64 % 720, (share * 1000.0).round() as i64);
        places.entry(key).or_default().push(*index);
    }
    let centres: Vec<[f64; 2]> = places
        .keys()
        .map(|(half, share)| dial.place(*half as f64 / 2.0, dial.far(*share as f64 / 1000.0 * dial.most)))
        .collect();
    let size = size(&centres, &places.values().map(Vec::len).collect::<Vec<usize>>());
    let mut at: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for (centre, members) in centres.iter().zip(places.values()) {
        for (index, [dx, dy]) in members.iter().zip(fan(members.len())) {
            at.insert(*index, [centre[0] + dx * size, centre[1] + dy * size]);
        }
    }
    for (index, [x, y]) in &at {
        if let Some([to_x, to_y]) = points[*index].duplicate_of.and_then(|other| at.get(&other)) {
            let _ = write!(svg, "<path class=\"link\" d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\"/>");
        }
    }
    for (index, place) in &at {
        let point = &points[*index];
        let steps = match point.steps {
            0 => String::new(),
            1 => ", 1 step".to_owned(),
            steps => format!(", {steps} steps"),
        };
        let word = point.verdict.word();
        let told = format!("{}: {word}{steps}, {} Ns", escaped(&point.name), plain(point.impulse_ns));
        mark(svg, point.verdict, *place, size, point.duplicate_of.is_some(), &told);
    }
}

/// A verdict's shape; `told` (XML text) shows when a viewer points at it.
pub(super) fn mark(svg: &mut String, verdict: Verdict, [x, y]: [f64; 2], size: f64, hollow: bool, told: &str) {
    let class = format!("{} k{}", verdict.word(), if hollow { " o" } else { "" });
    let told = if told.is_empty() { String::new() } else { format!("<title>{told}</title>") };
    let r = size * 0.86;
    let path = |d: String| format!("<path class=\"{class}\" d=\"{d}\">{told}</path>");
    let _ = svg.write_str(&match verdict {
        Verdict::Sway => format!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\">{told}</circle>", r * 0.9),
        // A flat bar: nothing happened.
        Verdict::Still => path(format!("M{:.1} {:.1}h{:.1}v{:.1}h{:.1}Z", x - r, y - r * 0.36, 2.0 * r, r * 0.72, -2.0 * r)),
        Verdict::Step => path(format!("M{x:.1} {:.1}l{r:.1} {:.1}h{:.1}Z", y - r, r * 1.8, -2.0 * r)),
        Verdict::Fall => {
            // A thick cross.
            let (a, b) = (r, r * 0.34);
            path(format!(
                "M{x:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}L{:.1} {y:.1}L{:.1} {:.1}L{:.1} {:.1}L{x:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}L{:.1} {y:.1}L{:.1} {:.1}L{:.1} {:.1}Z",
                y - b, x + a - b, y - a, x + a, y - a + b, x + b, x + a, y + a - b, x + a - b, y + a, y + b,
                x - a + b, y + a, x - a, y + a - b, x - b, x - a, y - a + b, x - a + b, y - a
            ))
        }
        Verdict::Failed => path(format!("M{:.1} {:.1}h{:.1}v{:.1}h{:.1}Z", x - r * 0.85, y - r * 0.85, 1.7 * r, 1.7 * r, -1.7 * r)),
    });
}

/// As large as fits between places.
fn size(centres: &[[f64; 2]], counts: &[usize]) -> f64 {
    let mut size = LARGEST;
    for (one, a) in centres.iter().enumerate() {
        for (two, b) in centres.iter().enumerate().skip(one + 1) {
            let apart = real::hypot(a[0] - b[0], a[1] - b[1]);
            size = size.min(apart / (reach(counts[one]) + reach(counts[two])));
        }
    }
    size.max(SMALLEST)
}

/// How far a fan reaches, in radii of a mark.
fn reach(count: usize) -> f64 {
    fan(count).iter().map(|[x, y]| real::hypot(*x, *y)).fold(0.0, f64::max) + 1.15
}

/// Places about a centre, in radii of a mark: side by side, then rings.
fn fan(count: usize) -> Vec<[f64; 2]> {
    let ring = |count: usize, radius: f64| {
        let turn = move |at: usize| TAU * at as f64 / count as f64 - PI / 2.0;
        (0..count).map(move |at| [radius * real::cos(turn(at)), radius * real::sin(turn(at))])
    };
    match count {
        0 | 1 => vec![[0.0, 0.0]; count],
        2 => vec![[-1.15, 0.0], [1.15, 0.0]],
        3..=6 => ring(count, 1.15 / real::sin(PI / count as f64)).collect(),
        _ => {
            let mut places = vec![[0.0, 0.0]];
            let mut around = 1;
            while places.len() < count {
                let left = count - places.len();
                places.extend(ring((6 * around).min(left), 2.3 * around as f64));
                around += 1;
            }
            places
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_marks_of_a_fan_overlap() {
        for count in 1..60 {
            let places = fan(count);
            assert_eq!(places.len(), count);
            for (one, a) in places.iter().enumerate() {
                for b in &places[one + 1..] {
                    let apart = real::hypot(a[0] - b[0], a[1] - b[1]);
                    assert!(apart > 2.2, "{count}: {apart}");
                }
            }
        }
    }

    #[test]
    fn marks_shrink_until_neighbouring_fans_fit() {
        assert_eq!(size(&[[0.0, 0.0], [400.0, 0.0]], &[3, 3]), LARGEST);
        let tight = size(&[[0.0, 0.0], [20.0, 0.0]], &[3, 3]);
        assert!(2.0 * reach(3) * tight <= 20.0 + 1e-9 && tight > SMALLEST, "{tight}");
        assert_eq!(size(&[[0.0, 0.0], [1.0, 0.0]], &[3, 3]), SMALLEST);
    }
}

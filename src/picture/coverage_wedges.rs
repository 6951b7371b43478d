//! Many pushes around a character as shares: a field for each range of direction and impulse, divided by what came of them.
//!
//! Where a sweep has few directions and few impulses the fields lie around those values, else they divide the plot evenly.
//! The part of a share that looks like an earlier one is pale; falls and failures are striped as well. px.

use super::coverage::{CoveragePoint, Dial, plain};
use super::verdict::Verdict;
use std::fmt::Write;

/// Fields around, and out, where values are too many to have fields of their own.
const AROUND: usize = 16;
const OUT: usize = 6;
/// Values of their own at most.
const MOST_AROUND: usize = 24;
const MOST_OUT: usize = 12;

/// Draws the fields of those points, each with the direction (degrees) in which it lies.
pub(super) fn draw(svg: &mut String, points: &[CoveragePoint], own: &[(usize, f64)], dial: &Dial) {
    let around = around(own.iter().map(|(_, direction)| *direction));
    let out = out(own.iter().map(|(index, _)| points[*index].impulse_ns), dial.most);
    // (around x out) counts by verdict, those like an earlier one apart.
    let mut fields = vec![[[0_usize; 2]; 5]; around.len() * out.len()];
    for (index, direction) in own {
        let point = &points[*index];
        let column = around.iter().position(|[from, to]| (direction - from).rem_euclid(360.0) < to - from).unwrap_or(0);
        let row = out.iter().position(|[_, to]| point.impulse_ns < *to).unwrap_or(out.len() - 1);
        fields[column * out.len() + row][point.verdict as usize][usize::from(point.duplicate_of.is_some())] += 1;
    }
    for (at, field) in fields.iter().enumerate() {
        let ([from, to], [low, high]) = (around[at / out.len()], out[at % out.len()]);
        let total: usize = field.iter().flatten().sum();
        if total > 0 {
            let radii = [dial.far(low), dial.far(high)];
            shares(svg, field, total, dial, [from, to], radii, [low, high]);
        }
    }
}

/// One field.
fn shares(
    svg: &mut String,
    field: &[[usize; 2]; 5],
    total: usize,
    dial: &Dial,
    [from, to]: [f64; 2],
    [near, far]: [f64; 2],
    [low, high]: [f64; 2],
) {
    let words = Verdict::ALL.map(|verdict| (field[verdict as usize].iter().sum::<usize>(), verdict));
    let words: Vec<String> = words
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, verdict)| format!("{count} {}", verdict.word()))
        .collect();
    let _ = write!(svg, "<g class=\"w\"><title>{}, {} to {} Ns</title>", words.join(", "), plain(low), plain(high));
    // A fortieth of the field stays free on each side.
    let margin = (to - from) / 40.0;
    let (start, width) = (from + margin, to - from - 2.0 * margin);
    let mut done = 0;
    for verdict in Verdict::ALL {
        for (pale, count) in field[verdict as usize].into_iter().enumerate() {
            if count == 0 {
                continue;
            }
            let at = |count: usize| start + width * count as f64 / total as f64;
            let path = sector(dial, [at(done), at(done + count)], [near + 0.7, far - 0.7]);
            let class = if pale == 1 { " d" } else { "" };
            let _ = write!(svg, "<path class=\"{} w{class}\" d=\"{path}\"/>", verdict.word());
            if verdict >= Verdict::Fall {
                let _ = write!(svg, "<path fill=\"url(#stripes)\" d=\"{path}\"/>");
            }
            done += count;
        }
    }
    svg.push_str("</g>");
}

/// A part of a ring.
fn sector(dial: &Dial, [from, to]: [f64; 2], [near, far]: [f64; 2]) -> String {
    // A whole ring would begin where it ends.
    let to = to.min(from + 359.9);
    let wide = u8::from(to - from > 180.0);
    let ([ax, ay], [bx, by]) = (dial.place(from, far), dial.place(to, far));
    let ([cx, cy], [dx, dy]) = (dial.place(to, near), dial.place(from, near));
    format!(
        "M{ax:.1} {ay:.1}A{far:.1} {far:.1} 0 {wide} 0 {bx:.1} {by:.1}L{cx:.1} {cy:.1}A{near:.1} {near:.1} 0 {wide} 1 {dx:.1} {dy:.1}Z"
    )
}

/// Ranges of direction, degrees; a range may reach over 360.
fn around(directions: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
    let mut found: Vec<f64> = Vec::new();
    for direction in directions {
        let apart = |a: f64| ((a - direction + 180.0).rem_euclid(360.0) - 180.0).abs();
        if found.iter().all(|have| apart(*have) > 0.5) {
            found.push(direction);
        }
        if found.len() > MOST_AROUND {
            let width = 360.0 / AROUND as f64;
            return (0..AROUND).map(|at| [(at as f64 - 0.5) * width, (at as f64 + 0.5) * width]).collect();
        }
    }
    found.sort_by(f64::total_cmp);
    let count = found.len();
    let range = |at: usize| {
        let before = if at == 0 { found[count - 1] - 360.0 } else { found[at - 1] };
        let after = if at + 1 == count { found[0] + 360.0 } else { found[at + 1] };
        // A direction without near neighbours does not claim half the circle.
        let half = |other: f64| ((other - found[at]).abs() / 2.0).min(22.5);
        [found[at] - half(before), found[at] + half(after)]
    };
    (0..count).map(range).collect()
}

/// Ranges of impulse, N s, from the smallest; the last holds its upper end.
fn out(impulses: impl Iterator<Item = f64>, most: f64) -> Vec<[f64; 2]> {
    let mut found: Vec<f64> = Vec::new();
    for impulse in impulses {
        if found.iter().all(|have| (have - impulse).abs() > 0.002 * most) {
            found.push(impulse);
        }
        if found.len() > MOST_OUT {
            return (0..OUT).map(|at| [most * at as f64 / OUT as f64, most * (at + 1) as f64 / OUT as f64]).collect();
        }
    }
    found.sort_by(f64::total_cmp);
    let narrowest = found.windows(2).map(|pair| pair[1] - pair[0]).fold(most / 3.0, f64::min);
    let range = |at: usize| {
        let low = if at == 0 { (found[0] - narrowest / 2.0).max(0.0) } else { (found[at - 1] + found[at]) / 2.0 };
        let high = found.get(at + 1).map_or((found[at] + narrowest / 2.0).min(most), |next| (found[at] + next) / 2.0);
        [low, high.max(low + 0.004 * most)]
    };
    (0..found.len()).map(range).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_directions_have_fields_of_their_own_and_many_share_sixteen() {
        let eight = around((0..80).map(|at| f64::from(at % 8) * 45.0));
        assert_eq!(eight.len(), 8);
        assert_eq!((eight[0], eight[2]), ([-22.5, 22.5], [67.5, 112.5]));
        assert_eq!(around((0..200).map(f64::from)).len(), AROUND);
        assert_eq!(around([359.9, 0.1].into_iter()).len(), 1, "one direction");
        assert_eq!(around([90.0].into_iter()), [[67.5, 112.5]]);
    }

    #[test]
    fn impulses_have_rings_about_them_that_do_not_overlap() {
        let rings = out([20.0, 40.0, 60.0, 20.0].into_iter(), 60.0);
        assert_eq!(rings, [[10.0, 30.0], [30.0, 50.0], [50.0, 60.0]]);
        assert_eq!(out((0..50).map(f64::from), 60.0).len(), OUT);
        assert_eq!(out([0.0].into_iter(), 1.0).len(), 1);
    }
}

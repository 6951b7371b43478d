//! The axes of a sweep to points: which row of each axis, for every point. Product, side by side, or sampled.
//!
//! Leaves out scenarios and rigs, which multiply the points, and what a row means.

use crate::maths::seed::Seed;
use crate::model::sweep::{Axis, AxisValues, Choice, Combine};
use crate::model::sweep_range::{between, valued};

/// How many points there are; `None` past what can be counted.
pub fn count(axes: &[Axis], combine: Combine) -> Option<usize> {
    match combine {
        Combine::Sample { count, .. } => Some(count),
        Combine::Zip => Some(axes.first().map_or(1, length)),
        Combine::Product => axes.iter().map(length).try_fold(1usize, |all, axis| all.checked_mul(axis)),
    }
}

/// The values at each point, axis by axis and path by path: one for every path of the sweep.
pub fn points(axes: &[Axis], combine: Combine) -> Vec<Vec<Choice>> {
    let count = count(axes, combine).unwrap_or(0);
    match combine {
        Combine::Sample { count, seed, stratified } => sampled(axes, count, seed, stratified),
        Combine::Zip => (0..count).map(|point| axes.iter().flat_map(|axis| row(axis, point)).collect()).collect(),
        Combine::Product => (0..count)
            .map(|point| {
                let mut rest = count;
                let at = |axis: &Axis| {
                    rest /= length(axis);
                    row(axis, point / rest % length(axis))
                };
                axes.iter().flat_map(at).collect()
            })
            .collect(),
    }
}

/// Rows of an axis.
fn length(axis: &Axis) -> usize {
    match &axis.values {
        AxisValues::Rows(rows) => rows.len(),
        AxisValues::Between { .. } => 1,
    }
}

fn row(axis: &Axis, index: usize) -> Vec<Choice> {
    match &axis.values {
        AxisValues::Rows(rows) => rows[index].clone(),
        AxisValues::Between { from, to, log } => drawn(*from, *to, *log, 0.5),
    }
}

fn drawn(from: f64, to: f64, log: bool, share: f64) -> Vec<Choice> {
    // Six digits: a drawn force is no measurement, and its name should be short.
    let value: f64 = format!("{:.5e}", between(from, to, log, share)).parse().unwrap_or(from);
    vec![Choice { value: valued(value, false), name: None }]
}

/// McKay, Beckman and Conover, "A Comparison of Three Methods for Selecting Values of Input Variables", 1979: each axis is cut into
/// `count` parts, and a permutation of its own says which point draws from which part.
fn sampled(axes: &[Axis], count: usize, seed: u64, stratified: bool) -> Vec<Vec<Choice>> {
    let mut points = vec![Vec::with_capacity(axes.len()); count];
    for (number, axis) in axes.iter().enumerate() {
        let mut draw = Seed::new(seed).split(number as u64);
        let mut parts: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            parts.swap(last, (draw.unit() * (last + 1) as f64) as usize);
        }
        for (point, part) in points.iter_mut().zip(parts) {
            let share = if stratified { (part as f64 + draw.unit()) / count as f64 } else { draw.unit() };
            point.extend(match &axis.values {
                AxisValues::Rows(rows) => rows[((share * rows.len() as f64) as usize).min(rows.len() - 1)].clone(),
                AxisValues::Between { from, to, log } => drawn(*from, *to, *log, share),
            });
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::real;
    use crate::model::sweep::AxisPath;
    use toml::Value;

    fn axis(path: &str, values: AxisValues) -> Axis {
        Axis { paths: vec![AxisPath { path: path.into(), place: path.into() }], values }
    }

    fn list(path: &str, values: &[i64]) -> Axis {
        let rows = values.iter().map(|value| vec![Choice { value: Value::Integer(*value), name: None }]).collect();
        axis(path, AxisValues::Rows(rows))
    }

    fn whole(points: &[Vec<Choice>]) -> Vec<Vec<i64>> {
        points.iter().map(|point| point.iter().filter_map(|choice| choice.value.as_integer()).collect()).collect()
    }

    #[test]
    fn the_product_turns_the_last_axis_fastest() {
        let axes = [list("a", &[1, 2]), list("b", &[3, 4, 5])];
        let points = points(&axes, Combine::Product);
        assert_eq!(whole(&points), [[1, 3], [1, 4], [1, 5], [2, 3], [2, 4], [2, 5]]);
    }

    #[test]
    fn zip_goes_row_by_row() {
        let axes = [list("a", &[1, 2]), list("b", &[3, 4])];
        assert_eq!(whole(&points(&axes, Combine::Zip)), [[1, 3], [2, 4]]);
    }

    #[test]
    fn a_latin_hypercube_draws_once_from_each_part_of_each_axis() {
        let axes = [
            axis("a", AxisValues::Between { from: 0.0, to: 10.0, log: false }),
            axis("b", AxisValues::Between { from: 1.0, to: 1024.0, log: true }),
            list("c", &[1, 2]),
        ];
        let combine = Combine::Sample { count: 10, seed: 3, stratified: true };
        let drawn = points(&axes, combine);
        for (path, part) in [(0, 0), (1, 1)] {
            let mut parts: Vec<usize> = drawn
                .iter()
                .map(|point| point[path].value.as_float().expect("a number"))
                .map(|value| if part == 0 { value as usize } else { real::log2(value) as usize })
                .collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..10).collect::<Vec<_>>(), "path {path}");
        }
        let ones = drawn.iter().filter(|point| point[2].value.as_integer() == Some(1)).count();
        assert_eq!(ones, 5, "a list of two is halved");
        assert_eq!(drawn, points(&axes, combine), "the same seed draws the same");
        assert_ne!(drawn, points(&axes, Combine::Sample { count: 10, seed: 4, stratified: true }));
    }

    #[test]
    fn a_product_past_counting_is_told() {
        let axes: Vec<Axis> = (0..40).map(|_| list("a", &[0; 100])).collect();
        assert_eq!(count(&axes, Combine::Product), None);
    }
}

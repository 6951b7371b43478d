//! The pictures of a batch: the sheet of small contact sheets and the coverage of directions and impulses.

use super::batch_out::Results;
use super::writer::Output;

/// Index of the earlier variation that each resembles.
pub fn alike(results: &Results) -> Vec<Option<usize>> {
    vec![None; results.endings.len()]
}

/// `sheet.png`, and further pages.
pub fn sheet(_results: &Results, _alike: &[Option<usize>]) -> Vec<Output> {
    Vec::new()
}

/// `coverage.svg`.
pub fn coverage(results: &Results, _alike: &[Option<usize>]) -> Output {
    Output { path: results.output.join("coverage.svg"), bytes: Vec::new() }
}

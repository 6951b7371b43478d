//! Sums over the samples that move, which no stillness before or after them can thin out.
//!
//! A sample moves where the centre of mass is faster than [`MOVING_SPEED`], or where nothing carries it. A stand counts
//! beside them, by itself: the worst half second of it, so that a body that leans where nothing could hold it is seen
//! although it does not move, and so that a longer stand adds such half seconds and takes none away.

use super::dynamics::Dynamics;
use super::support::Support;
use super::{MOVING_SPEED, percentile};

/// s of stillness that are a stand.
const STAND: f64 = 0.5;

/// Which samples move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moving {
    /// One a sample.
    pub samples: Vec<bool>,
    window: usize, // samples of a stand's half second
}

impl Moving {
    /// Of a motion at `hz` samples a second.
    pub fn of(dynamics: &Dynamics, supports: &[Option<Support>], hz: f64) -> Moving {
        let speeds = dynamics.velocity.iter().map(|velocity| velocity.length() > MOVING_SPEED);
        let samples = speeds.zip(supports).map(|(fast, support)| fast || support.is_none()).collect();
        Moving { samples, window: (STAND * hz).round().max(1.0) as usize }
    }

    /// Root of the mean square over moving samples, or over the worst half second of a stand where that is more.
    pub fn rms(&self, values: &[f64]) -> f64 {
        let squares: Vec<f64> = values.iter().map(|value| value * value).collect();
        let moving: Vec<f64> = self.pick(&squares).collect();
        let mean = if moving.is_empty() { 0.0 } else { moving.iter().sum::<f64>() / moving.len() as f64 };
        mean.max(self.worst_stand(&squares)).sqrt()
    }

    /// The value below which a share of the moving samples lies, or the mean of the worst half second of a stand where
    /// that is more. `None`: a sample that says nothing.
    pub fn percentile(&self, values: &[Option<f64>], share: f64) -> f64 {
        let moving: Vec<f64> = self.pick(values).flatten().collect();
        let all: Vec<f64> = values.iter().map(|value| value.unwrap_or(0.0)).collect();
        percentile(&moving, share).max(self.worst_stand(&all))
    }

    /// Share of the moving samples of which something holds; 0 where nothing moves.
    pub fn share(&self, holds: &[bool]) -> f64 {
        let moving: Vec<bool> = self.pick(holds).collect();
        let held = moving.iter().filter(|holds| **holds).count();
        held as f64 / moving.len().max(1) as f64
    }

    fn pick<T: Copy>(&self, values: &[T]) -> impl Iterator<Item = T> {
        self.samples.iter().zip(values).filter(|(moves, _)| **moves).map(|(_, value)| *value)
    }

    /// The largest mean over any half second in which no sample moves; 0 without one.
    fn worst_stand(&self, values: &[f64]) -> f64 {
        let windows = self.samples.windows(self.window).zip(values.windows(self.window));
        let still = windows.filter(|(moves, _)| moves.iter().all(|moves| !moves)).map(|(_, values)| values);
        still.map(|values| values.iter().sum::<f64>() / self.window as f64).fold(0.0, f64::max)
    }
}

/// The level that the values keep up for more than `span` (s), and the sample at which that begins: the largest, over
/// all such spans, of the least value within. What lasts shorter, like one sample of an impact, does not count; neither
/// does a span with a `None` in it.
pub fn kept_up(values: &[Option<f64>], hz: f64, span: f64) -> (f64, usize) {
    // So many samples span more than that from the first to the last.
    let count = (span * hz + 1e-9).floor() as usize + 2;
    let least = |window: &[Option<f64>]| {
        window.iter().try_fold(f64::INFINITY, |least, value| value.map(|value| least.min(value)))
    };
    let levels = values.windows(count).enumerate().filter_map(|(at, window)| Some((least(window)?, at)));
    levels.fold((0.0, 0), |most, next| if next.0 > most.0 { next } else { most })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stillness_that_is_added_changes_nothing_and_a_worse_stand_counts() {
        let moving = Moving { samples: [vec![true; 100], vec![false; 80]].concat(), window: 60 };
        let values: Vec<f64> = (0..180).map(|at| if at < 100 { 0.3 } else { 0.1 }).collect();
        assert!((moving.rms(&values) - 0.3).abs() < 1e-12);
        let mut padded = moving.clone();
        padded.samples.extend([false; 500]);
        let longer = [values.clone(), vec![0.0; 500]].concat();
        assert_eq!(padded.rms(&longer), moving.rms(&values));
        let leaning = [values, vec![0.4; 500]].concat();
        assert!((padded.rms(&leaning) - 0.4).abs() < 1e-12);
        let told: Vec<Option<f64>> = leaning.iter().map(|value| Some(*value)).collect();
        assert!((padded.percentile(&told, 0.99) - 0.4).abs() < 1e-12);
        assert!((padded.share(&leaning.iter().map(|value| *value > 0.35).collect::<Vec<_>>())).abs() < 1e-12);
        // A standstill between two movements is no stand.
        let pause = Moving { samples: [vec![true; 9], vec![false; 59], vec![true; 9]].concat(), window: 60 };
        assert_eq!(pause.rms(&[vec![0.0; 9], vec![1.0; 59], vec![0.0; 9]].concat()), 0.0);
    }

    #[test]
    fn a_level_is_kept_up_only_by_what_lasts_and_stays_in_contact() {
        let at = |samples: std::ops::Range<usize>| {
            (0..60).map(|sample| Some(if samples.contains(&sample) { 0.2 } else { 0.01 })).collect::<Vec<_>>()
        };
        // At 120 Hz six intervals are 0.05 s: seven samples do not span more, eight do.
        assert_eq!(kept_up(&at(10..17), 120.0, 0.05).0, 0.01);
        assert_eq!(kept_up(&at(10..18), 120.0, 0.05), (0.2, 10));
        let mut broken = at(10..18);
        broken[13] = None;
        assert_eq!(kept_up(&broken, 120.0, 0.05).0, 0.01);
        assert_eq!(kept_up(&[], 120.0, 0.05), (0.0, 0));
    }
}

//! Time to place on a timeline and back: a window of time over a stretch of points. Pure; s and egui points.

use std::ops::RangeInclusive;

/// s, the shortest time that a timeline shows.
const SHORTEST: f64 = 0.05;
/// s, the longest.
const LONGEST: f64 = 3600.0;

/// What a timeline shows: kept from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeWindow {
    /// s, at the left edge.
    pub start: f64,
    /// s, from edge to edge.
    pub span: f64,
}

/// The map of one frame.
#[derive(Clone, Copy, Debug)]
pub struct TimeMap {
    window: TimeWindow,
    left: f32,
    width: f32,
}

impl TimeWindow {
    /// All of a clip, with a little room.
    pub fn whole(duration: f64) -> TimeWindow {
        let span = (duration * 1.04).clamp(SHORTEST, LONGEST);
        TimeWindow { start: -span * 0.01, span }
    }

    /// Nearer by a factor, about a time that stays where it is.
    pub fn zoomed(self, factor: f64, about: f64) -> TimeWindow {
        let span = (self.span / factor.max(1e-6)).clamp(SHORTEST, LONGEST);
        TimeWindow { start: about - (about - self.start) * span / self.span, span }
    }

    /// Later by so many seconds.
    pub fn panned(self, by: f64) -> TimeWindow {
        TimeWindow { start: self.start + by, ..self }
    }
}

impl TimeMap {
    /// The window over a stretch of the screen.
    pub fn new(window: TimeWindow, across: RangeInclusive<f32>) -> TimeMap {
        TimeMap { window, left: *across.start(), width: (across.end() - across.start()).max(1.0) }
    }

    /// Where a time is.
    pub fn x(&self, time: f64) -> f32 {
        // In f64 up to the end: far from the start of a long clip f32 seconds are coarser than points.
        (f64::from(self.left) + (time - self.window.start) / self.window.span * f64::from(self.width)) as f32
    }

    /// Which time is there.
    pub fn time(&self, x: f32) -> f64 {
        self.window.start + f64::from(x - self.left) / f64::from(self.width) * self.window.span
    }

    /// s, how long a distance is.
    pub fn length(&self, points: f32) -> f64 {
        f64::from(points) / f64::from(self.width) * self.window.span
    }

    /// Places of marks for a ruler, with a distance that people count in, at least `apart` points from each other; and the distance.
    pub fn ticks(&self, apart: f32) -> (Vec<f64>, f64) {
        let least = self.length(apart);
        let decade = 10_f64.powf(least.max(1e-9).log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|times| times * decade).into_iter().find(|step| *step >= least);
        let step = step.unwrap_or(10.0 * decade).max(1e-3);
        let first = (self.window.start / step).ceil() as i64;
        let last = ((self.window.start + self.window.span) / step).floor() as i64;
        ((first..=last.min(first + 500)).map(|at| at as f64 * step).collect(), step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_the_same_time() {
        for (start, span) in [(0.0, 5.0), (-0.1, 0.05), (3000.0, 0.2)] {
            let map = TimeMap::new(TimeWindow { start, span }, 40.0..=1240.0);
            for share in [0.0, 0.25, 0.5, 1.0] {
                let time = start + span * share;
                assert!((map.time(map.x(time)) - time).abs() < span * 1e-5, "{time}");
            }
        }
    }

    #[test]
    fn zoom_keeps_the_time_under_the_pointer() {
        let window = TimeWindow { start: 1.0, span: 4.0 };
        let near = window.zoomed(2.0, 2.5);
        let (before, after) = (TimeMap::new(window, 0.0..=800.0), TimeMap::new(near, 0.0..=800.0));
        assert!((before.x(2.5) - after.x(2.5)).abs() < 1e-3 && near.span == 2.0);
    }

    #[test]
    fn ticks_are_round_numbers_that_do_not_crowd() {
        let map = TimeMap::new(TimeWindow { start: -0.05, span: 5.2 }, 0.0..=1000.0);
        let (ticks, step) = map.ticks(60.0);
        assert_eq!(step, 0.5);
        assert_eq!((ticks[0], ticks.len()), (0.0, 11));
    }
}

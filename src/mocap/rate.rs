//! Frame rates: what rate a frame time means, on which grid keys lie, and how many frames a clip may have.

/// Hz, that clips are made at; the NTSC ones are 1.001 slower than what they are called.
const KNOWN: [f64; 15] = [
    24.0,
    25.0,
    30.0,
    48.0,
    50.0,
    60.0,
    72.0,
    90.0,
    100.0,
    120.0,
    240.0,
    24.0 / 1.001,
    30.0 / 1.001,
    60.0 / 1.001,
    120.0 / 1.001,
];
/// Hz, where nothing shows a rate.
pub const DEFAULT: f64 = 30.0;
/// Hz: keys further apart than that are poses, not frames.
const SLOWEST: f64 = 20.0;
/// Share of the keys that must lie on a grid.
const ON_GRID: f64 = 0.98;
/// Frames that a clip of few keys may be read as: 20 minutes at 30 Hz.
const MOST_FROM_FEW: usize = 36_000;
/// Frames of any clip: two hours at 120 Hz, some 1.2 GB of captured joints.
pub const MOST_FRAMES: usize = 1_000_000;

/// Hz of a frame time (s): the known rate that is meant where it is within what six decimals lose, else to a thousandth.
pub fn of_frame_time(frame_time: f64) -> f64 {
    let fps = 1.0 / frame_time;
    let near = |known: &f64| (fps - known).abs() < 2e-4 * fps;
    let candidates = KNOWN.iter().copied().chain([fps.round()]).filter(near);
    let nearest = candidates.min_by(|a, b| (a - fps).abs().total_cmp(&(b - fps).abs()));
    nearest.unwrap_or((fps * 1000.0).round() / 1000.0)
}

/// Hz of the grid that the keys of a clip's tracks lie on; `start` is its first, s. Keys that are all alike apart have a rate of their own.
/// `None` where they are poses rather than frames.
pub fn of_keys<'a>(tracks: impl Iterator<Item = &'a [f32]>, start: f64) -> Option<f64> {
    let mut times: Vec<f64> = tracks.flatten().map(|time| f64::from(*time) - start).collect();
    times.sort_by(f64::total_cmp);
    let span = times.last().copied().unwrap_or(0.0);
    // An f32 of some minutes is good to a few microseconds; a tool that rounds to milliseconds is worse.
    times.dedup_by(|a, b| (*a - *b).abs() < 1.5e-3);
    if times.len() < 2 || span <= 0.0 {
        return None;
    }
    let mut gaps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_by(f64::total_cmp);
    let even = |time: &&f64, rate: f64| {
        let frames = **time * rate;
        (frames - frames.round()).abs() < (0.02_f64).max(1.1e-3 * rate.min(60.0))
    };
    let fits = |rate: f64| times.iter().filter(|time| even(time, rate)).count() as f64 >= ON_GRID * times.len() as f64;
    // A rate of its own: every key one gap on.
    let own = (times.len() - 1) as f64 / span;
    let all_alike = gaps[gaps.len() - 1] - gaps[0] < 0.1 / own;
    if all_alike && own >= SLOWEST {
        return Some(of_frame_time(own.recip()));
    }
    let closest = gaps[gaps.len() / 20];
    // 30 before 24: a grid of 6 Hz lies on both. Whole rates before NTSC's: a second of keys tells 24 from 23.976 no more.
    let ordered = std::iter::once(DEFAULT).chain(KNOWN);
    ordered.filter(|rate| *rate * closest > 0.9 && *rate >= SLOWEST).find(|rate| fits(*rate))
}

/// How many frames a clip of that length has; `None` if they are too many for what its `keys` can tell.
pub fn frames(seconds: f64, fps: f64, keys: usize) -> Option<usize> {
    let frames = (seconds * fps + 0.01).floor() + 1.0;
    let most = MOST_FROM_FEW.max(keys.saturating_mul(2)).min(MOST_FRAMES);
    (frames >= 1.0 && frames <= most as f64).then_some(frames as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_what_the_frame_time_means() {
        let cases = [
            (0.008342, 120.0 / 1.001),
            (0.0083333, 120.0),
            (0.00833298, 120.0),
            (0.0333333, 30.0),
            (0.033367, 30.0 / 1.001),
            (0.041667, 24.0),
            (0.04, 25.0),
            (0.01, 100.0),
            (0.0312, 32.051),
        ];
        for (time, fps) in cases {
            assert!((of_frame_time(time) - fps).abs() < 1e-3, "{time}: {}", of_frame_time(time));
        }
    }

    #[test]
    fn keys_show_their_grid_also_where_most_were_taken_away() {
        let at =
            |rate: f64, frames: &[u32]| -> Vec<f32> { frames.iter().map(|f| (f64::from(*f) / rate) as f32).collect() };
        let all: Vec<u32> = (0..134).collect();
        let of = |times: &[f32]| of_keys([times].into_iter(), 0.0).unwrap_or(DEFAULT);
        assert_eq!(of(&at(100.0, &all)), 100.0);
        assert_eq!(of(&at(24.0, &[0, 1, 5, 6, 11, 20])), 24.0);
        assert_eq!(of(&at(25.0, &[0, 3, 4, 11, 17])), 25.0);
        assert_eq!(of(&at(2.0, &[0, 1, 2, 3, 6])), 30.0, "poses half a second apart");
        assert_eq!(of(&at(30.0, &[0])), 30.0);
        assert_eq!(of(&at(36.0, &all)), 36.0, "a rate of its own");
    }

    #[test]
    fn a_clip_of_two_keys_an_hour_apart_is_refused() {
        assert_eq!(frames(1.0, 30.0, 2), Some(31));
        assert_eq!(frames(600.0, 120.0, 72_001), Some(72_001));
        assert_eq!(frames(3600.0, 120.0, 2), None);
        assert_eq!(frames(f64::NAN, 30.0, 2), None);
    }
}

//! The playhead: where it is, whether it runs, how fast, and what it does at the end. Times s.

/// Speeds that a person may choose.
pub const SPEEDS: [f64; 5] = [0.1, 0.25, 0.5, 1.0, 2.0];

/// The playhead's state.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    /// s, where it is.
    pub time: f64,
    /// Whether it runs.
    pub playing: bool,
    /// Whether it begins again at the end.
    pub looping: bool,
    /// Times the clip's own speed.
    pub speed: f64,
}

impl Default for Playback {
    fn default() -> Playback {
        Playback { time: 0.0, playing: false, looping: true, speed: 1.0 }
    }
}

impl Playback {
    /// `passed` seconds of the clock go by over a clip of that length.
    pub fn advance(&mut self, passed: f64, duration: f64) {
        if !self.playing || duration <= 0.0 || !passed.is_finite() {
            return;
        }
        let next = self.time + passed.max(0.0) * self.speed;
        if next <= duration {
            self.time = next;
        } else if self.looping {
            self.time = next % duration;
        } else {
            (self.time, self.playing) = (duration, false);
        }
    }

    /// Runs, or stops. At the end it begins again.
    pub fn toggle(&mut self, duration: f64) {
        self.playing = !self.playing;
        if self.playing && self.time >= duration - 1e-9 {
            self.time = 0.0;
        }
    }

    /// Goes by whole frames and stands there.
    pub fn step(&mut self, frames: i32, fps: f64, duration: f64) {
        self.playing = false;
        let frame = (self.time * fps).round() + f64::from(frames);
        self.time = (frame / fps.max(1e-6)).clamp(0.0, duration.max(0.0));
    }

    /// Goes there; it runs on if it ran.
    pub fn seek(&mut self, time: f64, duration: f64) {
        self.time = time.clamp(0.0, duration.max(0.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_begins_again_or_stands_at_the_end() {
        let mut playback = Playback { playing: true, speed: 2.0, ..Playback::default() };
        playback.advance(1.4, 2.5);
        assert!((playback.time - 0.3).abs() < 1e-12 && playback.playing);
        playback.looping = false;
        playback.advance(9.0, 2.5);
        assert_eq!((playback.time, playback.playing), (2.5, false));
        playback.toggle(2.5);
        assert_eq!((playback.time, playback.playing), (0.0, true));
    }

    #[test]
    fn steps_are_whole_frames_inside_of_the_clip() {
        let mut playback = Playback { time: 0.51, playing: true, ..Playback::default() };
        playback.step(1, 30.0, 1.0);
        assert!((playback.time - 16.0 / 30.0).abs() < 1e-12 && !playback.playing);
        playback.step(-99, 30.0, 1.0);
        assert_eq!(playback.time, 0.0);
        playback.step(99, 30.0, 1.0);
        assert_eq!(playback.time, 1.0);
    }
}

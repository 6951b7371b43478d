//! How fast the studio is: it plays, makes an edit a second, and tells its times at the end. For whoever wants to know, and for tests.

use super::command::Command;
use super::document::{Edit, Entry, Lane, Place};
use super::state::State;
use eframe::egui;
use serde::Serialize;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// s between edits.
const EVERY: f64 = 1.0;

/// What was measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Times {
    /// ms from the start of the program to the first frame.
    pub first_frame_ms: f64,
    /// ms from there to the first clip.
    pub first_clip_ms: f64,
    /// ms from an edit to the clip that shows it: the middle one, and the longest.
    pub edit_ms: [f64; 2],
    /// Edits that were measured.
    pub edits: usize,
    /// ms of work of the window's own thread a frame, the drawing of triangles apart: the middle one, and the 95th percentile.
    pub frame_cpu_ms: [f64; 2],
    /// Frames a second.
    pub fps: f64,
    /// How many there were.
    pub frames: usize,
}

/// Where the times go.
pub type Told = Arc<Mutex<Times>>;

/// A measurement that goes on.
pub struct Measure {
    began: Instant,
    first: Option<Instant>,
    clip: Option<Instant>,
    seconds: f64,
    asked: Option<(Instant, u64)>,
    next: f64,
    edits: Vec<f64>,
    work: Vec<f64>,
    told: Told,
}

impl Measure {
    /// For so many seconds, from the start of the program.
    pub fn new(began: Instant, seconds: f64, told: Told) -> Measure {
        Measure {
            began,
            first: None,
            clip: None,
            seconds,
            asked: None,
            next: EVERY,
            edits: Vec::new(),
            work: Vec::new(),
            told,
        }
    }

    /// A frame begins.
    pub fn frame(&mut self, ctx: &egui::Context, state: &mut State) {
        ctx.request_repaint();
        let now = Instant::now();
        let first = *self.first.get_or_insert(now);
        if self.clip.is_none() && state.is_fresh() {
            self.clip = Some(now);
            self.work.clear(); // what came before shows no clip
        }
        let Some(clip) = self.clip else { return };
        if let (Some((asked, edit)), Some(shown)) = (self.asked, &state.shown)
            && shown.edit > edit
        {
            self.edits.push(ms(now - asked));
            self.asked = None;
        }
        let since = (now - clip).as_secs_f64();
        if since > self.next && self.asked.is_none() && state.is_fresh() {
            self.next = since + EVERY;
            let place = Place { lane: Lane::Push, index: 0 };
            let edit = state.shown.as_ref().map_or(0, |shown| shown.edit);
            if let Some(Entry::Push(push)) = state.document().entry(place) {
                let force = push.force + 7.0;
                state.apply(Command::Edit(Edit::Replace(
                    place,
                    Entry::Push(crate::model::scenario::Push { force, ..push }),
                )));
                self.asked = Some((now, edit));
            }
        }
        if since > self.seconds && !state.closing {
            let mut times = self.told.lock().unwrap_or_else(PoisonError::into_inner);
            *times = Times {
                first_frame_ms: ms(first - self.began),
                first_clip_ms: ms(clip - first),
                edit_ms: [share(&mut self.edits, 0.5), share(&mut self.edits, 1.0)],
                edits: self.edits.len(),
                frame_cpu_ms: [share(&mut self.work, 0.5), share(&mut self.work, 0.95)],
                fps: self.work.len() as f64 / since,
                frames: self.work.len(),
            };
            state.history.saved(&state.document().scenario.clone());
            state.apply(Command::Quit);
        }
    }

    /// A frame was drawn.
    pub fn drawn(&mut self, took: Duration) {
        self.work.push(ms(took));
    }
}

fn ms(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e5).round() / 100.0
}

/// The value under which that share lies.
fn share(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    values[(last as f64 * share).round() as usize]
}

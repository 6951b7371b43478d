//! What the audit's desk shows and what a person decided: plain, and changed by commands alone.
//!
//! Times s, frames from 0. Knows no window and no thread.

use super::repairs::{Decision, Repairs};
use super::shown::{Preview, Shown};
use crate::model::findings::{Flag, Rule};
use crate::studio::playback::Playback;
use crate::studio::time_map::TimeWindow;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// The desk's state.
#[derive(Clone, Debug)]
pub struct State {
    /// The clip file.
    pub file: Option<PathBuf>,
    /// Names of its clips.
    pub clips: Vec<String>,
    /// Which of them is shown, or will be.
    pub chosen: usize,
    /// The clip, read and judged.
    pub shown: Option<Shown>,
    /// Corrections and decisions of every clip that was looked at.
    pub repairs: BTreeMap<usize, Repairs>,
    /// The flag that a person looks at: index into the findings before.
    pub flag: Option<usize>,
    /// The step, of the motion that is shown.
    pub step: Option<usize>,
    /// Rules whose flags are not listed.
    pub hidden: BTreeSet<Rule>,
    /// What is shown.
    pub preview: Preview,
    /// The playhead.
    pub playback: Playback,
    /// What the timeline shows.
    pub window: TimeWindow,
    /// What the plan shows; `None` where it goes with the playhead.
    pub plan: Option<PlanView>,
    /// What went wrong.
    pub fault: Option<String>,
    /// What went well.
    pub notice: Option<String>,
    /// What is worked on.
    pub doing: Option<&'static str>,
}

/// A piece of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanView {
    /// m, (x, z): what is in the middle.
    pub middle: DVec2,
    /// Points a metre.
    pub zoom: f64,
}

/// What a person does at the desk.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Wants another file.
    Open,
    /// Wants the corrected file written.
    Save,
    /// Looks at another clip.
    Choose(usize),
    /// Looks at a flag.
    Flag(usize),
    /// At the next one that is listed.
    NextFlag,
    /// At the one before.
    PreviousFlag,
    /// At a step.
    Footprint(usize),
    /// Goes to a time.
    Seek(f64),
    /// Starts or stops.
    Play,
    /// Goes by frames.
    Step(i32),
    /// Plays at that speed.
    Speed(f64),
    /// Begins again at the end, or not.
    Loop,
    /// Shows this.
    Preview(Preview),
    /// Lists flags of that rule, or no more.
    Toggle(Rule),
    /// Accepts or rejects a correction, or takes that back.
    Decide(usize, Decision),
    /// Accepts all that are not decided.
    AcceptAll,
    /// Zooms or pans the timeline.
    Window(TimeWindow),
    /// Zooms or pans the plan.
    Plan(Option<PlanView>),
    /// Has read what went wrong.
    Dismiss,
}

impl Default for State {
    fn default() -> State {
        State {
            file: None,
            clips: Vec::new(),
            chosen: 0,
            shown: None,
            repairs: BTreeMap::new(),
            flag: None,
            step: None,
            hidden: BTreeSet::new(),
            preview: Preview::default(),
            playback: Playback::default(),
            window: TimeWindow::whole(1.0),
            plan: None,
            fault: None,
            notice: None,
            doing: None,
        }
    }
}

impl State {
    /// Nothing of the file, all of the person's ways of looking.
    pub fn emptied(&self) -> State {
        let playback = Playback { time: 0.0, playing: false, ..self.playback.clone() };
        State { hidden: self.hidden.clone(), preview: self.preview, playback, ..State::default() }
    }

    /// s, the clip's.
    pub fn duration(&self) -> f64 {
        self.shown.as_ref().map_or(0.0, |shown| shown.before.duration())
    }

    /// The corrections of the clip that is shown; `None` until there are any.
    pub fn now(&self) -> Option<&Repairs> {
        self.repairs.get(&self.chosen)
    }

    /// Every flag of the clip.
    pub fn flags(&self) -> &[Flag] {
        self.shown.as_ref().map_or(&[], |shown| &shown.before.findings.flags)
    }

    /// Indices of the flags that are listed.
    pub fn listed(&self) -> Vec<usize> {
        let flags = self.flags();
        (0..flags.len()).filter(|index| !self.hidden.contains(&flags[*index].rule)).collect()
    }

    /// The correction of the flag that a person looks at.
    pub fn selected_repair(&self) -> Option<usize> {
        self.now()?.of_flag(self.flags().get(self.flag?)?)
    }

    /// All but what needs work beside the window.
    pub fn apply(&mut self, command: Command) {
        let duration = self.duration();
        match command {
            Command::Flag(index) => self.look_at(index),
            Command::NextFlag => self.jump(true),
            Command::PreviousFlag => self.jump(false),
            Command::Footprint(index) => {
                self.step = Some(index);
                let touched = self.shown.as_ref().and_then(|shown| {
                    let motion = shown.motion(self.preview);
                    Some(motion.findings.steps.get(index)?.touch_down as f64 / motion.capture.fps)
                });
                if let Some(time) = touched {
                    self.go(time);
                }
            }
            Command::Seek(time) => self.playback.seek(time, duration),
            Command::Play => self.playback.toggle(duration),
            Command::Step(frames) => {
                let fps = self.shown.as_ref().map_or(30.0, |shown| shown.before.capture.fps);
                self.playback.step(frames, fps, duration);
            }
            Command::Speed(speed) => self.playback.speed = speed,
            Command::Loop => self.playback.looping = !self.playback.looping,
            Command::Preview(preview) => self.preview = preview,
            Command::Toggle(rule) => {
                if !self.hidden.remove(&rule) {
                    self.hidden.insert(rule);
                }
            }
            Command::Window(window) => self.window = kept(window, duration),
            Command::Plan(plan) => self.plan = plan,
            Command::Dismiss => (self.fault, self.notice) = (None, None),
            Command::Open | Command::Save | Command::Choose(_) | Command::Decide(..) | Command::AcceptAll => {}
        }
    }

    fn jump(&mut self, onward: bool) {
        let listed = self.listed();
        let frame = self.shown.as_ref().map_or(0, |shown| shown.before.frame(self.playback.time));
        let flags = self.flags();
        let at = self.flag.and_then(|flag| listed.iter().position(|index| *index == flag));
        let next = match (at, onward) {
            (Some(at), true) => listed.get(at + 1).or(listed.first()),
            (Some(at), false) => at.checked_sub(1).map_or(listed.last(), |before| listed.get(before)),
            (None, true) => listed.iter().find(|index| flags[**index].start >= frame).or(listed.first()),
            (None, false) => listed.iter().rev().find(|index| flags[**index].start <= frame).or(listed.last()),
        };
        if let Some(index) = next.copied() {
            self.look_at(index);
        }
    }

    /// The playhead stands at the flag's first frame; the step that it is about is looked at too.
    fn look_at(&mut self, index: usize) {
        let Some((flag, fps)) =
            self.flags().get(index).cloned().zip(self.shown.as_ref().map(|it| it.before.capture.fps))
        else {
            return;
        };
        self.flag = Some(index);
        self.step = self.shown.as_ref().and_then(|shown| {
            let steps = &shown.motion(self.preview).findings.steps;
            let of_it =
                |foot: &str, touched: usize| Some(foot) == flag.foot && (flag.start..=flag.end).contains(&touched);
            steps.iter().position(|step| of_it(step.foot, step.touch_down))
        });
        self.go(flag.start as f64 / fps);
    }

    /// Stands there, and the timeline shows it.
    fn go(&mut self, time: f64) {
        self.playback.playing = false;
        self.playback.seek(time, self.duration());
        self.plan = None;
        let TimeWindow { start, span } = self.window;
        if time < start + 0.03 * span || time > start + 0.97 * span {
            self.window = kept(TimeWindow { start: time - 0.3 * span, span }, self.duration());
        }
    }
}

/// A window that does not leave the clip.
fn kept(window: TimeWindow, duration: f64) -> TimeWindow {
    let whole = TimeWindow::whole(duration);
    let span = window.span.min(whole.span);
    let start = window.start.clamp(whole.start, (whole.start + whole.span - span).max(whole.start));
    TimeWindow { start, span }
}

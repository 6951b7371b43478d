//! The author's view: the character in the middle, the timeline below, the inspector beside, plots where they are wanted.
//!
//! A push by hand in the view becomes an entry of the push lane while it goes on; the clip follows it as it is baked anew.

use super::command::Command;
use super::document::{Edit, Entry, Lane, Place};
use super::plots::Plots;
use super::simulate::Shown;
use super::state::State;
use super::timeline::{self, Timeline};
use super::viewport::{Figure, Grip, GripPhase, Scene, Viewport};
use super::{inspector, transport};
use crate::model::scenario::{Direction, Push};
use crate::picture::transforms_of_globals;
use eframe::egui;
use glam::DVec3;
use std::sync::Arc;

/// s, a push by hand while nothing plays.
const STILL_PUSH: f64 = 0.2;
/// s, within which a push is answered as a rule.
const ANSWERED: f64 = 2.5;
/// s, the shortest push by hand.
const SHORTEST_PUSH: f64 = 0.05;

/// What the view keeps from frame to frame.
#[derive(Default)]
pub struct Author {
    /// The camera and what is shown.
    pub viewport: Viewport,
    /// The lanes.
    pub timeline: Timeline,
    /// Which curves are shown.
    pub plots: Plots,
    /// The push in hand.
    hand: Option<Place>,
    /// The rig that was last seen: another is framed anew.
    rig: Option<Arc<crate::rig::Rig>>,
}

impl Author {
    /// Draws it; the commands are what the person did.
    pub fn ui(&mut self, ui: &mut egui::Ui, state: &State) -> Vec<Command> {
        let mut commands = Vec::new();
        egui::Panel::right("inspector").default_size(300.0).size_range(240.0..=460.0).show(ui, |ui| {
            commands.extend(inspector::ui(ui, state));
        });
        egui::Panel::bottom("timeline").resizable(true).default_size(352.0).min_size(120.0).show(ui, |ui| {
            ui.add_space(4.0);
            commands.extend(transport::ui(ui, state, &mut self.timeline));
            ui.add_space(2.0);
            let input = timeline::Input {
                document: state.document(),
                shown: state.shown.as_ref(),
                fresh: state.is_fresh(),
                selected: state.selected,
                time: state.playback.time,
                faults: &state.faults,
            };
            commands.extend(self.timeline.ui(ui, &input));
        });
        if state.plots {
            egui::Panel::left("plots").default_size(300.0).size_range(200.0..=640.0).show(ui, |ui| {
                match &state.curves {
                    Some(curves) => {
                        let window = self.timeline.window(state.document().scenario.duration);
                        let sought = self.plots.ui(ui, curves, state.playback.time, Some(window));
                        commands.extend(sought.map(Command::Seek));
                    }
                    None => drop(ui.spinner()),
                }
            });
        }
        egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| {
            commands.extend(self.view(ui, state));
        });
        commands
    }

    fn view(&mut self, ui: &mut egui::Ui, state: &State) -> Vec<Command> {
        let Some(shown) = &state.shown else {
            ui.centered_and_justified(|ui| match &state.failure {
                Some(failure) => ui.colored_label(ui.visuals().error_fg_color, super::state::told(failure)),
                None => ui.spinner(),
            });
            return Vec::new();
        };
        if self.rig.as_ref().is_none_or(|rig| !Arc::ptr_eq(rig, &shown.rig)) {
            self.rig = Some(Arc::clone(&shown.rig));
            self.viewport.frame_next();
        }
        let time = state.playback.time;
        let pose = pose(shown, time);
        let marks = shown.tracks.at(time);
        let figures = [Figure { rig: &shown.rig, pose: &pose, ghost: false }];
        let scene = Scene { figures: &figures, capsules: &[], props: &shown.baked.props, time, marks: &marks };
        let grip = self.viewport.ui(ui, &scene);
        self.pushed(state, grip)
    }

    /// A push by hand to an entry: added as it begins, changed while it goes on, one step of the history.
    fn pushed(&mut self, state: &State, grip: Option<Grip>) -> Vec<Command> {
        let Some(grip) = grip else { return Vec::new() };
        let force = grip.force.length();
        let mut commands = Vec::new();
        let now = (state.playback.time * 100.0).round() / 100.0;
        if self.hand.is_none() && force > 5.0 && grip.phase != GripPhase::Released {
            let index = state.document().scenario.push.len();
            self.hand = Some(Place { lane: Lane::Push, index });
            let start = now.min(state.document().scenario.duration - 0.02).max(0.0);
            let push = Push { start, duration: STILL_PUSH, force, toward: toward(grip.force), at: grip.bone };
            commands.push(Command::Drag(Edit::Add(Entry::Push(push))));
            commands.push(Command::Select(self.hand));
        } else if let Some(place) = self.hand
            && let Some(Entry::Push(push)) = state.document().entry(place)
        {
            let lasted = if state.playback.playing && now > push.start {
                (now - push.start).max(SHORTEST_PUSH)
            } else {
                push.duration
            };
            // Let go, the pointer no longer pulls: the last force stays.
            let (force, toward) = match force > 5.0 {
                true => ((force / 5.0).round() * 5.0, toward(grip.force)),
                false => (push.force, push.toward),
            };
            let changed = Push { duration: lasted, force, toward, ..push };
            commands.push(Command::Drag(Edit::Replace(place, Entry::Push(changed))));
        }
        if grip.phase == GripPhase::Released {
            if let Some(Entry::Push(push)) = self.hand.take().and_then(|place| state.document().entry(place)) {
                // Room for the answer.
                let room = ((push.end() + ANSWERED) * 10.0).ceil() / 10.0;
                if room > state.document().scenario.duration {
                    commands.push(Command::Drag(Edit::Duration(room)));
                }
            }
            commands.push(Command::Release);
        }
        commands
    }
}

/// A level force as an angle in space would turn with the character: it stays a vector.
fn toward(force: DVec3) -> Direction {
    let unit = force.normalize_or(DVec3::Z);
    Direction::Vector((unit * 100.0).round() / 100.0)
}

/// The clip's pose at a time.
pub fn pose(shown: &Shown, time: f64) -> crate::picture::NodeTransforms {
    let mut sampler = shown.rig.sampler(&shown.baked.clip);
    transforms_of_globals(&shown.rig, sampler.node_globals(time))
}

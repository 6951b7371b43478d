//! The window's program: what it does at every frame, and how it begins and ends.
//!
//! `logic` takes answers and moves the playhead, `ui` draws and carries out what the person did. No simulation and no file is touched on
//! this thread.

use super::audit_desk::{AuditDesk, AuditRequest};
use super::audit_view;
use super::author::Author;
use super::batch_desk::{BatchDesk, BatchRequest, Job, SweepToSave};
use super::command::{Command, View, pressed};
use super::dialogs::Dialogs;
use super::document::Edit;
use super::home::Home;
use super::measure::Measure;
use super::menu;
use super::state::{Asking, Purpose, State};
use super::viewport::{self, Viewport};
use super::worker::Wake;
use eframe::egui::{self, ThemePreference, ViewportCommand};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// s: after a longer wait the playhead does not make up for it.
const LONGEST_FRAME: f64 = 0.5;

/// The studio.
pub struct Studio {
    /// All that it knows.
    pub state: State,
    author: Author,
    /// The audit's desk.
    pub audit: AuditDesk,
    audit_viewport: Viewport,
    /// The batch's desk.
    pub batch: BatchDesk,
    sweep: Option<Box<SweepToSave>>,
    job: Option<Box<Job>>,
    dialogs: Dialogs,
    clock: Option<Instant>,
    theme: Option<Option<String>>,
    title: String,
    measure: Option<Measure>,
}

impl Studio {
    /// Begins in a window.
    pub fn new(context: &eframe::CreationContext, home: Home, open: Option<PathBuf>) -> Studio {
        if let Some(render) = &context.wgpu_render_state {
            viewport::install(render);
        }
        let ctx = context.egui_ctx.clone();
        let wake: Wake = Arc::new(move || ctx.request_repaint());
        Studio {
            state: State::new(Arc::clone(&wake), home, open),
            author: Author::default(),
            audit: AuditDesk::new(Arc::clone(&wake)),
            audit_viewport: Viewport::default(),
            batch: BatchDesk::new(wake),
            sweep: None,
            job: None,
            dialogs: Dialogs::default(),
            clock: None,
            theme: None,
            title: String::new(),
            measure: None,
        }
    }

    /// Measures itself and ends.
    pub fn measured(mut self, measure: Measure) -> Studio {
        self.measure = Some(measure);
        self
    }

    /// Whether anything is worked on beside the window.
    pub fn is_busy(&self) -> bool {
        self.state.is_busy() || self.audit.is_busy() || self.batch.is_busy()
    }

    fn audit_asks(&mut self, request: AuditRequest) {
        match request {
            AuditRequest::OpenDialog => self.state.asking = Some(Asking::File(Purpose::Clip)),
            AuditRequest::SaveDialog(name) => {
                self.state.suggested = name.file_name().map(|name| name.to_string_lossy().into_owned());
                self.state.asking = Some(Asking::File(Purpose::Corrected));
            }
            AuditRequest::Message(text) => self.state.say(text),
        }
    }

    fn batch_asks(&mut self, request: BatchRequest) {
        match request {
            BatchRequest::Open(scenario) => {
                self.state.apply(Command::Edit(Edit::Scenario(scenario)));
                self.state.apply(Command::View(View::Author));
                self.state.apply(Command::Seek(0.0));
            }
            BatchRequest::SaveSweep(sweep) => {
                self.state.suggested = Some(sweep.name());
                self.sweep = Some(sweep);
                self.state.asking = Some(Asking::File(Purpose::Sweep));
            }
            BatchRequest::BakeToFolder(job) => {
                self.job = Some(job);
                self.state.asking = Some(Asking::File(Purpose::Folder));
            }
        }
    }

    /// Files that were chosen for the other views.
    fn chosen(&mut self) {
        for (purpose, path) in std::mem::take(&mut self.state.chosen) {
            match purpose {
                Purpose::Clip => {
                    self.state.view = View::Audit;
                    self.audit_viewport.frame_next();
                    self.audit.open(path);
                }
                Purpose::Corrected => self.audit.save(path),
                Purpose::Sweep => {
                    if let Some(sweep) = self.sweep.take() {
                        self.state.write(sweep.outputs(&path));
                    }
                }
                Purpose::Folder => {
                    if let Some(job) = self.job.take() {
                        self.batch.bake_to(path, *job);
                    }
                }
                _ => {}
            }
        }
    }

    fn look(&mut self, ctx: &egui::Context) {
        if self.theme.as_ref() != Some(&self.state.remembered.theme) {
            self.theme = Some(self.state.remembered.theme.clone());
            ctx.set_theme(match self.state.remembered.theme.as_deref() {
                Some("dark") => ThemePreference::Dark,
                Some("light") => ThemePreference::Light,
                _ => ThemePreference::System,
            });
        }
        let mark = if self.state.history.is_unsaved() { "*" } else { "" };
        let title = format!("{}{mark} - Surefoot", self.state.document().scenario.title);
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Files that were dropped on the window, and the wish to close it.
    fn outside(&mut self, ctx: &egui::Context) {
        let dropped: Vec<PathBuf> =
            ctx.input(|input| input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect());
        for path in dropped {
            self.state.apply(Command::Open(path));
        }
        let wishes = ctx.input(|input| input.viewport().close_requested());
        if wishes && !self.state.closing {
            if self.state.history.is_unsaved() {
                ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            }
            self.state.apply(Command::Quit);
        }
        if self.state.closing && !wishes {
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
    }
}

impl eframe::App for Studio {
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        let passed = self.clock.map_or(0.0, |clock| clock.elapsed().as_secs_f64()).min(LONGEST_FRAME);
        self.clock = Some(Instant::now());
        self.state.tick(passed);
        self.audit.tick();
        self.batch.tick();
        self.chosen();
        self.outside(ctx);
        self.look(ctx);
        if let Some(measure) = &mut self.measure {
            measure.frame(ctx, &mut self.state);
        }
        let plays = match self.state.view {
            View::Author => self.state.playback.playing,
            View::Audit => self.audit.is_playing(),
            View::Batch => false,
        };
        if plays {
            ctx.request_repaint();
        } else if self.is_busy() {
            ctx.request_repaint_after_secs(0.05);
        } else if self.state.history.is_unsaved() {
            ctx.request_repaint_after_secs(1.0); // a copy is kept of what was done last
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let began = Instant::now();
        let mut commands = Vec::new();
        if self.state.asking.is_none() {
            commands.extend(pressed(ui.ctx(), self.state.view));
        }
        egui::Panel::top("menu").show(ui, |ui| commands.extend(menu::ui(ui, &self.state)));
        match self.state.view {
            View::Author => commands.extend(self.author.ui(ui, &self.state)),
            View::Audit => {
                let (audit, viewport) = (&mut self.audit, &mut self.audit_viewport);
                let requests = audit.ui(ui, &mut |ui, scene| audit_view::ui(ui, viewport, scene));
                requests.into_iter().for_each(|request| self.audit_asks(request));
            }
            View::Batch => {
                let requests = self.batch.ui(ui, self.state.document(), self.state.file.as_deref());
                requests.into_iter().for_each(|request| self.batch_asks(request));
            }
        }
        for command in commands {
            self.state.apply(command);
        }
        let ctx = ui.ctx().clone();
        self.dialogs.ui(&ctx, &mut self.state);
        if let Some(measure) = &mut self.measure {
            measure.drawn(began.elapsed());
        }
    }
}

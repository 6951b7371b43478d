//! What a person can ask of the studio, and the keys that ask it. Panels give commands; [`super::state`] carries them out.

use super::document::{Edit, Lane, Place};
use eframe::egui::{self, Key, KeyboardShortcut, Modifiers};
use std::path::PathBuf;

/// Something that a person asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Change the document, in a step of its own.
    Edit(Edit),
    /// Change it as a part of a drag, which is one step as a whole.
    Drag(Edit),
    /// The drag is over.
    Release,
    /// One step back.
    Undo,
    /// One step on again.
    Redo,
    /// This entry is meant from now on.
    Select(Option<Place>),
    /// A new entry at a time, or at the playhead.
    Add(Lane, Option<f64>),
    /// A mark at the playhead.
    Mark,
    /// The selected entry to the clipboard.
    Copy,
    /// That, and away with it.
    Cut,
    /// The clipboard's entry at the playhead.
    Paste,
    /// The selected entry once more, right behind itself.
    Duplicate,
    /// Away with the selected entry.
    Delete,
    /// Run, or stop.
    PlayPause,
    /// Go there, s.
    Seek(f64),
    /// By whole frames.
    Step(i32),
    /// Again from the start at the end, or not.
    ToggleLoop,
    /// Times the clip's own speed.
    Speed(f64),
    /// A new document.
    New,
    /// Choose a file to open.
    OpenDialog,
    /// Choose a rig.
    RigDialog,
    /// Choose a base clip.
    BaseDialog,
    /// Choose the mesh of the ground.
    GroundDialog,
    /// Open a file, whatever it is.
    Open(PathBuf),
    /// One of the examples inside of the program, by its number.
    Example(usize),
    /// Write which node is which bone beside the rig.
    WriteBones,
    /// Save, and ask where if that is not known.
    Save,
    /// Save elsewhere.
    SaveAs,
    /// Choose where the clip goes.
    ExportDialog,
    /// Show the keys.
    Keys,
    /// Another view.
    View(View),
    /// Show the plots, or not.
    TogglePlots,
    /// Light, dark, or `None` as the system.
    Theme(Option<bool>),
    /// End the program, after a question where something is unsaved.
    Quit,
}

/// The three views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// A scenario by hand.
    #[default]
    Author,
    /// A clip's faults.
    Audit,
    /// Variations.
    Batch,
}

impl View {
    /// From left to right, with what they are called and for.
    pub const ALL: [(View, &'static str, &'static str); 3] = [
        (View::Author, "Author", "place pushes, walks and balls on a timeline and see the reaction"),
        (
            View::Audit,
            "Audit",
            "find the footsteps of a clip that a balanced person would not have taken, and correct them",
        ),
        (View::Batch, "Batch", "vary values and compare what comes of them"),
    ];
}

/// A key and what it does.
pub struct Shortcut {
    /// What it does, for the list.
    pub what: &'static str,
    /// The key.
    pub key: KeyboardShortcut,
    /// What it asks for.
    pub command: Command,
    /// In the author's view only.
    pub author: bool,
}

const fn shortcut(what: &'static str, modifiers: Modifiers, key: Key, command: Command, author: bool) -> Shortcut {
    Shortcut { what, key: KeyboardShortcut::new(modifiers, key), command, author }
}

/// Every key, in the order of the list; where one key is a part of another with modifiers, the longer one is first.
pub fn shortcuts() -> Vec<Shortcut> {
    const NONE: Modifiers = Modifiers::NONE;
    const COMMAND: Modifiers = Modifiers::COMMAND;
    const BOTH: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);
    vec![
        shortcut("New", COMMAND, Key::N, Command::New, false),
        shortcut("Open...", COMMAND, Key::O, Command::OpenDialog, false),
        shortcut("Save as...", BOTH, Key::S, Command::SaveAs, true),
        shortcut("Save", COMMAND, Key::S, Command::Save, true),
        shortcut("Export the clip...", COMMAND, Key::E, Command::ExportDialog, true),
        shortcut("Quit", COMMAND, Key::Q, Command::Quit, false),
        shortcut("Redo", BOTH, Key::Z, Command::Redo, true),
        shortcut("Redo", COMMAND, Key::Y, Command::Redo, true),
        shortcut("Undo", COMMAND, Key::Z, Command::Undo, true),
        shortcut("Duplicate the entry", COMMAND, Key::D, Command::Duplicate, true),
        shortcut("Delete the entry", NONE, Key::Delete, Command::Delete, true),
        shortcut("Delete the entry", NONE, Key::Backspace, Command::Delete, true),
        shortcut("Add a push at the playhead", NONE, Key::P, Command::Add(Lane::Push, None), true),
        shortcut("Add a walk at the playhead", NONE, Key::W, Command::Add(Lane::Walk, None), true),
        shortcut("Mark the playhead", NONE, Key::M, Command::Mark, true),
        shortcut("Select nothing", NONE, Key::Escape, Command::Select(None), true),
        shortcut("Play or pause", NONE, Key::Space, Command::PlayPause, true),
        shortcut("Ten frames back", Modifiers::SHIFT, Key::ArrowLeft, Command::Step(-10), true),
        shortcut("Ten frames on", Modifiers::SHIFT, Key::ArrowRight, Command::Step(10), true),
        shortcut("A frame back", NONE, Key::ArrowLeft, Command::Step(-1), true),
        shortcut("A frame on", NONE, Key::ArrowRight, Command::Step(1), true),
        shortcut("To the start", NONE, Key::Home, Command::Seek(0.0), true),
        shortcut("To the end", NONE, Key::End, Command::Seek(f64::MAX), true),
        shortcut("Loop, or not", NONE, Key::L, Command::ToggleLoop, true),
        shortcut("Plots, or not", NONE, Key::G, Command::TogglePlots, true),
        shortcut("Author", COMMAND, Key::Num1, Command::View(View::Author), false),
        shortcut("Audit", COMMAND, Key::Num2, Command::View(View::Audit), false),
        shortcut("Batch", COMMAND, Key::Num3, Command::View(View::Batch), false),
        shortcut("This list", NONE, Key::F1, Command::Keys, false),
    ]
}

/// What the mouse and the keys of single views do: for the list only.
pub const BESIDES: [(&str, &str); 13] = [
    ("Cut, copy, paste the entry", "Ctrl+X, Ctrl+C, Ctrl+V"),
    ("Push the character", "drag it with the left button"),
    ("Look around, shift, come nearer", "right drag, Shift + right drag, wheel"),
    ("Frame the character; front, side, top", "F; 1, 3, 7"),
    ("New entry in a lane", "double click"),
    ("Move, stretch, strengthen an entry", "drag its middle, its end, its knob"),
    ("Without snapping", "Alt while dragging"),
    ("Direction and more of an entry", "right click"),
    ("Zoom and shift the timeline", "Ctrl + wheel, wheel or middle drag"),
    ("Next and previous flag (Audit)", "N, P"),
    ("Accept and reject its correction (Audit)", "A, R"),
    ("Larger, smaller, ordinary size", "Ctrl + plus, Ctrl + minus, Ctrl + 0"),
    ("Stop typing", "Escape"),
];

/// What the keys of this frame ask for. While text is typed only Ctrl keys do, and those that text has of its own do not.
pub fn pressed(ctx: &egui::Context, view: View) -> Vec<Command> {
    let typing = ctx.text_edit_focused();
    let mut commands = Vec::new();
    ctx.input_mut(|input| {
        for shortcut in shortcuts() {
            let texts_own = typing
                && (!shortcut.key.modifiers.command || matches!(shortcut.key.logical_key, Key::Z | Key::Y | Key::D));
            let elsewhere = shortcut.author && view != View::Author;
            if !texts_own && !elsewhere && input.consume_shortcut(&shortcut.key) {
                commands.push(shortcut.command);
            }
        }
        if !typing && view == View::Author {
            for event in &input.events {
                match event {
                    egui::Event::Copy => commands.push(Command::Copy),
                    egui::Event::Cut => commands.push(Command::Cut),
                    egui::Event::Paste(_) => commands.push(Command::Paste),
                    _ => {}
                }
            }
        }
    });
    commands
}

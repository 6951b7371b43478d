//! Title, duration and seed; the character and its style dials; the ground; the base clip; how the clip is baked.

use super::fields::{Number, changed, choice, dial, grid};
use crate::model::scenario::{Base, CEILING, Character, Ground, GroundKind, Style};
use crate::model::sweep::{BakeSettings, ENGINES};
use crate::rig::{Rig, clips};
use crate::studio::command::Command;
use crate::studio::document::{Document, Edit};
use eframe::egui;

/// Name, hint, value, what it is without a word, and how it is set.
type Dial<T> = (&'static str, &'static str, f64, f64, fn(&mut T, f64));
/// The same of style, where all are 0.5 without a word.
type StyleDial = (&'static str, &'static str, f64, fn(&mut Style, f64));

/// What the whole scenario is.
pub fn scene(ui: &mut egui::Ui, document: &Document, commands: &mut Vec<Command>) {
    let scenario = &document.scenario;
    grid(ui, "scene", |ui| {
        let label = ui.label("Title").on_hover_text("the clip is named after it");
        let mut title = scenario.title.clone();
        let field = egui::TextEdit::singleline(&mut title).char_limit(200).desired_width(150.0);
        let response = ui.add(field).labelled_by(label.id);
        changed(&response, title != scenario.title, commands, || Edit::Title(title.clone()));
        ui.end_row();
        let number = Number::new("Duration", 0.1..=600.0, "of the clip").unit("s", 0.02, 2);
        number.row(ui, scenario.duration, commands, Edit::Duration);
        let number = Number::new(
            "Seed",
            0.0..=1e6,
            "another seed, another of what is left to chance: balls, breathing, small differences",
        );
        number
            .unit("", 0.05, 0)
            .default(0.0)
            .row(ui, scenario.seed as f64, commands, |seed| Edit::Seed(seed.max(0.0) as u64));
    });
}

/// Body and dials.
pub fn character(ui: &mut egui::Ui, document: &Document, rig: Option<&Rig>, commands: &mut Vec<Command>) {
    let character = document.scenario.character;
    let default = Character::default();
    let with = |change: &dyn Fn(&mut Character)| {
        let mut changed = character;
        change(&mut changed);
        Edit::Character(changed)
    };
    grid(ui, "character", |ui| {
        let own = rig.map_or(80.0, |rig| (rig.body.mass * 10.0).round() / 10.0);
        let number =
            Number::new("Mass", 1.0..=2000.0, "a heavier body is moved less by the same push").unit("kg", 0.2, 1);
        number.default(own).row(ui, character.mass.unwrap_or(own), commands, |mass| {
            with(&|changed| changed.mass = ((mass - own).abs() > 1e-9).then_some(mass))
        });
        let number = Number::new("Legs", 0.25..=4.0, "times the length of the rig's").unit("×", 0.005, 2);
        number
            .default(default.leg_scale)
            .row(ui, character.leg_scale, commands, |value| with(&|changed| changed.leg_scale = value));
        let dials: [Dial<Character>; 3] = [
            (
                "Agility",
                "how fast it reacts and swings its feet: 0.5 an ordinary adult, 1 whatever balance takes",
                character.agility,
                default.agility,
                |changed, value| changed.agility = value,
            ),
            (
                "Crouch",
                "how low it stands all the time: 0.5 halves the leg's rest length",
                character.crouch,
                default.crouch,
                |changed, value| changed.crouch = value,
            ),
            (
                "Breathing",
                "breath and small unrest while it stands: 0.5 as in people, 0 none",
                character.breathing,
                default.breathing,
                |changed, value| changed.breathing = value,
            ),
        ];
        for (name, hint, value, default, set) in dials {
            dial(ui, (name, hint), (value, default), commands, |value| with(&|changed| set(changed, value)));
        }
    });
    ui.label("Style").on_hover_text("0.5 as found in people");
    let style = character.style;
    grid(ui, "style", |ui| {
        let dials: [StyleDial; 5] = [
            ("Step height", "how high the swinging foot goes", style.step_height, |style, value| {
                style.step_height = value
            }),
            ("Stance width", "how far apart the feet stand", style.stance_width, |style, value| {
                style.stance_width = value
            }),
            ("Readiness", "how soon it steps instead of swaying", style.readiness, |style, value| {
                style.readiness = value
            }),
            ("Recovery time", "how long it takes to stand comfortably again", style.recovery_time, |style, value| {
                style.recovery_time = value
            }),
            ("Arms", "how much the arms do for balance", style.arms, |style, value| style.arms = value),
        ];
        for (name, hint, value, set) in dials {
            dial(ui, (name, hint), (value, 0.5), commands, |value| with(&|changed| set(&mut changed.style, value)));
        }
    });
}

/// Its shape and friction.
pub fn ground(ui: &mut egui::Ui, document: &Document, commands: &mut Vec<Command>) {
    let ground = &document.scenario.ground;
    let kinds: [(&str, GroundKind); 6] = [
        ("flat", GroundKind::Flat),
        ("slope", GroundKind::Slope { angle: 8_f64.to_radians() }),
        ("stairs", GroundKind::Stairs { rise: 0.16, tread: 0.32, count: 8 }),
        ("uneven", GroundKind::Uneven { height: 0.08, wavelength: 1.5, seed: 1 }),
        ("gaps", GroundKind::Gaps { width: 0.2, spacing: 1.0 }),
        ("platform", GroundKind::Platform { pitch: vec![[0.5, 0.0], [2.0, 0.2], [3.5, 0.0]], roll: Vec::new() }),
    ];
    let mesh = match &ground.kind {
        GroundKind::Mesh { file, .. } => Some(file),
        _ => None,
    };
    // The choice shows the kind; its own numbers stay where the kind stays.
    let same = std::mem::discriminant(&ground.kind);
    let choices: Vec<(&str, GroundKind)> = kinds
        .into_iter()
        .map(|(name, kind)| (name, if std::mem::discriminant(&kind) == same { ground.kind.clone() } else { kind }))
        .chain(mesh.map(|_| ("mesh", ground.kind.clone())))
        .collect();
    let with = |kind: GroundKind| Edit::Ground(Ground { kind, ..ground.clone() });
    grid(ui, "ground", |ui| {
        choice(
            ui,
            ("Kind", "what it stands on; slopes, stairs and gaps run along its forward"),
            &ground.kind,
            &choices,
            commands,
            with,
        );
        match ground.kind.clone() {
            GroundKind::Flat | GroundKind::Platform { .. } => {}
            GroundKind::Slope { angle } => {
                let number = Number::new("Angle", -45.0..=45.0, "up is positive").unit("°", 0.2, 1);
                number.row(ui, angle.to_degrees(), commands, |value| {
                    with(GroundKind::Slope { angle: value.to_radians() })
                });
            }
            GroundKind::Stairs { rise, tread, count } => {
                let number = Number::new("Rise", -0.5..=0.5, "of a step; up is positive").unit("m", 0.002, 3);
                number.row(ui, rise, commands, |rise| with(GroundKind::Stairs { rise, tread, count }));
                let number = Number::new("Tread", 0.1..=5.0, "depth of a step").unit("m", 0.005, 3);
                number.row(ui, tread, commands, |tread| with(GroundKind::Stairs { rise, tread, count }));
                let number = Number::new("Steps", 1.0..=200.0, "how many").unit("", 0.05, 0);
                number.row(ui, f64::from(count), commands, |count| {
                    with(GroundKind::Stairs { rise, tread, count: count.max(1.0) as u32 })
                });
            }
            GroundKind::Uneven { height, wavelength, seed } => {
                let number = Number::new("Height", 0.0..=1.0, "crest over trough").unit("m", 0.002, 3);
                number.row(ui, height, commands, |height| with(GroundKind::Uneven { height, wavelength, seed }));
                let number = Number::new("Wavelength", 0.2..=100.0, "from crest to crest").unit("m", 0.01, 2);
                number
                    .row(ui, wavelength, commands, |wavelength| with(GroundKind::Uneven { height, wavelength, seed }));
                let number = Number::new("Ground seed", 0.0..=1e6, "another seed, another ground").unit("", 0.05, 0);
                number.row(ui, seed as f64, commands, |seed| {
                    with(GroundKind::Uneven { height, wavelength, seed: seed.max(0.0) as u64 })
                });
            }
            GroundKind::Mesh { file, ceiling, surface } => {
                let with = |ceiling| with(GroundKind::Mesh { file: file.clone(), ceiling, surface: surface.clone() });
                let hint = "faces that lie higher are no ground; automatic: 2 m where ground lies over other ground, else none";
                let choices = [("automatic", None), ("given", Some(ceiling.unwrap_or(CEILING)))];
                choice(ui, ("Ceiling", hint), &ceiling, &choices, commands, with);
                if let Some(height) = ceiling {
                    let number = Number::new("Ceiling height", 0.5..=100.0, "over the origin").unit("m", 0.02, 2);
                    number.row(ui, height, commands, |height| with(Some(height)));
                }
            }
            GroundKind::Gaps { width, spacing } => {
                let number = Number::new("Width", 0.01..=5.0, "of a gap").unit("m", 0.005, 3);
                number.row(ui, width, commands, |width| with(GroundKind::Gaps { width, spacing }));
                let number = Number::new("Spacing", 0.02..=100.0, "from gap to gap").unit("m", 0.01, 2);
                number.row(ui, spacing, commands, |spacing| with(GroundKind::Gaps { width, spacing }));
            }
        }
        let number = Number::new("Friction", 0.05..=10.0, "0.1 is ice, 0.8 rubber on concrete").unit("", 0.01, 2);
        number
            .default(1.0)
            .row(ui, ground.friction, commands, |friction| Edit::Ground(Ground { friction, ..ground.clone() }));
    });
    ui.horizontal(|ui| {
        if ui.button("Mesh...").on_hover_text("a level of your own: .glb or .gltf, metres, Y up").clicked() {
            commands.push(Command::GroundDialog);
        }
        mesh.map(|file| ui.weak(file));
    });
    if matches!(ground.kind, GroundKind::Platform { .. }) {
        ui.weak("its angles are set in the Platform lane of the timeline");
    }
}

/// The clip under the reaction.
pub fn base(ui: &mut egui::Ui, document: &Document, rig: Option<&Rig>, commands: &mut Vec<Command>) {
    ui.weak("the reaction starts from it, plays over it and returns to it");
    let base = document.scenario.base.as_ref();
    let names = rig.map(clips::clip_names).unwrap_or_default();
    let shown = match base {
        None => "none".to_owned(),
        Some(base) => base.clip.clone().or(base.file.clone()).unwrap_or_default(),
    };
    ui.horizontal(|ui| {
        let label = ui.label("Clip");
        let response = egui::ComboBox::from_id_salt("base clip").selected_text(&shown).width(140.0).show_ui(ui, |ui| {
            if ui.selectable_label(base.is_none(), "none").clicked() {
                commands.push(Command::Edit(Edit::Base(None)));
            }
            for name in &names {
                let own = base.is_some_and(|base| base.file.is_none() && base.clip.as_deref() == Some(name));
                if ui.selectable_label(own, name).clicked() {
                    let base = Base { clip: Some(name.clone()), file: None };
                    commands.push(Command::Edit(Edit::Base(Some(base))));
                }
            }
        });
        response.response.labelled_by(label.id);
        if ui.button("File...").on_hover_text("a motion file: .bvh, .fbx, .glb, .vrma").clicked() {
            commands.push(Command::BaseDialog);
        }
    });
    if let Some(file) = base.and_then(|base| base.file.as_ref()) {
        ui.weak(file);
    }
    if names.is_empty() {
        ui.weak("the rig has no clips of its own");
    }
}

/// As the flags of `surefoot bake`.
pub fn bake(ui: &mut egui::Ui, document: &Document, commands: &mut Vec<Command>) {
    let bake = &document.bake;
    grid(ui, "bake", |ui| {
        let drives = [("auto", "auto"), ("stepper", "stepper"), ("ragdoll", "ragdoll")];
        let hint =
            "who moves the body: the pendulum's path, joint torques and contacts, or what is more plausible of the two";
        choice(ui, ("Drive", hint), &bake.drive, &drives, commands, |drive| {
            Edit::Bake(BakeSettings { drive, ..bake.clone() })
        });
        let rates = [("24 fps", 24.0), ("25 fps", 25.0), ("30 fps", 30.0), ("60 fps", 60.0), ("120 fps", 120.0)];
        choice(ui, ("Rate", "keys a second"), &bake.fps, &rates, commands, |fps| {
            Edit::Bake(BakeSettings { fps, ..bake.clone() })
        });
        let roots = [("root node", "root"), ("hips", "hips"), ("in place", "in-place")];
        choice(ui, ("Travel", "where root motion goes"), &bake.root, &roots, commands, |root| {
            Edit::Bake(BakeSettings { root, ..bake.clone() })
        });
        for (name, hint, on, other) in [
            (
                "Props",
                "ground, boxes and balls into the file",
                bake.props,
                BakeSettings { props: !bake.props, ..bake.clone() },
            ),
            (
                "Loop",
                "only a cycle of it, without a seam",
                bake.looped,
                BakeSettings { looped: !bake.looped, ..bake.clone() },
            ),
        ] {
            let label = ui.label(name).on_hover_text(hint);
            let mut shown = on;
            if ui.checkbox(&mut shown, "").labelled_by(label.id).on_hover_text(hint).changed() {
                commands.push(Command::Edit(Edit::Bake(other)));
            }
            ui.end_row();
        }
    });
    ui.label("Helpers for engines").on_hover_text("scripts beside the clip that load it and its events");
    ui.horizontal_wrapped(|ui| {
        for engine in ENGINES {
            let mut on = bake.engines.contains(&engine);
            if ui.checkbox(&mut on, engine).changed() {
                let engines = ENGINES
                    .into_iter()
                    .filter(|other| if *other == engine { on } else { bake.engines.contains(other) });
                commands.push(Command::Edit(Edit::Bake(BakeSettings { engines: engines.collect(), ..bake.clone() })));
            }
        }
    });
}

//! The numbers of the selected entry, its direction and its bone.

use super::fields::{Number, changed, choice, grid};
use crate::model::Role;
use crate::model::scenario::{Direction, Feet};
use crate::studio::command::Command;
use crate::studio::compass::compass;
use crate::studio::document::{Edit, Entry, Place};
use crate::studio::strength::{direction, with_direction};
use eframe::egui;

/// Bones that are pushed as a rule, and what they are called.
const BONES: [(&str, Role); 14] = [
    ("head", Role::Head),
    ("neck", Role::Neck),
    ("upper chest", Role::UpperChest),
    ("chest", Role::Chest),
    ("spine", Role::Spine),
    ("hips", Role::Hips),
    ("left shoulder", Role::LeftShoulder),
    ("right shoulder", Role::RightShoulder),
    ("left hand", Role::LeftHand),
    ("right hand", Role::RightHand),
    ("left thigh", Role::LeftUpperLeg),
    ("right thigh", Role::RightUpperLeg),
    ("left shin", Role::LeftLowerLeg),
    ("right shin", Role::RightLowerLeg),
];

/// Draws them.
pub fn ui(ui: &mut egui::Ui, place: Place, entry: &Entry, duration: f64, commands: &mut Vec<Command>) {
    let replace = |entry: Entry| Edit::Replace(place, entry);
    grid(ui, "entry", |ui| {
        let start = Number::new("Start", 0.0..=duration, "when it begins").unit("s", 0.01, 3);
        start.row(ui, entry.start(), commands, |value| replace(entry.moved(value)));
        match entry {
            Entry::Walk(walk) => {
                length(ui, place, entry, walk.duration, commands);
                let number = Number::new("Speed", 0.0..=10.0, "how fast it walks; people walk at 1.2 to 1.5, 0 stops");
                number.unit("m/s", 0.01, 2).row(ui, walk.speed, commands, |speed| {
                    replace(Entry::Walk(crate::model::scenario::Walk { speed, ..*walk }))
                });
                let mut own = walk.facing.is_some();
                let label = ui
                    .label("Own facing")
                    .on_hover_text("the pelvis points elsewhere than it walks: sideways, backwards");
                ui.horizontal(|ui| {
                    let check = ui.checkbox(&mut own, "").labelled_by(label.id);
                    if check.changed() {
                        let facing = own.then_some(0.0);
                        commands.push(Command::Edit(replace(Entry::Walk(crate::model::scenario::Walk {
                            facing,
                            ..*walk
                        }))));
                    }
                });
                ui.end_row();
                if let Some(facing) = walk.facing {
                    degrees(ui, "Facing", "where the pelvis points", facing, commands, |facing| {
                        replace(Entry::Walk(crate::model::scenario::Walk { facing: Some(facing), ..*walk }))
                    });
                }
            }
            Entry::Turn(turn) => length(ui, place, entry, turn.duration, commands),
            Entry::Crouch(crouch) => {
                length(ui, place, entry, crouch.duration, commands);
                let number = Number::new("Amount", 0.0..=1.0, "how low: 0.5 halves the leg's rest length");
                number.row(ui, crouch.amount, commands, |amount| {
                    replace(Entry::Crouch(crate::model::scenario::Crouch { amount, ..*crouch }))
                });
            }
            Entry::Stand(stand) => {
                length(ui, place, entry, stand.duration, commands);
                let feet = [("both", Feet::Both), ("left", Feet::Left), ("right", Feet::Right)];
                choice(ui, ("On", "which feet carry"), &stand.on, &feet, commands, |on| {
                    replace(Entry::Stand(crate::model::scenario::Stand { on, ..*stand }))
                });
            }
            Entry::Push(push) | Entry::Pull(push) => {
                let is_push = matches!(entry, Entry::Push(_));
                let again = |push| replace(if is_push { Entry::Push(push) } else { Entry::Pull(push) });
                Number::new("Duration", 0.01..=600.0, "how long the force acts").unit("s", 0.01, 3).row(
                    ui,
                    push.duration,
                    commands,
                    |duration| again(crate::model::scenario::Push { duration, ..*push }),
                );
                Number::new("Force", 1.0..=20_000.0, "constant while it acts").unit("N", 2.0, 1).row(
                    ui,
                    push.force,
                    commands,
                    |force| again(crate::model::scenario::Push { force, ..*push }),
                );
                ui.label("Impulse").on_hover_text("force times duration: what decides how far it steps");
                ui.label(format!("{:.1} N s", push.impulse()));
                ui.end_row();
                bone(ui, push.at, commands, |at| again(crate::model::scenario::Push { at, ..*push }));
            }
            Entry::Throw(throw) => throw_rows(ui, throw, commands, &|throw| replace(Entry::Throw(throw))),
            Entry::Carry(carry) => carry_rows(ui, carry, duration, commands, &|carry| replace(Entry::Carry(carry))),
        }
    });
    if let Some(mut angle) = direction(entry) {
        let name = match entry {
            Entry::Throw(_) => "From",
            Entry::Walk(_) => "Heading",
            Entry::Turn(_) => "Facing",
            _ => "Toward",
        };
        ui.horizontal(|ui| {
            let response = compass(ui, name, &mut angle, 110.0);
            changed(&response, response.changed(), commands, || replace(with_direction(entry, angle)));
            ui.vertical(|ui| {
                ui.label(name);
                grid(ui, "direction", |ui| {
                    degrees(ui, "Angle", "0 front, 90 its left, -90 its right", angle, commands, |angle| {
                        replace(with_direction(entry, angle))
                    });
                });
            });
        });
    }
    if let Entry::Push(push) | Entry::Pull(push) = entry
        && let Direction::Vector(vector) = push.toward
    {
        ui.weak(format!("a direction in space: {:.2}, {:.2}, {:.2}", vector.x, vector.y, vector.z));
    }
}

/// A duration that may be left open.
fn length(ui: &mut egui::Ui, place: Place, entry: &Entry, duration: Option<f64>, commands: &mut Vec<Command>) {
    let label = ui.label("Ends").on_hover_text("by itself, or when the next entry of the lane begins");
    ui.horizontal(|ui| {
        let mut own = duration.is_some();
        let check = ui.checkbox(&mut own, "by itself").labelled_by(label.id);
        if check.changed() {
            let mut changed = entry.clone();
            let duration = own.then_some(1.0);
            match &mut changed {
                Entry::Walk(walk) => walk.duration = duration,
                Entry::Turn(turn) => turn.duration = duration,
                Entry::Crouch(crouch) => crouch.duration = duration,
                Entry::Stand(stand) => stand.duration = duration,
                _ => {}
            }
            commands.push(Command::Edit(Edit::Replace(place, changed)));
        }
    });
    ui.end_row();
    if let Some(duration) = duration {
        let number = Number::new("Duration", 0.01..=600.0, "how long it lasts").unit("s", 0.01, 3);
        number.row(ui, duration, commands, |value| Edit::Replace(place, entry.stretched(entry.start() + value)));
    }
}

fn degrees(
    ui: &mut egui::Ui,
    name: &str,
    hint: &str,
    angle: f64,
    commands: &mut Vec<Command>,
    edit: impl Fn(f64) -> Edit,
) {
    let shown = (angle.to_degrees() * 1e6).round() / 1e6;
    let number = Number::new(name, -360.0..=360.0, hint).unit("°", 1.0, 1);
    number.row(ui, shown, commands, |value| edit(value.to_radians()));
}

fn bone(ui: &mut egui::Ui, at: Role, commands: &mut Vec<Command>, edit: impl Fn(Role) -> Edit) {
    let mut bones: Vec<(&str, Role)> = BONES.into();
    if !bones.iter().any(|(_, role)| *role == at) {
        bones.push((at.name(), at));
    }
    choice(ui, ("At", "the bone that it acts on"), &at, &bones, commands, edit);
}

fn throw_rows(
    ui: &mut egui::Ui,
    throw: &crate::model::scenario::Throw,
    commands: &mut Vec<Command>,
    edit: &dyn Fn(crate::model::scenario::Throw) -> Edit,
) {
    use crate::model::scenario::Throw;
    let number = Number::new("Balls", 1.0..=200.0, "how many").unit("", 0.05, 0);
    number.row(ui, f64::from(throw.count), commands, |value| edit(Throw { count: value.max(1.0) as u32, ..*throw }));
    let number = Number::new("Interval", 0.01..=60.0, "between one ball and the next").unit("s", 0.01, 2);
    number.row(ui, throw.interval, commands, |interval| edit(Throw { interval, ..*throw }));
    let number = Number::new("Speed", 0.5..=60.0, "as they arrive").unit("m/s", 0.1, 1);
    number.row(ui, throw.speed, commands, |speed| edit(Throw { speed, ..*throw }));
    let number = Number::new("Least radius", 0.01..=1.0, "the seed draws each ball's between least and greatest");
    number
        .unit("m", 0.005, 3)
        .row(ui, throw.radius[0], commands, |low| edit(Throw { radius: [low, throw.radius[1].max(low)], ..*throw }));
    let number = Number::new("Greatest radius", 0.01..=1.0, "the seed draws each ball's between least and greatest");
    number
        .unit("m", 0.005, 3)
        .row(ui, throw.radius[1], commands, |high| edit(Throw { radius: [throw.radius[0].min(high), high], ..*throw }));
    let number = Number::new("Density", 1.0..=5000.0, "50 is light foam, 1000 water").unit("kg/m³", 1.0, 0);
    number.row(ui, throw.density, commands, |density| edit(Throw { density, ..*throw }));
    let number = Number::new("Spread", 0.0..=2.0, "how far from the bone they may be aimed").unit("m", 0.01, 2);
    number.row(ui, throw.spread, commands, |spread| edit(Throw { spread, ..*throw }));
    bone(ui, throw.at, commands, |at| edit(Throw { at, ..*throw }));
}

fn carry_rows(
    ui: &mut egui::Ui,
    carry: &crate::model::scenario::Carry,
    duration: f64,
    commands: &mut Vec<Command>,
    edit: &dyn Fn(crate::model::scenario::Carry) -> Edit,
) {
    use crate::model::scenario::Carry;
    let label = ui.label("Put away").on_hover_text("before the scenario ends");
    let mut own = carry.end.is_some();
    if ui.checkbox(&mut own, "").labelled_by(label.id).changed() {
        let end = own.then_some((carry.start + 2.0).min(duration));
        commands.push(Command::Edit(edit(Carry { end, ..carry.clone() })));
    }
    ui.end_row();
    if let Some(end) = carry.end {
        let number = Number::new("End", 0.0..=600.0, "when it is put away").unit("s", 0.01, 2);
        number.row(ui, end, commands, |end| edit(Carry { end: Some(end), ..carry.clone() }));
    }
    for (index, [time, kg]) in carry.mass.iter().copied().enumerate() {
        let name = if carry.mass.len() == 1 { "Mass".to_owned() } else { format!("Mass at {time:.2} s") };
        let number = Number::new(&name, 0.0..=200.0, "of the box").unit("kg", 0.1, 2);
        number.row(ui, kg, commands, |kg| {
            let mut changed = carry.clone();
            changed.mass[index][1] = kg;
            edit(changed)
        });
    }
    ui.label("Changes").on_hover_text("the mass goes in a straight line from point to point");
    ui.horizontal(|ui| {
        if ui.small_button("Add a point").clicked() {
            let mut changed = carry.clone();
            let last = changed.mass.last().copied().unwrap_or([carry.start, 5.0]);
            changed.mass.push([last[0] + 1.0, last[1] + 10.0]);
            commands.push(Command::Edit(edit(changed)));
        }
        if carry.mass.len() > 1 && ui.small_button("Remove the last").clicked() {
            let mut changed = carry.clone();
            changed.mass.pop();
            commands.push(Command::Edit(edit(changed)));
        }
    });
    ui.end_row();
    for (index, (time, size)) in carry.size.iter().enumerate() {
        for (axis, name) in ["Across", "Up", "Forward"].into_iter().enumerate() {
            let name = if carry.size.len() == 1 { name.to_owned() } else { format!("{name} at {time:.2} s") };
            let number = Number::new(&name, 0.05..=2.0, "size of the box").unit("m", 0.01, 2);
            number.row(ui, size[axis], commands, |value| {
                let mut changed = carry.clone();
                changed.size[index].1[axis] = value;
                edit(changed)
            });
        }
    }
    ui.label("Grows").on_hover_text("the size goes in a straight line from point to point");
    ui.horizontal(|ui| {
        if ui.small_button("Add a size").clicked() {
            let mut changed = carry.clone();
            let (time, size) = changed.size.last().copied().unwrap_or((carry.start, glam::DVec3::splat(0.3)));
            changed.size.push((time + 1.0, size));
            commands.push(Command::Edit(edit(changed)));
        }
        if carry.size.len() > 1 && ui.small_button("Remove the last size").clicked() {
            let mut changed = carry.clone();
            changed.size.pop();
            commands.push(Command::Edit(edit(changed)));
        }
    });
    ui.end_row();
}

//! What the clip says of itself under the lanes: contacts of each foot, faults, events. Read only; a click goes there. Times s.

use super::{HEAD, row};
use crate::bake::Baked;
use crate::model::Side;
use crate::model::report::Part;
use crate::picture::figure::side_color;
use crate::studio::command::Command;
use crate::studio::simulate::Shown;
use crate::studio::time_map::TimeMap;
use eframe::egui::{self, Align2, Color32, FontId, Rect, Sense, Stroke, pos2, vec2};

/// Height of a track.
const TRACK: f32 = 17.0;
/// m, a zero-moment point that is farther out of the support is flagged.
const OUT: f64 = 0.03;
/// mm, a contact that slips by more is flagged.
const SLIP: f64 = 2.0;

/// A stretch of the clip that is not as it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
    /// For a person.
    pub why: String,
}

/// Draws the tracks; fainter where the clip is older than the document.
pub fn ui(ui: &mut egui::Ui, map: &TimeMap, shown: Option<&Shown>, fresh: bool, commands: &mut Vec<Command>) {
    let strength = if fresh { 1.0 } else { 0.5 };
    let Some(shown) = shown else { return };
    let report = &shown.baked.report;
    ui.add_space(3.0);
    for side in [Side::Left, Side::Right] {
        let name = if side == Side::Left { "Left foot" } else { "Right foot" };
        let [r, g, b] = side_color(side);
        let color = Color32::from_rgb(r, g, b).gamma_multiply(strength);
        let bars = report.contacts.iter().filter(|contact| contact.foot == side).map(|contact| {
            let (part, share) = match contact.part {
                Part::Flat => ("flat", 1.0),
                Part::Heel => ("heel", 0.5),
                Part::Ball => ("ball", 0.65),
            };
            let why = format!(
                "{} foot {part}, {:.3} to {:.3} s, slips {:.1} mm",
                if side == Side::Left { "left" } else { "right" },
                contact.start,
                contact.end,
                contact.slip_mm
            );
            (contact.start, contact.end, color.gamma_multiply(share), why)
        });
        track(ui, map, name, bars.collect(), commands);
    }
    let color = Color32::from_rgb(230, 150, 30).gamma_multiply(strength);
    let flags = faults(&shown.baked).into_iter().map(|fault| (fault.start, fault.end, color, fault.why));
    track(ui, map, "Flags", flags.collect(), commands);
    events(ui, map, shown, strength, commands);
}

/// A row of bars with words on hover.
fn track(
    ui: &mut egui::Ui,
    map: &TimeMap,
    name: &str,
    bars: Vec<(f64, f64, Color32, String)>,
    commands: &mut Vec<Command>,
) {
    let space = named(ui, name);
    let painter = ui.painter().with_clip_rect(space);
    for (index, (start, end, color, why)) in bars.into_iter().enumerate() {
        let (left, right) = (map.x(start), map.x(end));
        let bar = Rect::from_x_y_ranges(left..=right.max(left + 2.0), space.top() + 3.0..=space.bottom() - 3.0);
        if !bar.intersects(space) {
            continue;
        }
        painter.rect_filled(bar, 2.0, color);
        let response = ui.interact(bar.intersect(space), ui.scope_id().with((name, index)), Sense::click());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, why.clone()));
        if response.clicked() {
            commands.push(Command::Seek(start));
        }
        response.on_hover_text(why);
    }
}

fn events(ui: &mut egui::Ui, map: &TimeMap, shown: &Shown, strength: f32, commands: &mut Vec<Command>) {
    let space = named(ui, "Events");
    let painter = ui.painter().with_clip_rect(space);
    let color = ui.visuals().text_color().gamma_multiply(strength);
    for (index, event) in shown.baked.report.events.iter().enumerate() {
        let x = map.x(event.time);
        let at = pos2(x, space.center().y);
        if !space.contains(at) {
            continue;
        }
        let lost = event.name == "balance_lost";
        let color = if lost { ui.visuals().error_fg_color } else { color };
        let diamond = vec![at - vec2(0.0, 5.0), at + vec2(4.0, 0.0), at + vec2(0.0, 5.0), at - vec2(4.0, 0.0)];
        painter.add(egui::Shape::convex_polygon(diamond, color, Stroke::NONE));
        let foot = event.foot.map_or("", |side| if side == Side::Left { " left" } else { " right" });
        let text = format!("{}{foot} at {:.3} s", event.name, event.time);
        let hit = Rect::from_center_size(at, vec2(8.0, 12.0));
        let response = ui.interact(hit, ui.scope_id().with(("event", index)), Sense::click());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, text.clone()));
        if response.clicked() {
            commands.push(Command::Seek(event.time));
        }
        response.on_hover_text(text);
    }
}

/// The next row with a name; gives the space of its times.
fn named(ui: &mut egui::Ui, name: &str) -> Rect {
    let row = row(ui, TRACK);
    let at = pos2(row.left() + 8.0, row.center().y);
    ui.painter().text(at, Align2::LEFT_CENTER, name, FontId::proportional(11.0), ui.visuals().weak_text_color());
    Rect::from_min_max(pos2(row.left() + HEAD, row.top()), row.max)
}

/// Where the clip is not as it should be: slips, a zero-moment point far out of the support, pops, limits of joints.
pub fn faults(baked: &Baked) -> Vec<Fault> {
    let mut faults: Vec<Fault> = Vec::new();
    for contact in baked.report.contacts.iter().filter(|contact| contact.slip_mm > SLIP) {
        let why = format!("the foot slips by {:.1} mm while it is held", contact.slip_mm);
        faults.push(Fault { start: contact.start, end: contact.end, why });
    }
    let Some(findings) = &baked.findings else { return faults };
    let dt = baked.clip.duration / (findings.zmp_distances.len().max(2) - 1) as f64;
    let mut open: Option<(usize, usize, f64)> = None;
    for (index, out) in findings.zmp_distances.iter().chain([&None]).enumerate() {
        match (out.filter(|out| *out > OUT), open) {
            (Some(out), Some((start, _, most))) => open = Some((start, index, out.max(most))),
            (Some(out), None) => open = Some((index, index, out)),
            (None, Some((start, end, most))) => {
                let why = format!("balance: the zero-moment point is up to {:.0} cm outside of the feet", most * 100.0);
                faults.push(Fault { start: start as f64 * dt, end: end as f64 * dt, why });
                open = None;
            }
            (None, None) => {}
        }
    }
    for pop in &findings.joints.pops {
        let why = format!("{} jerks by {:.0} degrees in a frame", pop.role.name(), pop.step.to_degrees());
        faults.push(Fault { start: pop.time, end: pop.time + 1.0 / baked.clip.fps.max(1.0), why });
    }
    faults.sort_by(|a, b| a.start.total_cmp(&b.start));
    faults
}

//! The list of what was found: a filter by rule, what is wrong with the whole clip, flags by time, and where nothing is said.

use super::colors;
use super::repairs::Decision;
use super::shown::Shown;
use super::state::{Command, State};
use crate::model::findings::{Flag, Rule};
use eframe::egui::{
    self, Align2, Color32, CornerRadius, FontId, Rect, Role, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

/// Draws it.
pub fn flags_list(ui: &mut Ui, state: &State, shown: &Shown, commands: &mut Vec<Command>) {
    let found = &shown.before.findings;
    ui.add_space(4.0);
    let count = found.flags.len() + found.clip_flags.len();
    ui.strong(match count {
        0 => "No flags".to_owned(),
        1 => "1 flag".to_owned(),
        _ => format!("{count} flags"),
    });
    filter(ui, state, commands);
    ui.separator();
    ScrollArea::vertical().id_salt("audit_flag_rows").auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 4.0;
        for flag in &found.clip_flags {
            clip_row(ui, flag.rule, &flag.why);
        }
        for index in state.listed() {
            row(ui, state, shown, index, commands);
        }
        if count == 0 {
            ui.label("Nothing in this clip is beyond what a balanced person does.");
        }
        silences(ui, shown, commands);
        for note in &found.notes {
            ui.weak(note);
        }
        for note in shown.after.iter().flat_map(|after| &after.notes).filter(|note| !note.contains("--")) {
            ui.weak(note);
        }
    });
}

fn filter(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        for rule in Rule::ALL {
            let count = state.flags().iter().filter(|flag| flag.rule == rule).count();
            if count == 0 {
                continue;
            }
            let listed = !state.hidden.contains(&rule);
            if chip(ui, rule, &format!("{} {count}", colors::title(rule)), listed) {
                commands.push(Command::Toggle(rule));
            }
        }
    });
}

/// A rule to list or not.
fn chip(ui: &mut Ui, rule: Rule, name: &str, listed: bool) -> bool {
    let color = colors::rule(rule, ui.visuals());
    let ink = if listed { ui.visuals().strong_text_color() } else { ui.visuals().weak_text_color() };
    let text = ui.painter().layout_no_wrap(name.to_owned(), small(ui), ink);
    let (rect, response) = ui.allocate_exact_size(text.size() + vec2(24.0, 7.0), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, listed, name));
    let fill = if listed { color.gamma_multiply(0.22) } else { ui.visuals().faint_bg_color };
    let line = if response.hovered() || response.has_focus() { color } else { Color32::TRANSPARENT };
    ui.painter().rect(rect, 4.0, fill, egui::Stroke::new(1.0, line), egui::StrokeKind::Inside);
    let dot = rect.left_center() + vec2(10.0, 0.0);
    match listed {
        true => ui.painter().circle_filled(dot, 4.0, color),
        false => ui.painter().circle_stroke(dot, 3.5, egui::Stroke::new(1.0, color)),
    };
    ui.painter().galley(rect.min + vec2(18.0, 3.5), text, ink);
    response.on_hover_text(if listed { "Click to list these no more" } else { "Click to list these" }).clicked()
}

/// A little larger than the smallest text.
fn small(ui: &Ui) -> FontId {
    let font = TextStyle::Small.resolve(ui.style());
    FontId { size: 1.15 * font.size, ..font }
}

/// What is wrong with the clip as a whole.
fn clip_row(ui: &mut Ui, rule: Rule, why: &str) {
    let color = colors::rule(rule, ui.visuals());
    egui::Frame::new().fill(color.gamma_multiply(0.12)).inner_margin(6.0).corner_radius(4.0).show(ui, |ui| {
        ui.colored_label(color, format!("{} · the whole clip", colors::title(rule)));
        ui.label(why);
        if rule == Rule::Timing {
            ui.weak("Not corrected here: `surefoot correct --retime` gives the clip another frame rate.");
        }
        ui.take_available_width();
    });
}

/// What became of a flag, and its colour.
pub fn fate(state: &State, shown: &Shown, flag: &Flag, ui: &Ui) -> (&'static str, Color32) {
    let visuals = ui.visuals();
    let repairs = state.now();
    if let Some(repair) = repairs.and_then(|repairs| repairs.list.get(repairs.of_flag(flag)?)) {
        return (colors::word(repair.decision), colors::decision(repair.decision, visuals));
    }
    match &shown.after {
        None => ("…", visuals.weak_text_color()),
        Some(after) => {
            let same = |other: &Flag| crate::correct::Target::of(other).meets(&crate::correct::Target::of(flag));
            if after.motion.findings.flags.iter().any(same) {
                ("no correction found", visuals.warn_fg_color)
            } else {
                ("mended with another", colors::decision(Decision::Pending, visuals))
            }
        }
    }
}

fn row(ui: &mut Ui, state: &State, shown: &Shown, index: usize, commands: &mut Vec<Command>) {
    let flag = &shown.before.findings.flags[index];
    let selected = state.flag == Some(index);
    let (fate, fate_color) = fate(state, shown, flag, ui);
    let color = colors::rule(flag.rule, ui.visuals());
    let (body, small) = (TextStyle::Body.resolve(ui.style()), small(ui));
    let (strong, weak) = (ui.visuals().strong_text_color(), ui.visuals().weak_text_color());
    let width = ui.available_width();
    let why = ui.painter().layout(flag.why.clone(), small.clone(), ui.visuals().text_color(), width - 22.0);
    let line = ui.text_style_height(&TextStyle::Body);
    let height = line + 1.15 * ui.text_style_height(&TextStyle::Small) + why.size().y + 15.0;
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, selected, spoken(flag, fate)));
    if selected && response.rect.height() > 0.0 && state.flag != seen(ui) {
        response.scroll_to_me(None);
        ui.data_mut(|data| data.insert_temp(egui::Id::unique("audit_flag_seen"), state.flag));
    }
    if response.clicked() {
        commands.push(Command::Flag(index));
    }
    if !ui.is_rect_visible(rect) {
        return;
    }
    let painter = ui.painter();
    let fill = if selected {
        color.gamma_multiply(0.22)
    } else if response.hovered() {
        ui.visuals().widgets.hovered.weak_bg_fill
    } else {
        ui.visuals().faint_bg_color
    };
    painter.rect_filled(rect, 4.0, fill);
    let bar = Rect::from_min_size(rect.min, vec2(4.0, height));
    painter.rect_filled(bar, CornerRadius { nw: 4, sw: 4, ne: 0, se: 0 }, color);
    let (left, right) = (rect.left() + 12.0, rect.right() - 8.0);
    let name = colors::title(flag.rule).to_owned() + &flag.foot.map(|foot| format!(" · {foot}")).unwrap_or_default();
    painter.text(pos2(left, rect.top() + 4.0), Align2::LEFT_TOP, name, body.clone(), strong);
    painter.text(pos2(right, rect.top() + 4.0), Align2::RIGHT_TOP, amount(flag), body, color);
    let second = rect.top() + 5.0 + line;
    painter.text(pos2(left, second), Align2::LEFT_TOP, frames(flag), small.clone(), weak);
    painter.text(pos2(right, second), Align2::RIGHT_TOP, fate, small, fate_color);
    let third = rect.bottom() - why.size().y - 5.0;
    painter.galley(pos2(left, third), why, strong);
}

fn seen(ui: &Ui) -> Option<usize> {
    ui.data(|data| data.get_temp::<Option<usize>>(egui::Id::unique("audit_flag_seen"))).flatten()
}

/// Where the pendulum does not apply.
fn silences(ui: &mut Ui, shown: &Shown, commands: &mut Vec<Command>) {
    let found = &shown.before.findings;
    if found.abstained.is_empty() {
        return;
    }
    ui.add_space(4.0);
    ui.weak("Not judged");
    for span in &found.abstained {
        let text = format!("frames {}–{}: {}", span.start, span.end, span.why);
        if ui.add(egui::Label::new(egui::RichText::new(text).small()).sense(Sense::click())).clicked() {
            commands.push(Command::Seek(span.start as f64 / found.fps));
        }
    }
}

/// "12.3 cm".
pub fn amount(flag: &Flag) -> String {
    format!("{:.1} cm", 100.0 * flag.delta_m)
}

/// "frames 12–15".
pub fn frames(flag: &Flag) -> String {
    if flag.start == flag.end {
        format!("frame {}", flag.start)
    } else {
        format!("frames {}–{}", flag.start, flag.end)
    }
}

/// For a screen reader.
fn spoken(flag: &Flag, fate: &str) -> String {
    let foot = flag.foot.map(|foot| format!(", {foot} foot")).unwrap_or_default();
    format!("{}{foot}, {}, {}, {fate}: {}", colors::title(flag.rule), frames(flag), amount(flag), flag.why)
}

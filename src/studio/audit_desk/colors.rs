//! Colours of rules, feet and decisions, on light and on dark ground; names of rules for people.

use super::repairs::Decision;
use crate::model::Side;
use crate::model::findings::Rule;
use eframe::egui::{Color32, Visuals};

/// Of a rule.
pub fn rule(rule: Rule, visuals: &Visuals) -> Color32 {
    let (light, dark) = match rule {
        Rule::FootPlacement => (0x2f5fd0, 0x6f9bff),
        Rule::Balance => (0xb0249c, 0xe06ad0),
        Rule::FootSlide => (0xc9650c, 0xf59a45),
        Rule::Penetration => (0xb3261e, 0xf2726a),
        Rule::Float => (0x0b8a8f, 0x3cc4c9),
        Rule::Ballistic => (0x6a3fc4, 0xa98bf5),
        Rule::Timing => (0x7a6a12, 0xcbb64a),
        Rule::Drift => (0x4c7a1d, 0x93c94f),
    };
    hex(if visuals.dark_mode { dark } else { light })
}

/// Of a foot, as in the other pictures.
pub fn foot(side: Side, visuals: &Visuals) -> Color32 {
    let (light, dark) = match side {
        Side::Left => (0x2468e8, 0x6ea0ff),
        Side::Right => (0x0c9454, 0x3fc98a),
    };
    hex(if visuals.dark_mode { dark } else { light })
}

/// Of what a person decided.
pub fn decision(decision: Decision, visuals: &Visuals) -> Color32 {
    let (light, dark) = match decision {
        Decision::Pending => (0x6b7280, 0xa3abb8),
        Decision::Accepted => (0x15803d, 0x4ade80),
        Decision::Rejected => (0xb3261e, 0xf2726a),
    };
    hex(if visuals.dark_mode { dark } else { light })
}

/// For a person.
pub fn title(rule: Rule) -> &'static str {
    match rule {
        Rule::FootPlacement => "Foot placement",
        Rule::Balance => "Balance",
        Rule::FootSlide => "Foot slide",
        Rule::Penetration => "Penetration",
        Rule::Float => "Float",
        Rule::Ballistic => "Ballistic",
        Rule::Timing => "Timing",
        Rule::Drift => "Drift",
    }
}

/// For a person.
pub fn word(decision: Decision) -> &'static str {
    match decision {
        Decision::Pending => "to decide",
        Decision::Accepted => "accepted",
        Decision::Rejected => "rejected",
    }
}

fn hex(rgb: u32) -> Color32 {
    let [_, red, green, blue] = rgb.to_be_bytes();
    Color32::from_rgb(red, green, blue)
}

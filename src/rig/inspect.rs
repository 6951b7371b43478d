//! What a rig is, for a person and as JSON. The fields of the JSON are fixed by the command line's `inspect --json`.

use super::Rig;
use crate::model::{Role, Side};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// `{ height_m, mass_kg, up, forward, units_to_metres, confidence, method, bones, legs, feet, warnings }`.
pub fn inspect_json(rig: &Rig) -> Value {
    let body = &rig.body;
    let mut bones = Map::new();
    for (role, node) in &rig.mapping.bones {
        bones.insert(role.name().to_owned(), node_name(rig, *node));
    }
    let (mut legs, mut feet) = (Map::new(), Map::new());
    for side in Side::BOTH {
        let leg = leg_of(rig, side);
        legs.insert(
            side_name(side).to_owned(),
            json!({ "thigh_m": round(leg[0]), "shank_m": round(leg[1]), "length_m": round(leg[0] + leg[1]) }),
        );
        let foot = &body.feet[side as usize];
        let mut entry = Map::new();
        for (name, value) in [
            ("ankle_height_m", foot.ankle_height),
            ("length_m", foot.tip - foot.heel),
            ("heel_m", foot.heel),
            ("ball_m", foot.ball),
            ("tip_m", foot.tip),
            ("width_m", foot.half_width * 2.0),
        ] {
            entry.insert(name.to_owned(), json!(round(value)));
        }
        entry.insert("toes".to_owned(), json!(foot.toe.is_some()));
        feet.insert(side_name(side).to_owned(), Value::Object(entry));
    }
    json!({
        "height_m": round(body.height),
        "mass_kg": round(body.mass),
        "up": rig.mapping.up,
        "forward": rig.mapping.forward,
        "units_to_metres": round_to(1.0 / rig.document_from_scenario.scale, 1e9),
        "confidence": round_to(rig.mapping.confidence, 1e2),
        "method": rig.mapping.method,
        "bones": bones,
        "legs": legs,
        "feet": feet,
        "warnings": rig.mapping.warnings,
    })
}

/// The same as lines of text.
pub fn inspect_text(rig: &Rig) -> String {
    let body = &rig.body;
    let mut text = String::new();
    let mut line = |args: std::fmt::Arguments| {
        let _ = text.write_fmt(args); // Writing to a String cannot fail.
        text.push('\n');
    };
    line(format_args!("height      {:.3} m", body.height));
    line(format_args!("mass        {:.1} kg", body.mass));
    line(format_args!(
        "axes        {} up, {} forward, {} m a unit",
        rig.mapping.up,
        rig.mapping.forward,
        round_to(1.0 / rig.document_from_scenario.scale, 1e9)
    ));
    line(format_args!("bones from  {} (confidence {:.2})", rig.mapping.method, rig.mapping.confidence));
    for side in Side::BOTH {
        let (leg, foot) = (leg_of(rig, side), &body.feet[side as usize]);
        line(format_args!(
            "{:<5} leg   thigh {:.3} m, shank {:.3} m; foot {:.3} m long, {:.3} m wide, ankle {:.3} m up{}",
            side_name(side),
            leg[0],
            leg[1],
            foot.tip - foot.heel,
            foot.half_width * 2.0,
            foot.ankle_height,
            if foot.toe.is_some() { "" } else { ", no toe joint" }
        ));
    }
    for role in Role::ALL {
        if let Some(node) = rig.mapping.bones.get(role) {
            line(format_args!("  {:<26} {}", role.name(), shown(&node_name(rig, *node))));
        }
    }
    for warning in &rig.mapping.warnings {
        line(format_args!("warning: {warning}"));
    }
    text
}

/// Thigh and shank, m.
fn leg_of(rig: &Rig, side: Side) -> [f64; 2] {
    let roles = match side {
        Side::Left => [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot],
        Side::Right => [Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot],
    };
    let at = roles.map(|role| rig.body.joint(role).map(|joint| rig.body.joints[joint].rest));
    match at {
        [Some(hip), Some(knee), Some(ankle)] => [hip.distance(knee), knee.distance(ankle)],
        _ => [0.0, 0.0],
    }
}

/// The node's name; its index where it has none or where another node has the same.
fn node_name(rig: &Rig, node: usize) -> Value {
    match &rig.nodes[node].name {
        Some(name) if rig.nodes.iter().filter(|other| other.name.as_deref() == Some(name)).count() == 1 => json!(name),
        _ => json!(node),
    }
}

fn shown(name: &Value) -> String {
    name.as_str().map_or_else(|| format!("node {name}"), str::to_owned)
}

fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}

fn round(value: f64) -> f64 {
    round_to(value, 1e4)
}

fn round_to(value: f64, steps: f64) -> f64 {
    (value * steps).round() / steps
}

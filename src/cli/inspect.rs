//! `surefoot inspect`: what was found in a rig.

use super::args::InspectArgs;
use super::exit_code::{Exit, Failure};
use super::{parts, resolve, say, tell};
use crate::model::{Role, Side};
use crate::rig::Rig;

/// Inspects.
pub fn run(args: &InspectArgs) -> Result<Exit, Failure> {
    let rig = resolve::rig(&args.rig)?.rig;
    if args.json {
        say(&format!("{}\n", parts::inspect_json(&rig)?))?;
        return Ok(Exit::Done);
    }
    say(&table(&rig, &args.rig.display().to_string()))?;
    for warning in &rig.mapping.warnings {
        tell(&format!("warning: {warning}"));
    }
    Ok(Exit::Done)
}

/// The findings for a person.
fn table(rig: &Rig, name: &str) -> String {
    let mut text = String::new();
    let mut line = |label: &str, what: std::fmt::Arguments| {
        text += &format!("{label:<11}{what}\n");
    };
    let (body, mapping) = (&rig.body, &rig.mapping);
    line("rig", format_args!("{name}"));
    line("mapped by", format_args!("{} (confidence {:.2})", mapping.method, mapping.confidence));
    line("size", format_args!("{:.3} m, {:.1} kg, leg {:.3} m", body.height, body.mass, body.leg_length));
    let per_metre = rig.document_from_scenario.scale;
    line("axes", format_args!("up {}, forward {}, {per_metre:.4} units a metre", mapping.up, mapping.forward));
    for side in Side::BOTH {
        let foot = &body.feet[side as usize];
        line(
            match side {
                Side::Left => "left foot",
                Side::Right => "right foot",
            },
            format_args!(
                "{:.1} cm long, {:.1} cm wide, ankle {:.1} cm high, {}",
                (foot.tip - foot.heel) * 100.0,
                foot.half_width * 200.0,
                foot.ankle_height * 100.0,
                if foot.toe.is_some() { "toes bend" } else { "no toe joint" }
            ),
        );
    }
    for (index, (role, node)) in mapping.bones.iter().enumerate() {
        line(if index == 0 { "bones" } else { "" }, format_args!("{:<24} {}", role.name(), node_name(rig, *node)));
    }
    let made: Vec<&str> = body
        .joints
        .iter()
        .zip(&rig.joint_nodes)
        .filter(|(_, node)| node.is_none())
        .map(|(joint, _)| Role::name(joint.role))
        .collect();
    if !made.is_empty() {
        line("made up", format_args!("{}", made.join(", ")));
    }
    let clips = rig.document.json.get("animations").and_then(|clips| clips.as_array()).map_or(0, Vec::len);
    line("clips", format_args!("{clips}"));
    text
}

fn node_name(rig: &Rig, node: usize) -> String {
    match rig.nodes.get(node).and_then(|node| node.name.as_deref()) {
        Some(name) => format!("{name} (node {node})"),
        None => format!("node {node}"),
    }
}

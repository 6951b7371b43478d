//! The tables of a scenario of which there is one each: character, ground, stepper, base clip.

use super::scenario::{Base, Character, Ground, GroundKind, Stepper, Style, SupportModel, Trigger};
use super::scenario_reader::Reader;

/// `[character]`.
pub(super) fn character(mut table: Reader<'_, '_>) -> Character {
    let default = Character::default();
    let dial = |table: &mut Reader<'_, '_>, key| table.number(key).unwrap_or(0.5);
    let character = Character {
        mass: table.number("mass"),
        leg_scale: table.number("leg_scale").unwrap_or(default.leg_scale),
        crouch: table.number("crouch").unwrap_or(default.crouch),
        agility: table.number("agility").unwrap_or(default.agility),
        breathing: table.number("breathing").unwrap_or(default.breathing),
        style: Style {
            step_height: dial(&mut table, "step_height"),
            stance_width: dial(&mut table, "stance_width"),
            readiness: dial(&mut table, "readiness"),
            recovery_time: dial(&mut table, "recovery_time"),
            arms: dial(&mut table, "arms"),
        },
    };
    table.finish();
    character
}

/// `[ground]`.
pub(super) fn ground(mut table: Reader<'_, '_>) -> Ground {
    let kinds = ["flat", "slope", "stairs", "uneven", "gaps", "platform", "mesh"].map(|kind| (kind, kind));
    let kind = match table.choice("kind", &kinds).unwrap_or("flat") {
        "slope" => GroundKind::Slope { angle: table.required_number("angle").to_radians() },
        "stairs" => GroundKind::Stairs {
            rise: table.required_number("rise"),
            tread: table.required_number("tread"),
            count: table.count("count").unwrap_or(10),
        },
        "uneven" => GroundKind::Uneven {
            height: table.required_number("height"),
            wavelength: table.required_number("wavelength"),
            seed: table.whole("seed").unwrap_or(0),
        },
        "gaps" => GroundKind::Gaps { width: table.required_number("width"), spacing: table.required_number("spacing") },
        "platform" => {
            let in_radians = |points: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
                points.into_iter().map(|[time, angle]| [time, angle.to_radians()]).collect()
            };
            GroundKind::Platform {
                pitch: table.points("pitch").map(in_radians).unwrap_or_default(),
                roll: table.points("roll").map(in_radians).unwrap_or_default(),
            }
        }
        "mesh" => {
            let file = table.string("file");
            if file.is_none() && table.peek("file").is_none() {
                table.missing("file", "name a .glb or .gltf beside the scenario, as in `file = \"level.glb\"`");
            }
            GroundKind::Mesh { file: file.unwrap_or_default(), ceiling: table.number("ceiling"), surface: None }
        }
        _ => GroundKind::Flat,
    };
    let friction = table.number("friction").unwrap_or(1.0);
    table.finish();
    Ground { kind, friction }
}

/// `[stepper]`.
pub(super) fn stepper(mut table: Reader<'_, '_>) -> Stepper {
    let default = Stepper::default();
    let supports =
        [("soles", SupportModel::Soles), ("circles", SupportModel::Circles), ("capsules", SupportModel::Capsules)];
    let triggers = [("extrapolated", Trigger::Extrapolated), ("projected", Trigger::Projected)];
    let stepper = Stepper {
        ankle_feedback: table.truth("ankle_feedback").unwrap_or(default.ankle_feedback),
        leg_change: table.truth("leg_change").unwrap_or(default.leg_change),
        support: table.choice("support", &supports).unwrap_or(default.support),
        trigger: table.choice("trigger", &triggers).unwrap_or(default.trigger),
        spring: table.number("spring").unwrap_or(default.spring),
        damping: table.number("damping").unwrap_or(default.damping),
        length_bias: table.number("length_bias").unwrap_or(default.length_bias),
        pull_bias: table.number("pull_bias").unwrap_or(default.pull_bias),
    };
    table.finish();
    stepper
}

/// `[base]`; a fault where it names neither a clip nor a file.
pub(super) fn base(mut table: Reader<'_, '_>) -> Option<Base> {
    let base = Base { clip: table.string("clip"), file: table.string("file") };
    if base.clip.is_none() && base.file.is_none() {
        table.missing("clip", "name a clip of the rig, as in `clip = \"Idle\"`, or a motion `file`");
    }
    table.finish();
    Some(base)
}

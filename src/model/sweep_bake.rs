//! `[bake]` in the text of a sweep: how its clips are baked, as the flags of `surefoot bake` have it.

use super::scenario_reader::Reader;
use super::sweep::{BakeSettings, ENGINES};
use toml::de::DeValue;

/// How keys are joined.
const CURVES: [&str; 2] = ["linear", "spline"];

/// The settings of the table, each that is not there as it is by default.
pub(super) fn bake_settings(mut table: Reader<'_, '_>) -> BakeSettings {
    let default = BakeSettings::default();
    let words = |words: [&'static str; 3]| words.map(|word| (word, word));
    let settings = BakeSettings {
        fps: table.number_within("fps", (1.0, 240.0), "frames a second").unwrap_or(default.fps),
        root: table.choice("root", &words(["root", "hips", "in-place"])).unwrap_or(default.root),
        drive: table.choice("drive", &words(["auto", "stepper", "ragdoll"])).unwrap_or(default.drive),
        assist: match table.peek("assist") {
            Some(DeValue::Array(_)) => table.numbers::<2>("assist"),
            Some(DeValue::String(_)) => {
                table.choice("assist", &[("auto", None), ("off", Some([0.0, 0.0]))]).unwrap_or(None)
            }
            Some(_) => table.number("assist").map(|torque| [torque, 0.0]),
            None => None,
        },
        props: table.truth("props").unwrap_or(default.props),
        looped: table.truth("loop").unwrap_or(default.looped),
        curves: table.choice("curves", &CURVES.map(|word| (word, word))).unwrap_or(default.curves),
        only_animation: table.truth("only_animation").unwrap_or(default.only_animation),
        contact_nodes: table.truth("contact_nodes").unwrap_or(default.contact_nodes),
        format: table
            .choice("format", &super::FileKind::ALL.map(|kind| (kind.ending(), kind)))
            .unwrap_or(default.format),
        engines: engines(&mut table),
    };
    if settings.assist.is_some_and(|limits| limits.iter().any(|limit| *limit < 0.0)) {
        table.wrong_type("assist", "a limit of 0 or more", "give \"auto\", \"off\", Nm, or [Nm, N], none under 0");
    }
    table.finish();
    settings
}

/// One name or a list of them.
fn engines(table: &mut Reader<'_, '_>) -> Vec<&'static str> {
    let named = ENGINES.map(|name| (name, name));
    let Some(value) = table.peek("engine") else { return Vec::new() };
    let DeValue::Array(list) = value else { return table.choice("engine", &named).into_iter().collect() };
    let wanted: Vec<&str> = list.iter().filter_map(|entry| entry.get_ref().as_str()).collect();
    if wanted.len() != list.len() || wanted.iter().any(|name| !ENGINES.contains(name)) {
        table.wrong_type("engine", "names of engines", &format!("give some of {}", ENGINES.join(", ")));
    }
    ENGINES.into_iter().filter(|name| wanted.contains(name)).collect()
}

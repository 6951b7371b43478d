//! The walks that clips are held on (`tests/walks.rs`), and that `tests/benches/pops.rs` looks for pops in.
//!
//! Speeds are Froude-equal and forces scale with mass.

use surefoot::model::scenario::Scenario;
use surefoot::model::scenario_text;
use surefoot::rig::Rig;

/// The rigs that walk.
pub const RIGS: [&str; 4] = ["builtin", "gdquest_mannequiny", "m2m_human_male", "kaykit_Knight"];
/// The built-in one's legs.
const LEGS: [f64; 2] = [0.7, 1.3];

/// What each scenario is called, how long it is and what it says; `{v<speed>}` is Froude-equal, `{f<force>}` mass-scaled.
fn scenarios() -> Vec<(String, f64, String)> {
    let go = |speed: f64, rest: &str| format!("[[walk]]\nstart = 0.3\nspeed = {{v{speed}}}\n{rest}");
    let stop = "[[walk]]\nstart = 4.5\nspeed = 0.0\n";
    let mut list: Vec<(String, f64, String)> = Vec::new();
    for (name, speed, rest) in [
        ("walk 0.6", 0.6, ""),
        ("walk 1.2", 1.2, ""),
        ("walk 1.6", 1.6, ""),
        ("back 0.6", 0.6, "heading = 180.0\nfacing = 0.0\n"),
        ("left 0.4", 0.4, "heading = 90.0\nfacing = 0.0\n"),
    ] {
        list.push((name.into(), 9.0, go(speed, rest) + stop + rest));
    }
    let curve =
        "[[walk]]\nstart = 2.5\nspeed = {v1.0}\nheading = 90.0\n[[walk]]\nstart = 4.5\nspeed = 0.0\nheading = 90.0\n";
    list.push(("curve 1.0".into(), 9.0, go(1.0, "") + curve));
    list.push(("turn 90".into(), 6.0, "[[turn]]\nstart = 0.5\nfacing = 90.0\n".into()));
    list.push(("turn 180".into(), 8.0, "[[turn]]\nstart = 0.5\nfacing = 180.0\n".into()));
    list.push(("a step or two".into(), 5.5, go(0.8, "[[walk]]\nstart = 1.1\nspeed = 0.0\n")));
    for toward in ["front", "back", "left", "right"] {
        let push = format!("[[push]]\nstart = 2.5\nduration = 0.2\nforce = {{f300}}\ntoward = \"{toward}\"\n");
        list.push((format!("pushed {toward}"), 9.0, go(1.2, "") + stop + &push));
    }
    let drag = "[[pull]]\nstart = 1.0\nduration = 3.5\nforce = {f60}\ntoward = \"back\"\nat = \"hips\"\n";
    list.push(("drags 60 N".into(), 9.0, go(1.0, "") + stop + drag));
    list
}

/// The numbers in braces, scaled to the body.
fn filled(text: &str, rig: &Rig, legs: f64) -> String {
    let leg = rig.body.leg_length * legs / 0.83;
    let mut parts = text.split('{');
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (what, rest) = part.split_once('}').expect("closed");
        let value: f64 = what[1..].parse().expect("a number");
        let scale = if what.starts_with('v') { leg.sqrt() } else { rig.body.mass / 89.5 };
        filled += &format!("{}{rest}", value * scale);
    }
    filled
}

/// The walks of a rig, by title.
pub fn walks(name: &str, rig: &Rig) -> Vec<Scenario> {
    let legs: &[f64] = if name == "builtin" { &[1.0, LEGS[0], LEGS[1]] } else { &[1.0] };
    let list = scenarios();
    legs.iter()
        .flat_map(|legs| list.iter().map(move |what| (legs, what)))
        .map(|(legs, (what, duration, text))| {
            let title = format!("{name} x{legs} {what}");
            let text = format!(
                "title = \"{title}\"\nduration = {duration}\nseed = 3\n[character]\nleg_scale = {legs}\n{}",
                filled(text, rig, *legs)
            );
            scenario_text::parse(&title, &text).unwrap_or_else(|errors| panic!("{title}: {errors:?}"))
        })
        .collect()
}

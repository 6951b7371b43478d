//! A scenario as its text: TOML in degrees that [`super::scenario_text`] reads back as the same scenario. What is as it would be if it
//! were left out is left out. No I/O; comments of a text that was read before are not kept.

use super::scenario::{Carry, Direction, Feet, GroundKind, Push, Scenario, SupportModel, Throw, Trigger};
use std::fmt::Write;

/// The text.
pub fn write(scenario: &Scenario) -> String {
    let default = Scenario::default();
    let mut text = String::new();
    pair(&mut text, "title", &quoted(&scenario.title));
    pair(&mut text, "duration", &number(scenario.duration));
    if scenario.seed != default.seed {
        pair(&mut text, "seed", &scenario.seed.to_string());
    }
    character(&mut text, scenario);
    ground(&mut text, scenario);
    stepper(&mut text, scenario);
    if let Some(base) = &scenario.base {
        text += "\n[base]\n";
        for (key, value) in [("clip", &base.clip), ("file", &base.file)] {
            if let Some(value) = value {
                pair(&mut text, key, &quoted(value));
            }
        }
    }
    for walk in &scenario.walk {
        span(&mut text, "walk", walk.start, walk.duration);
        pair(&mut text, "speed", &number(walk.speed));
        unless(&mut text, "heading", walk.heading.to_degrees(), 0.0);
        if let Some(facing) = walk.facing {
            pair(&mut text, "facing", &number(facing.to_degrees()));
        }
    }
    for turn in &scenario.turn {
        span(&mut text, "turn", turn.start, turn.duration);
        pair(&mut text, "facing", &number(turn.facing.to_degrees()));
    }
    for crouch in &scenario.crouch {
        span(&mut text, "crouch", crouch.start, crouch.duration);
        pair(&mut text, "amount", &number(crouch.amount));
    }
    for stand in &scenario.stand {
        span(&mut text, "stand", stand.start, stand.duration);
        let on = match stand.on {
            Feet::Both => "both",
            Feet::Left => "left",
            Feet::Right => "right",
        };
        pair(&mut text, "on", &quoted(on));
    }
    scenario.push.iter().for_each(|push| force(&mut text, "push", push));
    scenario.pull.iter().for_each(|pull| force(&mut text, "pull", pull));
    scenario.throw.iter().for_each(|balls| throw(&mut text, balls));
    scenario.carry.iter().for_each(|box_| carry(&mut text, box_));
    for marker in &scenario.marker {
        text += "\n[[marker]]\n";
        pair(&mut text, "time", &number(marker.time));
        pair(&mut text, "name", &quoted(&marker.name));
    }
    text
}

fn character(text: &mut String, scenario: &Scenario) {
    let default = Scenario::default().character;
    if scenario.character == default {
        return;
    }
    let character = &scenario.character;
    *text += "\n[character]\n";
    if let Some(mass) = character.mass {
        pair(text, "mass", &number(mass));
    }
    unless(text, "leg_scale", character.leg_scale, default.leg_scale);
    unless(text, "crouch", character.crouch, default.crouch);
    unless(text, "agility", character.agility, default.agility);
    unless(text, "breathing", character.breathing, default.breathing);
    let (style, plain) = (&character.style, &default.style);
    unless(text, "step_height", style.step_height, plain.step_height);
    unless(text, "stance_width", style.stance_width, plain.stance_width);
    unless(text, "readiness", style.readiness, plain.readiness);
    unless(text, "recovery_time", style.recovery_time, plain.recovery_time);
    unless(text, "arms", style.arms, plain.arms);
}

fn ground(text: &mut String, scenario: &Scenario) {
    if scenario.ground == Scenario::default().ground {
        return;
    }
    *text += "\n[ground]\n";
    let mut kind = |name: &str, values: &[(&str, String)]| {
        pair(text, "kind", &quoted(name));
        values.iter().for_each(|(key, value)| pair(text, key, value));
    };
    let degrees = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        points.iter().map(|[time, angle]| [*time, angle.to_degrees()]).collect()
    };
    match &scenario.ground.kind {
        GroundKind::Flat => kind("flat", &[]),
        GroundKind::Slope { angle } => kind("slope", &[("angle", number(angle.to_degrees()))]),
        GroundKind::Stairs { rise, tread, count } => {
            kind("stairs", &[("rise", number(*rise)), ("tread", number(*tread)), ("count", count.to_string())]);
        }
        GroundKind::Uneven { height, wavelength, seed } => {
            let values = [("height", number(*height)), ("wavelength", number(*wavelength)), ("seed", seed.to_string())];
            kind("uneven", &values);
        }
        GroundKind::Gaps { width, spacing } => {
            kind("gaps", &[("width", number(*width)), ("spacing", number(*spacing))]);
        }
        GroundKind::Platform { pitch, roll } => {
            let curves = [("pitch", pitch), ("roll", roll)];
            let there = curves.iter().filter(|(_, curve)| !curve.is_empty());
            let values: Vec<(&str, String)> = there.map(|(key, curve)| (*key, points(&degrees(curve)))).collect();
            kind("platform", &values);
        }
        GroundKind::Mesh { file, ceiling, .. } => {
            let ceiling = ceiling.map(|ceiling| ("ceiling", number(ceiling)));
            let values: Vec<(&str, String)> = [("file", quoted(file))].into_iter().chain(ceiling).collect();
            kind("mesh", &values);
        }
    }
    unless(text, "friction", scenario.ground.friction, 1.0);
}

fn stepper(text: &mut String, scenario: &Scenario) {
    let (stepper, default) = (&scenario.stepper, Scenario::default().stepper);
    if *stepper == default {
        return;
    }
    *text += "\n[stepper]\n";
    for (key, value, plain) in [
        ("ankle_feedback", stepper.ankle_feedback, default.ankle_feedback),
        ("leg_change", stepper.leg_change, default.leg_change),
    ] {
        if value != plain {
            pair(text, key, &value.to_string());
        }
    }
    match stepper.support {
        SupportModel::Soles => {}
        SupportModel::Circles => pair(text, "support", &quoted("circles")),
        SupportModel::Capsules => pair(text, "support", &quoted("capsules")),
    }
    if stepper.trigger == Trigger::Projected {
        pair(text, "trigger", &quoted("projected"));
    }
    unless(text, "spring", stepper.spring, default.spring);
    unless(text, "damping", stepper.damping, default.damping);
    unless(text, "length_bias", stepper.length_bias, default.length_bias);
    unless(text, "pull_bias", stepper.pull_bias, default.pull_bias);
}

fn force(text: &mut String, lane: &str, push: &Push) {
    span(text, lane, push.start, Some(push.duration));
    pair(text, "force", &number(push.force));
    pair(text, "toward", &direction(push.toward));
    pair(text, "at", &quoted(push.at.name()));
}

fn throw(text: &mut String, balls: &Throw) {
    span(text, "throw", balls.start, None);
    pair(text, "count", &balls.count.to_string());
    pair(text, "interval", &number(balls.interval));
    pair(text, "radius", &list(&balls.radius));
    pair(text, "density", &number(balls.density));
    pair(text, "speed", &number(balls.speed));
    pair(text, "from", &direction(balls.from));
    pair(text, "at", &quoted(balls.at.name()));
    pair(text, "spread", &number(balls.spread));
}

fn carry(text: &mut String, carried: &Carry) {
    span(text, "carry", carried.start, None);
    if let Some(end) = carried.end {
        pair(text, "end", &number(end));
    }
    pair(text, "mass", &points(&carried.mass));
    let sizes: Vec<String> = match carried.size.as_slice() {
        [(_, only)] => only.to_array().map(number).to_vec(),
        many => many.iter().map(|(time, size)| format!("[{}, {}]", number(*time), list(&size.to_array()))).collect(),
    };
    pair(text, "size", &format!("[{}]", sizes.join(", ")));
}

fn span(text: &mut String, lane: &str, start: f64, duration: Option<f64>) {
    let _ = write!(text, "\n[[{lane}]]\n");
    pair(text, "start", &number(start));
    if let Some(duration) = duration {
        pair(text, "duration", &number(duration));
    }
}

fn pair(text: &mut String, key: &str, value: &str) {
    let _ = writeln!(text, "{key} = {value}");
}

fn unless(text: &mut String, key: &str, value: f64, default: f64) {
    if value != default {
        pair(text, key, &number(value));
    }
}

fn direction(direction: Direction) -> String {
    match direction {
        Direction::Front => quoted("front"),
        Direction::Back => quoted("back"),
        Direction::Left => quoted("left"),
        Direction::Right => quoted("right"),
        Direction::Heading(angle) => number(angle.to_degrees()),
        Direction::Vector(vector) => list(&vector.to_array()),
    }
}

/// Twelve digits, so that 90 degrees that were radians are 90 degrees again.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    format!("{:?}", rounded + 0.0) // + 0.0: never "-0.0"
}

fn list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|value| number(*value)).collect::<Vec<_>>().join(", "))
}

fn points(points: &[[f64; 2]]) -> String {
    format!("[{}]", points.iter().map(|point| list(point)).collect::<Vec<_>>().join(", "))
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    use super::super::scenario_text::{example_text, parse};
    use super::*;

    #[test]
    fn what_is_written_reads_back_the_same() {
        let every = example_text()
            .lines()
            .map(|line| match line.strip_prefix("# ") {
                Some(rest) if rest.starts_with('[') || rest.split(' ').nth(1) == Some("=") => rest,
                _ => line,
            })
            .collect::<Vec<_>>()
            .join("\n");
        let grounds = [
            "kind = \"slope\"\nangle = 12.5",
            "kind = \"stairs\"\nrise = 0.17\ntread = 0.29\ncount = 7",
            "kind = \"uneven\"\nheight = 0.1\nwavelength = 1.5\nseed = 3\nfriction = 0.7",
            "kind = \"gaps\"\nwidth = 0.2\nspacing = 1.1",
            "kind = \"platform\"\nroll = [[0, 0], [2, 12.3]]",
            "kind = \"mesh\"\nfile = \"levels/kerb.glb\"",
            "kind = \"mesh\"\nfile = \"levels/hill.glb\"\nceiling = 2",
            "kind = \"mesh\"\nfile = \"a \\\"b\\\".gltf\"\nceiling = 4.5\nfriction = 0.7",
        ];
        let mut texts: Vec<String> =
            grounds.iter().map(|ground| format!("title = \"a \\\"b\\\"\"\n[ground]\n{ground}\n")).collect();
        texts.push(every);
        texts.push("[[carry]]\nstart = 0\nmass = 3\nsize = [[0, [0.3, 0.2, 0.2]], [2.5, [0.6, 0.2, 0.4]]]\n".into());
        texts.push("duration = 3\n[[push]]\nstart = 1\nduration = 0.1\nforce = 100\ntoward = -33.3\n[[push]]\nstart = 2\nduration = 0.1\nforce = 100\ntoward = [0.1, 0, -1]\n".into());
        for text in texts {
            let scenario = parse("a.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
            let written = write(&scenario);
            let again = parse("a.toml", &written).unwrap_or_else(|errors| panic!("{errors}\n{written}"));
            assert_eq!(scenario, again, "{written}");
            assert_eq!(write(&again), written);
        }
    }
}

//! Every pop of the shoved and of the walking clips: joint, degrees, the foot's nearest contact edge, the steps around it;
//! and every joint that leaves its range, with what else a clip falls short in.
//!
//! `cargo bench --bench pops` prints them all and, at the end, how they spread; words after `--` choose clips by a part of
//! their title, `-q` leaves the list out.

#![expect(clippy::print_stdout, reason = "the table")]
#![expect(dead_code, reason = "shares its rigs with other tables")]

#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
#[path = "../limits_grid.rs"]
mod limits_grid;
#[path = "../walk_grid.rs"]
mod walk_grid;

use limits_grid::{EIGHT, rigs, shove};
use rayon::prelude::*;
use std::collections::BTreeMap;
use surefoot::bake::{BakeOptions, Baked, bake};
use surefoot::measure::joints::Pop;
use surefoot::model::scenario::Scenario;
use surefoot::model::scenario_text;
use surefoot::model::{
    Side,
    report::{Outcome, Part},
};
use surefoot::rig::Rig;

/// Those that climb.
const STAIRS: [&str; 6] =
    ["builtin", "gdquest_mannequiny", "godette_vrm0", "kaykit_Knight", "vrm1_debug_robot", "khronos_CesiumMan"];

/// What else is short in a clip: ranges, ZMP, rest, legs, soles.
fn short(row: &Row) -> Vec<String> {
    let Some(found) = &row.baked.findings else { return Vec::new() };
    let excess = found.joints.excesses.iter().map(|excess| {
        let (angle, by) = (&excess.angle, excess.by.to_degrees());
        format!("{} {} {:.1} deg out at {:.2} s", angle.role.name(), angle.axis, by, excess.time)
    });
    let legs = 100.0 * found.feet.least_leg_distance / found.leg_scale;
    let rest = [
        (found.zmp.inside < 0.95, format!("ZMP inside {:.1} %", 100.0 * found.zmp.inside)),
        (found.balance.rest_from.is_none(), "never at rest".to_owned()),
        (legs < 8.0, format!("legs {legs:.1} cm at {:.2} s", found.feet.least_leg_time)),
        (found.feet.slip_max_mm > 2.0, format!("slips {:.1} mm", found.feet.slip_max_mm)),
        (
            found.feet.penetration_max_mm > 5.0,
            format!("sinks {:.1} mm at {:.2} s", found.feet.penetration_max_mm, found.feet.penetration_time),
        ),
    ];
    let slips = row.baked.report.contacts.iter().filter(|contact| contact.slip_mm > 2.0).map(|contact| {
        let (foot, part) = (contact.foot, contact.part);
        format!("{foot:?} {part:?} {:.2} to {:.2} s slips {:.1} mm", contact.start, contact.end, contact.slip_mm)
    });
    excess.chain(slips).chain(rest.into_iter().filter(|(is, _)| *is).map(|(_, line)| line)).collect()
}

struct Row {
    grid: &'static str,
    title: String,
    baked: Baked,
    lines: Vec<(String, String)>, // what kind, the whole line
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let quiet = std::env::args().any(|word| word == "-q");
    let rigs = rigs();
    let mut cells: Vec<(&'static str, &Rig, Scenario)> = Vec::new();
    for (name, rig) in &rigs {
        for impulse in [20.0, 40.0, 60.0, 80.0, 100.0] {
            for direction in EIGHT {
                let mut scenario = shove(&rig.body, direction, impulse);
                scenario.title = format!("{name} {}", scenario.title);
                cells.push(("shoves", rig, scenario));
            }
        }
        if walk_grid::RIGS.contains(&name.as_str()) {
            cells.extend(walk_grid::walks(name, rig).into_iter().map(|scenario| ("walks", rig, scenario)));
        }
        if STAIRS.contains(&name.as_str()) {
            cells.extend(stairs(name, rig).into_iter().map(|scenario| ("ground", rig, scenario)));
        }
    }
    cells.retain(|(grid, _, scenario)| {
        words.is_empty() || words.iter().any(|word| scenario.title.contains(word.as_str()) || grid == word)
    });
    let rows: Vec<Row> = cells.par_iter().map(|(grid, rig, scenario)| row(grid, rig, scenario)).collect();
    for grid in ["shoves", "walks", "ground"] {
        let of: Vec<&Row> = rows.iter().filter(|row| row.grid == grid).collect();
        if of.is_empty() {
            continue;
        }
        let mut kinds: BTreeMap<&str, (usize, f64)> = BTreeMap::new();
        for row in &of {
            let short = short(row);
            if !(quiet || row.lines.is_empty() && short.is_empty()) {
                println!("{}", row.title);
                row.lines.iter().for_each(|(_, line)| println!("    {line}"));
                short.iter().for_each(|line| println!("    {line}"));
            }
            for (kind, _) in &row.lines {
                kinds.entry(kind).or_default().0 += 1;
            }
            let mut once: Vec<&str> = row.lines.iter().map(|(kind, _)| kind.as_str()).collect();
            once.dedup();
            for kind in &once {
                kinds.entry(kind).or_default().1 += 1.0 / once.len() as f64;
            }
        }
        let mut kinds: Vec<_> = kinds.into_iter().collect();
        kinds.sort_by(|a, b| b.1.1.total_cmp(&a.1.1));
        println!("{grid}: kind, pops, weight in clips");
        for (kind, (count, weight)) in kinds {
            println!("    {kind:<40} {count:>4} {weight:>6.1}");
        }
        let mut beyond: BTreeMap<String, (usize, f64)> = BTreeMap::new();
        for excess in of.iter().filter_map(|row| row.baked.findings.as_ref()).flat_map(|found| &found.joints.excesses) {
            let of_both = excess.angle.role.name().trim_start_matches("left").trim_start_matches("right");
            let way = if excess.angle.value > excess.angle.range[1] { "over" } else { "under" };
            let entry = beyond.entry(format!("{of_both} {} {way}", excess.angle.axis)).or_default();
            *entry = (entry.0 + 1, entry.1.max(excess.by.to_degrees()));
        }
        println!("{grid}: out of range, joints, the farthest in degrees");
        for (what, (count, most)) in beyond {
            println!("    {what:<40} {count:>4} {most:>6.1}");
        }
        let share =
            |holds: &dyn Fn(&Row) -> bool| 100.0 * of.iter().filter(|row| holds(row)).count() as f64 / of.len() as f64;
        let most = |value: &dyn Fn(&Row) -> f64| {
            let worst = of.iter().max_by(|a, b| value(a).total_cmp(&value(b))).expect("a clip");
            format!("{:.1} ({})", value(worst), worst.title)
        };
        fn found(row: &Row) -> &surefoot::measure::Findings {
            row.baked.findings.as_ref().expect("measured")
        }
        println!(
            "{grid}: {} clips, no pop {:.1}, limits {:.1}, zmp95 {:.1}, out3 {:.1}, legs>8 {:.1}, stand {:.1}, slip<2 {:.1}, sink<5 {:.1}, float<5 {:.1}, speed<10 {:.1}, rest {:.1}",
            of.len(),
            share(&|row| found(row).joints.pops.is_empty()),
            share(&|row| found(row).joints.excesses.is_empty()),
            share(&|row| found(row).zmp.inside >= 0.95),
            share(&|row| found(row).zmp.outside_p95_cm <= 3.0),
            share(&|row| 100.0 * found(row).feet.least_leg_distance / found(row).leg_scale >= 8.0),
            share(&|row| row.baked.report.outcome != Outcome::Fall),
            share(&|row| found(row).feet.slip_max_mm <= 2.0),
            share(&|row| found(row).feet.penetration_max_mm <= 5.0),
            share(&|row| found(row).feet.float_max_mm <= 5.0),
            share(&|row| found(row).feet.slip_speed_p95 <= 10.0),
            share(&|row| found(row).balance.rest_from.is_some()),
        );
        for (who, at) in [("builtin", true), ("third", false)] {
            let own: Vec<&&Row> = of.iter().filter(|row| row.title.starts_with("builtin") == at).collect();
            let part = |holds: &dyn Fn(&Row) -> bool| {
                own.iter().filter(|row| holds(row)).count() as f64 / own.len().max(1) as f64
            };
            println!(
                "{grid}/{who}: pops {:.3}, limits {:.3}, zmp {:.3}, out {:.3}, legs {:.3}, rest {:.3}",
                part(&|row| found(row).joints.pops.is_empty()),
                part(&|row| found(row).joints.excesses.is_empty()),
                part(&|row| found(row).zmp.inside >= 0.95),
                part(&|row| found(row).zmp.outside_p95_cm <= 3.0),
                part(&|row| 100.0 * found(row).feet.least_leg_distance / found(row).leg_scale >= 8.0),
                part(&|row| found(row).balance.rest_from.is_some())
            );
        }
        println!(
            "{grid}: worst slip {}, sink {}, float {}",
            most(&|row| found(row).feet.slip_max_mm),
            most(&|row| found(row).feet.penetration_max_mm),
            most(&|row| found(row).feet.float_max_mm),
        );
    }
}

/// The same on stairs and slopes, and a walk to compare them with.
fn stairs(name: &str, rig: &Rig) -> Vec<Scenario> {
    let leg = rig.body.leg_length / 0.83;
    let walk = |speed: f64| {
        let speed = speed * leg.sqrt();
        format!("[[walk]]\nstart = 0.5\nspeed = {speed}\n[[walk]]\nstart = 4.0\nspeed = 0.0\n")
    };
    let stairs =
        |rise: f64| format!("[ground]\nkind = \"stairs\"\nrise = {}\ntread = {}\ncount = 6\n", rise * leg, 0.29 * leg);
    let slope = |degrees: f64| format!("[ground]\nkind = \"slope\"\nangle = {degrees}\n");
    let list = [
        ("stairs up", stairs(0.17) + &walk(0.8)),
        ("stairs down", stairs(-0.17) + &walk(0.8)),
        ("walk up", slope(15.0) + &walk(1.0)),
        ("walk down", slope(-15.0) + &walk(1.0)),
        ("walk 1.2", walk(1.2)),
    ];
    list.into_iter()
        .map(|(what, text)| {
            let title = format!("{name} {what}");
            let text = format!("title = \"{title}\"\nduration = 6.0\n{text}");
            scenario_text::parse(&title, &text).unwrap_or_else(|errors| panic!("{title}: {errors:?}"))
        })
        .collect()
}

fn row(grid: &'static str, rig: &Rig, scenario: &Scenario) -> Row {
    let baked = bake(rig, scenario, &BakeOptions::default()).expect("the simulation holds");
    let scale = scenario.character.leg_scale;
    let scaled = if scale == 1.0 { None } else { Some(rig.with_leg_scale(scale)) };
    let rig = scaled.as_ref().unwrap_or(rig);
    let pops = baked.findings.as_ref().map(|found| found.joints.pops.clone()).unwrap_or_default();
    let lines = pops.iter().map(|pop| told(rig, &baked, pop)).collect();
    Row { grid, title: scenario.title.clone(), baked, lines }
}

fn told(rig: &Rig, baked: &Baked, pop: &Pop) -> (String, String) {
    let body = &baked.performance.timeline.body;
    let joint = body.joint(pop.role).expect("it popped");
    let fps = baked.clip.fps;
    let frame = (pop.time * fps).round() as i64;
    let last = (baked.clip.duration * fps).round() as i64;
    let mut sampler = rig.sampler(&baked.clip);
    let mut turn = |frame: i64| {
        let pose = sampler.sample(frame as f64 / fps).pose();
        match body.joints[joint].parent {
            Some(parent) => pose.turns[parent].inverse() * pose.turns[joint],
            None => pose.turns[joint],
        }
    };
    let steps: Vec<String> = (frame - 4..=frame + 4)
        .filter(|at| *at >= 0 && *at < last)
        .map(|at| {
            let step = turn(at).inverse() * turn(at + 1);
            let degrees = (2.0 * step.xyz().length().atan2(step.w.abs())).to_degrees();
            if at == frame { format!("[{degrees:.1}]") } else { format!("{degrees:.1}") }
        })
        .collect();
    let name = pop.role.name();
    let sides: &[Side] = match name {
        _ if name.starts_with("Left") || name.starts_with("left") => &[Side::Left],
        _ if name.starts_with("Right") || name.starts_with("right") => &[Side::Right],
        _ => &Side::BOTH,
    };
    let mut edges: Vec<(f64, &str)> = Vec::new();
    for side in sides {
        let own: Vec<_> = baked.performance.contacts.iter().filter(|contact| contact.side == *side).collect();
        for (index, contact) in own.iter().enumerate() {
            let before =
                index.checked_sub(1).map(|before| own[before]).filter(|b| (b.end - contact.start).abs() < 1e-4);
            match (before.map(|b| b.part), contact.part) {
                (None, part) if contact.start > 0.0 => {
                    edges.push((
                        contact.start,
                        match part {
                            Part::Heel => "heel strike",
                            Part::Ball => "ball strike",
                            Part::Flat => "flat strike",
                        },
                    ));
                }
                (Some(Part::Flat), Part::Ball) => edges.push((contact.start, "heel off")),
                (Some(Part::Heel), _) => edges.push((contact.start, "flat after heel")),
                (Some(_), Part::Flat) => edges.push((contact.start, "flat after ball")),
                _ => {}
            }
            if own.get(index + 1).is_none_or(|next| next.start - contact.end > 1e-4) {
                edges.push((contact.end, "lift"));
            }
        }
    }
    let middle = pop.time + 0.5 / fps;
    let near = edges.iter().min_by(|a, b| (a.0 - middle).abs().total_cmp(&(b.0 - middle).abs()));
    let (off, edge) = near.map_or((0.0, "nothing"), |edge| ((middle - edge.0) * fps, edge.1));
    let bare = name
        .trim_start_matches("Left")
        .trim_start_matches("Right")
        .trim_start_matches("left")
        .trim_start_matches("right");
    let place = if off < -3.0 {
        "long before"
    } else if off < -0.5 {
        "before"
    } else if off <= 0.5 {
        "at"
    } else if off <= 3.0 {
        "after"
    } else {
        "long after"
    };
    let kind = format!("{bare} {place} {edge}");
    let line = format!(
        "{name} {:.2} s {:.1} deg, {off:+.1} frames from {edge}: {}",
        pop.time,
        pop.step.to_degrees(),
        steps.join(" ")
    );
    (kind, line)
}

//! `surefoot bake`: a scenario onto a rig, and what came of it for the person and for programs.

use super::args::{Assist, BakeArgs, Drive, Root};
use super::progress::busy;
use super::{parts, say, tell, travel};
use crate::bake::{Baked, Fall};
use crate::disk::writer::{self, Output};
use crate::disk::{Exit, Failure};
use crate::disk::{level, resolve};
use crate::export::Form;
use crate::export::engine::{ENGINES, Engine};
use crate::model::report::{Contact, JointTorque, Outcome, Part};
use crate::model::{FileKind, Scenario, Side};
use crate::ragdoll::control::MOST_TORQUE;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Where `--demo` writes unless it is told.
const DEMO_OUTPUT: &str = "exports/demo.glb";

/// Bakes.
pub fn run(args: &BakeArgs) -> Result<Exit, Failure> {
    if args.drive == Drive::Stepper && !matches!(args.assist, Assist::Auto | Assist::Off) {
        tell("warning: --assist bounds the ragdoll's help; the stepper takes none, so it changes nothing");
    }
    let output = args.output.clone().unwrap_or_else(|| PathBuf::from(DEMO_OUTPUT));
    let events = output.with_extension("events.json");
    let mut places: Vec<&Path> = vec![&output, &events];
    places.extend(args.sheet.as_deref());
    places.extend(args.plot.as_deref());
    let engines = engines(args);
    let helpers: Vec<PathBuf> = engines.iter().map(|engine| output.with_file_name(engine.file)).collect();
    places.extend(helpers.iter().map(PathBuf::as_path));

    // Everything that can be wrong with the arguments is told before the work starts.
    if let (true, Some(what)) = (args.props, FileKind::of(&output).without_props()) {
        return Err(Failure::bad_input(format!(
            "{}: {what} holds no meshes, so no props\n  help: leave --props away, or let the name end in .glb",
            output.display()
        )));
    }
    let mut inputs: Vec<PathBuf> = Vec::new();
    let mut scenario = match &args.scenario {
        Some(path) => {
            inputs.push(path.clone());
            resolve::scenario(path)?
        }
        None => Scenario::demo(),
    };
    let ground = level::lay(&mut scenario, args.scenario.as_deref())?;
    inputs.extend(ground.iter().flat_map(|level| level.files.clone()));
    let rig = busy(&format!("reading {}", args.rig.display()), || resolve::rig(&args.rig))?;
    inputs.extend(rig.files);
    let rig = rig.rig;
    writer::check(&places, &inputs)?;
    let mut warnings = Vec::new();
    let mut warn = |warning: String| {
        tell(&format!("warning: {warning}"));
        warnings.push(warning);
    };
    ground.as_ref().and_then(level::left_out).into_iter().for_each(&mut warn);
    for warning in &rig.mapping.warnings {
        warn(format!("{}: {warning}", args.rig.display()));
    }

    let (chosen, why) = travel::chosen(&rig, args.root, &engines, args.only_animation);
    why.into_iter().for_each(&mut warn);
    let root = crate::bake::RootMotion::from(chosen);
    for engine in engines.iter().filter(|engine| !engine.takes(root.name())) {
        warn(format!("{} takes root motion from {}", engine.title, engine.root));
    }

    let base = busy("reading the base clip", || resolve::base(&rig, &scenario, args.scenario.as_deref(), &args.rig))?;
    inputs.extend(base.as_ref().map(|base| base.0.clone()));
    let what = format!("baking \"{}\" onto {}", scenario.title, args.rig.display());
    let baked = busy(&what, || parts::bake(&rig, &scenario, base.map(|base| base.1), root, args))?;
    for warning in &baked.warnings {
        warn(warning.clone());
    }
    let fell = baked.report.outcome == Outcome::Fall;
    if fell && args.require_balance {
        if args.json {
            say(&as_json(&baked, &baked.clip.name, None, &warnings))?;
        }
        tell("the character fell: nothing was written (--require-balance)");
        return Ok(Exit::Refused);
    }

    let root_joint = chosen == Root::Root && engines.iter().any(|engine| engine.root_is_joint);
    let form = Form {
        kind: FileKind::of(&output),
        props: args.props,
        root_joint,
        only_animation: args.only_animation,
        no_contact_nodes: args.no_contact_nodes,
    };
    let exported = parts::exported(&rig, &baked, form)?;
    for change in &exported.changes {
        warn(change.clone());
    }
    let size = exported.file.len();
    let mut outputs = vec![
        Output { path: output.clone(), bytes: exported.file },
        Output { path: events.clone(), bytes: exported.events },
    ];
    for (engine, path) in engines.iter().zip(&helpers) {
        outputs.push(Output { path: path.clone(), bytes: engine.helper() });
    }
    if let Some(sheet) = &args.sheet {
        outputs.push(Output {
            path: sheet.clone(),
            bytes: busy("drawing the contact sheet", || {
                parts::sheet(&rig, &baked.clip, &baked.report, &parts::seen_props(&baked))
            }),
        });
    }
    if let Some(plot) = &args.plot {
        let bytes = crate::picture::clip_plot(&baked.performance, &scenario).into_bytes();
        outputs.push(Output { path: plot.clone(), bytes });
    }
    writer::write(&outputs, &inputs)?;
    let (sheet, plot) = (args.sheet.as_deref(), args.plot.as_deref());
    let places = Places { output: &output, events: &events, helpers: &helpers, sheet, plot };
    say(&match args.json {
        true => as_json(&baked, &exported.name, Some(&places), &warnings),
        false => {
            let next =
                if args.demo && FileKind::of(&output) == FileKind::Glb { next_steps(&output) } else { String::new() };
            summary(&baked, &exported.name, &places, size) + &next
        }
    })?;
    Ok(Exit::Done)
}

/// Those that were asked for, each once, in the order of the table.
fn engines(args: &BakeArgs) -> Vec<&'static Engine> {
    ENGINES.iter().filter(|engine| args.engine.iter().any(|wanted| wanted.name == engine.name)).collect()
}

/// Where the results are.
struct Places<'a> {
    output: &'a Path,
    events: &'a Path,
    helpers: &'a [PathBuf],
    sheet: Option<&'a Path>,
    plot: Option<&'a Path>,
}

/// One JSON object on one line.
fn as_json(baked: &Baked, name: &str, places: Option<&Places>, warnings: &[String]) -> String {
    let text = |path: Option<&Path>| path.map(|path| path.display().to_string());
    let object = json!({
        "output": text(places.map(|places| places.output)),
        "events": text(places.map(|places| places.events)),
        "helpers": places.map_or(&[][..], |places| places.helpers).iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
        "sheet": text(places.and_then(|places| places.sheet)),
        "plot": text(places.and_then(|places| places.plot)),
        "clip": name,
        "warnings": warnings,
        "choice": baked.choice.as_ref().map(|choice| {
            json!({ "drive": baked.report.drive, "why": choice.why, "other_score": choice.other })
        }),
        "report": crate::export::events::report_json(name, &baked.report).unwrap_or_default(),
    });
    format!("{object}\n")
}

/// What a person who has baked the demo may do next. Cargo names the package it runs in the environment: whoever runs the program by
/// cargo has most likely not installed it.
fn next_steps(output: &Path) -> String {
    let by_cargo = std::env::var_os("CARGO_PKG_NAME").is_some_and(|name| name == env!("CARGO_PKG_NAME"));
    let program = if by_cargo { "cargo run --release --" } else { "surefoot" };
    let mut text = format!(
        "\nTo look at it, drop {} into any glTF viewer, for example\n\
         https://gltf-viewer.donmccurdy.com, or into an engine that reads glTF; in Blender choose\n\
         File > Import > glTF 2.0.\n\nTo bake onto your own rig (.glb, .gltf, .vrm or .fbx):\n\n\
         \x20   {program} new scenario -o shove.toml\n\
         \x20   {program} bake hero.glb shove.toml -o exports/hero_shove.glb\n",
        output.display()
    );
    if by_cargo {
        text +=
            "\n`cargo install --path .` installs the program: then `surefoot` stands for `cargo run --release --`.\n";
    }
    text
}

/// What came of it, for a person.
fn summary(baked: &Baked, name: &str, places: &Places, size: usize) -> String {
    let report = &baked.report;
    let mut text = String::new();
    let mut line = |label: &str, what: std::fmt::Arguments| {
        text += format!("{label:<11}{what}").trim_end();
        text.push('\n');
    };
    line("baked", format_args!("{} ({})", places.output.display(), bytes(size)));
    line("events", format_args!("{}", places.events.display()));
    for (index, helper) in places.helpers.iter().enumerate() {
        line(if index == 0 { "helpers" } else { "" }, format_args!("{}", helper.display()));
    }
    if let Some(sheet) = places.sheet {
        line("sheet", format_args!("{}", sheet.display()));
    }
    if let Some(plot) = places.plot {
        line("plot", format_args!("{}", plot.display()));
    }
    line(
        "clip",
        format_args!(
            "{}: {:.2} s at {} fps, root motion {}, drive {}, seed {}",
            name, report.duration, report.fps, report.root_motion, report.drive, report.seed
        ),
    );
    if let Some(base) = &report.base {
        line(
            "base",
            format_args!(
                "{}: first frame {:.2} degrees and {:.1} mm from its pose, last frame {:.2} and {:.1}",
                base.clip, base.first_deg, base.first_mm, base.last_deg, base.last_mm
            ),
        );
    }
    if let Some(cycle) = &report.looped {
        line(
            "loop",
            format_args!(
                "a cycle of {:.2} s at {:.2} m/s: its last frame is {:.2} degrees and {:.1} mm from its first; {:.1} degrees and {:.0} mm were evened out",
                cycle.period, cycle.speed, cycle.error_deg, cycle.error_mm, cycle.evened_deg, cycle.evened_mm
            ),
        );
    }
    line("body", format_args!("{:.1} kg, {:.2} m", report.body.mass, report.body.height));
    line("outcome", format_args!("{}", outcome(baked)));
    for (index, push) in report.disturbances.iter().enumerate() {
        let force = glam::DVec3::from(push.force).length();
        line(
            if index == 0 { "pushed" } else { "" },
            format_args!(
                "{} of {:.0} N at {} from {:.2} to {:.2} s ({:.1} Ns)",
                push.kind,
                force,
                push.bone,
                push.start,
                push.end,
                force * (push.end - push.start)
            ),
        );
    }
    if let Some(choice) = &baked.choice {
        let other = if report.drive == "ragdoll" { "stepper" } else { "ragdoll" };
        let score = choice.other.map_or(String::new(), |score| format!("; the {other}'s plausibility is {score:.2}"));
        line("drive", format_args!("{}: {}{score}", report.drive, choice.why));
    }
    if let Some(driven) = &baked.performance.articulated {
        let help = &report.assist;
        line(
            "assist",
            format_args!(
                "{:.0} Nm peak ({:.0} rms), {:.0} N peak ({:.0} rms) on the root; allowed {:.0} Nm, {:.0} N",
                help.peak_nm, help.rms_nm, help.peak_n, help.rms_n, driven.bound.torque, driven.bound.force
            ),
        );
        if let Some(why) = &driven.why {
            line("", format_args!("{why}"));
        }
        let worst =
            |torque: &JointTorque| format!("{} {:.0} Nm ({:.0} %)", torque.joint, torque.peak_nm, 100.0 * torque.share);
        let worst: Vec<String> = report.torques.iter().take(3).map(worst).collect();
        line("torques", format_args!("peak {} of the {MOST_TORQUE:.0} Nm that a joint may give", worst.join(", ")));
    }
    for (index, contact) in report.contacts.iter().enumerate() {
        line(if index == 0 { "contacts" } else { "" }, format_args!("{}", contact_row(contact)));
    }
    for (index, event) in report.events.iter().enumerate() {
        let foot = event.foot.map_or("", |side| side_name(side));
        line(if index == 0 { "happens" } else { "" }, format_args!("{:7.3} s  {} {foot}", event.time, event.name));
    }
    let measured = &report.plausibility;
    line(
        "plausible",
        format_args!(
            "{:.2}: ZMP inside {:.1} % (p95 {:.1} cm out), slip {:.2} mm, penetration {:.1} mm, friction needed {:.2}, peak ankle {:.1} m/s, speed ratio {:.2}",
            measured.score,
            measured.zmp_inside * 100.0,
            measured.zmp_outside_p95_cm,
            measured.slip_max_mm,
            measured.penetration_max_mm,
            measured.friction_p99,
            measured.peak_ankle_speed,
            measured.speed_ratio
        ),
    );
    for note in &measured.notes {
        line("", format_args!("{note}"));
    }
    text
}

fn outcome(baked: &Baked) -> String {
    let report = &baked.report;
    let steps = match report.steps {
        1 => "1 step".to_owned(),
        steps => format!("{steps} steps"),
    };
    match report.outcome {
        Outcome::Still => "still: nothing moved".to_owned(),
        Outcome::Sway => "sway: the feet stayed where they were".to_owned(),
        Outcome::Step if report.looped.is_some() => format!("step: {steps} a cycle"),
        Outcome::Step => format!("step: {steps}, and it stands"),
        Outcome::Fall => match baked.fall() {
            Some(Fall::Down(_)) => format!("fall: balance was lost after {steps}, and it goes down"),
            Some(Fall::Measured(time)) => {
                format!("fall: it is measured as fallen at {time:.2} s; {steps} in all")
            }
            _ => format!("fall: balance was lost after {steps}; the clip ends there"),
        },
    }
}

fn contact_row(contact: &Contact) -> String {
    let part = match contact.part {
        Part::Heel => "heel",
        Part::Ball => "ball",
        Part::Flat => "flat",
    };
    let foot = side_name(contact.foot);
    let [x, y, z] = contact.position.map(|metres| (metres * 100.0).round() / 100.0 + 0.0); // + 0.0: never "-0.00"
    let slip = contact.slip_mm;
    format!(
        "{foot:<5}  {part}  {:7.3} to {:7.3} s  at ({x:6.2}, {y:5.2}, {z:6.2})  slip {slip:.2} mm",
        contact.start, contact.end
    )
}

fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}

fn bytes(size: usize) -> String {
    match size {
        0..10_000 => format!("{size} bytes"),
        10_000..10_000_000 => format!("{:.0} kB", size as f64 / 1e3),
        _ => format!("{:.1} MB", size as f64 / 1e6),
    }
}

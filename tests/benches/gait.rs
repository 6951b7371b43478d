//! How the baked walk compares with people, row by row: textbook means, and captured walks where the data is there.
//!
//! `cargo bench --bench gait` prints it for the built-in rig; words after `--` name other rigs.

#![expect(clippy::print_stdout, reason = "the table")]

#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
use surefoot::bake::{BakeOptions, bake, contacts};
use surefoot::measure::gait::{Gait, gait};
use surefoot::measure::{Frame, HeldContact, Motion, Track};
use surefoot::mocap::{self, retarget::planted_parts};
use surefoot::model::report::Part;
use surefoot::model::scenario::{Scenario, Walk};
use surefoot::model::{BodyPose, Clip, Side};
use surefoot::rig::mannequin::BUILTIN;

use surefoot::rig::{Rig, clips, load, load_bytes};

/// Samples a second.
const HZ: f64 = 120.0;
/// Captured walks without forces: their contacts are read off their feet.
const RECORDED: [&str; 2] = ["cmu_02_01_walk", "cmu_12_01_walk"];

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let data = data::place();
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let mut rigs = vec![("builtin".to_owned(), load_bytes("builtin", BUILTIN, &alone, None).expect("built in"))];
    for word in words {
        match load(&data.join("rigs").join(&word)) {
            Ok(rig) => rigs.push((word, rig)),
            Err(error) => println!("{word}: {error}"),
        }
    }
    let mut captured: Vec<(String, Gait, f64)> = Vec::new();
    captured.extend(measured(&data).map(|(gait, leg)| ("rajagopal".to_owned(), gait, leg)));
    for name in RECORDED {
        captured
            .extend(recorded(&data, name).map(|(gait, leg)| (name.trim_end_matches("_walk").to_owned(), gait, leg)));
    }
    for (name, rig) in rigs {
        let leg = surefoot::whole_body::Anatomy::new(&rig.body).legs[0].length();
        let pace = (leg / 0.83).sqrt();
        let mut columns: Vec<(String, Gait, f64)> = Vec::new();
        for speed in [0.8, 1.2, 1.6] {
            match walked(&rig, speed * pace) {
                Some(gait) => columns.push((format!("{speed:.1} m/s"), gait, leg)),
                None => println!("{name}: no walk at {speed}"),
            }
        }
        columns.extend(captured.iter().cloned());
        print(&name, &columns);
    }
}

fn print(name: &str, columns: &[(String, Gait, f64)]) {
    let head: Vec<String> = columns.iter().map(|(title, gait, _)| format!("{title:>9} ({})", gait.strides)).collect();
    println!("\n{name:<32} {}   people", head.join("  "));
    let rows: Vec<Vec<_>> = columns.iter().map(|(_, gait, leg)| gait.rows(*leg)).collect();
    let Some(first) = rows.first() else { return };
    for (index, row) in first.iter().enumerate() {
        let digits = if row.mean.abs() < 0.1 { 4 } else { 2 };
        let cells: Vec<String> = rows
            .iter()
            .map(|rows| format!("{:>11.digits$}{}", rows[index].value, if rows[index].fits() { "  " } else { " !" }))
            .collect();
        let people: Vec<String> = rows.iter().map(|rows| format!("{:.digits$}", rows[index].mean)).collect();
        let steady = people.iter().all(|text| *text == people[0]);
        let people = if steady { people[0].clone() } else { people.join(" / ") };
        println!("{:<32} {}   {people} ±{}", row.name, cells.join(" "), row.spread);
    }
    let speeds: Vec<String> = columns.iter().map(|(_, gait, _)| format!("{:>11.3}  ", gait.speed)).collect();
    println!("{:<32} {}", "speed, m/s", speeds.join(" "));
}

/// A walk in the middle of a clip, as its keys play it.
fn walked(rig: &Rig, speed: f64) -> Option<Gait> {
    let walk = |start: f64, speed: f64| Walk { start, duration: None, speed, heading: 0.0, facing: None };
    let scenario = Scenario {
        title: "walk".into(),
        duration: 9.0,
        walk: vec![walk(0.5, speed), walk(7.0, 0.0)],
        ..Scenario::default()
    };
    let baked = bake(rig, &scenario, &BakeOptions::default()).ok()?;
    let poses = sampled(rig, &baked.clip, HZ);
    let motion = Motion { body: &baked.performance.timeline.body, hz: HZ, per_frame: 4, poses: &poses };
    gait(&Track::new(motion)?, &contacts::held(&baked.performance.contacts, Frame::World), 3.0, 7.0)
}

fn sampled(rig: &Rig, clip: &Clip, hz: f64) -> Vec<BodyPose> {
    let mut sampler = rig.sampler(clip);
    (0..=(clip.duration * hz) as usize).map(|sample| sampler.sample(sample as f64 / hz).pose()).collect()
}

/// A captured walk, its contacts by the parts of the soles that stand still.
fn recorded(data: &std::path::Path, name: &str) -> Option<(Gait, f64)> {
    let file = data.join("clips").join(name).with_extension("bvh");
    let capture = match mocap::load(&file).and_then(|clips| clips.capture(0, &mocap::Options::default())) {
        Ok(capture) => capture,
        Err(error) => {
            println!("skipped: {error}");
            return None;
        }
    };
    let poses: Vec<BodyPose> = (0..capture.frames())
        .map(|frame| BodyPose { hips: capture.at(frame)[0], turns: capture.turns_at(frame).to_vec() })
        .collect();
    let time = |frame: usize| frame as f64 / capture.fps;
    let contacts: Vec<HeldContact> = planted_parts(&capture)
        .into_iter()
        .map(|(planted, part, _)| HeldContact {
            side: planted.side,
            part,
            start: time(planted.start),
            end: time(planted.end + 1),
            point: glam::DVec3::ZERO,
            normal: glam::DVec3::Y,
            frame: Frame::World,
        })
        .collect();
    let motion = Motion { body: &capture.body, hz: capture.fps, per_frame: 4, poses: &poses };
    let leg = surefoot::whole_body::Anatomy::new(&capture.body).legs[0].length();
    Some((gait(&Track::new(motion)?, &contacts, 0.0, time(poses.len()))?, leg))
}

/// The captured walk with its forces, its contacts by the plates.
fn measured(data: &std::path::Path) -> Option<(Gait, f64)> {
    let file = data.join("forces/rajagopal_walk.glb");
    let Ok(rig) = load(&file) else {
        println!("skipped: the captured walk ({} is not there)", file.display());
        return None;
    };
    let clip = clips::read_clip(&rig, 0).ok()?;
    let poses = sampled(&rig, &clip, HZ);
    let table = std::fs::read_to_string(data.join("forces/rajagopal_walk_forces.csv")).ok()?;
    let mut contacts = Vec::new();
    for (side, column) in [(Side::Left, 13), (Side::Right, 14)] {
        let mut since: Option<f64> = None;
        let lines: Vec<(f64, bool)> = table
            .lines()
            .skip(1)
            .filter_map(|line| {
                let cells: Vec<&str> = line.split(',').collect();
                Some((cells.first()?.parse().ok()?, cells.get(column)?.trim() == "1"))
            })
            .collect();
        for (time, down) in lines.iter().copied().chain([(lines.last()?.0, false)]) {
            match (down, since) {
                (true, None) => since = Some(time),
                (false, Some(start)) => {
                    let held = HeldContact {
                        side,
                        part: Part::Flat,
                        start,
                        end: time,
                        point: glam::DVec3::ZERO,
                        normal: glam::DVec3::Y,
                        frame: Frame::World,
                    };
                    contacts.push(held);
                    since = None;
                }
                _ => {}
            }
        }
    }
    let motion = Motion { body: &rig.body, hz: HZ, per_frame: 4, poses: &poses };
    let leg = surefoot::whole_body::Anatomy::new(&rig.body).legs[0].length();
    Some((gait(&Track::new(motion)?, &contacts, -1.0, 10.0)?, leg))
}

//! Retargets clips to bodies and prints what came out: `cargo bench --bench retarget [-- FILTER [RIG]]`.
//!
//! slip, sink and float (mm) are those of the stances; slip in brackets is the source's own. "under" is the deepest sole anywhere. arms and legs are
//! degrees between a limb's directions in both (worst; mean and worst @ frame). pops: the source's / the target's. shake: how much more the pelvis
//! accelerates up and down, m/s2. With SUREFOOT_STRIPS=FOLDER every clip is drawn there beside its source.

#![expect(clippy::print_stdout, reason = "the table")]

#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
#[path = "../retarget_grid.rs"]
mod retarget_grid;

use glam::DVec3;
use retarget_grid::{FILES, bodies, clips, line, measured, poses};
use std::path::{Path, PathBuf};
use surefoot::measure::joints::joints;
use surefoot::measure::{Motion, Track};
use surefoot::mocap::retarget::{planted_parts, retarget};
use surefoot::model::{Body, Capture, Role};
use surefoot::picture::{Overlay, png, stick_strip};

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let verbose = std::env::args().any(|word| word == "-v");
    let data = data::place();
    if !data.is_dir() {
        println!("skipped: no data folder (set SUREFOOT_DATA)");
        return;
    }
    let strips = std::env::var_os("SUREFOOT_STRIPS").map(PathBuf::from);
    let wanted = |index: usize, text: &str| words.get(index).is_none_or(|word| text.contains(word.as_str()));
    let bodies = bodies(&data);
    for file in FILES {
        let captures = clips(&data, file, &|name| !name.contains("T-Pose") && (wanted(0, name) || wanted(0, file)));
        if !captures.is_empty() {
            println!("{file}");
        }
        for capture in captures.iter().filter(|capture| capture.frames() > 2) {
            if verbose {
                println!(
                    "    source: {} frames, {:.1} fps, leg {:.3}",
                    capture.frames(),
                    capture.fps,
                    capture.body.leg_length
                );
                for (planted, part, height) in planted_parts(capture) {
                    println!("    {:?} {}-{} {part:?} {:+.3}", planted.side, planted.start, planted.end, height);
                }
            }
            if let Some(folder) = &strips {
                draw(folder, "source", capture);
            }
            for (name, body) in bodies.iter().filter(|(name, _)| wanted(1, name)) {
                let target = retarget(capture, body);
                println!("{}", line(&capture.name, name, &measured(capture, &target)));
                if verbose {
                    println!("    lean at rest: {:.1} to {:.1} deg", lean(&capture.body), lean(body));
                    tell_pops(&target);
                    target.notes.iter().for_each(|note| println!("    note {note}"));
                }
                if let Some(folder) = &strips {
                    draw(folder, name.split('.').next().unwrap_or(name), &target);
                }
            }
        }
    }
}

/// How far the trunk leans forward at rest, degrees.
fn lean(body: &Body) -> f64 {
    let at = |role: Role| body.joint(role).map_or(DVec3::ZERO, |joint| body.joints[joint].rest);
    let trunk = at(Role::LeftUpperArm) + at(Role::RightUpperArm) - at(Role::LeftUpperLeg) - at(Role::RightUpperLeg);
    trunk.z.atan2(trunk.y).to_degrees()
}

fn tell_pops(capture: &Capture) {
    let poses = poses(capture);
    let motion = Motion { body: &capture.body, hz: capture.fps, per_frame: 1, poses: &poses };
    for pop in Track::new(motion).map(|track| joints(&track).pops).unwrap_or_default() {
        println!(
            "    pop {} at frame {:.0}: {:.1} deg",
            pop.role.name(),
            pop.time * capture.fps,
            pop.step.to_degrees()
        );
    }
}

fn draw(folder: &Path, body: &str, capture: &Capture) {
    let poses = poses(capture);
    let span = std::env::var("SUREFOOT_SPAN").unwrap_or_default();
    let mut ends = span.split('-').filter_map(|word| word.parse::<usize>().ok());
    let (from, to) = (ends.next().unwrap_or(0), ends.next().unwrap_or(poses.len() - 1).min(poses.len() - 1));
    let shown: Vec<(f64, surefoot::model::BodyPose)> = (0..12)
        .map(|at| from + (to - from) * at / 11)
        .map(|frame| (frame as f64 / capture.fps, poses[frame].clone()))
        .collect();
    let parts = planted_parts(capture);
    let overlays: Vec<Overlay> = shown
        .iter()
        .map(|(time, pose)| {
            let frame = (time * capture.fps).round() as usize;
            let holds = parts.iter().filter(|(planted, ..)| planted.start <= frame && frame <= planted.end);
            let contacts: Vec<_> = holds.map(|(planted, part, _)| (planted.side, *part)).collect();
            Overlay::of_pose(&capture.body, pose, &contacts)
        })
        .collect();
    let image = stick_strip(&capture.body, &shown, &overlays, &format!("{} {body}", capture.name));
    let path = folder.join(format!("{}_{body}.png", capture.name.replace(['/', ' '], "_")));
    std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&path, png(&image))).expect("the picture is written");
}

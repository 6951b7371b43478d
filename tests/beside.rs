//! Hand-keyed hits of a third-party rig beside baked shoves of it, over the same idle: the numbers of both, and with
//! `SUREFOOT_SHEETS=folder` a sheet of each pair, theirs in the upper row. The rig is not in this repository, nor are its pictures.

#![expect(clippy::print_stdout, reason = "the table, and what was skipped")]

use crate::data;
use crate::reaction::{Seen, delay, leaning, peak, settles};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use surefoot::bake::{BakeOptions, Baked, bake, base::prepare};
use surefoot::mocap;
use surefoot::model::scenario::{self, Direction, Push, Scenario};
use surefoot::model::{Clip, Role};
use surefoot::picture::compose::page;
use surefoot::picture::skin::surfaces;
use surefoot::picture::{Frame, Header, Layout, Trail, png, transforms_of_globals};
use surefoot::rig::{Rig, clips, load};

/// Theirs, and the shove that is ours: bone, heading (degrees), Ns, s.
const PAIRS: [(&str, Role, f64, f64, f64); 4] = [
    ("Hit_Chest", Role::Chest, 180.0, 35.0, 0.08),
    ("Hit_Head", Role::Head, 180.0, 25.0, 0.06),
    ("Hit_Chest", Role::LeftShoulder, 170.0, 90.0, 0.15),
    ("Push_Loop", Role::Chest, 180.0, 60.0, 0.4),
];

/// s, when ours is shoved.
const START: f64 = 1.0;

/// The shove over the rig's idle.
fn ours(rig: &Rig, file: &Path, (at, towards, impulse, seconds): (Role, f64, f64, f64)) -> Baked {
    let scenario = Scenario {
        title: "shove".into(),
        duration: 5.0,
        seed: 1,
        base: Some(scenario::Base { clip: Some("Idle_Loop".into()), file: None }),
        push: vec![Push {
            start: START,
            duration: seconds,
            force: impulse / seconds,
            toward: Direction::Heading(towards.to_radians()),
            at,
        }],
        ..Scenario::default()
    };
    let known = mocap::load(file).expect("its clips load");
    let index = known.find("Idle_Loop").expect("it stands");
    let reading = known.reading(index, &mocap::Options::default()).expect("it reads");
    let base = Arc::new(prepare(rig, &scenario, &reading, Some(index)).expect("it is a stand"));
    bake(rig, &scenario, &BakeOptions { base: Some(base), ..BakeOptions::default() }).expect("it bakes")
}

fn told(name: &str, seen: &Seen, feet: f64) {
    let arms = if peak(&seen.arms[0]).0 > peak(&seen.arms[1]).0 { &seen.arms[0] } else { &seen.arms[1] };
    let (trunk, head) = (peak(&leaning(&seen.trunk)), peak(&leaning(&seen.head)));
    println!(
        "{name:<28} {:>6.2} {:>5.1} at {:.2} | {:>5.1} at {:.2} | {:>5.1} | {:>5.1} at {:.2} | {:>6.2} {:>6.2} | {feet:>6.1}",
        delay(&seen.trunk),
        trunk.0,
        trunk.1,
        head.0,
        head.1,
        seen.twist.iter().map(|twist| (twist - seen.twist[0]).abs()).fold(0.0, f64::max),
        peak(arms).0,
        peak(arms).1,
        settles(&leaning(&seen.trunk)),
        settles(arms),
    );
}

/// cm, the farthest that an ankle is from where it was.
fn feet(rig: &Rig, clip: &Clip, [start, until]: [f64; 2]) -> f64 {
    let mut sampler = rig.sampler(clip);
    let ankles = [Role::LeftFoot, Role::RightFoot].map(|role| rig.body.joint(role).expect("a foot"));
    let first = sampler.sample(start).positions;
    let mut most = 0.0_f64;
    for tick in 0..=((until - start) * 30.0) as usize {
        let now = sampler.sample(start + tick as f64 / 30.0).positions;
        most = ankles.iter().map(|ankle| (now[*ankle] - first[*ankle]).with_y(0.0).length()).fold(most, f64::max);
    }
    100.0 * most
}

#[test]
fn hand_keyed_hits_and_baked_shoves_side_by_side() {
    let Some(file) = data::file("rigs/m2m_human_base_animations.glb") else { return };
    let rig = load(&file).expect("it loads");
    let names = clips::clip_names(&rig);
    println!(
        "clip                         trunk 1deg  peak | head          | twist | arm           | settle trunk, arms | feet cm"
    );
    for (theirs, at, towards, impulse, seconds) in PAIRS {
        let index = names.iter().position(|name| name == theirs).expect("the rig has it");
        let keyed = clips::read_clip(&rig, index).expect("it reads");
        let baked = ours(&rig, &file, (at, towards, impulse, seconds));
        let sampler = RefCell::new(rig.sampler(&keyed));
        let seen = Seen::over(&rig, [0.0, keyed.duration], keyed.duration, &mut |time| {
            sampler.borrow_mut().sample(time).pose()
        });
        told(&format!("{theirs} ({:.2} s)", keyed.duration), &seen, feet(&rig, &keyed, [0.0, keyed.duration]));
        let own = RefCell::new(rig.sampler(&baked.clip));
        let seen = Seen::over(&rig, [START, 5.0], START, &mut |time| own.borrow_mut().sample(time).pose());
        let name = format!("  {impulse} Ns in {seconds} s at {}", at.name());
        told(&name, &seen, feet(&rig, &baked.clip, [START, 5.0]));
        let trunk = peak(&leaning(&seen.trunk));
        assert!(trunk.0 > 2.0 && trunk.1 < 0.5, "{name}: the shove shows at once");
        if let Some(folder) = std::env::var_os("SUREFOOT_SHEETS") {
            let picture = sheet(&rig, (&keyed, theirs), (&baked.clip, &name));
            let path = PathBuf::from(folder).join(format!("{theirs}_{}.png", at.name()));
            std::fs::write(&path, picture).expect("the folder is there");
            println!("wrote {}", path.display());
        }
    }
}

/// Theirs over ours, at the same times from the hit on; below, how ours goes on.
fn sheet(rig: &Rig, theirs: (&Clip, &str), ours: (&Clip, &str)) -> Vec<u8> {
    const COLUMNS: usize = 8;
    let mut frames = Vec::new();
    let step = (theirs.0.duration / (COLUMNS - 1) as f64).min(0.12);
    for (clip, name, from, step) in
        [(theirs.0, theirs.1, 0.0, step), (ours.0, "ours", START, step), (ours.0, "ours, later", START + 0.3, 0.25)]
    {
        let mut sampler = rig.sampler(clip);
        for column in 0..COLUMNS {
            let time = from + column as f64 * step;
            let globals = sampler.node_globals(time.min(clip.duration)).to_vec();
            let transforms = transforms_of_globals(rig, &globals);
            frames.push(Frame {
                time: time - if from < START { 0.0 } else { START },
                label: name.to_owned(),
                surfaces: surfaces(rig, &transforms),
                ..Frame::default()
            });
        }
    }
    let header = Header {
        title: format!("{} and {}", theirs.1, ours.1.trim()),
        subtitle: "hand-keyed above; ours over Idle_Loop below; s from the hit".into(),
        badge: None,
    };
    let layout = Layout { width: 1500, columns: COLUMNS, view: 210, plan: 0 };
    png(&page(&frames, &Trail::default(), &header, &layout))
}

//! What a clip costs to read: frames a second of a 31-joint BVH, parsed and posed (to hold: 40,000), and of real FBX and glTF.

#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
use divan::{Bencher, counter::ItemsCount};
use std::fmt::Write;
use surefoot::mocap::{Options, load, read};

fn main() {
    divan::main();
}

/// Frames of the made clip.
const FRAMES: usize = 7_200;

/// A walker of CMU's 31 joints, a minute at 120 Hz.
fn walker() -> String {
    let mut joints: Vec<(&str, usize, [f64; 3])> = vec![("Hips", 0, [0.0, 0.0, 0.0])]; // name, depth, offset
    for (side, x) in [("Left", 1.0), ("Right", -1.0)] {
        let name = |bone: &str| -> &'static str { format!("{side}{bone}").leak() };
        joints.push((name("HipJoint"), 1, [0.0, 0.0, 0.0]));
        joints.push((name("UpLeg"), 2, [9.0 * x, -2.0, 0.0]));
        joints.push((name("Leg"), 3, [0.0, -41.0, 0.0]));
        joints.push((name("Foot"), 4, [0.0, -42.0, 0.0]));
        joints.push((name("ToeBase"), 5, [0.0, -5.0, 13.0]));
    }
    joints.extend([("LowerBack", 1, [0.0, 3.0, 0.0]), ("Spine", 2, [0.0, 12.0, 0.0]), ("Spine1", 3, [0.0, 12.0, 0.0])]);
    joints.extend([("Neck", 4, [0.0, 2.0, 0.0]), ("Neck1", 5, [0.0, 9.0, 0.0]), ("Head", 6, [0.0, 9.0, 0.0])]);
    for (side, x) in [("Left", 1.0), ("Right", -1.0)] {
        let name = |bone: &str| -> &'static str { format!("{side}{bone}").leak() };
        joints.push((name("Shoulder"), 4, [0.0, 2.0, 0.0]));
        joints.push((name("Arm"), 5, [17.0 * x, 10.0, 0.0]));
        joints.push((name("ForeArm"), 6, [28.0 * x, 0.0, 0.0]));
        joints.push((name("Hand"), 7, [25.0 * x, 0.0, 0.0]));
        joints.push((name("FingerBase"), 8, [0.0, 0.0, 0.0]));
        joints.push((name("HandIndex1"), 9, [4.0 * x, 0.0, 0.0]));
        joints.push((name("Thumb"), 8, [2.0 * x, 0.0, 3.0]));
    }
    let mut text = "HIERARCHY\n".to_owned();
    for (index, (name, depth, [x, y, z])) in joints.iter().enumerate() {
        let channels = if *depth == 0 { "6 Xposition Yposition Zposition" } else { "3" };
        let kind = if *depth == 0 { "ROOT" } else { "JOINT" };
        let next = joints.get(index + 1).map_or(0, |joint| joint.1);
        let _ =
            writeln!(text, "{kind} {name}\n{{\nOFFSET {x} {y} {z}\nCHANNELS {channels} Zrotation Yrotation Xrotation");
        if next <= *depth {
            text += "End Site\n{\nOFFSET 0 0 8\n}\n";
            text += &"}\n".repeat(depth + 1 - next);
        }
    }
    let _ = write!(text, "MOTION\nFrames: {FRAMES}\nFrame Time: 0.0083333\n");
    for frame in 0..FRAMES {
        let phase = frame as f64 * 0.05;
        let _ = write!(text, "{:.4} {:.4} {:.4}", phase.sin(), 92.0 + phase.cos(), frame as f64);
        for channel in 0..3 * joints.len() {
            let _ = write!(text, " {:.5}", 12.0 * (phase + channel as f64).sin());
        }
        text.push('\n');
    }
    text
}

#[divan::bench(sample_count = 10)]
fn bvh_of_31_joints(bencher: Bencher) {
    let text = walker();
    let nothing = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    bencher.counter(ItemsCount::new(FRAMES)).bench_local(|| {
        let file = read("walker.bvh", text.as_bytes(), &nothing, None).expect("a BVH");
        file.capture(0, &Options::default()).expect("a capture")
    });
}

#[divan::bench(args = ["clips/cmu_01_01_hops.bvh", "clips/pab_walk.fbx", "forces/rajagopal_walk.glb"], sample_count = 10)]
fn real(bencher: Bencher, clip: &str) {
    let path = data::place().join(clip);
    let Ok(file) = load(&path) else { return };
    let frames = file.capture(0, &Options::default()).map_or(0, |capture| capture.frames());
    bencher.counter(ItemsCount::new(frames)).bench_local(|| {
        let file = load(&path).expect("a clip");
        file.capture(0, &Options::default()).expect("a capture")
    });
}

//! The bodies of real rigs: plausible heights, masses, centres and soles. `--nocapture` prints the table.

#![expect(clippy::print_stdout, reason = "the table, and what was skipped")]

use crate::data;
use glam::DVec3;
use std::path::PathBuf;
use surefoot::model::{Body, Side};
use surefoot::rig::mannequin::{BUILTIN, MannequinOptions, mannequin};
use surefoot::rig::{Rig, load, load_bytes};
use surefoot::whole_body::{Anatomy, Solver, stand};

fn built_in(bytes: &[u8]) -> Rig {
    let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    load_bytes("builtin", bytes, &none, None).expect("the built-in rig loads")
}

fn centre_of_mass(body: &Body) -> DVec3 {
    let weighted: DVec3 =
        body.segments.iter().map(|segment| (body.joints[segment.joint].rest + segment.centre) * segment.mass).sum();
    weighted / body.mass
}

fn row(name: &str, rig: &Rig) {
    let body = &rig.body;
    let com = centre_of_mass(body);
    println!(
        "{name:32} h {:.3} m {:5.1} leg {:.3} com {:+.2},{:.3},{:+.2}",
        body.height,
        body.mass,
        body.leg_length,
        com.x,
        com.y / body.height,
        com.z
    );
    for foot in &body.feet {
        println!(
            "    ankle {:.3} heel {:+.3} ball {:+.3} tip {:+.3} half width {:.3} fwd {:+.2},{:+.2} level {:4.1} toe {:?} {:4.1} points {} {}",
            foot.ankle_height,
            foot.heel,
            foot.ball,
            foot.tip,
            foot.half_width,
            foot.forward.x,
            foot.forward.y,
            foot.level.angle_between(glam::DQuat::IDENTITY).to_degrees(),
            foot.toe,
            foot.toe_level.angle_between(glam::DQuat::IDENTITY).to_degrees(),
            foot.rear_sole.len(),
            foot.front_sole.len()
        );
    }
    for warning in &rig.mapping.warnings {
        println!("    ! {warning}");
    }
}

/// What no body may break, however it is drawn.
fn check(name: &str, rig: &Rig) {
    let body = &rig.body;
    let height = body.height;
    let sum: f64 = body.segments.iter().map(|segment| segment.mass).sum();
    assert!((sum / body.mass - 1.0).abs() < 1e-9, "{name}: segments weigh {sum} of {}", body.mass);
    let com = centre_of_mass(body);
    // Stylised rigs carry half their height in the head, which weighs no more for it.
    assert!((0.28..0.68).contains(&(com.y / height)), "{name}: centre of mass at {:.3}", com.y / height);
    for side in Side::BOTH {
        let foot = &body.feet[side as usize];
        let length = (foot.tip - foot.heel) / height;
        assert!((0.08..0.30).contains(&length), "{name} {side:?}: foot length {length:.3} of the height");
        assert!(foot.heel < foot.ball && foot.ball < foot.tip, "{name} {side:?}: {foot:?}");
        assert!(
            (0.02..0.14).contains(&(foot.half_width / height)) || length < 0.1,
            "{name} {side:?}: {}",
            foot.half_width
        );
        assert!(foot.ankle_height > 0.0 && foot.ankle_height < 0.2 * height, "{name}: {}", foot.ankle_height);
        assert!(foot.forward.y > 0.5, "{name} {side:?}: it points {}", foot.forward);
        for point in &foot.rear_sole {
            let above = (foot.level * *point).y + foot.ankle_height;
            assert!((-1e-6..0.05 * height).contains(&above), "{name} {side:?}: sole point {above} over the sole");
        }
    }
}

#[test]
fn real_rigs_have_plausible_bodies() {
    let Some(data) = data::folder() else { return };
    let mut files: Vec<PathBuf> = std::fs::read_dir(data.join("rigs"))
        .expect("the folder of rigs")
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| {
            path.extension().is_some_and(|ending| ["glb", "gltf", "vrm"].iter().any(|known| ending == *known))
        })
        .filter(|path| !path.to_string_lossy().contains("Fox"))
        .collect();
    files.sort();
    let mut count = 0;
    for path in files {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        // Whether each file maps is the loader's test, not this one's.
        let rig = match load(&path) {
            Ok(rig) => rig,
            Err(error) => {
                println!("{name}: not loaded: {error}");
                continue;
            }
        };
        row(&name, &rig);
        check(&name, &rig);
        count += 1;
    }
    assert!(count >= 11, "only {count} rigs");
}

/// Bones of the rigs that names do not find, by node name or index.
const NAMED_BY_HAND: [(&str, &str); 2] = [
    (
        "khronos_CesiumMan.gltf",
        "[bones]\nhips = 2\nspine = 11\nchest = 12\nneck = 19\nhead = 20\n\
         leftUpperArm = 16\nleftLowerArm = 17\nleftHand = 18\nrightUpperArm = 13\nrightLowerArm = 14\nrightHand = 15\n\
         leftUpperLeg = 7\nleftLowerLeg = 8\nleftFoot = 9\nleftToes = 10\n\
         rightUpperLeg = 3\nrightLowerLeg = 4\nrightFoot = 5\nrightToes = 6\n",
    ),
    (
        "sketchbook_boxman.glb",
        "[bones]\nhips = \"body_lower\"\nspine = \"body_upper\"\nhead = \"head\"\n\
         leftUpperArm = \"arm_upper.L\"\nleftLowerArm = \"arm_lower.L\"\n\
         rightUpperArm = \"arm_upper.R\"\nrightLowerArm = \"arm_lower.R\"\n\
         leftUpperLeg = \"leg_upper.L\"\nleftLowerLeg = \"leg_lower.L\"\n\
         rightUpperLeg = \"leg_upper.R\"\nrightLowerLeg = \"leg_lower.R\"\n",
    ),
];

#[test]
fn rigs_without_feet_or_in_mid_stride_stand_on_their_soles() {
    let Some(data) = data::folder() else { return };
    for (name, bones) in NAMED_BY_HAND {
        let bytes = std::fs::read(data.join("rigs").join(name)).expect("the rig's file");
        let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        let rig = load_bytes(name, &bytes, &none, Some(bones)).unwrap_or_else(|error| panic!("{name}: {error}"));
        row(name, &rig);
        check(name, &rig);
    }
}

#[test]
fn the_built_in_rig_is_the_papers_character() {
    let rig = built_in(BUILTIN);
    row("builtin", &rig);
    check("builtin", &rig);
    let body = &rig.body;
    assert!((body.height - 1.70).abs() < 2e-3, "{}", body.height);
    assert!((body.mass - 89.5).abs() < 1e-9, "{}", body.mass);
    assert!((body.leg_length - 0.83).abs() < 2e-3, "{}", body.leg_length);
    assert!(rig.mapping.warnings.is_empty(), "{:?}", rig.mapping.warnings);
}

#[test]
fn other_heights_and_legs_come_out_as_asked() {
    let child = built_in(&mannequin(&MannequinOptions { height: 1.2, ..MannequinOptions::default() }));
    assert!((child.body.height - 1.2).abs() < 2e-3, "{}", child.body.height);
    assert!((child.body.mass - 89.5 * (1.2f64 / 1.7).powi(2)).abs() < 1e-3, "{}", child.body.mass);
    let tall =
        built_in(&mannequin(&MannequinOptions { leg_scale: 1.3, mass: Some(70.0), ..MannequinOptions::default() }));
    assert!((tall.body.leg_length - 0.83 * 1.3).abs() < 2e-3, "{}", tall.body.leg_length);
    assert!((tall.body.height - 1.70 - 0.3 * 0.83).abs() < 2e-3, "{}", tall.body.height);
    assert!((tall.body.mass - 70.0).abs() < 1e-9, "{}", tall.body.mass);
    let odd = built_in(&mannequin(&MannequinOptions { height: f64::NAN, leg_scale: -1.0, mass: Some(f64::NAN) }));
    check("odd options", &odd);
}

/// The rig of a file, where the data folder is there.
fn real(name: &str) -> Option<Rig> {
    Some(load(&data::folder()?.join("rigs").join(name)).unwrap_or_else(|error| panic!("{name}: {error}")))
}

#[test]
fn a_robots_eyes_are_of_its_height_and_hair_knots_are_not() {
    let (Some(robot), Some(girl)) = (real("vrm1_debug_robot.vrm"), real("godette_vrm0.vrm")) else { return };
    assert!((robot.body.height - 2.23).abs() < 0.01, "{}", robot.body.height);
    assert!((girl.body.height - 1.387).abs() < 0.01, "{}", girl.body.height);
}

#[test]
fn a_bevelled_shoe_ends_where_it_bears() {
    let Some(rig) = real("khronos_CesiumMan.gltf") else { return };
    for foot in &rig.body.feet {
        let over = |point: &DVec3| (foot.level * *point).y + foot.ankle_height;
        let bearing = foot.front_sole.iter().filter(|point| over(point) < 0.001).map(|point| {
            let levelled = foot.level * *point;
            levelled.x * foot.forward.x + levelled.z * foot.forward.y
        });
        let most = bearing.fold(0.0, f64::max);
        // Between them lies the bevel, which 45 degrees of pitch bring down.
        assert!(
            (0.0..0.008).contains(&(foot.tip - most)),
            "the tip is at {:.4}, the sole bears to {most:.4}",
            foot.tip
        );
    }
}

#[test]
fn wide_clothes_spread_the_arms_and_narrow_hips_do_not() {
    let spread = |name: &str| real(name).map(|rig| Anatomy::new(&rig.body).arms.map(|arm| arm.widen.to_degrees()));
    let Some([left, right]) = spread("godette_vrm0.vrm") else { return };
    assert!((5.0..20.0).contains(&left) && (left - right).abs() < 0.001, "shorts that stand off: {left} and {right}");
    for name in ["m2m_human_male.glb", "gdquest_mannequiny.glb", "sketchbook_boxman.glb"] {
        assert_eq!(spread(name), Some([0.0; 2]), "{name}");
    }
}

#[test]
fn a_knee_that_swivels_goes_to_the_side_and_leaves_hip_and_foot_where_they_are() {
    let rig = built_in(BUILTIN);
    let anatomy = Anatomy::new(&rig.body);
    let physique = stand::physique(&rig.body, &anatomy);
    let plants = stand::natural_plants(physique.stance_width, physique.com_forward);
    let low = DVec3::Y * (physique.com_height - 0.15);
    let solved = |swivel: f64| {
        let mut target = stand::stand_target(&rig.body, &plants, low, 0.0);
        target.feet[0].swivel = swivel;
        let solved = Solver::new(&rig.body, &anatomy).solve(&target);
        (solved.pose.positions(&rig.body), solved.knees[0])
    };
    let ((straight, bend), (turned, still)) = (solved(0.0), solved(0.2));
    let leg = &anatomy.legs[0];
    let moved = |joint: usize| turned[joint] - straight[joint];
    // The thigh's mass moves, and the pelvis a little against it.
    assert!(
        moved(leg.upper).length() < 8e-3 && moved(leg.foot).length() < 1e-6,
        "{} {}",
        moved(leg.upper),
        moved(leg.foot)
    );
    assert!((still - bend).abs() < 0.02 && bend > 0.8, "bends of {bend} and {still} rad");
    let across = leg.thigh_length * (bend * 0.5).sin() * 0.2; // a knee's distance from the line, turned
    assert!((moved(leg.lower).x + across).abs() < 0.3 * across, "{} for {across} to the right", moved(leg.lower));
}

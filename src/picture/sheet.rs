//! The contact sheet of a clip: the skinned rig at its telling moments, and the film, the same at equal distances.
//!
//! A clip is anything that answers "which pose at t": the picture computes the body and its [`super::balance`] from the
//! pose itself, contacts ([`super::footing`]) and pushes from the report. Where the caller knows better (the simulation's own ξ, a
//! measured centre of pressure) it hands in an overlay.

use super::balance::{centre_of_mass, extrapolated, pushes, trail};
use super::compose::{Frame, Header, Layout, page};
use super::footing::{Spell, contact_at, laid, prints, sole, spells};
use super::marks::Overlay;
use super::moments::{Moment, even_moments};
use super::skin::{NodeTransforms, surfaces};
use super::stage::Stage;
use crate::model::report::Outcome;
use crate::model::{ClipReport, Prop, Side};
use crate::rig::Rig;
use image::RgbaImage;

/// What a sheet is made from.
pub struct SheetInput<'a> {
    /// Whose clip.
    pub rig: &'a Rig,
    /// The pose at a time, s: see [`super::skin::transforms_of_globals`].
    pub pose: &'a dyn Fn(f64) -> NodeTransforms,
    /// What the clip says about itself.
    pub report: &'a ClipReport,
    /// Marks that replace the computed ones where they are given: com, xi, cop; pushes and soles where not empty.
    pub overlay: Option<&'a dyn Fn(f64) -> Overlay>,
    /// What stands and moves beside the body; without a ground among them it is flat and has no end.
    pub props: &'a [Prop],
    /// Which moments; [`super::choose_moments`] finds them.
    pub moments: Vec<Moment>,
    /// Sizes.
    pub layout: Layout,
}

/// The sheet.
pub fn sheet(input: &SheetInput) -> RgbaImage {
    let spells = spells(input);
    let frames: Vec<Frame> = input.moments.iter().map(|moment| frame(input, &spells, moment)).collect();
    page(&frames, &trail(input), &header(input.report), &input.layout)
}

/// `count` pictures at equal distances, small: for judging the motion itself.
pub fn film(input: &SheetInput, count: usize) -> RgbaImage {
    let layout = Layout { columns: 10, view: 150, plan: 0, ..input.layout };
    let moments = even_moments(input.report.duration, count.clamp(2, 200));
    let SheetInput { rig, pose, report, overlay, props, .. } = *input;
    sheet(&SheetInput { rig, pose, report, overlay, props, moments, layout })
}

fn frame<'a>(input: &SheetInput<'a>, spells: &[Spell], moment: &Moment) -> Frame<'a> {
    let time = moment.time;
    let transforms = (input.pose)(time);
    let mut overlay = Overlay {
        com: Some(centre_of_mass(input.rig, &transforms)),
        xi: extrapolated(input, time),
        pushes: pushes(input, time, &transforms),
        soles: Side::BOTH
            .into_iter()
            .filter_map(|side| contact_at(input.report, side, time))
            .map(|contact| laid(input, contact, time, sole(input.rig, contact.foot, contact.part, &transforms)))
            .collect(),
        ..Overlay::default()
    };
    if let Some(known) = input.overlay.map(|overlay| overlay(time)) {
        overlay.com = known.com.or(overlay.com);
        overlay.xi = known.xi.or(overlay.xi);
        overlay.cop = known.cop.or(overlay.cop);
        if !known.pushes.is_empty() {
            overlay.pushes = known.pushes;
        }
        if !known.soles.is_empty() {
            overlay.soles = known.soles;
        }
        overlay.prints = known.prints;
    }
    if overlay.prints.is_empty() {
        overlay.prints = prints(input, spells, time);
    }
    let stage = Stage::at(input.props, time);
    Frame { time, label: moment.label.clone(), surfaces: surfaces(input.rig, &transforms), overlay, stage }
}

/// Title, outcome and the numbers that decide; of a clip that was not baked here, which tells none, only its length and its body.
fn header(report: &ClipReport) -> Header {
    let length = format!("{:.1} s", report.duration);
    let body = format!("{:.1} kg, {:.2} m", report.body.mass, report.body.height);
    if report.generator.is_empty() {
        return Header { title: report.scenario.clone(), subtitle: [length, body].join("  ·  "), badge: None };
    }
    let (word, color) = match report.outcome {
        Outcome::Still => ("still", [110, 118, 128]),
        Outcome::Sway => ("sway", [32, 128, 140]),
        Outcome::Step => ("step", [26, 122, 74]),
        Outcome::Fall => ("fall", [190, 38, 38]),
    };
    let plausibility = &report.plausibility;
    let steps = if report.steps == 1 { "1 step".to_owned() } else { format!("{} steps", report.steps) };
    let numbers = [
        steps,
        length,
        body,
        format!("plausibility {:.2}", plausibility.score),
        format!("ZMP inside {:.0} %", plausibility.zmp_inside * 100.0),
        format!("slip {:.1} mm", plausibility.slip_max_mm),
        format!("penetration {:.1} mm", plausibility.penetration_max_mm),
        format!("ankle {:.1} m/s", plausibility.peak_ankle_speed),
    ];
    Header { title: report.scenario.clone(), subtitle: numbers.join("  ·  "), badge: Some((word.to_owned(), color)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{BodyPose, Role};
    use crate::picture::figure::{capsule, side_color};
    use crate::picture::moments::tests::pushed;
    use crate::picture::skin::{body_pose, transforms_of_locals};
    use crate::picture::strip::tests::person;
    use crate::picture::{choose_moments, marks, png};
    use crate::rig::{Document, Mapping, MeshPart, RigNode, Similarity, Trs};
    use glam::{DAffine3, DQuat, DVec3};

    const TAN: [u8; 3] = [205, 150, 90];

    #[test]
    fn a_clip_that_was_not_baked_here_is_given_no_outcome_and_no_numbers() {
        let mut report = pushed();
        report.generator = "surefoot".to_owned();
        assert!(header(&report).badge.is_some() && header(&report).subtitle.contains("plausibility"));
        report.generator.clear();
        let foreign = header(&report);
        assert!(foreign.badge.is_none() && !foreign.subtitle.contains("plausibility"), "{}", foreign.subtitle);
    }

    /// A skinned person in a file that is in centimetres with Z up: node `j + 1` is joint `j`, node 0 turns and scales.
    fn tan_rig() -> Rig {
        let body = person();
        let axes = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
        let node = |parent: Option<usize>, local: Trs| RigNode {
            name: None,
            parent,
            children: vec![],
            local,
            bind: local,
            has_matrix: false,
            mesh: None,
            skin: None,
        };
        let mut nodes = vec![node(None, Trs { rotation: axes, scale: DVec3::splat(100.0), ..Trs::IDENTITY })];
        let mut mesh = Vec::new();
        for (index, joint) in body.joints.iter().enumerate() {
            let local = Trs { translation: body.offset(index), ..Trs::IDENTITY };
            nodes.push(node(Some(joint.parent.map_or(0, |parent| parent + 1)), local));
            let Some(parent) = joint.parent else { continue };
            let start = body.joints[parent].rest;
            let limb = capsule(start, joint.rest, DQuat::IDENTITY, [0.06, 0.05], 1.0, [1.0; 3]);
            let axis = joint.rest - start;
            let weights = limb.positions.iter().map(|point| {
                let share = ((*point - start).dot(axis) / axis.length_squared() - 0.8).clamp(0.0, 0.2) * 2.5;
                [(parent + 1, 1.0 - share), (index + 1, share), (0, 0.0), (0, 0.0)]
            });
            mesh.push(MeshPart {
                weights: weights.collect(),
                uvs: vec![],
                indices: limb.indices.into_owned(),
                positions: limb.positions,
                normals: limb.normals,
                base_color: [TAN[0], TAN[1], TAN[2], 255].map(crate::picture::raster::to_linear),
                base_texture: None,
            });
        }
        Rig {
            document: Document {
                json: serde_json::Value::Null,
                buffers: vec![],
                glb_buffer: false,
                images: vec![],
                image_files: vec![],
            },
            leg_scales: Default::default(),
            joint_nodes: (0..body.joints.len()).map(|joint| Some(joint + 1)).collect(),
            nodes,
            document_from_scenario: Similarity { scale: 100.0, rotation: axes, translation: DVec3::ZERO },
            mapping: Mapping {
                method: "test".to_owned(),
                confidence: 1.0,
                bones: Default::default(),
                warnings: vec![],
                up: "+Z".to_owned(),
                forward: "-Y".to_owned(),
            },
            body,
            mesh,
        }
    }

    /// The whole body `right` metres to its right at the end, the left arm raised by `raise`.
    fn posed(rig: &Rig, right: f64, raise: f64) -> NodeTransforms {
        let mut locals: Vec<Trs> = rig.nodes.iter().map(|node| node.bind).collect();
        let arm = rig.body.joint(Role::LeftUpperArm).expect("a person has arms") + 1;
        locals[arm].rotation = DQuat::from_rotation_z(raise);
        transforms_of_locals(rig, &locals, DAffine3::from_translation(DVec3::new(-100.0 * right, 0.0, 0.0)))
    }

    fn draw(rig: &Rig, raise: f64, report: &ClipReport, moments: Vec<Moment>) -> RgbaImage {
        let pose = |time: f64| posed(rig, 0.15 * time, raise);
        sheet(&SheetInput { rig, pose: &pose, report, overlay: None, props: &[], moments, layout: Layout::default() })
    }

    fn one(time: f64) -> Vec<Moment> {
        vec![Moment { time, label: String::new() }]
    }

    /// Pixels of the front view (one moment a page) whose hue is that colour's, whatever the light makes of it.
    fn seen(image: &RgbaImage, color: [u8; 3]) -> Vec<(u32, u32)> {
        let hue = |pixel: [u8; 3]| {
            let grey = (f64::from(pixel[0]) + f64::from(pixel[1]) + f64::from(pixel[2])) / 3.0;
            DVec3::from(pixel.map(|channel| f64::from(channel) - grey))
        };
        let wanted = hue(color);
        // Not the corner with the small soles.
        let front = image.enumerate_pixels().filter(|(x, y, _)| *x < 1350 && (58..58 + 214).contains(y));
        front
            .filter(|(_, _, pixel)| {
                let found = hue([pixel[0], pixel[1], pixel[2]]);
                found.length() > 0.45 * wanted.length() && found.normalize().dot(wanted.normalize()) > 0.985
            })
            .map(|(x, y, _)| (x, y))
            .collect()
    }

    fn middle(pixels: &[(u32, u32)]) -> f64 {
        pixels.iter().map(|(x, _)| f64::from(*x)).sum::<f64>() / pixels.len().max(1) as f64
    }

    #[test]
    fn the_bind_pose_moves_nothing_and_a_turned_node_moves_its_mesh_as_the_body_moves() {
        let rig = tan_rig();
        let locals: Vec<Trs> = rig.nodes.iter().map(|node| node.bind).collect();
        let still = transforms_of_locals(&rig, &locals, DAffine3::IDENTITY);
        assert!(still.iter().all(|transform| transform.abs_diff_eq(DAffine3::IDENTITY, 1e-9)));
        let transforms = posed(&rig, 0.2, 1.0);
        let pose = body_pose(&rig, &transforms);
        let mut wanted = BodyPose::rest(&rig.body);
        wanted.hips.x -= 0.2;
        let hand = rig.body.joint(Role::LeftHand).expect("hand");
        let elbow = rig.body.joint(Role::LeftLowerArm).expect("elbow");
        let shoulder = rig.body.joint(Role::LeftUpperArm).expect("shoulder");
        for joint in [shoulder, elbow, hand] {
            wanted.turns[joint] = DQuat::from_rotation_z(1.0);
        }
        let (found, wanted) = (pose.positions(&rig.body), wanted.positions(&rig.body));
        assert!(found.iter().zip(&wanted).all(|(found, wanted)| found.distance(*wanted) < 1e-9));
        assert!(wanted[hand].distance(rig.body.joints[hand].rest) > 0.3, "the arm was to move");
        let skinned = transforms[elbow + 1].transform_point3(rig.body.joints[hand].rest);
        assert!(skinned.distance(wanted[hand]) < 1e-9, "mesh and body part by {}", skinned.distance(wanted[hand]));
    }

    #[test]
    fn the_body_stands_in_the_middle_and_its_left_arm_rises_on_the_right() {
        let rig = tan_rig();
        let report = ClipReport { disturbances: vec![], ..pushed() };
        let hanging = seen(&draw(&rig, 0.0, &report, one(0.2)), TAN);
        let raised = seen(&draw(&rig, 1.4, &report, one(0.2)), TAN);
        assert!(hanging.len() > 2000, "{} pixels of body", hanging.len());
        assert!((middle(&hanging) - 700.0).abs() < 4.0, "middle at {}", middle(&hanging));
        let far = |pixels: &[(u32, u32)], from: i64, to: i64| {
            let low = pixels.iter().map(|(x, _)| i64::from(*x)).min().unwrap_or(0);
            pixels.iter().filter(|(x, _)| (from..to).contains(&(i64::from(*x) - low))).count()
        };
        assert_eq!(far(&hanging, 90, 400), 0, "a hanging body is narrow");
        assert!(far(&raised, 90, 400) > 150, "the raised arm reaches out to the right");
    }

    #[test]
    fn a_push_from_the_left_is_a_red_arrow_on_the_right_only_while_it_lasts() {
        let rig = tan_rig();
        let during = draw(&rig, 0.0, &pushed(), one(0.7));
        let red = seen(&during, marks::PUSH);
        assert!(red.len() > 150, "{} red pixels", red.len());
        assert!(middle(&red) > middle(&seen(&during, TAN)) + 20.0, "the arrow stands at {}", middle(&red));
        let before = seen(&draw(&rig, 0.0, &pushed(), one(0.5)), marks::PUSH);
        // A pixel where the mark of ξ fades into the body may be as red: not an arrow.
        assert!(before.len() * 50 < red.len(), "nothing pushes yet: {before:?}");
    }

    #[test]
    fn each_foot_shows_its_colour_only_while_it_holds() {
        let rig = tan_rig();
        let blue_green = |time: f64| {
            let image = draw(&rig, 0.0, &pushed(), one(time));
            Side::BOTH.map(|side| seen(&image, side_color(side)).len())
        };
        let both = blue_green(0.2);
        assert!(both[0] > 35 && both[1] > 35, "both feet hold: {both:?}");
        let left = blue_green(0.9);
        assert!(left[0] > 35 && left[1] < both[1] / 2, "the right foot swings: {left:?}");
        let right = blue_green(1.3);
        assert!(right[1] > 35 && right[0] < both[0] / 2, "the left foot swings: {right:?}");
    }

    #[test]
    fn the_same_sheet_twice_has_the_same_bytes_and_another_pose_has_others() {
        let rig = tan_rig();
        let page = |raise: f64| png(&draw(&rig, raise, &pushed(), choose_moments(&pushed(), 12)));
        let first = page(0.3);
        assert!(first.starts_with(b"\x89PNG") && first.len() > 20_000);
        assert_eq!(first, page(0.3));
        assert_ne!(first, page(0.4));
    }

    #[test]
    fn poses_that_are_not_numbers_leave_an_empty_page_and_no_panic() {
        let rig = tan_rig();
        let pose = |_: f64| vec![DAffine3::from_scale(DVec3::NAN); rig.nodes.len()];
        let report = pushed();
        let moments = choose_moments(&report, 12);
        let input = SheetInput {
            rig: &rig,
            pose: &pose,
            report: &report,
            overlay: None,
            props: &[],
            moments,
            layout: Layout::default(),
        };
        assert_eq!(sheet(&input).width(), 1400);
        assert_eq!(film(&input, 30).width(), 1400);
        assert_eq!(sheet(&SheetInput { moments: vec![], ..input }).width(), 1400);
    }
}

//! A moment of the audit's desk as a scene of the viewport: the clip as it will be, as it was, and where the pendulum puts the feet.
//!
//! Clip space (metres, Y up); a floor that is not at 0 becomes a ground of its own.

use super::audit_desk::AuditScene;
use super::viewport::{Figure, Marks, Scene, Viewport};
use crate::model::props::{Mesh, Shape};
use crate::model::report::Part;
use crate::model::{Body, BodyPose, Prop};
use crate::picture::SoleMark;
use eframe::egui;
use glam::DVec3;
use std::f64::consts::TAU;

/// m, the ring around a predicted footstep.
const RING: f64 = 0.07;
/// m, half of the ground's edge.
const AROUND: f64 = 30.0;
/// Linear RGB of that ground.
const STONE: [f32; 3] = [0.32, 0.34, 0.36];

/// Draws it.
pub fn ui(ui: &mut egui::Ui, viewport: &mut Viewport, scene: &AuditScene) {
    let coming = scene.steps.iter().map(|step| {
        let radius = if step.selected { RING * 1.6 } else { RING };
        let ring: Vec<DVec3> = (0..24).map(|part| ring(step.predicted, radius, f64::from(part) / 24.0)).collect();
        SoleMark { side: step.side, part: Part::Flat, whole: ring.clone(), held: ring }
    });
    let marks =
        Marks { overlay: scene.overlay.clone(), coming: coming.collect(), ground: scene.floor, ..Marks::default() };
    let props: Vec<Prop> = (scene.floor.abs() > 1e-3).then(|| ground(scene.floor)).into_iter().collect();
    let mut figures = Vec::new();
    let mut capsules: Vec<(&Body, &BodyPose, bool)> = Vec::new();
    match (scene.rig, &scene.nodes) {
        (Some(rig), Some((nodes, ghost))) => {
            figures.push(Figure { rig, pose: nodes, ghost: false });
            figures.extend(ghost.as_ref().map(|pose| Figure { rig, pose, ghost: true }));
        }
        _ => {
            capsules.push((scene.body, &scene.pose, false));
            capsules.extend(scene.ghost.as_ref().map(|ghost| (scene.body, ghost, true)));
        }
    }
    // A push by hand has no meaning here.
    viewport.ui(ui, &Scene { figures: &figures, capsules: &capsules, props: &props, time: scene.time, marks: &marks });
}

fn ring(middle: DVec3, radius: f64, share: f64) -> DVec3 {
    middle + DVec3::new((share * TAU).cos(), 0.0, (share * TAU).sin()) * radius
}

fn ground(height: f64) -> Prop {
    let corner = |x: f64, z: f64| DVec3::new(x * AROUND, height, z * AROUND);
    let mesh = Mesh {
        positions: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
        normals: vec![DVec3::Y; 4],
        indices: vec![0, 1, 2, 0, 2, 3],
    };
    Prop { ground: true, ..Prop::standing("ground", Shape::Mesh(mesh), STONE) }
}

//! The viewport: rigs, figures, ground and things in 3D, and what is known of their balance over them.
//!
//! [`Viewport::ui`] reads a [`Scene`] of plain references, moves its own camera and gives back a push by hand; it changes nothing else. What is to be
//! drawn becomes one plain `Frame`; a paint callback draws it by wgpu into targets of its own and brings it into egui's
//! pass. Without [`install`] (no graphics card, tests without a renderer) the place stays empty and everything else works.
//! Scenario space, metres.

mod buffers;
mod callback;
pub mod camera;
mod colors;
mod frame;
mod geometry;
mod gpu;
pub mod input;
pub mod marks;
mod overlay;
pub mod pick;
mod view;

pub use callback::{draw_calls, install, install_with};
pub use camera::Camera;
pub use gpu::Quality;
pub use input::{Grip, GripPhase};
pub use marks::{Marks, Tracks};

use crate::model::props::{Prop, Shape};
use crate::model::{Body, BodyPose};
use crate::picture::NodeTransforms;
use crate::picture::skin::body_pose;
use crate::rig::Rig;
use camera::Sight;
use colors::Colors;
use eframe::egui::{self, Sense, Ui, UiBuilder, Vec2, WidgetInfo};
use eframe::egui_wgpu::Callback as PaintCallback;
use frame::Frame;
use glam::DVec3;
use input::{Held, Standing, ViewKey};
use std::borrow::Cow;
use std::sync::Arc;

/// m, ground this near to 0 is the flat one.
const LEVEL: f64 = 1e-6;

/// A view: its camera, what it shows, and what is in hand.
#[derive(Clone, Debug, Default)]
pub struct Viewport {
    /// From where it looks.
    pub camera: Camera,
    /// What it shows.
    pub show: Show,
    held: Option<Held>,
    /// It has seen a character.
    framed: bool,
    /// The shapes of the scene's props as they were, in the scene's order.
    shapes: Vec<Kept>,
}

/// A shape that is on the graphics card.
#[derive(Clone, Debug)]
struct Kept {
    shape: Arc<Shape>,
    /// It is nothing but the flat ground.
    level: bool,
}

/// What is shown of what is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the switches say it")]
pub struct Show {
    pub contacts: bool,
    pub footprints: bool,
    pub com: bool,
    pub xi: bool,
    pub cop: bool,
    pub support: bool,
    pub regions: bool,
    pub forces: bool,
    pub trail: bool,
    pub ghost: bool,
    pub props: bool,
}

/// A rig in a pose.
#[derive(Clone, Copy, Debug)]
pub struct Figure<'a> {
    /// The rig; uploaded once, by the identity of the `Arc`.
    pub rig: &'a Arc<Rig>,
    /// See [`crate::picture::transforms_of_globals`].
    pub pose: &'a NodeTransforms,
    /// It shines through and throws no shadow.
    pub ghost: bool,
}

/// What is to be seen.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Rigs; the first that is no ghost is the character.
    pub figures: &'a [Figure<'a>],
    /// Bodies without a rig; true: a ghost.
    pub capsules: &'a [(&'a Body, &'a BodyPose, bool)],
    /// Ground and things.
    pub props: &'a [Prop],
    /// s.
    pub time: f64,
    /// What is known of the balance.
    pub marks: &'a Marks,
}

impl Default for Show {
    fn default() -> Show {
        Show {
            contacts: true,
            footprints: true,
            com: true,
            xi: true,
            cop: true,
            support: true,
            regions: false,
            forces: true,
            trail: true,
            ghost: true,
            props: true,
        }
    }
}

impl Show {
    /// Nothing but figures, ground and things.
    pub fn none() -> Show {
        Show {
            contacts: false,
            footprints: false,
            com: false,
            xi: false,
            cop: false,
            support: false,
            regions: false,
            forces: false,
            trail: false,
            ghost: true,
            props: true,
        }
    }

    /// Each with its name and what it means.
    fn switches(&mut self) -> [(&mut bool, &'static str, &'static str); 11] {
        [
            (&mut self.contacts, "Contacts", "Soles that hold the ground now: left blue, right green"),
            (&mut self.footprints, "Footprints", "Where feet stood, and outlines where they will"),
            (&mut self.com, "Centre of mass", "With its plumb line"),
            (&mut self.xi, "Extrapolated centre of mass", "ξ: where it would come to rest over a foot"),
            (&mut self.cop, "Centre of pressure", "Where the ground pushes back"),
            (&mut self.support, "Support polygon", "The hull of the soles that hold"),
            (
                &mut self.regions,
                "Regions",
                "ξ in the green: nothing to do. In the yellow: the ankles hold. In the red: a step",
            ),
            (&mut self.forces, "Forces", "Pushes, pulls and hits as they act"),
            (&mut self.trail, "Trail", "The way of the centre of mass"),
            (&mut self.ghost, "Ghost", "The figure to compare with"),
            (&mut self.props, "Ground and things", "Slopes, stairs, platform, balls and boxes"),
        ]
    }
}

/// Joints of a figure.
struct Seen<'a> {
    body: &'a Body,
    pose: Cow<'a, BodyPose>,
    positions: Vec<DVec3>,
    ghost: bool,
}

impl Seen<'_> {
    /// m, the middle of its joints and how far they reach, with the flesh around them.
    fn ball(&self) -> (DVec3, f64) {
        let finite = || self.positions.iter().filter(|point| point.is_finite());
        let low = finite().fold(DVec3::INFINITY, |low, point| low.min(*point));
        let high = finite().fold(DVec3::NEG_INFINITY, |high, point| high.max(*point));
        let middle = (low + high) * 0.5 + DVec3::Y * 0.02 * self.body.height;
        (middle, (high - low).max_element() * 0.5 + 0.11 * self.body.height)
    }

    /// m, under its hips, at the height of its lowest joint over that of the rest pose.
    fn anchor(&self) -> DVec3 {
        let rest = self.body.joints.iter().map(|joint| joint.rest.y).fold(f64::INFINITY, f64::min);
        let lowest = self.positions.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
        DVec3::new(self.pose.hips.x, lowest - rest, self.pose.hips.z)
    }
}

impl Viewport {
    /// Shows a scene in all the room there is; a push by hand, if there is one.
    pub fn ui(&mut self, ui: &mut Ui, scene: &Scene) -> Option<Grip> {
        let (rect, response) =
            ui.allocate_exact_size(ui.available_size().max(Vec2::splat(8.0)), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Canvas, true, "Viewport"));
        let seen = seen(scene);
        let character = seen.iter().find(|seen| !seen.ghost).or(seen.first());
        let across = f64::from(rect.width() / rect.height().max(1.0));
        if let Some(character) = character {
            self.see(ui, character, across);
        }
        let corner = egui::Rect::from_min_size(rect.right_top() + Vec2::new(-66.0, 8.0), Vec2::new(58.0, 22.0));
        input::move_camera(ui, &response, &mut self.camera, self.held.is_some());
        match (input::key(ui, &response), character) {
            (Some(ViewKey::Look(from)), _) => self.camera.look(from),
            (Some(ViewKey::Frame), Some(character)) => {
                let (middle, radius) = character.ball();
                self.camera.frame(middle, radius, across);
            }
            _ => {}
        }
        let sight = Sight::new(&self.camera, rect);
        let standing = character.map(|seen| Standing { body: seen.body, positions: &seen.positions });
        let grip = input::push(ui, &response, &self.camera, &sight, standing.as_ref(), &mut self.held);
        let colors = Colors::of(ui.visuals().dark_mode);
        if ui.is_rect_visible(rect) {
            let painter = ui.painter_at(rect);
            let scale = ui.ctx().pixels_per_point();
            let size = [rect.width(), rect.height()].map(|length| (length * scale).round().clamp(1.0, 16384.0) as u32);
            let frame = self.frame(scene, &seen, size, &colors);
            let callback = callback::Callback { id: response.id.value(), frame };
            painter.add(PaintCallback::new_paint_callback(rect, callback));
            overlay::points(&painter, &sight, scene.marks, &self.show, &colors);
            self.paint_forces(&painter, &sight, scene, character, &colors);
        }
        let mut follows = self.camera.follows;
        ui.scope_builder(UiBuilder::new().max_rect(corner), |ui| overlay::menu(ui, &mut self.show, &mut follows));
        if follows != self.camera.follows {
            self.camera.set_follows(follows);
        }
        grip
    }

    /// Forgets which character it has seen: the next one is framed anew.
    pub fn frame_next(&mut self) {
        self.framed = false;
    }

    /// The character is there now.
    fn see(&mut self, ui: &Ui, character: &Seen, across: f64) {
        let anchor = character.anchor();
        if !self.framed && anchor.is_finite() {
            self.framed = true;
            self.camera.jump(anchor);
            let height = character.body.height;
            self.camera.frame(anchor + DVec3::Y * 0.51 * height, 0.585 * height, across);
        }
        let seconds = f64::from(ui.input(|input| input.stable_dt));
        if self.camera.follow(anchor, seconds) {
            ui.ctx().request_repaint();
        }
    }

    /// What is to be drawn.
    fn frame(&mut self, scene: &Scene, seen: &[Seen], size: [u32; 2], colors: &Colors) -> Frame {
        self.keep(scene.props);
        let show = self.show;
        let props = || scene.props.iter().zip(&self.shapes).filter(|(_, kept)| show.props && !kept.level);
        let flat = !props().any(|(prop, _)| prop.ground);
        let characters: Vec<(DVec3, f64)> = seen.iter().filter(|seen| !seen.ghost).map(Seen::ball).collect();
        let foot = seen.iter().find(|seen| !seen.ghost).map(Seen::anchor).filter(|foot| foot.is_finite());
        let (mut frame, origin) = Frame::new(&self.camera, size, colors, flat, (&characters, foot));
        for figure in scene.figures.iter().filter(|figure| show.ghost || !figure.ghost) {
            let ghost = figure.ghost.then_some(colors.ghost);
            if figure.rig.mesh.iter().any(|part| !part.indices.is_empty()) {
                frame.rig(figure.rig, figure.pose, origin, ghost);
            } else {
                let pose = body_pose(figure.rig, figure.pose);
                geometry::add_figure(&mut frame, &figure.rig.body, &pose, ghost, origin);
            }
        }
        for (body, pose, ghost) in scene.capsules.iter().filter(|(_, _, ghost)| show.ghost || !ghost) {
            geometry::add_figure(&mut frame, body, pose, ghost.then_some(colors.ghost), origin);
        }
        for (prop, kept) in props() {
            let key = prop.at(scene.time);
            if key.scale != DVec3::ZERO && key.translation.is_finite() {
                frame.thing(&kept.shape, &key, prop.color, prop.ground, origin);
            }
        }
        geometry::add_ground(&mut frame, scene.marks, &show, colors, origin);
        let character = seen.iter().find(|seen| !seen.ghost);
        if let (true, Some(seen)) = (show.forces, character) {
            let pushes = &scene.marks.overlay.pushes;
            geometry::add_arrows(&mut frame, pushes, seen.body, &seen.pose, &seen.positions, origin);
        }
        frame
    }

    /// The same shapes as before keep their identity.
    fn keep(&mut self, props: &[Prop]) {
        self.shapes.truncate(props.len());
        for (index, prop) in props.iter().enumerate() {
            match self.shapes.get_mut(index) {
                Some(kept) if *kept.shape == prop.shape => {}
                Some(kept) => *kept = Kept::new(prop),
                None => self.shapes.push(Kept::new(prop)),
            }
        }
    }

    /// The newtons of what pushes, and the push in hand.
    fn paint_forces(
        &self,
        painter: &egui::Painter,
        sight: &Sight,
        scene: &Scene,
        character: Option<&Seen>,
        colors: &Colors,
    ) {
        let Some(seen) = character else { return };
        for push in scene.marks.overlay.pushes.iter().filter(|_| self.show.forces) {
            let (tail, _) = geometry::arrow_ends(push, seen.body, &seen.pose, &seen.positions);
            if let Some(at) = sight.project(tail) {
                overlay::newtons(painter, at - Vec2::new(0.0, 22.0), push.force.length(), colors);
            }
        }
        let standing = Standing { body: seen.body, positions: &seen.positions };
        if let Some(held) = &self.held
            && let Some(bone) = input::place(&standing, held.bone).and_then(|place| sight.project(place))
        {
            overlay::grip(painter, bone, held.pointer, held.force.length(), colors);
        }
    }
}

impl Kept {
    fn new(prop: &Prop) -> Kept {
        let level = match &prop.shape {
            Shape::Mesh(mesh) if prop.ground && prop.keys.len() <= 1 => {
                let top = |(point, normal): (&DVec3, &DVec3)| normal.y < 0.9 || point.y.abs() < LEVEL;
                mesh.positions.iter().all(|point| point.y < LEVEL) && mesh.positions.iter().zip(&mesh.normals).all(top)
            }
            _ => false,
        };
        // Slabs with gaps are level too, but not everywhere.
        let whole = |mesh: &crate::model::props::Mesh| mesh.positions.len() <= 24;
        let level = level && matches!(&prop.shape, Shape::Mesh(mesh) if whole(mesh));
        Kept { shape: Arc::new(prop.shape.clone()), level }
    }
}

/// Joints of all that is to be seen.
fn seen<'a>(scene: &Scene<'a>) -> Vec<Seen<'a>> {
    let rigs = scene.figures.iter().map(|figure| {
        let pose = body_pose(figure.rig, figure.pose);
        let positions = pose.positions(&figure.rig.body);
        Seen { body: &figure.rig.body, pose: Cow::Owned(pose), positions, ghost: figure.ghost }
    });
    let bodies = scene.capsules.iter().filter(|(body, pose, _)| pose.turns.len() == body.joints.len());
    let bodies = bodies.map(|(body, pose, ghost)| {
        let positions = pose.positions(body);
        Seen { body, pose: Cow::Borrowed(*pose), positions, ghost: *ghost }
    });
    rigs.chain(bodies).collect()
}

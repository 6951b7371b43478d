//! Pointer and keys in the viewport: the camera, and a push by hand. Points in; newtons and metres out.
//!
//! Middle or right drag, or left with Alt or beside the character, orbits; with Shift it pans; the wheel and a pinch zoom. F frames, 1 3 7 look
//! from the front, the left and above. Left drag from the character pushes it.

use super::camera::{Camera, Side, Sight};
use super::pick;
use crate::model::{Body, Role};
use eframe::egui::{self, Key, Modifiers, PointerButton, Pos2, Response, Ui};
use glam::DVec3;

/// rad a point.
const ORBIT: f64 = 0.0075;
/// N, a drag over the whole height of the view.
const FULL_HEIGHT: f64 = 1000.0;
/// N.
const STRONGEST: f64 = 800.0;

/// A push by hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// What was taken hold of.
    pub bone: Role,
    /// N, scenario space: level, or with Ctrl in the picture's plane.
    pub force: DVec3,
    /// Where in the drag.
    pub phase: GripPhase,
}

/// Where in a push by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GripPhase {
    /// It begins now.
    Started,
    /// It goes on.
    Held,
    /// It ends now, with its last force.
    Released,
}

/// A push in hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    pub(super) bone: Role,
    /// Points.
    pub(super) pointer: Pos2,
    pub(super) force: DVec3,
}

/// Who stands in the viewport.
pub(super) struct Standing<'a> {
    pub(super) body: &'a Body,
    /// m, its joints.
    pub(super) positions: &'a [DVec3],
}

/// Moves the camera as pointer and keys say. `holding`: the left drag is a push.
pub(super) fn move_camera(ui: &Ui, response: &Response, camera: &mut Camera, holding: bool) {
    let modifiers = ui.input(|input| input.modifiers);
    let free = response.dragged_by(PointerButton::Primary) && !holding;
    if free || response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle) {
        let drag = response.drag_delta();
        if modifiers.shift {
            let height = f64::from(response.rect.height().max(1.0));
            camera.pan(-f64::from(drag.x) / height, f64::from(drag.y) / height);
        } else {
            camera.orbit(-f64::from(drag.x) * ORBIT, f64::from(drag.y) * ORBIT);
        }
    }
    if response.contains_pointer() {
        let (wheel, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        camera.zoom((f64::from(wheel) * 0.0025).exp() * f64::from(pinch));
    }
}

/// A key of the viewport that was pressed, unless someone is writing.
pub(super) fn key(ui: &Ui, response: &Response) -> Option<ViewKey> {
    if !(response.contains_pointer() || response.has_focus()) || ui.ctx().text_edit_focused() {
        return None;
    }
    let keys = [
        (Key::F, ViewKey::Frame),
        (Key::Num1, ViewKey::Look(Side::Front)),
        (Key::Num3, ViewKey::Look(Side::Left)),
        (Key::Num7, ViewKey::Look(Side::Top)),
    ];
    let pressed = |(key, _): &(Key, ViewKey)| ui.input_mut(|input| input.consume_key(Modifiers::NONE, *key));
    keys.into_iter().find(pressed).map(|(_, meaning)| meaning)
}

/// What a key says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ViewKey {
    /// See the character whole.
    Frame,
    /// Look along an axis.
    Look(Side),
}

/// Begins, moves or ends a push by hand.
pub(super) fn push(
    ui: &Ui,
    response: &Response,
    camera: &Camera,
    sight: &Sight,
    standing: Option<&Standing>,
    held: &mut Option<Held>,
) -> Option<Grip> {
    let modifiers = ui.input(|input| input.modifiers);
    let pointer = response.interact_pointer_pos().or_else(|| held.map(|held| held.pointer))?;
    if response.drag_started_by(PointerButton::Primary) && !modifiers.alt {
        let from = ui.input(|input| input.pointer.press_origin()).unwrap_or(pointer);
        let standing = standing?;
        let (bone, _) = pick::bone(standing.body, standing.positions, sight.eye, sight.ray(from))?;
        *held = Some(Held { bone, pointer, force: DVec3::ZERO });
        let force = force(camera, sight, standing, bone, pointer, modifiers);
        *held = Some(Held { bone, pointer, force });
        return Some(Grip { bone, force, phase: GripPhase::Started });
    }
    let now = (*held)?;
    let bone = now.bone;
    let force = match standing {
        Some(standing) => force(camera, sight, standing, bone, pointer, modifiers),
        None => now.force,
    };
    if response.dragged_by(PointerButton::Primary) {
        *held = Some(Held { bone, pointer, force });
        return Some(Grip { bone, force, phase: GripPhase::Held });
    }
    *held = None;
    Some(Grip { bone, force: now.force, phase: GripPhase::Released })
}

/// N, of a drag from a bone to the pointer: to the right is to the right, up is away from the viewer.
fn force(
    camera: &Camera,
    sight: &Sight,
    standing: &Standing,
    bone: Role,
    pointer: Pos2,
    modifiers: egui::Modifiers,
) -> DVec3 {
    let Some(from) = place(standing, bone).and_then(|place| sight.project(place)) else { return DVec3::ZERO };
    let drag = (pointer - from) / sight.rect.height().max(1.0);
    let right = camera.right();
    let up = if modifiers.command { camera.up() } else { DVec3::Y.cross(right) };
    let force = (right * f64::from(drag.x) - up * f64::from(drag.y)) * FULL_HEIGHT;
    force.clamp_length_max(STRONGEST)
}

/// m, where the joint of a bone is.
pub(super) fn place(standing: &Standing, bone: Role) -> Option<DVec3> {
    standing.body.joint(bone).and_then(|joint| standing.positions.get(joint)).copied()
}

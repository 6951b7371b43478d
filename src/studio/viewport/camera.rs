//! The viewer's place: an eye that goes around a target, and what it sees where. Scenario space, metres, radians, points.

use eframe::egui::{Pos2, Rect};
use glam::dcamera::rh;
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::f64::consts::{FRAC_PI_2, PI};

/// rad, from the lower to the upper edge.
const OPENING: f64 = 0.56;
/// m.
const DISTANCES: [f64; 2] = [0.3, 80.0];
/// 1/s, how fast the eye follows the character up and down: it does not bob with every step.
const FOLLOW_HEIGHT: f64 = 4.0;

/// An eye that goes around a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// m, what it looks at, from the character where it follows, else from the origin.
    pub offset: DVec3,
    /// rad about +Y: 0 sees the rig's face, a quarter turn its left.
    pub yaw: f64,
    /// rad, over the horizon.
    pub pitch: f64,
    /// m, from the target.
    pub distance: f64,
    /// Goes with the character.
    pub follows: bool,
    /// m, where the character was seen last.
    anchor: DVec3,
}

/// From where, by a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The character's face.
    Front,
    /// Its left.
    Left,
    /// Above it, its front down.
    Top,
}

impl Default for Camera {
    fn default() -> Camera {
        Camera { offset: DVec3::Y * 0.9, yaw: 0.62, pitch: 0.17, distance: 4.4, follows: true, anchor: DVec3::ZERO }
    }
}

impl Camera {
    /// m, what it looks at.
    pub fn target(&self) -> DVec3 {
        if self.follows { self.anchor + self.offset } else { self.offset }
    }

    /// Unit, towards the viewer.
    pub fn back(&self) -> DVec3 {
        let (sin, cos) = self.pitch.sin_cos();
        DVec3::new(self.yaw.sin() * cos, sin, self.yaw.cos() * cos)
    }

    /// m.
    pub fn eye(&self) -> DVec3 {
        self.target() + self.back() * self.distance
    }

    /// Unit, to the right of the picture.
    pub fn right(&self) -> DVec3 {
        DVec3::new(self.yaw.cos(), 0.0, -self.yaw.sin())
    }

    /// Unit, up in the picture.
    pub fn up(&self) -> DVec3 {
        self.back().cross(self.right())
    }

    /// Turns it around its target, rad.
    pub fn orbit(&mut self, yaw: f64, pitch: f64) {
        self.yaw = (self.yaw + yaw + PI).rem_euclid(2.0 * PI) - PI;
        self.pitch = (self.pitch + pitch).clamp(-0.35, FRAC_PI_2 - 1e-3);
    }

    /// Moves its target in the picture's plane, by shares of the picture's height.
    pub fn pan(&mut self, right: f64, up: f64) {
        let height = 2.0 * self.distance * (OPENING / 2.0).tan();
        self.offset += (self.right() * right + self.up() * up) * height;
    }

    /// Goes nearer, times.
    pub fn zoom(&mut self, times: f64) {
        if times.is_finite() && times > 0.0 {
            self.distance = (self.distance / times).clamp(DISTANCES[0], DISTANCES[1]);
        }
    }

    /// Looks along an axis.
    pub fn look(&mut self, from: Side) {
        (self.yaw, self.pitch) = match from {
            Side::Front => (0.0, 0.09),
            Side::Left => (FRAC_PI_2, 0.09),
            Side::Top => (0.0, FRAC_PI_2 - 1e-3),
        };
    }

    /// Sees a ball of that radius whole.
    pub fn frame(&mut self, middle: DVec3, radius: f64, width_over_height: f64) {
        let narrow = width_over_height.clamp(0.2, 1.0);
        self.distance = (radius * 1.08 / ((OPENING / 2.0).sin() * narrow)).clamp(DISTANCES[0], DISTANCES[1]);
        self.offset = if self.follows { middle - self.anchor } else { middle };
    }

    /// Keeps its picture while it begins or ceases to go with the character.
    pub fn set_follows(&mut self, follows: bool) {
        let target = self.target();
        self.follows = follows;
        self.offset = if follows { target - self.anchor } else { target };
    }

    /// The character is there now, and `seconds` have gone by. Whether the eye still moves.
    pub fn follow(&mut self, character: DVec3, seconds: f64) -> bool {
        if !character.is_finite() {
            return false;
        }
        let rise = character.y - self.anchor.y;
        let share = if rise.abs() > 1.0 { 1.0 } else { 1.0 - (-FOLLOW_HEIGHT * seconds.clamp(0.0, 0.1)).exp() };
        self.anchor = DVec3::new(character.x, self.anchor.y + rise * share, character.z);
        self.follows && (character.y - self.anchor.y).abs() > 2e-3
    }

    /// At once.
    pub fn jump(&mut self, character: DVec3) {
        if character.is_finite() {
            self.anchor = character;
        }
    }

    /// Depth 0..1 from near to far, of space less `origin`.
    pub fn clip_from_world(&self, origin: DVec3, width_over_height: f64) -> DMat4 {
        let eye = self.eye() - origin;
        let near = (self.distance * 0.05).clamp(0.02, 1.0);
        let view = rh::view::look_at_mat4(eye, self.target() - origin, self.up());
        rh::proj::directx::perspective(OPENING, width_over_height.max(0.01), near, 600.0) * view
    }

    /// The ray's axes: across half the picture's width, up half of it, and ahead.
    pub fn rays(&self, width_over_height: f64) -> [DVec3; 3] {
        let half = (OPENING / 2.0).tan();
        [self.right() * half * width_over_height, self.up() * half, -self.back()]
    }
}

/// A camera and the part of the window that shows it.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// Points.
    pub rect: Rect,
    /// m.
    pub eye: DVec3,
    rays: [DVec3; 3],
    clip: DMat4,
}

impl Sight {
    /// Of a camera.
    pub fn new(camera: &Camera, rect: Rect) -> Sight {
        let across = f64::from(rect.width() / rect.height().max(1.0));
        Sight { rect, eye: camera.eye(), rays: camera.rays(across), clip: camera.clip_from_world(DVec3::ZERO, across) }
    }

    /// Where a point of space is seen; `None` behind the eye.
    pub fn project(&self, point: DVec3) -> Option<Pos2> {
        let clip: DVec4 = self.clip * point.extend(1.0);
        if clip.w < 1e-3 || !clip.is_finite() {
            return None;
        }
        let at = DVec2::new(clip.x, -clip.y) / clip.w;
        let middle = self.rect.center();
        let half = self.rect.size() / 2.0;
        Some(Pos2::new(middle.x + at.x as f32 * half.x, middle.y + at.y as f32 * half.y))
    }

    /// Unit, from the eye through a point of the window.
    pub fn ray(&self, at: Pos2) -> DVec3 {
        let off = (at - self.rect.center()) / (self.rect.size() / 2.0);
        let [right, up, ahead] = self.rays;
        (ahead + right * f64::from(off.x) - up * f64::from(off.y)).normalize_or(ahead)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_seen_where_its_ray_goes() {
        let mut camera = Camera::default();
        camera.orbit(0.7, 0.3);
        let sight = Sight::new(&camera, Rect::from_min_size(Pos2::new(100.0, 50.0), eframe::egui::vec2(640.0, 400.0)));
        assert!(sight.project(camera.target()).is_some_and(|at| at.distance(sight.rect.center()) < 1e-2));
        for point in [DVec3::new(0.3, 1.2, 0.4), DVec3::new(-0.8, 0.1, 0.9)] {
            let at = sight.project(point).expect("before the eye");
            let off = (point - sight.eye).normalize().cross(sight.ray(at)).length();
            assert!(off < 1e-6, "{off}");
        }
        assert!(sight.project(camera.eye() + camera.back()).is_none());
    }

    #[test]
    fn following_keeps_the_picture_when_it_is_switched() {
        let mut camera = Camera::default();
        camera.jump(DVec3::new(3.0, 0.0, 1.0));
        let target = camera.target();
        camera.set_follows(false);
        assert_eq!(camera.target(), target);
        camera.follow(DVec3::new(9.0, 0.0, 1.0), 0.1);
        assert_eq!(camera.target(), target);
    }
}

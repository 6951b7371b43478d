//! How a foot lies on a mesh: its stiff sole on the plane that bears it, not on the face under its ankle. Scenario space, metres.

use super::control::Controller;
use super::figure::Figure;
use super::flat;
use super::kerb;
use crate::model::{Side, Spot, Terrain};
use glam::{DQuat, DVec2, DVec3};

/// Points along a sole and across it at which the ground is asked: 4 cm apart along one of 0.27 m.
const POINTS: [usize; 2] = [7, 3];
/// m at legs of 0.83 m: ground that is no higher over a sole that stands may bear it.
pub(super) const RISES: f64 = 0.03;

impl Controller {
    /// The ground for a foot whose ankle is to be over that place (x, z), turned by `yaw` (rad) from how it stood at first.
    pub(super) fn lies(&self, figure: &Figure, terrain: &Terrain, side: Side, ankle: DVec2, yaw: f64) -> Spot {
        let spot = terrain.spot(ankle);
        if !terrain.is_mesh() {
            return spot;
        }
        let lie = terrain.lie(ankle, &outline(figure, side, yaw));
        lie.map_or(spot, |lie| Spot { height: lie.height, normal: lie.normal, ..spot })
    }

    /// The ground for a foot that stands: on treads, under its sole's middle where it lies flat.
    pub(super) fn stood_on(&self, figure: &Figure, terrain: &Terrain, side: Side) -> Spot {
        let (ankle, yaw) = self.foot(figure, side);
        if terrain.has_treads() {
            return terrain.spot(flat(self.laid_flat(figure, side)) + self.ahead(side, yaw));
        }
        let at = flat(ankle);
        let spot = terrain.spot(at);
        if !terrain.is_mesh() {
            return spot;
        }
        let ceiling = ankle.y - figure.ankle_height + RISES * self.size;
        let lie = terrain.lie_under(at, &outline(figure, side, yaw), ceiling);
        lie.map_or(spot, |lie| Spot { height: lie.height, normal: lie.normal, ..spot })
    }

    /// m, by place (x, z): the plane of the ground that bears a foot.
    pub(super) fn plane_under(&self, figure: &Figure, terrain: &Terrain, side: Side) -> impl Fn(DVec2) -> f64 + use<> {
        let (spot, ankle) = (self.stood_on(figure, terrain, side), flat(self.foot(figure, side).0));
        let slope = -flat(spot.normal) / spot.normal.y.max(0.1);
        move |at| spot.height + slope.dot(at - ankle)
    }

    /// m, the ground's height under a point (x, z) of a sole that stands on that plane: the plane's own over a gap or a lower tread.
    pub(super) fn borne_by(&self, terrain: &Terrain, plane: &impl Fn(DVec2) -> f64, at: DVec2) -> f64 {
        let spot = terrain.spot(at);
        let lower = terrain.has_edges() && (!spot.holds || spot.height < plane(at) - kerb::LOWER * self.size);
        if lower { plane(at) } else { spot.height }
    }
}

/// m, (x, z) from the ankle.
fn outline(figure: &Figure, side: Side, yaw: f64) -> Vec<DVec2> {
    let turn = DQuat::from_rotation_y(yaw);
    let [rear_left, rear_right, .., tip_left, tip_right] = figure.soles[side as usize];
    let share = |at: usize, of: usize| at as f64 / (of - 1) as f64;
    let at = |along: usize, across: usize| {
        let line: [DVec3; 2] =
            [(rear_left, tip_left), (rear_right, tip_right)].map(|(rear, tip)| rear.lerp(tip, share(along, POINTS[0])));
        let point = turn * line[0].lerp(line[1], share(across, POINTS[1]));
        DVec2::new(point.x, point.z)
    };
    (0..POINTS[0]).flat_map(|along| (0..POINTS[1]).map(move |across| at(along, across))).collect()
}

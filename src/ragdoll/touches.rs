//! What the links' boxes may touch: the ground, by their corners where it is a smooth surface and by whole boxes where it has edges
//! (stairs, gaps), and balls. A mesh is met by corners: its floors from above, its walls from the side of the box's middle; of what rises
//! between corners only soles feel something. Scenario space, SI.

use super::bulk::above_legs;
use super::figure::Figure;
use super::ground::{DEEP, FAR, Tread, double, rotation, treads, vector};
use crate::dynamics::{Articulation, Loose, Touch};
use crate::model::scenario::GroundKind;
use crate::model::{Side, Terrain};
use glam::{DQuat, DVec2, DVec3};
use rapier3d::math::Pose;
use rapier3d::parry::query::ContactManifold;
use rapier3d::parry::query::details::contact_manifold_cuboid_cuboid;
use rapier3d::parry::shape::Cuboid;

/// m, nearer than that to the ground a corner is looked at, and so deep that it came from elsewhere.
const NEAR: f64 = 0.08;
const FROM_ELSEWHERE: f64 = -0.3;
/// m, what is deeper under a face of a mesh is beside it: farther than anything sinks in a part of a tick, lower than a kerb.
const SUNK: f64 = 0.08;
/// m: ground that is so much nearer to a sole than to its corners rises between them.
const RIDGE: f64 = 1e-3;
/// Shares of the way from a sole's rear corner to its front one at which that is asked: 4 cm apart along one of 0.27 m.
const BETWEEN: [f64; 3] = [0.25, 0.5, 0.75];
/// Names of contacts: eight corners a link, then points of boxes against boxes, then those between a sole's corners, then balls.
const BOXES: u32 = 1 << 10;
const RIDGES: u32 = 1 << 18;
const BALLS: u32 = 1 << 20;

/// A link's box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hull {
    /// m, half sides.
    pub(super) half: DVec3,
    /// m, its middle in the link's frame.
    pub(super) middle: DVec3,
    /// Its turn in the link's frame.
    pub(super) turn: DQuat,
    /// m, its corners in the link's frame.
    corners: [DVec3; 8],
    /// m, of the farthest corner from the link's origin.
    radius: f64,
    /// m: along both sides of the part of a sole that it bears on, in the link's frame, from the rear to the front; of a foot.
    sides: Option<[[DVec3; 2]; 2]>,
}

/// A ball, as the links see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    /// m.
    pub(super) radius: f64,
    /// m, how much farther off it may be and still arrive in this tick.
    pub(super) reach: f64,
    pub(super) friction: f64,
    pub(super) bounce: f64,
}

/// What is to be touched.
#[derive(Clone, Debug)]
pub(super) struct Surroundings {
    pub(super) hulls: Vec<Hull>,
    treads: Vec<Tread>,
    /// One for each loose body that is a ball: the first ones.
    pub(super) balls: Vec<Round>,
    /// The box in the hands: which loose body, and m.
    pub(super) carried: Option<(usize, DVec3, usize)>,
}

impl Surroundings {
    pub(super) fn new(figure: &Figure, terrain: &Terrain) -> Surroundings {
        let hulls = (0..figure.links.len()).map(|index| {
            let (half, middle) = above_legs(figure, index);
            let mut hull = Hull::new(half, middle, figure.links[index].turn);
            hull.bear_on_sole(figure, index);
            hull
        });
        Surroundings { hulls: hulls.collect(), treads: treads(terrain), balls: Vec::new(), carried: None }
    }

    /// All that may be touched in a part of a tick; `spin`: rad/s, of ground that turns about the origin.
    pub(super) fn find(
        &self,
        body: &Articulation,
        loose: &[Loose],
        (terrain, spin): (&Terrain, DVec3),
        touches: &mut Vec<Touch>,
    ) {
        let friction = terrain.friction.max(0.0);
        let mesh = matches!(terrain.kind, GroundKind::Mesh { .. });
        for (link, hull) in self.hulls.iter().enumerate() {
            let (origin, turn) = body.place(link);
            let spot = terrain.spot(DVec2::new(origin.x, origin.z));
            if !self.treads.is_empty() {
                self.find_treads((link, hull), (origin, turn), friction, touches);
            } else if mesh || (origin.y - spot.height) * spot.normal.y < hull.radius + NEAR {
                for (corner, local) in hull.corners.iter().enumerate() {
                    let at = origin + turn * *local;
                    let spot = terrain.spot_under(at, SUNK);
                    if mesh {
                        self.find_wall((link, hull), corner, (origin + turn * hull.middle, at), terrain, touches);
                    }
                    let gap = (at.y - spot.height) * spot.normal.y;
                    if (FROM_ELSEWHERE..NEAR).contains(&gap) {
                        let key = 8 * link as u32 + corner as u32;
                        touches.push(ground(link, key, at, (spot.normal, gap), friction, spin.cross(at)));
                    }
                }
                if mesh {
                    self.find_ridges((link, hull), (origin, turn), terrain, touches);
                }
            }
        }
        if let Some((number, size, hand)) = self.carried {
            self.find_carried(&loose[number], (size, hand), (terrain, spin), touches);
        }
        for (number, (round, ball)) in self.balls.iter().zip(loose).enumerate() {
            self.find_ball(body, (number, round, ball), loose, touches);
        }
    }

    /// A corner that is through a wall of a mesh, or nearly: seen from the middle of its box.
    fn find_wall(
        &self,
        (link, hull): (usize, &Hull),
        corner: usize,
        (middle, at): (DVec3, DVec3),
        terrain: &Terrain,
        touches: &mut Vec<Touch>,
    ) {
        let out = (at - middle).normalize_or_zero();
        let Some((place, normal)) = terrain.wall(middle, at + out * NEAR) else { return };
        let gap = (at - place).dot(normal);
        if (-hull.radius..NEAR).contains(&gap) {
            let key = BOXES + 8 * link as u32 + corner as u32;
            touches.push(ground(link, key, at, (normal, gap), terrain.friction.max(0.0), DVec3::ZERO));
        }
    }

    /// A sole over a mesh that rises between its corners, as where a ramp ends: it rocks there.
    fn find_ridges(
        &self,
        (link, hull): (usize, &Hull),
        (origin, turn): (DVec3, DQuat),
        terrain: &Terrain,
        touches: &mut Vec<Touch>,
    ) {
        let gap = |local: DVec3| {
            let at = origin + turn * local;
            let spot = terrain.spot_under(at, SUNK);
            (at, spot.normal, (at.y - spot.height) * spot.normal.y)
        };
        for (line, [rear, front]) in hull.sides.iter().flatten().enumerate() {
            let [(.., behind), (.., ahead)] = [gap(*rear), gap(*front)];
            for (number, share) in BETWEEN.into_iter().enumerate() {
                let (at, normal, gap) = gap(rear.lerp(*front, share));
                let rises = gap < behind + (ahead - behind) * share - RIDGE;
                if rises && (FROM_ELSEWHERE..NEAR).contains(&gap) {
                    let key = RIDGES + 8 * link as u32 + (BETWEEN.len() * line + number) as u32;
                    touches.push(ground(link, key, at, (normal, gap), terrain.friction.max(0.0), DVec3::ZERO));
                }
            }
        }
    }

    /// A box that meets treads.
    fn find_treads(
        &self,
        (link, hull): (usize, &Hull),
        (origin, turn): (DVec3, DQuat),
        friction: f64,
        touches: &mut Vec<Touch>,
    ) {
        let reach = hull.radius + NEAR;
        let hull_pose = pose(origin + turn * hull.middle, turn * hull.turn);
        for (number, tread) in self.treads.iter().enumerate() {
            let [from, to] = tread.span;
            if origin.y > tread.top + reach || origin.z + reach < from || origin.z - reach > to {
                continue;
            }
            let half = DVec3::new(FAR, DEEP, 0.5 * (to - from));
            let floor_pose = pose(DVec3::new(0.0, tread.top - DEEP, 0.5 * (from + to)), DQuat::IDENTITY);
            let mut manifold: ContactManifold<(), ()> = ContactManifold::new();
            let (floor, own) = (Cuboid::new(vector(half)), Cuboid::new(vector(hull.half)));
            contact_manifold_cuboid_cuboid(&floor_pose.inv_mul(&hull_pose), &floor, &own, NEAR as f32, &mut manifold);
            let normal = double(manifold.local_n1).normalize_or(DVec3::Y);
            for (point, found) in manifold.points.iter().enumerate() {
                let at = double(hull_pose * found.local_p2);
                let key = BOXES + (64 * link as u32 + (number as u32 % 8)) * 8 + point as u32 % 8;
                touches.push(ground(link, key, at, (normal, f64::from(found.dist)), friction, DVec3::ZERO));
            }
        }
    }

    /// The box in the hands meets the ground: through the hand that it is fixed to.
    fn find_carried(
        &self,
        held: &Loose,
        (size, hand): (DVec3, usize),
        (terrain, spin): (&Terrain, DVec3),
        touches: &mut Vec<Touch>,
    ) {
        for corner in 0..8_u32 {
            let at = held.place + held.turn * (size * 0.5 * signs(corner));
            let spot = terrain.spot_under(at, SUNK);
            let gap = (at.y - spot.height) * spot.normal.y;
            if (FROM_ELSEWHERE..NEAR).contains(&gap) {
                let key = 8 * self.hulls.len() as u32 + corner;
                touches.push(ground(hand, key, at, (spot.normal, gap), terrain.friction.max(0.0), spin.cross(at)));
            }
        }
    }

    /// A ball that meets boxes: the body's, and through its hand the one that is carried.
    fn find_ball(
        &self,
        body: &Articulation,
        (number, round, ball): (usize, &Round, &Loose),
        loose: &[Loose],
        touches: &mut Vec<Touch>,
    ) {
        let mut meet = |link: usize, middle: DVec3, turn: DQuat, half: DVec3, key: u32| {
            let inside = turn.inverse() * (ball.place - middle);
            let nearest = inside.clamp(-half, half);
            let (at, away, gap) = if nearest == inside {
                // Its centre is in the box: out by the nearest side.
                let left = half - inside.abs();
                let axis = left.to_array().iter().enumerate().fold(
                    0,
                    |least, (axis, depth)| {
                        if *depth < left[least] { axis } else { least }
                    },
                );
                let mut out = DVec3::ZERO;
                out[axis] = inside[axis].signum();
                (inside + out * left[axis], out, -left[axis] - round.radius)
            } else {
                let away = inside - nearest;
                (nearest, away.normalize(), away.length() - round.radius)
            };
            if gap < round.reach {
                touches.push(Touch {
                    link,
                    key,
                    at: middle + turn * at,
                    normal: -(turn * away),
                    gap,
                    friction: round.friction,
                    bounce: round.bounce,
                    surface: DVec3::ZERO,
                    other: Some(number),
                });
            }
        };
        let key = BALLS + 64 * number as u32;
        for (link, hull) in self.hulls.iter().enumerate() {
            let (origin, turn) = body.place(link);
            if origin.distance(ball.place) < hull.radius + round.radius + round.reach {
                meet(link, origin + turn * hull.middle, turn * hull.turn, hull.half, key + link as u32);
            }
        }
        if let Some((carried, size, hand)) = self.carried {
            let held = &loose[carried];
            meet(hand, held.place, held.turn, 0.5 * size, key + 63);
        }
    }
}

impl Hull {
    fn new(half: DVec3, middle: DVec3, turn: DQuat) -> Hull {
        let corners = std::array::from_fn(|corner| middle + turn * (half * signs(corner as u32)));
        let radius = corners.iter().map(|corner| corner.length()).fold(0.0, f64::max);
        Hull { half, middle, turn, corners, radius, sides: None }
    }

    /// A foot bears on its sole's outline, toes on that of ball and tip; above they keep their box.
    fn bear_on_sole(&mut self, figure: &Figure, link: usize) {
        let Some(side) = Side::BOTH.into_iter().find(|side| figure.legs[*side as usize][2] == figure.bears(link))
        else {
            return;
        };
        let above = [2, 3, 6, 7].map(|corner| self.corners[corner]);
        let low = figure.sole_of(side, link);
        self.sides = Some(figure.sole_sides(side, link));
        for (index, corner) in self.corners.iter_mut().enumerate() {
            *corner = low.get(index).copied().unwrap_or(above[index % 4]);
        }
    }
}

fn signs(corner: u32) -> DVec3 {
    let sign = |bit: u32| if corner & bit == 0 { -1.0 } else { 1.0 };
    DVec3::new(sign(1), sign(2), sign(4))
}

fn ground(link: usize, key: u32, at: DVec3, (normal, gap): (DVec3, f64), friction: f64, surface: DVec3) -> Touch {
    Touch { link, key, at, normal, gap, friction, bounce: 0.0, surface, other: None }
}

fn pose(place: DVec3, turn: DQuat) -> Pose {
    Pose::from_parts(vector(place), rotation(turn))
}

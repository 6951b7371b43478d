//! How high the ground is under a point, and how deep a point of a foot in the air is under it. Scenario space, metres.
//!
//! A step's edge is a corner: what is a hair past it is that hair deep, not a whole rise. Uneven ground is round and soles
//! are flat: near its lift and its landing a foot may be where the plane of that contact lets it be.

use super::{HeldContact, Track};
use crate::maths::real;
use crate::model::scenario::GroundKind;
use crate::model::{Side, Terrain, terrain};
use glam::{DVec2, DVec3};

/// Share of a swing, at each end, in which the plane of the contact there counts as ground too.
const NEAR_CONTACT: f64 = 0.25;

/// m, how far beside a point of a mesh its edge is looked for: out of a kerb's side a foot is as deep as it is far from there.
const BESIDE: [f64; 8] = [0.0005, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064];

/// m, the height of the ground straight below (or above) a point of the world.
pub fn height_below(terrain: &Terrain, time: f64, point: DVec3) -> f64 {
    if terrain.moves() {
        let normal = terrain.turn(time) * DVec3::Y;
        return -(point.x * normal.x + point.z * normal.z) / normal.y.max(0.1);
    }
    terrain.spot(DVec2::new(point.x, point.z)).height
}

/// m, how deep a point of the world lies in the ground, to its nearest surface; negative above it.
pub fn depth(terrain: &Terrain, time: f64, point: DVec3) -> f64 {
    let point = terrain.turn(time).inverse() * point;
    let at = DVec2::new(point.x, point.z);
    let spot = terrain.spot(at);
    let under = (spot.height - point.y) * spot.normal.y;
    match terrain.kind {
        // Out of the front of a riser it is no farther than to the edge.
        GroundKind::Stairs { rise, tread, count } if under > 0.0 && (at.y > terrain::FIRST || rise < 0.0) => {
            let steps = ((at.y - terrain::FIRST) / tread).floor().clamp(0.0, f64::from(count.saturating_sub(1)));
            if rise < 0.0 {
                // Behind the edge of a stair that goes down.
                let next = (steps as u32 + u32::from(at.y > terrain::FIRST)..count)
                    .find(|step| rise * f64::from(step + 1) < point.y);
                return next.map_or(under, |step| under.min(terrain::FIRST + f64::from(step) * tread - at.y));
            }
            let inside = (0..=steps as u32).rev().take_while(|step| point.y < rise * f64::from(step + 1)).last();
            let edge = inside.map_or(at.y, |step| terrain::FIRST + f64::from(step) * tread);
            under.min(at.y - edge)
        }
        // Into a gap a foot may sink; from there it is in the slab's side.
        GroundKind::Gaps { .. } if !spot.holds => -1.0,
        GroundKind::Gaps { width, spacing } if under > 0.0 && at.y > terrain::FIRST => {
            let into = (at.y - terrain::FIRST).rem_euclid(spacing);
            under.min(into - width).min(spacing - into)
        }
        GroundKind::Mesh { .. } if !spot.holds => -1.0,
        GroundKind::Mesh { .. } if under > BESIDE[0] => {
            let beside = BESIDE.into_iter().take_while(|reach| *reach < under).find(|reach| {
                (0..8).any(|eighth| {
                    let (sine, cosine) = real::sin_cos(std::f64::consts::FRAC_PI_4 * f64::from(eighth));
                    terrain.spot(at + DVec2::new(sine, cosine) * *reach).height <= point.y
                })
            });
            beside.unwrap_or(under)
        }
        _ => under,
    }
}

/// m, how deep a point of a foot lies in the ground at one sample, where a contact (placed in the world) holds the foot: under the contact's
/// plane. That plane goes on where a tread or a ramp ends and goes on through a riser, so on stairs and meshes the ground itself counts.
pub fn depth_held(track: &Track, contact: &HeldContact, sample: usize, point: DVec3) -> f64 {
    let edged = track.terrain.as_ref().filter(|terrain| terrain.has_treads() || terrain.is_mesh());
    edged.map_or(-contact.height(point), |terrain| depth(terrain, track.motion.time(sample), point))
}

/// The ground as a foot in the air meets it at one sample.
pub struct Swung<'a> {
    terrain: Option<&'a Terrain>,
    time: f64,
    plane: Option<HeldContact>,
}

impl<'a> Swung<'a> {
    /// For a foot that no contact holds then.
    pub fn new(track: &'a Track, contacts: &[HeldContact], side: Side, sample: usize) -> Swung<'a> {
        let time = track.motion.time(sample);
        let terrain = track.terrain.as_ref();
        let round =
            terrain.is_some_and(|terrain| matches!(terrain.kind, GroundKind::Uneven { .. } | GroundKind::Mesh { .. }));
        let own = || contacts.iter().filter(|contact| contact.side == side);
        let last = own().filter(|contact| contact.end < time).max_by(|a, b| a.end.total_cmp(&b.end));
        let next = own().filter(|contact| contact.start > time).min_by(|a, b| a.start.total_cmp(&b.start));
        let near = match (last, next) {
            (Some(last), Some(next)) => {
                let share = (time - last.end) / (next.start - last.end).max(1e-9);
                if share < NEAR_CONTACT {
                    Some(last)
                } else if share > 1.0 - NEAR_CONTACT {
                    Some(next)
                } else {
                    None
                }
            }
            _ => None,
        };
        let plane = near.filter(|_| round).map(|contact| track.placed(contact, sample));
        Swung { terrain, time, plane }
    }

    /// m, how deep a point lies in it; negative above it.
    pub fn depth(&self, point: DVec3) -> f64 {
        let depth = self.terrain.map_or(-point.y, |terrain| depth(terrain, self.time, point));
        self.plane.map_or(depth, |plane| depth.min(-plane.height(point)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Frame, Motion, fixture, measure_on};
    use super::*;
    use crate::model::scenario::Ground;
    use glam::{DQuat, dvec3};

    fn ground(kind: GroundKind) -> Terrain {
        Terrain::new(&Ground { kind, ..Ground::default() })
    }

    fn tilting(degrees: f64) -> Terrain {
        ground(GroundKind::Platform { pitch: vec![[0.0, 0.0], [1.0, degrees.to_radians()]], roll: vec![] })
    }

    #[test]
    fn past_the_edge_of_a_stair_is_as_deep_as_it_is_past_and_no_more() {
        let stairs = ground(GroundKind::Stairs { rise: 0.17, tread: 0.3, count: 3 });
        let deep = |y, z| depth(&stairs, 0.0, dvec3(0.0, y, z));
        assert!((deep(-0.02, 0.5) - 0.02).abs() < 1e-12, "under the floor before them");
        assert!((deep(0.10, 1.01) - 0.01).abs() < 1e-12, "1 cm into the first riser");
        assert!((deep(0.16, 1.20) - 0.01).abs() < 1e-12, "1 cm under the first tread");
        assert!((deep(0.10, 1.32) - 0.24).abs() < 1e-12, "under the second tread and past the first riser");
        assert!((deep(0.10, 1.32 - 0.30) - 0.02).abs() < 1e-12);
        assert!(deep(0.20, 1.25) < 0.0 && deep(0.52, 9.0) < 0.0 && (deep(0.50, 9.0) - 0.01).abs() < 1e-12);
        let down = ground(GroundKind::Stairs { rise: -0.17, tread: 0.3, count: 3 });
        let deep = |y, z| depth(&down, 0.0, dvec3(0.0, y, z));
        assert!((deep(-0.10, 0.98) - 0.02).abs() < 1e-12, "2 cm behind the first edge");
        assert!((deep(-0.20, 1.29) - 0.01).abs() < 1e-12 && (deep(-0.18, 1.1) - 0.01).abs() < 1e-12);
        assert!((deep(-0.60, 1.1) - 0.43).abs() < 1e-12, "under all of them");
        let gaps = ground(GroundKind::Gaps { width: 0.2, spacing: 1.0 });
        assert!(depth(&gaps, 0.0, dvec3(0.0, -0.1, 1.1)) < 0.0, "a foot may hang into a gap");
        assert!((depth(&gaps, 0.0, dvec3(0.0, -0.1, 1.21)) - 0.01).abs() < 1e-12);
    }

    /// A body that stands still with both feet held, so far ahead and with its toes turned down by so many degrees.
    fn stood(terrain: &Terrain, ahead: f64, height: f64, droop: f64) -> f64 {
        let body = fixture::body();
        let toes = body.feet.each_ref().map(|foot| foot.toe.expect("it has toes"));
        let poses = fixture::poses(&body, 60, |pose, _| {
            pose.hips += dvec3(0.0, height, ahead);
            toes.iter().for_each(|toe| pose.turns[*toe] = DQuat::from_rotation_x(droop.to_radians()));
        });
        let contacts = fixture::standing().map(|contact| HeldContact { point: DVec3::Y * height, ..contact });
        let found = measure_on(fixture::motion(&body, &poses), terrain, &contacts, &[]).expect("sound");
        found.feet.penetration_max_mm
    }

    #[test]
    fn toes_of_a_foot_that_stands_are_free_past_an_edge_and_deep_in_a_tread_or_a_riser() {
        let down = ground(GroundKind::Stairs { rise: -0.17, tread: 0.3, count: 3 });
        let up = ground(GroundKind::Stairs { rise: 0.17, tread: 0.3, count: 3 });
        // Its tips are 0.19 m ahead of it, turned down about joints 0.12 m ahead.
        assert!(stood(&down, 0.5, 0.0, 0.0) < 1e-6, "flat in the midst of a tread");
        assert!(stood(&down, 0.85, 0.0, 0.0) < 1e-6, "flat, the toes over the edge");
        assert!(stood(&down, 0.86, 0.0, 30.0) < 1e-6, "the toes hang over the edge");
        let (sine, cosine) = real::sin_cos(30.0_f64.to_radians());
        let under = 1e3 * (0.02 * cosine + 0.07 * sine - 0.02);
        let deep = stood(&down, 0.5, 0.0, 30.0);
        assert!((deep - under).abs() < 1e-6 && deep > 25.0, "the toes are in the tread: {deep}");
        let deep = stood(&down, 1.15, -0.19, 0.0);
        assert!((deep - 20.0).abs() < 1e-6, "the sole is under its tread: {deep}");
        let deep = stood(&up, 0.83, 0.0, 0.0);
        assert!((deep - 20.0).abs() < 1e-6, "the tips are in the riser: {deep}");
        assert!(stood(&up, 0.80, 0.0, 0.0) < 1e-6, "before the riser");
    }

    #[test]
    fn a_foot_that_stands_on_a_crease_of_a_mesh_is_in_its_faces_and_not_under_a_plane_past_them() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 2, |_, _| {});
        let held = |terrain: &Terrain, point: DVec3, normal: DVec3, asked: DVec3| {
            let track = Track::over(fixture::motion(&body, &poses), terrain).expect("sound");
            let contact = HeldContact { point, normal, ..fixture::flat(Side::Left, 0.0, 1.0) };
            depth_held(&track, &contact, 0, asked)
        };
        let at = |y: f64, z: f64| dvec3(0.0, y, z);
        // A ramp up that ends at z = 0.1: the sole lies along the ramp or along the floor.
        let corner = |x: f64, y: f64, z: f64| dvec3(x, y, z);
        let strip = |[near, far]: [f64; 2], low: f64| {
            let [a, b] = [corner(-1.0, low, near), corner(1.0, low, near)];
            let [c, d] = [corner(-1.0, 0.0, far), corner(1.0, 0.0, far)];
            [[a, c, d], [a, d, b]]
        };
        let triangles = [strip([-2.0, 0.1], -0.21), strip([0.1, 2.0], 0.0)].concat();
        let mut crest = Ground {
            kind: GroundKind::Mesh { file: String::new(), ceiling: None, surface: None },
            ..Ground::default()
        };
        crest.lay(&std::sync::Arc::new(crate::model::Surface::new(triangles)));
        let crest = Terrain::new(&crest);
        assert!(
            held(&crest, at(0.0, 0.12), DVec3::Y, at(-0.005, 0.0)) < 0.0,
            "a heel over the ramp, under the floor's plane"
        );
        let along = dvec3(0.0, 1.0, -0.1).normalize();
        let deep = held(&crest, at(0.0, 0.1), along, at(-0.01, 0.2));
        assert!((deep - 0.01).abs() < 1e-12, "{deep}: under the floor");
        let ridge = held(&crest, at(-0.02, 0.1), DVec3::Y, at(-0.015, 0.12));
        assert!((ridge - 0.015).abs() < 1e-12, "{ridge}: over its plane, and the ground is higher still");
    }

    #[test]
    fn who_rides_a_platform_stands_still_on_it_and_slides_over_the_world() {
        let body = fixture::body();
        let terrain = tilting(4.0);
        let poses = fixture::poses(&body, 121, |pose, sample| {
            let turn = terrain.turn(sample / 120.0);
            pose.hips = turn * pose.hips;
            pose.turns.iter_mut().for_each(|joint| *joint = turn * *joint);
        });
        let motion = Motion { ..fixture::motion(&body, &poses) };
        let standing = fixture::standing();
        let riding = standing.map(|contact| HeldContact { frame: Frame::Platform, ..contact });
        let rides = measure_on(motion, &terrain, &riding, &[]).expect("sound");
        assert!(rides.feet.slip_max_mm < 1e-9 && rides.feet.slip_speed_p95 < 1e-6, "{:?}", rides.feet);
        assert!(rides.feet.penetration_max_mm < 1e-9 && rides.feet.float_max_mm < 1e-9, "{:?}", rides.feet);
        let stays = measure_on(motion, &terrain, &standing, &[]).expect("sound");
        assert!(stays.feet.slip_max_mm > 5.0, "{:?}", stays.feet);
        // In the air its sole is on the platform still.
        assert!(measure_on(motion, &terrain, &[], &[]).expect("sound").feet.penetration_max_mm < 1e-6);
    }

    #[test]
    fn a_stand_on_a_slope_needs_its_tangent_of_friction() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 240, |pose, sample| pose.hips.x += 0.03 * real::sin(sample / 40.0));
        for degrees in [-20.0_f64, 10.0, 25.0] {
            let angle = degrees.to_radians();
            let terrain = ground(GroundKind::Slope { angle });
            let normal = terrain.spot(DVec2::ZERO).normal;
            let contacts = fixture::standing().map(|contact| HeldContact { normal, ..contact });
            let found = measure_on(fixture::motion(&body, &poses), &terrain, &contacts, &[]).expect("sound");
            assert!((found.friction_p99 - real::tan(angle.abs())).abs() < 0.03, "{degrees}: {}", found.friction_p99);
            assert!(found.zmp.inside > 0.99 && found.residual_force < 1e-6, "{degrees}: {:?}", found.zmp);
        }
    }

    #[test]
    fn a_climber_has_not_fallen_and_a_level_walker_under_the_slope_has() {
        let body = fixture::body();
        let terrain = ground(GroundKind::Slope { angle: 0.3 });
        let walked = |climbs: f64| {
            let poses = fixture::poses(&body, 361, |pose, sample| {
                let way = 2.0 * sample / 360.0;
                pose.hips += dvec3(0.0, climbs * way * real::tan(0.3), way);
                pose.turns[0] = DQuat::IDENTITY;
            });
            measure_on(fixture::motion(&body, &poses), &terrain, &[], &[]).expect("sound").balance.fallen
        };
        assert_eq!(walked(1.0), None);
        assert!(walked(0.0).is_some_and(|time| time > 1.0));
    }

    #[test]
    fn a_flat_sole_may_leave_round_ground_along_the_plane_that_it_stood_on() {
        let body = fixture::body();
        let terrain = ground(GroundKind::Uneven { height: 0.1, wavelength: 0.8, seed: 3 });
        let poses = fixture::poses(&body, 121, |_, _| {});
        let track = Track::over(fixture::motion(&body, &poses), &terrain).expect("sound");
        let normal = terrain.spot(DVec2::ZERO).normal;
        let hold = |start, end| HeldContact { start, end, normal, ..fixture::flat(Side::Left, 0.0, 0.0) };
        let contacts = [hold(0.0, 0.2), hold(0.6, 1.0)];
        // Points of the plane that lie under the round ground beside it.
        let sunk = (0..400).map(|at| DVec2::new(f64::from(at % 20) - 10.0, f64::from(at / 20) - 10.0) * 0.02);
        let sunk = sunk.map(|at| dvec3(at.x, -(at.x * normal.x + at.y * normal.z) / normal.y, at.y));
        let sunk: Vec<DVec3> = sunk.filter(|point| depth(&terrain, 0.0, *point) > 2e-3).collect();
        assert!(sunk.len() > 20, "{}", sunk.len());
        let worst = |sample: usize| {
            let floor = Swung::new(&track, &contacts, Side::Left, sample);
            sunk.iter().map(|point| floor.depth(*point)).fold(0.0, f64::max)
        };
        assert!(worst(30) < 1e-9 && worst(70) < 1e-9, "just lifted, and soon down: {} {}", worst(30), worst(70));
        assert!(worst(48) > 2e-3, "in mid-swing the ground is what it is");
    }
}

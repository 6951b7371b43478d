//! Where the ground carries: the soles' parts in contact, their hull on the contact plane, the corners that can push.
//!
//! Scenario space, m. A part is a share of the sole: heel the rear third, ball what is ahead of the ball line, flat all
//! of it. Sole vertices are taken at the pose and projected onto the contact's plane along its normal, so that a sole
//! that hovers or sinks by a hair supports as the contact claims; `feet` says by how much it does.

use super::scuff::Touching;
use super::{HeldContact, Scuff, Track};
use crate::maths::hull::{closest_point, convex_hull, signed_distance};
use crate::model::{Body, FootShape, Side, report::Part};
use glam::{DVec2, DVec3, dvec3};

/// Planes whose normals differ by more than this angle (rad) or whose points lie further apart along them than
/// [`SAME_PLANE_GAP`] (m) have no common ZMP.
const SAME_PLANE_ANGLE: f64 = 0.035;
/// m.
const SAME_PLANE_GAP: f64 = 0.01;

/// s, how far the filter of the forces (7 Hz, zero lag) spreads a blow: what is farther off weighs 4 % on either side (what is farther than
/// 0.03 s, 8 %, and a landing's blow is several times the body's weight).
pub const SMEARED: f64 = 0.05;

/// The support of one sample.
#[derive(Clone, Debug)]
pub struct Support {
    /// m, a point of the plane (at the mean height, where planes differ).
    pub origin: DVec3,
    /// Unit (the mean, where planes differ).
    pub normal: DVec3,
    /// Unit, the plane's own axes; X and Z on level ground.
    pub axes: [DVec3; 2],
    /// m, in those axes from the point of the plane nearest the space's origin: (x, z) on level ground.
    pub hull: Vec<DVec2>,
    /// Corners that can push: point and its plane's unit normal.
    pub corners: Vec<(DVec3, DVec3)>,
    /// All contacts lie in one plane.
    pub level: bool,
}

/// The support at a sample; `None` in flight.
pub fn support(track: &Track, contacts: &[HeldContact], sample: usize) -> Option<Support> {
    support_near(track, contacts, sample, 0.0)
}

/// What carries at a sample or up to `near` s before or after it, where it is when it carries; `None` in flight.
pub fn support_near(track: &Track, contacts: &[HeldContact], sample: usize, near: f64) -> Option<Support> {
    let time = track.motion.time(sample);
    let holds = |contact: &&HeldContact| contact.start - near - 1e-6 <= time && time <= contact.end + near + 1e-6;
    let holding: Vec<HeldContact> =
        contacts.iter().filter(holds).map(|contact| track.placed(contact, sample)).collect();
    let scuffs = touching_then(track, time);
    let planes: Vec<HeldContact> = holding.iter().chain(scuffs.iter().map(|scuff| &scuff.plane)).copied().collect();
    let first = *planes.first()?;
    let normal = planes.iter().map(|contact| contact.normal).sum::<DVec3>().normalize_or(first.normal);
    let level = planes.iter().all(|contact| {
        contact.normal.angle_between(first.normal) <= SAME_PLANE_ANGLE
            && first.height(contact.point).abs() <= SAME_PLANE_GAP
    });
    let axes = plane_axes(normal);
    // Planes that differ meet halfway: what is seen of them together (the hull) lies at their mean height.
    let height = planes.iter().map(|contact| contact.point.dot(normal)).sum::<f64>() / planes.len() as f64;
    let origin = normal * if level { first.point.dot(normal) } else { height };
    let mut support = Support { origin, normal, axes, hull: Vec::new(), corners: Vec::new(), level };
    let mut points: Vec<DVec3> = Vec::new();
    let mut flat: Vec<DVec2> = Vec::new();
    for (index, contact) in planes.iter().enumerate() {
        points.clear();
        match index.checked_sub(holding.len()) {
            Some(scuff) => points.extend_from_slice(&scuffs[scuff].points),
            None => {
                let within = track.motion.samples_in(contact.start, contact.end);
                let held = if within.is_empty() { sample } else { sample.clamp(within.start, within.end - 1) };
                part_points(track, held, contact.side, contact.part, &mut points);
            }
        }
        if level {
            flat.extend(points.iter().map(|point| support.on_plane(*point)));
        } else {
            // Each plane has corners of its own.
            let [x, z] = plane_axes(contact.normal);
            let base = contact.normal * contact.point.dot(contact.normal);
            let outline: Vec<DVec2> = points.iter().map(|point| DVec2::new(point.dot(x), point.dot(z))).collect();
            let lift = |at: DVec2| base + x * at.x + z * at.y;
            support.corners.extend(thinned(&convex_hull(&outline)).map(|at| (lift(at), contact.normal)));
            flat.extend(points.iter().map(|point| support.on_plane(*point)));
        }
    }
    support.hull = convex_hull(&flat);
    if level {
        support.corners = thinned(&support.hull).map(|at| (support.in_space(at), normal)).collect();
    }
    Some(support)
}

/// What of the feet that scuff then or just before or after touches the ground in that time.
fn touching_then<'t>(track: &'t Track, time: f64) -> Vec<&'t Touching> {
    let near = |scuff: &Scuff| [scuff.start.max(time - SMEARED), scuff.end.min(time + SMEARED)];
    let scuffs = track.scuffs.iter().zip(&track.touched);
    scuffs.flat_map(|(scuff, touched)| touched.in_span(track, near(scuff))).collect()
}

/// The hull alone: (x, z) on level ground; empty in flight.
pub fn support_at(track: &Track, sample: usize, contacts: &[HeldContact]) -> Vec<DVec2> {
    support(track, contacts, sample).map(|support| support.hull).unwrap_or_default()
}

impl Support {
    /// A point's place on the plane, along the normal.
    pub fn on_plane(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.axes[0]), point.dot(self.axes[1]))
    }

    /// The place on the plane straight below (or above) a point: along gravity, not along the normal.
    pub fn below(&self, point: DVec3) -> DVec2 {
        let height = (point - self.origin).dot(self.normal);
        self.on_plane(point - DVec3::Y * (height / self.normal.y.max(0.1)))
    }

    /// m, the point of space at a place on the plane.
    pub fn in_space(&self, at: DVec2) -> DVec3 {
        self.origin + self.axes[0] * at.x + self.axes[1] * at.y
    }

    /// m, how far out of the hull a place is; negative inside.
    pub fn outside(&self, at: DVec2) -> f64 {
        signed_distance(&self.hull, at)
    }

    /// The nearest place of the hull.
    pub fn nearest(&self, at: DVec2) -> Option<DVec2> {
        closest_point(&self.hull, at)
    }
}

/// The sole's vertices of a part at a sample, m, scenario space; never none.
pub fn part_points(track: &Track, sample: usize, side: Side, part: Part, out: &mut Vec<DVec3>) {
    let body = track.motion.body;
    let foot = &body.feet[side as usize];
    let rear = |out: &mut Vec<DVec3>, from: f64| {
        let kept = foot.rear_sole.iter().filter(|offset| from == f64::INFINITY || along(foot, **offset) <= from);
        out.extend(kept.map(|offset| track.rigid_point(sample, foot.ankle, *offset)));
    };
    let front = |out: &mut Vec<DVec3>| match foot.toe {
        Some(toe) => {
            let shift = body.joints[toe].rest - body.joints[foot.ankle].rest;
            out.extend(foot.front_sole.iter().map(|offset| track.rigid_point(sample, toe, *offset - shift)));
        }
        None => out.extend(foot.front_sole.iter().map(|offset| track.rigid_point(sample, foot.ankle, *offset))),
    };
    let before = out.len();
    match part {
        Part::Flat => {
            rear(out, f64::INFINITY);
            front(out);
        }
        Part::Heel => rear(out, foot.heel + (foot.tip - foot.heel) / 3.0 + 1e-9),
        Part::Ball => front(out),
    }
    if out.len() == before {
        // A sole without vertices there: its outline.
        let (from, to) = match part {
            Part::Flat => (foot.heel, foot.tip),
            Part::Heel => (foot.heel, foot.heel + (foot.tip - foot.heel) / 3.0),
            Part::Ball => (foot.ball, foot.tip),
        };
        for (length, width) in [(from, -1.0), (from, 1.0), (to, -1.0), (to, 1.0)] {
            let offset = levelled_point(foot, length, width * foot.half_width, 0.0);
            out.push(track.rigid_point(sample, foot.ankle, offset));
        }
    }
}

/// A point that a contact holds still: rigid with a joint, at an offset from it at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldPoint {
    /// Index of the joint.
    pub joint: usize,
    /// m.
    pub offset: DVec3,
}

/// The points that a contact of that part holds still. Flat: ankle and toe joints; ball: the toe joint; heel: the
/// rearmost point of the sole ([`FootShape::heel_point`]). A foot without toe joint turns about the tip of its sole, so that is held instead.
pub fn held_points(body: &Body, side: Side, part: Part) -> Vec<HeldPoint> {
    let foot = &body.feet[side as usize];
    let ankle = HeldPoint { joint: foot.ankle, offset: DVec3::ZERO };
    let toe = match foot.toe {
        Some(joint) => HeldPoint { joint, offset: DVec3::ZERO },
        None => HeldPoint { joint: foot.ankle, offset: levelled_point(foot, foot.tip, 0.0, 0.0) },
    };
    match part {
        Part::Flat => vec![ankle, toe],
        Part::Ball => vec![toe],
        Part::Heel => vec![HeldPoint { joint: foot.ankle, offset: foot.heel_point() }],
    }
}

/// m, offset from the ankle at rest of a point that is rigid with the foot joint and, where the foot stands level,
/// `length` along it, `width` to its left and `height` over its sole.
pub fn levelled_point(foot: &FootShape, length: f64, width: f64, height: f64) -> DVec3 {
    let left = DVec2::new(foot.forward.y, -foot.forward.x);
    let flat = foot.forward * length + left * width;
    foot.level.inverse() * dvec3(flat.x, height - foot.ankle_height, flat.y)
}

/// m, along the levelled foot from the ankle, of a vertex that moves with the foot joint.
fn along(foot: &FootShape, offset: DVec3) -> f64 {
    let levelled = foot.level * offset;
    foot.forward.dot(DVec2::new(levelled.x, levelled.z))
}

/// Two unit vectors that span the plane, X and Z for a level one.
fn plane_axes(normal: DVec3) -> [DVec3; 2] {
    let x = (DVec3::X - normal * normal.x).try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
    [x, x.cross(normal)]
}

/// m, as far beside the line between its neighbours a corner says nothing.
const BESIDE: f64 = 0.002;

/// The corners of a hull without those that are hardly beside the line between their neighbours: the least telling goes first, so that of
/// some that lie close together one stays.
fn thinned(hull: &[DVec2]) -> impl Iterator<Item = DVec2> {
    let mut kept = hull.to_vec();
    let beside = |kept: &[DVec2], index: usize| {
        let (last, next) = (kept[(index + kept.len() - 1) % kept.len()], kept[(index + 1) % kept.len()]);
        (next - last).normalize_or_zero().perp_dot(kept[index] - last).abs()
    };
    let mut far: Vec<f64> = (0..kept.len()).map(|index| beside(&kept, index)).collect();
    while kept.len() > 4 {
        let least = far.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        let Some((index, _)) = least.filter(|(_, least)| **least <= BESIDE) else { break };
        kept.remove(index);
        far.remove(index);
        // Only its neighbours are now beside another line.
        for near in [(index + kept.len() - 1) % kept.len(), index % kept.len()] {
            far[near] = beside(&kept, near);
        }
    }
    kept.into_iter()
}

#[cfg(test)]
mod tests {
    use super::super::{Scuff, fixture};
    use super::*;
    use crate::model::Terrain;
    use glam::DQuat;

    fn area(hull: &[DVec2]) -> f64 {
        (0..hull.len()).map(|i| 0.5 * hull[i].perp_dot(hull[(i + 1) % hull.len()])).sum()
    }

    #[test]
    fn each_part_supports_with_its_share_of_the_sole() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 4, |_, _| {});
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let of = |part| {
            let contact = HeldContact { part, ..fixture::flat(Side::Left, 0.0, 1.0) };
            area(&support(&track, &[contact], 0).expect("in contact").hull)
        };
        assert!((of(Part::Flat) - 0.25 * 0.09).abs() < 1e-9);
        assert!((of(Part::Ball) - 0.07 * 0.09).abs() < 1e-9);
        // Rear third reaches 23 mm ahead of the ankle; the last vertices before that stand at the ankle.
        assert!((of(Part::Heel) - 0.06 * 0.09).abs() < 1e-9);
        let both = support(&track, &fixture::standing(), 0).expect("in contact");
        assert!((area(&both.hull) - 0.25 * 0.29).abs() < 1e-9);
        assert!(support(&track, &[fixture::flat(Side::Left, 0.5, 1.0)], 0).is_none(), "flight before the contact");
    }

    #[test]
    fn what_carries_in_a_moment_supports_where_it_will_stand() {
        let body = fixture::body();
        // It comes from 0.3 m behind and stands from 0.5 s on.
        let poses = fixture::poses(&body, 121, |pose, sample| pose.hips.z -= 1.0 * (0.5 - sample / 120.0).max(0.0));
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let lands = [fixture::flat(Side::Left, 0.5, 1.0)];
        let stands = support(&track, &lands, 60).expect("it stands");
        let before = support_near(&track, &lands, 55, 0.05).expect("it is about to");
        assert_eq!(before.hull, stands.hull);
        assert!(support(&track, &lands, 55).is_none() && support_near(&track, &lands, 50, 0.05).is_none());
    }

    #[test]
    fn a_foot_that_rolls_on_supports_with_all_that_touches_meanwhile() {
        let body = fixture::body();
        // Onto its heels and back, within 0.1 s.
        let poses = fixture::poses(&body, 121, |pose, sample| {
            let pitch = DQuat::from_rotation_x(-0.3 * (1.0 - ((sample - 60.0) / 6.0).abs()).max(0.0));
            pose.turns.iter_mut().for_each(|turn| *turn = pitch);
            pose.hips = pitch * (pose.hips - dvec3(0.0, 0.0, -0.06)) + dvec3(0.0, 0.0, -0.06);
        });
        let scuffs = Side::BOTH.map(|side| Scuff { side, start: 0.3, end: 0.7 });
        let track = Track::over(fixture::motion(&body, &poses), &Terrain::flat()).expect("sound").scuffing(&scuffs);
        let length = |sample: usize| {
            let hull = support(&track, &[], sample).expect("it touches").hull;
            let along = hull.iter().map(|point| point.y);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        assert!(length(60) > 0.24, "{} m on the heels, and flat a moment before", length(60));
        assert!(length(45) > 0.24);
    }

    #[test]
    fn two_heights_are_no_common_plane() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 2, |_, _| {});
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let mut stairs = fixture::standing();
        assert!(support(&track, &stairs, 0).expect("in contact").level);
        stairs[1].point.y = 0.17;
        let support = support(&track, &stairs, 0).expect("in contact");
        assert!(!support.level);
        assert!(support.corners.iter().any(|(point, _)| point.y == 0.17));
        assert!(support.corners.iter().any(|(point, _)| point.y == 0.0));
    }

    #[test]
    fn a_sloping_plane_keeps_lengths() {
        let normal = dvec3(0.0, 1.0, 1.0).normalize();
        let [x, z] = plane_axes(normal);
        assert!(x.dot(normal).abs() < 1e-12 && z.dot(normal).abs() < 1e-12 && z.z > 0.0);
        assert_eq!(plane_axes(DVec3::Y), [DVec3::X, DVec3::Z]);
    }
}

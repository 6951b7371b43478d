//! Where a clip's travel goes: onto a root bone, into the hips, or away.
//!
//! The root follows the character over the ground (x, z and yaw, scenario space) along the hips' path with the sway taken
//! out: a zero-lag Gaussian over 0.2 s whose ends are pinned, so that the root starts at rest and ends exactly under the
//! character, where the next clip goes on. It rises and falls with the ground that carries the body, on stairs as on a
//! ramp; what the body does over that stays with the hips. In place only the horizontal travel is left out.

use super::spline;
use super::track::CORNER;
use crate::maths::real;
use crate::model::BodyPose;
use crate::rig::Rig;
use crate::rig::animate::{RootCarrier, RootMove, hermite, slerp};
use glam::{DQuat, DVec3, DVec4};
use std::f64::consts::{PI, TAU};

/// s, standard deviation of the filter on the root's path.
const SMOOTHING: f64 = 0.2;
/// m, how far from the root's path its splines may be; straight lines less, whose corners are steps of its speed.
const KNOT_PLACE: [f64; 2] = [1.0e-2, 1.0e-3];
/// rad, the same for its yaw: 1 degree, 0.2 degrees.
const KNOT_YAW: [f64; 2] = [1.0 * PI / 180.0, 0.2 * PI / 180.0];

/// s: slopes are taken over that, to either side.
const SLOPE: f64 = 1.0e-3;

/// Where the travel goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RootMotion {
    /// Onto the root bone, or a new `Root` where the rig has none.
    #[default]
    Root,
    /// All in the hips.
    Hips,
    /// Horizontal travel is left out: the feet slide by design, and contacts are those of the travelling clip.
    InPlace,
}

impl RootMotion {
    /// As the command line and the report spell it.
    pub fn name(self) -> &'static str {
        match self {
            RootMotion::Root => "root",
            RootMotion::Hips => "hips",
            RootMotion::InPlace => "in-place",
        }
    }

    /// The mode of that name.
    pub fn from_name(name: &str) -> Option<RootMotion> {
        [RootMotion::Root, RootMotion::Hips, RootMotion::InPlace].into_iter().find(|mode| mode.name() == name)
    }

    /// The node that carries it on a rig.
    pub fn carrier(self, rig: &Rig) -> RootCarrier {
        match self {
            RootMotion::Hips => RootCarrier::None,
            RootMotion::Root | RootMotion::InPlace => root_bone(rig).map_or(RootCarrier::New, RootCarrier::Node),
        }
    }
}

/// The rig's own root bone: above the hips, on the ground at the origin, and a joint of a skin or called "root". A name wins
/// over a place, the upper over the lower.
pub fn root_bone(rig: &Rig) -> Option<usize> {
    let joints = rig.skin_joints();
    let globals = rig.bind_globals();
    let mut above = Vec::new();
    let mut at = rig.nodes.get(rig.hips_node())?.parent;
    while let Some(node) = at {
        above.push(node);
        at = rig.nodes[node].parent;
    }
    let near = |node: usize| {
        let place = globals[node].translation / rig.body.height.max(1e-6);
        real::hypot(place.x, place.z) < 0.05 && place.y.abs() < 0.1
    };
    above.retain(|node| near(*node));
    let named = above.iter().rev().find(|node| rig.nodes[**node].name.as_deref().is_some_and(is_root_name));
    named.or_else(|| above.iter().rev().find(|node| joints.contains(*node))).copied()
}

fn is_root_name(name: &str) -> bool {
    let plain: String = name
        .rsplit([':', '|'])
        .next()
        .unwrap_or(name)
        .chars()
        .filter(char::is_ascii_alphanumeric)
        .collect::<String>()
        .to_ascii_lowercase();
    matches!(
        plain.as_str(),
        "root" | "rootmotion" | "rootbone" | "boneroot" | "rlboneroot" | "ccbaseboneroot" | "rootx"
    )
}

/// The root's path, sampled evenly and joined by cubics; or by the splines of its keys.
#[derive(Clone, Debug, PartialEq)]
pub struct RootCurve {
    dt: f64,
    samples: Vec<[f64; 4]>, // x, z (m), yaw (rad), y (m)
    knots: Vec<Knot>,       // empty until keyed
    straight: bool,         // joined by lines
    carrier: DVec3,         // m, where the node that carries it is at rest: between keys that goes by straight lines
}

/// A key of the root: values and slopes as a reader has them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    time: f64,
    place: [DVec4; 2], // m, then m/s
    turn: [DVec4; 2],  // the quaternion's parts, then theirs a second
}

impl RootCurve {
    /// The path for poses `dt` s apart, the first at time 0, over ground that is that high (m) under them (0 where it is not
    /// said). Without `turning` the yaw stays 0.
    pub fn follow(poses: &[BodyPose], heights: &[f64], dt: f64, turning: bool) -> RootCurve {
        let Some(first) = poses.first() else {
            return RootCurve { dt, samples: vec![[0.0; 4]], knots: Vec::new(), straight: false, carrier: DVec3::ZERO };
        };
        let mut yaw = 0.0;
        let mut samples = Vec::with_capacity(poses.len());
        for (index, pose) in poses.iter().enumerate() {
            if turning {
                let twist = twist(pose.turns[0]) - twist(first.turns[0]);
                yaw += (twist - yaw + PI).rem_euclid(TAU) - PI;
            }
            let place = pose.hips - DQuat::from_rotation_y(yaw) * first.hips;
            let rise = heights.get(index).map_or(0.0, |height| height - heights[0]);
            samples.push([place.x, place.z, yaw, rise]);
        }
        RootCurve {
            dt,
            samples: smooth(&samples, SMOOTHING / dt.max(1e-6)),
            knots: Vec::new(),
            straight: false,
            carrier: DVec3::ZERO,
        }
    }

    /// Replaces the path by splines (or straight lines) between as few of `times` (s, rising) as follow it closely. What the root then
    /// does between its keys is known exactly, and the hips make up for it. `carrier`: m, where the node that carries it is at rest.
    pub fn key(&mut self, times: &[f64], straight: bool, carrier: DVec3) {
        (self.straight, self.carrier) = (straight, carrier);
        let lines = straight.then_some(carrier);
        let knots: Vec<Knot> = times.iter().map(|time| self.knot_at(*time)).collect();
        let path: Vec<[f64; 4]> = times.iter().map(|time| self.smooth_at(*time)).collect();
        let (place, turn) = (KNOT_PLACE[usize::from(straight)], KNOT_YAW[usize::from(straight)]);
        let spans = |from: usize, to: usize| {
            (from + 1..to).all(|at| {
                let now = between(&knots[from], &knots[to], times[at], lines);
                let [x, z, yaw, y] = path[at];
                let turned = now.rotation * DQuat::from_rotation_y(-yaw);
                now.translation.distance(DVec3::new(x, y, z)) <= place && real::sin(twist(turned)).abs() <= turn
            })
        };
        let mut kept: Vec<Knot> = knots.first().copied().into_iter().collect();
        let mut from = 0;
        while from + 1 < times.len() {
            let mut to = from + 1;
            while to + 1 < times.len() && spans(from, to + 1) {
                to += 1;
            }
            kept.push(knots[to]);
            from = to;
        }
        let clock: Vec<f64> = kept.iter().map(|knot| knot.time).collect();
        let evened = |part: fn(&Knot) -> [DVec4; 2]| {
            let values: Vec<DVec4> = kept.iter().map(|knot| part(knot)[0]).collect();
            let ends = [kept.first(), kept.last()].map(|knot| knot.map_or(DVec4::ZERO, |knot| part(knot)[1]));
            let ends = ends.map(|slope| if slope.length() < CORNER { DVec4::ZERO } else { slope });
            spline::slopes(&clock, &values, ends)
        };
        let (places, turns) = (evened(|knot| knot.place), evened(|knot| knot.turn));
        for ((knot, place), turn) in kept.iter_mut().zip(places).zip(turns) {
            (knot.place[1], knot.turn[1]) = (place, turn);
        }
        self.knots = kept;
    }

    /// Whether it has a key at `time` (s).
    pub fn has_knot(&self, time: f64) -> bool {
        self.knots.iter().any(|knot| knot.time == time)
    }

    /// Where the root is at `time` (s), from rest.
    pub fn at(&self, time: f64) -> RootMove {
        let next = self.knots.partition_point(|knot| knot.time <= time);
        let lines = self.straight.then_some(self.carrier);
        match (self.knots.get(next.wrapping_sub(1)), self.knots.get(next)) {
            (Some(earlier), Some(later)) => between(earlier, later, time, lines),
            (Some(only), None) | (None, Some(only)) => between(only, only, time, lines),
            (None, None) => {
                let [x, z, yaw, y] = self.smooth_at(time);
                RootMove { rotation: DQuat::from_rotation_y(yaw), translation: DVec3::new(x, y, z) }
            }
        }
    }

    fn knot_at(&self, time: f64) -> Knot {
        let end = self.dt * (self.samples.len() - 1) as f64;
        let [early, late] = [(time - SLOPE).max(0.0), (time + SLOPE).min(end.max(SLOPE))];
        let (now, before, after) = (self.smooth_at(time), self.smooth_at(early), self.smooth_at(late));
        let [vx, vz, spin, vy] = [0, 1, 2, 3].map(|axis| (after[axis] - before[axis]) / (late - early).max(SLOPE));
        let [x, z, yaw, y] = now;
        let (sine, cosine) = real::sin_cos(yaw / 2.0);
        Knot {
            time,
            place: [DVec4::new(x, y, z, 0.0), DVec4::new(vx, vy, vz, 0.0)],
            turn: [DVec4::new(0.0, sine, 0.0, cosine), DVec4::new(0.0, cosine, 0.0, -sine) * (spin / 2.0)],
        }
    }

    fn smooth_at(&self, time: f64) -> [f64; 4] {
        let last = self.samples.len() - 1;
        let place = (time / self.dt.max(1e-9)).clamp(0.0, last as f64);
        let index = (place.floor() as usize).min(last.saturating_sub(1));
        let share = place - index as f64;
        let sample = |offset: isize, axis: usize| {
            let at = index as isize + offset;
            let inside = |at: isize| self.samples[at.clamp(0, last as isize) as usize][axis];
            if at < 0 {
                2.0 * inside(0) - inside(-at)
            } else if at > last as isize {
                2.0 * inside(last as isize) - inside(2 * last as isize - at)
            } else {
                inside(at)
            }
        };
        [0, 1, 2, 3].map(|axis| cubic([-1, 0, 1, 2].map(|offset| sample(offset, axis)), share))
    }
}

/// As a reader joins two keys; by lines, which what stands at that place at rest goes along.
fn between(from: &Knot, to: &Knot, time: f64, lines: Option<DVec3>) -> RootMove {
    let seconds = to.time - from.time;
    let share = if seconds > 0.0 { ((time - from.time) / seconds).clamp(0.0, 1.0) } else { 0.0 };
    if let Some(carrier) = lines {
        let [first, last] = [from, to].map(|knot| DQuat::from_vec4(knot.turn[0]));
        let rotation = slerp(first, last, share);
        let carrier = carrier * DVec3::new(1.0, 0.0, 1.0); // turned about Y: its height stays to the bit
        let [start, end] = [(from, first), (to, last)].map(|(knot, turn)| knot.place[0].truncate() + turn * carrier);
        return RootMove { rotation, translation: start.lerp(end, share) - rotation * carrier };
    }
    let place = hermite([from.place[0], from.place[1], to.place[1], to.place[0]], seconds, share);
    let turn = hermite([from.turn[0], from.turn[1], to.turn[1], to.turn[0]], seconds, share);
    RootMove { rotation: DQuat::from_vec4(turn.try_normalize().unwrap_or(DVec4::W)), translation: place.truncate() }
}

/// The turn about +Y in a rotation, rad.
fn twist(turn: DQuat) -> f64 {
    if turn.y == 0.0 && turn.w == 0.0 { 0.0 } else { 2.0 * real::atan2(turn.y, turn.w) }
}

/// Catmull-Rom through the middle two.
fn cubic([before, from, to, after]: [f64; 4], share: f64) -> f64 {
    let (start, end) = ((to - before) / 2.0, (after - from) / 2.0);
    let difference = to - from;
    from + share * (start + share * ((3.0 * difference - 2.0 * start - end) + share * (start + end - 2.0 * difference)))
}

/// Gaussian of `deviation` samples; the ends continue by point reflection, which leaves the end samples where they are.
fn smooth(samples: &[[f64; 4]], deviation: f64) -> Vec<[f64; 4]> {
    let last = samples.len() as isize - 1;
    let reach = ((3.0 * deviation).ceil() as isize).min(last.max(0));
    let weights: Vec<f64> =
        (-reach..=reach).map(|offset| real::exp(-0.5 * (offset as f64 / deviation).powi(2))).collect();
    let total: f64 = weights.iter().sum();
    let extended = |at: isize, axis: usize| {
        let inside = |at: isize| samples[at.clamp(0, last) as usize][axis];
        match at {
            at if at < 0 => 2.0 * inside(0) - inside(-at),
            at if at > last => 2.0 * inside(last) - inside(2 * last - at),
            at => inside(at),
        }
    };
    let filtered = |centre: isize, axis: usize| {
        let terms = weights.iter().zip(-reach..=reach).map(|(weight, offset)| weight * extended(centre + offset, axis));
        terms.sum::<f64>() / total
    };
    let mut result: Vec<[f64; 4]> = (0..=last).map(|centre| [0, 1, 2, 3].map(|axis| filtered(centre, axis))).collect();
    for end in [0, last as usize] {
        result[end] = samples[end]; // the same but for rounding
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(count: usize, dt: f64) -> Vec<BodyPose> {
        let pose = |index: usize| {
            let time = index as f64 * dt;
            let going = (time - 1.0).clamp(0.0, 1.0);
            let sway = 0.03 * real::sin(TAU * 3.0 * time) * going * (2.0 - time).max(0.0);
            let hips = DVec3::new(0.02 + sway, 0.9, 0.05 + going * going * (3.0 - 2.0 * going));
            BodyPose { hips, turns: vec![DQuat::from_rotation_y(3.5 * going)] }
        };
        (0..count).map(pose).collect()
    }

    #[test]
    fn the_root_starts_at_rest_and_ends_under_the_character() {
        let poses = walk(91, 1.0 / 30.0);
        let curve = RootCurve::follow(&poses, &[], 1.0 / 30.0, true);
        assert_eq!(curve.at(0.0), RootMove::IDENTITY);
        let end = curve.at(3.0);
        // Turned by more than half a circle: the angle is followed, not wrapped.
        assert!(end.rotation.angle_between(DQuat::from_rotation_y(3.5)) < 1e-9, "{end:?}");
        let hips = end.affine().transform_point3(poses[0].hips);
        assert!(hips.distance(poses[90].hips) < 1e-9, "{hips}");
    }

    #[test]
    fn sway_stays_in_the_hips() {
        let poses = walk(91, 1.0 / 30.0);
        let curve = RootCurve::follow(&poses, &[], 1.0 / 30.0, false);
        let jitter = |path: &[f64]| path.windows(3).map(|p| (p[0] - 2.0 * p[1] + p[2]).abs()).fold(0.0, f64::max);
        let raw: Vec<f64> = poses.iter().map(|pose| pose.hips.x).collect();
        let root: Vec<f64> = (0..91).map(|index| curve.at(f64::from(index) / 30.0).translation.x).collect();
        assert!(jitter(&root) < 0.05 * jitter(&raw), "{} {}", jitter(&root), jitter(&raw));
    }

    #[test]
    fn stairs_are_a_ramp_to_the_root_and_end_where_they_end() {
        let poses = walk(91, 1.0 / 30.0);
        let tread = |time: f64| 0.17 * ((time - 0.5) / 0.55).ceil().clamp(0.0, 3.0) + 0.4;
        let heights: Vec<f64> = (0..91).map(|index| tread(f64::from(index) / 30.0)).collect();
        let curve = RootCurve::follow(&poses, &heights, 1.0 / 30.0, true);
        assert_eq!(curve.at(0.0), RootMove::IDENTITY);
        assert!((curve.at(3.0).translation.y - 0.51).abs() < 1e-9);
        let path: Vec<f64> = (0..90).map(|index| curve.at(f64::from(index) / 30.0).translation.y).collect();
        let steepest = path.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max) * 30.0;
        assert!(steepest < 0.45, "{steepest} m/s; a riser by itself is 5");
    }

    #[test]
    fn one_pose_makes_a_root_that_stays() {
        let curve = RootCurve::follow(&walk(1, 0.1), &[], 0.1, true);
        assert_eq!(curve.at(5.0), RootMove::IDENTITY);
    }
}

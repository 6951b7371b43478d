//! What the rules look at: centre of mass, its speed, and each foot's sole points with their heights and speeds, frame by frame.
//!
//! Clip space (metres, Y up), SI. The centre of mass is filtered (7 Hz, zero lag, as everywhere); feet are filtered at 12 Hz where the
//! frame rate allows, so that marker noise does not shake a standing foot off the ground.

use crate::maths::filter;
use crate::measure::GRAVITY;
use crate::measure::dynamics::CUTOFF_HZ;
use crate::measure::support::levelled_point;
use crate::model::{Capture, Role, Side};
use glam::{DVec2, DVec3};

/// Hz; above a foot's own motion in a heel strike, below markers' noise.
const FOOT_HZ: f64 = 12.0;

/// A capture with what is derived from it.
#[derive(Clone, Debug)]
pub struct Track<'a> {
    /// The motion.
    pub capture: &'a Capture,
    /// m, filtered.
    pub com: Vec<DVec3>,
    /// m/s.
    pub velocity: Vec<DVec3>,
    /// m/s².
    pub acceleration: Vec<DVec3>,
    /// Left and right.
    pub feet: [FootTrack; 2],
    /// Unit, (x, z): where the pelvis looks.
    pub facing: Vec<DVec2>,
}

/// One foot's points.
#[derive(Clone, Debug, Default)]
pub struct FootTrack {
    /// m: rear end, bending line and front end of the sole.
    pub points: Vec<[DVec3; 3]>,
    /// m/s, of the same points.
    pub speeds: Vec<[DVec3; 3]>,
    /// m: height of the lowest of the sole.
    pub low: Vec<f64>,
    /// m/s: speed of the point that moves least.
    pub still: Vec<f64>,
}

impl<'a> Track<'a> {
    /// Derives it. The capture has one frame at least.
    pub fn new(capture: &'a Capture) -> Track<'a> {
        let hz = capture.fps;
        let raw: Vec<DVec3> = (0..capture.frames()).map(|frame| capture.centre_of_mass(frame)).collect();
        let com = filter::zero_lag(&raw, CUTOFF_HZ, hz);
        let velocity = filter::derivative(&com, hz);
        let acceleration = filter::second_derivative(&com, hz);
        let feet = Side::BOTH.map(|side| foot_track(capture, side));
        Track { com, velocity, acceleration, feet, facing: facing(capture), capture }
    }

    /// Frames.
    pub fn len(&self) -> usize {
        self.com.len()
    }

    /// Whether there is none (never, of a capture).
    pub fn is_empty(&self) -> bool {
        self.com.is_empty()
    }

    /// m, (x, z): straight below the centre of mass.
    pub fn below(&self, frame: usize) -> DVec2 {
        DVec2::new(self.com[frame].x, self.com[frame].z)
    }

    /// 1/s, of the pendulum whose height is the centre of mass's over that ground.
    pub fn omega(&self, frame: usize, floor: f64) -> f64 {
        let tallest = self.capture.body.leg_length;
        (GRAVITY / (self.com[frame].y - floor).max(0.3 * tallest)).sqrt()
    }

    /// The body's own length: what lengths scale by, 1 for a leg of 0.83 m.
    pub fn size(&self) -> f64 {
        (self.capture.body.leg_length / 0.83).max(1e-3)
    }

    /// s, the body's own time: what times scale by, 1 for a leg of 0.83 m.
    pub fn tempo(&self) -> f64 {
        self.size().sqrt()
    }
}

impl FootTrack {
    /// m, (x, z): where the foot stands in a frame: the middle of heel and bending line.
    pub fn place(&self, frame: usize) -> DVec2 {
        let [heel, ball, _] = self.points[frame];
        let middle = (heel + ball) * 0.5;
        DVec2::new(middle.x, middle.z)
    }
}

fn foot_track(capture: &Capture, side: Side) -> FootTrack {
    let hz = capture.fps;
    let foot = &capture.body.feet[side as usize];
    let body = &capture.body;
    let heel = levelled_point(foot, foot.heel, 0.0, 0.0);
    let ball = levelled_point(foot, foot.ball, 0.0, 0.0);
    let ahead = |offset: &DVec3| {
        let levelled = foot.level * *offset;
        foot.forward.dot(DVec2::new(levelled.x, levelled.z))
    };
    // Its foremost point, brought to the middle line: a vertex is on one side of it.
    let front = foot.front_sole.iter().max_by(|a, b| ahead(a).total_cmp(&ahead(b))).map(|vertex| {
        let along = foot.forward * ahead(vertex);
        foot.level.inverse() * DVec3::new(along.x, (foot.level * *vertex).y, along.y)
    });
    let front = front.unwrap_or_else(|| levelled_point(foot, foot.tip, 0.0, 0.0));
    let shift = foot.toe.map_or(DVec3::ZERO, |toe| body.joints[toe].rest - body.joints[foot.ankle].rest);
    let (tip_joint, tip) = (foot.toe.unwrap_or(foot.ankle), front - shift);
    let mut series: [Vec<DVec3>; 3] = Default::default();
    let mut low = Vec::with_capacity(capture.frames());
    for frame in 0..capture.frames() {
        let places = [
            capture.rigid_point(frame, foot.ankle, heel),
            capture.rigid_point(frame, foot.ankle, ball),
            capture.rigid_point(frame, tip_joint, tip),
        ];
        low.push(places.iter().map(|place| place.y).fold(f64::MAX, f64::min));
        for (series, place) in series.iter_mut().zip(places) {
            series.push(place);
        }
    }
    let series = series.map(|series| filter::zero_lag(&series, FOOT_HZ, hz));
    let rates = [0, 1, 2].map(|point: usize| filter::derivative(&series[point], hz));
    let low = filter::zero_lag(&low, FOOT_HZ, hz);
    let frames = low.len();
    let still =
        (0..frames).map(|frame| rates.iter().map(|rate| rate[frame].length()).fold(f64::MAX, f64::min)).collect();
    FootTrack {
        points: (0..frames).map(|frame| [series[0][frame], series[1][frame], series[2][frame]]).collect(),
        speeds: (0..frames).map(|frame| [rates[0][frame], rates[1][frame], rates[2][frame]]).collect(),
        low,
        still,
    }
}

/// Where the pelvis looks: square to the line of the hip joints.
fn facing(capture: &Capture) -> Vec<DVec2> {
    let joint = |role| capture.body.joint(role).unwrap_or(0);
    let (left, right) = (joint(Role::LeftUpperLeg), joint(Role::RightUpperLeg));
    let mut last = DVec2::Y;
    (0..capture.frames())
        .map(|frame| {
            let places = capture.at(frame);
            let across = places[left] - places[right];
            // X is left where Z is ahead: ahead = left x up.
            last = DVec2::new(-across.z, across.x).try_normalize().unwrap_or(last);
            last
        })
        .collect()
}

/// Files of captured motion often begin with a T-pose: frames from which the body jumps within the first few. They are held at the first
/// frame of the motion; how many there are.
pub fn without_pose(capture: &Capture) -> (Option<Capture>, usize) {
    const LOOKED_AT: usize = 5;
    let frames = capture.frames();
    let joints = capture.body.joints.len();
    let leap = |frame: usize| {
        let pairs = capture.at(frame).iter().zip(capture.at(frame + 1));
        pairs.map(|(from, to)| from.distance(*to)).fold(0.0, f64::max)
    };
    if frames < 3 * LOOKED_AT {
        return (None, 0);
    }
    let usual = (LOOKED_AT..3 * LOOKED_AT - 1).map(leap).fold(0.0, f64::max);
    let far = 0.15 * capture.body.leg_length;
    let Some(last) = (0..LOOKED_AT).rev().find(|frame| leap(*frame) > far.max(4.0 * usual)) else { return (None, 0) };
    let mut held = capture.clone();
    for frame in 0..=last {
        held.positions.copy_within((last + 1) * joints..(last + 2) * joints, frame * joints);
        held.turns.copy_within((last + 1) * joints..(last + 2) * joints, frame * joints);
    }
    (Some(held), last + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::fixture::{Gait, posed, walk};
    use crate::measure::fixture;

    #[test]
    fn a_walk_goes_where_it_looks_at_its_speed() {
        let capture = walk(Gait::default());
        let track = Track::new(&capture);
        let mean: DVec3 = track.velocity.iter().copied().sum::<DVec3>() / track.len() as f64;
        assert!((mean.z - 1.0).abs() < 0.05 && mean.x.abs() < 0.05, "{mean}");
        assert!(track.facing.iter().all(|facing| facing.dot(DVec2::Y) > 0.999));
        // The pendulum's own acceleration, ω² times the distance, survives the filter.
        let least = track.acceleration.iter().map(|a| a.z).fold(f64::MAX, f64::min);
        assert!((-4.0..-1.5).contains(&least), "{least}");
    }

    #[test]
    fn a_foot_that_stands_has_a_still_point_at_the_ground_and_one_that_swings_has_none() {
        let gait = Gait { floor: 0.3, ..Gait::default() };
        let capture = walk(gait);
        let track = Track::new(&capture);
        let middle = |step: f64| ((step + 0.5) * gait.step_secs * gait.fps) as usize;
        for step in 2..8 {
            let (side, place) = gait.foothold(step + 1);
            let (stance, swing) = (&track.feet[side as usize], &track.feet[side.other() as usize]);
            let frame = middle(step as f64);
            assert!(stance.still[frame] < 0.02 && (stance.low[frame] - 0.3).abs() < 0.003);
            assert!(stance.place(frame).distance(DVec2::new(place.x, place.z)) < 0.005);
            assert!(swing.still[frame] > 1.0 && swing.low[frame] > 0.35);
        }
    }

    #[test]
    fn a_t_pose_before_the_motion_is_held_at_the_motions_first_frame() {
        let capture = walk(Gait::default());
        assert_eq!(without_pose(&capture).1, 0, "a motion that begins at once has none");
        let joints = capture.body.joints.len();
        let mut posed = capture.clone();
        for frame in 0..2 {
            for joint in 0..joints {
                posed.positions[frame * joints + joint] = capture.body.joints[joint].rest + DVec3::X * 0.7;
            }
        }
        let (held, count) = without_pose(&posed);
        assert_eq!(count, 2);
        let held = held.expect("it is held");
        assert_eq!(held.at(0), capture.at(2));
        assert_eq!(held.at(1), capture.at(2));
        assert_eq!(held.at(2), capture.at(2));
    }

    #[test]
    fn a_fast_start_is_no_pose() {
        // Thrown from the first frame on: every frame leaps as far.
        let body = fixture::body();
        let fast = posed(&body, 30.0, 40, |time| {
            let way = DVec3::new(0.0, 0.0, 9.0 * time);
            (DVec3::new(0.0, 0.9, 0.0) + way, [way + DVec3::X * 0.1, way - DVec3::X * 0.1])
        });
        assert_eq!(without_pose(&fast).1, 0);
    }
}

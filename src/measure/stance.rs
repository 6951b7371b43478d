//! The last stance: how far the feet are from standing side by side, or as they stood at first. Metres, radians.
//!
//! Measured on the ground plane, in the pelvis' heading: where the left ankle is from the right one, and where each foot
//! points. One length over both: the farthest that an ankle, or the tip of a foot that is turned on its ankle, is from
//! where it would be. So crossed, straddled, one before the other and pigeon-toed all count, and none hides another.

use super::Track;
use crate::maths::quat::{wrap_angle, yaw_of};
use crate::maths::real;
use crate::model::{Body, Physique, Role, Side};
use glam::{DQuat, DVec2};

/// s at the end that are looked at: who walks then is in no stance.
const LAST: f64 = 1.0;
/// m/s at the reference leg, the mean over that time; people's slowest walks have twice as much.
const WALKS: f64 = 0.2;
/// s and m/s, the same of who is asked to walk there: tread by tread down a flight he stands for a second before each step.
const ASKED: [f64; 2] = [4.0, 0.05];
/// rad, who turns by more in that time turns on the spot: its feet are on their way.
const TURNS: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// The last stance of who stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndStance {
    /// m, from the natural stand or the first stance, whichever is nearer.
    pub off: f64,
    /// m, the left ankle from the right one: to the left, and ahead.
    pub apart: DVec2,
}

/// Where the feet are in the pelvis' heading.
#[derive(Clone, Copy, Debug)]
struct Stance {
    apart: DVec2,
    yaws: [f64; 2],
}

/// Looks at the last sample; `None` for who walks or turns there.
pub fn end_stance(track: &Track) -> Option<EndStance> {
    let motion = track.motion;
    let body = motion.body;
    let last = track.len().checked_sub(1)?;
    let [seconds, slowest] = if track.goes { ASKED } else { [LAST, WALKS] };
    let first = last.saturating_sub((seconds * motion.hz).round() as usize);
    let span = (motion.time(last) - motion.time(first)).max(1.0 / motion.hz);
    let way = (motion.poses[last].hips - motion.poses[first].hips).with_y(0.0).length();
    let turn = wrap_angle(yaw_of(motion.poses[last].turns[0]) - yaw_of(motion.poses[first].turns[0])).abs();
    // Speeds of like bodies go by the root of the leg (Froude).
    if way / span > slowest * (body.leg_length / Physique::REFERENCE.leg_length).max(0.0).sqrt() || turn > TURNS {
        return None;
    }
    let (ends, starts) = (Stance::at(track, last), Stance::at(track, 0));
    let off = ends.off(&Stance::natural(body), body).min(ends.off(&starts, body));
    Some(EndStance { off, apart: ends.apart })
}

impl Stance {
    fn at(track: &Track, sample: usize) -> Stance {
        let (body, pose) = (track.motion.body, &track.motion.poses[sample]);
        let heading = yaw_of(pose.turns[0]);
        let ankles = Side::BOTH.map(|side| track.positions(sample)[body.feet[side as usize].ankle]);
        let apart = DQuat::from_rotation_y(-heading) * (ankles[0] - ankles[1]);
        let yaws = Side::BOTH.map(|side| {
            let foot = &body.feet[side as usize];
            let points = DQuat::from_rotation_y(real::atan2(foot.forward.x, foot.forward.y));
            yaw_of(pose.turns[foot.ankle] * foot.level.inverse() * points) - heading
        });
        Stance { apart: DVec2::new(apart.x, apart.z), yaws }
    }

    /// Feet side by side.
    fn natural(body: &Body) -> Stance {
        let rest = |role: Role| body.joint(role).map(|joint| body.joints[joint].rest);
        let hips = rest(Role::LeftUpperLeg).zip(rest(Role::RightUpperLeg));
        let half_width = 0.5 * (body.feet[0].half_width + body.feet[1].half_width);
        let hip_width = hips.map_or(0.0, |(left, right)| left.distance(right));
        let width = Physique::natural_width(body.leg_length, hip_width, half_width);
        let out = Physique::REFERENCE.toe_out;
        Stance { apart: DVec2::new(width, 0.0), yaws: Side::BOTH.map(|side| side.sign() * out) }
    }

    /// m, the farthest that an ankle or a foot's tip is from where another stance has it.
    fn off(&self, other: &Stance, body: &Body) -> f64 {
        let tips = Side::BOTH.map(|side| {
            let turned = wrap_angle(self.yaws[side as usize] - other.yaws[side as usize]);
            2.0 * body.feet[side as usize].tip.abs() * real::sin(0.5 * turned).abs()
        });
        self.apart.distance(other.apart).max(tips[0]).max(tips[1])
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;
    use crate::model::BodyPose;
    use glam::DVec3;

    /// A clip that begins in the fixture's stand and ends as `end` makes it.
    fn ended(end: impl Fn(&mut BodyPose, &Body)) -> Option<EndStance> {
        let body = fixture::body();
        let poses = fixture::poses(&body, 481, |pose, sample| {
            if sample >= 240.0 {
                end(pose, &body);
            }
        });
        end_stance(&Track::new(fixture::motion(&body, &poses)).expect("sound"))
    }

    /// Turns the whole left leg about the hip.
    fn leg(pose: &mut BodyPose, body: &Body, turn: DQuat) {
        let hip = body.joint(Role::LeftUpperLeg).expect("a leg");
        (hip..hip + 4).for_each(|joint| pose.turns[joint] = turn);
    }

    #[test]
    fn side_by_side_is_no_distance_and_crossed_straddled_and_pigeon_toed_are() {
        let still = ended(|_, _| {}).expect("it stands");
        assert!(still.off < 1e-9 && (still.apart.x - 0.20).abs() < 1e-9, "{still:?}");
        let by = |turn: DQuat| ended(|pose, body| leg(pose, body, turn)).expect("it stands");
        let reach = 0.82 * real::sin(0.4);
        let crossed = by(DQuat::from_rotation_z(-0.4));
        assert!((crossed.off - reach).abs() < 0.03 && crossed.apart.x < 0.0, "{crossed:?}");
        let straddled = by(DQuat::from_rotation_z(0.4));
        assert!((straddled.off - reach).abs() < 0.03 && straddled.apart.x > 0.4, "{straddled:?}");
        let ahead = by(DQuat::from_rotation_x(-0.4));
        assert!((ahead.off - reach).abs() < 0.03 && ahead.apart.y > 0.3, "{ahead:?}");
        // The foot alone: 0.19 m from ankle to tip.
        let turned = ended(|pose, body| pose.turns[body.feet[0].ankle] = DQuat::from_rotation_y(-0.8)).expect("stands");
        assert!((turned.off - 2.0 * 0.19 * real::sin(0.4)).abs() < 0.005, "{turned:?}");
    }

    #[test]
    fn the_first_stance_is_as_good_as_the_natural_one() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 481, |pose, _| leg(pose, &body, DQuat::from_rotation_x(-0.4)));
        let found = end_stance(&Track::new(fixture::motion(&body, &poses)).expect("sound")).expect("it stands");
        assert!(found.off < 1e-9, "{found:?}");
    }

    #[test]
    fn who_is_asked_to_walk_and_gets_on_slowly_is_in_no_stance_and_who_is_stuck_is() {
        let body = fixture::body();
        let goes_by = |far: f64, asked: bool| {
            let poses = fixture::poses(&body, 601, |pose, sample| {
                leg(pose, &body, DQuat::from_rotation_x(-0.4 * (sample / 120.0).min(1.0)));
                pose.hips.z += far * (sample / 120.0 - 2.0).clamp(0.0, 1.0);
            });
            end_stance(&Track::new(fixture::motion(&body, &poses)).expect("sound").going(asked)).is_none()
        };
        assert_eq!(
            [(0.3, true), (0.3, false), (0.0, true)].map(|(far, asked)| goes_by(far, asked)),
            [true, false, false]
        );
    }

    #[test]
    fn a_body_that_faces_elsewhere_stands_all_the_same_and_one_that_walks_or_turns_does_not() {
        let body = fixture::body();
        let stance = |change: &dyn Fn(&mut BodyPose, f64)| {
            let poses = fixture::poses(&body, 361, |pose, sample| change(pose, sample / 120.0));
            end_stance(&Track::new(fixture::motion(&body, &poses)).expect("sound"))
        };
        let faces = |pose: &mut BodyPose, angle: f64| {
            let turn = DQuat::from_rotation_y(angle);
            pose.turns.iter_mut().for_each(|joint| *joint = turn * *joint);
            pose.hips = turn * pose.hips;
        };
        let turned = stance(&|pose, time| faces(pose, 2.0 * time.min(1.5)));
        assert!(turned.expect("it stands").off < 1e-9, "{turned:?}");
        assert_eq!(stance(&|pose, time| faces(pose, 0.5 * time)), None);
        assert_eq!(stance(&|pose, time| pose.hips += DVec3::Z * 0.3 * time), None);
        assert!(stance(&|pose, time| pose.hips += DVec3::Z * 0.1 * time).is_some());
    }
}

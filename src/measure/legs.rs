//! How near the two legs come: the least distance between the axes of thigh and shank of one and of the other. Metres.
//!
//! Over the whole motion, whether a foot is in the air or both stand: who crosses the legs and stays so is seen as long.
//! Feet are left out; they may be put close together ([`super::feet`] looks at them while one swings).

use super::Track;
use super::feet::segment_distance;
use crate::model::{Body, Role, Side};
use glam::DVec3;

/// m at the reference leg of 0.83 m: a body whose hips are nearer to each other has its legs as much nearer, and thinner. Rigs that are
/// built as people are have 0.16 to 0.2.
const HIPS: f64 = 0.15;
/// Share of what the legs' length says that [`size`] says at least.
const NARROWEST: f64 = 0.2;

/// The least distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Legs {
    /// m.
    pub least: f64,
    /// s, when that is.
    pub time: f64,
    /// [`size`] of the body.
    pub size: f64,
}

impl Legs {
    /// m at the reference leg.
    pub fn apart(&self) -> f64 {
        self.least / self.size
    }
}

/// Times a person's of 0.83 m of leg, how far apart the body's legs are in a stand and a walk: as long as they are, or as far apart as its
/// hips are where that is less.
pub fn size(body: &Body) -> f64 {
    let [left, right] = Side::BOTH.map(|side| body.joints[chain(body, side)[0]].rest);
    let long = body.leg_length / 0.83;
    long.min((left.distance(right) / HIPS).max(NARROWEST * long))
}

/// Looks at every sample.
pub fn legs(track: &Track) -> Legs {
    let chains = Side::BOTH.map(|side| chain(track.motion.body, side));
    let mut found = Legs { least: f64::INFINITY, time: 0.0, size: size(track.motion.body) };
    for sample in 0..track.len() {
        let positions = track.positions(sample);
        let [left, right] = chains.each_ref().map(|chain| chain.map(|joint| positions[joint]));
        let least = distance(&left, &right);
        if least < found.least {
            found = Legs { least, time: track.motion.time(sample), ..found };
        }
    }
    found
}

/// Hip, knee and ankle; for one that lacks, the next one down.
fn chain(body: &Body, side: Side) -> [usize; 3] {
    let own = |role: Role| body.joint(if side == Side::Left { role } else { role.mirrored() });
    let ankle = body.feet[side as usize].ankle;
    let knee = own(Role::LeftLowerLeg).unwrap_or(ankle);
    [own(Role::LeftUpperLeg).unwrap_or(knee), knee, ankle]
}

/// m, between the axes of two legs, each as the places of hip, knee and ankle.
pub fn distance(one: &[DVec3; 3], other: &[DVec3; 3]) -> f64 {
    let pairs = one.windows(2).flat_map(|a| other.windows(2).map(move |b| ([a[0], a[1]], [b[0], b[1]])));
    pairs.map(|(a, b)| segment_distance(a, b)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;
    use crate::maths::real;
    use glam::DQuat;

    #[test]
    fn a_stand_has_its_hips_width_and_legs_that_cross_on_the_ground_are_found() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 5, |_, _| {});
        let found = legs(&Track::new(fixture::motion(&body, &poses)).expect("sound"));
        assert!((found.least - 0.20).abs() < 1e-9, "{found:?}");
        // The left leg turns inwards and forwards within half a second, and stays so.
        let hip = body.joint(Role::LeftUpperLeg).expect("a leg");
        let turned = |inwards: f64, forwards: f64| {
            let poses = fixture::poses(&body, 121, |pose, sample| {
                let share = (sample / 60.0).min(1.0);
                let turn = DQuat::from_rotation_z(-inwards * share) * DQuat::from_rotation_x(-forwards * share);
                (hip..hip + 4).for_each(|joint| pose.turns[joint] = turn);
            });
            legs(&Track::new(fixture::motion(&body, &poses)).expect("sound"))
        };
        let near = turned(0.12, 0.0);
        assert!((near.least - (0.20 - 0.82 * real::sin(0.12))).abs() < 1e-9 && near.time == 0.5, "{near:?}");
        // Crossed: the distance of two lines, 0.20 m apart at the hips.
        let along = DQuat::from_rotation_z(-0.45) * DQuat::from_rotation_x(-0.15) * -DVec3::Y;
        let across = turned(0.45, 0.15);
        let expected = 0.20 * along.cross(DVec3::Y).normalize().x.abs();
        assert!(
            across.least < expected + 1e-9 && across.least > 0.9 * expected && expected < 0.07,
            "{across:?}, {expected}"
        );
    }

    #[test]
    fn who_stands_on_narrow_hips_has_his_legs_far_enough_apart() {
        let standing = |apart: f64| {
            let mut body = fixture::body();
            let legs = [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot, Role::LeftToes];
            for joint in &mut body.joints {
                let (left, right) = (legs.contains(&joint.role), legs.map(Role::mirrored).contains(&joint.role));
                joint.rest.x += (f64::from(u8::from(left)) - f64::from(u8::from(right))) * 0.5 * (apart - 0.20);
            }
            let poses = fixture::poses(&body, 5, |_, _| {});
            legs_of(&body, &poses)
        };
        let long = fixture::body().leg_length / 0.83;
        for apart in [0.1, 0.06] {
            let found = standing(apart);
            assert!((found.least - apart).abs() < 1e-9 && (found.apart() - HIPS).abs() < 1e-9, "{found:?}");
        }
        assert_eq!(standing(0.16).size, long, "people's legs are measured by their length");
        let none = standing(0.0);
        assert!(none.apart().abs() < 1e-9 && none.size > 0.0, "{none:?}");
    }

    fn legs_of(body: &Body, poses: &[crate::model::BodyPose]) -> Legs {
        legs(&Track::new(fixture::motion(body, poses)).expect("sound"))
    }

    #[test]
    fn the_thighs_count_too() {
        let body = fixture::body();
        let knee = |side: Side| chain(&body, side)[1];
        let poses = fixture::poses(&body, 1, |pose, _| {
            // Knees together, shanks apart.
            for (side, sign) in [(Side::Left, -1.0), (Side::Right, 1.0)] {
                let thigh = knee(side) - 1;
                pose.turns[thigh] = DQuat::from_rotation_z(sign * 0.20);
                (knee(side)..knee(side) + 3).for_each(|joint| pose.turns[joint] = DQuat::from_rotation_z(-sign * 0.3));
            }
        });
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let apart = track.positions(0)[knee(Side::Left)].distance(track.positions(0)[knee(Side::Right)]);
        assert!((legs(&track).least - apart).abs() < 1e-9 && apart < 0.05, "{apart}");
    }
}

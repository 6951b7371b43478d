//! What moves the body: centre of mass, angular momentum and the wrench that the ground must supply, sample by sample.
//!
//! Scenario space, SI. Segments are rigid (de Leva 1996), velocities are central differences of the poses. Filtered
//! (7 Hz, zero lag) are the path of the centre of mass and the angular momentum, each *before* it is differentiated,
//! and the known pushes' force and moment: the filter is linear, so the equations of motion hold between filtered
//! quantities, and a push that starts within one sample is subtracted as the motion shows it. What is carried counts:
//! centre of mass, force and moment are those of body and load together (the body's, where nothing is carried).

use super::{GRAVITY, KnownPush, PushPoint, Track};
use crate::maths::filter;
use crate::model::BodyPose;
use glam::{DMat3, DQuat, DVec3};

/// Hz; keyed motion at 30 fps has no truth above it (DESIGN, "Measures").
pub const CUTOFF_HZ: f64 = 7.0;

/// A force and a moment about the centre of mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// N.
    pub force: DVec3,
    /// N m.
    pub moment: DVec3,
}

/// One value a sample of each.
#[derive(Clone, Debug)]
pub struct Dynamics {
    /// m, centre of mass, filtered.
    pub com: Vec<DVec3>,
    /// m/s, of the filtered path.
    pub velocity: Vec<DVec3>,
    /// m/s², of the filtered path.
    pub acceleration: Vec<DVec3>,
    /// kg m²/s, angular momentum about the centre of mass, filtered.
    pub momentum: Vec<DVec3>,
    /// N m, its rate.
    pub momentum_rate: Vec<DVec3>,
    /// The known pushes, moment about the centre of mass, filtered.
    pub push: Vec<Wrench>,
    /// What is left for contacts to supply: m (a - g) - push, and the rate of momentum less the push's moment.
    pub needed: Vec<Wrench>,
}

/// Differentiates a track.
pub fn dynamics(track: &Track, pushes: &[KnownPush]) -> Dynamics {
    let motion = track.motion;
    let hz = motion.hz;
    let raw: Vec<DVec3> = (0..track.len())
        .map(|sample| motion.poses[sample].centre_of_mass(motion.body, track.positions(sample)))
        .collect();
    let com = filter::zero_lag(&raw, CUTOFF_HZ, hz);
    let velocity = filter::derivative(&com, hz);
    let acceleration = filter::second_derivative(&com, hz);
    let momentum = filter::zero_lag(&angular_momentum(track), CUTOFF_HZ, hz);
    let momentum_rate = filter::derivative(&momentum, hz);
    let mut found =
        Dynamics { com, velocity, acceleration, momentum, momentum_rate, push: Vec::new(), needed: Vec::new() };
    let mut inertial: Vec<Wrench> = (0..track.len())
        .map(|i| Wrench {
            force: (found.acceleration[i] + DVec3::Y * GRAVITY) * motion.body.mass,
            moment: found.momentum_rate[i],
        })
        .collect();
    let mut whole = raw;
    if !track.loads.is_empty() {
        whole = carry(track, &whole, &mut found, &mut inertial);
    }
    found.push = pushed(track, &whole, pushes);
    found.needed = inertial
        .iter()
        .zip(&found.push)
        .map(|(wrench, push)| Wrench { force: wrench.force - push.force, moment: wrench.moment - push.moment })
        .collect();
    found
}

/// Adds what is carried: the body's own quantities become those of the whole, moments about the common centre of mass,
/// whose path is returned. Each part is differentiated for itself, so a load that grows does not count as motion.
fn carry(track: &Track, body: &[DVec3], found: &mut Dynamics, inertial: &mut [Wrench]) -> Vec<DVec3> {
    let motion = track.motion;
    let hz = motion.hz;
    let count = track.len();
    let mut whole: Vec<DVec3> = body.iter().map(|com| *com * motion.body.mass).collect();
    let mut filtered: Vec<DVec3> = found.com.iter().map(|com| *com * motion.body.mass).collect();
    let mut parts = Vec::new();
    for load in track.loads {
        let path: Vec<DVec3> =
            (0..count).map(|i| load.centre_in(&motion.poses[i], track.positions(i), motion.time(i))).collect();
        let centre = filter::zero_lag(&path, CUTOFF_HZ, hz);
        let spin: Vec<DVec3> = (0..count)
            .map(|i| {
                let (before, after) = (i.saturating_sub(1), (i + 1).min(count - 1));
                let rate = hz / (after - before).max(1) as f64;
                let spin = angular_velocity(&motion.poses[before], &motion.poses[after], load.joint, rate);
                load.inertia(1.0, motion.poses[i].turns[load.joint], motion.time(i)) * spin
            })
            .collect();
        let spin_rate = filter::derivative(&filter::zero_lag(&spin, CUTOFF_HZ, hz), hz);
        for i in 0..count {
            let mass = load.mass_at(motion.time(i));
            whole[i] += path[i] * mass;
            filtered[i] += centre[i] * mass;
        }
        parts.push((
            load,
            centre.clone(),
            filter::derivative(&centre, hz),
            filter::second_derivative(&centre, hz),
            spin_rate,
        ));
    }
    for i in 0..count {
        let mass = track.mass(i);
        whole[i] /= mass;
        let com = filtered[i] / mass;
        let gravity = DVec3::Y * GRAVITY;
        let share = motion.body.mass / mass;
        let mut velocity = found.velocity[i] * share;
        let mut acceleration = found.acceleration[i] * share;
        inertial[i].moment += (found.com[i] - com).cross(found.acceleration[i] + gravity) * motion.body.mass;
        for (load, centre, rate, second, spin_rate) in &parts {
            let part = load.mass_at(motion.time(i));
            inertial[i].force += (second[i] + gravity) * part;
            inertial[i].moment += (centre[i] - com).cross(second[i] + gravity) * part + spin_rate[i] * part;
            velocity += rate[i] * (part / mass);
            acceleration += second[i] * (part / mass);
        }
        (found.com[i], found.velocity[i], found.acceleration[i]) = (com, velocity, acceleration);
    }
    whole
}

/// Whole-body angular momentum about the centre of mass, unfiltered, kg m²/s.
pub fn angular_momentum(track: &Track) -> Vec<DVec3> {
    let body = track.motion.body;
    let poses = track.motion.poses;
    let last = track.len() - 1;
    let centres = |sample: usize| {
        let positions = track.positions(sample);
        body.segments.iter().map(move |s| positions[s.joint] + poses[sample].turns[s.joint] * s.centre)
    };
    let mut velocities: Vec<DVec3> = Vec::with_capacity(body.segments.len());
    (0..track.len())
        .map(|sample| {
            let (before, after) = (sample.saturating_sub(1), (sample + 1).min(last));
            if before == after {
                return DVec3::ZERO;
            }
            let rate = track.motion.hz / (after - before) as f64;
            velocities.clear();
            velocities.extend(centres(before).zip(centres(after)).map(|(from, to)| (to - from) * rate));
            let com = poses[sample].centre_of_mass(body, track.positions(sample));
            let com_velocity: DVec3 =
                body.segments.iter().zip(&velocities).map(|(s, v)| *v * s.mass).sum::<DVec3>() / body.mass;
            let mut momentum = DVec3::ZERO;
            for ((segment, centre), velocity) in body.segments.iter().zip(centres(sample)).zip(&velocities) {
                momentum += (centre - com).cross(*velocity - com_velocity) * segment.mass;
                let turn = DMat3::from_quat(poses[sample].turns[segment.joint]);
                let spin = angular_velocity(&poses[before], &poses[after], segment.joint, rate);
                momentum += turn * (segment.inertia * (turn.transpose() * spin));
            }
            momentum
        })
        .collect()
}

/// rad/s, scenario axes, of what is rigid with a joint, between two poses 1/rate apart.
fn angular_velocity(before: &BodyPose, after: &BodyPose, joint: usize, rate: f64) -> DVec3 {
    shortest(after.turns[joint] * before.turns[joint].inverse()).to_scaled_axis() * rate
}

/// The same rotation by the shorter way.
pub(crate) fn shortest(turn: DQuat) -> DQuat {
    if turn.w < 0.0 { -turn } else { turn }
}

/// Force and moment of the pushes at every sample, filtered. A push counts by the share of the sample's cell that it
/// covers, so its impulse is whole.
fn pushed(track: &Track, com: &[DVec3], pushes: &[KnownPush]) -> Vec<Wrench> {
    let hz = track.motion.hz;
    let count = track.len();
    let mut force = vec![DVec3::ZERO; count];
    let mut moment = vec![DVec3::ZERO; count];
    for push in pushes {
        for (sample, com) in com.iter().enumerate() {
            let time = track.motion.time(sample);
            let covered = (push.end.min(time + 0.5 / hz) - push.start.max(time - 0.5 / hz)) * hz;
            if covered > 0.0 {
                let share = push.force * covered.min(1.0);
                force[sample] += share;
                moment[sample] += (acting_at(track, sample, *com, push.at) - *com).cross(share);
            }
        }
    }
    if pushes.is_empty() {
        return vec![Wrench::default(); count];
    }
    let force = filter::zero_lag(&force, CUTOFF_HZ, hz);
    let moment = filter::zero_lag(&moment, CUTOFF_HZ, hz);
    force.into_iter().zip(moment).map(|(force, moment)| Wrench { force, moment }).collect()
}

/// m, the point of attack.
fn acting_at(track: &Track, sample: usize, com: DVec3, at: PushPoint) -> DVec3 {
    let joints = track.motion.body.joints.len();
    match at {
        PushPoint::Joint(joint) if joint < joints => track.positions(sample)[joint],
        PushPoint::Segment(joint, offset) if joint < joints => track.rigid_point(sample, joint, offset),
        PushPoint::World(point) => point,
        PushPoint::Centre | PushPoint::Joint(_) | PushPoint::Segment(..) => com,
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;
    use crate::model::Role;

    #[test]
    fn a_spinning_arm_has_the_known_angular_momentum() {
        // The whole body but one arm stands; the arm, straight up, turns about the shoulder's X axis at 2 rad/s.
        let body = fixture::body();
        let spin = 2.0;
        let hz = 120.0;
        let poses = fixture::poses(&body, 120, |pose, sample| {
            for role in [Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand] {
                pose.turns[body.joint(role).expect("an arm")] =
                    DQuat::from_rotation_x(std::f64::consts::PI + spin * sample / hz);
            }
        });
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let momentum = angular_momentum(&track);
        // By hand: point masses and inertias of the arm about its own centre, and the arm's centre of mass against the
        // rest of the body: L = I_own ω + m M'/(m + M') r x v about the common centre, M' the rest at rest.
        let shoulder = body.joints[body.joint(Role::LeftUpperArm).expect("an arm")].rest;
        let arm: Vec<(f64, DVec3, DMat3)> = body
            .segments
            .iter()
            .filter(|s| [Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand].contains(&body.joints[s.joint].role))
            .map(|s| (s.mass, body.joints[s.joint].rest + s.centre, s.inertia))
            .collect();
        let mass: f64 = arm.iter().map(|(m, ..)| m).sum();
        let rest: DVec3 = arm.iter().map(|(m, c, _)| *c * *m).sum::<DVec3>() / mass;
        let centre = shoulder - (rest - shoulder) * DVec3::new(-1.0, 1.0, 1.0);
        let own: f64 =
            arm.iter().map(|(m, c, i)| i.x_axis.x + m * (DVec3 { x: 0.0, ..*c - rest }).length_squared()).sum();
        let rest_mass = body.mass - mass;
        let rest_centre = (fixture::com(&body) * body.mass - rest * mass) / rest_mass;
        let velocity = DVec3::X.cross(centre - shoulder) * spin;
        let orbit = mass * rest_mass / body.mass * (centre - rest_centre).cross(velocity).x;
        let expected = own * spin + orbit;
        assert!(expected.abs() > 1.0, "the case must weigh something: {expected}");
        // The first sample's differences are one-sided: look at the next, one step into the turn.
        let got = momentum[1].x;
        assert!((got - expected).abs() < 0.02 * expected.abs(), "got {got}, by hand {expected}");
    }

    #[test]
    fn a_push_through_the_centre_explains_the_acceleration_it_gives() {
        // 80 kg pushed by 200 N for 0.2 s from rest, sliding freely on: needed horizontal force is nil throughout.
        let body = fixture::body();
        let push = KnownPush { start: 1.0, end: 1.2, force: DVec3::X * 200.0, at: PushPoint::Centre };
        let poses = fixture::poses(&body, 360, |pose, sample| {
            let t = sample / 120.0;
            let during = (t - 1.0).clamp(0.0, 0.2);
            let a = 200.0 / body.mass;
            pose.hips.x += 0.5 * a * during * during + a * during * (t - 1.2).max(0.0);
        });
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let with = dynamics(&track, &[push]);
        let without = dynamics(&track, &[]);
        let worst = |d: &Dynamics| d.needed.iter().map(|w| w.force.x.abs()).fold(0.0, f64::max);
        assert!(worst(&with) < 4.0, "{}", worst(&with));
        assert!(worst(&without) > 150.0, "{}", worst(&without));
        assert!(with.needed.iter().all(|w| (w.force.y - body.mass * GRAVITY).abs() < 1e-6));
    }
}

//! All measures of a motion at once, the score over them, and what a person should be told.
//!
//! Scenario space, SI but where a name says cm or mm. The measures themselves are in the files beside this one; the
//! score's formula is in [`super::score`].

use super::dynamics::{Dynamics, Wrench, dynamics};
use super::feet::{FeetFindings, feet};
use super::joints::{JointFindings, joints};
use super::outcome::{Balance, balance, speed_ratio};
use super::residual::{Units, residual};
use super::score::{ANKLE_SPEED, score};
use super::support::{Support, support};
use super::zmp::{self, ZmpFindings};
use super::{HeldContact, KnownPush, MOVING_SPEED, Motion, Track, percentile};
use crate::model::{Load, Terrain, report::Plausibility};

/// Everything that was found.
#[derive(Clone, Debug)]
pub struct Findings {
    /// Contacts, soles, ankles, legs.
    pub feet: FeetFindings,
    /// Limits, knees, pops.
    pub joints: JointFindings,
    /// Zero-moment point and flight.
    pub zmp: ZmpFindings,
    /// How it ends.
    pub balance: Balance,
    /// 99th percentile, over moving samples with contact (or all of them where that is more), of tangential over normal force
    /// needed of the ground.
    pub friction_p99: f64,
    /// Least force needed along the ground's normal, over samples with contact, in body weights.
    pub vertical_min: f64,
    /// RMS over all samples of the missing force, body weights.
    pub residual_force: f64,
    /// RMS over all samples of the missing moment, body weights x height.
    pub residual_moment: f64,
    /// N, N m: the largest missing force and moment, and when (s).
    pub residual_peak: ((f64, f64), (f64, f64)),
    /// Peak change of speed along the push over impulse / mass; `None` without a push.
    pub speed_ratio: Option<f64>,
    /// The body's leg over the reference 0.83 m: lengths that are asked for scale with it.
    pub leg_scale: f64,
    /// The friction that the residual was measured with.
    pub friction: f64,
    /// Centre of mass, momentum and needed wrench, sample by sample.
    pub dynamics: Dynamics,
    /// m out of the support, sample by sample; `None` in flight.
    pub zmp_distances: Vec<Option<f64>>,
}

/// Measures a motion over a ground of which only the contacts' planes are known; `None` for one that cannot be
/// ([`Motion::is_sound`]).
pub fn measure(motion: Motion, contacts: &[HeldContact], pushes: &[KnownPush], friction: f64) -> Option<Findings> {
    Some(measure_track(&Track::new(motion)?, contacts, pushes, friction))
}

/// The same over a ground that is known, with its friction.
pub fn measure_on(
    motion: Motion,
    terrain: &Terrain,
    contacts: &[HeldContact],
    pushes: &[KnownPush],
) -> Option<Findings> {
    Some(measure_track(&Track::over(motion, terrain)?, contacts, pushes, terrain.friction))
}

/// The same of a body that carries something.
pub fn measure_carrying(
    motion: Motion,
    terrain: &Terrain,
    loads: &[Load],
    contacts: &[HeldContact],
    pushes: &[KnownPush],
) -> Option<Findings> {
    Some(measure_track(&Track::over(motion, terrain)?.carrying(loads), contacts, pushes, terrain.friction))
}

fn measure_track(track: &Track, contacts: &[HeldContact], pushes: &[KnownPush], friction: f64) -> Findings {
    let motion = track.motion;
    let units = Units::of(motion.body);
    let dynamics = dynamics(track, pushes);
    let supports: Vec<Option<Support>> = (0..track.len()).map(|sample| support(track, contacts, sample)).collect();
    let residuals: Vec<Wrench> = supports
        .iter()
        .enumerate()
        .map(|(i, support)| residual(support.as_ref(), dynamics.needed[i], dynamics.com[i], friction, units))
        .collect();
    let distances = zmp::distances(&motion, &dynamics, &supports, &residuals);
    let (friction_p99, vertical_min) = ground_forces(&dynamics, &supports, units);
    let rms =
        |square: &dyn Fn(&Wrench) -> f64| (residuals.iter().map(square).sum::<f64>() / residuals.len() as f64).sqrt();
    let peak = |size: &dyn Fn(&Wrench) -> f64| {
        let sizes = residuals.iter().enumerate().map(|(sample, wrench)| (size(wrench), motion.time(sample)));
        sizes.fold((0.0, 0.0), |peak, next| if next.0 > peak.0 { next } else { peak })
    };
    Findings {
        feet: feet(track, contacts),
        joints: joints(track),
        zmp: zmp::findings(&motion, &dynamics, &distances),
        balance: balance(track, &dynamics, &supports, contacts, pushes, None),
        friction_p99,
        vertical_min,
        residual_force: rms(&|wrench| wrench.force.length_squared()) / units.weight,
        residual_moment: rms(&|wrench| wrench.moment.length_squared()) / (units.weight * units.height),
        residual_peak: (peak(&|wrench| wrench.force.length()), peak(&|wrench| wrench.moment.length())),
        speed_ratio: speed_ratio(track, &dynamics, pushes),
        leg_scale: motion.body.leg_length / 0.83,
        friction,
        dynamics,
        zmp_distances: distances,
    }
}

/// What a baked clip says about itself; a motion that cannot be measured scores 0 and says so.
pub fn plausibility(motion: Motion, contacts: &[HeldContact], pushes: &[KnownPush], friction: f64) -> Plausibility {
    match measure(motion, contacts, pushes, friction) {
        Some(findings) => findings.plausibility(),
        None => Plausibility { notes: vec!["the motion could not be measured".into()], ..Plausibility::default() },
    }
}

impl Findings {
    /// The report's share of the findings.
    pub fn plausibility(&self) -> Plausibility {
        let mut report = Plausibility {
            score: 0.0,
            zmp_inside: self.zmp.inside,
            zmp_outside_p95_cm: self.zmp.outside_p95_cm,
            friction_p99: self.friction_p99,
            vertical_min: self.vertical_min,
            residual_force: self.residual_force,
            residual_moment: self.residual_moment,
            slip_max_mm: self.feet.slip_max_mm,
            penetration_max_mm: self.feet.penetration_max_mm,
            peak_ankle_speed: self.feet.peak_ankle_speed,
            speed_ratio: self.speed_ratio.unwrap_or(0.0),
            notes: self.notes(),
        };
        report.score = score(&report, self.friction);
        report
    }

    /// What a person should look at, most telling first.
    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(time) = self.balance.fallen {
            notes.push(format!("the body has fallen at {time:.2} s"));
        }
        if self.zmp.inside < 0.95 {
            notes.push(format!(
                "the zero-moment point is out of the feet in {:.0} % of the moving frames, {:.1} cm at {:.2} s",
                100.0 * (1.0 - self.zmp.inside),
                self.zmp.outside_max_cm,
                self.zmp.worst_time
            ));
        }
        if self.residual_force > 0.05 {
            let (newtons, time) = self.residual_peak.0;
            notes.push(format!("up to {newtons:.0} N come from nowhere (at {time:.2} s)"));
        }
        if self.residual_moment > 0.02 {
            let (moment, time) = self.residual_peak.1;
            notes.push(format!("up to {moment:.0} Nm come from nowhere (at {time:.2} s)"));
        }
        if self.friction_p99 > self.friction {
            notes.push(format!(
                "the feet need a friction of {:.2}, the ground has {:.2}",
                self.friction_p99, self.friction
            ));
        }
        if self.vertical_min < 0.0 {
            notes.push(format!("the ground would have to pull with {:.2} body weights", -self.vertical_min));
        }
        if self.zmp.flight > 0 && self.zmp.flight_worst > 2.0 {
            notes.push(format!("in flight the body is {:.1} m/s² off a free fall", self.zmp.flight_worst));
        }
        if self.feet.slip_max_mm > 2.0 {
            notes.push(format!("a planted foot slips {:.1} mm", self.feet.slip_max_mm));
        }
        if self.feet.penetration_max_mm > 5.0 {
            notes.push(format!(
                "a sole is {:.1} mm under the ground at {:.2} s",
                self.feet.penetration_max_mm, self.feet.penetration_time
            ));
        }
        if self.feet.float_max_mm > 5.0 {
            notes.push(format!(
                "a sole that should touch is {:.1} mm over the ground at {:.2} s",
                self.feet.float_max_mm, self.feet.float_time
            ));
        }
        if self.feet.peak_ankle_speed > ANKLE_SPEED {
            notes.push(format!("an ankle moves at {:.1} m/s; people reach about 8", self.feet.peak_ankle_speed));
        }
        if let Some(ratio) = self.speed_ratio.filter(|ratio| !(0.6..=1.1).contains(ratio)) {
            notes.push(format!("the push gives {ratio:.2} of the speed that its impulse would"));
        }
        if self.feet.least_leg_distance < LEAST_LEG_DISTANCE * self.leg_scale {
            notes.push(format!(
                "the legs come within {:.0} mm of each other at {:.2} s",
                1000.0 * self.feet.least_leg_distance,
                self.feet.least_leg_time
            ));
        }
        if self.joints.knee_past_straight > super::joints::LIMIT_TOLERANCE {
            notes
                .push(format!("a knee bends {:.1} degrees past straight", self.joints.knee_past_straight.to_degrees()));
        }
        for excess in &self.joints.excesses {
            notes.push(format!(
                "{} {} is {:.0} degrees at {:.2} s, {:.0} past its limit",
                excess.angle.role.name(),
                excess.angle.axis,
                excess.angle.value.to_degrees(),
                excess.time,
                excess.by.to_degrees()
            ));
        }
        for pop in &self.joints.pops {
            notes.push(format!(
                "{} pops by {:.0} degrees at {:.2} s",
                pop.role.name(),
                pop.step.to_degrees(),
                pop.time
            ));
        }
        notes
    }
}

/// m at the reference leg, between the legs' axes in a swing; nearer, the legs of most characters touch.
const LEAST_LEG_DISTANCE: f64 = 0.08;

/// (99th percentile of the friction needed, least normal force in body weights).
fn ground_forces(dynamics: &Dynamics, supports: &[Option<Support>], units: Units) -> (f64, f64) {
    // A stand on a slope needs friction too: over all samples where that is more.
    let (mut friction, mut all): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut least = f64::INFINITY;
    for (sample, support) in supports.iter().enumerate() {
        let Some(support) = support else { continue };
        let force = dynamics.needed[sample].force;
        let normal = force.dot(support.normal);
        least = least.min(normal / units.weight);
        let tangent = (force - support.normal * normal).length();
        all.push(tangent / normal.max(0.05 * units.weight));
        if dynamics.velocity[sample].length() > MOVING_SPEED {
            friction.extend(all.last());
        }
    }
    (percentile(&friction, 0.99).max(percentile(&all, 0.99)), if least.is_finite() { least } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::super::{GRAVITY, fixture};
    use super::*;
    use crate::model::Side;
    use glam::DVec3;
    use std::f64::consts::TAU;

    #[test]
    fn a_still_stand_is_beyond_reproach() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 240, |_, _| {});
        let found = measure(fixture::motion(&body, &poses), &fixture::standing(), &[], 1.0).expect("sound");
        assert!(found.residual_force < 1e-9 && found.residual_moment < 1e-9);
        assert!((found.vertical_min - 1.0).abs() < 1e-9);
        assert!(found.joints.excesses.is_empty() && found.joints.pops.is_empty(), "{:?}", found.joints);
        assert!(!found.balance.moved && found.balance.recovered && found.balance.rest_from == Some(0.0));
        // Inside by how far the projection of the centre of mass is from the edge.
        let com = fixture::com(&body);
        let depth = (0.145 - com.x.abs()).min(com.z + 0.06).min(0.19 - com.z);
        assert!(found.zmp_distances.iter().all(|d| (d.expect("in contact") + depth).abs() < 1e-6));
        let report = found.plausibility();
        assert!((report.score - 1.0).abs() < 1e-9 && report.notes.is_empty(), "{report:?}");
    }

    /// A body that rides the linear pendulum of a pressure that goes to `reach` and back along X, smoothly.
    fn pendulum(reach: f64) -> (crate::model::Body, Vec<crate::model::BodyPose>, Vec<f64>) {
        let body = fixture::body();
        let height = fixture::com(&body).y;
        let omega_squared = GRAVITY / height;
        // c = A sin² gives p = c - c''/ω².
        let w = TAU * 0.4;
        let along = |time: f64| (0.5 - 0.5 * (w * time).cos(), 0.5 * w * w * (w * time).cos());
        let scale = reach / (1.0 + w * w / (2.0 * omega_squared));
        let poses = fixture::poses(&body, 601, |pose, sample| pose.hips.x += scale * along(sample / 120.0).0);
        let pressure = (0..601)
            .map(|sample| along(f64::from(sample) / 120.0))
            .map(|(c, a)| scale * (c - a / omega_squared))
            .collect();
        (body, poses, pressure)
    }

    #[test]
    fn a_pendulums_own_pressure_is_found_within_2_mm() {
        let (body, poses, pressure) = pendulum(0.3);
        let motion = fixture::motion(&body, &poses);
        let track = Track::new(motion).expect("sound");
        let dynamics = dynamics(&track, &[]);
        let z = fixture::com(&body).z;
        // It starts in mid-acceleration, which the padding of a filter cannot know: a quarter of a second is left out.
        for (sample, pressure) in pressure.iter().enumerate().take(track.len() - 30).skip(30) {
            let support = support(&track, &fixture::standing(), sample).expect("in contact");
            let found = zmp::zmp(&support, dynamics.needed[sample], dynamics.com[sample], body.mass * GRAVITY);
            assert!((found.x - pressure).abs() < 0.002, "{sample}: {found} against {pressure}");
            assert!((found.y - z).abs() < 0.002, "{sample}: {found}");
        }
    }

    #[test]
    fn keys_at_30_fps_joined_by_straight_lines_show_the_same_pressure() {
        let (body, poses, pressure) = pendulum(0.3);
        let keyed: Vec<_> = (0..poses.len())
            .map(|sample| {
                let (from, u) = (sample - sample % 4, (sample % 4) as f64 / 4.0);
                let mut pose = poses[sample].clone();
                pose.hips = poses[from].hips.lerp(poses[(from + 4).min(poses.len() - 1)].hips, u);
                pose
            })
            .collect();
        let motion = fixture::motion(&body, &keyed);
        let track = Track::new(motion).expect("sound");
        let dynamics = dynamics(&track, &[]);
        for (sample, pressure) in pressure.iter().enumerate().take(track.len() - 30).skip(30) {
            let support = support(&track, &fixture::standing(), sample).expect("in contact");
            let found = zmp::zmp(&support, dynamics.needed[sample], dynamics.com[sample], body.mass * GRAVITY);
            assert!((found.x - pressure).abs() < 0.004, "{sample}: {found} against {pressure}");
        }
    }

    #[test]
    fn a_stand_on_two_stairs_is_carried_and_one_past_them_is_not() {
        let body = fixture::body();
        let mut contacts = fixture::standing();
        contacts[1].point.y = 0.17;
        let at = |shift: f64| {
            let poses = fixture::poses(&body, 240, |pose, sample| {
                let u = (sample / 120.0).clamp(0.0, 1.0);
                pose.hips.x += shift * (3.0 * u * u - 2.0 * u * u * u);
                for side in Side::BOTH {
                    let hip = body.feet[side as usize].ankle - 2;
                    let ankle = body.joints[hip + 2].rest;
                    let hip_now = body.joints[hip].rest + (pose.hips - body.joints[0].rest);
                    pose.turns[hip] = glam::DQuat::from_rotation_arc(-DVec3::Y, (ankle - hip_now).normalize());
                    pose.turns[hip + 1] = pose.turns[hip];
                }
            });
            measure(fixture::motion(&body, &poses), &contacts, &[], 1.0).expect("sound")
        };
        assert!(at(0.02).residual_moment < 1e-6 && at(0.02).zmp.inside == 1.0, "{:?}", at(0.02).zmp);
        assert!(at(0.30).zmp.inside < 0.95 && at(0.30).zmp.outside_max_cm > 3.0, "{:?}", at(0.30).zmp);
    }

    #[test]
    fn nonsense_in_contacts_and_pushes_costs_the_score_not_the_program() {
        use super::super::PushPoint;
        let body = fixture::body();
        let poses = fixture::poses(&body, 60, |pose, sample| pose.hips.x += 0.01 * sample);
        for value in [f64::NAN, f64::INFINITY, -1e300, 1e300] {
            let push = KnownPush { start: value, end: 1.0, force: DVec3::splat(value), at: PushPoint::Joint(999) };
            let mut contact = fixture::flat(Side::Left, 0.0, value);
            contact.normal = DVec3::splat(value);
            contact.point.y = value;
            let other = fixture::flat(Side::Right, value, 0.2);
            for friction in [value, 0.0, 1.0] {
                let report = plausibility(fixture::motion(&body, &poses), &[contact, other], &[push], friction);
                assert!((0.0..=1.0).contains(&report.score), "{report:?}");
            }
        }
    }

    #[test]
    fn a_pelvis_25_cm_off_its_feet_has_its_pressure_outside() {
        let body = fixture::body();
        // The pelvis goes 25 cm sideways between 1 and 2 s, the feet stay.
        let poses = fixture::poses(&body, 360, |pose, sample| {
            let u = (sample / 120.0 - 1.0).clamp(0.0, 1.0);
            pose.hips.x += 0.25 * (3.0 * u * u - 2.0 * u * u * u);
            for side in Side::BOTH {
                // Legs lean so that the ankles stay: a turn of the whole leg about the hip.
                let hip = body.feet[side as usize].ankle - 2;
                let ankle = body.joints[hip + 2].rest;
                let hip_now = body.joints[hip].rest + (pose.hips - body.joints[0].rest);
                let turn = glam::DQuat::from_rotation_arc(-DVec3::Y, (ankle - hip_now).normalize());
                pose.turns[hip] = turn;
                pose.turns[hip + 1] = turn;
            }
        });
        let found = measure(fixture::motion(&body, &poses), &fixture::standing(), &[], 1.0).expect("sound");
        assert!(found.zmp.outside_max_cm > 5.0 && found.zmp.inside < 0.9, "{:?}", found.zmp);
        assert!(found.residual_moment > 0.01, "{}", found.residual_moment);
        let report = found.plausibility();
        assert!(report.score < 0.6 && report.notes.iter().any(|note| note.contains("zero-moment")), "{report:?}");
    }

    #[test]
    fn a_body_in_free_fall_needs_nothing_and_a_hovering_one_its_weight() {
        let body = fixture::body();
        let fall = fixture::poses(&body, 60, |pose, sample| {
            let t = sample / 120.0;
            pose.hips += DVec3::new(1.0 * t, 3.0 + 1.0 * t - 0.5 * GRAVITY * t * t, 0.0);
        });
        let found = measure(fixture::motion(&body, &fall), &[], &[], 1.0).expect("sound");
        // The filter's padding bends the ends of a parabola: look at the middle, and at the whole with leave.
        for needed in &found.dynamics.needed[20..40] {
            assert!(needed.force.length() < 0.01 * body.mass * GRAVITY, "{needed:?}");
        }
        assert_eq!(found.zmp.flight, 60);
        let hover = fixture::poses(&body, 60, |pose, _| pose.hips.y += 1.0);
        let found = measure(fixture::motion(&body, &hover), &[], &[], 1.0).expect("sound");
        assert!((found.residual_force - 1.0).abs() < 1e-9, "{}", found.residual_force);
    }

    #[test]
    fn a_body_that_speeds_up_with_no_contact_lacks_all_of_the_force() {
        let body = fixture::body();
        let w = TAU * 0.5;
        let poses = fixture::poses(&body, 481, |pose, sample| {
            pose.hips.z += 0.4 * (1.0 - (w * sample / 120.0).cos());
            pose.hips.y += 1.0;
        });
        let found = measure(fixture::motion(&body, &poses), &[], &[], 1.0).expect("sound");
        let a_rms = 0.4 * w * w * 0.5_f64.sqrt() / GRAVITY;
        assert!((found.residual_force - 1.0_f64.hypot(a_rms)).abs() < 0.01, "{}", found.residual_force);
    }

    #[test]
    fn an_unsound_motion_says_so() {
        let body = fixture::body();
        let mut poses = fixture::poses(&body, 3, |_, _| {});
        poses[1].turns.pop();
        let report = plausibility(fixture::motion(&body, &poses), &[], &[], 1.0);
        assert!(report.score == 0.0 && report.notes.len() == 1);
        assert!(measure(fixture::motion(&body, &[]), &[], &[], 1.0).is_none());
        let one = fixture::poses(&body, 1, |_, _| {});
        assert!(measure(fixture::motion(&body, &one), &fixture::standing(), &[], 1.0).is_some());
    }
}

//! The gate: why a clip that stands may not pass as standing. Bounds are lengths at the reference leg of 0.83 m, s and
//! body weights.
//!
//! What it asks is what nobody who looks lets pass, however good the rest is: a body in the air that did not jump, one
//! that is held by nothing, legs through each other. Whether a clip stands at all, [`super::outcome`] says.

use super::Findings;

/// s, the longest that neither foot may be in contact: a frame or two while the weight goes over, no flight.
pub const LONGEST_HOVER: f64 = 0.05;
/// Body weights, the most that the contacts may lack of the force that the motion needs, kept up for longer than
/// [`RESIDUAL_SPAN`]: some 40 N of an adult, about what a hand gives that steadies somebody.
pub const MOST_RESIDUAL: f64 = 0.05;
/// s. A landing is over sooner, and a filter at 7 Hz smears it over one or two samples more than it lasts.
pub const RESIDUAL_SPAN: f64 = 0.05;
/// m at the reference leg, the nearest that the axes of thigh or shank may come: two calves of 5.5 cm half their girth's
/// width touch at 11 cm, so at 6 half of each is within the other.
pub const LEAST_LEGS: f64 = 0.06;

/// Why not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hindrance {
    /// Neither foot is in contact.
    Hover {
        /// s, how long.
        seconds: f64,
        /// s, from when on.
        time: f64,
    },
    /// A force comes from nowhere while a foot is in contact.
    Force {
        /// Body weights, how much of it is kept up.
        weights: f64,
        /// s, from when on.
        time: f64,
    },
    /// The legs are in each other.
    Legs {
        /// m, how near their axes come.
        distance: f64,
        /// s, when.
        time: f64,
    },
}

/// Everything that hinders it, the most telling first; nothing where it may pass.
pub fn gate(found: &Findings) -> Vec<Hindrance> {
    let hover = Hindrance::Hover { seconds: found.hover.longest, time: found.hover.time };
    let (weights, time) = found.residual_kept_up;
    let force = Hindrance::Force { weights, time };
    let (distance, apart) = (found.legs.least, found.legs.apart());
    let legs = Hindrance::Legs { distance, time: found.legs.time };
    // What is no number hinders too.
    let within =
        [found.hover.longest <= LONGEST_HOVER + 1e-9, weights <= MOST_RESIDUAL + 1e-9, apart >= LEAST_LEGS - 1e-9];
    [hover, force, legs].into_iter().zip(within).filter(|(_, within)| !within).map(|(why, _)| why).collect()
}

impl std::fmt::Display for Hindrance {
    fn fmt(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Hindrance::Hover { seconds, time } => {
                write!(to, "neither foot is on the ground for {seconds:.2} s from {time:.2} s on")
            }
            Hindrance::Force { weights, time } => {
                write!(to, "{:.0} % of the body's weight comes from nowhere from {time:.2} s on", 100.0 * weights)
            }
            Hindrance::Legs { distance, time } => {
                write!(to, "the legs come within {:.1} cm of each other at {time:.2} s", 100.0 * distance)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{HeldContact, KnownPush, PushPoint, fixture, measure};
    use super::*;
    use crate::maths::real;
    use crate::model::{Role, Side};
    use glam::{DQuat, DVec3};

    #[test]
    fn a_hover_passes_up_to_50_ms_and_no_longer() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 240, |_, _| {});
        let lifted = |gap: f64| {
            let contacts: Vec<HeldContact> = [(0.0, 0.8), (0.8 + gap, 9.0)]
                .into_iter()
                .flat_map(|(start, end)| Side::BOTH.map(|side| fixture::flat(side, start, end)))
                .collect();
            gate(&measure(fixture::motion(&body, &poses), &contacts, &[], 1.0).expect("sound"))
        };
        assert_eq!(lifted(0.0), []);
        assert_eq!(lifted(0.049), []);
        let found = lifted(0.052);
        let Some(Hindrance::Hover { seconds, time }) = found.first() else { panic!("{found:?}") };
        assert!((seconds - 0.052).abs() < 1e-9 && (time - 0.8).abs() < 1e-9, "{found:?}");
        assert_eq!(found[0].to_string(), "neither foot is on the ground for 0.05 s from 0.80 s on");
    }

    #[test]
    fn a_force_from_nowhere_passes_up_to_5_percent_of_the_weight_and_where_it_is_short() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 360, |_, _| {});
        let weight = body.mass * super::super::GRAVITY;
        // Lifted by a hook with more than the weight: the ground cannot pull down.
        let lifted = |share: f64, duration: f64| {
            let force = DVec3::Y * ((1.0 + share) * weight);
            let hook = KnownPush { start: 1.0, end: 1.0 + duration, force, at: PushPoint::Centre };
            gate(&measure(fixture::motion(&body, &poses), &fixture::standing(), &[hook], 1.0).expect("sound"))
        };
        assert_eq!(lifted(0.045, 1.0), []);
        let found = lifted(0.055, 1.0);
        let [Hindrance::Force { weights, time }] = found[..] else { panic!("{found:?}") };
        assert!((0.05..0.07).contains(&weights) && (1.0..1.9).contains(&time), "{found:?}");
        assert!(found[0].to_string().contains("of the body's weight comes from nowhere from 1."), "{}", found[0]);
        // The same pull for two samples is an impact: its filtered force stays under the weight.
        assert_eq!(lifted(0.055, 2.0 / 120.0), []);
    }

    #[test]
    fn legs_pass_down_to_6_cm_of_the_reference_leg() {
        // The left leg, which hangs 0.20 m beside the right one, leans inwards.
        let near = |gap: f64, scale: f64| {
            let mut body = fixture::body();
            body.joints.iter_mut().for_each(|joint| joint.rest *= scale);
            body.leg_length = 0.83 * scale;
            let hip = body.joint(Role::LeftUpperLeg).expect("a leg");
            let lean = DQuat::from_rotation_z(-real::asin((0.20 - gap) / 0.82));
            let poses = fixture::poses(&body, 120, |pose, _| (hip..hip + 4).for_each(|joint| pose.turns[joint] = lean));
            gate(&measure(fixture::motion(&body, &poses), &fixture::standing(), &[], 1.0).expect("sound"))
        };
        for scale in [1.0, 0.5] {
            assert_eq!(near(0.061, scale), []);
            let found = near(0.059, scale);
            let [Hindrance::Legs { distance, .. }] = found[..] else { panic!("{found:?}") };
            assert!((distance - 0.059 * scale).abs() < 1e-9, "{found:?}");
            let told = format!("the legs come within {:.1} cm of each other at 0.00 s", 100.0 * distance);
            assert_eq!(found[0].to_string(), told);
        }
    }

    #[test]
    fn everything_that_hinders_is_told_the_air_first() {
        let body = fixture::body();
        let hip = body.joint(Role::LeftUpperLeg).expect("a leg");
        let poses = fixture::poses(&body, 240, |pose, _| {
            (hip..hip + 4).for_each(|joint| pose.turns[joint] = DQuat::from_rotation_z(-0.4));
        });
        let contacts = [fixture::flat(Side::Left, 0.0, 0.5), fixture::flat(Side::Right, 1.0, 9.0)];
        let push = KnownPush { start: 0.0, end: 9.0, force: DVec3::Y * 2000.0, at: PushPoint::Centre };
        let found = gate(&measure(fixture::motion(&body, &poses), &contacts, &[push], 1.0).expect("sound"));
        let kinds = [
            matches!(found[0], Hindrance::Hover { .. }),
            matches!(found[1], Hindrance::Force { .. }),
            matches!(found[2], Hindrance::Legs { .. }),
        ];
        assert_eq!(kinds, [true; 3], "{found:?}");
    }
}

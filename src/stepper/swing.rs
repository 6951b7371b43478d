//! The swinging foot's way through the air: a cubic Bezier on the ground, bowed around the stance leg, and a lift that
//! starts and ends at rest. Scenario space, metres.

use super::{Params, Plant, Swing, ground, support};
use glam::{DVec2, DVec3};

/// How far along its way a swing is, 0..1, by the clock.
pub fn phase(swing: &Swing, time: f64) -> f64 {
    ((time - swing.lift) / (swing.land - swing.lift)).clamp(0.0, 1.0)
}

/// Where the foot is at that phase.
pub fn along(params: &Params, swing: &Swing, phase: f64) -> Plant {
    let eased = ease(phase);
    let (from, to) = (ground(swing.from.ankle), ground(swing.to.ankle));
    let path = bezier(from, to, swing.detour, eased);
    let up = 16.0 * phase * phase * (1.0 - phase) * (1.0 - phase);
    let height = swing.from.ankle.y + (swing.to.ankle.y - swing.from.ankle.y) * eased + params.lift_height * up;
    Plant { ankle: DVec3::new(path.x, height, path.y), yaw: swing.from.yaw + (swing.to.yaw - swing.from.yaw) * eased }
}

/// The bow, (x, z) m, that keeps the path `gap` m away from the stance ankle; zero where the straight way does.
pub fn detour(from: DVec2, to: DVec2, stance: DVec2, facing: f64, outward: f64, gap: f64) -> DVec2 {
    let mut near = f64::INFINITY;
    let mut away = support::left(facing) * outward;
    for i in 1..8 {
        let point = from + (to - from) * (i as f64 / 8.0);
        let distance = point.distance(stance);
        if distance < near {
            near = distance;
            if distance > 0.25 * gap && (point - stance).dot(away) > 0.0 {
                away = (point - stance) / distance;
            }
        }
    }
    away * (gap - near).max(0.0) * (4.0 / 3.0) // a cubic's middle goes three quarters of the way to its handles
}

/// Peak over mean speed of the easing.
pub const PEAK: f64 = 1.875;

fn ease(u: f64) -> f64 {
    u * u * u * (10.0 + u * (6.0 * u - 15.0))
}

fn bezier(from: DVec2, to: DVec2, detour: DVec2, u: f64) -> DVec2 {
    let (one, two) = (from + (to - from) / 3.0 + detour, from + (to - from) * (2.0 / 3.0) + detour);
    let w = 1.0 - u;
    from * (w * w * w) + one * (3.0 * w * w * u) + two * (3.0 * w * u * u) + to * (u * u * u)
}

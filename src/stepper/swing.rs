//! The swinging foot's way through the air: a cubic Bezier on the ground, bowed around the stance leg, and a lift that
//! starts and ends at rest. Scenario space, metres.

use super::{Params, Plant, StepKind, Swing, ground, stand};
use glam::{DVec2, DVec3};

/// How far along its way a swing is, 0..1, by the clock.
pub fn phase(swing: &Swing, time: f64) -> f64 {
    ((time - swing.lift) / (swing.land - swing.lift)).clamp(0.0, 1.0)
}

/// Where the foot is at that time.
pub fn along(params: &Params, swing: &Swing, time: f64) -> Plant {
    if swing.kind == StepKind::Held {
        let height = stand::height(params, swing, time);
        return Plant::level(swing.from.ankle + DVec3::Y * height, swing.from.yaw);
    }
    let phase = phase(swing, time);
    let eased = if swing.kind == StepKind::Walk { phase * phase * (3.0 - 2.0 * phase) } else { ease(phase) };
    let (from, to) = (ground(swing.from.ankle), ground(swing.to.ankle));
    let path = bezier(from, to, swing.detour, eased);
    let up = 16.0 * phase * phase * (1.0 - phase) * (1.0 - phase);
    let height = swing.from.ankle.y + (swing.to.ankle.y - swing.from.ankle.y) * eased + params.lift_height * up;
    Plant {
        ankle: DVec3::new(path.x, height, path.y),
        yaw: swing.from.yaw + (swing.to.yaw - swing.from.yaw) * eased,
        normal: swing.from.normal.lerp(swing.to.normal, eased).normalize(),
    }
}

/// The bow, (x, z) m, that keeps the path `gap` m away from the stance ankle on the side that `round` (a unit vector)
/// points to; zero where the straight way does.
pub fn detour(from: DVec2, to: DVec2, stance: DVec2, round: DVec2, gap: f64) -> DVec2 {
    let way = to - from;
    let share = ((stance - from).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
    let amid = ((share.min(1.0 - share) - 0.02) / 0.1).clamp(0.0, 1.0); // the ends stand where they may
    if amid == 0.0 {
        return DVec2::ZERO;
    }
    let normal = way.perp() / way.length();
    let normal = if round.dot(normal) < 0.0 { -normal } else { normal };
    let past = (from + way * share - stance).dot(normal);
    let bow = 3.0 * share * (1.0 - share); // of a cubic, for handles bowed by 1
    normal * ((gap - past).max(0.0) * amid / bow.max(0.3))
}

/// The side on which the straight way passes the stance ankle; `else_way` where it goes through it.
pub fn round(from: DVec2, to: DVec2, stance: DVec2, else_way: DVec2) -> DVec2 {
    let way = to - from;
    let share = ((stance - from).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
    let past = from + way * share - stance;
    if past.length() > 1e-3 { past.normalize() } else { else_way }
}

/// Peak over mean speed of the easing.
pub const PEAK: f64 = 1.875;

/// The same of a walking step: the foot is under way before it leaves the ground.
pub const WALK_PEAK: f64 = 1.5;

fn ease(u: f64) -> f64 {
    u * u * u * (10.0 + u * (6.0 * u - 15.0))
}

fn bezier(from: DVec2, to: DVec2, detour: DVec2, u: f64) -> DVec2 {
    let (one, two) = (from + (to - from) / 3.0 + detour, from + (to - from) * (2.0 / 3.0) + detour);
    let w = 1.0 - u;
    from * (w * w * w) + one * (3.0 * w * w * u) + two * (3.0 * w * u * u) + to * (u * u * u)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_through_the_stance_foot_is_bowed_around_it_by_the_gap() {
        let stance = DVec2::ZERO;
        for (from, to) in [((0.2, -0.3), (-0.1, 0.4)), ((0.2, 0.0), (-0.25, 0.16)), ((-0.3, -0.1), (0.3, 0.05))] {
            let (from, to) = (DVec2::from(from), DVec2::from(to));
            for round in [DVec2::Y, DVec2::NEG_Y, DVec2::X] {
                let bow = detour(from, to, stance, round, 0.116);
                let near = (0..=100).map(|i| bezier(from, to, bow, f64::from(i) / 100.0).distance(stance));
                let near = near.fold(f64::INFINITY, f64::min);
                assert!(near > 0.08, "{from} {to} {round}: {near}");
            }
        }
    }

    #[test]
    fn a_way_that_is_clear_stays_straight() {
        let bow = detour(DVec2::new(0.18, 0.0), DVec2::new(0.2, 0.5), DVec2::ZERO, DVec2::X, 0.116);
        assert_eq!(bow, DVec2::ZERO);
    }

    #[test]
    fn the_easing_starts_and_ends_at_rest_and_peaks_as_it_says() {
        let speed = |u: f64| (ease(u + 1e-6) - ease(u - 1e-6)) / 2e-6;
        assert!(speed(1e-5).abs() < 1e-6 && speed(1.0 - 1e-5).abs() < 1e-6);
        assert!((speed(0.5) - PEAK).abs() < 1e-6);
    }
}

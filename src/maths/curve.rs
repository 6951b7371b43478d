//! Curves in time that start and end at rest, soft limits, and interpolation of uniform series.

use crate::maths::real;
use std::ops::{Add, Mul, Sub};

/// 0 to 1 with no velocity and no acceleration at either end (quintic); clamped outside 0..1.
pub fn smooth5(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u * u * u * (10.0 + u * (6.0 * u - 15.0))
}

/// 0 to 1 at rest at both ends with little more than the least possible peak acceleration: 4.6 where a quintic has 5.8
/// and bang-bang 4. Its acceleration is a trapezoid with ramps of [`TRAPEZOID_RAMP`]; clamped outside 0..1.
pub fn trapezoid(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    if u > 0.5 {
        return 1.0 - trapezoid(1.0 - u);
    }
    let r = TRAPEZOID_RAMP;
    let along = |u: f64| {
        let (speed, start) = (0.5 * r, r * r / 6.0);
        if u < r {
            return u * u * u / (6.0 * r);
        }
        let level = (u - r).min(0.5 - 2.0 * r);
        let place = start + speed * level + 0.5 * level * level;
        let over = (u - (0.5 - r)).max(0.0);
        place + (speed + level) * over + 0.5 * over * over - over * over * over / (6.0 * r)
    };
    0.5 * along(u) / along(0.5)
}

/// Share of the whole time in which [`trapezoid`]'s acceleration rises.
const TRAPEZOID_RAMP: f64 = 0.10;

/// 0 to 1 with no velocity at either end (cubic); clamped outside 0..1.
pub fn smooth3(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}

/// 0, 1 in the middle, 0, at rest at both ends: a step's clearance.
pub fn bump(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    16.0 * (u * (1.0 - u)).powi(2)
}

/// `x`, bent so that it never passes ±limit.
pub fn soft_limit(x: f64, limit: f64) -> f64 {
    limit * real::tanh(x / limit)
}

/// A uniform series with spacing `dt`, sampled at `time` through a Catmull-Rom cubic; the ends hold.
pub fn sample<T>(series: &[T], dt: f64, time: f64) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    let last = series.len() - 1;
    let place = (time / dt).clamp(0.0, last as f64);
    let index = (place.floor() as usize).min(last.saturating_sub(1));
    let u = place - index as f64;
    let at = |i: isize| series[i.clamp(0, last as isize) as usize];
    let i = index as isize;
    let (a, b, c, d) = (at(i - 1), at(i), at(i + 1), at(i + 2));
    let (m0, m1) = ((c - a) * 0.5, (d - b) * 0.5);
    let (u2, u3) = (u * u, u * u * u);
    b * (2.0 * u3 - 3.0 * u2 + 1.0) + m0 * (u3 - 2.0 * u2 + u) + c * (3.0 * u2 - 2.0 * u3) + m1 * (u3 - u2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trapezoid_rises_smoothly_and_accelerates_less_than_a_quintic() {
        let peak = |curve: fn(f64) -> f64| {
            let h = 1e-3;
            (1..999)
                .map(|i| f64::from(i) * h)
                .map(|u| ((curve(u + h) - 2.0 * curve(u) + curve(u - h)) / (h * h)).abs())
                .fold(0.0, f64::max)
        };
        assert!((trapezoid(0.5) - 0.5).abs() < 1e-12 && trapezoid(0.0) == 0.0 && trapezoid(1.0) == 1.0, "its ends");
        assert!(peak(trapezoid) < 5.05 && peak(smooth5) > 5.7, "{} {}", peak(trapezoid), peak(smooth5));
    }

    #[test]
    fn sampling_passes_through_the_series_and_keeps_a_line_straight() {
        let line: Vec<f64> = (0..10).map(|i| 3.0 * f64::from(i)).collect();
        assert!((sample(&line, 0.1, 0.3) - 9.0).abs() < 1e-12, "at a sample");
        assert!((sample(&line, 0.1, 0.35) - 10.5).abs() < 1e-12, "between samples");
        assert_eq!(sample(&line, 0.1, 99.0), 27.0, "past the end");
    }
}

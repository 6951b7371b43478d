//! The inverted pendulum in closed form: where it goes, where it can be stopped, how long a step it takes.
//!
//! SI units, ground plane as `DVec2` (x, z). Sources: Kenwright, "Watch Your Step" (2013), equation for the step length
//! with the slip in its first line mended; Hof (2005) and Koolen (2012) for the extrapolated centre of mass. Constant
//! height, massless legs: what the spring leg adds is the caller's business.

use crate::maths::real;
use glam::DVec2;

/// m/s².
pub const GRAVITY: f64 = 9.81;

/// 1/s, the pendulum's rate at that height of the centre of mass over the ground.
pub fn rate(height: f64) -> f64 {
    (GRAVITY / height).sqrt()
}

/// m, the extrapolated centre of mass c + v/ω.
pub fn extrapolated(position: DVec2, velocity: DVec2, omega: f64) -> DVec2 {
    position + velocity / omega
}

/// m and m/s after `time` s over a fixed pivot, at constant height.
pub fn predict(position: DVec2, velocity: DVec2, pivot: DVec2, omega: f64, time: f64) -> (DVec2, DVec2) {
    let grown = real::exp(omega * time);
    let (cosh, sinh) = (0.5 * (grown + 1.0 / grown), 0.5 * (grown - 1.0 / grown));
    let lean = position - pivot;
    (pivot + lean * cosh + velocity * (sinh / omega), lean * (omega * sinh) + velocity * cosh)
}

/// m, where the extrapolated centre of mass goes in `time` s over a fixed pivot: ξ(t) = p + (ξ - p) exp(ω t).
pub fn carried(xi: DVec2, pivot: DVec2, omega: f64, time: f64) -> DVec2 {
    pivot + (xi - pivot) * real::exp(omega * time)
}

/// m, the distance ahead of the centre of mass at which a foot must land for the speed to be `residual` when the mass
/// passes over it: the pole vault's energy, `½v² + g(h-s) = ½v'² + gL`, `L² = (h-s)² + d²`.
///
/// `height` is that of the centre of mass over the present foothold, `rise` how much higher the next one is. 0 where
/// the speed is no more than the residual.
pub fn step_distance(speed: f64, residual: f64, height: f64, rise: f64) -> f64 {
    let drop = height - rise;
    let vault = (speed * speed - residual * residual) / (2.0 * GRAVITY);
    if vault <= 0.0 || drop <= 0.0 {
        return 0.0;
    }
    (vault * (vault + 2.0 * drop)).sqrt() // (drop + vault)² - drop², without the cancellation
}

/// m, the pivot that brings the extrapolated centre of mass from `xi` to `aim` in `time` s.
pub fn pivot_for(xi: DVec2, aim: DVec2, omega: f64, time: f64) -> DVec2 {
    let grown = real::exp(omega * time);
    (aim - xi * grown) / (1.0 - grown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extrapolated_centre_of_mass_goes_where_the_pendulum_does() {
        let (com, velocity, pivot, omega) = (DVec2::new(0.1, -0.2), DVec2::new(0.4, 0.7), DVec2::new(0.05, 0.1), 3.3);
        for time in [0.0, 0.2, 0.9] {
            let (there, then) = predict(com, velocity, pivot, omega, time);
            let xi = carried(extrapolated(com, velocity, omega), pivot, omega, time);
            assert!(xi.distance(extrapolated(there, then, omega)) < 1e-12, "after {time} s");
        }
    }

    #[test]
    fn step_distance_is_the_papers_formula_when_no_speed_is_left() {
        for speed in [0.3, 1.0, 2.5] {
            for rise in [-0.2, 0.0, 0.3] {
                let paper = speed / (2.0 * GRAVITY) * (speed * speed + 4.0 * GRAVITY * (0.96 - rise)).sqrt();
                assert!((step_distance(speed, 0.0, 0.96, rise) - paper).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn step_distance_is_near_the_capture_point_at_low_speed_and_past_it_at_high_speed() {
        let share = |speed: f64| step_distance(speed, 0.0, 0.96, 0.0) / (speed / rate(0.96)) - 1.0;
        assert!(share(0.5) > 0.0 && share(0.5) < 0.0035);
        assert!(share(1.0) > 0.01 && share(1.0) < 0.015);
        assert!(share(2.0) > 0.045 && share(2.0) < 0.055);
    }

    #[test]
    fn a_vault_over_the_step_leaves_the_residual_speed() {
        let (speed, residual, height, rise) = (1.4_f64, 0.6_f64, 0.9_f64, 0.1_f64);
        let d = step_distance(speed, residual, height, rise);
        let apex = real::hypot(height - rise, d);
        let left = speed * speed + 2.0 * GRAVITY * (height - rise - apex);
        assert!((left - residual * residual).abs() < 1e-12);
        assert_eq!(step_distance(0.5, 0.6, height, rise), 0.0);
    }

    #[test]
    fn the_pendulum_stops_over_its_extrapolated_centre_of_mass() {
        let omega = rate(0.96);
        let (c, v) = (DVec2::new(0.1, -0.2), DVec2::new(0.7, 0.3));
        let (end, speed) = predict(c, v, extrapolated(c, v, omega), omega, 5.0);
        assert!((end - extrapolated(c, v, omega)).length() < 1e-6 && speed.length() < 1e-6);
    }

    #[test]
    fn the_pivot_found_leads_to_the_aim() {
        let omega = rate(0.8);
        let (c, v, aim) = (DVec2::new(0.1, -0.2), DVec2::new(0.7, 0.3), DVec2::new(0.4, 0.1));
        let pivot = pivot_for(extrapolated(c, v, omega), aim, omega, 0.35);
        let (end, speed) = predict(c, v, pivot, omega, 0.35);
        assert!((extrapolated(end, speed, omega) - aim).length() < 1e-12);
    }
}

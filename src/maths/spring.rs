//! A damped spring stepped exactly: the same path whatever the time step (while its target holds).

use crate::maths::real;

/// Position and velocity of one coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    /// Position.
    pub x: f64,
    /// Velocity, a second.
    pub v: f64,
}

impl Spring {
    /// One step of x'' = ω²(target - x) - 2ζω x', ω in rad/s, for ζ below 1 (a ζ of 1 or more is taken as 0.999).
    pub fn step(&mut self, target: f64, omega: f64, zeta: f64, dt: f64) {
        let zeta = zeta.clamp(0.0, 0.999);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let (sin, cos) = real::sin_cos(damped * dt);
        let decay = real::exp(-zeta * omega * dt);
        let offset = self.x - target;
        let b = (self.v + zeta * omega * offset) / damped;
        self.x = target + decay * (offset * cos + b * sin);
        self.v = decay * ((b * damped - zeta * omega * offset) * cos - (offset * damped + zeta * omega * b) * sin);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_small_steps_end_where_one_large_step_does() {
        let mut small = Spring { x: 1.0, v: -3.0 };
        let mut large = small;
        for _ in 0..100 {
            small.step(0.2, 9.0, 0.4, 0.005);
        }
        large.step(0.2, 9.0, 0.4, 0.5);
        assert!((small.x - large.x).abs() < 1e-9 && (small.v - large.v).abs() < 1e-9, "{small:?} {large:?}");
    }
}

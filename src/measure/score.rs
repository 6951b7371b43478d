//! One number over the measures: 0..1, 1 where nothing is wrong.
//!
//! A weighted geometric mean of qualities 1/(1 + x/half), x being how far a measure is from what nothing is wrong with
//! and `half` where it is half as good (the table in `terms`). So it falls with every measure that gets worse, and one
//! that is far off cannot be bought back by the others. The weights are judgement: balance and forces count twice.

use crate::model::report::Plausibility;

/// m/s, what people's ankles reach.
pub const ANKLE_SPEED: f64 = 8.0;

/// 0..1, of a report's measures and the ground's friction.
pub fn score(report: &Plausibility, friction: f64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (weight, x, half) in terms(report, friction) {
        // Not a number, or infinite: as bad as can be.
        let x = if x.is_finite() { x.max(0.0) } else { return 0.0 };
        sum -= weight * (1.0 + x / half).ln();
        weights += weight;
    }
    (sum / weights).exp()
}

/// (weight, how far off, where it is half as good).
fn terms(report: &Plausibility, friction: f64) -> [(f64, f64, f64); 10] {
    let ratio = report.speed_ratio;
    let speed = if ratio == 0.0 { 0.0 } else { (ratio - 1.1).max(0.6 - ratio).max(0.0) };
    [
        (2.0, 1.0 - report.zmp_inside, 0.2),
        (2.0, report.zmp_outside_p95_cm, 6.0),
        (2.0, report.residual_force, 0.15),
        (2.0, report.residual_moment, 0.04),
        (1.0, (report.friction_p99 - friction).max(0.0), 0.3),
        (1.0, (0.1 - report.vertical_min).max(0.0), 0.3), // a body that stands never gets near weightless
        (1.0, report.slip_max_mm, 20.0),                  // viewers notice 21 mm (Prazak 2011)
        (1.0, report.penetration_max_mm, 30.0),
        (1.0, (report.peak_ankle_speed - ANKLE_SPEED).max(0.0), 4.0),
        (1.0, speed, 0.4),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_score_falls_with_every_measure_that_gets_worse() {
        let good = Plausibility { zmp_inside: 1.0, vertical_min: 1.0, ..Plausibility::default() };
        assert!((score(&good, 1.0) - 1.0).abs() < 1e-12);
        let worse: [fn(&mut Plausibility, f64); 10] = [
            |p, x| p.zmp_inside -= 0.1 * x,
            |p, x| p.zmp_outside_p95_cm += x,
            |p, x| p.residual_force += 0.1 * x,
            |p, x| p.residual_moment += 0.01 * x,
            |p, x| p.friction_p99 = 1.0 + 0.1 * x,
            |p, x| p.vertical_min = 0.1 - 0.1 * x,
            |p, x| p.slip_max_mm += x,
            |p, x| p.penetration_max_mm += x,
            |p, x| p.peak_ankle_speed = 8.0 + x,
            |p, x| p.speed_ratio = 1.1 + 0.1 * x,
        ];
        for (index, change) in worse.iter().enumerate() {
            let mut last = 1.0;
            for x in 1..6 {
                let mut report = good.clone();
                change(&mut report, f64::from(x));
                let score = score(&report, 1.0);
                assert!(score < last - 1e-4 && score > 0.0, "term {index} at {x}: {score} after {last}");
                last = score;
            }
        }
        let mut broken = good;
        broken.residual_force = f64::NAN;
        assert_eq!(score(&broken, 1.0), 0.0);
    }
}

//! One number over the measures: 0..1, 1 where nothing is wrong.
//!
//! A product of qualities 1/(1 + x/half), each to the power weight/[`WHOLE`]: x is how far a measure is from what nothing
//! is wrong with, `half` where it is half as good. So it falls with every measure that gets worse, and one that is far off
//! cannot be bought back by the others. [`WHOLE`] is the weight of balance, forces and feet together, whose weighted
//! geometric mean is the first part; what an eye sees at once (hover, legs through each other, a fall, ...) takes from
//! that, and does not weigh less because there is much else that is right. Weights and halves are judgement, but where a
//! source is named.

use crate::maths::real;
use crate::model::report::Plausibility;

/// m/s, what people's ankles reach.
pub const ANKLE_SPEED: f64 = 8.0;
/// m at the reference leg, between the axes of thighs and shanks; nearer, the legs of most characters touch somewhere: knees
/// are 11 cm wide, thighs 15 and more. Baked walks come down to 13, a stand has 18.
pub const LEGS_APART: f64 = 0.125;
/// mm at the reference leg, how far from side by side feet may stand: people's own stands differ by as much (their heels
/// are 17 cm apart at the mean and the feet 14 degrees, McIlroy and Maki 1997), and the style dial spreads them so far.
const EASY_STANCE: f64 = 60.0;
/// Weights of the first ten measures of balance, forces and feet together.
const WHOLE: f64 = 14.0;

/// (weight, how far off, where it is half as good).
type Term = (f64, f64, f64);

/// 0..1, of a report's measures and the ground's friction. Of a motion that was `given` (captured, keyed by hand) how it
/// goes does not count, only how well it is done: flight, a fall and the last stance are then what was asked for.
pub fn score(report: &Plausibility, friction: f64, given: bool) -> f64 {
    let mut sum = 0.0;
    let course = if given { Vec::new() } else { course(report).to_vec() };
    for (weight, off, half) in forces(report, friction).into_iter().chain(posture(report)).chain(course) {
        // Not a number, or infinite: as bad as can be.
        let off = if off.is_finite() { off.max(0.0) } else { return 0.0 };
        sum -= weight / WHOLE * real::ln(1.0 + off / half);
    }
    real::exp(sum)
}

/// Balance, forces and feet; balance and forces count twice.
fn forces(report: &Plausibility, friction: f64) -> [Term; 11] {
    [
        (2.0, 1.0 - report.zmp_inside, 0.2),
        (2.0, report.zmp_outside_p95_cm, 6.0),
        (2.0, report.residual_force, 0.15),
        (2.0, report.residual_moment, 0.04),
        (1.0, (report.friction_p99 - friction).max(0.0), 0.3),
        (1.0, (0.1 - report.vertical_min).max(0.0), 0.3), // a body that stands never gets near weightless
        (1.0, report.slip_max_mm, 20.0),                  // viewers notice 21 mm (Prazak 2011)
        (1.0, report.scuff_max_mm, 40.0),                 // the same of a foot that nobody expects to stand
        (1.0, report.penetration_max_mm, 30.0),
        (1.0, (report.peak_ankle_speed - ANKLE_SPEED).max(0.0), 4.0),
        (1.0, report.speed_beyond, 0.4),
    ]
}

/// What an eye sees of the body in single frames.
fn posture(report: &Plausibility) -> [Term; 4] {
    [
        // Worse than all but hover to an animator, and no dial hides it. At 100 mm knees are in each other and 0.71 of the
        // score are left, at 0, where the axes meet, 0.41.
        (7.0, (1000.0 * LEGS_APART - report.legs_mm).max(0.0), 25.0),
        // Ranges differ by 5 to 10 degrees from one person to the next: that much is hardly seen, 30 is a broken joint.
        (2.0, report.joint_excess_deg, 15.0),
        (1.0, report.joint_excess_share, 0.5),
        (2.0, report.pops_deg, 20.0), // five of the smallest jumps that are pops at all
    ]
}

/// What the body does that nobody asked for.
fn course(report: &Plausibility) -> [Term; 3] {
    [
        // The worst that there is to an animator. 0.1 s is three frames: seen, and half of the score is gone by 0.3 s.
        (7.0, report.hover_s, 0.1),
        // A foot's width too far is a bad stand, half a step or a crossing (30 cm) leaves 0.66 of the score.
        (4.0, (report.end_stance_mm - EASY_STANCE).max(0.0), 60.0),
        // A quarter at most of what the rest gives, so that of two falls the better one has the better score.
        (WHOLE, f64::from(u8::from(report.falls)), 1.0 / 3.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Plausibility {
        Plausibility { zmp_inside: 1.0, vertical_min: 1.0, legs_mm: 180.0, ..Plausibility::default() }
    }

    #[test]
    fn the_score_falls_with_every_measure_that_gets_worse() {
        let good = good();
        assert!((score(&good, 1.0, false) - 1.0).abs() < 1e-12);
        let worse: [fn(&mut Plausibility, f64); 17] = [
            |p, x| p.scuff_max_mm = 10.0 * x,
            |p, x| p.zmp_inside -= 0.1 * x,
            |p, x| p.zmp_outside_p95_cm += x,
            |p, x| p.residual_force += 0.1 * x,
            |p, x| p.residual_moment += 0.01 * x,
            |p, x| p.friction_p99 = 1.0 + 0.1 * x,
            |p, x| p.vertical_min = 0.1 - 0.1 * x,
            |p, x| p.slip_max_mm += x,
            |p, x| p.penetration_max_mm += x,
            |p, x| p.peak_ankle_speed = 8.0 + x,
            |p, x| p.speed_beyond = 0.1 * x,
            |p, x| p.legs_mm = 125.0 - x,
            |p, x| p.joint_excess_deg = x,
            |p, x| p.joint_excess_share = 0.1 * x,
            |p, x| p.pops_deg = x,
            |p, x| p.hover_s = 0.01 * x,
            |p, x| p.end_stance_mm = 60.0 + x,
        ];
        for (index, change) in worse.iter().enumerate() {
            let mut last = 1.0;
            for x in 1..6 {
                let mut report = good.clone();
                change(&mut report, f64::from(x));
                let score = score(&report, 1.0, false);
                assert!(score < last - 1e-4 && score > 0.0, "term {index} at {x}: {score} after {last}");
                last = score;
            }
        }
        let mut broken = good;
        broken.residual_force = f64::NAN;
        assert_eq!(score(&broken, 1.0, false), 0.0);
    }

    #[test]
    fn what_an_eye_sees_at_once_costs_much_and_what_it_does_not_see_nothing() {
        let of = |change: &dyn Fn(&mut Plausibility)| {
            let mut report = good();
            change(&mut report);
            score(&report, 1.0, false)
        };
        assert_eq!(of(&|p| (p.legs_mm, p.end_stance_mm) = (125.0, 60.0)), 1.0);
        // In the order in which an animator ranked them: hover, legs, the last stance; a fall before all.
        let fall = of(&|p| p.falls = true);
        let hover = of(&|p| p.hover_s = 0.7);
        let legs = of(&|p| p.legs_mm = 30.0);
        let crossed = of(&|p| p.end_stance_mm = 280.0);
        assert!(fall <= 0.25 + 1e-12, "{fall}");
        assert!(fall < hover && hover < legs && legs < crossed && crossed < 0.75, "{hover} {legs} {crossed}");
    }

    #[test]
    fn of_two_falls_the_better_one_has_the_better_score() {
        let fall = |legs_mm: f64| score(&Plausibility { falls: true, legs_mm, ..good() }, 1.0, false);
        assert!(fall(30.0) < 0.8 * fall(150.0));
    }

    #[test]
    fn a_motion_that_was_given_may_fly_fall_and_stand_as_it_likes_but_not_slip() {
        let given = Plausibility { falls: true, hover_s: 1.0, end_stance_mm: 400.0, ..good() };
        assert_eq!(score(&given, 1.0, true), 1.0);
        assert!(score(&given, 1.0, false) < 0.1);
        assert!(score(&Plausibility { slip_max_mm: 20.0, ..given }, 1.0, true) < 0.96);
    }
}

//! The passes that make a run one motion, a few times over, as each disturbs the others: legs into reach, joints into range, knees
//! even, the pressure into the support. Scenario space, SI.

use super::care::Care;
use super::timeline::Timeline;
use super::{ankles, apart, balance, contacts, footing, heels, knees, reach};
use crate::maths::real;
use crate::measure::joints::LegAngles;
use crate::measure::{Frame, KnownPush};
use crate::sim::TickState;
use crate::stepper::Plant;
use glam::DVec2;

/// Passes of reach envelope and balance filter (measured: with nine two thirds of the clips have the ZMP home, with 14 3/4).
const PASSES: usize = 16;
/// Passes in which feet and pelvis still turn for the joints' ranges: the filter settles after them.
const EASE_PASSES: usize = 10;
/// Passes until which recoveries take more care of sudden legs; walks do until the last but one.
const CARE_PASSES: usize = 8;
/// Damping of the first passes and of the last.
const DAMPING: [f64; 2] = [0.002, 0.012];
/// Passes more where heels come up for their ankles: the body goes over the balls of its feet, and the ankles bend by more.
const HEEL_PASSES: usize = 6;
/// Passes in which the feet still adapt their roll to the ankles.
const ROLL_PASSES: usize = 4;
/// Rounds at last of lowering and bends, and m that the lowering moves without bends that follow.
const SETTLES: usize = 2;
/// m.
const MOVED: f64 = 5e-4;
/// m, and of a normal's height, by which what is level may be off.
const LEVEL: f64 = 1e-6;
/// The passes that bring the legs into reach, the joints into range and the pressure into the support, a few times over, as each
/// disturbs the others; what care they took, and m that the ZMP was out of the support before each. `uneven`: heels and knees go by
/// their ankles' ranges in walks too.
pub(super) fn converge(
    timeline: &mut Timeline,
    (cop, pushes): (&[DVec2], &[KnownPush]),
    scale: f64,
    uneven: bool,
) -> (Care, Vec<f64>) {
    let frame = Frame::of(&timeline.terrain);
    let stands = timeline.stands();
    let contacts = |timeline: &Timeline| contacts::held(&timeline.feet.contacts(stands), frame);
    let mut held = contacts(timeline);
    let gauge = LegAngles::of(&timeline.body);
    let mut zmp_before_pass = Vec::new();
    let mut care = Care::new(timeline.com.len());
    let mut passes = PASSES;
    let mut pass = 0;
    while pass < passes {
        let solved = timeline.solve_all();
        if pass > ROLL_PASSES && pass < passes - 2 {
            care.watch(timeline, &solved, pass >= CARE_PASSES);
        }
        reach::lower_into_reach(timeline, &solved, scale, &care, damping(pass));
        if pass > 0 && pass <= ROLL_PASSES {
            apart::keep_apart(timeline, &solved);
            let Timeline { body, anatomy, feet, dt, .. } = &mut *timeline;
            feet.ease_ankles(body, anatomy, &solved, cop, *dt);
            held = contacts(timeline);
        }
        let spares = ROLL_PASSES < pass && pass < if passes > PASSES { passes - 4 } else { EASE_PASSES - 1 };
        if spares && footing::spare_legs(timeline, &gauge, &solved, scale, uneven) {
            held = contacts(timeline);
        }
        if pass > 0 && pass < EASE_PASSES {
            ankles::ease_hips(timeline, &gauge, &solved, scale, uneven);
            // Each sees what the other left.
            if pass % 2 == 0 {
                ankles::ease_knees(timeline, &gauge, &solved, scale, uneven);
            } else {
                ankles::ease(timeline, &gauge, &solved, scale);
            }
            timeline.feet.clear_a_mesh();
        }
        let rising = uneven && (ROLL_PASSES - 1..passes - 2).contains(&pass);
        if rising && heels::raise(timeline, &gauge, &solved, scale) {
            held = contacts(timeline);
            passes = PASSES + HEEL_PASSES;
        }
        knees::even_knees(timeline, &solved, scale, &care);
        if pass > 0 {
            let poses: Vec<_> = solved.into_iter().map(|solved| solved.pose).collect();
            zmp_before_pass.push(balance::pass(timeline, &poses, &held, pushes));
        }
        pass += 1;
    }
    (care, zmp_before_pass)
}

/// Where heels and knees go by their ankles' ranges in walks too: in a crouch, and where some foot stands aslant, higher or lower. On
/// level ground they go as `swing` says, over a base clip as the clip does.
pub(super) fn heels_may_rise(timeline: &Timeline, ticks: &[TickState], plants: &[Plant]) -> bool {
    let level = |plant: &Plant| plant.normal.y > 1.0 - LEVEL && (plant.ankle.y - plants[0].ankle.y).abs() < LEVEL;
    let uneven = timeline.terrain.moves() || !plants.iter().all(level);
    timeline.over.is_none() && (uneven || ticks.iter().any(|tick| tick.crouched > 0.0))
}

/// The lowering and the bends in the air that each other need: the swinging legs' mass moves the hips, and a hip that is lowered takes
/// along a foot whose knee is told its bend.
pub(super) fn settle(timeline: &mut Timeline, scale: f64, care: &Care) {
    let mut solved = timeline.solve_all();
    for _ in 0..SETTLES {
        let was = timeline.lowering.clone();
        reach::lower_into_reach(timeline, &solved, scale, care, damping(PASSES));
        let moved = was.iter().zip(&timeline.lowering).map(|(was, now)| (now - was).abs()).fold(0.0, f64::max);
        if moved < MOVED {
            return;
        }
        solved = timeline.solve_all();
        knees::even_knees(timeline, &solved, scale, care);
        solved = timeline.solve_all();
    }
}

/// How much the lowering holds on to the last pass's: little while it finds its place, more as it settles.
fn damping(pass: usize) -> f64 {
    let settled = ((pass as f64 - ROLL_PASSES as f64) / 8.0).clamp(0.0, 1.0);
    DAMPING[0] * real::powf(DAMPING[1] / DAMPING[0], settled)
}

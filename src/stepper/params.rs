//! What tunes the controller, already scaled to a body. SI units.
//!
//! Every number is written for the reference body (0.83 m leg, centre of mass at 0.96 m, 89.5 kg) and scaled by Froude's
//! rule: lengths by the leg, times by sqrt(com height / g), speeds and forces by what follows. No absolute constants.

use super::Physique;
use crate::maths::pendulum::GRAVITY;
use crate::maths::real;
use crate::model::scenario::{Stepper, SupportModel, Trigger};
use crate::model::{Side, Stance};
use glam::DVec2;

/// How a character may be set apart from the ordinary adult.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// 0..1; 0.5 an ordinary adult, 1 whatever balance takes.
    pub agility: f64,
    /// The foot that goes first when neither is better.
    pub lead: Side,
    /// Which of the paper's variants it is.
    pub variant: Stepper,
    /// 0..1, how high the swinging foot is lifted; 0.5 as people do.
    pub step_height: f64,
    /// 0..1, how wide the stand is that it returns to; 0.5 as the body stands.
    pub stance_width: f64,
    /// 0..1, how readily it steps rather than sways; 0.5 as people do.
    pub readiness: f64,
    /// 0..1, how long it takes over coming back to a comfortable stand; 0.5 as people do, 0 half of it, 1 twice.
    pub recovery_time: f64,
}

impl Style {
    /// Times people's, how long the way back to a comfortable stand takes.
    pub fn unhurried(&self) -> f64 {
        real::powf(4_f64, self.recovery_time.clamp(0.0, 1.0) - 0.5)
    }
}

impl Default for Style {
    fn default() -> Style {
        Style {
            agility: 0.5,
            lead: Side::Right,
            variant: Stepper::default(),
            step_height: 0.5,
            stance_width: 0.5,
            readiness: 0.5,
            recovery_time: 0.5,
        }
    }
}

/// The controller's tuning for one body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "each line says it")]
pub struct Params {
    pub lead: Side,
    pub trigger: Trigger,
    pub support: SupportModel,
    // The body's stand.
    pub width: f64,       // m, ankle to ankle
    pub com_forward: f64, // m, centre of mass ahead of the ankles
    pub stance: Stance,   // at rest
    pub tempo: f64,       // times of the reference body are multiplied by this
    pub size: f64,        // lengths likewise
    // Spring leg.
    pub spring: f64, // N/m
    pub damper: f64, // N s/m
    // Support and ankle feedback.
    pub circle_radius: f64, // m, the paper's circle
    pub margin: f64,        // m, the centre of pressure keeps this far inside the soles
    pub inner: f64,         // m, ξ this near to its aim: nothing to do
    pub outer: f64,         // m, ξ this far inside the outline: step (negative: outside)
    pub gain: f64,          // of the centre of pressure on ξ's error
    pub lag: f64,           // s, time constant of the centre of pressure
    pub sense: f64,         // s, time constant of the perceived push
    // Timing.
    pub instant: f64,        // s, clocks that differ by less are equal: sums of ticks are not exact
    pub reaction: f64,       // s, from the disturbance's being felt to the first lift
    pub swing: f64,          // s, a corrective swing
    pub follow_swing: f64,   // s
    pub comfort_swing: f64,  // s
    pub double_support: f64, // s, from landing to the next lift
    pub pause: f64,          // s, from coming to rest to a comfort step
    // Footholds.
    pub reach: f64,       // m, hip to ankle along the ground at touchdown
    pub ankle_speed: f64, // m/s, peak
    pub gap: f64,         // m, sideways between the ankles in a step
    pub outward: f64,     // m, the foot lands this far outside of the point that it must catch
    pub overshoot: f64,   // m, and this far ahead of it
    pub across: f64,      // m, likewise of a foot that crosses: it lands short, for the other one is to follow
    pub pass: f64,        // m, a foot that crosses lands so far ahead of or behind the other
    pub slip_arc: f64,    // share of the pole vault's arc by which the centre of mass sinks beside its foot
    pub give: f64,        // share of the drop to the landing height that the stance leg gives way by
    pub leg_lag: f64,     // s, time constant of the legs' force
    pub most_across: f64, // m, a foot crosses no farther than so
    pub least_step: f64,  // m, a corrective step is no shorter than so, if it may be longer
    pub retarget: f64,    // m/s, how fast a swing's landing can be moved
    pub expect: f64,      // s, a push is expected to go on for as long as it has lasted, but no longer than so
    pub foresee: f64,     // N, of a push harder than so, what it will yet do counts for the decision to step
    pub tipping: f64,     // share of a high push's moment that ends up as speed
    pub delay: f64,       // s, until the ankles answer with their full gain
    pub cost_speed: f64,  // s, weight of the speed at touchdown in the choice of a foot
    pub cost_cross: f64,  // share of the crossing
    pub pull: f64,        // m, the paper's k_p
    pub leg_bias: f64,    // of the leg's length error in the step's length
    pub trail: f64,       // m, the trailing foot starts when the centre of mass is so far from it and leaving
    pub lift_height: f64, // m, of the swinging ankle
    // Gait.
    pub walk_arc: f64,      // as slip_arc: more of the vault shows in a walk
    pub walk_bias: f64,     // as leg_bias, of a step of the gait
    pub twist_most: f64,    // rad, a turn that leaves the feet behind by more is stepped
    pub turned: f64,        // rad, and by less than so is done
    pub rolls: bool,        // the pressure rolls under the feet
    pub ramp: f64,          // m/s2, of the commanded velocity
    pub step_width: f64,    // m, between the ankles' lines
    pub step_gap: f64,      // m, between the ankles of feet that pass each other
    pub stumble: f64,       // m, a wanted landing so far out of reach wants a corrective step
    pub midair: f64,        // m, the same of a step in the air soon after a shove
    pub trims: bool,        // under a force that lasts it corrects its own speed, and nobody else does
    pub fits: bool,         // steps are timed so that they land off the edges of gaps
    pub balls: Option<f64>, // m ahead of the ankles, where feet bear with their heels up; none where heels rise by themselves or not at all
    pub upright: f64,       // how little it is crouched, 0 to 1: strides are long where it is not
    pub even: f64,          // share that is kept of what makes a step unlike the last ones
    pub wide: f64,          // m, steps wider than so are no walk
    pub brief: f64,         // s, the swings of the first and the last step are no longer than so
    pub least_swing: f64,   // s, a hasty swing of the gait
    pub transfer: f64,      // share of the rear foot in the pivot of the step that stops
    pub walk_gain: f64,     // of ankle feedback on ξ at touchdown
    /// 1/min, steps at least: of a slow walk that does not turn, of another (`gait::SLOW`), of a fast one (`gait::FAST`) on feet that do not
    /// bend and on such that do.
    pub cadence: [f64; 4],
    pub double: f64,      // times people's, the share of a step in which both feet carry
    pub rolled: f64,      // times people's, how far the pressure rolls under a foot
    pub roll_ahead: f64,  // m, by which the pressure rolls farther ahead under the feet
    pub turn_rate: f64,   // rad/s, the fastest turn
    pub leg_change: bool, // legs give and stretch
    // Comfort.
    pub stagger: f64, // m
    pub widen: f64,   // share of the width
    pub twist: f64,   // rad
    // Failure.
    pub leg_span: f64, // m, hip to ankle, stretched
    pub low: f64,      // m, the centre of mass under this: fallen
    pub lean: f64,     // m, centre of mass from the nearest standing ankle, along the ground: fallen
}

impl Params {
    /// The tuning for that body and style.
    pub fn new(physique: &Physique, style: &Style) -> Params {
        let variant = &style.variant;
        let size = physique.leg_length / 0.83;
        let tempo = (physique.com_height / 0.96).sqrt();
        let pace = size / tempo;
        let agility = style.agility.clamp(0.0, 1.0);
        let dial = |slow: f64, adult: f64, best: f64| {
            if agility < 0.5 {
                slow + (adult - slow) * 2.0 * agility
            } else {
                adult + (best - adult) * (2.0 * agility - 1.0)
            }
        };
        let mut width = physique.stance_width * (0.6 + 0.8 * style.stance_width.clamp(0.0, 1.0));
        let weight = physique.mass * GRAVITY;
        let stiffness = 23.6 * weight / physique.leg_length; // 25 kN/m for the reference body
        let margin = 0.01 * size;
        width = width.max(2.0 * physique.half_width + 0.02 * size).max(0.0);
        let hip_low = 0.74 * physique.hip_height - physique.ankle_height;
        let leg = physique.leg_length * 0.995;
        let legs_reach = (leg * leg - hip_low * hip_low).max(0.04 * leg * leg).sqrt();
        let gap = (0.14 * physique.leg_length).max(2.0 * physique.half_width + 0.01 * size).min(0.95 * width);
        let com_forward = physique.com_forward.min(physique.tip - 2.0 * margin).max(physique.heel + 2.0 * margin);
        let natural = Stance {
            middle: DVec2::ZERO,
            apart: DVec2::new(width, 0.0),
            over: DVec2::new(0.0, com_forward),
            yaws: [physique.toe_out, -physique.toe_out],
        };
        Params {
            lead: style.lead,
            trigger: variant.trigger,
            support: variant.support,
            width,
            com_forward,
            stance: physique.stance.unwrap_or(natural),
            tempo,
            size,
            spring: variant.spring * stiffness,
            damper: variant.damping * 0.67 * 2.0 * (stiffness * physique.mass).sqrt(),
            circle_radius: 0.08 * size,
            margin,
            inner: 0.008 * size,
            outer: 0.05 * (style.readiness.clamp(0.0, 1.0) - 0.5) * size,
            gain: 1.0 / style.unhurried(),
            lag: 0.036 * tempo,
            sense: 0.06 * tempo,
            instant: 1e-9 * tempo,
            reaction: dial(0.20, 0.11, 0.0) * tempo,
            swing: dial(0.36, 0.30, 0.22) * tempo,
            follow_swing: dial(0.42, 0.37, 0.30) * tempo * style.unhurried().sqrt(),
            comfort_swing: 0.46 * tempo * style.unhurried(),
            double_support: dial(0.08, 0.06, 0.02) * tempo,
            pause: 0.35 * tempo * style.unhurried(),
            reach: dial(0.85, 1.0, 1.45) * legs_reach,
            ankle_speed: dial(6.0, 8.0, 16.0) * pace,
            gap,
            outward: 0.045 * size,
            overshoot: 0.02 * size,
            across: -0.03 * size,
            pass: (0.20 * size).max(gap + 0.04 * size),
            slip_arc: 0.6,
            give: 1.0,
            leg_lag: 0.02 * tempo,
            most_across: dial(0.4, 0.45, 0.8) * size,
            least_step: 0.2 * size,
            retarget: dial(2.0, 3.0, 8.0) * pace,
            expect: 0.12 * tempo,
            foresee: 0.25 * weight,
            tipping: 0.2,
            delay: 0.5 * tempo,
            cost_speed: 0.2 * tempo,
            cost_cross: 0.2,
            pull: variant.pull_bias * physique.com_height,
            leg_bias: 0.4 * variant.length_bias,
            trail: 0.36 * physique.leg_length,
            lift_height: (0.05 + 0.08 * style.step_height.clamp(0.0, 1.0)) * size,
            rolls: variant.ankle_feedback,
            walk_arc: 0.95,
            walk_bias: variant.length_bias,
            twist_most: 0.35,
            turned: 0.12,
            ramp: 0.8 * pace / tempo,
            step_width: (0.10 * size).max(2.0 * physique.half_width + 0.005 * size),
            step_gap: (0.09 * size).max(2.0 * physique.half_width),
            stumble: dial(1.2, 1.0, 0.65) * size,
            midair: f64::INFINITY, // a foot of the pendulum's is where it is planned
            even: 1.0,
            trims: true,
            fits: false,
            balls: None,
            upright: 1.0,
            wide: f64::INFINITY,
            least_swing: dial(0.34, 0.28, 0.20) * tempo,
            brief: 0.45 * tempo,
            transfer: 0.14,
            walk_gain: 0.7,
            cadence: [66.0; 4],
            double: 1.0,
            rolled: 1.0,
            roll_ahead: 0.0,
            turn_rate: 1.6 / tempo,
            leg_change: variant.leg_change,
            stagger: 0.05 * size,
            widen: 0.25,
            twist: 0.2,
            leg_span: leg,
            low: 0.57 * physique.com_height,
            lean: dial(0.85, 0.9, 1.3) * physique.leg_length,
        }
    }
}

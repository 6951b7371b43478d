//! All measures of a motion at once, the score over them, and what a person should be told.
//!
//! Scenario space, SI but where a name says cm or mm. The measures themselves are in the files beside this one; the
//! score's formula is in [`super::score`].

use super::dynamics::{Dynamics, Wrench, dynamics};
use super::feet::{FeetFindings, feet};
use super::gate::RESIDUAL_SPAN;
use super::hover::{Hover, hover};
use super::joints::{JointFindings, joints};
use super::legs::{Legs, legs};
use super::moving::{Moving, kept_up};
use super::outcome::{Balance, balance};
use super::residual::{Units, residual};
use super::score::score;
use super::scuff::{Scuff, grounded, slides};
use super::speed::{SpeedGain, speed_gain};
use super::stance::{EndStance, end_stance};
use super::support::{SMEARED, Support, support_near};
use super::zmp::{self, ZmpFindings};
use super::{HeldContact, KnownPush, Motion, Track};
use crate::model::{Load, Terrain, report::Plausibility};

/// Everything that was found.
#[derive(Clone, Debug)]
pub struct Findings {
    /// Contacts, soles, ankles, legs.
    pub feet: FeetFindings,
    /// Limits, knees, pops.
    pub joints: JointFindings,
    /// Zero-moment point and flight.
    pub zmp: ZmpFindings,
    /// How near the legs come.
    pub legs: Legs,
    /// Time in the air (neither foot in contact nor scuffing over the ground), until it has fallen.
    pub hover: Hover,
    /// Feet that scuff, and how far each slides, mm.
    pub scuffs: Vec<(Scuff, f64)>,
    /// How it ends.
    pub balance: Balance,
    /// How it stands at the end; `None` for who walks, turns or has fallen there.
    pub end_stance: Option<EndStance>,
    /// Whether it falls: measured as fallen, unless who knows of a fall after the measured part says so.
    pub falls: bool,
    /// Whether the motion was given (captured, keyed by hand): how it goes is then not judged, only how well it is done.
    pub given: bool,
    /// Which samples move.
    pub moving: Moving,
    /// 99th percentile, over moving samples with contact (or the mean of a stand's worst half second where that is more), of
    /// tangential over normal force needed of the ground.
    pub friction_p99: f64,
    /// Least force needed along the ground's normal, over samples with contact, in body weights.
    pub vertical_min: f64,
    /// RMS over moving samples (or a stand's worst half second where that is more) of the missing force, body weights.
    pub residual_force: f64,
    /// The same of the missing moment, body weights x height.
    pub residual_moment: f64,
    /// Body weights, the missing force that is kept up in contact for longer than the gate's span, and from when on (s).
    pub residual_kept_up: (f64, f64),
    /// N, N m: the largest missing force and moment, and when (s).
    pub residual_peak: ((f64, f64), (f64, f64)),
    /// What a push gave of speed; `None` without one.
    pub speed: Option<SpeedGain>,
    /// The body's leg over the reference 0.83 m: lengths that are asked for scale with it.
    pub leg_scale: f64,
    /// The friction that the residual was measured with.
    pub friction: f64,
    /// Centre of mass, momentum and needed wrench, sample by sample.
    pub dynamics: Dynamics,
    /// m out of the support, sample by sample; `None` in flight.
    pub zmp_distances: Vec<Option<f64>>,
}

/// Measures a motion over a ground of which only the contacts' planes are known; `None` for one that cannot be
/// ([`Motion::is_sound`]).
pub fn measure(motion: Motion, contacts: &[HeldContact], pushes: &[KnownPush], friction: f64) -> Option<Findings> {
    Some(measure_track(&Track::new(motion)?, contacts, pushes, friction))
}

/// The same over a ground that is known, with its friction.
pub fn measure_on(
    motion: Motion,
    terrain: &Terrain,
    contacts: &[HeldContact],
    pushes: &[KnownPush],
) -> Option<Findings> {
    Some(measure_track(&Track::over(motion, terrain)?, contacts, pushes, terrain.friction))
}

/// What the motion's measures must know beside it.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    /// The ground.
    pub terrain: &'a Terrain,
    /// What is carried.
    pub loads: &'a [Load],
    /// m, the deepest crouch that is meant.
    pub crouched: f64,
    /// When a foot bears without holding still.
    pub scuffs: &'a [Scuff],
    /// Whether it is asked to walk where the motion ends.
    pub goes: bool,
}

/// The same of a body that carries something or crouches.
pub fn measure_in(
    motion: Motion,
    setting: &Setting,
    contacts: &[HeldContact],
    pushes: &[KnownPush],
) -> Option<Findings> {
    let track = Track::over(motion, setting.terrain)?.carrying(setting.loads).crouching(setting.crouched);
    let track = track.scuffing(setting.scuffs).going(setting.goes);
    Some(measure_track(&track, contacts, pushes, setting.terrain.friction))
}

fn measure_track(track: &Track, contacts: &[HeldContact], pushes: &[KnownPush], friction: f64) -> Findings {
    let motion = track.motion;
    let units = Units::of(motion.body);
    let dynamics = dynamics(track, pushes);
    // The forces that a motion needs are filtered, so a landing's blow shows before the contact begins.
    let supports: Vec<Option<Support>> =
        (0..track.len()).map(|sample| support_near(track, contacts, sample, SMEARED)).collect();
    let residuals: Vec<Wrench> = supports
        .iter()
        .enumerate()
        .map(|(i, support)| residual(support.as_ref(), dynamics.needed[i], dynamics.com[i], friction, units))
        .collect();
    let distances = zmp::distances(&motion, &dynamics, &supports, &residuals);
    let moving = Moving::of(&dynamics, &supports, motion.hz);
    let (friction_p99, vertical_min) = ground_forces(&dynamics, &supports, &moving, units);
    let forces: Vec<f64> = residuals.iter().map(|wrench| wrench.force.length() / units.weight).collect();
    let moments: Vec<f64> =
        residuals.iter().map(|wrench| wrench.moment.length() / (units.weight * units.height)).collect();
    let in_contact: Vec<Option<f64>> =
        forces.iter().zip(&supports).map(|(force, support)| support.as_ref().map(|_| *force)).collect();
    let (level, from) = kept_up(&in_contact, motion.hz, RESIDUAL_SPAN);
    let peak = |size: &dyn Fn(&Wrench) -> f64| {
        let sizes = residuals.iter().enumerate().map(|(sample, wrench)| (size(wrench), motion.time(sample)));
        sizes.fold((0.0, 0.0), |peak, next| if next.0 > peak.0 { next } else { peak })
    };
    let balance = balance(track, &dynamics, &supports, contacts, pushes, None);
    let end = motion.time(track.len() - 1);
    let on_ground: Vec<HeldContact> = contacts.iter().copied().chain(grounded(track, track.scuffs)).collect();
    Findings {
        feet: feet(track, contacts),
        joints: joints(track),
        zmp: zmp::findings(&motion, &dynamics, &distances),
        legs: legs(track),
        scuffs: slides(track, track.scuffs),
        hover: hover(&on_ground, balance.fallen.unwrap_or(end)),
        end_stance: if balance.fallen.is_none() { end_stance(track) } else { None },
        falls: balance.fallen.is_some(),
        given: false,
        balance,
        friction_p99,
        vertical_min,
        residual_force: moving.rms(&forces),
        residual_moment: moving.rms(&moments),
        residual_kept_up: (level, motion.time(from)),
        moving,
        residual_peak: (peak(&|wrench| wrench.force.length()), peak(&|wrench| wrench.moment.length())),
        speed: speed_gain(track, &dynamics, pushes),
        leg_scale: motion.body.leg_length / 0.83,
        friction,
        dynamics,
        zmp_distances: distances,
    }
}

/// What a baked clip says about itself; a motion that cannot be measured scores 0 and says so.
pub fn plausibility(motion: Motion, contacts: &[HeldContact], pushes: &[KnownPush], friction: f64) -> Plausibility {
    match measure(motion, contacts, pushes, friction) {
        Some(findings) => findings.plausibility(),
        None => Plausibility { notes: vec!["the motion could not be measured".into()], ..Plausibility::default() },
    }
}

impl Findings {
    /// The report's share of the findings.
    pub fn plausibility(&self) -> Plausibility {
        let mut report = Plausibility {
            score: 0.0,
            zmp_inside: self.zmp.inside,
            zmp_outside_p95_cm: self.zmp.outside_p95_cm,
            friction_p99: self.friction_p99,
            vertical_min: self.vertical_min,
            residual_force: self.residual_force,
            residual_moment: self.residual_moment,
            slip_max_mm: self.feet.slip_max_mm,
            scuff_max_mm: self.scuffs.iter().map(|scuff| scuff.1).fold(0.0, f64::max),
            penetration_max_mm: self.feet.penetration_max_mm,
            peak_ankle_speed: self.feet.peak_ankle_speed,
            speed_ratio: self.speed.map_or(0.0, |gain| gain.ratio),
            speed_beyond: self.speed.map_or(0.0, |gain| gain.beyond()),
            hover_s: self.hover.total,
            hover_longest_s: self.hover.longest,
            legs_mm: 1000.0 * self.legs.apart(),
            joint_excess_deg: self.joints.excesses.iter().map(|excess| excess.by.to_degrees()).fold(0.0, f64::max),
            joint_excess_share: self.moving.share(&self.joints.beyond),
            pops: self.joints.pops.len() as u32,
            // Summed from 0: a sum of none is -0.
            pops_deg: self.joints.pops.iter().fold(0.0, |sum, pop| sum + pop.step.to_degrees()),
            end_stance_mm: self.end_stance.filter(|_| !self.falls).map_or(0.0, |end| 1000.0 * end.off / self.leg_scale),
            falls: self.falls,
            notes: self.notes(),
        };
        report.score = score(&report, self.friction, self.given);
        report
    }
}

/// (99th percentile of the friction needed, least normal force in body weights).
fn ground_forces(dynamics: &Dynamics, supports: &[Option<Support>], moving: &Moving, units: Units) -> (f64, f64) {
    let mut least = f64::INFINITY;
    let one = |(support, needed): (&Option<Support>, &Wrench)| {
        let support = support.as_ref()?;
        let normal = needed.force.dot(support.normal);
        least = least.min(normal / units.weight);
        let tangent = (needed.force - support.normal * normal).length();
        Some(tangent / normal.max(0.05 * units.weight))
    };
    // A stand on a slope needs friction too.
    let ratios: Vec<Option<f64>> = supports.iter().zip(&dynamics.needed).map(one).collect();
    (moving.percentile(&ratios, 0.99), if least.is_finite() { least } else { 0.0 })
}

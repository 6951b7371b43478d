//! The paper's seven cases of walking at a commanded speed, as scenarios for a rig, and what is measured of their clips; `tests/seven.rs`
//! asserts on it, `tests/benches/seven_cases.rs` prints and draws all.
//!
//! Speeds are Froude-equal and forces scale with mass: both are given for legs of 0.83 m and 89.5 kg. The speed is the clip's own: that of
//! the hips on its keys, over whole strides.

use glam::DVec3;
use std::fmt::Write as _;
use surefoot::bake::{BakeOptions, Baked, Drive, bake};
use surefoot::model::report::Outcome;
use surefoot::model::scenario_text;
use surefoot::rig::mannequin::BUILTIN;
use surefoot::rig::{Rig, load, load_bytes};

/// The paper's bare pendulum as a scenario says it: no ankle feedback, no change of leg lengths.
pub const BARE: &str = "[stepper]\nankle_feedback = false\nleg_change = false\n";
/// Rigs of others beside the built-in one.
pub const OTHERS: [&str; 2] = ["gdquest_mannequiny.glb", "m2m_ue_names_no_animation.glb"];

/// s, from a change of the commanded speed or the start of a force until the speed is to be steady.
const SETTLES: f64 = 3.5;
/// Share of the commanded speed within which it is back after an impulse.
const BACK: f64 = 0.1;
/// s of the reference body, over which that is averaged: about a step at 1.2 m/s.
const STEP: f64 = 0.57;

/// One of the seven.
#[derive(Clone, Debug)]
pub struct Case {
    /// For a person.
    pub name: String,
    /// s.
    pub duration: f64,
    /// (s, m/s): from when on which speed is commanded.
    pub walks: Vec<(f64, f64)>,
    /// Degrees, up positive.
    pub slope: f64,
    /// s, s, N along the way: start, duration and strength of a force on the hips.
    pub force: Option<(f64, f64, f64)>,
}

impl Case {
    /// A walk on the level at that speed (m/s).
    pub fn level(name: &str, speed: f64) -> Case {
        Case { name: name.into(), duration: 12.0, walks: vec![(0.2, speed)], slope: 0.0, force: None }
    }

    /// The scenario's text for a rig whose legs are scaled, with those further tables.
    fn text(&self, rig: &Rig, legs: f64, more: &str) -> String {
        let (pace, mass) = (pace(rig, legs), rig.body.mass / 89.5);
        let mut text = format!("duration = {}\n[character]\nleg_scale = {legs}\n{more}", self.duration);
        if self.slope != 0.0 {
            let _ = write!(text, "[ground]\nkind = \"slope\"\nangle = {}\n", self.slope);
        }
        for (start, speed) in &self.walks {
            let _ = write!(text, "[[walk]]\nstart = {start}\nspeed = {:.4}\n", speed * pace);
        }
        if let Some((start, duration, newtons)) = self.force {
            let (toward, force) = (if newtons < 0.0 { 180 } else { 0 }, newtons.abs() * mass);
            let at = "at = \"hips\"";
            let _ = write!(
                text,
                "[[push]]\nstart = {start}\nduration = {duration}\nforce = {force:.2}\ntoward = {toward}\n{at}\n"
            );
        }
        text
    }

    /// (from, to) s and m/s, where its speed is to be steady.
    fn spans(&self) -> Vec<(f64, f64, f64)> {
        let ends = self.walks[1..].iter().map(|walk| walk.0).chain([self.duration]);
        let disturbed = self.force.map_or(0.0, |force| force.0);
        let spans = self.walks.iter().zip(ends);
        spans.map(|((start, speed), end)| (start.max(disturbed) + SETTLES, end, *speed)).collect()
    }
}

/// m/s, what one of the reference body is for a rig with scaled legs.
fn pace(rig: &Rig, legs: f64) -> f64 {
    (rig.body.leg_length * legs / 0.83).sqrt()
}

/// The seven, at that speed (m/s) where they do not change it: on slopes of so many degrees up and down, with impulses and lasting
/// forces of so many N.
pub fn seven(speed: f64, [up, down]: [(f64, f64); 2], [impulse, lasting]: [f64; 2]) -> [Case; 7] {
    let on = |name: &str, degrees: f64, speed: f64| Case { slope: degrees, ..Case::level(name, speed) };
    let forced = |name: &str, start: f64, lasts: f64, newtons: f64| Case {
        force: Some((start, lasts, newtons)),
        ..Case::level(name, speed)
    };
    let changing = vec![(0.2, 0.6), (8.0, 1.2), (16.0, 0.9), (24.0, 0.4)];
    [
        Case { walks: changing, duration: 34.0, ..Case::level("(a) changing speed", speed) },
        on(&format!("(b) {:.0} degrees up at {:.1} m/s", up.0, up.1), up.0, up.1),
        on(&format!("(c) {:.0} degrees down at {:.1} m/s", down.0, down.1), -down.0, down.1),
        forced(&format!("(d) {impulse:.0} N, 0.2 s from behind"), 5.0, 0.2, impulse),
        forced(&format!("(e) {impulse:.0} N, 0.2 s from the front"), 5.0, 0.2, -impulse),
        forced(&format!("(f) {lasting:.0} N push that lasts"), 4.0, 8.0, lasting),
        forced(&format!("(g) {lasting:.0} N pull that lasts"), 4.0, 8.0, -lasting),
    ]
}

/// The built-in rig with ordinary, short and long legs, and the others where their files are.
pub fn bodies(data: Option<std::path::PathBuf>) -> Vec<(String, Rig, f64)> {
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let builtin = load_bytes("builtin", BUILTIN, &alone, None).expect("the built-in rig loads");
    let mut bodies: Vec<_> =
        [1.0, 0.7, 1.3].map(|legs| (format!("built-in, legs x {legs}"), builtin.clone(), legs)).into();
    for name in OTHERS.iter().filter(|_| data.is_some()) {
        let path = data.clone().unwrap_or_default().join("rigs").join(name);
        bodies.push(((*name).into(), load(&path).unwrap_or_else(|error| panic!("{name}: {error}")), 1.0));
    }
    bodies
}

/// What a clip of a case does.
#[derive(Clone, Debug)]
pub struct Walked {
    /// Speed over the commanded one less 1, where it is farthest from 0 in a steady span.
    pub error: f64,
    /// s after an impulse began, from when on the speed is within a tenth for good.
    pub back: Option<f64>,
    /// s, where balance is lost.
    pub fell: Option<f64>,
    /// Of 1.
    pub score: f64,
    /// (s, m/s of the reference body): the centre of mass; the bench draws it.
    pub curve: Vec<(f64, f64)>,
    /// Of its steady steps.
    pub vault: Vault,
}

/// Means over touchdowns, m of the body's leg lengths times 0.83.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vault {
    /// From the centre of mass to the foot that lands, along the way.
    pub ahead: f64,
    /// Equation 2's d for the speed then, the speed that is left over the foot, and how much higher than the other foot it stands.
    pub vaulted: f64,
    /// How much higher that is.
    pub rise: f64,
    /// From foot to foot along the way.
    pub step: f64,
    /// The centre of mass over the foot that stands.
    pub height: f64,
}

/// Bakes the case by that drive; who refuses says what.
pub fn walked(rig: &Rig, legs: f64, case: &Case, drive: Drive, more: &str, seed: u64) -> Result<Walked, String> {
    let text = case.text(rig, legs, more);
    let scenario = scenario_text::parse(&case.name, &text).unwrap_or_else(|errors| panic!("{errors:?}\n{text}"));
    let options = BakeOptions { drive, seed: Some(seed), ..BakeOptions::default() };
    let baked = bake(rig, &scenario, &options).map_err(|error| error.to_string())?;
    let pace = pace(rig, legs);
    let trace = &baked.performance.trace;
    let fell = (baked.report.outcome == Outcome::Fall).then(|| baked.performance.lost.unwrap_or_default());
    let (mut error, mut last) = (0.0_f64, 0.0);
    for (from, until, speed) in case.spans().into_iter().filter(|_| fell.is_none()) {
        let off = speed_over(rig, &baked, from, until) / (speed * pace) - 1.0;
        error = if off.abs() > error.abs() || off.is_nan() { off } else { error };
        last = from;
    }
    let brief = case.force.filter(|force| force.1 < 1.0 && fell.is_none());
    Ok(Walked {
        error,
        back: brief.map(|force| back(&baked, force.0, case.walks[case.walks.len() - 1].1 * pace)),
        fell,
        score: baked.report.plausibility.score,
        curve: trace.ticks.iter().enumerate().map(|(i, t)| (i as f64 * trace.dt, t.velocity.z / pace)).collect(),
        vault: vault(&baked, last, 0.83 / (rig.body.leg_length * legs)),
    })
}

/// m/s along +Z, the hips on the clip's keys, over the whole strides within a span; not a number where there is none.
fn speed_over(rig: &Rig, baked: &Baked, from: f64, until: f64) -> f64 {
    let steps = &baked.performance.trace.steps;
    let within = || steps.iter().filter(|step| step.land >= from && step.land <= until);
    let Some(last) = within().next_back() else { return f64::NAN };
    let Some(first) = within().find(|step| step.side == last.side && step.land < last.land) else { return f64::NAN };
    let mut sampler = rig.sampler(&baked.clip);
    let mut at = |time: f64| sampler.sample(time).hips.z;
    (at(last.land) - at(first.land)) / (last.land - first.land)
}

/// s after `from` until the centre of mass's speed along +Z, averaged over a step, is within a tenth of `speed` for good.
fn back(baked: &Baked, from: f64, speed: f64) -> f64 {
    let trace = &baked.performance.trace;
    let span = (STEP / trace.dt).round() as usize;
    let first = (from / trace.dt).round() as usize;
    let off = |i: usize| {
        let way = trace.ticks[i + span].com.z - trace.ticks[i].com.z;
        (way / (span as f64 * trace.dt) / speed - 1.0).abs() > BACK
    };
    let last = (first..trace.ticks.len().saturating_sub(span)).rev().find(|i| off(*i));
    last.map_or(0.0, |last| (last + 1 + span / 2 - first) as f64 * trace.dt)
}

/// What the touchdowns from `from` s on show: at each v, h over the foot that stands and s, and v' when the centre of mass is over the
/// foot that has landed.
fn vault(baked: &Baked, from: f64, size: f64) -> Vault {
    let trace = &baked.performance.trace;
    let (mut sum, mut count) = (Vault::default(), 0.0);
    for pair in trace.steps.windows(2).filter(|pair| pair[1].land > from && pair[0].side != pair[1].side) {
        let landed = ((pair[1].land / trace.dt).round() as usize).min(trace.ticks.len() - 1);
        let (now, foot) = (&trace.ticks[landed], pair[1].to.ankle);
        let Some(over) = trace.ticks[landed..].iter().find(|tick| tick.com.z >= foot.z) else { continue };
        let stance: DVec3 = now.feet[pair[0].side as usize].ankle;
        let rise = foot.y - stance.y; // s
        let drop = now.com.y - stance.y - rise; // h - s
        let apex = drop + (now.velocity.z.powi(2) - over.velocity.z.powi(2)) / (2.0 * 9.81); // the rigid leg's length
        sum.ahead += (foot.z - now.com.z) * size;
        sum.vaulted += (apex * apex - drop * drop).max(0.0).sqrt() * size;
        sum.rise += rise * size;
        sum.step += (foot.z - stance.z) * size;
        sum.height += (now.com.y - stance.y) * size;
        count += 1.0;
    }
    let mean = |value: f64| value / f64::max(count, 1.0);
    Vault {
        ahead: mean(sum.ahead),
        vaulted: mean(sum.vaulted),
        rise: mean(sum.rise),
        step: mean(sum.step),
        height: mean(sum.height),
    }
}

//! What the plots show of a clip: curves over its time, computed once a clip and not on the window's thread. Pure; units stand at each.
//!
//! Centre of mass, ZMP and slip are the clip's own, measured on its keys; ξ, centre of pressure, support and margin are the run's behind
//! it, and torques the articulated body's. Of a loop only what is measured is there: its run is longer than the cycle. Who falls is
//! measured while the feet carry.

use crate::bake::Baked;
use crate::measure::Findings;
use crate::model::report::Contact;
use crate::model::scenario::Scenario;
use crate::model::{Role, Side};
use crate::picture::clip_plot::{margin, panels};
use crate::picture::plot::{Colour, Panel};
use crate::rig::Rig;
use egui_plot::PlotPoint;
use glam::DVec3;

/// Samples a frame of what is measured.
const PER_FRAME: f64 = 4.0;
/// Joints whose torque is shown.
pub(super) const JOINTS: usize = 4;
/// Points of a curve at most: past that only the least and the greatest of a stretch are kept.
pub(super) const MOST_POINTS: usize = 2400;

/// All curves of a clip.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// s.
    pub duration: f64,
    /// In the order of [`Kind::ALL`].
    pub charts: Vec<Chart>,
    /// (foot, from, to) s: the feet on the ground.
    pub contacts: Vec<(Side, f64, f64)>,
    /// (from, to) s: pushes, pulls and hits.
    pub pushes: Vec<(f64, f64)>,
}

/// A plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "`name` and `hint` say what they are")]
pub enum Kind {
    Speed,
    Height,
    Forward,
    Sideways,
    Margin,
    Torques,
    Slip,
    Zmp,
}

/// One plot's curves.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Which.
    pub kind: Kind,
    /// Drawn in order.
    pub curves: Vec<Curve>,
    /// The support behind them: stretches of (s, low, high).
    pub band: Vec<Vec<[f64; 3]>>,
    /// For a person: why there is nothing, or not all.
    pub note: Option<String>,
}

/// A curve: stretches of (s, value in the chart's unit), with nothing between them.
#[derive(Clone, Debug)]
pub struct Curve {
    /// What it is.
    pub name: String,
    /// Which of the colours.
    pub colour: Colour,
    /// Broken, for what was wanted.
    pub dashed: bool,
    /// In the order of time.
    pub stretches: Vec<Vec<PlotPoint>>,
}

impl Kind {
    /// From top to bottom.
    pub const ALL: [Kind; 8] =
        [Kind::Speed, Kind::Height, Kind::Forward, Kind::Sideways, Kind::Margin, Kind::Torques, Kind::Slip, Kind::Zmp];

    /// What it is called.
    pub fn name(self) -> &'static str {
        [
            "Speed",
            "Height",
            "Forward",
            "To the left",
            "Margin of stability",
            "Torques",
            "Slip",
            "ZMP out of the support",
        ][self as usize]
    }

    /// Of its values.
    pub fn unit(self) -> &'static str {
        ["m/s", "m", "m", "m", "m", "Nm", "mm", "cm"][self as usize]
    }

    /// What it tells.
    pub fn hint(self) -> &'static str {
        [
            "over the ground: what is commanded, and the centre of mass",
            "of the centre of mass over the scenario's ground",
            "centre of mass, capture point ξ and centre of pressure along the rig's forward; grey: where the soles are",
            "the same towards the rig's left",
            "how far the capture point ξ is inside of the soles; negative: outside, so it must step or fall",
            "of the joints that work hardest; only the ragdoll has them",
            "how far a held foot moves, one bar a contact",
            "how far the zero-moment point is out of the support; negative: inside, as far from the edge",
        ][self as usize]
    }

    /// Whether 0 belongs into the picture.
    pub fn has_zero(self) -> bool {
        !matches!(self, Kind::Height | Kind::Forward | Kind::Sideways)
    }
}

impl Chart {
    /// The values of its curves at a time, where they have one.
    pub fn values(&self, time: f64) -> impl Iterator<Item = (&Curve, Option<f64>)> {
        self.curves.iter().map(move |curve| (curve, curve.at(time)))
    }

    /// The least and the greatest value, with some air.
    pub fn bounds(&self) -> (f64, f64) {
        let points = self.curves.iter().flat_map(|curve| curve.stretches.iter().flatten()).map(|point| point.y);
        let band = self.band.iter().flatten().flat_map(|[_, low, high]| [*low, *high]);
        let zero = self.kind.has_zero().then_some(0.0);
        let values = points.chain(band).chain(zero);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
        if low > high {
            return (0.0, 1.0);
        }
        let air = (0.08 * (high - low)).max(0.01);
        (low - air, high + air)
    }
}

impl Curve {
    /// Its value then, straight lines between points.
    pub fn at(&self, time: f64) -> Option<f64> {
        let holds = |points: &&Vec<PlotPoint>| {
            points.first().is_some_and(|first| first.x <= time + 1e-9)
                && points.last().is_some_and(|last| time <= last.x + 1e-9)
        };
        let points = self.stretches.iter().find(holds)?;
        let next = points.partition_point(|point| point.x < time).min(points.len() - 1);
        let (a, b) = (points[next.saturating_sub(1)], points[next]);
        let share = if b.x > a.x { ((time - a.x) / (b.x - a.x)).clamp(0.0, 1.0) } else { 0.0 };
        Some(a.y + (b.y - a.y) * share)
    }
}

/// The curves of a clip on its rig.
pub fn series(baked: &Baked, scenario: &Scenario, rig: &Rig) -> Series {
    let looped = baked.report.looped.is_some();
    let performance = &baked.performance;
    let run = if looped { Vec::new() } else { panels(performance, scenario) };
    let body = Body::of(baked, looped);
    let charts = Kind::ALL.map(|kind| {
        let (curves, band, note) = match kind {
            Kind::Speed => (speed(run.first(), &body), Vec::new(), None),
            Kind::Height => (vec![body.curve(|centre, _| centre.y)], Vec::new(), None),
            Kind::Forward => place(run.get(1), body.curve(|centre, _| centre.z)),
            Kind::Sideways => place(run.get(2), body.curve(|centre, _| centre.x)),
            Kind::Margin if looped => {
                (Vec::new(), Vec::new(), Some("a loop tells none: its run is longer than it".into()))
            }
            Kind::Margin => (margins(baked), Vec::new(), None),
            Kind::Torques => torques(baked, rig, looped),
            Kind::Slip => (slips(&baked.report.contacts), Vec::new(), None),
            Kind::Zmp => {
                let note = baked.findings.is_none().then(|| "the motion could not be measured".to_owned());
                (zmp(baked, looped), Vec::new(), note)
            }
        };
        Chart { kind, curves, band, note }
    });
    Series {
        duration: baked.clip.duration,
        charts: charts.into(),
        contacts: baked.report.contacts.iter().map(|contact| (contact.foot, contact.start, contact.end)).collect(),
        pushes: baked
            .report
            .disturbances
            .iter()
            .filter(|push| push.kind != "carry")
            .map(|push| (push.start, push.end))
            .collect(),
    }
}

/// The clip's own centre of mass, or the run's where the clip could not be measured.
struct Body {
    at: Vec<(f64, DVec3, DVec3)>, // s, m, m/s
}

impl Body {
    fn of(baked: &Baked, looped: bool) -> Body {
        let at = match &baked.findings {
            Some(findings) => {
                let dynamics = &findings.dynamics;
                let (times, from) = measured(baked, findings, looped);
                let samples = dynamics.com.iter().zip(&dynamics.velocity).skip(from);
                times.zip(samples).map(|(time, (com, velocity))| (time, *com, *velocity)).collect()
            }
            None => {
                let trace = &baked.performance.trace;
                let ticks = trace.ticks.iter().enumerate();
                let ticks = ticks.map(|(index, tick)| (index as f64 * trace.dt, tick.com, tick.velocity));
                ticks.take_while(|(time, ..)| *time <= baked.clip.duration + 1e-9).collect()
            }
        };
        Body { at }
    }

    fn curve(&self, value: impl Fn(DVec3, DVec3) -> f64) -> Curve {
        let points = self.at.iter().map(|(time, com, velocity)| (*time, Some(value(*com, *velocity))));
        curve("centre of mass", Colour::Blue, points)
    }
}

/// The times of measured samples and which of them is the first of the clip: a loop is measured three times on end.
fn measured(baked: &Baked, findings: &Findings, looped: bool) -> (impl Iterator<Item = f64> + use<>, usize) {
    let hz = (baked.clip.fps * PER_FRAME).max(1e-6);
    let duration = baked.clip.duration;
    let from = if looped { (duration * hz).round() as usize } else { 0 };
    let count = findings.dynamics.com.len().saturating_sub(from);
    ((0..count).map(move |sample| sample as f64 / hz).take_while(move |time| *time <= duration + 1e-9), from)
}

fn speed(panel: Option<&Panel>, body: &Body) -> Vec<Curve> {
    let mut curves: Vec<Curve> = panel.into_iter().flat_map(|panel| lines(panel).take(1)).collect();
    curves.push(body.curve(|_, velocity| velocity.x.hypot(velocity.z)));
    curves
}

/// Along an axis of the ground: the run's ξ and centre of pressure over its support, and the clip's centre of mass.
fn place(panel: Option<&Panel>, body: Curve) -> (Vec<Curve>, Vec<Vec<[f64; 3]>>, Option<String>) {
    let mut curves: Vec<Curve> = panel.into_iter().flat_map(|panel| lines(panel).skip(1)).collect();
    curves.push(body);
    let band = panel.map(|panel| {
        let whole = |(_, low, high): &(f64, f64, f64)| low.is_finite() && high.is_finite();
        let stretches = panel.band.chunk_by(|a, b| whole(a) == whole(b)).filter(|stretch| stretch.iter().all(whole));
        let every = panel.band.len().div_ceil(MOST_POINTS).max(1);
        stretches
            .map(|stretch| stretch.iter().step_by(every).map(|(time, low, high)| [*time, *low, *high]).collect())
            .collect()
    });
    (curves, band.unwrap_or_default(), None)
}

fn lines(panel: &Panel) -> impl Iterator<Item = Curve> {
    panel.lines.iter().map(|line| Curve {
        dashed: line.dashed,
        ..curve(&line.name, line.colour, line.points.iter().map(|(time, value)| (*time, Some(*value))))
    })
}

fn margins(baked: &Baked) -> Vec<Curve> {
    let performance = &baked.performance;
    let trace = &performance.trace;
    let end = baked.clip.duration + 1e-9;
    let ticks = trace.ticks.iter().enumerate().map(|(index, tick)| (index as f64 * trace.dt, tick));
    let points =
        ticks.take_while(|(time, _)| *time <= end).map(|(time, tick)| (time, margin(&performance.physique, tick)));
    vec![curve("ξ inside of the soles", Colour::Orange, points)]
}

fn torques(baked: &Baked, rig: &Rig, looped: bool) -> (Vec<Curve>, Vec<Vec<[f64; 3]>>, Option<String>) {
    let Some(driven) = baked.performance.articulated.as_ref().filter(|_| !looped) else {
        let why = match looped {
            true => "a loop tells none: its run is longer than it",
            false => {
                "none: the stepper moved this body, which poses it without joint torques. Drive `ragdoll` has them"
            }
        };
        return (Vec::new(), Vec::new(), Some(why.into()));
    };
    const COLOURS: [Colour; JOINTS] = [Colour::Blue, Colour::Orange, Colour::Green, Colour::Red];
    let run = &driven.run;
    let end = baked.clip.duration + 1e-9;
    let curves = run.torques.iter().zip(&run.torque_curves).zip(COLOURS).map(|(((role, _), torques), colour)| {
        let points =
            torques.iter().enumerate().map(|(tick, torque)| (tick as f64 * run.trace.dt, Some(f64::from(*torque))));
        curve(&bone(rig, *role), colour, points.take_while(|(time, _)| *time <= end))
    });
    (curves.collect(), Vec::new(), None)
}

/// A joint as the rig's own bone where it has one: what an animator knows it by.
fn bone(rig: &Rig, role: Role) -> String {
    let of_rig = rig.body.joints.iter().any(|joint| joint.role == role && joint.animated);
    if of_rig { role.name().to_owned() } else { format!("{} (not in the rig)", role.name()) }
}

fn slips(contacts: &[Contact]) -> Vec<Curve> {
    let of = |side: Side, name: &str, colour: Colour| Curve {
        name: name.to_owned(),
        colour,
        dashed: false,
        stretches: (contacts.iter())
            .filter(|contact| contact.foot == side && contact.slip_mm.is_finite())
            .map(|contact| [contact.start, contact.end].map(|time| PlotPoint::new(time, contact.slip_mm)).to_vec())
            .collect(),
    };
    vec![of(Side::Left, "left foot", Colour::Blue), of(Side::Right, "right foot", Colour::Orange)]
}

fn zmp(baked: &Baked, looped: bool) -> Vec<Curve> {
    let Some(findings) = &baked.findings else { return Vec::new() };
    let (times, from) = measured(baked, findings, looped);
    let distances = findings.zmp_distances.iter().skip(from).map(|distance| distance.map(|metres| 100.0 * metres));
    vec![curve("ZMP", Colour::Green, times.zip(distances))]
}

/// A curve through what there is.
pub(super) fn curve(name: &str, colour: Colour, points: impl Iterator<Item = (f64, Option<f64>)>) -> Curve {
    let points: Vec<(f64, Option<f64>)> =
        points.map(|(time, value)| (time, value.filter(|value| value.is_finite()))).collect();
    let stretches = points.chunk_by(|a, b| a.1.is_some() == b.1.is_some()).filter(|stretch| stretch[0].1.is_some());
    let every = points.len().div_ceil(MOST_POINTS / 2);
    let stretches = stretches.map(|stretch| {
        let there: Vec<PlotPoint> =
            stretch.iter().filter_map(|(time, value)| Some(PlotPoint::new(*time, (*value)?))).collect();
        if points.len() > MOST_POINTS { thinned(&there, every) } else { there }
    });
    Curve { name: name.to_owned(), colour, dashed: false, stretches: stretches.collect() }
}

/// The least and the greatest of every so many, in the order of time: peaks stay. The ends stay too.
fn thinned(points: &[PlotPoint], every: usize) -> Vec<PlotPoint> {
    let mut left: Vec<PlotPoint> = points.first().copied().into_iter().collect();
    for chunk in points.chunks(every.max(1)) {
        let by = |a: &&PlotPoint, b: &&PlotPoint| a.y.total_cmp(&b.y);
        let ends = [chunk.iter().min_by(by), chunk.iter().max_by(by)];
        let mut ends: Vec<PlotPoint> = ends.into_iter().flatten().copied().collect();
        ends.sort_by(|a, b| a.x.total_cmp(&b.x));
        left.extend(ends);
    }
    left.extend(points.last());
    left.dedup();
    left
}

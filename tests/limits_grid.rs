//! The grid that a baked clip's limits are held on: rigs x eight directions x impulses, and the table of what came out.
//!
//! Impulses are for 89.5 kg and a 0.83 m leg and scale with each body (by m and the root of the leg). A push acts on the
//! chest for 0.2 s from 0.6 s; the clip lasts 4 s. `tests/limits.rs` asserts on it, `tests/benches/limits.rs` prints all.

use crate::data;
use rayon::prelude::*;
use std::fmt::Write as _;
use surefoot::bake::{BakeOptions, Baked, bake};
use surefoot::export::glb;
use surefoot::measure::percentile;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::{Direction, Push, Scenario};
use surefoot::model::{Body, Channel, Clip, ClipReport, KeyValues, Role};
use surefoot::rig::mannequin::BUILTIN;
use surefoot::rig::{Rig, load, load_bytes};

/// Degrees, 0 pushed forwards, positive towards the left.
pub const EIGHT: [f64; 8] = [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0];

/// Rigs that nobody here made.
pub const THIRD_PARTY: [&str; 11] = [
    "m2m_human_base_animations.glb",
    "m2m_rig_human.glb",
    "m2m_human_male.glb",
    "m2m_ue_names_no_animation.glb",
    "gdquest_mannequiny.glb",
    "kaykit_Knight.glb",
    "khronos_CesiumMan.gltf",
    "godette_vrm0.vrm",
    "vrm1_debug_robot.vrm",
    "vrm_tiny_basic_armature.vrm",
    "sketchbook_boxman.glb",
];

/// What the issue asks of a clip, one a column of the table: name, unit, whether a clip holds it.
type Limit = (&'static str, fn(&Measured) -> f64, fn(f64, &Measured) -> bool);

/// The limits of one clip. Slip and ZMP shares are over many clips too: see [`Sum`].
pub const LIMITS: [Limit; 14] = [
    ("slip<2mm", |m| m.slip_max, |v, _| v <= 2.0),
    ("speed<10", |m| m.slip_speed, |v, _| v <= 10.0),
    ("sink<5mm", |m| m.sink, |v, _| v <= 5.0),
    ("float<5mm", |m| m.float, |v, _| v <= 5.0),
    ("knee<0", |m| m.knee, |v, _| v <= 0.05),
    ("limits", |m| m.beyond.iter().map(|(_, by)| *by).fold(0.0, f64::max), |v, _| v <= 0.0),
    ("pops", |m| m.pops.len() as f64, |v, _| v <= 0.0),
    ("legs>8cm", |m| -m.legs, |v, _| v <= -8.0),
    ("zmp>95%", |m| 100.0 - m.inside, |v, _| v <= 5.0),
    ("out<3cm", |m| m.outside, |v, _| v <= 3.0),
    ("ratio", |m| m.ratio.unwrap_or(1.0), |v, m| v >= 0.6 && v <= if m.sideways() { 1.3 } else { 1.1 }),
    ("step<60", |m| m.first_step.unwrap_or(0.0), |v, _| v <= 60.0),
    ("rests", |m| f64::from(u8::from(!m.rests)), |v, _| v <= 0.0),
    ("stands", |m| f64::from(u8::from(m.outcome == Outcome::Fall)), |v, _| v <= 0.0),
];

/// What was measured of one clip.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Degrees.
    pub direction: f64,
    /// Ns, of the reference body.
    pub impulse: f64,
    /// How it ended.
    pub outcome: Outcome,
    /// How many steps.
    pub steps: u32,
    /// mm, one a contact.
    pub slips: Vec<f64>,
    /// mm.
    pub slip_max: f64,
    /// mm/s, 95th percentile.
    pub slip_speed: f64,
    /// mm under the ground.
    pub sink: f64,
    /// mm over it.
    pub float: f64,
    /// Degrees past straight.
    pub knee: f64,
    /// Joint and axis, degrees beyond its range.
    pub beyond: Vec<(String, f64)>,
    /// Joint and degrees.
    pub pops: Vec<(String, f64)>,
    /// cm in a swing, of the reference leg.
    pub legs: f64,
    /// Per cent of the moving samples.
    pub inside: f64,
    /// cm, 95th percentile.
    pub outside: f64,
    /// Speed over impulse / mass.
    pub ratio: Option<f64>,
    /// Degrees between the first step and the push.
    pub first_step: Option<f64>,
    /// Whether it is at rest at the end.
    pub rests: bool,
    /// m/s.
    pub ankle_speed: f64,
    /// Keys and what they take.
    pub keys: Keys,
}

/// How few keys a clip has.
#[derive(Clone, Debug, Default)]
pub struct Keys {
    /// Keys over frames x channels.
    pub share: f64,
    /// The same over the channels that change anything.
    pub moving: f64,
    /// Channels, and those that change anything.
    pub channels: [usize; 2],
    /// Bytes that the clip adds to its rig's file, were it the only one there.
    pub added: usize,
    /// Bytes of its keys a second.
    pub rate: f64,
}

impl Keys {
    /// Of a clip.
    pub fn of(clip: &Clip) -> Keys {
        let frames = (clip.duration * clip.fps).round() + 1.0;
        let share = |channels: &[&Channel]| {
            let keys: usize = channels.iter().map(|channel| channel.times.len()).sum();
            keys as f64 / (frames * channels.len().max(1) as f64)
        };
        let all: Vec<&Channel> = clip.channels.iter().collect();
        let moving: Vec<&Channel> = clip.channels.iter().filter(|channel| changes(channel)).collect();
        Keys {
            share: share(&all),
            moving: share(&moving),
            channels: [all.len(), moving.len()],
            added: 0,
            rate: rate(clip),
        }
    }
}

/// Bytes of a clip's keys a second: what channels that have their times together, or equal values, take once.
fn rate(clip: &Clip) -> f64 {
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<u32>>();
    let arrays = clip.channels.iter().flat_map(|channel| {
        let values: Vec<f32> = match &channel.values {
            KeyValues::Translation(keys) | KeyValues::Scale(keys) => keys.concat(),
            KeyValues::Rotation(keys) => keys.concat(),
        };
        [(false, bits(&channel.times)), (true, bits(&values))]
    });
    let once: std::collections::BTreeSet<(bool, Vec<u32>)> = arrays.collect();
    once.iter().map(|(_, array)| 4 * array.len()).sum::<usize>() as f64 / clip.duration
}

/// Whether a channel's value is not the same all the time.
fn changes(channel: &Channel) -> bool {
    channel.times.len() > 1
}

impl Measured {
    /// Whether the push was from the side.
    pub fn sideways(&self) -> bool {
        self.direction.to_radians().sin().abs() > 0.9
    }
}

/// The rigs to bake on, the built-in one first; of the others those whose file is there.
pub fn rigs() -> Vec<(String, Rig)> {
    let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let builtin = load_bytes("builtin", BUILTIN, &none, None).expect("the built-in rig loads");
    let mut rigs = vec![("builtin".to_owned(), builtin)];
    let Some(data) = data::more() else { return rigs };
    for name in THIRD_PARTY {
        let path = data.join("rigs").join(name);
        let rig = load(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        rigs.push((name.split('.').next().unwrap_or(name).to_owned(), rig));
    }
    rigs
}

/// A shove of that many Ns of the reference body towards a heading (degrees).
pub fn shove(body: &Body, direction: f64, impulse: f64) -> Scenario {
    let scaled = impulse * (body.mass / 89.5) * (body.leg_length / 0.83).sqrt();
    let mut scenario = Scenario::demo();
    scenario.title = format!("shove {impulse} towards {direction}");
    scenario.duration = 4.0;
    scenario.seed = 7;
    scenario.pull.clear();
    scenario.push = vec![Push {
        start: 0.6,
        duration: 0.2,
        force: scaled / 0.2,
        toward: Direction::Heading(direction.to_radians()),
        at: Role::Chest,
    }];
    scenario
}

/// Bakes one shove and measures it.
pub fn measured_by(rig: &Rig, direction: f64, impulse: f64, options: &BakeOptions) -> Measured {
    let scenario = shove(&rig.body, direction, impulse);
    let baked = bake(rig, &scenario, options).expect("the simulation holds");
    let mut measured = of(&baked, direction, impulse);
    // What the file's other clips move is held in ours too: those channels are the other clips' doing.
    let mut alone = rig.clone();
    if let Some(root) = alone.document.json.as_object_mut() {
        root.shift_remove("animations");
    }
    let size = |clips: &[(Clip, ClipReport)]| glb(&alone, clips).expect("can be written").bytes.len();
    measured.keys.added = size(&[(baked.clip, baked.report)]) - size(&[]);
    measured
}

/// Bakes a whole grid, in order of direction, then impulse.
pub fn grid(rig: &Rig, directions: &[f64], impulses: &[f64]) -> Vec<Measured> {
    grid_by(rig, directions, impulses, &BakeOptions::default())
}

/// The same with other options.
pub fn grid_by(rig: &Rig, directions: &[f64], impulses: &[f64], options: &BakeOptions) -> Vec<Measured> {
    let cells: Vec<(f64, f64)> = directions.iter().flat_map(|d| impulses.iter().map(|i| (*d, *i))).collect();
    cells.par_iter().map(|(direction, impulse)| measured_by(rig, *direction, *impulse, options)).collect()
}

fn of(baked: &Baked, direction: f64, impulse: f64) -> Measured {
    let findings = baked.findings.as_ref().expect("a baked clip can be measured");
    let toward = glam::DVec2::from_angle(direction.to_radians()); // (z, x): from +Z towards +X
    let first_step = baked.performance.trace.steps.first().and_then(|step| {
        let way = step.to.ankle - step.from.ankle;
        let way = glam::DVec2::new(way.z, way.x).try_normalize()?;
        Some(way.dot(toward).clamp(-1.0, 1.0).acos().to_degrees())
    });
    let feet = &findings.feet;
    Measured {
        direction,
        impulse,
        outcome: baked.report.outcome,
        steps: baked.report.steps,
        slips: feet.slips.iter().map(|slip| slip.mm).collect(),
        slip_max: feet.slip_max_mm,
        slip_speed: feet.slip_speed_p95,
        sink: feet.penetration_max_mm,
        float: feet.float_max_mm,
        knee: findings.joints.knee_past_straight.to_degrees(),
        beyond: findings
            .joints
            .excesses
            .iter()
            .map(|excess| (format!("{} {}", excess.angle.role.name(), excess.angle.axis), excess.by.to_degrees()))
            .collect(),
        pops: findings.joints.pops.iter().map(|pop| (pop.role.name().to_owned(), pop.step.to_degrees())).collect(),
        legs: (100.0 * feet.least_leg_distance / findings.leg_scale).min(99.0),
        inside: 100.0 * findings.zmp.inside,
        outside: findings.zmp.outside_p95_cm,
        ratio: findings.speed.map(|gain| gain.ratio),
        first_step,
        rests: findings.balance.rest_from.is_some(),
        ankle_speed: feet.peak_ankle_speed,
        keys: Keys::of(&baked.clip),
    }
}

/// What holds over many clips.
#[derive(Clone, Debug)]
pub struct Sum {
    /// mm, 95th percentile over contacts, and the largest.
    pub slip: [f64; 2],
    /// Per cent, mean and worst.
    pub inside: [f64; 2],
    /// cm, of the clips' own 95th percentiles the 95th.
    pub outside: f64,
    /// Least and greatest, not sideways.
    pub ratio: [f64; 2],
    /// Least and greatest, sideways.
    pub ratio_sideways: [f64; 2],
    /// Share of clips, one a limit of [`LIMITS`].
    pub passes: Vec<f64>,
    /// The worst value, one a limit.
    pub worst: Vec<f64>,
}

impl Sum {
    /// Of clips, those that end in a fall too.
    pub fn of(clips: &[Measured]) -> Sum {
        let slips: Vec<f64> = clips.iter().flat_map(|clip| clip.slips.iter().copied()).collect();
        let outside: Vec<f64> = clips.iter().map(|clip| clip.outside).collect();
        let inside = clips.iter().map(|clip| clip.inside);
        let range = |sideways: bool| {
            let ratios = clips.iter().filter(|clip| clip.sideways() == sideways).filter_map(|clip| clip.ratio);
            ratios.fold([f64::INFINITY, 0.0], |[low, high], ratio| [ratio.min(low), ratio.max(high)])
        };
        let share = |(_, value, holds): &Limit| {
            let good = clips.iter().filter(|clip| holds(value(clip), clip)).count();
            if clips.is_empty() { 1.0 } else { good as f64 / clips.len() as f64 }
        };
        let worst = |(_, value, _): &Limit| clips.iter().map(value).fold(f64::NEG_INFINITY, f64::max);
        Sum {
            slip: [percentile(&slips, 0.95), slips.iter().copied().fold(0.0, f64::max)],
            inside: [inside.clone().sum::<f64>() / clips.len().max(1) as f64, inside.fold(100.0, f64::min)],
            outside: percentile(&outside, 0.95),
            ratio: range(false),
            ratio_sideways: range(true),
            passes: LIMITS.iter().map(share).collect(),
            worst: LIMITS.iter().map(worst).collect(),
        }
    }
}

/// The head of the table.
pub fn head() -> String {
    let mut text = format!("{:<26}{:>6}", "per cent of clips | worst", "clips");
    for (name, ..) in LIMITS {
        let _ = write!(text, "{name:>12}");
    }
    text + "  | slip p95  zmp mean worst  out p95    ratio      sideways  steps ankle | keys% worst moving% worst    kB most   kB/s most"
}

/// One row of the table.
pub fn row(name: &str, clips: &[Measured]) -> String {
    let sum = Sum::of(clips);
    let mut text = format!("{name:<26}{:>6}", clips.len());
    for (at, (limit, ..)) in LIMITS.iter().enumerate() {
        let worst = if *limit == "zmp>95%" { 100.0 - sum.worst[at] } else { sum.worst[at].abs() };
        let _ = write!(text, "{:>5.0}|{:<6}", 100.0 * sum.passes[at], short(worst));
    }
    let [low, high] = sum.ratio;
    let [side_low, side_high] = sum.ratio_sideways;
    let _ = write!(
        text,
        "  | {:>8.2}  {:>8.1} {:>5.1}  {:>7.2}  {low:.2}-{high:.2}  {side_low:.2}-{side_high:.2}  {:>5} {:>5.1} | {}",
        sum.slip[0],
        sum.inside[0],
        sum.inside[1],
        sum.outside,
        clips.iter().map(|clip| clip.steps).max().unwrap_or(0),
        clips.iter().map(|clip| clip.ankle_speed).fold(0.0, f64::max),
        key_columns(clips)
    );
    text
}

/// Shares of keys and kB, mean and worst, of the clips that do not fall.
fn key_columns(clips: &[Measured]) -> String {
    let standing: Vec<&Keys> =
        clips.iter().filter(|clip| clip.outcome != Outcome::Fall).map(|clip| &clip.keys).collect();
    let both = |value: fn(&Keys) -> f64| {
        let values = standing.iter().map(|keys| value(keys));
        (values.clone().sum::<f64>() / standing.len().max(1) as f64, values.fold(0.0, f64::max))
    };
    let (share, most) = both(|keys| 100.0 * keys.share);
    let (moving, most_moving) = both(|keys| 100.0 * keys.moving);
    let (added, most_added) = both(|keys| keys.added as f64 / 1e3);
    let (rate, most_rate) = both(|keys| keys.rate / 1e3);
    format!(
        "{share:>5.1} {most:>5.1} {moving:>7.1} {most_moving:>5.1} {added:>5.1} {most_added:>4.1} {rate:>6.1} {most_rate:>4.1}"
    )
}

/// What breaks in clips, most often first.
pub fn faults(clips: &[Measured]) -> String {
    let mut counts: std::collections::BTreeMap<String, (usize, f64)> = std::collections::BTreeMap::new();
    let mut count = |what: String, by: f64| {
        let entry = counts.entry(what).or_default();
        *entry = (entry.0 + 1, entry.1.max(by));
    };
    for clip in clips {
        clip.beyond.iter().for_each(|(what, by)| count(what.clone(), *by));
        clip.pops.iter().for_each(|(what, by)| count(format!("{what} pops"), *by));
        if clip.outcome == Outcome::Fall {
            count(format!("fall at {} Ns towards {}", clip.impulse, clip.direction), 0.0);
        }
    }
    let mut sorted: Vec<_> = counts.into_iter().collect();
    sorted.sort_by(|a, b| b.1.0.cmp(&a.1.0).then(a.0.cmp(&b.0)));
    sorted.iter().map(|(what, (times, by))| format!("{what} x{times} ({by:.1})")).collect::<Vec<_>>().join(", ")
}

fn short(value: f64) -> String {
    match value.abs() {
        0.0..10.0 => format!("{value:.2}"),
        10.0..100.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

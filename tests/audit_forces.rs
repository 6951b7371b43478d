//! The audit's contacts, centre of mass and zero-moment point against force plates (Rajagopal et al. 2016, `forces/` of the lab data).
//!
//! The file of forces has the GLB's axes and metres, so clip space is its space. Both feet are on plates in every frame.

#![allow(dead_code)] // the benchmark and the tests each use their part

use glam::{DVec2, DVec3, dvec3};
use std::path::Path;
use surefoot::audit::balance::balance;
use surefoot::audit::contacts::footfalls;
use surefoot::audit::placement::median;
use surefoot::audit::track::Track;
use surefoot::measure::GRAVITY;
use surefoot::mocap::{Options, load};
use surefoot::model::Side;

/// kg, of the person on the plates.
const MASS: f64 = 85.1;
/// N: a plate that bears more is stood on.
const BEARS: f64 = 20.0;
/// s at either end that a filter knows less of.
const ENDS: f64 = 0.1;

/// What the two say of each other.
#[derive(Clone, Debug)]
pub struct Compared {
    /// s, signed: our touchdowns less the plates'.
    pub touch_downs: Vec<f64>,
    /// s, signed: our lift-offs less the plates'.
    pub lift_offs: Vec<f64>,
    /// Body weights, RMS.
    pub force: f64,
    /// m, RMS in single support.
    pub zmp: f64,
    /// m, RMS: our centre of mass less the model's own.
    pub com: f64,
}

struct Plate {
    force: [DVec3; 2],
    pressure: [DVec3; 2],
    com: DVec3,
}

fn plates(text: &str) -> Vec<Plate> {
    let row = |line: &str| {
        let n: Vec<f64> = line.split(',').map(|field| field.trim().parse().expect("a number")).collect();
        let at = |i: usize| dvec3(n[i], n[i + 1], n[i + 2]);
        Plate { force: [at(1), at(7)], pressure: [at(4), at(10)], com: at(15) }
    };
    text.lines().skip(1).filter(|line| !line.is_empty()).map(row).collect()
}

/// `None` without the data.
pub fn measured(data: &Path) -> Option<Compared> {
    let text = std::fs::read_to_string(data.join("forces/rajagopal_walk_forces.csv")).ok()?;
    let plates = plates(&text);
    let file = load(&data.join("forces/rajagopal_walk.glb")).ok()?;
    let capture = file.capture(0, &Options::default()).ok()?;
    let track = Track::new(&capture);
    let feet = footfalls(&track);
    let frames = track.len().min(plates.len());
    let hz = capture.fps;
    // Where a series crosses the threshold, in frames and a fraction, upwards or downwards.
    let crossings = |side: Side, up: bool| -> Vec<f64> {
        let force = |frame: usize| plates[frame].force[side as usize].y - BEARS;
        (1..frames)
            .filter(|frame| {
                if up {
                    force(*frame) > 0.0 && force(*frame - 1) <= 0.0
                } else {
                    force(*frame) <= 0.0 && force(*frame - 1) > 0.0
                }
            })
            .map(|frame| frame as f64 - force(frame) / (force(frame) - force(frame - 1)))
            .collect()
    };
    let (mut touch_downs, mut lift_offs) = (Vec::new(), Vec::new());
    for side in Side::BOTH {
        let own = || feet.contacts.iter().filter(move |contact| contact.side == side);
        let nearest = |at: f64, list: Vec<f64>| {
            list.into_iter()
                .map(|other| (other - at) / hz)
                .min_by(|a, b| a.abs().total_cmp(&b.abs()))
                .unwrap_or(f64::INFINITY)
        };
        for at in crossings(side, true) {
            touch_downs
                .push(nearest(at, own().filter(|contact| !contact.cut.0).map(|contact| contact.touch_down).collect()));
        }
        for at in crossings(side, false) {
            lift_offs
                .push(nearest(at, own().filter(|contact| !contact.cut.1).map(|contact| contact.lift_off).collect()));
        }
    }
    let end = (ENDS * hz).round() as usize;
    let inner = end..frames - end;
    let rms =
        |values: Vec<f64>| (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt();
    let needed = |frame: usize| (track.acceleration[frame] + DVec3::Y * GRAVITY) / GRAVITY;
    let pushed = |frame: usize| (plates[frame].force[0] + plates[frame].force[1]) / (MASS * GRAVITY);
    let force = rms(inner.clone().map(|frame| needed(frame).distance(pushed(frame))).collect());
    let com = rms(inner.clone().map(|frame| track.com[frame].distance(plates[frame].com)).collect());
    let balance = balance(&track, &feet);
    let misses = |frame: usize| -> Option<f64> {
        let bears = |side: Side| plates[frame].force[side as usize].y > BEARS;
        let stance = match (bears(Side::Left), bears(Side::Right)) {
            (true, false) => Side::Left,
            (false, true) => Side::Right,
            _ => return None,
        };
        let pressure = plates[frame].pressure[stance as usize];
        Some(balance[frame]?.zmp.distance(DVec2::new(pressure.x, pressure.z)))
    };
    let zmp = rms(inner.filter_map(misses).collect());
    Some(Compared { touch_downs, lift_offs, force, zmp, com })
}

/// As lines of the table.
pub fn compare(data: &Path) -> Option<Vec<String>> {
    let found = measured(data)?;
    let told = |errors: &[f64]| {
        let list: Vec<String> = errors.iter().map(|error| format!("{:+.0}", 1000.0 * error)).collect();
        format!("{:.0} ms of 20 ({})", 1000.0 * median_size(errors), list.join(", "))
    };
    Some(vec![
        format!("touchdown, median error        {}", told(&found.touch_downs)),
        format!("lift-off, median error         {}", told(&found.lift_offs)),
        format!("force from acceleration, RMS   {:.3} body weights of 0.15", found.force),
        format!("ZMP in single support, RMS     {:.1} cm of 4", 100.0 * found.zmp),
        format!("centre of mass, RMS            {:.1} cm", 100.0 * found.com),
    ])
}

/// The median of their sizes.
pub fn median_size(errors: &[f64]) -> f64 {
    let sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    median(&sizes)
}

//! What a clip does frame by frame, as the table of an audit and its page show it: centre of mass, ξ, ZMP, margin, contacts, soles.
//!
//! Clip space (metres, Y up), s. The ZMP is the audit's; the margin is the distance from ξ to the edge of
//! the soles that bear, positive inside. Soles are the outline of heel, ball and tip. Judges nothing.

use crate::audit::balance::{Balance, balance};
use crate::audit::contacts::{Footfalls, footfalls};
use crate::audit::track::{Track, without_pose};
use crate::maths::hull::{convex_hull, signed_distance};
use crate::maths::pendulum;
use crate::model::findings::Findings;
use crate::model::{Capture, Side};
use glam::{DVec2, DVec3};

/// A frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameRow {
    /// From 0.
    pub frame: usize,
    /// s.
    pub time: f64,
    /// m.
    pub com: DVec3,
    /// m/s, of the centre of mass.
    pub speed: f64,
    /// m, (x, z).
    pub xi: DVec2,
    /// m, (x, z); none in flight.
    pub zmp: Option<DVec2>,
    /// m from ξ to the edge of the support, positive inside; none in flight.
    pub margin: Option<f64>,
    /// Left and right: "heel", "ball", "flat", where the foot bears.
    pub parts: [Option<&'static str>; 2],
    /// m, left and right: the sole's lowest point over the ground under it.
    pub soles: [f64; 2],
    /// m: the ground.
    pub floor: f64,
    /// m, left and right: heel, ball and tip of the sole.
    pub outlines: [[DVec3; 3]; 2],
}

/// Every frame of a capture with its findings.
pub fn frame_rows(capture: &Capture, findings: &Findings) -> Vec<FrameRow> {
    if capture.frames() == 0 {
        return Vec::new();
    }
    let (held, _) = without_pose(capture);
    let track = Track::new(held.as_ref().unwrap_or(capture));
    let feet = footfalls(&track);
    let mut parts: [Vec<Option<&'static str>>; 2] = [vec![None; track.len()], vec![None; track.len()]];
    for contact in &findings.contacts {
        let end = contact.end.min(track.len() - 1);
        if contact.start <= end {
            parts[usize::from(contact.foot == "right")][contact.start..=end].fill(Some(contact.part));
        }
    }
    let balance = balance(&track, &feet);
    (0..track.len())
        .map(|frame| row(&track, &feet, [parts[0][frame], parts[1][frame]], balance[frame], frame))
        .collect()
}

fn row(
    track: &Track,
    feet: &Footfalls,
    parts: [Option<&'static str>; 2],
    balance: Option<Balance>,
    frame: usize,
) -> FrameRow {
    let (com, velocity) = (track.com[frame], track.velocity[frame]);
    let floor = feet.floor_at(frame, track.below(frame));
    let flat = |v: DVec3| DVec2::new(v.x, v.z);
    let xi = pendulum::extrapolated(flat(com), flat(velocity), track.omega(frame, floor));
    let mut corners: Vec<DVec2> = Vec::new();
    for side in Side::BOTH {
        if let Some(part) = parts[side as usize] {
            corners.extend(sole_corners(track, side, part, frame));
        }
    }
    let hull = convex_hull(&corners);
    let bears = !hull.is_empty();
    let outlines = Side::BOTH.map(|side| track.feet[side as usize].points[frame]);
    FrameRow {
        frame,
        time: frame as f64 / track.capture.fps,
        com,
        speed: velocity.length(),
        xi,
        zmp: balance.map(|found| found.zmp),
        margin: bears.then(|| -signed_distance(&hull, xi)),
        parts,
        soles: Side::BOTH.map(|side| {
            let foot = &track.feet[side as usize];
            foot.low[frame] - feet.under(side, frame, foot.place(frame))
        }),
        floor,
        outlines,
    }
}

/// m, (x, z): the corners of the part of a sole that bears.
fn sole_corners(track: &Track, side: Side, part: &str, frame: usize) -> Vec<DVec2> {
    let [heel, ball, tip] = track.feet[side as usize].points[frame].map(|point| DVec2::new(point.x, point.z));
    let across =
        (tip - heel).try_normalize().unwrap_or(DVec2::Y).perp() * track.capture.body.feet[side as usize].half_width;
    let middle = match part {
        "heel" => vec![heel, heel.lerp(tip, 1.0 / 3.0)],
        "ball" => vec![ball, tip],
        _ => vec![heel, ball, tip],
    };
    middle.into_iter().flat_map(|point| [point - across, point + across]).collect()
}

//! What the target's feet shall do: turned as the source's and, where those bear, held on the ground without sliding.
//!
//! Clip space, m, rad; the target's floor is y = 0. Every foot keeps the height of its lowest point over the floor, scaled. In a stance
//! the flat sole lies level and still, the toes stay where the ball bears, the ankle goes as the foot rolls over heel and ball. What a
//! stance changes is carried out of it and into the next as an offset that dies away with its own speed. Moves no legs.

use super::retarget_planted::{Planted, SWIVELS, Sole, SourceFeet, Stance};
use super::retarget_turns::rest_frames;
use crate::maths::quat::{rotation_vector, yaw_of};
use crate::maths::real;
use crate::model::report::Part;
use crate::model::{Body, Capture, Side};
use glam::{DQuat, DVec3};

/// s, at a leg of 0.83 m: how long an offset lasts before and after a stance.
const BLEND: f64 = 0.15;
/// Of the source's leg: a foot that is higher over the ground may be pitched as it likes.
const NEAR: f64 = 0.18;
/// m at a leg of 0.83 m: a foot lower than that over the ground is placed by its sole, one over the second swings as its leg does.
const FREE: (f64, f64) = (0.02, 0.1);
/// Of the source's clearance: a swinging foot keeps that much at least.
const SHARE: f64 = 0.3;
/// Of the leg: over so much a swing's height goes over to its least.
const SOFT: f64 = 0.03;
/// rad: a sole that is tilted more than that while it stands flat stands on something else.
const TILTED: f64 = 0.26;

/// What one foot shall do, frame by frame.
#[derive(Clone, Debug)]
pub(super) struct FootPlan {
    /// Foot and toes.
    pub turns: Vec<[DQuat; 2]>,
    /// m: the ankle's height.
    pub height: Vec<f64>,
    /// 1 in a stance, 0 far from one.
    pub bears: Vec<f64>,
    /// (frames) how much a swing is the leg's own matter: 1 well over the ground; and m, how low its ankle may come then.
    free: Vec<(f64, f64)>,
    spans: Vec<(usize, usize)>,
    ways: Vec<Vec<DVec3>>,
    blend: usize,
    soft: f64,
}

impl FootPlan {
    /// Plans one foot. `raw`: (frames) the target's turns of foot and toes as the source has them.
    pub fn new(capture: &Capture, body: &Body, side: Side, raw: &[[DQuat; 2]], source: &SourceFeet) -> FootPlan {
        let sole = Sole::of(body, side);
        let (scale, fps) = (body.leg_length / capture.body.leg_length.max(1e-6), capture.fps);
        let stances: Vec<&Stance> = source.stances.iter().filter(|stance| stance.planted.side == side).collect();
        let spans: Vec<(usize, usize)> =
            stances.iter().map(|stance| (stance.planted.start, stance.planted.end)).collect();
        let tempo = (body.leg_length / 0.83).max(0.01).sqrt();
        let blend = ((BLEND * tempo * fps).round() as usize).max(2);
        let turns = if body.joints[body.feet[side as usize].ankle].animated {
            let raw = gentler(&capture.body, body, side, raw, &source.clearance[side as usize]);
            held_turns(body, side, &raw, &stances, blend)
        } else {
            raw.to_vec()
        };
        let ways = stances
            .iter()
            .map(|stance| {
                let Planted { start, end, .. } = stance.planted;
                let feet: Vec<DQuat> = turns[start..=end].iter().map(|turn| turn[0]).collect();
                sole.roll(&feet, &stance.parts)
            })
            .collect();
        // The lowest point over the floor: as the source's, but exactly on the ground in a stance.
        let least = stances.iter().map(|stance| stance.height).fold(0.0, f64::min);
        let own: Vec<f64> = (source.clearance[side as usize].iter().zip(&turns))
            .map(|(over, turn)| scale * over.max(least) - sole.lowest(turn[0], turn[1]))
            .collect();
        let offsets: Vec<Vec<DVec3>> = stances
            .iter()
            .map(|stance| {
                let frames = (stance.planted.start..=stance.planted.end).zip(&stance.parts);
                let stands = |frame: usize, part: Part| {
                    scale * stance.height + sole.standing(part, turns[frame][0], turns[frame][1])
                };
                frames.map(|(frame, part)| DVec3::Y * (stands(frame, *part) - own[frame])).collect()
            })
            .collect();
        let lifted = carried(raw.len(), &spans, &offsets, blend);
        let bears = bearing(raw.len(), &spans, blend);
        let height = (0..raw.len())
            .map(|frame| {
                let lowest = scale * least - sole.lowest(turns[frame][0], turns[frame][1]);
                let height = own[frame] + lifted[frame].y;
                if bears[frame] < 1.0 { height.max(lowest) } else { height }
            })
            .collect();
        let free = (source.clearance[side as usize].iter().zip(&turns).zip(&bears))
            .map(|((over, turn), bears)| {
                let size = capture.body.leg_length / 0.83;
                let u = ((over / size - FREE.0) / (FREE.1 - FREE.0)).clamp(0.0, 1.0);
                let least = scale * (least + SHARE * (over - least).max(0.0));
                (u * u * (3.0 - 2.0 * u) * (1.0 - bears), least - sole.lowest(turn[0], turn[1]))
            })
            .collect();
        FootPlan { turns, height, bears, free, spans, ways, blend, soft: SOFT * body.leg_length }
    }

    /// m, (frames) where the ankle shall be: at its height, well over the ground and level where it would come by itself, held in stances.
    pub fn ankles(&self, own: &[DVec3]) -> Vec<DVec3> {
        let offsets: Vec<Vec<DVec3>> = self
            .spans
            .iter()
            .zip(&self.ways)
            .map(|((start, end), way)| {
                // Where it stands is where that costs least: at the mean.
                let beside = |frame: usize| way[frame - start] - own[frame];
                let mean = (*start..=*end).map(beside).sum::<DVec3>() / (end - start + 1) as f64;
                (*start..=*end).map(|frame| (beside(frame) - mean) * DVec3::new(1.0, 0.0, 1.0)).collect()
            })
            .collect();
        let offsets = carried(own.len(), &self.spans, &offsets, self.blend);
        own.iter()
            .zip(offsets)
            .enumerate()
            .map(|(frame, (own, offset))| {
                let (height, (free, least)) = (self.height[frame], self.free[frame]);
                let swung = greater(own.y, least, self.soft);
                DVec3::new(own.x + offset.x, height + (swung - height) * free, own.z + offset.z)
            })
            .collect()
    }
}

/// The greater of two, without a corner.
fn greater(one: f64, other: f64, soft: f64) -> f64 {
    let near = (soft - (one - other).abs()).max(0.0);
    one.max(other) + near * near / (4.0 * soft.max(1e-9))
}

/// Feet that are longer for their legs than the source's are pitched less near the ground: else a step would lift a short leg's ankle to its knee.
fn gentler(source: &Body, body: &Body, side: Side, raw: &[[DQuat; 2]], clearance: &[f64]) -> Vec<[DQuat; 2]> {
    let length = |body: &Body| {
        let foot = &body.feet[side as usize];
        (foot.tip - foot.heel) / body.leg_length.max(1e-6)
    };
    let longer = length(body) / length(source).max(1e-6);
    if longer < 1.0 + 1e-6 {
        return raw.to_vec();
    }
    let frame = rest_frames(body)[body.feet[side as usize].ankle];
    let near = NEAR * source.leg_length;
    raw.iter()
        .zip(clearance)
        .map(|([foot, toes], over)| {
            let own = *foot * frame;
            let pitch = real::asin((own * DVec3::Z).y.clamp(-1.0, 1.0));
            let gentle = real::asin(real::sin(pitch) / longer);
            let share = real::exp(-(over.max(0.0) / near).powi(2));
            let back = DQuat::from_axis_angle(own * DVec3::X, (pitch - gentle) * share);
            [(back * *foot).normalize(), (back * *toes).normalize()]
        })
        .collect()
}

/// Turns of foot and toes: level and still where the sole is flat, the toes also where the ball bears.
fn held_turns(body: &Body, side: Side, raw: &[[DQuat; 2]], stances: &[&Stance], blend: usize) -> Vec<[DQuat; 2]> {
    let shape = &body.feet[side as usize];
    let rest = rest_frames(body);
    let frames = [rest[shape.ankle], shape.toe.map_or(rest[shape.ankle], |toe| rest[toe])];
    let mut turns = raw.to_vec();
    for part in [0, 1] {
        let mut spans = Vec::new();
        let mut offsets = Vec::new();
        for stance in stances {
            let held = |of: &Part| *of == Part::Flat || (part == 1 && *of == Part::Ball);
            for (from, to) in runs(&stance.parts, held) {
                let (start, end) = (stance.planted.start + from, stance.planted.start + to);
                // Toes that lie with a flat foot point where it does.
                let of = if part == 1 && stance.parts[from..=to].contains(&Part::Flat) { 0 } else { part };
                let own: Vec<DQuat> = (start..=end).map(|frame| raw[frame][of] * frames[of]).collect();
                let Some(level) = level(&own, &stance.parts[from..=to], of) else { continue };
                spans.push((start, end));
                offsets.push(
                    (start..=end)
                        .zip(level)
                        .map(|(frame, level)| {
                            rotation_vector(level * frames[part].inverse() * raw[frame][part].inverse())
                        })
                        .collect::<Vec<DVec3>>(),
                );
            }
        }
        let offsets = carried(raw.len(), &spans, &offsets, blend);
        for (turn, offset) in turns.iter_mut().zip(offsets) {
            turn[part] = (DQuat::from_scaled_axis(offset) * turn[part]).normalize();
        }
    }
    turns
}

/// The level frames of a foot that bears: one heading for all, unless it turns on the spot. `None` for one that stands on an edge.
fn level(own: &[DQuat], parts: &[Part], of: usize) -> Option<Vec<DQuat>> {
    let flat = |at: &usize| of == 1 || parts[*at] == Part::Flat;
    let counted: Vec<usize> = (0..own.len()).filter(flat).collect();
    let first = yaw_of(own[*counted.first()?]);
    let yaws: Vec<f64> = own.iter().map(|turn| crate::maths::quat::wrap_angle(yaw_of(*turn) - first)).collect();
    let mean = |values: &dyn Fn(usize) -> f64| counted.iter().map(|at| values(*at)).sum::<f64>() / counted.len() as f64;
    if of == 0 && mean(&|at| (own[at] * DVec3::Y).angle_between(DVec3::Y)) > TILTED {
        return None;
    }
    let (low, high) =
        counted.iter().fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(yaws[*at]), high.max(yaws[*at])));
    let still = high - low < SWIVELS;
    let middle = mean(&|at| yaws[at]);
    Some(yaws.iter().map(|yaw| DQuat::from_rotation_y(first + if still { middle } else { *yaw })).collect())
}

/// Runs of what is held, as (first, last).
fn runs(parts: &[Part], held: impl Fn(&Part) -> bool) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for (at, part) in parts.iter().enumerate() {
        match found.last_mut() {
            Some(last) if held(part) && last.1 + 1 == at => last.1 = at,
            _ if held(part) => found.push((at, at)),
            _ => {}
        }
    }
    found
}

/// (frames) an offset that is given in spans, carried out of each and into the next: it dies away over `blend` frames from the speed that
/// it has, or goes over to the next one where that is near.
fn carried(frames: usize, spans: &[(usize, usize)], offsets: &[Vec<DVec3>], blend: usize) -> Vec<DVec3> {
    let mut out = vec![DVec3::ZERO; frames];
    let speed = |offsets: &[DVec3], at_end: bool| {
        let last = offsets.len() - 1;
        let steps = last.min(2);
        if steps == 0 {
            return DVec3::ZERO;
        }
        let step = if at_end { offsets[last] - offsets[last - steps] } else { offsets[steps] - offsets[0] };
        step / steps as f64
    };
    let mut curve = |from: (usize, DVec3, DVec3), to: (usize, DVec3, DVec3)| {
        let length = (to.0 - from.0) as f64;
        // No speed may carry it farther off than it is.
        let bound = |speed: DVec3| speed.clamp_length_max(1.5 * from.1.distance(to.1) / length);
        let (start, end) = (bound(from.2) * length, bound(to.2) * length);
        let between = out.iter_mut().enumerate().take(to.0).skip(from.0 + 1);
        for (frame, out) in between {
            let u = (frame - from.0) as f64 / length;
            let (u2, u3) = (u * u, u * u * u);
            *out = from.1 * (2.0 * u3 - 3.0 * u2 + 1.0)
                + start * (u3 - 2.0 * u2 + u)
                + to.1 * (3.0 * u2 - 2.0 * u3)
                + end * (u3 - u2);
        }
    };
    let nothing = DVec3::ZERO;
    for (index, (start, end)) in spans.iter().enumerate() {
        let own = &offsets[index];
        let before = index.checked_sub(1).map(|before| spans[before].1);
        if before.is_none_or(|before| before + 2 * blend <= *start) {
            // What begins sooner than the blend can begins at full.
            let from = start.checked_sub(blend);
            match from {
                Some(from) => curve((from, nothing, nothing), (*start, own[0], speed(own, false))),
                None => curve((0, own[0], nothing), (*start, own[0], nothing)),
            }
        }
        let leaves = (*end, own[own.len() - 1], speed(own, true));
        match spans.get(index + 1) {
            Some((next, _)) if end + 2 * blend > *next => {
                let other = &offsets[index + 1];
                curve(leaves, (*next, other[0], speed(other, false)));
            }
            _ => curve(leaves, (end + blend, nothing, nothing)),
        }
    }
    for ((start, end), own) in spans.iter().zip(offsets) {
        out[*start..=*end].copy_from_slice(own);
        if *start > 0 && *start < blend && *start == spans[0].0 {
            out[..*start].fill(own[0]);
        }
    }
    out
}

/// 1 in stances, eased to 0 within the blend around them.
fn bearing(frames: usize, spans: &[(usize, usize)], blend: usize) -> Vec<f64> {
    (0..frames)
        .map(|frame| {
            let away = spans.iter().map(|(start, end)| start.saturating_sub(frame).max(frame.saturating_sub(*end)));
            let away = away.min().unwrap_or(usize::MAX).min(blend);
            let u = 1.0 - away as f64 / blend as f64;
            u * u * (3.0 - 2.0 * u)
        })
        .collect()
}

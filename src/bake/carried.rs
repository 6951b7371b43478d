//! The [[carry]] lane over a run: what the hands hold when, how heavy it is, what the stepper is told of it, the box to see.
//!
//! The hands come up in the 0.6 s before an entry starts; then the box is there, and its weight is taken over within 0.4 s.
//! At the end the same in reverse: the weight goes, the box is gone, the hands sink. A box that is carried from time 0 or to
//! the end of the scenario is simply held. Scenario space, SI.

use super::timeline::Timeline;
use crate::maths::curve::smooth3;
use crate::model::props::{Prop, PropKey, Shape};
use crate::model::scenario::{Carry, Scenario};
use crate::model::{Body, BodyPose, Load, Physique, load};
use crate::whole_body::{Anatomy, Grip, Hold, stand};
use glam::DVec3;

/// s, in which the hands come up or sink.
const HANDS: f64 = 0.6;
/// s, in which the weight is taken over or handed on.
const TAKE_OVER: f64 = 0.4;
/// s between points of the weight while it is.
const POINTS: f64 = 0.02;
/// Parts of the time between two sizes in which a grip is worked out: half a centimetre of palm beside a box that doubles.
const PIECES: usize = 8;
/// Masses between nothing and the greatest for which the stand is measured; lines between.
const MEASURED: usize = 8;
/// Linear RGB of the box.
const CARDBOARD: [f32; 3] = [0.45, 0.28, 0.13];

/// One entry of the lane.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    grips: Vec<(f64, Grip)>, // (s, how the box of then is held), never none
    hands: [f64; 4],         // s: they start up, are at the box, start down, are down
}

/// The entries of a scenario, and the loads that they are.
pub fn carried(body: &Body, anatomy: &Anatomy, scenario: &Scenario) -> (Vec<Carried>, Vec<Load>) {
    scenario.carry.iter().map(|carry| one(body, anatomy, carry, scenario.duration)).unzip()
}

fn one(body: &Body, anatomy: &Anatomy, carry: &Carry, duration: f64) -> (Carried, Load) {
    let start = carry.start;
    let put_down = carry.end.filter(|end| *end < duration - 1e-6);
    let end = put_down.unwrap_or(f64::INFINITY);
    let take_over = TAKE_OVER.min(0.5 * (end - start));
    let share = |time: f64| {
        let taken = if start > 0.0 { smooth3((time - start) / take_over) } else { 1.0 };
        let left = if put_down.is_some() { smooth3((end - time) / take_over) } else { 1.0 };
        taken * left
    };
    let last = put_down.unwrap_or(duration);
    let mut times: Vec<f64> = carry.mass.iter().map(|point| point[0]).filter(|at| *at > start && *at < last).collect();
    for point in 0..=(take_over / POINTS).ceil() as usize {
        let into = (POINTS * point as f64).min(take_over);
        times.extend([start + into, last - into]);
    }
    times.retain(|time| *time >= start && *time <= last);
    times.sort_by(f64::total_cmp);
    times.dedup_by(|later, earlier| *later - *earlier < 1e-9);
    let mass = times.iter().map(|time| [*time, load::along(&carry.mass, *time) * share(*time)]).collect();
    let heaviest = carry.mass.iter().map(|point| point[1]).fold(0.0, f64::max);
    let deepest = carry.size.iter().map(|(_, size)| size.z).fold(0.0, f64::max);
    let grip = |time: f64| (time, Grip::new(body, anatomy, carry.size_at(time), (heaviest, deepest)));
    let grips: Vec<(f64, Grip)> = changes(carry).into_iter().map(grip).collect();
    let forms = grips.iter().map(|(time, grip)| grip.form(*time)).collect();
    let load = grips[0].1.load(forms, mass, [start, end]);
    let up = if start > 0.0 { (start - HANDS).max(0.0) } else { f64::NEG_INFINITY };
    (Carried { grips, hands: [up, start, end, end + HANDS] }, load)
}

/// s, the times at which the grip is worked out: the points of the size, and between two that differ as often as arms need that turn
/// along with it. Never none.
fn changes(carry: &Carry) -> Vec<f64> {
    let mut times = vec![carry.size.first().map_or(0.0, |point| point.0)];
    for pair in carry.size.windows(2) {
        let ([from, to], pieces) = ([pair[0].0, pair[1].0], if pair[0].1 == pair[1].1 { 1 } else { PIECES });
        times.extend((1..=pieces).map(|piece| from + (to - from) * piece as f64 / pieces as f64));
    }
    times
}

impl Carried {
    /// s, when the hands first move for it; `None` where they hold it from the start.
    pub fn begins(&self) -> Option<f64> {
        self.hands[0].is_finite().then_some(self.hands[0])
    }

    /// How the box of a time is held.
    fn grip(&self, time: f64) -> Grip {
        let after = self.grips.partition_point(|(at, _)| *at <= time);
        match (after.checked_sub(1).map(|before| &self.grips[before]), self.grips.get(after)) {
            (Some((from, one)), Some((to, next))) => one.towards(next, (time - from) / (to - from).max(1e-9)),
            (Some((_, only)), None) | (None, Some((_, only))) => only.clone(),
            (None, None) => self.grips[0].1.clone(),
        }
    }

    fn arms(&self, time: f64) -> f64 {
        let [up, at, down, gone] = self.hands;
        if time >= at && time <= down {
            1.0
        } else if time < at {
            smooth3((time - up) / (at - up))
        } else {
            smooth3((gone - time) / (gone - down))
        }
    }
}

/// What the hands do at a time.
pub fn hold(carried: &[Carried], loads: &[Load], time: f64) -> Option<Hold> {
    let each = carried.iter().zip(loads).map(|(carried, load)| (carried, load, carried.arms(time)));
    let (carried, load, arms) = each.max_by(|a, b| a.2.total_cmp(&b.2)).filter(|(.., arms)| *arms > 0.0)?;
    Some(carried.grip(time).hold(load.mass_at(time), arms))
}

/// The stand with growing masses, at each time of a grip (s).
type Measured = Vec<(f64, Vec<Physique>)>;

/// The measures of the body with what it holds, tick by tick; none where it never holds anything.
pub fn physiques(
    body: &Body,
    anatomy: &Anatomy,
    (carried, loads): (&[Carried], &[Load]),
    dt: f64,
    ticks: usize,
) -> Vec<Physique> {
    if carried.is_empty() {
        return Vec::new();
    }
    let base = stand::physique(body, anatomy);
    // For each entry its greatest mass, and for each grip's time a row of masses.
    let tables: Vec<(f64, Measured)> = carried
        .iter()
        .zip(loads)
        .map(|(carried, load)| {
            let most = load.mass.iter().map(|point| point[1]).fold(1e-3, f64::max);
            let of = |grip: &Grip, index: usize| {
                let mass = most * index as f64 / MEASURED as f64;
                stand::physique_holding(body, anatomy, Some(grip.hold(mass, 1.0)))
            };
            let row = |(time, grip): &(f64, Grip)| (*time, (0..=MEASURED).map(|index| of(grip, index)).collect());
            (most, carried.grips.iter().map(row).collect())
        })
        .collect();
    let at = |time: f64| {
        let mut physique = base;
        for ((carried, load), (most, rows)) in carried.iter().zip(loads).zip(&tables) {
            let (arms, mass) = (carried.arms(time), load.mass_at(time));
            let place = (mass / most * MEASURED as f64).clamp(0.0, MEASURED as f64);
            let from = (place as usize).min(MEASURED - 1);
            let between = |value: fn(&Physique) -> f64| {
                let of = |table: &[Physique]| {
                    value(&table[from]) + (value(&table[from + 1]) - value(&table[from])) * (place - from as f64)
                };
                let held: Vec<[f64; 2]> = rows.iter().map(|(at, table)| [*at, of(table)]).collect();
                (load::along(&held, time) - value(&base)) * arms
            };
            physique.mass += mass;
            physique.com_height += between(|physique| physique.com_height);
            physique.hip_height += between(|physique| physique.hip_height);
        }
        physique
    };
    (0..ticks).map(|tick| at(tick as f64 * dt)).collect()
}

/// The boxes as things to see: there while they are held.
pub fn props(timeline: &Timeline) -> Vec<Prop> {
    boxes(&timeline.body, &timeline.loads, timeline.duration(), &|time| timeline.pose_at(time))
}

/// The same of any motion, s long.
pub fn boxes(body: &Body, loads: &[Load], duration: f64, pose_at: &dyn Fn(f64) -> BodyPose) -> Vec<Prop> {
    let frames = (duration * 30.0).ceil().max(1.0) as usize;
    let name = |index: usize| if loads.len() == 1 { "box".to_owned() } else { format!("box_{}", index + 1) };
    let one = |(index, load): (usize, &Load)| {
        let mut times: Vec<f64> = (0..=frames).map(|frame| duration * frame as f64 / frames as f64).collect();
        times.extend(load.forms.iter().map(|form| form.time).filter(|time| *time > 0.0 && *time < duration));
        times.extend(load.span.iter().copied().filter(|edge| *edge > 0.0 && *edge < duration));
        times.sort_by(f64::total_cmp);
        times.dedup_by(|later, earlier| *later - *earlier < 1e-6);
        let first = load.form_at(load.span[0].max(0.0)).size;
        let mut keys: Vec<PropKey> = Vec::with_capacity(times.len());
        for time in times.into_iter().filter(|time| *time >= load.span[0] && *time <= load.span[1]) {
            let pose = pose_at(time);
            let positions = pose.positions(body);
            keys.push(PropKey {
                time,
                translation: load.centre_in(&pose, &positions, time),
                rotation: (pose.turns[load.joint] * load.level).normalize(),
                scale: load.form_at(time).size / first,
            });
        }
        hide_beyond(&mut keys, duration);
        Prop { keys, ..Prop::standing(&name(index), Shape::Box(first), CARDBOARD) }
    };
    loads.iter().enumerate().map(one).filter(|prop| !prop.keys.is_empty()).collect()
}

/// Hides a thing before its first key and after its last, where the clip goes on there.
pub fn hide_beyond(keys: &mut Vec<PropKey>, duration: f64) {
    let gone = |key: &PropKey, time: f64| PropKey { time, scale: DVec3::ZERO, ..*key };
    if let Some(first) = keys.first().copied().filter(|first| first.time > 2e-3) {
        keys.insert(0, gone(&first, first.time - 1e-3));
    }
    if let Some(last) = keys.last().copied().filter(|last| last.time < duration - 2e-3) {
        keys.push(gone(&last, last.time + 1e-3));
    }
}

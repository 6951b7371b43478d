//! Heels that come up for ankles: a foot in contact stands on its ball where its ankle would bend past its range.
//!
//! Up a steep slope, deep in a crouch and on stairs nobody's shank leans as far over a flat foot as a straight way of the body would
//! have it: the heel leaves the ground, and the toes bend. Beside the roll that a step has (`swing`) each foot has a series of such
//! turns about its ball, never below 0, by the least acceleration that keeps the ankle's flexion within its range. Where the
//! series is 0 the foot is as it is without. Scenario space, radians, seconds.

use super::ankles::{Bound, fitted};
use super::timeline::Timeline;
use crate::maths::curve::bump;
use crate::measure::joints::LegAngles;
use crate::model::Side;
use crate::whole_body::solve::Solved;

/// rad, by which flexion stays inside of its range: the passes after the last fit move legs by a degree.
const MARGIN: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// rad, how far a heel comes up at most, with the roll that it has anyway: toes bend by 60 degrees.
pub(super) const MOST_PITCH: f64 = 54.0 * std::f64::consts::PI / 180.0;
/// rad, the same of a foot in the midst of its way through the air, whose toes turn with it from there on: as high as it is.
const ALOFT: f64 = 85.0 * std::f64::consts::PI / 180.0;
/// rad, a heel this low is down: 1 mm under a foot of 0.19 m from heel to ball.
const DOWN: f64 = 0.3 * std::f64::consts::PI / 180.0;
/// Entries after a heel's strike has settled in which its ankle is looked at.
const SEEN: usize = 2;
/// s, the end of a clip in which a heel's rise for the next step is not known: what a stride's takes.
const UNKNOWN: f64 = 0.42;
/// How much slower than a foot in the air one turns that carries.
const SLOWER: f64 = 1.3;

/// Fits the heels of both feet afresh to the poses that the present ones gave; whether any is up. `scale`: times relative to the
/// reference body.
pub(super) fn raise(timeline: &mut Timeline, legs: &LegAngles, solved: &[Solved], scale: f64) -> bool {
    let dt = timeline.dt;
    let mut any = false;
    let first = (timeline.still_until / dt).round() as usize;
    // The lift that a heel rises for may lie behind the end of a clip that ends in the midst of a walk.
    let ends = timeline.walking.last().is_some_and(|walking| *walking > 0.0);
    let known = if ends { solved.len().saturating_sub((UNKNOWN * scale / dt) as usize) } else { solved.len() };
    for side in Side::BOTH {
        let [least, most] = legs.ranges(side)[2];
        let path = &mut timeline.feet.feet[side as usize];
        // A heel does not strike that must be up as soon as the weight is on it.
        for swing in path.swings.iter_mut().filter(|swing| swing.strike < 0.0) {
            let last = ((swing.land + swing.settle) / dt).ceil() as usize + SEEN;
            let strained = |index: usize| legs.at(&solved[index].pose, side).is_some_and(|angles| angles[2] > most);
            if ((swing.land / dt) as usize..=last).any(|index| index < solved.len() && strained(index)) {
                swing.strike = 0.0;
                any = true;
            }
        }
        let mut bounds: Vec<Bound> = (0..solved.len())
            .map(|index| {
                let time = index as f64 * dt;
                let room = path.heel_room(time, dt).map_or([0.0; 2], |pitch| match pitch {
                    Some(pitch) => [0.0, (MOST_PITCH - pitch).max(0.0)],
                    None => {
                        let (pitch, u) = path.aloft(time);
                        [0.0, (MOST_PITCH + (ALOFT - MOST_PITCH) * bump(u).sqrt() - pitch).max(0.0)]
                    }
                });
                let Some(angles) = legs.at(&solved[index].pose, side) else { return Bound { room, wanted: room } };
                let bare = angles[2] + path.raised.at(time);
                let wanted = [bare - most + MARGIN + DOWN, bare - least].map(|end| end.clamp(room[0], room[1]));
                Bound { room, wanted: if index < known { wanted } else { [0.0, room[1]] } }
            })
            .collect();
        // As it stands when nobody has disturbed it yet.
        if let Some(standing) = bounds.first().map(|bound| bound.wanted[0]) {
            for bound in bounds.iter_mut().take(first + 1) {
                *bound = Bound { room: [standing; 2], wanted: [standing; 2] };
            }
        }
        let turns: Vec<f64> = fitted(&bounds, SLOWER * scale / dt).iter().map(|turn| (turn - DOWN).max(0.0)).collect();
        let up = turns.iter().any(|turn| *turn > 0.0);
        any |= up || path.raised.is_up();
        path.raised.set(if up { turns } else { Vec::new() }, dt);
    }
    if any {
        timeline.feet.clear_the_ground();
    }
    any
}

/// How far beside its roll a heel is up: a series, and nothing where it is empty.
#[derive(Clone, Debug, Default)]
pub(super) struct Heel {
    turns: Vec<f64>, // rad
    dt: f64,         // s
}

impl Heel {
    fn set(&mut self, turns: Vec<f64>, dt: f64) {
        (self.turns, self.dt) = (turns, dt);
    }

    pub(super) fn is_up(&self) -> bool {
        !self.turns.is_empty()
    }

    /// rad.
    pub(super) fn at(&self, time: f64) -> f64 {
        if self.turns.is_empty() { 0.0 } else { crate::maths::curve::sample(&self.turns, self.dt, time).max(0.0) }
    }

    /// s, the spans within `from` and `to` in which the heel is up, in order.
    pub(super) fn spans(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let mut spans: Vec<[f64; 2]> = Vec::new();
        let to = to.max(from);
        for index in 0..self.turns.len() {
            if self.turns[index] <= 0.0 {
                continue;
            }
            // The cubic between the entries may begin an entry before.
            let (start, end) = ((index as f64 - 1.0) * self.dt, (index as f64 + 1.0) * self.dt);
            let (start, end) = (start.clamp(from, to), end.clamp(from, to));
            match spans.last_mut() {
                Some(last) if start <= last[1] => last[1] = last[1].max(end),
                _ if end > start => spans.push([start, end]),
                _ => {}
            }
        }
        spans
    }
}

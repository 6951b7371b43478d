//! What a run is told: the ground, the disturbances, and the lanes of intent as the controller's inputs at a time.
//!
//! Scenario space, SI units. A lane's entry holds from its start until the next one's, or for its duration.

use super::session::SessionPush;
use crate::maths::real;
use crate::model::scenario::{Crouch, Feet, Scenario, Stand, Turn, Walk};
use crate::model::{Physique, Terrain};
use crate::stepper::Inputs;
use glam::DVec2;

/// A timeline for a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    /// What the character stands on.
    pub terrain: Terrain,
    /// What pushes it.
    pub pushes: Vec<SessionPush>,
    /// Where it means to walk.
    pub walk: Vec<Walk>,
    /// Where it means to turn.
    pub turn: Vec<Turn>,
    /// How low it means to go.
    pub crouch: Vec<Crouch>,
    /// What it means to stand on.
    pub stand: Vec<Stand>,
    /// 0..1, how low it goes where the lane says nothing.
    pub crouched: f64,
    /// Tick by tick, the measures of the body with what it carries; the last holds on. Empty: as the body stands.
    pub physiques: Vec<Physique>,
}

impl Script {
    /// Standing on flat ground, pushed.
    pub fn standing(pushes: &[SessionPush]) -> Script {
        Script {
            terrain: Terrain::flat(),
            pushes: pushes.to_vec(),
            walk: Vec::new(),
            turn: Vec::new(),
            crouch: Vec::new(),
            stand: Vec::new(),
            crouched: 0.0,
            physiques: Vec::new(),
        }
    }

    /// The ground and the lanes of intent of a scenario; its disturbances are forces on a body that the caller knows.
    pub fn of(scenario: &Scenario, pushes: Vec<SessionPush>) -> Script {
        Script {
            terrain: Terrain::new(&scenario.ground),
            pushes,
            walk: scenario.walk.clone(),
            turn: scenario.turn.clone(),
            crouch: scenario.crouch.clone(),
            stand: scenario.stand.clone(),
            crouched: scenario.character.crouch,
            physiques: Vec::new(),
        }
    }

    /// What is meant at a time, undisturbed.
    pub fn intent(&self, time: f64) -> Inputs {
        let walk = current(&self.walk, |walk| (walk.start, walk.duration), time);
        let facing = self.facing(time);
        Inputs {
            facing,
            walk: walk.map(|walk| DVec2::new(real::sin(walk.heading), real::cos(walk.heading)) * walk.speed),
            crouch: current(&self.crouch, |crouch| (crouch.start, crouch.duration), time)
                .map_or(self.crouched, |crouch| crouch.amount),
            stand: current(&self.stand, |stand| (stand.start, stand.duration), time)
                .map_or(Feet::Both, |stand| stand.on),
            ..Inputs::default()
        }
    }

    /// rad, where the pelvis is meant to point. The latest of the walk and turn lanes that spoke rules.
    fn facing(&self, time: f64) -> f64 {
        // Who stops goes on facing as before, unless told.
        let facings = self.walk.iter().filter(|walk| walk.speed != 0.0 || walk.facing.is_some());
        let spoken = facings
            .filter(|walk| walk.start <= time + 1e-9)
            .max_by(|a, b| a.start.total_cmp(&b.start))
            .map(|walk| (walk.start, walk.facing.unwrap_or(walk.heading)));
        let turned = last_begun(&self.turn, |turn| turn.start, time);
        match (spoken, turned) {
            (Some(walk), Some(turn)) if walk.0 > turn.start => walk.1,
            (_, Some(turn)) => self.turning(turn, time),
            (Some(walk), None) => walk.1,
            (None, None) => 0.0,
        }
    }

    /// rad, in the course of a turn that takes its duration, from what was meant before it.
    fn turning(&self, turn: &Turn, time: f64) -> f64 {
        let Some(duration) = turn.duration.filter(|&duration| time < turn.start + duration) else { return turn.facing };
        let earlier = turn.start - 1e-6;
        let walk = last_begun(&self.walk, |walk| walk.start, earlier - 1e-9);
        let before = last_begun(&self.turn, |turn| turn.start, earlier - 1e-9);
        let from = match (walk, before) {
            (Some(walk), Some(before)) if walk.start > before.start => walk.facing.unwrap_or(walk.heading),
            (_, Some(before)) => before.facing,
            (Some(walk), None) => walk.facing.unwrap_or(walk.heading),
            (None, None) => 0.0,
        };
        let share = ((time - turn.start) / duration).clamp(0.0, 1.0);
        from + (turn.facing - from) * share * share * (3.0 - 2.0 * share)
    }
}

/// The entry that began last, over or not.
fn last_begun<T>(lane: &[T], start: impl Fn(&T) -> f64, time: f64) -> Option<&T> {
    lane.iter().filter(|entry| start(entry) <= time + 1e-9).max_by(|a, b| start(a).total_cmp(&start(b)))
}

/// The entry that began last and is not over.
fn current<T>(lane: &[T], span: impl Fn(&T) -> (f64, Option<f64>), time: f64) -> Option<&T> {
    let entry = last_begun(lane, |entry| span(entry).0, time)?;
    let (start, duration) = span(entry);
    duration.is_none_or(|duration| time < start + duration - 1e-9).then_some(entry)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_stops_goes_on_facing_as_before_unless_told() {
        let walk = |start: f64, speed: f64, heading: f64| Walk { start, duration: None, speed, heading, facing: None };
        let mut script = Script { walk: vec![walk(0.5, 1.0, 1.2), walk(3.0, 0.0, 0.0)], ..Script::standing(&[]) };
        assert_eq!(script.intent(4.0).facing, 1.2);
        assert_eq!(script.intent(0.2).facing, 0.0);
        script.walk[1].facing = Some(0.3);
        assert_eq!(script.intent(4.0).facing, 0.3);
    }
}

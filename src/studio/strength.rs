//! What of an entry its knob and its compass change: how strong it is and where it goes, with what people call them.
//!
//! Strengths are in their own unit (N, m/s, kg, ...), directions rad from the character's front, positive towards its left.

use super::document::Entry;
use crate::model::scenario::{Direction, Feet};

/// How strong an entry is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// In `unit`.
    pub value: f64,
    /// The knob's range. What is typed may go beyond it.
    pub range: [f64; 2],
    /// `N`, `m/s`, ...
    pub unit: &'static str,
    /// Digits behind the point.
    pub digits: usize,
}

impl Strength {
    /// 0..1 in the range.
    pub fn share(&self) -> f64 {
        let [low, high] = self.range;
        ((self.value - low) / (high - low)).clamp(0.0, 1.0)
    }

    /// The value at a share of the range, rounded to what a knob can tell apart.
    pub fn at(&self, share: f64) -> f64 {
        let [low, high] = self.range;
        let step = 0.1_f64.powi(self.digits as i32) * if self.unit == "N" { 5.0 } else { 1.0 };
        ((low + share.clamp(0.0, 1.0) * (high - low)) / step).round() * step
    }

    /// As text.
    pub fn text(&self) -> String {
        format!("{:.*} {}", self.digits, self.value, self.unit).trim_end().to_owned()
    }
}

/// How strong an entry is; a stand has no strength, a turn is its direction.
pub fn strength(entry: &Entry) -> Option<Strength> {
    let of = |value, high, unit, digits| Some(Strength { value, range: [0.0, high], unit, digits });
    match entry {
        Entry::Walk(walk) => of(walk.speed, 1.8, "m/s", 2),
        Entry::Crouch(crouch) => of(crouch.amount, 1.0, "", 2),
        Entry::Push(push) => of(push.force, 800.0, "N", 0),
        Entry::Pull(pull) => of(pull.force, 200.0, "N", 0),
        Entry::Throw(throw) => of(throw.speed, 20.0, "m/s", 1),
        Entry::Carry(carry) => of(carry.mass.iter().map(|point| point[1]).fold(0.0, f64::max), 30.0, "kg", 1),
        Entry::Turn(_) | Entry::Stand(_) => None,
    }
}

/// The entry with that strength. A box whose mass changes keeps its course, scaled.
pub fn with_strength(entry: &Entry, value: f64) -> Entry {
    let mut changed = entry.clone();
    match &mut changed {
        Entry::Walk(walk) => walk.speed = value,
        Entry::Crouch(crouch) => crouch.amount = value,
        Entry::Push(push) => push.force = value.max(1.0),
        Entry::Pull(pull) => pull.force = value.max(1.0),
        Entry::Throw(throw) => throw.speed = value.max(0.5),
        Entry::Carry(carry) => {
            let most = carry.mass.iter().map(|point| point[1]).fold(0.0, f64::max);
            let scale = if most > 1e-9 { value.max(0.1) / most } else { 1.0 };
            carry.mass.iter_mut().for_each(|point| point[1] = (point[1] * scale * 100.0).round() / 100.0);
        }
        Entry::Turn(_) | Entry::Stand(_) => {}
    }
    changed
}

/// Where an entry goes or comes from; `None` where it has no direction, or one that is not level.
pub fn direction(entry: &Entry) -> Option<f64> {
    let of = |direction: Direction| match direction {
        Direction::Vector(vector) if vector.x.hypot(vector.z) < 1e-9 => None,
        direction => Some(yaw(direction)),
    };
    match entry {
        Entry::Walk(walk) => Some(walk.heading),
        Entry::Turn(turn) => Some(turn.facing),
        Entry::Push(push) | Entry::Pull(push) => of(push.toward),
        Entry::Throw(throw) => of(throw.from),
        Entry::Crouch(_) | Entry::Stand(_) | Entry::Carry(_) => None,
    }
}

/// The entry with that direction; the four plain ones get their names.
pub fn with_direction(entry: &Entry, angle: f64) -> Entry {
    let mut changed = entry.clone();
    let degrees = (angle.to_degrees().round() + 180.0).rem_euclid(360.0) - 180.0;
    let named = match degrees as i32 {
        0 => Direction::Front,
        90 => Direction::Left,
        -90 => Direction::Right,
        -180 | 180 => Direction::Back,
        _ => Direction::Heading(degrees.to_radians()),
    };
    match &mut changed {
        Entry::Walk(walk) => walk.heading = degrees.to_radians(),
        Entry::Turn(turn) => turn.facing = degrees.to_radians(),
        Entry::Push(push) | Entry::Pull(push) => push.toward = named,
        Entry::Throw(throw) => throw.from = named,
        Entry::Crouch(_) | Entry::Stand(_) | Entry::Carry(_) => {}
    }
    changed
}

/// What an entry says in its block.
pub fn label(entry: &Entry) -> String {
    let strength = strength(entry).map(|strength| strength.text());
    match entry {
        Entry::Walk(walk) if walk.speed == 0.0 => "stop".to_owned(),
        Entry::Turn(turn) => format!("{:.0}°", turn.facing.to_degrees()),
        Entry::Stand(stand) => match stand.on {
            Feet::Both => "both feet".to_owned(),
            Feet::Left => "left foot".to_owned(),
            Feet::Right => "right foot".to_owned(),
        },
        Entry::Throw(throw) => format!("{} × {}", throw.count, strength.unwrap_or_default()),
        _ => strength.unwrap_or_default(),
    }
}

fn yaw(direction: Direction) -> f64 {
    let unit = direction.unit(0.0);
    unit.x.atan2(unit.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studio::document::Lane;

    #[test]
    fn a_knob_sets_what_it_shows_and_a_compass_too() {
        for lane in Lane::ALL {
            let entry = lane.entry(1.0);
            if let Some(there) = strength(&entry) {
                let half = with_strength(&entry, there.at(0.5));
                assert!((strength(&half).expect("the same kind").share() - 0.5).abs() < 0.02, "{lane:?}");
            }
            if direction(&entry).is_some() {
                for degrees in [-135_f64, -90.0, 0.0, 30.0, 90.0, 180.0] {
                    let turned = direction(&with_direction(&entry, degrees.to_radians())).expect("still one");
                    let off = (turned.to_degrees() - degrees).rem_euclid(360.0);
                    assert!(off.min(360.0 - off) < 1e-6, "{lane:?} {degrees} {turned}");
                }
            }
        }
    }
}

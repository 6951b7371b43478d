//! Foot contacts of a run in scenario space: what the pose solver holds still and the clip promises; and when feet landed.

use super::feet::FootCurves;
use crate::measure::{Frame, HeldContact};
use crate::model::{Side, report::Part};
use crate::stepper::Plant;

/// One unbroken contact of one part of one foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootContact {
    /// Which foot.
    pub side: Side,
    /// Which part of its sole holds.
    pub part: Part,
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
    /// Where the foot stands (flat) during, before or after it.
    pub plant: Plant,
}

/// The contacts as the measures take them: on the plane that each foot stands on, in the ground's frame.
pub fn held(contacts: &[FootContact], frame: Frame) -> Vec<HeldContact> {
    contacts
        .iter()
        .map(|contact| HeldContact {
            side: contact.side,
            part: contact.part,
            start: contact.start,
            end: contact.end,
            point: contact.plant.ankle,
            normal: contact.plant.normal,
            frame,
        })
        .collect()
}

impl FootCurves {
    /// s between the last two landings of the foot that landed last before that time.
    pub fn stride_before(&self, time: f64) -> Option<f64> {
        let lands = |side: Side| {
            let mut lands =
                self.feet[side as usize].swings.iter().rev().map(|swing| swing.land).filter(|land| *land <= time);
            lands.next().zip(lands.next())
        };
        let newest = Side::BOTH.into_iter().filter_map(lands).max_by(|a, b| a.0.total_cmp(&b.0));
        newest.map(|(last, before)| last - before)
    }

    /// s since the foot last landed; infinite before its first step.
    pub fn since_landing(&self, side: Side, time: f64) -> f64 {
        let swings = &self.feet[side as usize].swings;
        swings.iter().rev().find(|swing| swing.land <= time).map_or(f64::INFINITY, |swing| time - swing.land)
    }
}

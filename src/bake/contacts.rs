//! Foot contacts of a run in scenario space: what the pose solver holds still and the clip promises.

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

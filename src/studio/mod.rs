//! The window: a scenario by hand, its reaction at once. egui and eframe; everything it does goes through the calls of the rows above.
//!
//! [`document`] is what is edited and [`history`] its past; panels read them and give edits.

pub mod audit_desk;
pub mod document;
pub mod errands;
pub mod history;
pub mod home;
pub mod playback;
pub mod simulate;
pub mod time_map;
pub mod worker;

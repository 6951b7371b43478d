//! The files on the disk, for both faces: which ones are meant, what is in them, and how whole ones get to their places.
//!
//! [`resolve`] opens rigs, scenarios, sweeps and base clips, [`level`] the meshes of grounds, [`clip_files`] clips; [`folder`] is where a batch puts its results,
//! [`batch_results`] what it leaves at the end;
//! [`correction`] is a clip file that is corrected; [`writer`] puts whole files in their places or none. A [`Failure`] says what is
//! wrong in words for a person. Nothing is printed here.

pub mod batch_results;
pub mod clip_files;
pub mod correction;
pub mod failure;
pub mod folder;
pub mod glob;
pub mod level;
pub mod resolve;
pub mod staged;
pub mod writer;

pub use failure::{Exit, Failure};

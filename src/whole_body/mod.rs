//! The pose that has the stepper's centre of mass and its feet, and moves as a pushed person does.
//!
//! Lower and upper body apart, as the paper has it: [`solve`] puts the pelvis where the articulated centre of mass is
//! the wanted one and bends the legs to the feet; [`reaction`] decides what trunk, head and arms do. Scenario space.

pub mod anatomy;
pub mod grip;
pub mod overlay;
pub mod reaction;
pub mod solve;
pub mod stand;
pub mod stoop;
pub mod stride;
pub mod struck;
pub mod sway;

pub use anatomy::Anatomy;
pub use grip::Grip;
pub use overlay::{BasePose, Neutral};
pub use solve::{ArmAngles, FootTarget, Hold, PoseTarget, Solver};

//! What a picture and a comparison need of a clip, taken while it is at hand.

use crate::bake::Baked;
use crate::rig::Rig;

/// A small contact sheet, PNG.
pub fn cell(_rig: &Rig, _baked: &Baked) -> Vec<u8> {
    Vec::new()
}

/// What tells its motion from others.
pub fn signature(_rig: &Rig, _baked: &Baked) -> Vec<f32> {
    Vec::new()
}

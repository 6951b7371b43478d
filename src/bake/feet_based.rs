//! Feet over a base clip: where they stand or walk as the clip has them. Scenario space, metres, seconds.

use super::base::{FootOffset, Walked};
use super::feet::FootCurves;
use crate::maths::curve::smooth3;
use crate::model::{Body, Side};

/// What a base clip has to say.
#[derive(Clone, Debug)]
pub(super) enum Based {
    /// There is none.
    Not,
    /// How they stand in it, and whether on the ball.
    Stand(Box<[(FootOffset, bool); 2]>),
    /// How they walk.
    Walk(Box<Walked>),
}

impl FootCurves {
    /// The same, standing at first and at last as in a base clip; with each foot, whether it does so on its ball.
    pub fn over(self, base: [(FootOffset, bool); 2]) -> FootCurves {
        let mut curves = self;
        for (path, (offset, _)) in curves.feet.iter_mut().zip(&base) {
            // One that does not stand flat there cannot roll over a flat foot's heel into it.
            if let Some(last) = path.swings.last_mut().filter(|last| last.strike < 0.0 && !offset.is_flat()) {
                last.strike = 0.0;
            }
        }
        FootCurves { base: Based::Stand(Box::new(base)), ..curves }
    }

    /// The same, walking at first and at last as in a base clip.
    pub fn over_walk(self, body: &Body, walked: Walked) -> FootCurves {
        let mut curves = FootCurves { base: Based::Walk(Box::new(walked)), ..self };
        curves.join(body);
        curves
    }

    /// Whether a foot is a base clip's then, and not to be touched.
    pub fn is_clips(&self, side: Side, time: f64) -> bool {
        matches!(&self.base, Based::Walk(walked) if walked.is_clips(side, time))
    }

    /// How much a foot stands as in the base clip, 0..1: before its first step and after its last.
    pub(super) fn as_in_base(&self, side: Side, time: f64) -> f64 {
        let swings = &self.feet[side as usize].swings;
        let (Some(first), Some(last)) = (swings.first(), swings.last()) else { return 1.0 };
        if swings.len() == 1 {
            return 1.0;
        }
        let left = 1.0 - smooth3(first.along(time));
        left.max(smooth3(last.along(time)))
    }

    /// Whether a foot is in the air as a base clip has it.
    pub fn flies_as_clip(&self, side: Side, time: f64) -> bool {
        matches!(&self.base, Based::Walk(walked) if walked.is_clips(side, time) && !walked.clip_bears(side, time))
    }

    /// Joins the feet of a base clip that walks to their curves as they are now.
    pub(super) fn join(&mut self, body: &Body) {
        let FootCurves { feet, terrain, base } = self;
        if let Based::Walk(walked) = base {
            walked.join(body, &|side, time| feet[side as usize].at(time, terrain));
        }
    }
}

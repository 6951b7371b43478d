//! A foot of a base clip that is coming down when the body is struck: it lands as the clip's does, as soon as the run's and as near to where
//! the run's stands as it gets meanwhile. Scenario space, m, s.

use super::leg::Foot;
use crate::bake::base::Walked;
use crate::bake::base::foot::to_ball;
use crate::bake::contacts::FootContact;
use crate::maths::curve::smooth3;
use crate::model::{Body, Side};
use crate::whole_body::FootTarget;
use glam::DVec3;

/// s after the clip's foot is flat: a foot that is coming down lands as the clip's where the run's is flat by then.
pub(super) const LATE: f64 = 0.1;
/// m/s at a leg of 0.83 m, mean: so fast a foot goes aside in what is left of a swing. In a walk the mean of a swing is as much again, and
/// its peak twice that.
const GOES: f64 = 2.0;
/// How much faster than in the clip it comes down at most.
const FASTER: f64 = 2.0;

/// m, how far a foot goes aside in so much (s) of a swing.
pub(super) fn goes(body: &Body, seconds: f64) -> f64 {
    GOES * (body.leg_length / 0.83).sqrt() * seconds.max(0.0)
}

/// How such a foot comes down.
#[derive(Clone, Copy, Debug)]
pub(super) struct Landing {
    /// s, when it goes on as the run's, which stands by then.
    pub(super) from: f64,
    struck: f64,    // s
    down: f64,      // s, when it lands
    clip: [f64; 2], // s of the clip, when its foot lands and when it is flat
    goes: DVec3,    // m, to the side of the clip's place
}

impl Landing {
    /// Of a foot of the clip that is coming down; `own`: what the run's foot holds then or next, `run` where that is at a time.
    pub(super) fn new(
        (body, side): (&Body, Side),
        walked: &Walked,
        struck: f64,
        dt: f64,
        own: Option<FootContact>,
        run: &dyn Fn(f64) -> FootTarget,
    ) -> Option<Landing> {
        let clip = walked.lands(side, struck)?;
        let own = own.filter(|own| own.start < clip[1] + LATE)?;
        let soonest = struck + (clip[0] - struck).max(0.0) / FASTER;
        let down = clip[0].min(own.start.max(soonest));
        let flat = down + clip[1] - clip[0];
        let from = own.start.max(flat) + dt;
        let ball = |target: &FootTarget| target.ankle + target.foot * to_ball(body, side);
        let off = (ball(&run(from)) - ball(&walked.gait.foot(side, clip[1]))).with_y(0.0);
        let most = goes(body, down - struck);
        Some(Landing { from, struck, down, clip, goes: off.clamp_length_max(most) })
    }

    /// s, when it is flat.
    pub(super) fn flat(&self) -> f64 {
        self.down + self.clip[1] - self.clip[0]
    }

    /// Where it is at a time before [`Landing::from`].
    pub(super) fn foot(&self, walked: &Walked, side: Side, time: f64) -> FootTarget {
        let share = ((time - self.struck) / (self.down - self.struck).max(1e-6)).min(1.0);
        let own = match self.down > self.struck && time < self.down {
            true => self.struck + (self.clip[0] - self.struck) * share,
            false => time - self.down + self.clip[0],
        };
        let clip = walked.gait.foot(side, own.min(self.clip[1]));
        FootTarget { ankle: clip.ankle + self.goes * smooth3(share), ..clip }
    }

    /// What it holds until it is flat, the clip's contacts before included.
    pub(super) fn contacts(&self, walked: &Walked, side: Side, list: &mut Vec<FootContact>) {
        if self.down <= self.struck {
            return walked.gait.contacts(side, 0.0, self.clip[1], DVec3::ZERO, 0.0, list);
        }
        walked.gait.contacts(side, 0.0, self.struck, DVec3::ZERO, 0.0, list);
        walked.gait.contacts(side, self.clip[0] - 1e-6, self.clip[1], self.goes, self.down - self.clip[0], list);
    }
}

/// The same as a leg is posed for it.
pub(super) fn leg_foot(target: &FootTarget) -> Foot {
    Foot { ankle: target.ankle, foot: target.foot, toe: target.toe }
}

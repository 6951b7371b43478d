//! How an articulated body's run goes from a base clip that walks and back to it: which foot is coming down, where the clip is laid when it
//! is taken up again, and how the foot rolls off that stands meanwhile. Scenario space, metres, seconds.

use super::Walked;
use super::foot::to_ball;
use super::gait::Fall;
use crate::maths::quat::wrap_angle;
use crate::model::{Body, BodyPose, Side};
use crate::whole_body::FootTarget;
use glam::{DQuat, DVec3};

/// s, from when on before it lands a foot is coming down.
const COMES_DOWN: f64 = 0.2;

/// How a foot rolls off as in the clip where it stands, s of the baked clip: `from` when the other one lifts to be the clip's, until that
/// `lands`; its heel rises at `ball`, it leaves at `lift`.
#[derive(Clone, Copy, Debug)]
pub struct RollOff {
    pub from: f64,
    pub lands: f64,
    pub lift: f64,
    pub ball: f64,
    /// What it is in the clip.
    pub fall: Fall,
    later: f64,
}

impl Walked {
    /// The clip's own pose where it is taken up again, before it is and after.
    pub fn taken_up(&self, time: f64) -> Option<BodyPose> {
        let back = self.back?;
        let pose = self.gait.at(time - back.later).pose;
        Some(BodyPose { hips: pose.hips + back.shift, ..pose })
    }

    /// Lays the clip that is taken up where its centre of mass is that of a run (m, at a time) when the first foot lands in it, and has
    /// feet lift and land when its own do.
    pub fn lay_on(&mut self, com: &dyn Fn(f64) -> DVec3) {
        let Some(back) = &mut self.back else { return };
        let [mut first, mut last] = [f64::INFINITY, 0.0_f64];
        for side in Side::BOTH {
            let Some(swing) = &mut self.sides[side as usize].back else { continue };
            let Some(lands) = self.gait.around(side, swing[1] - back.later + 1e-6).0 else { continue };
            // The foot that lifted in the clip stands until then.
            if swing[0] > back.over[0]
                && let Some(stood) = self.gait.around(side, lands.down - 1e-6).0
            {
                swing[0] = stood.up + back.later;
            }
            swing[1] = lands.down + back.later;
            (first, last) = (first.min(swing[1]), last.max(swing[1]));
        }
        back.over[1] = last;
        back.shift = (com(first) - self.gait.at(first - back.later).com).with_y(0.0);
    }

    /// s, from when to when the way back to the clip is.
    pub fn way_back_over(&self) -> Option<[f64; 2]> {
        self.back.map(|back| back.over)
    }

    /// The foot that stands while the other one goes back to the clip: how it rolls off there.
    pub fn roll_off(&self, side: Side) -> Option<RollOff> {
        let (back, [lift, land]) = (self.back?, self.sides[side as usize].back?);
        let [_, lands] = self.sides[side.other() as usize].back.filter(|other| other[1] < land)?;
        let fall = *self.gait.around(side, lift - back.later - 1e-6).0?;
        Some(RollOff { from: back.over[0], lands, lift, ball: fall.ball + back.later, later: back.later, fall })
    }

    /// A foot that stood there (`own`, at the time `from`) as the clip rolls it off, over the same ball.
    pub fn rolled_off(&self, body: &Body, roll: &RollOff, own: &FootTarget, time: f64) -> FootTarget {
        let side = roll.fall.side;
        let to_ball = to_ball(body, side);
        let (stands, clip) = (self.gait.foot(side, roll.fall.ball), self.gait.foot(side, time - roll.later));
        let by = wrap_angle(own.yaw - stands.yaw);
        let turn = DQuat::from_rotation_y(by);
        // As the clip's turns out of how it stands; once it has left it goes as the clip's.
        let rolled = |clip: DQuat, stands: DQuat| turn * (clip * stands.inverse()) * turn.inverse();
        let foot = (rolled(clip.foot, stands.foot) * own.foot).normalize();
        let toe = (rolled(clip.toe, stands.toe) * own.toe).normalize();
        let goes = turn * (clip.ankle + clip.foot * to_ball - stands.ankle - stands.foot * to_ball);
        let ball = own.ankle + own.foot * to_ball + goes;
        FootTarget { ankle: ball - foot * to_ball, foot, toe, yaw: clip.yaw + by, ..clip }
    }

    /// s, when that foot leaves for where the clip has it again.
    pub fn leaves(&self, side: Side) -> Option<f64> {
        self.sides[side as usize].back.map(|back| back[0])
    }

    /// s, when a foot of the clip lands that is coming down then, or soon, and when it is flat.
    pub fn lands(&self, side: Side, time: f64) -> Option<[f64; 2]> {
        match self.gait.around(side, time) {
            (Some(last), _) if time < last.flat => Some([last.down, last.flat]),
            (Some(last), Some(next)) if last.up < time && next.down < time + COMES_DOWN => Some([next.down, next.flat]),
            (None, Some(next)) if next.down < time + COMES_DOWN => Some([next.down, next.flat]),
            _ => None,
        }
    }
}

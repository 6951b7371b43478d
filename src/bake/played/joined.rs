//! A foot that leaves the clip of a walk for the run that goes on from it. Scenario space, m, s, rad.
//!
//! What the two differ by is let go at the ball, about which a foot rolls: the turn at once, or where both lie flat once it lies no more;
//! the place and where the foot points in a swing. A foot that stands stays where the clip has it until it next leaves, and so does one
//! that is about to land.

use super::hold::left;
use super::landing::goes;
use crate::bake::base::foot::to_ball;
use crate::maths::curve::smooth3;
use crate::maths::quat::wrap_angle;
use crate::model::{Body, Side};
use crate::whole_body::FootTarget;
use glam::{DQuat, DVec3};

/// s, the longest and the shortest in which turn and height are let go.
const TURNS: [f64; 2] = [0.25, 0.15];
/// Of the way that it would go in that time: how much farther it goes yet.
const COASTS: f64 = 0.3;
/// Part of a swing in which the place that a foot stood at beside the run's is let go: before it passes the other leg.
const PASSES: f64 = 0.5;

/// What a foot differs by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joined {
    from: f64,        // s
    turns: f64,       // s, from when on the turn is let go
    over: f64,        // s, in which turn and height are let go
    settles: f64,     // s, in which place and yaw are
    foot: [DVec3; 2], // rad and rad/s, after the yaw
    toe: [DVec3; 2],
    place: [DVec3; 2], // m and m/s, of the ball: beyond what stays until it leaves
    yaw: [f64; 2],
    stays: (DVec3, f64),      // m and rad
    leaves: Option<[f64; 2]>, // s, the swing in which that is let go
    to_ball: DVec3,           // m, at rest
}

/// A foot that the clip and the run have so.
pub(super) struct Both<'a> {
    /// The clip's at a time, s.
    pub(super) clip: &'a dyn Fn(f64) -> FootTarget,
    /// The run's.
    pub(super) run: &'a dyn Fn(f64) -> FootTarget,
    /// Whether the clip's bears.
    pub(super) bears: bool,
    /// s, until when both lie flat.
    pub(super) flat: Option<f64>,
    /// s, the swings of the run's that end after that moment.
    pub(super) swings: &'a [[f64; 2]],
}

impl Joined {
    /// At the time `from` (s); `dt`: s, in which it is seen how fast they part.
    pub(super) fn new(body: &Body, side: Side, both: &Both, from: f64, dt: f64) -> Joined {
        let to_ball = to_ball(body, side);
        let apart = |time: f64| {
            let (clip, run) = ((both.clip)(time), (both.run)(time));
            let yaw = wrap_angle(clip.yaw - run.yaw);
            let turn = DQuat::from_rotation_y(yaw);
            let axis = |turn: DQuat| if turn.w < 0.0 { (-turn).to_scaled_axis() } else { turn.to_scaled_axis() };
            let foot = axis(clip.foot * (turn * run.foot).inverse());
            let toe = axis(clip.toe * (turn * run.toe).inverse());
            let ball = |target: &FootTarget| target.ankle + target.foot * to_ball;
            (foot, toe, ball(&clip) - ball(&run), yaw)
        };
        let (now, before) = (apart(from), apart((from - dt).max(0.0)));
        let rate = |now: DVec3, before: DVec3| (now - before) / dt;
        let swings = both.swings.first().filter(|swing| swing[0] <= from).copied();
        let next = both.swings.iter().find(|swing| swing[0] > from).copied();
        let most = swings.map_or(next.map_or(TURNS[0], |next| next[0] - from), |swing| swing[1] - from);
        let over = if swings.is_some() { most.clamp(TURNS[1], TURNS[0]) } else { TURNS[0] };
        let (mut place, mut yaw) = ([now.2, rate(now.2, before.2)], [now.3, wrap_angle(now.3 - before.3) / dt]);
        let stands = both.bears && swings.is_none();
        if stands {
            (place[1], yaw[1]) = (DVec3::ZERO, 0.0);
        }
        // One that swings comes to the run's place as far as it gets there.
        let off = (place[0] + place[1] * (COASTS * over)).with_y(0.0);
        let far = swings.map_or(0.0, |swing| goes(body, swing[1] - from));
        let share = 1.0 - (far / off.length().max(1e-9)).min(1.0);
        let stays = match stands {
            true => (place[0], yaw[0]),
            false => (off * share, (yaw[0] + yaw[1] * (COASTS * over)) * share),
        };
        let flat = both.flat.filter(|until| stands && *until > from);
        let turn = |now: DVec3, before: DVec3| [now, if flat.is_some() { DVec3::ZERO } else { rate(now, before) }];
        place[0] -= stays.0;
        yaw[0] -= stays.1;
        Joined {
            from,
            turns: flat.unwrap_or(from),
            over,
            settles: if swings.is_some() { most.max(TURNS[1]) } else { over },
            foot: turn(now.0, before.0),
            toe: turn(now.1, before.1),
            place,
            yaw,
            stays,
            leaves: next,
            to_ball,
        }
    }

    /// s, when it leaves the clip.
    pub(super) fn from(&self) -> f64 {
        self.from
    }

    /// s, until when it holds what both hold: then it is as the run has it but for its place, or is let go to be.
    pub(super) fn settled(&self) -> f64 {
        if self.turns > self.from { self.turns } else { self.from + self.over }
    }

    /// That foot of the run's with what is left of the difference.
    pub(super) fn of(&self, run: &FootTarget, time: f64) -> FootTarget {
        let since = time - self.from;
        let gone = |[lift, land]: [f64; 2]| smooth3((time - lift) / (PASSES * (land - lift)).max(1e-6));
        let stays = 1.0 - self.leaves.map_or(0.0, gone);
        let one = |[value, rate]: [DVec3; 2], over: f64| left(value, rate, since, over);
        let turned = |[value, rate]: [DVec3; 2]| left(value, rate, (time - self.turns).max(0.0), self.over);
        let yaw = left(DVec3::Y * self.yaw[0], DVec3::Y * self.yaw[1], since, self.settles).y + self.stays.1 * stays;
        let turn = DQuat::from_rotation_y(yaw);
        let foot = (DQuat::from_scaled_axis(turned(self.foot)) * turn * run.foot).normalize();
        let toe = (DQuat::from_scaled_axis(turned(self.toe)) * turn * run.toe).normalize();
        let level = one(self.place, self.settles).with_y(0.0) + self.stays.0 * stays;
        let high = one(self.place, self.over) * DVec3::Y;
        let ball = run.ankle + run.foot * self.to_ball + level + high;
        FootTarget { ankle: ball - foot * self.to_ball, foot, toe, yaw: run.yaw + yaw, ..*run }
    }
}

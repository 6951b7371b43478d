//! A reaction over a base clip that stands: the stance that the stepper starts from and comes back to, the clip's sway on top of
//! the stepper's path, and the way home: first and last frame are the clip's own pose. Scenario space, metres, seconds.

use super::{Base, BaseError, FootOffset};
use crate::maths::curve::smooth3;
use crate::model::{Body, Physique, Plant, Side, Stance};
use crate::stepper::Step;
use crate::whole_body::{Anatomy, BasePose, Neutral};
use glam::{DQuat, DVec2, DVec3};
use std::sync::Arc;

/// s, in which what is left of a reaction is let go before the end.
const HOMEWARD: f64 = 1.0;
/// s, that the last landing or push must be over before.
const SETTLED: f64 = 0.25;
/// Part of the leg by which a landing is moved at most for the feet to stand as in the clip.
pub(in crate::bake) const MOST_MOVED: f64 = 0.1;
/// rad, the same of its turn.
pub(in crate::bake) const MOST_TURNED: f64 = 0.35;
/// rad: a heel that is up by more stands on its ball.
const ON_BALL: f64 = 6.0 * std::f64::consts::PI / 180.0;
/// m of foot travel in the clip that is passed over.
const STILL: f64 = 0.004;
/// m: from here on it is no stand.
const WANDERS: f64 = 0.06;

/// A base clip that stands, ready to be laid under a reaction.
#[derive(Clone, Debug)]
pub struct Stood {
    /// The clip.
    pub base: Arc<Base>,
    /// What a reaction is measured from.
    pub neutral: Neutral,
    /// How each foot stands.
    pub feet: [FootOffset; 2],
    /// m, mean centre of mass.
    pub com: DVec3,
    /// How far out each leg reaches in the clip, in leg lengths.
    pub reach: [f64; 2],
    /// Sentences for a person.
    pub notes: Vec<String>,
    on_ball: [bool; 2],
}

impl Stood {
    /// Measures the clip.
    pub fn new(base: Arc<Base>, body: &Body, anatomy: &Anatomy) -> Result<Stood, BaseError> {
        let first = base.at(0.0);
        let positions = first.pose.positions(body);
        let mut notes = base.notes.clone();
        let feet = Side::BOTH.map(|side| {
            let leg = &anatomy.legs[side as usize];
            let foot = first.pose.turns[leg.foot];
            let toe = leg.toe.map_or(foot, |toe| first.pose.turns[toe]);
            FootOffset::new(body, side, positions[leg.foot], foot, toe)
        });
        let mut com = DVec3::ZERO;
        let mut reach = [0.0_f64; 2];
        let mut travel = [0.0_f64; 2];
        let mut at = Vec::new();
        for frame in base.frames() {
            com += frame.com / base.frames().len() as f64;
            frame.pose.positions_into(body, &mut at);
            for side in Side::BOTH {
                let leg = &anatomy.legs[side as usize];
                reach[side as usize] = reach[side as usize].max((at[leg.foot] - at[leg.upper]).length() / leg.length());
                travel[side as usize] = travel[side as usize].max((at[leg.foot] - positions[leg.foot]).length());
            }
        }
        for side in Side::BOTH {
            let name = if side == Side::Left { "left" } else { "right" };
            if travel[side as usize] > WANDERS * body.leg_length / 0.83 {
                let what = format!("moves its {name} foot by {:.0} cm", travel[side as usize] * 100.0);
                return Err(BaseError::Unfit { name: base.name.clone(), what });
            }
            if travel[side as usize] > STILL {
                notes.push(format!(
                    "the base clip's {name} foot slides by {:.0} mm: it is held where it first stands",
                    travel[side as usize] * 1e3
                ));
            }
        }
        if !base.loops && base.frames().len() > 1 {
            notes.push(format!("the base clip does not loop: after {:.2} s its last pose is held", base.seconds()));
        }
        let on_ball = Side::BOTH.map(|side| feet[side as usize].pitch(body, side) > ON_BALL);
        Ok(Stood { neutral: Neutral::new(body, anatomy), feet, com, reach, notes, on_ball, base })
    }

    /// The stand that the controller starts from and comes back to.
    pub fn physique(&self, physique: &Physique) -> Physique {
        let [left, right] = self.feet.map(|foot| DVec2::new(foot.plant.ankle.x, foot.plant.ankle.z));
        let middle = (left + right) * 0.5;
        let lower = physique.com_height - self.com.y;
        Physique {
            com_height: self.com.y,
            hip_height: physique.hip_height - lower,
            stance: Some(Stance {
                middle,
                apart: left - right,
                over: DVec2::new(self.com.x, self.com.z) - middle,
                yaws: self.feet.map(|foot| foot.plant.yaw),
            }),
            ..*physique
        }
    }

    /// m, how far the clip's centre of mass is from its mean.
    pub fn sway(&self, time: f64) -> DVec3 {
        self.base.at(time).com - self.com
    }

    /// What is laid under the reaction at a time.
    pub fn pose(&self, time: f64) -> BasePose {
        self.base.at(time).base
    }

    /// How both feet stand, and whether on their balls.
    pub fn feet_and_balls(&self) -> [(FootOffset, bool); 2] {
        [0, 1].map(|side| (self.feet[side], self.on_ball[side]))
    }

    /// m, where the centre of mass comes to rest on the last plants.
    pub fn rests(&self, start: &[Plant; 2], steps: &[Step], facing: f64) -> DVec3 {
        let plant =
            |side: Side| steps.iter().rev().find(|step| step.side == side).map_or(start[side as usize], |step| step.to);
        let middle = (plant(Side::Left).ankle + plant(Side::Right).ankle) * 0.5;
        let clip = (self.feet[0].plant.ankle + self.feet[1].plant.ankle) * 0.5;
        let over = DQuat::from_rotation_y(facing) * (self.com - clip);
        middle + over
    }

    /// Moves the last landings by the little that they miss for the feet to stand as in the clip. `facing`: rad, at the end.
    pub fn come_home(&self, start: &[Plant; 2], steps: &mut [Step], facing: f64, body: &Body) -> bool {
        let last = Side::BOTH.map(|side| steps.iter().rposition(|step| step.side == side));
        let Some(final_step) = last.iter().flatten().copied().max_by(|a, b| steps[*a].land.total_cmp(&steps[*b].land))
        else {
            return true;
        };
        let turn = DQuat::from_rotation_y(facing);
        let wanted_yaw = |side: Side| facing + self.feet[side as usize].plant.yaw;
        let near = |from: f64, to: f64| crate::maths::quat::wrap_angle(to - from).abs() < MOST_TURNED;
        for side in Side::BOTH {
            if let Some(step) = last[side as usize].map(|step| &mut steps[step]) {
                if !near(step.to.yaw, wanted_yaw(side)) {
                    return false;
                }
                step.to.yaw += crate::maths::quat::wrap_angle(wanted_yaw(side) - step.to.yaw);
            }
        }
        let side = steps[final_step].side;
        let other = last[side.other() as usize].map_or(start[side.other() as usize], |step| steps[step].to);
        let apart = self.feet[side as usize].plant.ankle - self.feet[side.other() as usize].plant.ankle;
        let wanted = other.ankle + turn * apart;
        let off = wanted - steps[final_step].to.ankle;
        if (off * DVec3::new(1.0, 0.0, 1.0)).length() > MOST_MOVED * body.leg_length {
            return false;
        }
        steps[final_step].to.ankle += off * DVec3::new(1.0, 0.0, 1.0);
        true
    }
}

/// How much of a reaction is left, 1 down to 0 at the end: it lets go once landings and pushes are over (`busy`, s).
pub fn left_over(time: f64, busy: f64, end: f64) -> f64 {
    let from = (busy + SETTLED).max(end - HOMEWARD).min(end - 1e-3);
    1.0 - smooth3(((time - from) / (end - from)).clamp(0.0, 1.0))
}

//! Where a leg still steps suddenly from one frame to the next, the passes take more care of it: knees are evened more there,
//! and one that is sudden because it stands still before or after, in the air, is to go on turning there.
//!
//! The measure of a pop (measure/joints.rs) at a film's rate, a little stricter, on the poses that the present curves give.
//! Nothing is moved here: [`super::knees`] and [`super::reach`] weigh their evening by it. Seconds, radians.

use super::timeline::Timeline;
use crate::maths::curve::bump;
use crate::model::Side;
use crate::whole_body::solve::Solved;
use glam::DQuat;

/// Frames a second.
const FILM: f64 = 30.0;
/// rad, the least step that can be sudden.
const SUDDEN: f64 = 3.6 * std::f64::consts::PI / 180.0;
/// How much larger it is than those two frames before and after.
const TIMES: f64 = 3.5;
/// s, before and after a sudden step, in which more care is taken.
const WIDTH: f64 = 0.13;
/// The most care.
const MOST: f64 = 100.0;

/// What a sudden step's neighbour is asked for, more than would explain it.
const MORE: f64 = 1.15;
/// By how much that grows where it is not enough.
const GROWS: f64 = 1.2;

/// What the legs are asked for at each entry of a run.
#[derive(Clone, Debug)]
pub struct Care {
    care: [Vec<f64>; 2],
    paces: [Vec<f64>; 2],
}

impl Care {
    /// The same everywhere, for so many entries.
    pub fn new(count: usize) -> Care {
        Care { care: [vec![1.0; count], vec![1.0; count]], paces: [vec![0.0; count], vec![0.0; count]] }
    }

    /// How much more than elsewhere one leg is evened, an entry each: 1 or more.
    pub fn of(&self, side: Side) -> &[f64] {
        &self.care[side as usize]
    }

    /// rad/s, how fast one knee is to bend in the air from each entry to the next; 0 where nothing is asked.
    pub fn paces(&self, side: Side) -> &[f64] {
        &self.paces[side as usize]
    }

    /// Doubles it around every sudden step of a leg's joint; `late`, only of a walker's: what evens a knee there takes the
    /// balance filter passes to answer, and recoveries have less room for the pressure than for a jerk.
    pub fn watch(&mut self, timeline: &Timeline, solved: &[Solved], late: bool) {
        if solved.len() < 2 {
            return;
        }
        for side in Side::BOTH {
            let leg = &timeline.anatomy.legs[side as usize];
            for joint in [Some(leg.upper), Some(leg.lower), Some(leg.foot), leg.toe].into_iter().flatten() {
                let parent = timeline.body.joints[joint].parent.unwrap_or(0);
                for (frame, step) in sudden(&turns(solved, parent, joint, timeline)) {
                    let time = (frame as f64 + 0.5) / FILM;
                    if joint == leg.lower {
                        self.go_on(frame, step, side, timeline, solved);
                    }
                    let index = ((time / timeline.dt).round() as usize).min(timeline.walking.len().saturating_sub(1));
                    if !late || timeline.walking.get(index).is_some_and(|walking| *walking > 0.0) {
                        self.around(time, side, timeline.dt);
                    }
                }
            }
        }
    }

    /// Asks the knee to turn in the frame two before or two after a sudden step, whichever is in the air and turns more already.
    fn go_on(&mut self, frame: usize, step: f64, side: Side, timeline: &Timeline, solved: &[Solved]) {
        let entry = |frame: usize| ((frame as f64 / FILM / timeline.dt).round() as usize).min(solved.len() - 1);
        let bends = |frame: usize| {
            let bend = |at: usize| solved[entry(at)].knees[side as usize];
            bend(frame + 1) - bend(frame)
        };
        let flies = |frame: &usize| {
            (entry(*frame)..=entry(*frame + 1))
                .all(|index| timeline.feet.freedom(side, index as f64 * timeline.dt) > 0.0)
        };
        let around = [frame.checked_sub(2), frame.checked_add(2)].into_iter().flatten().filter(flies);
        let Some(at) = around.max_by(|a, b| bends(*a).abs().total_cmp(&bends(*b).abs())) else { return };
        let wanted = MORE * step / TIMES;
        let now = bends(at);
        // More bent in the air there is always room; who flies on turns on.
        let sign = if now.abs() > 0.4 * wanted {
            now.signum()
        } else if flies(&frame) {
            bends(frame).signum()
        } else if at < frame {
            -1.0
        } else {
            1.0
        };
        let paces = &mut self.paces[side as usize][entry(at)..entry(at + 1)];
        let asked = paces.first().copied().unwrap_or(0.0);
        let pace = if asked == 0.0 { sign * wanted * FILM } else { asked * GROWS };
        paces.fill(pace);
    }

    fn around(&mut self, time: f64, side: Side, dt: f64) {
        for (index, care) in self.care[side as usize].iter_mut().enumerate() {
            let off = (index as f64 * dt - time) / WIDTH;
            if off.abs() < 1.0 {
                *care = (*care * (1.0 + bump(0.5 + 0.5 * off))).min(MOST);
            }
        }
    }
}

/// A joint against its parent, frame by frame.
fn turns(solved: &[Solved], parent: usize, joint: usize, timeline: &Timeline) -> Vec<DQuat> {
    let local = |at: usize| solved[at].pose.turns[parent].inverse() * solved[at].pose.turns[joint];
    let frames = (timeline.duration() * FILM).floor() as usize;
    let turn = |frame: usize| {
        let place = frame as f64 / FILM / timeline.dt;
        let at = (place as usize).min(solved.len() - 2);
        local(at).slerp(local(at + 1), (place - at as f64).min(1.0))
    };
    (0..=frames).map(turn).collect()
}

/// The steps that their neighbours do not explain: the frame that each begins at, and rad.
fn sudden(turns: &[DQuat]) -> Vec<(usize, f64)> {
    let steps: Vec<f64> = turns.windows(2).map(|pair| pair[0].angle_between(pair[1])).collect();
    let at_or = |at: Option<usize>| at.and_then(|at| steps.get(at)).copied().unwrap_or(0.0);
    let is = |at: &usize| {
        let around = at_or(at.checked_sub(2)).max(at_or(at.checked_add(2)));
        steps[*at] > SUDDEN && steps[*at] > TIMES * around
    };
    (0..steps.len()).filter(is).map(|at| (at, steps[at])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_within_three_frames_is_sudden_and_the_same_turn_within_six_is_not() {
        let over = |frames: f64| -> Vec<DQuat> {
            let angle = |at: i32| 0.3 * crate::maths::curve::smooth3((f64::from(at) - 10.0) / frames);
            (0..30).map(|at| DQuat::from_rotation_x(angle(at))).collect()
        };
        let found = sudden(&over(3.0));
        assert!(!found.is_empty() && found.iter().all(|(frame, _)| frame.abs_diff(11) < 2), "{found:?}");
        assert!(sudden(&over(6.0)).is_empty());
        let mut care = Care::new(100);
        care.around(0.5, Side::Left, 0.01);
        assert!((care.of(Side::Left)[50] - 2.0).abs() < 1e-9 && care.of(Side::Left)[30] == 1.0);
        assert!(care.of(Side::Right).iter().all(|care| *care == 1.0));
    }
}

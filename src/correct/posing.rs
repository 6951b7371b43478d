//! Frames posed anew: a pelvis that carries everything above it, and feet put where they shall be, legs between by two-bone IK.
//!
//! Clip space, m. Bones keep the lengths that the frame gives them, a knee stays in its plane, a foot keeps its own turn but for what a goal
//! adds. Where a foot that bears is out of reach, the pelvis sinks as little and as gently as will do; one that swings comes as near as it can.

use crate::maths::quat::shortest_arc;
use crate::maths::two_bone_ik::two_bone_ik;
use crate::model::{Body, Capture, Role, Side};
use glam::{DQuat, DVec3};

/// A leg is no straighter than that, unless it was.
const STRAIGHTEST: f64 = 0.9985;
/// Of the leg's length: the pelvis sinks no more for reach.
const DEEPEST: f64 = 0.12;
/// s: how long before it is needed, and after, the pelvis sinks.
const SINKS: f64 = 0.2;

/// A span of frames, cut out.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// First frame.
    pub start: usize,
    joints: usize,
    positions: Vec<DVec3>, // (frames x joints)
    turns: Vec<DQuat>,
}

/// Where a foot shall be in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// m.
    pub ankle: DVec3,
    /// What the foot is turned by, in clip space.
    pub turn: DQuat,
    /// It must be there, whatever the pelvis does for it.
    pub bears: bool,
    /// Where its knee points, in clip space, if not as it does.
    pub knee: Option<DVec3>,
}

/// What a frame shall become.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// m: the pelvis and all above it.
    pub body: DVec3,
    /// Left and right.
    pub feet: [Foot; 2],
}

impl Piece {
    /// Copies frames, both ends included.
    pub fn cut(capture: &Capture, start: usize, end: usize) -> Piece {
        let joints = capture.body.joints.len();
        let range = start * joints..(end + 1) * joints;
        Piece {
            start,
            joints,
            positions: capture.positions[range.clone()].to_vec(),
            turns: capture.turns[range].to_vec(),
        }
    }

    /// Last frame.
    pub fn end(&self) -> usize {
        self.start + (self.positions.len() / self.joints.max(1)).saturating_sub(1)
    }

    /// Puts it in; what was there.
    pub fn swap(mut self, capture: &mut Capture) -> Piece {
        let range = self.start * self.joints..self.start * self.joints + self.positions.len();
        capture.positions[range.clone()].swap_with_slice(&mut self.positions);
        capture.turns[range].swap_with_slice(&mut self.turns);
        self
    }

    /// Moves the whole body of a frame.
    pub fn shift(&mut self, frame: usize, by: DVec3) {
        let base = (frame - self.start) * self.joints;
        self.positions[base..base + self.joints].iter_mut().for_each(|place| *place += by);
    }

    /// Takes a foot and what hangs from it the way it is turned in another pose, its ankle where it is.
    pub fn turn_foot_like(&mut self, body: &Body, frame: usize, side: Side, turns: &[DQuat], places: &[DVec3]) {
        let ankle = body.feet[side as usize].ankle;
        let base = (frame - self.start) * self.joints;
        for joint in under(body, ankle) {
            self.turns[base + joint] = turns[joint];
            self.positions[base + joint] = self.positions[base + ankle] + places[joint] - places[ankle];
        }
    }

    /// Poses a frame; m: how far each foot is from its goal then.
    fn pose(&mut self, body: &Body, frame: usize, goal: &Goal) -> [f64; 2] {
        if goal.body != DVec3::ZERO {
            self.shift(frame, goal.body);
        }
        let mut missed = [0.0; 2];
        for side in Side::BOTH {
            let foot = &goal.feet[side as usize];
            missed[side as usize] = self.place_foot(body, frame, leg(body, side), foot);
        }
        missed
    }

    fn place_foot(&mut self, body: &Body, frame: usize, [hip, knee, ankle]: [usize; 3], goal: &Foot) -> f64 {
        let base = (frame - self.start) * self.joints;
        let place = |piece: &Piece, joint: usize| piece.positions[base + joint];
        let (at_hip, at_knee, at_ankle) = (place(self, hip), place(self, knee), place(self, ankle));
        let (upper, lower) = (at_hip.distance(at_knee), at_knee.distance(at_ankle));
        let mut missed = 0.0;
        if goal.ankle.distance(at_ankle) > 1e-9 {
            let straightest = (at_hip.distance(at_ankle) / (upper + lower)).clamp(STRAIGHTEST, 0.9999);
            let forward = self.turns[base + hip] * DVec3::Z;
            let pole = goal.knee.unwrap_or_else(|| pole([at_hip, at_knee, at_ankle], goal.ankle, forward));
            let solved = two_bone_ik(at_hip, goal.ankle, upper, lower, pole, straightest);
            missed = solved.end.distance(goal.ankle);
            let thigh = shortest_arc(at_knee - at_hip, solved.middle - at_hip);
            let shank = shortest_arc(at_ankle - at_knee, solved.end - solved.middle);
            self.turns[base + hip] = (thigh * self.turns[base + hip]).normalize();
            self.turns[base + knee] = (shank * self.turns[base + knee]).normalize();
            self.positions[base + knee] = solved.middle;
            for joint in under(body, ankle) {
                self.positions[base + joint] += solved.end - at_ankle;
            }
        }
        if goal.turn != DQuat::IDENTITY {
            let pivot = place(self, ankle);
            for joint in under(body, ankle) {
                self.positions[base + joint] = pivot + goal.turn * (self.positions[base + joint] - pivot);
                self.turns[base + joint] = (goal.turn * self.turns[base + joint]).normalize();
            }
        }
        missed
    }
}

/// What a frame is now, as a goal.
pub fn as_it_is(capture: &Capture, frame: usize, bears: [bool; 2]) -> Goal {
    let foot = |side: Side| Foot {
        ankle: capture.at(frame)[capture.body.feet[side as usize].ankle],
        turn: DQuat::IDENTITY,
        bears: bears[side as usize],
        knee: None,
    };
    Goal { body: DVec3::ZERO, feet: Side::BOTH.map(foot) }
}

/// Frames posed to goals, from frame `start` on; m: the worst distance of a bearing foot from its goal.
pub fn pose(capture: &Capture, start: usize, goals: &[Goal]) -> (Piece, f64) {
    let body = &capture.body;
    let mut piece = Piece::cut(capture, start, start + goals.len().max(1) - 1);
    let sinks = sinking(capture, start, goals);
    let mut worst: f64 = 0.0;
    for (index, goal) in goals.iter().enumerate() {
        let frame = start + index;
        let mut goal = *goal;
        goal.body.y -= sinks[index];
        if goal == as_it_is(capture, frame, goal.feet.map(|foot| foot.bears)) {
            continue;
        }
        let missed = piece.pose(body, frame, &goal);
        for side in Side::BOTH {
            if goal.feet[side as usize].bears {
                worst = worst.max(missed[side as usize]);
            }
        }
    }
    (piece, worst)
}

/// Hip, knee and ankle.
pub fn leg(body: &Body, side: Side) -> [usize; 3] {
    let roles = match side {
        Side::Left => [Role::LeftUpperLeg, Role::LeftLowerLeg],
        Side::Right => [Role::RightUpperLeg, Role::RightLowerLeg],
    };
    let joint = |role| body.joint(role).unwrap_or(0);
    [joint(roles[0]), joint(roles[1]), body.feet[side as usize].ankle]
}

/// A joint and all that hang from it.
pub fn under(body: &Body, above: usize) -> Vec<usize> {
    let mut found = vec![above];
    for joint in above + 1..body.joints.len() {
        if body.joints[joint].parent.is_some_and(|parent| found.contains(&parent)) {
            found.push(joint);
        }
    }
    found
}

/// Where the knee goes: as it points now, and for what it bends more, to where the thigh has its front.
fn pole([hip, knee, ankle]: [DVec3; 3], target: DVec3, forward: DVec3) -> DVec3 {
    let axis = (ankle - hip).normalize_or(DVec3::NEG_Y);
    let aside = |vector: DVec3| vector - axis * vector.dot(axis);
    let now = aside(knee - hip);
    let (upper, lower) = (hip.distance(knee), knee.distance(ankle));
    let distance = hip.distance(target).clamp((upper - lower).abs() + 1e-6, upper + lower);
    let along = (upper * upper - lower * lower + distance * distance) / (2.0 * distance);
    let then = (upper * upper - along * along).max(0.0).sqrt();
    now + aside(forward).normalize_or_zero() * (then - now.length()).max(1e-9)
}

/// m, (goals): how far the pelvis must sink so that feet that bear are reached.
fn sinking(capture: &Capture, start: usize, goals: &[Goal]) -> Vec<f64> {
    let body = &capture.body;
    let need: Vec<f64> = goals
        .iter()
        .enumerate()
        .map(|(index, goal)| {
            let places = capture.at(start + index);
            let of = |side: Side| {
                let foot = &goal.feet[side as usize];
                let [hip, knee, ankle] = leg(body, side);
                let length = places[hip].distance(places[knee]) + places[knee].distance(places[ankle]);
                let was = places[hip].distance(places[ankle]) / length;
                let reach = length * was.clamp(STRAIGHTEST, 0.9999);
                let hip = places[hip] + goal.body;
                let across = (hip - foot.ankle) * DVec3::new(1.0, 0.0, 1.0);
                let highest = foot.ankle.y + (reach * reach - across.length_squared()).max(0.0).sqrt();
                if foot.bears { (hip.y - highest).max(0.0) } else { 0.0 }
            };
            of(Side::Left).max(of(Side::Right))
        })
        .collect();
    let deepest = DEEPEST * body.leg_length;
    if need.iter().all(|need| *need < 1e-6) {
        return vec![0.0; goals.len()];
    }
    // Each need is a hat with eased sides; their maximum, which at the ends of the piece is 0.
    let wide = (SINKS * capture.fps).round().max(2.0);
    let last = goals.len().saturating_sub(1);
    (0..goals.len())
        .map(|index| {
            let hats = need.iter().enumerate().map(|(at, need)| {
                let u = (1.0 - (at as f64 - index as f64).abs() / wide).clamp(0.0, 1.0);
                need * u * u * (3.0 - 2.0 * u)
            });
            let edge = (index.min(last - index) as f64 / (0.25 * wide)).min(1.0);
            (hats.fold(0.0, f64::max) * edge).min(deepest)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::fixture;

    /// Some frames of a body that stands with bent knees.
    fn standing() -> Capture {
        let body = fixture::body();
        let count = body.joints.len();
        let mut capture = Capture {
            name: "stand".into(),
            fps: 30.0,
            positions: (0..40).flat_map(|_| body.joints.iter().map(|joint| joint.rest)).collect(),
            turns: vec![DQuat::IDENTITY; 40 * count],
            body,
            units_to_metres: 1.0,
            up: "+Y".into(),
            confidence: 1.0,
            method: String::new(),
            notes: Vec::new(),
            pushes: Vec::new(),
        };
        let goals: Vec<Goal> = (0..40)
            .map(|frame| {
                let mut goal = as_it_is(&capture, frame, [false; 2]);
                goal.body = DVec3::NEG_Y * 0.05;
                goal
            })
            .collect();
        pose(&capture, 0, &goals).0.swap(&mut capture);
        capture
    }

    #[test]
    fn what_is_where_it_shall_be_stays_to_the_bit() {
        let capture = standing();
        let goals: Vec<Goal> = (5..20).map(|frame| as_it_is(&capture, frame, [true; 2])).collect();
        let (piece, missed) = pose(&capture, 5, &goals);
        assert_eq!(missed, 0.0);
        assert!(piece == Piece::cut(&capture, 5, 19));
    }

    #[test]
    fn a_moved_pelvis_leaves_the_feet_and_the_lengths() {
        let capture = standing();
        let goals: Vec<Goal> = (5..=20)
            .map(|frame| {
                let mut goal = as_it_is(&capture, frame, [true; 2]);
                goal.body = DVec3::X * 0.15;
                goal
            })
            .collect();
        let (piece, missed) = pose(&capture, 5, &goals);
        assert!(missed < 1e-9, "{missed}");
        let mut posed = capture.clone();
        piece.swap(&mut posed);
        for side in Side::BOTH {
            let [hip, knee, ankle] = leg(&capture.body, side);
            let (was, is) = (capture.at(12), posed.at(12));
            assert!(was[ankle].distance(is[ankle]) < 1e-9);
            assert!((is[hip].x - was[hip].x - 0.15).abs() < 1e-12);
            for (a, b) in [(hip, knee), (knee, ankle)] {
                assert!((was[a].distance(was[b]) - is[a].distance(is[b])).abs() < 1e-9, "a bone's length");
            }
            assert!(posed.turns_at(12)[ankle] == capture.turns_at(12)[ankle], "the foot keeps its turn");
        }
    }

    #[test]
    fn the_pelvis_sinks_where_a_foot_that_bears_is_out_of_reach() {
        let capture = standing();
        let goals: Vec<Goal> = (0..40)
            .map(|frame| {
                let mut goal = as_it_is(&capture, frame, [true; 2]);
                if (15..25).contains(&frame) {
                    goal.feet[0].ankle.x += 0.42;
                }
                goal
            })
            .collect();
        let (piece, missed) = pose(&capture, 0, &goals);
        assert!(missed < 1e-9, "missed by {missed}");
        let mut posed = capture.clone();
        piece.swap(&mut posed);
        assert!(posed.at(20)[0].y < capture.at(20)[0].y - 0.005, "it sinks");
        assert!(posed.at(0)[0] == capture.at(0)[0], "but not far from there");
    }
}

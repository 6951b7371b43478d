//! Feet of a walking clip, held while they bear.
//!
//! Captured and keyed feet slide by millimetres to centimetres while they bear. Here each contact has one place: the foot turns about
//! its heel (or its ball, walking backward) until it is flat, lies, and turns about its ball (or heel) until it leaves; what that costs
//! is taken back in the swing. Scenario
//! space, metres, seconds. Rigs without toes roll over the tip of the sole.

use super::BaseFrame;
use super::bearing::Bears;
use super::foot::to_ball;
use super::gait::Fall;
use crate::maths::curve::smooth3;
use crate::model::report::Part;
use crate::model::{Body, Plant, Role, Side};
use crate::whole_body::FootTarget;
use crate::whole_body::stand::foot_yaw;
use glam::{DQuat, DVec3};

/// m at a leg of 0.83 m: a heel or ball that is farther over the other's floor is up.
const UP: f64 = 0.015;
/// m at a leg of 0.83 m: a foot that is so far from where it lies does not stand there yet, or no more.
const OFF: f64 = 0.1;
/// m at a leg of 0.83 m: a foot that lies nearer to the ground is put on it.
const GROUNDED: f64 = 0.05;
/// s, in which the speed that a held foot has against the clip's is let go in the air.
const CARRIES: f64 = 0.2;
/// s: as long before and after a frame that is kept the clip's own sinking feet sink.
const KEPT: f64 = 0.12;
/// s at a leg of 0.83 m: a foot that stands until so shortly before a frame that is kept, or from so shortly after it, stands as the clip's
/// does then.
const CLOSE: f64 = 0.25;
/// s: as long before and after a frame that is kept a leg does not stretch farther than it does,
const NEAR_KEPT: f64 = 0.25;
/// of its length, than that.
const REACHES: f64 = 1.002;
/// m, the same of its height.
const OVER: f64 = 0.012;

/// A foot as a clip has it: ankle, foot and toe.
#[derive(Clone, Copy, Debug)]
struct Posed {
    hip: DVec3,
    ankle: DVec3,
    foot: DQuat,
    toe: DQuat,
}

/// A foot's targets, held while it bears, and when it does.
pub(super) fn hold(
    body: &Body,
    side: Side,
    frames: &[BaseFrame],
    contacts: &[&Bears],
    (fps, size): (f64, f64),
    (exact, other): (&[usize], &dyn Fn(usize) -> bool),
) -> (Vec<FootTarget>, Vec<Fall>) {
    let shape = &body.feet[side as usize];
    let role = if side == Side::Left { Role::LeftFoot } else { Role::RightFoot };
    let ankle = body.joint(role).unwrap_or(shape.ankle);
    let [hip, knee] = match side {
        Side::Left => [Role::LeftUpperLeg, Role::LeftLowerLeg],
        Side::Right => [Role::RightUpperLeg, Role::RightLowerLeg],
    }
    .map(|role| body.joint(role).unwrap_or(ankle));
    let rest = |joint: usize| body.joints[joint].rest;
    let leg = rest(hip).distance(rest(knee)) + rest(knee).distance(rest(ankle));
    let posed: Vec<Posed> = frames
        .iter()
        .map(|frame| {
            let positions = frame.pose.positions(body);
            let foot = frame.pose.turns[ankle];
            let toe = shape.toe.map_or(foot, |toe| frame.pose.turns[toe]);
            Posed { hip: positions[hip], ankle: positions[ankle], foot, toe }
        })
        .collect();
    let to_ball = to_ball(body, side);
    let to_heel = shape.heel_point();
    let mut held: Vec<Option<Posed>> = vec![None; posed.len()];
    let mut falls = Vec::new();
    for contact in contacts {
        let (mut first, mut last) = (contact.start, contact.end);
        let heel = |frame: usize| (posed[frame].ankle + posed[frame].foot * to_heel).y;
        let ball = |frame: usize| {
            let at = posed[frame].ankle + posed[frame].foot * to_ball;
            // Over the ball is the sole, lower by what the foot's own shape has.
            at.y - (to_ball_height(body, side))
        };
        // A foot that comes down on its heel rolls forward over it; one that walks backward comes down on its ball.
        let pitch = |frame: usize| ball(frame) - heel(frame);
        let is_flat = |frame: &usize| pitch(*frame).abs() < UP * size;
        let flattest = (first..=last).min_by(|a, b| pitch(*a).abs().total_cmp(&pitch(*b).abs())).unwrap_or(first);
        let mut flat_from = (first..=last).find(is_flat).unwrap_or(flattest);
        let mut flat_to = (flat_from..=last).rfind(is_flat).unwrap_or(flat_from);
        let part = |frame: usize| if pitch(frame) > 0.0 { Part::Heel } else { Part::Ball };
        let pivot = |part: Part| if part == Part::Heel { to_heel } else { to_ball };
        let parts = [part(first), part(last)];
        let [comes, leaves] = parts.map(pivot);
        let inside = |frame: &usize| (first..=last).contains(frame);
        let kept = exact.iter().copied().find(inside);
        let close = (CLOSE * size.sqrt() * fps) as usize;
        let near = exact.iter().copied().find(|frame| *frame + close >= first && *frame <= last + close);
        let anchor = kept.or(near.map(|frame| frame.clamp(first, last)));
        let mut lies = posed[anchor.map_or((flat_from + flat_to) / 2, |frame| frame.clamp(flat_from, flat_to))];
        let (from, to) = (posed[flat_from], posed[flat_to]);
        // Where it is not yet, or no more, it does not stand.
        let away = |frame: usize, to_point: DVec3| {
            let off = posed[frame].ankle + posed[frame].foot * to_point - lies.ankle - lies.foot * to_point;
            off.y > OVER * size || (off * DVec3::new(1.0, 0.0, 1.0)).length() > OFF * size
        };
        while first < flat_from && away(first, comes) && other(first) {
            first += 1;
        }
        while last > flat_to && away(last, leaves) && other(last) && other(last - 1) {
            last -= 1;
        }
        let kept = kept.filter(|frame| (first..=last).contains(frame));
        // What it turns about then is where the clip has it.
        if let Some(frame) = anchor.map(|frame| frame.clamp(first, last)) {
            let pivot = if frame < flat_from { comes } else { leaves };
            if !(flat_from..=flat_to).contains(&frame) {
                lies.ankle += posed[frame].ankle + posed[frame].foot * pivot - lies.ankle - lies.foot * pivot;
            }
        }
        // On the ground, where the clip's may float or sink by what keys and shoes are off.
        let over = sole_height(body, side, &lies);
        if kept.is_none() && over.abs() < GROUNDED * size {
            lies.ankle.y -= over;
        }
        let at = |pivot: DVec3| lies.ankle + lies.foot * pivot;
        let (comes_at, leaves_at) = (at(comes), at(leaves));
        // Near a frame that is kept the body is where the clip has it: a leg that does not reach there does not stand.
        let short = |frame: usize| {
            let close = |exact: &usize| *exact != frame && exact.abs_diff(frame) as f64 <= NEAR_KEPT * fps;
            let own = posed[frame];
            let ankle = if (flat_from..=flat_to).contains(&frame) {
                lies.ankle
            } else {
                let (flat, pivot, at) =
                    if frame < flat_from { (&from, comes, comes_at) } else { (&to, leaves, leaves_at) };
                at - own.foot * flat.foot.inverse() * lies.foot * pivot
            };
            exact.iter().any(close) && !exact.contains(&frame) && own.hip.distance(ankle) > leg * REACHES
        };
        while first < last && short(first) && other(first) {
            first += 1;
        }
        while last > first && short(last) && other(last) && other(last - 1) {
            last -= 1;
        }
        (flat_from, flat_to) = (flat_from.max(first.min(flat_to)), flat_to.min(last.max(flat_from)));
        for frame in first..=last {
            let own = posed[frame];
            let rolled = |flat: &Posed, (part, pivot, at): (Part, DVec3, DVec3), turns: usize, kept: Option<usize>| {
                let foot = (own.foot * flat.foot.inverse() * lies.foot).normalize();
                let toe = (own.toe * flat.toe.inverse() * lies.toe).normalize();
                // Toes lie while the foot rolls over them, but for how the clip has them at a frame that is kept.
                let as_clip = match kept {
                    _ if part == Part::Heel => 1.0,
                    Some(kept) => smooth3(frame.abs_diff(turns) as f64 / kept.abs_diff(turns) as f64),
                    None => 0.0,
                };
                Posed { ankle: at - foot * pivot, foot, toe: lies.toe.slerp(toe, as_clip), ..own }
            };
            held[frame] = Some(if frame < flat_from {
                let kept = kept.filter(|kept| *kept < flat_from);
                rolled(&from, (parts[0], comes, comes_at), flat_from, kept)
            } else if frame <= flat_to {
                lies
            } else {
                rolled(&to, (parts[1], leaves, leaves_at), flat_to, kept.filter(|kept| *kept > flat_to))
            });
        }
        let yaw = foot_yaw(body, side, lies.foot);
        let time = |frame: usize| frame as f64 / fps;
        falls.push(Fall {
            side,
            down: time(first),
            flat: time(flat_from.clamp(first, last)),
            ball: time(flat_to.clamp(first, last)),
            up: time(last),
            parts,
            plant: Plant::level(DVec3::new(lies.ankle.x, 0.0, lies.ankle.z), yaw),
        });
    }
    // In the air: what the two contacts took is handed over on the way.
    let count = posed.len();
    let mut frame = 0;
    while frame < count {
        if held[frame].is_some() {
            frame += 1;
            continue;
        }
        let begin = frame;
        while frame < count && held[frame].is_none() {
            frame += 1;
        }
        let off = |at: Option<usize>| {
            at.and_then(|at| held[at].map(|held| (at, held))).map(|(at, held)| {
                let own = posed[at];
                (held.ankle - own.ankle, held.foot * own.foot.inverse(), held.toe * own.toe.inverse())
            })
        };
        let before = off(begin.checked_sub(1));
        let after = off((frame < count).then_some(frame));
        let none = (DVec3::ZERO, DQuat::IDENTITY, DQuat::IDENTITY);
        let (from, to) = (before.or(after).unwrap_or(none), after.or(before).unwrap_or(none));
        let kept = exact.iter().copied().find(|exact| (begin..frame).contains(exact));
        // It leaves and comes with the speed that it has on the ground.
        let off_by = |at: usize| held[at].map(|held| held.ankle - posed[at].ankle);
        let slope = |from: Option<usize>, to: Option<usize>| {
            let both = from.zip(to).filter(|(from, to)| *to < count && held[*from].is_some() && held[*to].is_some());
            both.and_then(|(from, to)| off_by(to).zip(off_by(from))).map_or(DVec3::ZERO, |(to, from)| to - from)
        };
        let (leaves, comes) = (
            slope(begin.checked_sub(2), begin.checked_sub(1)),
            slope(Some(frame).filter(|f| *f < count), Some(frame + 1)),
        );
        let carries = |frames: usize, since: usize| {
            let whole = (CARRIES * fps).min(0.5 * frames as f64).max(1.0);
            let since = since as f64;
            if since < whole { since * (1.0 - since / whole).powi(2) } else { 0.0 }
        };
        for at in begin..frame {
            let along = |from: usize, to: usize| smooth3((at + 1 - from) as f64 / (to + 1 - from).max(1) as f64);
            let (from, to, share) = match kept {
                Some(kept) if at <= kept => (from, none, along(begin, kept)),
                Some(kept) => (none, to, along(kept, frame)),
                None => (from, to, along(begin, frame)),
            };
            let share = if kept == Some(at) { 1.0 } else { share };
            let own = posed[at];
            let (gone, left) = match kept {
                Some(kept) => (carries(kept - begin, at + 1 - begin), carries(frame - 1 - kept, frame - at)),
                None => (carries(frame - begin, at + 1 - begin), carries(frame - begin, frame - at)),
            };
            let carried = match kept {
                Some(kept) if at == kept => DVec3::ZERO,
                Some(kept) if at < kept => leaves * gone,
                Some(_) => -comes * left,
                None => leaves * gone - comes * left,
            };
            let mut swings = Posed {
                hip: own.hip,
                ankle: own.ankle + from.0.lerp(to.0, share) + carried,
                foot: (from.1.slerp(to.1, share) * own.foot).normalize(),
                toe: (from.2.slerp(to.2, share) * own.toe).normalize(),
            };
            // It swings over the ground; into it as the clip's at a frame that is kept.
            let as_clip = exact.iter().map(|exact| 1.0 - exact.abs_diff(at) as f64 / (KEPT * fps)).fold(0.0, f64::max);
            let sunk = as_clip * sole_height(body, side, &own).min(0.0) - sole_height(body, side, &swings);
            swings.ankle.y += sunk.max(0.0);
            held[at] = Some(swings);
        }
    }
    let target = |held: &Option<Posed>, own: &Posed| {
        let held = held.as_ref().unwrap_or(own);
        FootTarget {
            ankle: held.ankle,
            foot: held.foot,
            toe: held.toe,
            yaw: foot_yaw(body, side, held.foot),
            soft: 0.0,
            bend: None,
            swivel: 0.0,
        }
    };
    (held.iter().zip(&posed).map(|(held, own)| target(held, own)).collect(), falls)
}

/// m, the lowest point of a sole.
fn sole_height(body: &Body, side: Side, posed: &Posed) -> f64 {
    let shape = &body.feet[side as usize];
    let toe = shape.toe.map(|toe| body.joints[toe].rest - body.joints[shape.ankle].rest);
    let rear = shape.rear_sole.iter().map(|vertex| (posed.foot * *vertex).y);
    let front = shape.front_sole.iter().map(|vertex| match toe {
        Some(toe) => (posed.foot * toe + posed.toe * (*vertex - toe)).y,
        None => (posed.foot * *vertex).y,
    });
    let lowest = rear.chain(front).fold(f64::INFINITY, f64::min);
    posed.ankle.y + if lowest.is_finite() { lowest } else { -shape.ankle_height }
}

/// m, RMS over the frames in which feet bear: how far they are held from where the clip has them.
pub(super) fn strays(body: &Body, (frames, fps): (&[BaseFrame], f64), contacts: &[Bears]) -> f64 {
    let size = (body.leg_length / 0.83).max(1e-3);
    let (mut sum, mut count) = (0.0, 0.0);
    for side in Side::BOTH {
        let own: Vec<&Bears> = contacts.iter().filter(|contact| contact.side == side).collect();
        let bears =
            |frame: usize| contacts.iter().any(|one| one.side != side && (one.start..=one.end).contains(&frame));
        let (targets, _) = hold(body, side, frames, &own, (fps, size), (&[], &bears));
        let ankle = body.feet[side as usize].ankle;
        for contact in own {
            for frame in contact.start..=contact.end.min(frames.len() - 1) {
                let off = targets[frame].ankle - frames[frame].pose.positions(body)[ankle];
                sum += off.length_squared();
                count += 1.0;
            }
        }
    }
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}

/// m, how far the ball joint is over the sole of a level foot.
fn to_ball_height(body: &Body, side: Side) -> f64 {
    let shape = &body.feet[side as usize];
    let levelled = shape.level * to_ball(body, side);
    levelled.y + shape.ankle_height
}

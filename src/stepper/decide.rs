//! Decisions: whether to step, with which foot and which way past the other leg, when to lift it, where to aim it.
//!
//! The three regions of the paper: ξ near its aim, nothing; inside the soles, ankle feedback alone (`balance`); outside of
//! them a corrective step. Then the trailing foot follows, and what is still uncomfortable is mended without hurry.

use super::balance::steady_lean;
use super::foothold::{ankles, beside, corrective, middle_after};
use super::footing::{ROOM, apart, set_down_by, stepped};
use super::support::{Support, Tread};
use super::{Intent, Params, Passing, Physique, Plant, State, StepKind, Swing};
use super::{control::wrap, footfall, foothold, ground, swing};
use crate::maths::pendulum;
use crate::maths::real;
use crate::model::scenario::Trigger;
use crate::model::{Side, Terrain};
use glam::{DVec2, DVec3};

/// Share of a swing from which on it lands on the side of the other foot that it is going to.
const LATE: f64 = 0.6;

/// What to do with both feet down.
pub fn decide(params: &Params, physique: &Physique, state: &mut State) {
    let lean = steady_lean(physique, state);
    let xi = state.xi() + lean;
    let hard = ((state.touch.length() / params.foresee - 1.0) / 0.8).clamp(0.0, 1.0);
    let coming = foothold::expected(params, physique, state, params.expect) * (hard / state.omega());
    let out = match params.trigger {
        Trigger::Extrapolated => state.outline.outside(xi + coming),
        Trigger::Projected => state.outline.outside(ground(state.com)),
    } + params.outer;
    let corrective_now = matches!(state.intent, Some(Intent { kind: StepKind::Corrective, .. }));
    if out > 0.0 || (corrective_now && out > -0.02 * params.size) {
        state.intent = Some(choose(params, physique, state));
        return;
    }
    if discomfort(params, state) <= 1.0 {
        state.intent = None;
        return;
    }
    if let Some(intent @ Intent { kind: StepKind::FollowUp | StepKind::Comfort, .. }) = state.intent {
        state.intent = Some(Intent { committed: may_follow(params, physique, state, &intent), ..intent });
        return;
    }
    let recovering = state.recovering < params.tempo;
    let kind = if recovering { StepKind::FollowUp } else { StepKind::Comfort };
    state.intent = None;
    if kind == StepKind::Comfort && state.calm < params.pause - params.instant {
        return;
    }
    let gap = |side: Side| ground(state.feet[side as usize].ankle).distance(xi);
    let near_tie = (gap(Side::Left) - gap(Side::Right)).abs() < 1e-6 * params.size;
    let side = if near_tie {
        params.lead
    } else if gap(Side::Left) > gap(Side::Right) {
        Side::Left
    } else {
        Side::Right
    };
    state.intent = Some(Intent { side, kind, passing: Passing::Own, committed: false });
}

/// The foot whose corrective step serves best, and its way past the other leg.
fn choose(params: &Params, physique: &Physique, state: &State) -> Intent {
    let cost = |side: Side, passing: Passing| {
        let swing_time = params.swing;
        let wait = (params.reaction - state.alarm).max(params.double_support - state.settled).max(0.0);
        let stance = &state.feet[side.other() as usize];
        let sole = Support::one(params, physique, stance, Tread::Whole, params.margin);
        let shift = sole.outside(state.cop).max(0.0);
        let wait = wait.max(params.lag * real::ln(1.0 + shift / (0.01 * params.size)));
        let hold = corrective(params, physique, state, side, passing, (wait + swing_time, swing_time));
        let step = ground(hold.plant.ankle).distance(ground(state.feet[side as usize].ankle));
        let hop = 0.12 * (1.0 - step / (0.2 * params.size)).max(0.0);
        let again = if state.last == Some(side) && state.recovering < params.tempo { 0.06 } else { 0.0 };
        let keep = match state.intent {
            Some(Intent { kind: StepKind::Corrective, side: other, .. }) if other != side => 0.04,
            _ => 0.0,
        };
        let crossing = params.cost_cross * hold.across
            + match passing {
                Passing::Own => 0.0,
                Passing::Front => 0.02 * params.size,
                Passing::Behind => 0.05 * params.size,
            };
        (hold.miss + 0.35 * hold.off + 0.15 * step + params.cost_speed * hold.speed + crossing) / params.size
            + again
            + keep
            + hop
    };
    // one crossing at a time
    let apart = ground(state.feet[0].ankle - state.feet[1].ankle).dot(state.aside());
    let ways: &[Passing] =
        if apart > 0.9 * params.gap { &[Passing::Own, Passing::Front, Passing::Behind] } else { &[Passing::Own] };
    let best = |side: Side| {
        let mut found = (f64::INFINITY, Passing::Own);
        for &way in ways {
            let price = cost(side, way);
            if price < found.0 {
                found = (price, way);
            }
        }
        found
    };
    let (left, right) = (best(Side::Left), best(Side::Right));
    let left_first = if (left.0 - right.0).abs() < 1e-6 { params.lead == Side::Left } else { left.0 < right.0 };
    let (side, passing) = if left_first { (Side::Left, left.1) } else { (Side::Right, right.1) };
    Intent { side, kind: StepKind::Corrective, passing, committed: true }
}

/// Lifts the foot that is meant to step, once it may.
pub fn lift(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, dt: f64) -> Option<Side> {
    let intent = state.intent?;
    let from = state.feet[intent.side as usize];
    let stance = state.feet[intent.side.other() as usize];
    let sole = Support::one(params, physique, &stance, Tread::Whole, 0.5 * params.margin);
    if state.settled < params.double_support - params.instant || sole.outside(state.cop) > 0.0 {
        return None;
    }
    let swing_time = match intent.kind {
        StepKind::Corrective => {
            if state.alarm < params.reaction - params.instant && state.recovering > params.tempo {
                return None;
            }
            let speed = ground(state.velocity) * (params.tempo / params.size);
            let sideways = speed.dot(state.aside()).abs() / (speed.length() + 1e-9);
            let sideways = if intent.passing == Passing::Own { sideways } else { 0.0 };
            params.swing * (1.0 - 0.12 * (speed.length() / 1.5).min(1.0)) * (1.0 - 0.14 * sideways)
        }
        StepKind::FollowUp | StepKind::Comfort if !intent.committed => return None,
        StepKind::FollowUp | StepKind::Walk | StepKind::Held => params.follow_swing,
        StepKind::Comfort => params.comfort_swing,
    };
    let ticks = (swing_time / dt).round().max(2.0);
    let to = if intent.kind == StepKind::Corrective {
        corrective(params, physique, state, intent.side, intent.passing, (ticks * dt, ticks * dt)).plant
    } else {
        beside(params, state, intent.side)
    };
    let land = state.time + ticks * dt;
    let aim = ground(to.ankle);
    let to = set_down_by(terrain, physique, &stance, aim, (to.yaw, land));
    let ahead = state.ahead;
    let round = match intent.passing {
        Passing::Own => swing::round(ground(from.ankle), ground(to.ankle), ground(stance.ankle), -ahead),
        Passing::Front => ahead,
        Passing::Behind => -ahead,
    };
    state.swing = Some(Swing {
        side: intent.side,
        kind: intent.kind,
        lift: state.time,
        land,
        from,
        to,
        off: 0.0,
        aim,
        passing: intent.passing,
        round,
        detour: swing::detour(ground(from.ankle), ground(to.ankle), ground(stance.ankle), round, params.gap),
    });
    state.intent = None;
    Some(intent.side)
}

/// May the weight go to the stance foot now, for the other one to come beside it? Once it is on its way, a little less
/// will do, or the two would chase each other.
fn may_follow(params: &Params, physique: &Physique, state: &State, intent: &Intent) -> bool {
    let time = if intent.kind == StepKind::Comfort { params.comfort_swing } else { params.follow_swing };
    let stance = &state.feet[intent.side.other() as usize];
    let sole = Support::one(params, physique, stance, Tread::Whole, params.margin);
    let fin = middle_after(params, state, intent.side);
    let pivot = pendulum::pivot_for(state.xi(), fin, state.omega(), time);
    if intent.committed {
        return followed(params, physique, state, intent.side, time).1.length() < 0.06 * params.size;
    }
    sole.outside(pivot) <= 0.0 || trailing(params, physique, state, intent.side)
}

/// Is that foot being left behind, so that it had better come at once, and will both feet hold the fall when it has?
fn trailing(params: &Params, physique: &Physique, state: &State, side: Side) -> bool {
    let behind = ground(state.com) - ground(state.feet[side as usize].ankle);
    let leaving = behind.dot(ground(state.velocity)) > 0.05 * params.trail * params.size / params.tempo;
    behind.length() > params.trail && leaving && {
        let slip = followed(params, physique, state, side, params.follow_swing + 2.5 * params.lag).1;
        slip.length() < params.margin
    }
}

/// The follow-up's landing beside the other foot when it comes `time` s from now, and by how much ξ will then be
/// outside of both feet, steered as well as may be.
fn followed(params: &Params, physique: &Physique, state: &State, side: Side, time: f64) -> (Plant, DVec2) {
    let stance = &state.feet[side.other() as usize];
    let comfortable = beside(params, state, side);
    let area = Support::two(params, physique, [stance, &comfortable], [Tread::Whole; 2], 2.0 * params.margin);
    let sole = Support::one(params, physique, stance, Tread::Whole, params.margin);
    let fin = middle_after(params, state, side);
    let xi = state.xi();
    let pivot = sole.nearest(pendulum::pivot_for(xi, fin, state.omega(), time));
    let lands = pendulum::carried(xi, pivot, state.omega(), time);
    (comfortable, lands - area.nearest(lands))
}

/// Aims the swing at where it is needed now; the last quarter flies as planned.
pub fn replan(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, dt: f64) {
    let Some(mut swing) = state.swing else { return };
    if swing.kind == StepKind::Held || swing::phase(&swing, state.time) > 0.75 {
        return;
    }
    let left_over = swing.land - state.time;
    let whole = swing.land - swing.lift;
    let stance = ground(state.feet[swing.side.other() as usize].ankle);
    let wanted = if swing.kind == StepKind::Corrective {
        corrective(params, physique, state, swing.side, swing.passing, (left_over, whole)).plant
    } else if swing.kind == StepKind::Walk {
        let (footfall, land) = footfall::replan(params, physique, terrain, state, &swing, dt);
        (swing.land, state.gait.until, swing.off) = (land, land, footfall.off);
        footfall.plant
    } else {
        let (comfortable, slip) = followed(params, physique, state, swing.side, left_over);
        let ankle = ground(comfortable.ankle) + slip;
        let out = state.aside() * swing.side.sign();
        let ankle = ankle + out * (params.gap - (ankle - stance).dot(out)).max(0.0);
        Plant { ankle: DVec3::new(ankle.x, 0.0, ankle.y), ..comfortable }
    };
    let most = params.retarget * dt;
    swing.aim += (ground(wanted.ankle) - swing.aim).clamp_length_max(most);
    let beside = landing(params, physique, state, &swing, wanted.yaw);
    let by = state.feet[swing.side.other() as usize];
    swing.to = stepped(params, (terrain, physique), state, &by, beside, (wanted.yaw, swing.land));
    let detour = swing::detour(ground(swing.from.ankle), ground(swing.to.ankle), stance, swing.round, params.gap);
    swing.detour += (detour - swing.detour).clamp_length_max(most);
    state.swing = Some(swing);
}

/// Where the foot lands that is aimed there: beside the foot that stands and not on it. Late in a swing it no longer
/// changes to another side of it.
fn landing(params: &Params, physique: &Physique, state: &State, swing: &Swing, yaw: f64) -> DVec2 {
    let stance = &state.feet[swing.side.other() as usize];
    let plant = Plant::level(DVec3::new(swing.aim.x, 0.0, swing.aim.y), yaw);
    let beside = ground(apart(physique, stance, &plant, swing.side, ROOM * params.size).ankle);
    let late = swing::phase(swing, state.time) > LATE && beside.distance(ground(swing.to.ankle)) > 0.1 * params.size;
    if late { ground(swing.to.ankle) } else { beside }
}

/// How uncomfortable the stand is; over 1 it wants mending.
fn discomfort(params: &Params, state: &State) -> f64 {
    let [left_foot, right_foot] = ankles(state);
    let apart = left_foot - right_foot;
    let stance = &params.stance;
    let wide = (apart.dot(state.aside()) - stance.apart.x).abs() / (params.widen * params.width);
    let staggered = (apart.dot(state.ahead) - stance.apart.y).abs() / params.stagger;
    let twisted = Side::BOTH
        .into_iter()
        .map(|side| wrap(state.feet[side as usize].yaw - state.facing - stance.yaws[side as usize]).abs())
        .fold(0.0, f64::max)
        / params.twist;
    wide.max(staggered).max(twisted)
}

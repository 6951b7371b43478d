//! The tick: perceive, decide, plan, move the centre of pressure, integrate, land. Scenario space, SI units.

use super::foothold::{self, beside, corrective, middle, steady_lean};
use super::support::{Support, Tread};
use super::{Inputs, Intent, Params, Passing, Physique, Plant, State, Step, StepKind, Swing, TickOutput, Trigger};
use super::{ground, support, swing};
use crate::maths::pendulum::{self, GRAVITY};
use crate::model::Side;
use glam::{DVec2, DVec3};

/// One tick of `dt` s. Does nothing once balance is lost.
pub fn tick(params: &Params, physique: &Physique, state: &mut State, inputs: &Inputs, dt: f64) -> TickOutput {
    let mut output = TickOutput::default();
    if state.lost.is_some() {
        return output;
    }
    perceive(params, physique, state, inputs, dt);
    if state.swing.is_none() {
        decide(params, physique, state);
        output.lifted = lift(params, physique, state, dt);
    }
    replan(params, physique, state, dt);
    let wanted = pressure(params, physique, state);
    state.cop += (wanted - state.cop) * (1.0 - (-dt / params.lag).exp());
    integrate(params, physique, state, inputs, dt);
    state.tick += 1;
    state.time = state.tick as f64 * dt;
    output.landed = advance(params, state, dt);
    judge(params, physique, state, dt);
    output.lost = state.lost.is_some();
    output
}

fn perceive(params: &Params, physique: &Physique, state: &mut State, inputs: &Inputs, dt: f64) {
    let force = ground(inputs.force);
    let slow = if force.length_squared() > state.felt.length_squared() { 0.8 * params.tempo } else { params.sense };
    state.felt += (force - state.felt) * (1.0 - (-dt / slow).exp());
    let tipping = inputs.moment.cross(DVec3::Y) / (physique.mass * physique.com_height);
    state.tip += ground(tipping) * (params.tipping * dt);
    if state.felt.length() < 1e-9 * physique.mass {
        state.felt = DVec2::ZERO;
    }
    let turn = wrap(inputs.facing - state.facing);
    let most = 3.0 * dt / params.tempo;
    state.facing += turn.clamp(-most, most);
    state.settled += dt;
    state.recovering += dt;
    let aim = middle(params, state.facing, ankles(state));
    let shoved = force.length() > 0.08 * physique.mass * GRAVITY;
    state.touch += (force - state.touch) * (1.0 - (-dt / (0.5 * params.sense)).exp());
    state.pushed = if shoved { state.pushed + dt } else { 0.0 };
    if shoved || (state.xi() - aim).length() > 0.03 * params.size {
        state.alarm += dt;
    } else if state.rest >= params.pause && state.intent.is_none() {
        state.alarm = 0.0;
    }
}

/// What to do with both feet down.
fn decide(params: &Params, physique: &Physique, state: &mut State) {
    let lean = steady_lean(physique, state);
    let xi = state.xi() + lean;
    let feet = [&state.feet[0], &state.feet[1]];
    let outline = Support::two(params, physique, feet, [Tread::Whole; 2], 0.0);
    let out = match params.trigger {
        Trigger::Extrapolated => outline.outside(xi),
        Trigger::Projected => outline.outside(ground(state.com)),
    } + params.outer;
    let corrective_now = matches!(state.intent, Some(Intent { kind: StepKind::Corrective, .. }));
    if out > 0.0 || (corrective_now && out > -0.02 * params.size) {
        state.intent = Some(choose(params, physique, state));
        return;
    }
    if discomfort(params, physique, state) <= 1.0 {
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
    if kind == StepKind::Comfort && state.rest < params.pause {
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
        let wait = wait.max(params.lag * (1.0 + shift / (0.01 * params.size)).ln());
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
    let apart = ground(state.feet[0].ankle - state.feet[1].ankle).dot(support::left(state.facing));
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
fn lift(params: &Params, physique: &Physique, state: &mut State, dt: f64) -> Option<Side> {
    let intent = state.intent?;
    let from = state.feet[intent.side as usize];
    let stance = state.feet[intent.side.other() as usize];
    let sole = Support::one(params, physique, &stance, Tread::Whole, 0.5 * params.margin);
    if state.settled < params.double_support || sole.outside(state.cop) > 0.0 {
        return None;
    }
    let swing_time = match intent.kind {
        StepKind::Corrective => {
            if state.alarm < params.reaction && state.recovering > params.tempo {
                return None;
            }
            let speed = ground(state.velocity) * (params.tempo / params.size);
            let sideways = speed.dot(support::left(state.facing)).abs() / (speed.length() + 1e-9);
            let sideways = if intent.passing == Passing::Own { sideways } else { 0.0 };
            params.swing * (1.0 - 0.12 * (speed.length() / 1.5).min(1.0)) * (1.0 - 0.14 * sideways)
        }
        StepKind::FollowUp | StepKind::Comfort if !intent.committed => return None,
        StepKind::FollowUp => params.follow_swing,
        StepKind::Comfort => params.comfort_swing,
    };
    let ticks = (swing_time / dt).round().max(2.0);
    let to = if intent.kind == StepKind::Corrective {
        corrective(params, physique, state, intent.side, intent.passing, (ticks * dt, ticks * dt)).plant
    } else {
        beside(params, physique, state, intent.side)
    };
    let ahead = support::forward(state.facing);
    let round = match intent.passing {
        Passing::Own => swing::round(ground(from.ankle), ground(to.ankle), ground(stance.ankle), -ahead),
        Passing::Front => ahead,
        Passing::Behind => -ahead,
    };
    state.swing = Some(Swing {
        side: intent.side,
        kind: intent.kind,
        lift: state.time,
        land: state.time + ticks * dt,
        from,
        to,
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
    let fin = middle_after(params, physique, state, intent.side);
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
    let comfortable = beside(params, physique, state, side);
    let area = Support::two(params, physique, [stance, &comfortable], [Tread::Whole; 2], 2.0 * params.margin);
    let sole = Support::one(params, physique, stance, Tread::Whole, params.margin);
    let fin = middle_after(params, physique, state, side);
    let xi = state.xi();
    let pivot = sole.nearest(pendulum::pivot_for(xi, fin, state.omega(), time));
    let lands = pivot + (xi - pivot) * (state.omega() * time).exp();
    (comfortable, lands - area.nearest(lands))
}

/// Aims the swing at where it is needed now; the last quarter flies as planned.
fn replan(params: &Params, physique: &Physique, state: &mut State, dt: f64) {
    let Some(mut swing) = state.swing else { return };
    if swing::phase(&swing, state.time) > 0.75 {
        return;
    }
    let left_over = swing.land - state.time;
    let whole = swing.land - swing.lift;
    let stance = ground(state.feet[swing.side.other() as usize].ankle);
    let wanted = if swing.kind == StepKind::Corrective {
        corrective(params, physique, state, swing.side, swing.passing, (left_over, whole)).plant
    } else {
        let (comfortable, slip) = followed(params, physique, state, swing.side, left_over);
        let ankle = ground(comfortable.ankle) + slip;
        let out = support::left(state.facing) * swing.side.sign();
        let ankle = ankle + out * (params.gap - (ankle - stance).dot(out)).max(0.0);
        Plant { ankle: DVec3::new(ankle.x, 0.0, ankle.y), ..comfortable }
    };
    let most = params.retarget * dt;
    swing.to.ankle += (wanted.ankle - swing.to.ankle).clamp_length_max(most);
    swing.to.yaw = wanted.yaw;
    let detour = swing::detour(ground(swing.from.ankle), ground(swing.to.ankle), stance, swing.round, params.gap);
    swing.detour += (detour - swing.detour).clamp_length_max(most);
    state.swing = Some(swing);
}

/// Where the pressure is wanted, inside what carries.
fn pressure(params: &Params, physique: &Physique, state: &State) -> DVec2 {
    let lean = steady_lean(physique, state);
    let xi = state.xi() + lean;
    if let Some(swing) = &state.swing {
        let stance = &state.feet[swing.side.other() as usize];
        let sole = Support::one(params, physique, stance, Tread::Whole, params.margin);
        let left_over = (swing.land - state.time).max(0.1 * params.tempo);
        if swing.kind == StepKind::Corrective {
            let fin = foothold::over_foot(params, state, swing.side, swing.passing, &swing.to);
            return foothold::braking(params, state, swing.passing, &sole, (xi, fin), left_over);
        }
        let fin = middle(params, state.facing, [ground(stance.ankle), ground(swing.to.ankle)]);
        return sole.nearest(pendulum::pivot_for(xi, fin, state.omega(), left_over));
    }
    let feet = [&state.feet[0], &state.feet[1]];
    let mut aim = middle(params, state.facing, ankles(state));
    if let Some(intent) = state.intent {
        let stance = &state.feet[intent.side.other() as usize];
        let sole = Support::one(params, physique, stance, Tread::Whole, params.margin);
        if intent.kind == StepKind::Corrective {
            return sole.nearest(xi);
        }
        let time = if intent.kind == StepKind::Comfort { params.comfort_swing } else { params.follow_swing };
        let fin = middle_after(params, physique, state, intent.side);
        let pivot = pendulum::pivot_for(xi, fin, state.omega(), time);
        if intent.committed {
            return sole.nearest(pivot);
        }
        let stand = ground(stance.ankle) + support::forward(state.facing) * params.com_forward;
        aim = stand + (fin - stand) * (-state.omega() * time).exp();
    }
    let area = Support::two(params, physique, feet, [Tread::Whole; 2], params.margin);
    let error = xi - aim;
    let far = (error.length() / params.inner).min(1.0);
    let awake = (state.alarm / params.delay).min(1.0);
    let far = if state.intent.is_some() { 1.0 } else { far };
    area.nearest(xi + error * (params.gain * awake * awake * far * far))
}

fn integrate(params: &Params, physique: &Physique, state: &mut State, inputs: &Inputs, dt: f64) {
    let rest = rest_height(params, physique, state).min(physique.com_height - state.arc);
    let push = inputs.force / physique.mass;
    let spring = (params.spring * (rest - state.com.y) - params.damper * state.velocity.y) / physique.mass;
    let wanted = match &state.swing {
        // the stance leg gives way, so that the fall is caught by the landing foot and not pushed on by the other
        Some(swing) if swing.kind == StepKind::Corrective => {
            let left_over = (swing.land - state.time).max(dt);
            let drop = landing_height(params, physique, state) - state.com.y - state.velocity.y * left_over;
            (2.0 * params.give * drop / (left_over * left_over)).min(0.0)
        }
        _ => spring,
    };
    let lift =
        state.lift + (wanted.clamp(-0.35 * GRAVITY, 1.0 * GRAVITY) - state.lift) * (1.0 - (-dt / params.leg_lag).exp());
    let lift = if lift.abs() < 1e-12 * GRAVITY { 0.0 } else { lift };
    state.lift = lift;
    let tip = state.tip * (1.0 / (0.2 * params.tempo));
    state.tip -= tip * dt;
    let flat = (ground(state.com) - state.cop) * ((GRAVITY + lift) / state.com.y) + tip;
    let acceleration = DVec3::new(flat.x + push.x, lift + push.y, flat.y + push.z);
    state.com += state.velocity * dt + acceleration * (0.5 * dt * dt);
    state.velocity += acceleration * dt;
    state.acceleration = acceleration;
    let off = Side::BOTH
        .into_iter()
        .filter(|&side| state.planted(side))
        .map(|side| hip(params, state, side).distance_squared(ground(state.feet[side as usize].ankle)))
        .fold(f64::INFINITY, f64::min);
    let height = physique.com_height;
    let arc = params.slip_arc * (height - (height * height - off.min(0.5 * height * height)).sqrt());
    state.arc += (arc - state.arc) * (1.0 - (-dt / (0.06 * params.tempo)).exp());
}

/// The height that the legs allow: each spring's rest length makes up for gravity, the longest is the whole leg.
fn rest_height(params: &Params, physique: &Physique, state: &State) -> f64 {
    let mut height = physique.com_height;
    for side in Side::BOTH {
        let (ankle, weight) = match &state.swing {
            Some(swing) if swing.side == side => {
                let u = swing::phase(swing, state.time);
                (ground(swing.to.ankle), u * u * (3.0 - 2.0 * u))
            }
            _ => (ground(state.feet[side as usize].ankle), 1.0),
        };
        let allowed = leg_height(params, physique, state, side, ankle);
        height = height.min(physique.com_height + (allowed - physique.com_height) * weight);
    }
    height.max(0.7 * physique.com_height)
}

/// The height that the legs will allow when the swing lands.
fn landing_height(params: &Params, physique: &Physique, state: &State) -> f64 {
    let Some(swing) = &state.swing else { return physique.com_height };
    let left_over = (swing.land - state.time).max(0.0);
    let stance = &state.feet[swing.side.other() as usize];
    let (com, _) = pendulum::predict(ground(state.com), ground(state.velocity), state.cop, state.omega(), left_over);
    let then = State { com: DVec3::new(com.x, state.com.y, com.y), ..*state };
    let new = leg_height(params, physique, &then, swing.side, ground(swing.to.ankle));
    let old = leg_height(params, physique, &then, swing.side.other(), ground(stance.ankle));
    new.min(old).max(0.84 * physique.com_height)
}

/// The centre of mass's height with that leg stretched.
fn leg_height(params: &Params, physique: &Physique, state: &State, side: Side, ankle: DVec2) -> f64 {
    let hip = hip(params, state, side);
    let across = hip - ankle;
    let behind = across.dot(support::forward(state.facing)).max(0.0) / physique.leg_length;
    let upright = physique.hip_height - physique.ankle_height;
    let leg = params.leg_span.max(upright) + 0.07 * params.size * (2.5 * behind).min(1.0);
    let tall = (leg * leg - across.length_squared()).max(0.0).sqrt();
    physique.com_height + (tall - upright).min(0.0)
}

fn hip(params: &Params, state: &State, side: Side) -> DVec2 {
    ground(state.com) - support::forward(state.facing) * params.com_forward
        + support::left(state.facing) * (0.5 * side.sign() * params.width)
}

/// Moves the swinging foot; sets it down when its time is up.
fn advance(params: &Params, state: &mut State, dt: f64) -> Option<Step> {
    let swing = state.swing?;
    if state.time < swing.land - 0.5 * dt {
        state.feet[swing.side as usize] = swing::along(params, &swing, swing::phase(&swing, state.time));
        return None;
    }
    state.feet[swing.side as usize] = swing.to;
    state.swing = None;
    state.settled = 0.0;
    state.last = Some(swing.side);
    if swing.kind != StepKind::Comfort {
        state.recovering = 0.0;
    }
    let Swing { side, kind, lift, from, to, .. } = swing;
    Some(Step { side, kind, lift, land: state.time, from, to })
}

/// Keeps the clocks of rest and of failure.
fn judge(params: &Params, physique: &Physique, state: &mut State, dt: f64) {
    let com = ground(state.com);
    let slow = state.velocity.length() < 0.05;
    let area = Support::two(params, physique, [&state.feet[0], &state.feet[1]], [Tread::Whole; 2], 0.0);
    let still = slow && state.swing.is_none() && area.outside(state.xi()) <= 0.0;
    state.rest = if still { state.rest + dt } else { 0.0 };
    let near = Side::BOTH
        .into_iter()
        .filter(|&side| state.planted(side))
        .map(|side| hip(params, state, side).distance(ground(state.feet[side as usize].ankle)))
        .fold(f64::INFINITY, f64::min);
    let finite = com.is_finite() && state.com.y.is_finite();
    if state.com.y < params.low || near > params.lean || !finite {
        state.lost = Some(state.time);
    }
}

/// How uncomfortable the stand is; over 1 it wants mending.
fn discomfort(params: &Params, physique: &Physique, state: &State) -> f64 {
    let [left_foot, right_foot] = ankles(state);
    let apart = left_foot - right_foot;
    let wide = (apart.dot(support::left(state.facing)) - params.width).abs() / (params.widen * params.width);
    let staggered = apart.dot(support::forward(state.facing)).abs() / params.stagger;
    let twisted = Side::BOTH
        .into_iter()
        .map(|side| wrap(state.feet[side as usize].yaw - state.facing - side.sign() * physique.toe_out).abs())
        .fold(0.0, f64::max)
        / params.twist;
    wide.max(staggered).max(twisted)
}

/// The point to stand over once `side` has come beside the other.
fn middle_after(params: &Params, physique: &Physique, state: &State, side: Side) -> DVec2 {
    let stance = ground(state.feet[side.other() as usize].ankle);
    let to = ground(foothold::beside(params, physique, state, side).ankle);
    middle(params, state.facing, [stance, to])
}

fn ankles(state: &State) -> [DVec2; 2] {
    [ground(state.feet[0].ankle), ground(state.feet[1].ankle)]
}

fn wrap(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

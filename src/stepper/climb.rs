//! Up and down flights of stairs and high kerbs by a body of links, one tread at a time: from both feet on a tread one goes to the next, the
//! body comes over it while the heel behind rises, and the other foot follows beside it. Down there is more in [`super::descend`].
//!
//! As toddlers and the old do it: each step begins with ξ over the foot that stays. From tread to tread ξ follows a planned way, along the
//! line between the two feet, by the pressure under both. Scenario space, metres, seconds, radians.

use super::support::{Support, Tread};
use super::walk::Phase;
use super::{Gait, Inputs, Params, Passing, Physique, Plant, State, StepKind, Swing};
use super::{descend, ground, kerb, rise, support, swing};
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::model::scenario::GroundKind;
use crate::model::{Side, Terrain};
use glam::DVec2;

/// m: a single step up to here is for the gait ([`kerb`]).
const KERB: f64 = 0.1;
/// m of the reference body: so near to the first edge a walk ends.
const NEAR: f64 = 0.5;
/// m of the reference body and for shorter legs: a foot goes up to a tread that is no farther ahead; m of the reference body, a step
/// towards one that is.
const LONGEST: f64 = 0.37;
/// As [`LONGEST`] says.
pub(super) const STRIDE: f64 = 0.3;
/// m, that soles keep from edges; m of the reference body, more of it from a riser; and behind an edge where there is room.
pub(super) const EDGE: f64 = 0.01;
/// As [`EDGE`] says.
const TOES: f64 = 0.03;
/// As [`EDGE`] says.
pub(super) const ROOM: f64 = 0.02;
/// m of the reference body: feet no farther apart along the way stand beside each other.
pub(super) const BESIDE: f64 = 0.06;
/// Times the walk's, how far apart the feet are across: as near as in a walk, legs come within 12 cm of each other.
const WIDER: f64 = 1.15;
/// More of a sole over which ξ is held for each metre (of the reference body) of a rise: knees that bend for it lean shanks ahead.
const OVER: f64 = 1.0;
/// m of the reference body, nearer to the other foot.
const INWARD: f64 = 0.02;
/// s, that ξ takes at least from foot to foot.
const SETTLES: f64 = 0.3;
/// s, a swing.
const SWING: f64 = 0.7;
/// How far the sideways part of ξ's way may be behind the clock, as a share of it: it follows how far it has come ahead, or the pressure that
/// is wanted would be beside the line between the feet.
const SLACK: f64 = 0.3;
/// m of the reference body: a foot leaves when ξ is so near to where it is to be.
const READY: f64 = 0.04;
/// Shares of a leg's length: of the leg that lands, and of the one behind with its heel down.
const LEGS: [f64; 2] = [0.95, 0.975];
/// Share of a swing from which on the body is lowered for the landing, and in which it is.
const LOWERS: [f64; 2] = [0.2, 0.5];
/// s, how far ahead the hip is looked for where it moves.
const SOON: f64 = 0.15;
/// s, time constant of the body's height.
const RISES: f64 = 0.15;
/// m of the reference body, how high the heel behind rises at most; from where to where ahead of its sole's middle the pressure frees it;
/// from the ankle to the ball; and rad/s of it. Without it a knee at 17 cm bends until the ankle is at its range's end and the other heel
/// comes off: of five bodies two fall.
const HEEL: f64 = 0.08;
/// As [`HEEL`] says.
const FREES: f64 = 0.1;
/// As [`HEEL`] says: share of the sole.
const FREED_AT: f64 = 0.6;
/// As [`HEEL`] says.
const BALL: f64 = 0.13;
/// As [`HEEL`] says.
const PITCHES: f64 = 2.0;
/// rad, by which a heel turns up at most: arcsine of this.
const STEEPEST: f64 = 0.6;
/// rad for each metre (of the reference body) of a rise, how far the trunk leans ahead: 6 degrees at 10 cm.
const LEANS: f64 = 1.0;
/// m/s of the reference body: the pace that is told of it, and up to which a walk counts as ended.
const PACE: f64 = 0.12;
/// As [`PACE`] says.
const STOPPED: f64 = 0.25;

/// m of the reference body: so far off its way ξ is past what the pressure under the feet brings back; and the share of a swing after which
/// the foot in the air lands where it was sent all the same. Of 16 shoves of 20 N s on flights of 17 cm (the built-in body, without looking
/// ahead) 10 are stood up and 13 down, without it 8 and 5.
const LOST: f64 = 0.08;
/// As [`LOST`] says.
const LATE: f64 = 0.7;

/// How ξ goes from tread to tread.
struct Manner {
    /// Share of what of a sole bears, from behind, over which ξ is held.
    over: f64,
    /// s for each metre (of the reference body) that it goes from foot to foot: up, with 2.8 the pressure needed is behind the heel.
    shifts: f64,
    /// Share of a swing after which it begins to go to where the foot lands; share of that way that it has gone when it does.
    runs: [f64; 2],
    /// Of an error of it, how far the pressure goes beyond it.
    gain: f64,
}

const UP: Manner = Manner { over: 0.5, shifts: 3.6, runs: [0.3, 0.3], gain: 1.5 };
/// Down it runs ahead of the ball that it leaves. These, and the constants of [`descend`], are of a random search on four drawn flights without
/// looking ahead; 20 others of 3 to 17 cm, drawn on four bodies, are then descended without a fall.
const DOWN: Manner = Manner { over: 0.679, shifts: 2.824, runs: [0.287, 0.585], gain: 1.0 };

/// What is remembered of a flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Climb {
    /// It is at it.
    pub on: bool,
    /// It goes down.
    pub down: bool,
    /// rad, how far the trunk is to lean forwards.
    pub lean: f64,
    /// The foot whose heel is to rise, and how far, rad.
    pub heel: Option<(Side, f64)>,
    from: DVec2,  // m, where ξ was when both feet came to stand, (x, z)
    speed: DVec2, // m/s, how fast it was to go then
    since: f64,   // s, when that was
    off: f64,     // m, how far ξ is from its way
}

/// A tick's situation: who steps next or does, from which foot, and over where ξ is held.
struct Scene<'a> {
    params: &'a Params,
    physique: &'a Physique,
    terrain: &'a Terrain,
    side: Side,
    stance: Plant,
    rise: f64, // m, of the next tread
    over: DVec2,
}

/// Is that ground climbed one tread at a time?
fn climbed(params: &Params, terrain: &Terrain) -> bool {
    let steps =
        matches!(terrain.kind, GroundKind::Stairs { rise, count, .. } if rise.abs() > KERB || rise != 0.0 && count > 1);
    params.fits && steps
}

/// m, from where to where the tread reaches that a foot stands on.
pub(super) fn tread(terrain: &Terrain, physique: &Physique, foot: &Plant) -> [f64; 2] {
    let found = terrain.floor(foot.ankle.z + 0.5 * (physique.heel + physique.tip));
    found.unwrap_or([f64::NEG_INFINITY, f64::INFINITY])
}

/// Does it go straight at the steps?
fn straight(state: &State, inputs: &Inputs) -> bool {
    inputs.walk.is_some_and(|walk| walk.y > 0.0 && walk.x.abs() < 0.1 * walk.y) && state.ahead.y > 0.9
}

/// Is an edge near before the foremost foot of who goes to it?
fn near(params: &Params, physique: &Physique, terrain: &Terrain, state: &State, inputs: &Inputs) -> bool {
    let [left, right] = &state.feet;
    let foot = if left.ankle.z > right.ankle.z { left } else { right };
    climbed(params, terrain)
        && straight(state, inputs)
        && tread(terrain, physique, foot)[1] - foot.ankle.z < NEAR * params.size
}

/// What the gait is told: to end before a flight.
pub fn ended(params: &Params, physique: &Physique, terrain: &Terrain, state: &State, inputs: &Inputs) -> Inputs {
    let ends = near(params, physique, terrain, state, inputs);
    Inputs { walk: inputs.walk.filter(|_| !ends), ..*inputs }
}

/// Is it on a flight? Takes over from a walk that has ended before one, and gives back where both feet are at its end.
pub fn goes(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, inputs: &Inputs) -> bool {
    if !climbed(params, terrain) || state.climb.on && state.swing.is_some() {
        return state.climb.on;
    }
    let slow = state.velocity.length() < STOPPED * params.size / params.tempo;
    if state.climb.on {
        let [left, right] = &state.feet;
        let together = left.ankle.y == right.ankle.y && (left.ankle.z - right.ankle.z).abs() < BESIDE * params.size;
        let done = tread(terrain, physique, left)[1].is_infinite() || !straight(state, inputs);
        if together && done && slow {
            state.climb = Climb::default();
            state.gait = Gait::still(state.gait.side);
        }
        return state.climb.on;
    }
    let stands = state.swing.is_none() && state.gait.phase == Phase::Rest && slow;
    if stands && state.outline.outside(state.xi()) < -params.margin && near(params, physique, terrain, state, inputs) {
        let down = descend::falls(terrain);
        state.climb = Climb { on: true, down, from: state.xi(), since: state.time, ..Climb::default() };
    }
    state.climb.on
}

/// Who is shoved off its way leaves it, and the step in the air, to the body's own law, and goes on from where that brought it.
pub fn give_up(params: &Params, state: &mut State) {
    let shoved = state.shoved < params.tempo;
    let late = state.swing.is_some_and(|swing| swing::phase(&swing, state.time) > LATE);
    if shoved && !late && state.climb.off > LOST * params.size {
        (state.swing, state.climb) = (None, Climb::default());
        state.gait = Gait::still(state.gait.side);
    }
}

/// A foot is down.
pub fn landed(state: &mut State) {
    (state.climb.from, state.climb.since) = (state.xi(), state.time);
}

/// One tick on a flight: the pressure, the height, the lift of a foot.
pub fn tick(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, dt: f64) {
    let side = state.swing.map_or_else(|| next(params, physique, terrain, state), |swing| swing.side);
    let stance = state.feet[side.other() as usize];
    let rise = rise_ahead(physique, terrain, state);
    let mut scene = Scene { params, physique, terrain, side, stance, rise, over: DVec2::ZERO };
    scene.over = scene.middle(state, &stance, side.other());
    let (way, along) = scene.way(state);
    let [wanted, speed] = way;
    let xi = state.xi();
    state.climb.off = xi.distance(wanted);
    state.cop = scene.bears(state, xi - speed / state.omega() + (xi - wanted) * manner(state).gain);
    scene.height(state, dt);
    state.climb.lean = LEANS * rise / params.size;
    let phase = if state.swing.is_some() { Phase::Single } else { Phase::Double };
    let velocity = state.ahead * (PACE * params.size / params.tempo);
    state.gait = Gait { phase, side, tick: dt, velocity, ..state.gait };
    if let Some(swing) = &state.swing {
        state.gait.until = swing.land;
        return;
    }
    let ready = xi.distance(scene.over) < READY * params.size;
    state.gait.until = state.time + if ready { along.max(0.0) } else { along.max(SOON) };
    let sole = Support::one(params, physique, &stance, Tread::Whole, 0.0);
    let taken = state.climb.down && descend::taken(params, physique, state, side);
    if taken && sole.outside(state.cop) > 0.0 {
        (state.cop, state.gait.until) = (sole.nearest(state.cop), state.time);
    } else if (taken || along <= 0.0 && ready) && sole.outside(state.cop) <= 0.0 {
        scene.lift(state, dt);
    }
}

/// Share of a sole that may be over the edge behind it where the tread is hard to reach: as much as on treads that are shorter than it.
const OVERHANGS: f64 = 0.25;
/// m of the reference body: a foot that would go no farther stays where it is.
const STAYS: f64 = 0.02;

/// The foot that goes next: the one behind, or the one that has just come beside the other, over which ξ is, if it gets on from there.
fn next(params: &Params, physique: &Physique, terrain: &Terrain, state: &State) -> Side {
    if state.climb.down {
        return descend::next(params, state);
    }
    let before = state.feet[0].ankle.z - state.feet[1].ankle.z;
    if before.abs() < BESIDE * params.size {
        let side = state.last.unwrap_or(params.lead);
        let goes = place(params, physique, terrain, state, side) - state.feet[side as usize].ankle.z;
        return if goes > STAYS * params.size { side } else { side.other() };
    }
    if before < 0.0 { Side::Left } else { Side::Right }
}

/// m, how far along the way that foot is to go: beside the other, onto the next tread, or as near to it as it can where that is out of reach.
fn place(params: &Params, physique: &Physique, terrain: &Terrain, state: &State, side: Side) -> f64 {
    if state.climb.down {
        return descend::place(params, physique, terrain, state, side);
    }
    let stance = &state.feet[side.other() as usize];
    let (rear, front) = (physique.heel - EDGE, physique.tip + EDGE + TOES * params.size);
    let edge = tread(terrain, physique, stance)[1];
    let beside = (state.feet[side as usize].ankle.z - stance.ankle.z).abs() < BESIDE * params.size;
    if !beside || edge.is_infinite() {
        return stance.ankle.z;
    }
    let [next, end] = terrain.floor(edge + EDGE).unwrap_or([edge, f64::INFINITY]);
    let (low, high) = (next - rear, end - front);
    let far = stance.ankle.z + LONGEST * params.size.max(1.0);
    let least = low - OVERHANGS * (physique.tip - physique.heel);
    let on = if high < low { high } else { (low + (0.5 * (high - low)).min(ROOM * params.size)).min(far.max(least)) };
    if on <= far { on } else { (edge - front).min(stance.ankle.z + STRIDE * params.size) }
}

/// m, how much higher the tread is before the foot that is behind.
fn rise_ahead(physique: &Physique, terrain: &Terrain, state: &State) -> f64 {
    let [left, right] = &state.feet;
    let foot = if left.ankle.z > right.ankle.z { right } else { left };
    let [_, edge] = tread(terrain, physique, foot);
    if edge - foot.ankle.z > 2.0 * STRIDE {
        return 0.0;
    }
    let height = |z: f64| terrain.spot(DVec2::new(0.0, z)).height;
    (height(edge + EDGE) - height(edge - EDGE)).max(0.0)
}

fn manner(state: &State) -> &'static Manner {
    if state.climb.down { &DOWN } else { &UP }
}

impl Scene<'_> {
    /// m, (x, z), where that pressure can be.
    fn bears(&self, state: &State, pressure: DVec2) -> DVec2 {
        let (params, physique) = (self.params, self.physique);
        let down = state.climb.down;
        match &state.swing {
            Some(swing) if down && descend::sinks(state, swing) => {
                descend::on_ball(params, physique, self.terrain, &self.stance, pressure)
            }
            Some(_) => {
                Support::one(params, physique, &self.stance, Tread::Whole, 0.5 * params.margin).nearest(pressure)
            }
            None if down && descend::above(state, self.side) => {
                let rear = &state.feet[self.side as usize];
                descend::between(params, physique, self.terrain, (rear, self.over), pressure)
            }
            None => state.inset.nearest(pressure),
        }
    }

    /// m, over where ξ is held on that foot: on what of its sole is on its tread.
    fn middle(&self, state: &State, foot: &Plant, side: Side) -> DVec2 {
        let [from, to] = tread(self.terrain, self.physique, foot);
        let rear = self.physique.heel.max(from - foot.ankle.z);
        let front = self.physique.tip.min(to - foot.ankle.z);
        let share = manner(state).over + OVER * self.rise / self.params.size;
        let inward = state.aside() * (side.sign() * INWARD * self.params.size);
        let leaves = (state.climb.down && side != self.side)
            .then(|| descend::over(self.params, self.physique, self.terrain, state, side))
            .flatten();
        if let Some(ball) = leaves {
            return ball - inward;
        }
        ground(foot.ankle) + support::forward(foot.yaw) * (rear + share * (front - rear)) - inward
    }

    /// Where ξ is to be (m) and how fast it is to go (m/s), (x, z); and s that it still takes with both feet down.
    fn way(&self, state: &mut State) -> ([DVec2; 2], f64) {
        let (size, tempo, over) = (self.params.size, self.params.tempo, self.over);
        if let Some(swing) = &state.swing {
            let whole = swing.land - swing.lift;
            let [begins, share] = manner(state).runs;
            let x = ((state.time - swing.lift) / whole - begins).max(0.0) / (1.0 - begins);
            let x = x.min(1.0);
            let way = (self.middle(state, &swing.to, self.side) - over) * share;
            state.climb.speed = way * (2.0 * x / ((1.0 - begins) * whole));
            return ([over + way * (x * x), state.climb.speed], 0.0);
        }
        let Climb { from, speed, since, .. } = state.climb;
        let takes = (manner(state).shifts * from.distance(over) / size).max(SETTLES) * tempo;
        let a = ((state.time - since) / takes).clamp(0.0, 1.0);
        let mut place = from + (over - from) * smooth3(a) + speed * (takes * a * (1.0 - a) * (1.0 - a));
        let pace = (over - from) * (6.0 * a * (1.0 - a) / takes) + speed * (1.0 - 4.0 * a + 3.0 * a * a);
        let far = over.y - from.y;
        if far > 0.1 * size {
            let came = ((state.xi().y - from.y) / far).clamp(0.0, 1.0);
            place.x = from.x + (over.x - from.x) * came.max(smooth3(a) - SLACK);
        }
        ([place, pace], since + takes - state.time)
    }

    /// Follows the height that the legs reach, and raises the heel behind so that they reach farther.
    fn height(&self, state: &mut State, dt: f64) {
        let (params, physique, stance) = (self.params, self.physique, &self.stance);
        let stands = physique.hip_height - physique.ankle_height;
        let moving = (state.com.z + state.velocity.z * SOON).min(self.over.y);
        let hip = if state.swing.is_some() { self.over.y } else { moving } - params.com_forward;
        let reaches = |foot: &Plant, used: f64| {
            let (leg, away) = (used * physique.leg_length, foot.ankle.z - hip);
            foot.ankle.y + (leg * leg - away * away).max(0.3 * stands * stands).sqrt() - stands
        };
        let own = &state.feet[self.side as usize];
        let (goal, pitch) =
            if let Some(swing) = state.swing.filter(|swing| state.climb.down && descend::sinks(state, swing)) {
                (descend::height(physique, state, &swing, hip), 0.0)
            } else if let Some(swing) = &state.swing {
                let share = (state.time - swing.lift) / (swing.land - swing.lift);
                let full = stance.ankle.y.min(swing.to.ankle.y);
                let bent = full.min(reaches(&swing.to, LEGS[0]));
                (full + (bent - full) * smooth3((share - LOWERS[0]) / LOWERS[1]), 0.0)
            } else {
                // Down the heel behind comes off by itself.
                let rear = if state.climb.down { f64::INFINITY } else { reaches(own, LEGS[1]) };
                let frees = own.ankle.z + physique.heel + FREED_AT * (physique.tip - physique.heel);
                let freed = smooth3((state.cop.y - frees) / (FREES * params.size));
                let heel = if self.rise > 0.0 { HEEL * freed * params.size } else { 0.0 };
                let goal = stance.ankle.y.min(reaches(stance, LEGS[0])).min(rear + heel);
                (goal, real::asin(((goal - rear) / (BALL * params.size)).clamp(0.0, STEEPEST)))
            };
        state.gait.rise = state.swing.map_or(own.ankle.y, |swing| swing.to.ankle.y) - stance.ankle.y;
        let before = state.climb.heel.filter(|(foot, _)| *foot == self.side).map_or(0.0, |(_, pitch)| pitch);
        let most = PITCHES / params.tempo * dt;
        let turned = (self.side, before + (pitch - before).clamp(-most, most));
        state.climb.heel = state.swing.is_none().then_some(turned);
        rise::towards(state, goal, RISES * params.tempo, dt);
    }

    /// Where the foot goes: beside the other, or on.
    fn foothold(&self, state: &State) -> Plant {
        let (params, physique, stance) = (self.params, self.physique, &self.stance);
        let z = place(params, physique, self.terrain, state, self.side);
        let across = WIDER * params.step_width.max(0.9 * params.gap) * self.side.sign();
        let yaw = state.facing + self.side.sign() * physique.toe_out;
        kerb::stood(self.terrain, physique, DVec2::new(stance.ankle.x + across, z), yaw)
    }

    /// Lifts the foot.
    fn lift(&self, state: &mut State, dt: f64) {
        let to = self.foothold(state);
        state.swing = Some(Swing {
            side: self.side,
            kind: StepKind::Walk,
            lift: state.time,
            land: state.time + (SWING * self.params.tempo / dt).round() * dt,
            from: state.feet[self.side as usize],
            to,
            off: 0.0,
            aim: ground(to.ankle),
            passing: Passing::Own,
            round: state.aside() * self.side.sign(),
            detour: DVec2::ZERO,
        });
        state.gait.phase = Phase::Single;
    }
}

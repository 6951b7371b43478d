//! Up and down flights of stairs and high kerbs by a body of links: up step over step ([`super::ascend`]), down one tread at a time
//! ([`super::descend`]), as toddlers and the old do it.
//!
//! Each step begins with ξ over the foot that stays. From foot to foot ξ follows a planned way: in the swing it runs ahead, and with both feet
//! down it goes on along the line between them, by the pressure under both; who is ahead of it steps in haste
//! ([`super::haste`]). Scenario space, metres, seconds, radians.

use super::support::{Support, Tread};
use super::walk::Phase;
use super::{Gait, Inputs, Params, Passing, Physique, Plant, State, StepKind, Swing};
use super::{ascend, descend, ground, kerb, rise, support, swing};
use crate::maths::curve::smooth3;
use crate::model::scenario::GroundKind;
use crate::model::{Side, Terrain};
use glam::DVec2;

/// m: a single step up to here is for the gait ([`kerb`]).
const KERB: f64 = 0.1;
/// Part of the leg, the highest step of a mesh that is climbed; m of the reference body, deeper floors are no treads of one flight.
pub(super) const HIGHEST: f64 = 0.3;
/// As [`HIGHEST`] says.
const DEEP: f64 = 0.6;
/// m of the reference body: a walk ends so near to the first edge, of a flight up from the ankle ahead, and of one down from its toes: feet may
/// be as long on short legs. Of 24 drawn on legs of 0.58 m that come at 0.25 to 0.6 m/s
/// 14 fall with 0.32, none with this.
const NEAR: [f64; 2] = [1.0, 0.5];
/// m of the reference body, a step towards a tread that is out of reach.
pub(super) const STRIDE: f64 = 0.3;
/// m, that soles keep from edges; and behind an edge where there is room.
pub(super) const EDGE: f64 = 0.01;
/// As [`EDGE`] says.
pub(super) const ROOM: f64 = 0.02;
/// m of the reference body: feet no farther apart along the way stand beside each other.
pub(super) const BESIDE: f64 = 0.06;
/// m: feet whose heights differ by less stand on one floor.
const LEVEL: f64 = 0.001;
/// Times the walk's, how far apart the feet are across: as near as in a walk, legs come within 12 cm of each other.
const WIDER: f64 = 1.15;
/// More of a sole over which ξ is held for each metre (of the reference body) of a rise: knees that bend for it lean shanks ahead.
const OVER: f64 = 1.0;
/// m of the reference body: over a sole whose heel hangs over an edge, ξ is held at least so far ahead of that edge.
const INSIDE: f64 = 0.06;
/// m/s, that a command counts as at least; s of the reference body, how long who is asked to climb slowly waits over the foot ahead at most:
/// longer, and legs of 0.58 m fall.
const SLOWEST: f64 = 0.05;
/// As [`SLOWEST`] says.
const WAITS: f64 = 0.5;
/// How far the sideways part of ξ's way may be behind the clock, as a share of it: it follows how far it has come ahead, or the pressure that
/// is wanted would be beside the line between the feet.
const SLACK: f64 = 0.3;
/// m of the reference body: a foot leaves when ξ is so near to where it is to be.
const READY: f64 = 0.04;
/// Share of a leg's length: of the leg that lands.
const LEG: f64 = 0.95;
/// Share of a swing from which on the body is lowered for the landing, and in which it is.
const LOWERS: [f64; 2] = [0.2, 0.5];
/// s, how far ahead the hip is looked for where it moves.
const SOON: f64 = 0.15;
/// s, time constant of the body's height.
const RISES: f64 = 0.15;
/// rad/s of the reference body, how fast a heel turns up.
const PITCHES: f64 = 2.0;
/// m/s of the reference body: the pace that is told of it, and up to which a walk counts as ended.
const PACE: f64 = 0.12;
/// As [`PACE`] says.
const STOPPED: f64 = 0.25;
/// s of the reference body: a flight up is begun from feet beside each other, or by who has stood still for so long.
const STOOD: f64 = 1.0;

/// m of the reference body: so far off its way ξ is past what the pressure under the feet brings back, on a flight up and on one down: after a
/// shove, and without one; and the share of a swing after which the foot in the air lands where it was sent all the same. Of 32 shoves of
/// 20 N s amid flights up of 17 cm one to three are falls with 0.05, five with 0.065. Unshoved, of 96 drawn walks down without looking ahead
/// none falls from 0.2 on, four with 0.12.
const LOST: [f64; 2] = [0.05, 0.08];
/// As [`LOST`] says.
const LOST_UNSHOVED: [f64; 2] = [0.12, 0.25];
/// As [`LOST`] says.
const LATE: f64 = 0.7;

/// How ξ goes from tread to tread.
struct Manner {
    /// s of the reference body, a swing.
    swing: f64,
    /// m of the reference body, by which ξ is held nearer to the other foot.
    inward: f64,
    /// Share of what of a sole bears, from behind, over which ξ is held.
    over: f64,
    /// s for each metre (of the reference body) that it goes on with both feet down, and s that it takes at least.
    shifts: [f64; 2],
    /// Share of a swing after which it begins to go to where the foot lands; share of that way that it has gone when it does.
    runs: [f64; 2],
    /// Of an error of it, how far the pressure goes beyond it.
    gain: f64,
}

/// Up it has gone two thirds of its way when a foot lands: with a third, ankles come to the end of their range and the body falls back.
const UP: Manner = Manner { swing: 0.7, inward: 0.02, over: 0.5, shifts: [2.16, 0.2], runs: [0.3, 0.66], gain: 1.5 };
/// Down it runs ahead of the ball that it leaves. These, and the constants of [`descend`], are of random searches on drawn flights without
/// looking ahead, rounded.
const DOWN: Manner =
    Manner { swing: 0.875, inward: 0.0, over: 0.5, shifts: [3.25, 0.32], runs: [0.225, 0.76], gain: 1.0 };

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
    asked: f64,   // m/s, how fast it is to go
    from: DVec2,  // m, where ξ was when both feet came to stand, (x, z)
    speed: DVec2, // m/s, how fast it was to go then
    since: f64,   // s, when that was
    off: f64,     // m, how far ξ is from its way
}

/// A tick's situation: who steps next or does, from which foot, and over where ξ is held.
pub(super) struct Scene<'a> {
    pub(super) params: &'a Params,
    pub(super) physique: &'a Physique,
    terrain: &'a Terrain,
    pub(super) side: Side,
    pub(super) stance: Plant,
    rise: f64, // m, of the next tread
    pub(super) over: DVec2,
}

/// Which way steps go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flight {
    Up,
    Down,
}

/// Which way the steps before a foot go, where they are climbed one at a time: stairs by name, and on a mesh level floors at different
/// heights, one after the other along z.
pub(super) fn flight(params: &Params, physique: &Physique, terrain: &Terrain, foot: &Plant) -> Option<Flight> {
    let rise = match terrain.kind {
        _ if !params.fits => return None,
        GroundKind::Stairs { rise, count, .. } => {
            Some(rise).filter(|rise| rise.abs() > KERB || *rise != 0.0 && count > 1)
        }
        GroundKind::Mesh { .. } => {
            let x = foot.ankle.x;
            let edge = tread(terrain, physique, foot)[1];
            let next = floor(terrain, x, edge)[1];
            let rise = step(terrain, x, edge)?;
            let goes_on =
                || next - edge < DEEP * params.size && step(terrain, x, next).is_some_and(|next| next * rise > 0.0);
            let steep = rise.abs() > KERB;
            let bends = params.balls.is_some() || rise > 0.0 && !steep;
            (bends && rise.abs() <= HIGHEST * physique.leg_length && (steep || goes_on())).then_some(rise)
        }
        _ => None,
    }?;
    Some(if rise < 0.0 { Flight::Down } else { Flight::Up })
}

/// m, how much higher the floor beyond an edge along z is than the one before it; `None` where there is no edge or no level floor.
fn step(terrain: &Terrain, x: f64, edge: f64) -> Option<f64> {
    let level = |z: f64| terrain.level_at(DVec2::new(x, z));
    Some(level(edge + EDGE)? - level(edge - EDGE)?).filter(|_| edge.is_finite())
}

/// m, from where to where along z the floor reaches that begins at an edge.
pub(super) fn floor(terrain: &Terrain, x: f64, edge: f64) -> [f64; 2] {
    terrain.floor_at(DVec2::new(x, edge + EDGE)).unwrap_or([edge, f64::INFINITY])
}

/// m, from where to where the tread reaches that a foot stands on.
pub(super) fn tread(terrain: &Terrain, physique: &Physique, foot: &Plant) -> [f64; 2] {
    let middle = DVec2::new(foot.ankle.x, foot.ankle.z + 0.5 * (physique.heel + physique.tip));
    terrain.floor_at(middle).unwrap_or([f64::NEG_INFINITY, f64::INFINITY])
}

/// Does it go straight at the steps?
fn straight(state: &State, inputs: &Inputs) -> bool {
    inputs.walk.is_some_and(|walk| walk.y > 0.0 && walk.x.abs() < 0.1 * walk.y) && state.ahead.y > 0.9
}

/// m, how much farther the edge before that foot is than where a walk ends.
fn near_to(params: &Params, physique: &Physique, terrain: &Terrain, down: bool, foot: &Plant) -> f64 {
    let toes = if down { physique.tip } else { 0.0 };
    tread(terrain, physique, foot)[1] - foot.ankle.z - toes - NEAR[usize::from(down)] * params.size
}

/// The flight of which an edge is near before the foremost foot of who goes to it.
fn near(params: &Params, physique: &Physique, terrain: &Terrain, state: &State, inputs: &Inputs) -> Option<Flight> {
    let [left, right] = &state.feet;
    let foot = if left.ankle.z > right.ankle.z { left } else { right };
    let flight = flight(params, physique, terrain, foot).filter(|_| straight(state, inputs))?;
    let far = near_to(params, physique, terrain, flight == Flight::Down, foot);
    (far < 0.0).then_some(flight)
}

/// What the gait is told: to end before a flight.
pub fn ended(params: &Params, physique: &Physique, terrain: &Terrain, state: &State, inputs: &Inputs) -> Inputs {
    let ends = near(params, physique, terrain, state, inputs) == Some(Flight::Down);
    Inputs { walk: inputs.walk.filter(|_| !ends), ..*inputs }
}

/// Is it on a flight? Takes over from a walk that has ended before one, and gives back where both feet are at its end.
pub fn goes(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, inputs: &Inputs) -> bool {
    if state.climb.on && state.swing.is_some() {
        return true;
    }
    let slow = state.velocity.length() < STOPPED * params.size / params.tempo;
    if state.climb.on {
        let [left, right] = &state.feet;
        let together =
            (left.ankle.y - right.ankle.y).abs() < LEVEL && (left.ankle.z - right.ankle.z).abs() < BESIDE * params.size;
        let done = ends(params, physique, terrain, &state.climb, left) || !straight(state, inputs);
        if together && done && slow {
            state.climb = Climb::default();
            state.gait = Gait::still(state.gait.side);
        }
        return state.climb.on;
    }
    let Some(flight) = near(params, physique, terrain, state, inputs) else { return false };
    let down = flight == Flight::Down;
    let walks = state.swing.is_none() && state.gait.phase == Phase::Double && !down;
    if walks && ascend::begins(params, physique, terrain, state) {
        let speed = (state.xi() - state.cop) * state.omega();
        state.climb = Climb { on: true, from: state.xi(), since: state.time, speed, ..Climb::default() };
        return true;
    }
    let level = (state.feet[0].ankle.z - state.feet[1].ankle.z).abs() < BESIDE * params.size;
    let stood = level || down || state.calm > STOOD * params.tempo;
    let stands = state.swing.is_none() && state.gait.phase == Phase::Rest && slow && stood;
    if stands && state.outline.outside(state.xi()) < -params.margin {
        state.climb = Climb { on: true, down, from: state.xi(), since: state.time, ..Climb::default() };
    }
    state.climb.on
}

/// Is that foot at the end of the flight?
fn ends(params: &Params, physique: &Physique, terrain: &Terrain, climb: &Climb, foot: &Plant) -> bool {
    let edge = tread(terrain, physique, foot)[1];
    let far = terrain.is_mesh() && near_to(params, physique, terrain, climb.down, foot) > 0.0;
    edge.is_infinite()
        || far
        || flight(params, physique, terrain, foot) != Some(if climb.down { Flight::Down } else { Flight::Up })
}

/// Who is off its way leaves it, and the step in the air, to the body's own law, and goes on from where that brought it.
pub fn give_up(params: &Params, state: &mut State) {
    let shoved = state.shoved < params.tempo;
    let late = state.swing.is_some_and(|swing| swing::phase(&swing, state.time) > LATE);
    let most = if shoved { LOST } else { LOST_UNSHOVED }[usize::from(state.climb.down)];
    if !late && state.climb.off > most * params.size {
        (state.swing, state.climb) = (None, Climb::default());
        state.gait = Gait::still(state.gait.side);
    }
}

/// A foot is down.
pub fn landed(state: &mut State) {
    (state.climb.from, state.climb.since) = (state.xi(), state.time);
}

/// One tick on a flight: the pressure, the height, the lift of a foot.
pub fn tick(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, inputs: &Inputs, dt: f64) {
    state.climb.asked = inputs.walk.unwrap_or_default().length();
    let next =
        if state.climb.down { descend::next(params, state) } else { ascend::next(params, physique, terrain, state) };
    let side = state.swing.map_or(next, |swing| swing.side);
    let stance = state.feet[side.other() as usize];
    let rise = ascend::rise_ahead(physique, terrain, state);
    let mut scene = Scene { params, physique, terrain, side, stance, rise, over: DVec2::ZERO };
    scene.over = scene.middle(state, &stance, side.other());
    let (way, along) = scene.way(state);
    let [wanted, speed] = way;
    let xi = state.xi();
    state.climb.off = xi.distance(wanted);
    state.cop = scene.bears(state, xi - speed / state.omega() + (xi - wanted) * manner(state).gain);
    scene.height(state, dt);
    state.climb.lean = ascend::LEANS * rise / params.size;
    let phase = if state.swing.is_some() { Phase::Single } else { Phase::Double };
    let velocity = state.ahead * (PACE * params.size / params.tempo);
    state.gait = Gait { phase, side, tick: dt, velocity, ..state.gait };
    if let Some(swing) = state.swing {
        let swing = if state.climb.down { swing } else { scene.in_time(state, &swing, dt) };
        (state.swing, state.gait.until) = (Some(swing), swing.land);
        return;
    }
    let ready = xi.distance(scene.over) < READY * params.size;
    state.gait.until = state.time + if ready { along.max(0.0) } else { along.max(SOON) };
    let sole = Support::one(params, physique, &stance, Tread::Whole, 0.0);
    let taken = state.climb.down && descend::taken(params, physique, state, side);
    if taken && sole.outside(state.cop) > 0.0 {
        (state.cop, state.gait.until) = (sole.nearest(state.cop), state.time);
    } else if (taken || along <= 0.0 && ready && scene.is_ahead(state) || scene.runs(state))
        && sole.outside(state.cop) <= 0.0
    {
        scene.lift(state, dt);
    }
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
                let sole = Support::one(params, physique, &self.stance, Tread::Whole, 0.5 * params.margin);
                ascend::on_tread(self.terrain, physique, &self.stance, sole.nearest(pressure))
            }
            None if down && descend::above(state, self.side) => {
                let rear = &state.feet[self.side as usize];
                descend::between(params, physique, self.terrain, (rear, self.over), pressure)
            }
            None => state.inset.nearest(pressure),
        }
    }

    /// m, over where ξ is held on that foot: on what of its sole is on its tread.
    pub(super) fn middle(&self, state: &State, foot: &Plant, side: Side) -> DVec2 {
        let [from, to] = tread(self.terrain, self.physique, foot);
        let heel = self.physique.heel;
        let front = self.physique.tip.min(to - foot.ankle.z);
        let share = manner(state).over + OVER * self.rise / self.params.size;
        let at = (heel + share * (front - heel)).max(from - foot.ankle.z + INSIDE * self.params.size);
        let inward = state.aside() * (side.sign() * manner(state).inward * self.params.size);
        let leaves = (state.climb.down && side != self.side)
            .then(|| descend::over(self.params, self.physique, self.terrain, state, side))
            .flatten();
        if let Some(ball) = leaves {
            return ball - inward;
        }
        ground(foot.ankle) + support::forward(foot.yaw) * at - inward
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
            let mut place = over + way * (x * x);
            if state.climb.down && descend::sinks(state, swing) {
                place.x = over.x + way.x * (x * x).min(descend::came(state, over.y, over.y + way.y));
            }
            return ([place, state.climb.speed], 0.0);
        }
        let Climb { from, speed, since, .. } = state.climb;
        let [each, least] = manner(state).shifts;
        let takes = (each * from.distance(over) / size).max(least) * tempo;
        let a = ((state.time - since) / takes).clamp(0.0, 1.0);
        let mut place = from + (over - from) * smooth3(a) + speed * (takes * a * (1.0 - a) * (1.0 - a));
        let pace = (over - from) * (6.0 * a * (1.0 - a) / takes) + speed * (1.0 - 4.0 * a + 3.0 * a * a);
        let far = over.y - from.y;
        if far > 0.1 * size {
            let came = ((state.xi().y - from.y) / far).clamp(0.0, 1.0);
            place.x = from.x + (over.x - from.x) * came.max(smooth3(a) - SLACK);
        }
        // who is to go slowly waits over the foot ahead, but not for long
        let apart = self.stance.ankle.z - state.feet[self.side as usize].ankle.z;
        let waits = if state.climb.down {
            0.0
        } else {
            (apart / state.climb.asked.max(SLOWEST) - UP.swing * tempo).min(WAITS * tempo)
        };
        ([place, pace], since + takes.max(waits) - state.time)
    }

    /// Follows the height that the legs reach, and raises the heel behind so that they reach farther.
    fn height(&self, state: &mut State, dt: f64) {
        let (params, physique, stance) = (self.params, self.physique, &self.stance);
        let moving = (state.com.z + state.velocity.z * SOON).min(self.over.y);
        let hip = if state.swing.is_some() { self.over.y } else { moving } - params.com_forward;
        let reaches = |foot: &Plant| ascend::reaches(physique, foot, LEG, hip);
        let own = &state.feet[self.side as usize];
        let (goal, pitch) =
            if let Some(swing) = state.swing.filter(|swing| state.climb.down && descend::sinks(state, swing)) {
                (descend::height(physique, state, &swing, hip), 0.0)
            } else if let Some(swing) = &state.swing {
                let share = (state.time - swing.lift) / (swing.land - swing.lift);
                let full = stance.ankle.y.min(swing.to.ankle.y);
                let bent = full.min(reaches(&swing.to));
                (full + (bent - full) * smooth3((share - LOWERS[0]) / LOWERS[1]), 0.0)
            } else {
                let most = stance.ankle.y.min(reaches(stance));
                // Down the heel behind comes off by itself.
                let up = || ascend::height(params, physique, (state, self.side), hip, most);
                if state.climb.down { (most - self.bends(state), 0.0) } else { up() }
            };
        state.gait.rise = state.swing.map_or(own.ankle.y, |swing| swing.to.ankle.y) - stance.ankle.y;
        let before = state.climb.heel.filter(|(foot, _)| *foot == self.side).map_or(0.0, |(_, pitch)| pitch);
        let most = PITCHES / params.tempo * dt;
        let turned = (self.side, before + (pitch - before).clamp(-most, most));
        state.climb.heel = state.swing.is_none().then_some(turned);
        rise::towards(state, goal, RISES * params.tempo, dt);
    }

    /// m, by how much the knees are bent before a foot goes down.
    fn bends(&self, state: &State) -> f64 {
        let drop = self.stance.ankle.y - self.foothold(state).ankle.y;
        descend::bends(self.params, state.time - state.climb.since, drop.max(0.0))
    }

    /// Is ξ so far ahead that a foot may leave for the tread below?
    fn is_ahead(&self, state: &State) -> bool {
        let sinks = state.climb.down && self.foothold(state).ankle.y < self.stance.ankle.y - EDGE;
        !sinks || descend::ahead(self.params, state, self.over.y)
    }

    /// m, how far apart the feet are across.
    pub(super) fn across(&self) -> f64 {
        WIDER * self.params.step_width.max(0.9 * self.params.gap)
    }

    /// Where the foot goes: beside the other, or on.
    fn foothold(&self, state: &State) -> Plant {
        let (params, physique, stance) = (self.params, self.physique, &self.stance);
        let place = if state.climb.down { descend::place } else { ascend::place };
        let z = place(params, physique, self.terrain, state, self.side);
        let yaw = state.facing + self.side.sign() * physique.toe_out;
        kerb::stood(self.terrain, physique, DVec2::new(stance.ankle.x + self.across() * self.side.sign(), z), yaw)
    }

    /// Lifts the foot.
    fn lift(&self, state: &mut State, dt: f64) {
        let to = self.foothold(state);
        state.swing = Some(Swing {
            side: self.side,
            kind: StepKind::Walk,
            lift: state.time,
            land: state.time + (manner(state).swing * self.params.tempo / dt).round() * dt,
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

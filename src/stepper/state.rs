//! The controller's state, what it is told each tick and what it says. Plain values, scenario space, SI units.

use super::rise::{self, Carried};
use super::stand::OneFoot;
use super::support::{Support, Tread};
use super::walk::Gait;
use super::{Params, Physique, Plant, Step, StepKind, footing, ground, support};
use crate::maths::pendulum;
use crate::model::scenario::Feet;
use crate::model::{Side, Terrain};
use glam::{DVec2, DVec3};

/// What acts on the character during a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// N, disturbances.
    pub force: DVec3,
    /// N m, their moment about the centre of mass.
    pub moment: DVec3,
    /// rad, where the pelvis is wanted to point.
    pub facing: f64,
    /// m/s, the velocity that is commanded, (x, z); `None` to stand.
    pub walk: Option<DVec2>,
    /// 0..1, 0.5 halves the leg's rest length.
    pub crouch: f64,
    /// The feet to stand on.
    pub stand: Feet,
}

impl Default for Inputs {
    /// To stand on both feet, undisturbed, facing +Z.
    fn default() -> Inputs {
        Inputs { force: DVec3::ZERO, moment: DVec3::ZERO, facing: 0.0, walk: None, crouch: 0.0, stand: Feet::Both }
    }
}

/// How a swinging foot stands to the other leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passing {
    /// It stays on its own side.
    Own,
    /// It crosses over in front of the stance leg.
    Front,
    /// It crosses behind it.
    Behind,
}

/// A swing in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Which foot.
    pub side: Side,
    /// Why.
    pub kind: StepKind,
    /// s.
    pub lift: f64,
    /// s, when it will land.
    pub land: f64,
    /// Where it stood.
    pub from: Plant,
    /// Where it will land, as planned now.
    pub to: Plant,
    /// m, where it is aimed, before the ground moves it, (x, z).
    pub aim: DVec2,
    /// m, how far its landing is from where a walk wants it.
    pub off: f64,
    /// How it passes the stance leg.
    pub passing: Passing,
    /// Unit vector (x, z) to the side of the stance ankle on which it passes.
    pub round: DVec2,
    /// m, bulge of its path that way, (x, z).
    pub detour: DVec2,
}

/// A step that is decided and waits for its lift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intent {
    /// Which foot.
    pub side: Side,
    /// Why.
    pub kind: StepKind,
    /// How it will pass the stance leg.
    pub passing: Passing,
    /// The weight is being shifted: the lift comes as soon as the stance foot carries it.
    pub committed: bool,
}

/// Everything that the controller remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Ticks so far.
    pub tick: u64,
    /// s, now.
    pub time: f64,
    /// m, centre of mass.
    pub com: DVec3,
    /// m/s.
    pub velocity: DVec3,
    /// m/s², during the tick that ended now.
    pub acceleration: DVec3,
    /// m, centre of pressure.
    pub cop: DVec2,
    /// The feet: on the ground, or the ankle's shadow raised by its height in the air.
    pub feet: [Plant; 2],
    /// The same feet in the ground frame where they stand (the platform's; scenario space else).
    pub held: [Plant; 2],
    /// What both feet held when they last stood both: their soles' outline, and where in it the pressure may go.
    pub outline: Support,
    /// See `outline`.
    pub inset: Support,
    /// The swing in progress.
    pub swing: Option<Swing>,
    /// The gait.
    pub gait: Gait,
    /// Standing on one foot.
    pub one: OneFoot,
    /// On a flight of stairs.
    pub climb: super::climb::Climb,
    /// The step decided on.
    pub intent: Option<Intent>,
    /// rad, where the pelvis points.
    pub facing: f64,
    /// Unit vector (x, z) that way.
    pub ahead: DVec2,
    /// N, the push as it is felt, (x, z).
    pub felt: DVec2,
    /// N, the push of this moment as the skin feels it, (x, z).
    pub touch: DVec2,
    /// s, how long it has lasted.
    pub pushed: f64,
    /// s, since a shove last acted.
    pub shoved: f64,
    /// m/s, speed that the tipping of the trunk has yet to give to the centre of mass, (x, z).
    pub tip: DVec2,
    /// m/s², upward acceleration that the legs give.
    pub lift: f64,
    /// m, how far the pendulum's arc has lowered the centre of mass.
    pub arc: f64,
    /// Coulomb coefficient of the ground.
    pub friction: f64,
    /// The height of the ground that the legs' rest lengths are reckoned from.
    pub carried: Carried,
    /// s, since ξ left the inner region; 0 while it has not.
    pub alarm: f64,
    /// s, since both feet are down.
    pub settled: f64,
    /// s, since the last corrective or follow-up step landed; large when there was none.
    pub recovering: f64,
    /// The foot that stepped last.
    pub last: Option<Side>,
    /// s, at rest by the measures' definition.
    pub rest: f64,
    /// s, the same by a speed that scales with the body.
    pub calm: f64,
    /// s, when balance was lost.
    pub lost: Option<f64>,
}

/// What happened in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickOutput {
    /// That foot left the ground.
    pub lifted: Option<Side>,
    /// That step landed.
    pub landed: Option<Step>,
    /// Balance was lost in this tick.
    pub lost: bool,
}

impl State {
    /// At rest, the ankles' middle over `place`, facing `facing`.
    pub fn standing(params: &Params, physique: &Physique, terrain: &Terrain, place: DVec2, facing: f64) -> State {
        let feet = Side::BOTH.map(|side| {
            let apart = params.stance.apart * (0.5 * side.sign());
            let ankle = place + support::left(facing) * apart.x + support::forward(facing) * apart.y;
            footing::set_down(terrain, physique, ankle, facing + params.stance.yaws[side as usize], 0.0)
        });
        let held = feet.each_ref().map(|foot| footing::to_ground(foot, terrain.turn(0.0)));
        let hold = |margin: f64| Support::two(params, physique, [&feet[0], &feet[1]], [Tread::Whole; 2], margin);
        let over = params.stance.over;
        let over = place + support::left(facing) * over.x + support::forward(facing) * over.y;
        let low = 0.5 * (feet[0].ankle.y + feet[1].ankle.y) - 0.35 * (feet[0].ankle.y - feet[1].ankle.y).abs();
        State {
            tick: 0,
            time: 0.0,
            com: DVec3::new(over.x, physique.com_height + low, over.y),
            velocity: DVec3::ZERO,
            acceleration: DVec3::ZERO,
            cop: over,
            outline: hold(0.0),
            inset: hold(params.margin),
            feet,
            held,
            swing: None,
            gait: Gait::still(params.lead),
            one: OneFoot::default(),
            climb: super::climb::Climb::default(),
            intent: None,
            facing,
            ahead: support::forward(facing),
            felt: DVec2::ZERO,
            touch: DVec2::ZERO,
            pushed: 0.0,
            shoved: 1e3 * params.tempo,
            tip: DVec2::ZERO,
            lift: 0.0,
            arc: 0.0,
            friction: terrain.friction,
            carried: Carried::still(low),
            alarm: 0.0,
            settled: 1e3 * params.tempo,
            recovering: 1e3 * params.tempo,
            last: None,
            rest: 0.0,
            calm: 0.0,
            lost: None,
        }
    }

    /// Both soles stand: what they hold.
    pub fn hold(&mut self, params: &Params, physique: &Physique) {
        let feet = [&self.feet[0], &self.feet[1]];
        self.outline = Support::two(params, physique, feet, [Tread::Whole; 2], 0.0);
        self.inset = Support::two(params, physique, feet, [Tread::Whole; 2], params.margin);
    }

    /// 1/s, the pendulum's rate at the present height.
    pub fn omega(&self) -> f64 {
        pendulum::rate(self.height().max(1e-3))
    }

    /// m, the centre of mass over the ground under it.
    pub fn height(&self) -> f64 {
        self.com.y - rise::under(self, ground(self.com))
    }

    /// m, extrapolated centre of mass.
    pub fn xi(&self) -> DVec2 {
        pendulum::extrapolated(ground(self.com), ground(self.velocity), self.omega())
    }

    /// Unit vector (x, z) to the pelvis's left.
    pub fn aside(&self) -> DVec2 {
        DVec2::new(self.ahead.y, -self.ahead.x)
    }

    /// Does that foot carry?
    pub fn planted(&self, side: Side) -> bool {
        self.swing.is_none_or(|swing| swing.side != side)
    }
}

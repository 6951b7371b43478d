//! What a run leaves behind: the state at every tick and the steps with their exact times. Scenario space, SI units.

use super::SessionPush;
use crate::stepper::{Phase, Plant, Step};
use crate::whole_body::reaction::Senses;
use glam::{DVec2, DVec3};

/// A finished run. Tick `i` stands at `i * dt` s.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// s.
    pub dt: f64,
    /// Tick states, the first at time 0.
    pub ticks: Vec<TickState>,
    /// Steps in the order of their lifts. A swing that the end cut off is not in it.
    pub steps: Vec<Step>,
    /// The swing that the end cut off, as it would have landed; a foot that is held up comes down a while later.
    pub aloft: Option<Step>,
    /// The script's pushes in its order; those that turned with the character as they acted.
    pub pushes: Vec<SessionPush>,
    /// Where the feet stand at time 0: left, right.
    pub start: [Plant; 2],
    /// Balance was lost at that time (s): the ticks end there.
    pub lost: Option<f64>,
    /// For how long the character had been at rest (DESIGN "at rest") when the run ended, s; 0 while it moves.
    pub rest: f64,
}

/// One tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickState {
    /// m, centre of mass.
    pub com: DVec3,
    /// m/s.
    pub velocity: DVec3,
    /// m/s², applied during the tick that ends here.
    pub acceleration: DVec3,
    /// m, extrapolated centre of mass c + v/ω on the ground, (x, z).
    pub xi: DVec2,
    /// m, centre of pressure, (x, z).
    pub cop: DVec2,
    /// N, the disturbances' force during the tick that ends here.
    pub push: DVec3,
    /// N m, the moment of that force about the centre of mass.
    pub push_moment: DVec3,
    /// Ground point under each ankle (in the air: the height over the ground as y) and where the foot points.
    pub feet: [Plant; 2],
    /// Which feet carry.
    pub planted: [bool; 2],
    /// rad, where the pelvis should point.
    pub facing: f64,
    /// m/s, the commanded velocity as the gait follows it, (x, z); 0 to stand.
    pub walk: DVec2,
    /// Where in the gait.
    pub gait: Phase,
    /// Something that no step crosses bars the way that it is to walk.
    pub barred: bool,
    /// m, by how much a crouch lowers the centre of mass.
    pub crouched: f64,
}

impl TickState {
    /// What the upper body knows of it; whether it means to stand on one foot the tick does not say.
    pub fn senses(&self, on_one: bool) -> Senses {
        Senses {
            acceleration: self.acceleration,
            push: self.push,
            push_moment: self.push_moment,
            xi: self.xi,
            velocity: DVec2::new(self.velocity.x, self.velocity.z),
            wanted: self.walk,
            crouched: self.crouched,
            on_one,
            safe: 0.0,
            feet: self.feet,
            planted: self.planted,
            facing: self.facing,
        }
    }
}

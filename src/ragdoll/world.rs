//! The world of the articulated body: its links in reduced coordinates ([`crate::dynamics`]), the ground, and what else there is.
//!
//! Scenario space, SI units. Springs and damping of the joints are taken at the end of each part of a tick (what stands at 10 ms);
//! feed-forward enters through the springs' rests.

use super::figure::{Figure, Freedom, Part};
use super::ranges::range_of;
use super::things::{Balls, Held};
use super::touches::Surroundings;
use crate::dynamics::{Around, Articulation, Joint, Link, Tree, TreeError};
use crate::model::{Side, Terrain};
use glam::{DMat3, DQuat, DVec2, DVec3};

/// m from the origin, m/s and m of a joint's gap: beyond, the simulation has broken down.
const FARTHEST: f64 = 100.0;
pub(super) const FASTEST: f64 = 100.0;
const TORN: f64 = 0.05;
/// N m, the most that a joint gives.
pub const MOST_TORQUE: f64 = 500.0;
/// Upward part of the ground's unit normal, below which who leans into it may touch it with his hands: 20 degrees.
const HANDS: f64 = 0.94;

/// Where a link is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkState {
    /// m, the link's origin.
    pub origin: DVec3,
    /// Turn from the stand.
    pub turn: DQuat,
    /// m/s, of the link's centre of mass.
    pub velocity: DVec3,
    /// rad/s.
    pub spin: DVec3,
}

/// The world.
#[derive(Clone)]
pub struct World {
    /// s, length of a tick.
    pub dt: f64,
    /// In how many parts a tick is taken.
    pub parts: usize,
    pub(super) body: Articulation,
    pub(super) around: Around,
    pub(super) surroundings: Surroundings,
    pub(super) balls: Balls,
    pub(super) held: Option<Held>,
    pub(super) offsets: Vec<DVec3>, // m, by which the law's centre of a link is beside its own, link's frame
    centres: Vec<DVec3>,
    pressed: Vec<f64>,
    bears: Vec<usize>, // the link that what presses on one counts for: a toe's is its foot
}

impl World {
    /// The figure placed so, at rest, on that ground; ticks of `dt` s in `parts`.
    pub fn new(
        figure: &Figure,
        placed: &[(DVec3, DQuat)],
        terrain: &Terrain,
        dt: f64,
        parts: usize,
    ) -> Result<World, TreeError> {
        let links = figure.links.iter().enumerate().map(|(index, link)| Link {
            parent: link.parent,
            joint: match link.freedom {
                Freedom::Free => Joint::Free,
                Freedom::Ball { .. } => Joint::Ball,
                Freedom::Hinge { axis, .. } => Joint::Hinge { axis },
            },
            anchor: link.anchor,
            mass: link.mass,
            centre: link.centre,
            // A hand without flesh still has something to turn.
            inertia: link.inertia + DMat3::IDENTITY * (1e-6 * link.mass),
            range: range_of(figure, index, terrain),
        });
        let tree = Tree::new(links.collect())?;
        Ok(World {
            dt,
            parts,
            body: Articulation::new(tree, placed, MOST_TORQUE),
            around: Around::default(),
            surroundings: Surroundings::new(figure, terrain),
            balls: Balls::default(),
            held: None,
            offsets: vec![DVec3::ZERO; figure.links.len()],
            centres: figure.links.iter().map(|link| link.centre).collect(),
            pressed: vec![0.0; figure.links.len()],
            bears: (0..figure.links.len()).map(|link| figure.bears(link)).collect(),
        })
    }

    /// Where the links are.
    pub fn read(&self, states: &mut Vec<LinkState>) {
        states.clear();
        states.extend((0..self.body.links()).map(|link| {
            let (origin, turn) = self.body.place(link);
            let centre = origin + turn * (self.centres[link] + self.offsets[link]);
            let (velocity, spin) = self.body.motion_at(link, centre);
            LinkState { origin, turn, velocity, spin }
        }));
    }

    /// What is wrong with the links, for a person: a number that is none, a part that flew away, was torn off, or is faster than
    /// any body; `None` where all is well.
    pub fn broken(figure: &Figure, states: &[LinkState]) -> Option<String> {
        for (index, (link, state)) in figure.links.iter().zip(states).enumerate() {
            let name = link.part.name();
            let finite = state.origin.is_finite() && state.turn.is_finite();
            if !finite || !state.velocity.is_finite() || !state.spin.is_finite() {
                return Some(format!("the place of the {name} is not a finite number"));
            }
            if state.origin.length() > FARTHEST {
                return Some(format!("the {name} left the world ({:.0} m away)", state.origin.length()));
            }
            if state.velocity.length() > FASTEST {
                return Some(format!("the {name} moves at {:.0} m/s", state.velocity.length()));
            }
            let joint = link.parent.map(|parent| states[parent].origin + states[parent].turn * link.anchor);
            let gap = joint.map_or(0.0, |joint| joint.distance(state.origin));
            if index > 0 && gap > TORN {
                return Some(format!("the joint of the {name} came apart by {:.0} cm", gap * 100.0));
            }
        }
        None
    }

    /// What the joint of a link does in the next tick: a spring towards `ahead` (rad from where it is, the parent's frame) and a damper,
    /// N m/rad and N m s/rad about the parent's axes; of a hinge the first of each.
    pub fn drive(&mut self, link: usize, stiffness: DVec3, damping: DVec3, ahead: DVec3) {
        self.body.drive(link, stiffness, damping, ahead);
    }

    /// N m, what the joint of a link gave in the last tick, its spring and damper included.
    pub fn given(&self, link: usize) -> f64 {
        self.body.given(link)
    }

    /// Lets all forces of the last tick go.
    pub fn clear_forces(&mut self) {
        self.body.let_go();
    }

    /// A force on a link at a point of scenario space, and a torque, for the next tick.
    pub fn push(&mut self, link: usize, force: DVec3, point: DVec3, torque: DVec3) {
        self.body.push(link, force, point, torque);
    }

    /// One tick; the ground stands as it will at `time` (s) at its end.
    pub fn step(&mut self, terrain: &Terrain, time: f64) {
        let begin = time - self.dt;
        let still = !terrain.moves();
        let spin = if still {
            DVec3::ZERO
        } else {
            super::short(terrain.turn(time) * terrain.turn(begin).inverse()) / self.dt
        };
        self.gather();
        let (surroundings, dt) = (&self.surroundings, self.dt);
        self.body.step(&mut self.around, self.dt, self.parts, &mut |body, loose, share, touches| {
            if still {
                surroundings.find(body, loose, (terrain, spin), touches);
            } else {
                surroundings.find(body, loose, (&terrain.held_at(begin + share * dt), spin), touches);
            }
        });
        self.pressed.fill(0.0);
        for met in self.around.met.iter().filter(|met| met.touch.other.is_none()) {
            self.pressed[self.bears[met.touch.link]] += met.impulse.length();
        }
        self.scatter(terrain, time);
    }

    /// N s, what the ground pressed on a link's box in the last tick; a foot's toes count for the foot.
    pub fn pressed(&self, link: usize) -> f64 {
        self.pressed[link]
    }

    /// A link other than a foot that bears on the ground; shanks only where the knee is down.
    pub fn lies_on(&self, figure: &Figure, states: &[LinkState], terrain: &Terrain) -> Option<usize> {
        let least = 0.03 * figure.mass * 9.81 * self.dt;
        (0..figure.links.len()).find(|index| {
            let at = states[*index].origin;
            let knee = || at.y - terrain.spot(DVec2::new(at.x, at.z)).height < 0.2 * figure.leg_length;
            match figure.links[*index].part {
                Part::Foot(_) | Part::Toes(_) => false,
                Part::Shank(_) => knee() && self.pressed(*index) > least,
                // Hands that hang reach ground that rises before who leans into it.
                Part::Forearm(_) | Part::Hand(_) if terrain.spot(DVec2::new(at.x, at.z)).normal.y < HANDS => false,
                _ => self.pressed(*index) > least,
            }
        })
    }

    /// Is either foot's box pressed: left, right.
    pub fn feet_pressed(&self, figure: &Figure) -> [bool; 2] {
        Side::BOTH.map(|side| self.pressed(figure.legs[side as usize][2]) > 0.0)
    }
}

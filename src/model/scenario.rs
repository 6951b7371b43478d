//! The scenario: what a person writes to say what happens to the character. Plain data in SI; angles in radians.
//!
//! Scenario space: metres, Y up, Z the rig's forward (so X is its left), origin on the ground under the rig. Headings are
//! seen from above, 0 forward, positive towards the left. The text form (TOML, degrees) is read by
//! `scenario_text`, what makes sense is decided in `scenario_rules`.
//! Lanes keep the order of the file; entries of a lane need not stand in the order of their times.

use super::load;
use super::role::Role;
use super::surface::Surface;
use crate::maths::real;
use glam::DVec3;
use std::sync::Arc;

/// A whole scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// What a clip is named after.
    pub title: String,
    /// s.
    pub duration: f64,
    /// Starts every random draw.
    pub seed: u64,
    /// What differs from the rig's own character.
    pub character: Character,
    /// What it stands on.
    pub ground: Ground,
    /// Which of the paper's variants the stepper is.
    pub stepper: Stepper,
    /// The clip that the reaction starts from.
    pub base: Option<Base>,
    /// Intent: where to walk.
    pub walk: Vec<Walk>,
    /// Intent: turning on the spot.
    pub turn: Vec<Turn>,
    /// Intent: how low to stand.
    pub crouch: Vec<Crouch>,
    /// Intent: on which feet to stand.
    pub stand: Vec<Stand>,
    /// Disturbance: shoves.
    pub push: Vec<Push>,
    /// Disturbance: sustained forces.
    pub pull: Vec<Push>,
    /// Disturbance: balls.
    pub throw: Vec<Throw>,
    /// Disturbance: a box in both hands.
    pub carry: Vec<Carry>,
    /// A person's own marks on the timeline; they change nothing.
    pub marker: Vec<Marker>,
}

/// The character, where it differs from the rig's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Character {
    /// kg; `None`: from the rig.
    pub mass: Option<f64>,
    /// Times the rig's legs: thighs and shanks grow in every direction, feet and upper body stay as they are.
    pub leg_scale: f64,
    /// 0..1; 0.5 halves the leg's rest length.
    pub crouch: f64,
    /// 0..1: 0.5 an ordinary adult, 1 whatever balance takes.
    pub agility: f64,
    /// 0..1: breathing and the small unrest of standing still; 0 none, 0.5 as found in people.
    pub breathing: f64,
    /// How it moves where balance leaves a choice.
    pub style: Style,
}

/// Style dials, each 0..1 with 0.5 as found in people.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// How high the swing foot goes.
    pub step_height: f64,
    /// How far apart the feet stand.
    pub stance_width: f64,
    /// How soon it steps.
    pub readiness: f64,
    /// How long it takes to come back to a comfortable stand.
    pub recovery_time: f64,
    /// How much the arms do.
    pub arms: f64,
}

/// The stepper as the paper varies it; as it comes, the best that is known. The articulated body follows
/// all of them but spring and damping: its legs hold it by torques.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepper {
    /// In a walk pressure moves under a foot. Without: the paper's bare pendulum, which touches the ground in points. A stand keeps it.
    pub ankle_feedback: bool,
    /// Legs give and stretch. Without: the height is kept.
    pub leg_change: bool,
    /// The area under a foot.
    pub support: SupportModel,
    /// What makes it step.
    pub trigger: Trigger,
    /// Times the leg's stiffness, 25 kN/m of the reference body.
    pub spring: f64,
    /// Times its damper, 2.0 kN s/m of the reference body.
    pub damping: f64,
    /// Times the share of a leg's length error that a step is shorter or longer by.
    pub length_bias: f64,
    /// The paper's k_p, of the centre of mass's height: how far a force as large as the weight moves the foothold.
    pub pull_bias: f64,
}

/// What makes the stepper step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trigger {
    /// The extrapolated centre of mass ξ leaves the support.
    Extrapolated,
    /// The paper's wording: the bare projection of the centre of mass does.
    Projected,
}

/// How the stepper models the area under a foot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SupportModel {
    /// The rectangle of the real sole, and the hull of two.
    Soles,
    /// The paper's: a circle under each foot, a capsule between two.
    Circles,
    /// A capsule along each sole, and the hull of two.
    Capsules,
}

/// The ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Its shape.
    pub kind: GroundKind,
    /// Coulomb coefficient.
    pub friction: f64,
}

/// Shapes of ground. Slopes, stairs and gaps run along Z.
#[derive(Clone, Debug, PartialEq)]
pub enum GroundKind {
    /// The plane y = 0.
    Flat,
    /// A plane.
    Slope {
        /// rad, up positive along heading 0.
        angle: f64,
    },
    /// The first riser stands 1 m ahead.
    Stairs {
        /// m, up positive.
        rise: f64,
        /// m.
        tread: f64,
        /// Number of risers.
        count: u32,
    },
    /// Rolling ground.
    Uneven {
        /// m, crest over trough.
        height: f64,
        /// m.
        wavelength: f64,
        /// Which ground of that kind.
        seed: u64,
    },
    /// The first gap lies 1 m ahead.
    Gaps {
        /// m.
        width: f64,
        /// m, from gap to gap.
        spacing: f64,
    },
    /// A 3 m square that turns about its centre under the rig.
    Platform {
        /// (s, rad), straight lines between.
        pitch: Vec<[f64; 2]>,
        /// (s, rad), straight lines between.
        roll: Vec<[f64; 2]>,
    },
    /// Triangles of one's own: the file's world is scenario space.
    Mesh {
        /// A glTF file, relative to the scenario's folder.
        file: String,
        /// m over the origin, if one is given; faces that lie higher are no ground.
        ceiling: Option<f64>,
        /// What is in the file, once it has been read.
        surface: Option<Arc<Surface>>,
    },
}

/// m over the origin: the ceiling of a scenario that gives none, where some of its ground lies over other. Over a head, under most roofs.
pub const CEILING: f64 = 2.0;

/// A clip that the reaction starts from, plays over and returns to. At least one of the two is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    /// Its name: in the file, or in the rig where there is no file.
    pub clip: Option<String>,
    /// A motion file, relative to the scenario's folder.
    pub file: Option<String>,
}

/// Walk from `start` until the next entry of the lane or for `duration`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk {
    /// s.
    pub start: f64,
    /// s.
    pub duration: Option<f64>,
    /// m/s, 0 stops.
    pub speed: f64,
    /// rad, seen from above: 0 the rig's own forward, positive towards its left.
    pub heading: f64,
    /// rad, where the pelvis points; `None`: along the heading.
    pub facing: Option<f64>,
}

/// Turn on the spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// s.
    pub start: f64,
    /// s, that it may take.
    pub duration: Option<f64>,
    /// rad.
    pub facing: f64,
}

/// Crouch from `start` until the next entry of the lane or for `duration`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crouch {
    /// s.
    pub start: f64,
    /// s.
    pub duration: Option<f64>,
    /// 0..1, as [`Character::crouch`].
    pub amount: f64,
}

/// Stand on certain feet from `start` until the next entry of the lane or for `duration`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// s.
    pub start: f64,
    /// s.
    pub duration: Option<f64>,
    /// Which feet carry.
    pub on: Feet,
}

/// Feet to stand on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feet {
    /// Two feet.
    Both,
    /// The left one only.
    Left,
    /// The right one only.
    Right,
}

/// A force on a bone, constant over its time: a push, or a pull (the same, but sustained).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// s.
    pub start: f64,
    /// s.
    pub duration: f64,
    /// N.
    pub force: f64,
    /// Where it drives the character to.
    pub toward: Direction,
    /// Where it acts. A rig that lacks the bone takes it at the next one towards the hips that it has.
    pub at: Role,
}

/// Rigid spheres thrown at the character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Throw {
    /// s, when the first one arrives.
    pub start: f64,
    /// How many.
    pub count: u32,
    /// s between them.
    pub interval: f64,
    /// m, least and greatest; drawn by the seed.
    pub radius: [f64; 2],
    /// kg/m³.
    pub density: f64,
    /// m/s on arrival.
    pub speed: f64,
    /// Where they come from.
    pub from: Direction,
    /// Where they are aimed.
    pub at: Role,
    /// m, how far from there they may hit.
    pub spread: f64,
}

/// A box in both hands. They come up for it in the 0.6 s before its start; there it appears in them, and its weight is taken
/// over in 0.4 s. At the end the same in reverse. From time 0, and to the end of the scenario, it is simply held.
#[derive(Clone, Debug, PartialEq)]
pub struct Carry {
    /// s.
    pub start: f64,
    /// s; `None`: until the scenario ends.
    pub end: Option<f64>,
    /// (s, kg), straight lines between; a constant mass is one entry.
    pub mass: Vec<[f64; 2]>,
    /// (s, m: across, up, forward), straight lines between; a constant size is one entry.
    pub size: Vec<(f64, DVec3)>,
}

impl Carry {
    /// m: across, up, forward, at a time (s).
    pub fn size_at(&self, time: f64) -> DVec3 {
        let axis = |axis: usize| {
            let lengths: Vec<[f64; 2]> = self.size.iter().map(|(at, size)| [*at, size[axis]]).collect();
            load::along(&lengths, time)
        };
        DVec3::new(axis(0), axis(1), axis(2))
    }
}

/// A mark on the timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// s.
    pub time: f64,
    /// What is there.
    pub name: String,
}

/// A direction as a person says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction {
    /// Ahead of the character as it faces when it starts.
    Front,
    /// Behind it.
    Back,
    /// To its left.
    Left,
    /// To its right.
    Right,
    /// rad from its front, positive towards its left.
    Heading(f64),
    /// In scenario space, of any length but zero; does not turn with the character.
    Vector(DVec3),
}

impl Direction {
    /// The unit vector in scenario space for a character that faces `facing_yaw` (rad about +Y, 0 along +Z, positive
    /// towards +X). Zero for a zero vector, which [`Scenario::validate`] refuses.
    pub fn unit(self, facing_yaw: f64) -> DVec3 {
        let forward = DVec3::new(real::sin(facing_yaw), 0.0, real::cos(facing_yaw));
        let left = DVec3::new(forward.z, 0.0, -forward.x);
        match self {
            Direction::Front => forward,
            Direction::Back => -forward,
            Direction::Left => left,
            Direction::Right => -left,
            Direction::Heading(angle) => forward * real::cos(angle) + left * real::sin(angle),
            Direction::Vector(vector) => {
                // Scaled first: the square of a very long vector would overflow, that of a very short one vanish.
                let largest = vector.abs().max_element();
                if largest > 0.0 && largest.is_finite() { (vector / largest).normalize() } else { DVec3::ZERO }
            }
        }
    }
}

impl Push {
    /// s, when it is over.
    pub fn end(&self) -> f64 {
        self.start + self.duration
    }

    /// N s.
    pub fn impulse(&self) -> f64 {
        self.force * self.duration
    }
}

impl Default for Style {
    fn default() -> Style {
        Style { step_height: 0.5, stance_width: 0.5, readiness: 0.5, recovery_time: 0.5, arms: 0.5 }
    }
}

impl Default for Character {
    fn default() -> Character {
        Character { mass: None, leg_scale: 1.0, crouch: 0.0, agility: 0.5, breathing: 0.0, style: Style::default() }
    }
}

impl Default for Stepper {
    fn default() -> Stepper {
        Stepper {
            ankle_feedback: true,
            leg_change: true,
            support: SupportModel::Soles,
            trigger: Trigger::Extrapolated,
            spring: 1.0,
            damping: 1.0,
            length_bias: 1.0,
            pull_bias: 0.4,
        }
    }
}

impl Default for Ground {
    fn default() -> Ground {
        Ground { kind: GroundKind::Flat, friction: 1.0 }
    }
}

impl Default for Scenario {
    /// Four seconds of standing still.
    fn default() -> Scenario {
        Scenario {
            title: "untitled".to_owned(),
            duration: 4.0,
            seed: 0,
            character: Character::default(),
            ground: Ground::default(),
            stepper: Stepper::default(),
            base: None,
            walk: Vec::new(),
            turn: Vec::new(),
            crouch: Vec::new(),
            stand: Vec::new(),
            push: Vec::new(),
            pull: Vec::new(),
            throw: Vec::new(),
            carry: Vec::new(),
            marker: Vec::new(),
        }
    }
}

impl Scenario {
    /// What `bake builtin --demo` bakes: a shove of 60 N s from the left at the chest.
    pub fn demo() -> Scenario {
        Scenario {
            title: "shove from the left".to_owned(),
            seed: 7,
            push: vec![Push { start: 0.6, duration: 0.2, force: 300.0, toward: Direction::Right, at: Role::Chest }],
            ..Scenario::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn directions_are_the_characters_own_when_it_faces_forward() {
        assert_eq!(Direction::Front.unit(0.0), DVec3::Z);
        assert_eq!(Direction::Left.unit(0.0), DVec3::X);
        assert_eq!(Direction::Right.unit(0.0), -DVec3::X);
        assert_eq!(Direction::Back.unit(0.0), -DVec3::Z);
    }

    #[test]
    fn directions_turn_with_the_character_and_vectors_do_not() {
        let facing = FRAC_PI_2; // it looks to where its left was
        assert!(Direction::Front.unit(facing).distance(DVec3::X) < 1e-12);
        assert!(Direction::Left.unit(facing).distance(-DVec3::Z) < 1e-12);
        assert_eq!(Direction::Vector(DVec3::new(0.0, 0.0, 2.0)).unit(facing), DVec3::Z);
    }

    #[test]
    fn a_heading_of_ninety_degrees_is_left_whatever_it_faces() {
        for facing in [-PI, -1.0, 0.0, 0.3, 2.5] {
            let heading = Direction::Heading(FRAC_PI_2).unit(facing);
            assert!(heading.distance(Direction::Left.unit(facing)) < 1e-12, "facing {facing}");
            assert!((heading.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn extreme_vectors_still_give_a_unit_or_zero() {
        for (vector, length) in [(1e300, 1.0), (1e-300, 1.0), (0.0, 0.0), (f64::NAN, 0.0), (f64::INFINITY, 0.0)] {
            let unit = Direction::Vector(DVec3::new(vector, vector, 0.0)).unit(0.0);
            assert!((unit.length() - length).abs() < 1e-12, "{vector}");
        }
    }

    #[test]
    fn the_demo_is_sixty_newton_seconds() {
        assert!((Scenario::demo().push[0].impulse() - 60.0).abs() < 1e-9);
    }
}

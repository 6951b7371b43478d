//! How far the trunk bends forwards over a crouch, and the arms with it. Radians.
//!
//! A shank leans over a flat foot no further than the ankle bends. Who goes low puts the hips back instead, the trunk forwards
//! over the feet and the arms before it: 30 to 45 degrees of trunk in a half crouch. How far a body must is found on its own stand.

use super::anatomy::Anatomy;
use super::reaction::{UPPER, UpperAngles, upper_turns};
use super::solve::{PoseTarget, Solver};
use super::stand::{TRUNK_LEAN, natural_plants, stand_target};
use crate::measure::joints::LegAngles;
use crate::model::{Body, Physique, Side};
use glam::DVec3;

/// rad, the farthest that the trunk leans to keep the heels down, and how far it leans over heels that are up.
const LEANS: [f64; 2] = [50.0 * std::f64::consts::PI / 180.0, 36.0 * std::f64::consts::PI / 180.0];
/// rad, by which the ankle stays inside of its range: a stride needs the rest.
const MARGIN: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// rad, the most that a hip flexes for it: a thigh that swings needs the rest of its 125 degrees.
const HIP: f64 = 100.0 * std::f64::consts::PI / 180.0;
/// Depths at which a body is tried.
const DEPTHS: usize = 8;
/// Leans at which each is tried.
const TRIES: usize = 16;
/// Of either lean, what the pelvis takes beyond its share: hips go back over heels that are down, and flex less over those that are up.
const PELVES: [f64; 2] = [0.35, -0.25];
/// rad of the shoulder and of the elbow for each of the lean: hands before the knees.
const ARMS: [f64; 2] = [1.35, 0.6];

/// What a crouch adds to the upper body, from none to the deepest: rad of the trunk's lean beyond what the reaction has for it, and of the
/// pelvis beyond its share of that.
#[derive(Clone, Debug)]
pub struct Stoop {
    deepest: f64, // m
    leans: [Lean; DEPTHS + 1],
}

type Lean = glam::DVec2;

impl Stoop {
    /// For a body that crouches down to `deepest` (m, by which its centre of mass is lower).
    pub fn new(body: &Body, anatomy: &Anatomy, physique: &Physique, deepest: f64) -> Stoop {
        let mut stoop = Stoop { deepest, leans: [Lean::ZERO; DEPTHS + 1] };
        if deepest <= 0.0 {
            return stoop;
        }
        let legs = LegAngles::of(body);
        let plants = natural_plants(physique.stance_width, physique.com_forward);
        let mut solver = Solver::new(body, anatomy);
        // rad, how far the worse ankle and hip are within what a stand that low may ask of them.
        let mut spare = |lowered: f64, more: Lean| {
            let com = DVec3::Y * (physique.com_height - lowered);
            let mut angles = [0.0; UPPER];
            angles[1] = bent(lowered, physique);
            add(&mut angles, more);
            let (pelvis, chest, head, arms) = upper_turns(&angles);
            let target = PoseTarget { pelvis, chest, head, arms, ..stand_target(body, &plants, com, 0.0) };
            let pose = solver.solve(&target).pose;
            let of = |side: Side| {
                legs.at(&pose, side).map(|angles| [legs.ranges(side)[2][1] - MARGIN - angles[2], HIP - angles[0]])
            };
            Side::BOTH.into_iter().filter_map(of).fold([f64::INFINITY; 2], |a, b| [a[0].min(b[0]), a[1].min(b[1])])
        };
        for depth in 1..=DEPTHS {
            let lowered = deepest * depth as f64 / DEPTHS as f64;
            let rest = |most: f64| (most - TRUNK_LEAN - bent(lowered, physique)).max(0.0);
            let tried = |part: usize| rest(LEANS[0]) * part as f64 / TRIES as f64;
            let holds = |more: &Lean, spare: &mut dyn FnMut(f64, Lean) -> [f64; 2]| {
                spare(lowered, *more).iter().all(|spare| *spare >= 0.0)
            };
            let down = (0..=TRIES)
                .map(|part| Lean::new(tried(part), PELVES[0] * tried(part)))
                .find(|more| holds(more, &mut spare));
            stoop.leans[depth] = down.unwrap_or(Lean::new(rest(LEANS[1]), PELVES[1] * rest(LEANS[1])));
        }
        stoop
    }

    /// Adds what a crouch that deep (m) asks of the upper body.
    pub fn add(&self, lowered: f64, angles: &mut UpperAngles) {
        if self.deepest > 0.0 {
            let place = (lowered / self.deepest).clamp(0.0, 1.0);
            add(angles, crate::maths::curve::sample(&self.leans, 1.0 / DEPTHS as f64, place));
        }
    }
}

/// rad, what the reaction leans for a crouch.
fn bent(lowered: f64, physique: &Physique) -> f64 {
    super::reaction::CROUCH_LEAN * lowered / physique.leg_length
}

fn add(angles: &mut UpperAngles, lean: Lean) {
    angles[1] += lean.x;
    angles[17] += lean.y;
    for side in 0..2 {
        angles[7 + side * 3] += ARMS[0] * lean.x;
        angles[9 + side * 3] += ARMS[1] * lean.x;
    }
}

//! What friction allows: the ground's force stays in its cone, and the gait takes no steps that would ask for more.
//!
//! A pendulum over its pressure asks the ground for a level force of its lean times its load. Ground plane (x, z), SI units.

use super::{Params, Physique, State, rise};
use crate::maths::real;
use glam::{DVec2, DVec3};

/// Share of the friction coefficient that a walk uses: the legs' own swing asks for the rest (a baked walk at 1.2 m/s asks for 0.39
/// where its pendulum asks for 0.25; with 0.6 here, walks on 0.1 and 0.3 asked for 0.12 and 0.33).
const USED: f64 = 0.5;
/// Lean to the sides of a walk, over the height: it asks for friction too.
const ASIDE: f64 = 0.045;
/// Share of a step that both feet carry in a slow walk: then the pressure goes along.
const DOUBLE: f64 = 0.3;
/// Of the foot's length, how far the pressure rolls on under it.
const ROLLS: f64 = 0.4;
/// m, of the reference body: steps are no shorter than so, slip or not.
const LEAST: f64 = 0.12;
/// Share of what friction could give, that starting and stopping may take.
const RAMP: f64 = 0.4;
/// Halvings that find the largest share of a force in its cone: to a part in 65,000.
const HALVINGS: usize = 16;

/// m, the longest step whose lean friction holds where the ground is as steep as `grade` (m a m).
pub fn longest(params: &Params, physique: &Physique, state: &State) -> f64 {
    let cone = real::atan2(USED * state.friction, 1.0) - real::atan2(state.gait.grade.abs(), 1.0) * USED;
    let lean = real::tan(cone.max(0.0));
    let along = (lean * lean - ASIDE * ASIDE).max(0.0).sqrt();
    let rolled = ROLLS * (physique.tip - physique.heel);
    ((2.0 * along * physique.com_height + rolled) / (1.0 - DOUBLE)).max(LEAST * params.size)
}

/// m/s², how fast a walk gathers speed and loses it at most.
pub fn ramp(params: &Params, state: &State) -> f64 {
    params.ramp.min(RAMP * state.friction * crate::maths::pendulum::GRAVITY)
}

/// The level part (m/s², (x, z)) of what the ground gives a body whose legs push up with `up` m/s²: `wanted`, or as much of it as the
/// cone about the ground's normal holds; the feet slide under the rest.
pub fn held(state: &State, wanted: DVec2, up: f64) -> DVec2 {
    let normal = rise::normal(state);
    let inside = |share: f64| {
        let force = DVec3::new(wanted.x * share, up.max(0.0), wanted.y * share);
        let straight = force.dot(normal);
        (force - normal * straight).length() <= state.friction * straight + 1e-12
    };
    if inside(1.0) {
        return wanted;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if inside(middle) { low = middle } else { high = middle }
    }
    wanted * low
}

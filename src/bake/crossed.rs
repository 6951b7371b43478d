//! What of a mesh's ground the walks of a scenario cross, looked at before anything is played. Scenario space, metres.

use crate::maths::real;
use crate::model::Terrain;
use crate::model::scenario::Scenario;
use glam::{DVec2, DVec3};

/// m, to either side of the way that is looked at too, and between the places asked along it.
const ASIDE: f64 = 0.3;
const STRIDE: f64 = 0.05;
/// m: walls so high over the ground are met; m: what rises or falls by more is stopped before, and so are holes that are wider.
const WALL: f64 = 0.5;
const STOPS: f64 = 0.4;
const HOLE: f64 = 0.5;
/// m: grades are compared over so much of the way.
const BENDS: f64 = 0.15;

/// What there is on the way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Crossed {
    /// Metres a metre, the greatest rise and the greatest fall of a face, and the greatest lean across the way.
    pub(super) up: f64,
    pub(super) down: f64,
    pub(super) across: f64,
    /// Metres a metre, by which the rise of the ground changes at the most from place to place.
    pub(super) bends: f64,
    /// m, the highest step, up or down; and the least way from one to the next.
    pub(super) step: f64,
    pub(super) apart: Option<f64>,
    /// Is there a hole to step over?
    pub(super) hole: bool,
    /// Do steps lie straight across the way?
    pub(super) aslant: bool,
}

/// What the walks of a scenario cross, if nothing pushes them aside.
pub(super) fn crossed(scenario: &Scenario) -> Crossed {
    let terrain = Terrain::new(&scenario.ground);
    let mut found = Crossed::default();
    let mut place = DVec2::ZERO;
    for (index, walk) in scenario.walk.iter().enumerate() {
        let next = scenario.walk.get(index + 1).map_or(scenario.duration, |next| next.start);
        let lasts = walk.duration.map_or(next, |lasts| next.min(walk.start + lasts)) - walk.start;
        let way = DVec2::new(real::sin(walk.heading), real::cos(walk.heading));
        let far = walk.speed * lasts.max(0.0);
        let mut first: Option<f64> = None;
        for aside in [0.0, -ASIDE, ASIDE] {
            let from = place + DVec2::new(way.y, -way.x) * aside;
            let edge = along(&terrain, (from, way), far, &mut found);
            let straight = first.is_none_or(|first| edge.is_some_and(|edge| (edge - first).abs() < STRIDE));
            found.aslant |= aside != 0.0 && (!straight || first.is_none() && edge.is_some());
            first = first.or(if aside == 0.0 { edge } else { None });
        }
        place += way * far;
    }
    found
}

/// Along one line, to where a walk stops by itself; gives how far along it the first step is, m.
fn along(terrain: &Terrain, (from, way): (DVec2, DVec2), far: f64, found: &mut Crossed) -> Option<f64> {
    let (mut here, mut lacking, mut last) = (terrain.spot(from), 0.0, None::<f64>);
    let mut first = None;
    let mut grades: Vec<f64> = Vec::new();
    for number in 1..=(far / STRIDE).ceil() as usize {
        let at = from + way * (STRIDE * number as f64);
        let next = terrain.spot(at);
        if !next.holds {
            lacking += STRIDE;
            if lacking > HOLE {
                return first;
            }
            continue;
        }
        found.hole |= std::mem::take(&mut lacking) > 0.0;
        let over = here.height + WALL;
        let before = at - way * STRIDE;
        let walled = terrain.wall(DVec3::new(before.x, over, before.y), DVec3::new(at.x, over, at.y)).is_some();
        let grade = |normal: DVec3, way: DVec2| -(normal.x * way.x + normal.z * way.y) / normal.y.max(0.1);
        let [was, is] = [here.normal, next.normal].map(|normal| grade(normal, way));
        let step = (next.height - here.height - 0.5 * STRIDE * (was + is)).abs();
        if walled || step > STOPS {
            return first;
        }
        if step > crate::model::terrain::RISER {
            let place = STRIDE * number as f64;
            found.step = found.step.max(step);
            if let Some(last) = last {
                found.apart = Some(found.apart.map_or(place - last, |least| least.min(place - last)));
            }
            (first, last) = (first.or(Some(place)), Some(place));
        }
        grades.push(is);
        let behind = grades[grades.len().saturating_sub((BENDS / STRIDE) as usize + 1)];
        found.bends = found.bends.max((is - behind).abs());
        (found.up, found.down) = (found.up.max(is), found.down.max(-is));
        found.across = found.across.max(grade(next.normal, DVec2::new(way.y, -way.x)).abs());
        here = next;
    }
    first
}

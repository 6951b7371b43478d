//! The ground as a surface: how high it is, how it leans, where it holds a foot. Scenario space, metres, radians.
//!
//! [`Terrain::spot`] answers in the **ground frame**: scenario space but for the platform, whose frame turns about the origin
//! as [`Terrain::turn`] says. Without memory, so that stepper, clip, measure and picture see the same ground. A mesh answers for the
//! topmost of its faces that face up under the ceiling; where it has none
//! it does not hold.

use super::scenario::{CEILING, Ground, GroundKind};
use super::surface::Surface;
use crate::maths::real;
use crate::maths::seed::Seed;
use glam::{DQuat, DVec2, DVec3};
use std::sync::Arc;

/// m ahead of the origin, where stairs and gaps begin.
pub const FIRST: f64 = 1.0;
/// m, side of the square platform.
pub const PLATFORM_SIDE: f64 = 3.0;
/// Plane waves in uneven ground.
const WAVES: usize = 6;
/// Upward part of the unit normal of a floor that counts as level: within 0.1 degrees.
const LEVEL: f64 = 1.0 - 1.5e-6;
/// m, how far on a mesh edges are looked for.
const SEEN: f64 = 0.9;
/// m, ground that leaves its own plane by so much within [`STRIDE`] is an edge: a sole that is over the lower side is not borne there.
pub const RISER: f64 = 0.02;
/// m, between the places asked along a way; and how often that is halved to find an edge: to 0.1 mm.
const STRIDE: f64 = 0.03;
/// As [`STRIDE`] says.
const HALVINGS: u32 = 8;
/// m, height of a place where a mesh has nothing: below all that a foot could reach.
const NOTHING: f64 = -10.0;

/// A ground that can be asked about.
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain {
    /// Its shape.
    pub kind: GroundKind,
    /// Coulomb coefficient.
    pub friction: f64,
    waves: [Wave; WAVES],
    tilt: DQuat,        // of a platform that is held still
    lean: (f64, DVec3), // of a slope: m a metre by which it rises, unit normal
}

/// One plane wave of uneven ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Wave {
    along: DVec2, // rad/m
    phase: f64,
    height: f64, // m
}

/// The ground at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// m.
    pub height: f64,
    /// Unit vector out of the ground.
    pub normal: DVec3,
    /// False over a gap.
    pub holds: bool,
}

impl Ground {
    /// The triangles of a mesh that has been read.
    pub fn surface(&self) -> Option<&Arc<Surface>> {
        match &self.kind {
            GroundKind::Mesh { surface, .. } => surface.as_ref(),
            _ => None,
        }
    }

    /// Lays triangles into a mesh's ground.
    pub fn lay(&mut self, read: &Arc<Surface>) {
        if let GroundKind::Mesh { surface, .. } = &mut self.kind {
            *surface = Some(Arc::clone(read));
        }
    }
}

impl GroundKind {
    /// m over the origin: the ceiling that holds. None has to be given for hills to be ground where nothing lies over anything else.
    pub fn ceiling(&self) -> f64 {
        match self {
            GroundKind::Mesh { ceiling: Some(ceiling), .. } => *ceiling,
            GroundKind::Mesh { surface: Some(surface), .. } if surface.is_roofed() => CEILING,
            _ => f64::INFINITY,
        }
    }
}

impl Terrain {
    /// The ground of a scenario.
    pub fn new(ground: &Ground) -> Terrain {
        let mut waves = [Wave::default(); WAVES];
        if let GroundKind::Uneven { height, wavelength, seed } = ground.kind {
            let mut draw = Seed::new(seed);
            for (index, wave) in waves.iter_mut().enumerate() {
                let angle = (index as f64 + draw.between(-0.4, 0.4)) * std::f64::consts::PI / WAVES as f64;
                let length = wavelength * draw.between(0.8, 1.6);
                *wave = Wave {
                    along: DVec2::new(real::sin(angle), real::cos(angle)) * (std::f64::consts::TAU / length),
                    phase: draw.between(0.0, std::f64::consts::TAU),
                    height: 0.5 * height / WAVES as f64, // all crests together reach what was asked
                };
            }
        }
        let lean = match ground.kind {
            GroundKind::Slope { angle } => (real::tan(angle), DVec3::new(0.0, real::cos(angle), -real::sin(angle))),
            _ => (0.0, DVec3::Y),
        };
        Terrain { kind: ground.kind.clone(), friction: ground.friction, waves, tilt: DQuat::IDENTITY, lean }
    }

    /// The plane y = 0 with friction 1.
    pub fn flat() -> Terrain {
        Terrain::new(&Ground::default())
    }

    /// Is it level ground with gaps across?
    pub fn has_gaps(&self) -> bool {
        matches!(self.kind, GroundKind::Gaps { .. })
    }

    /// Has it level treads at different heights?
    pub fn has_treads(&self) -> bool {
        matches!(self.kind, GroundKind::Stairs { .. })
    }

    /// m, from where to where, along z, the tread reaches that has that z, or the ground between two gaps that is nearest to it; `None` where
    /// there is no such thing.
    pub fn floor(&self, z: f64) -> Option<[f64; 2]> {
        match self.kind {
            GroundKind::Stairs { tread, count, .. } => {
                let number = ((z - FIRST) / tread).floor();
                let (first, last) = (number < 0.0, number >= f64::from(count) - 1.0);
                let from = if first { f64::NEG_INFINITY } else { FIRST + number.min(f64::from(count) - 1.0) * tread };
                let to = if first {
                    FIRST
                } else if last {
                    f64::INFINITY
                } else {
                    FIRST + (number + 1.0) * tread
                };
                Some([from, to])
            }
            GroundKind::Gaps { width, spacing } => {
                // solid ground number 0 ends where the first gap begins
                let number = ((z - FIRST - 0.5 * width) / spacing).floor() + 1.0;
                let from = if number < 0.5 { f64::NEG_INFINITY } else { FIRST + width + (number - 1.0) * spacing };
                Some([from, if number < 0.5 { FIRST } else { FIRST + number * spacing }])
            }
            _ => None,
        }
    }

    /// Has it, or may it have, edges at which the ground ends or goes on higher or lower?
    pub fn has_edges(&self) -> bool {
        self.has_gaps() || self.has_treads() || self.is_mesh()
    }

    /// Is it a mesh?
    pub fn is_mesh(&self) -> bool {
        matches!(self.kind, GroundKind::Mesh { .. })
    }

    /// m, as [`Self::floor`], on the line along z through a place; on a mesh from edge to edge, infinite where there is none within
    /// [`SEEN`].
    pub fn floor_at(&self, at: DVec2) -> Option<[f64; 2]> {
        let GroundKind::Mesh { .. } = self.kind else { return self.floor(at.y) };
        let far = |way: DVec2| self.edge(at, way, SEEN).unwrap_or(f64::INFINITY);
        Some([at.y - far(DVec2::NEG_Y), at.y + far(DVec2::Y)])
    }

    /// m, how far from a place, that way, the first edge is within `reach` m: where the ground ends, or leaves its own plane by
    /// [`RISER`] or more within [`STRIDE`].
    pub fn edge(&self, at: DVec2, way: DVec2, reach: f64) -> Option<f64> {
        let spot = |far: f64| self.spot(at + way * far);
        let mut here = spot(0.0);
        for step in 1..=(reach / STRIDE).ceil() as usize {
            let far = STRIDE * step as f64;
            let next = spot(far);
            if !next.holds && !here.holds {
                continue;
            }
            let grade = |spot: &Spot| -(spot.normal.x * way.x + spot.normal.z * way.y) / spot.normal.y.max(0.1);
            let rise = next.height - here.height - 0.5 * STRIDE * (grade(&here) + grade(&next));
            if next.holds != here.holds || rise.abs() > RISER {
                let above = 0.5 * (here.height + next.height);
                let (mut near, mut beyond) = (far - STRIDE, far);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (near + beyond);
                    let same = (spot(middle).height > above) == (here.height > above);
                    *(if same { &mut near } else { &mut beyond }) = middle;
                }
                return Some(0.5 * (near + beyond));
            }
            here = next;
        }
        None
    }

    /// Is it the plane y = 0 for good?
    pub fn is_flat(&self) -> bool {
        self.kind == GroundKind::Flat
    }

    /// m, the height of a level floor at (x, z): of flat ground, and of a mesh where it is level; `None` where feet may lean.
    pub fn level_at(&self, at: DVec2) -> Option<f64> {
        match self.kind {
            GroundKind::Flat => Some(0.0),
            GroundKind::Mesh { .. } => {
                let spot = self.spot(at);
                (spot.holds && spot.normal.y > LEVEL).then_some(spot.height)
            }
            _ => None,
        }
    }

    /// Does it turn under the feet?
    pub fn moves(&self) -> bool {
        matches!(self.kind, GroundKind::Platform { .. })
    }

    /// The ground as it stands at a time, held still: then [`Self::spot`] answers in scenario space for a platform too.
    pub fn held_at(&self, time: f64) -> Terrain {
        Terrain { tilt: self.turn(time), ..self.clone() }
    }

    /// The ground at (x, z) in the ground frame.
    pub fn spot(&self, at: DVec2) -> Spot {
        let level = |height: f64| Spot { height, normal: DVec3::Y, holds: true };
        match self.kind {
            GroundKind::Platform { .. } if self.tilt != DQuat::IDENTITY => {
                let normal = self.tilt * DVec3::Y;
                let height = -(normal.x * at.x + normal.z * at.y) / normal.y.max(1e-3);
                Spot { height, normal, holds: true }
            }
            GroundKind::Flat | GroundKind::Platform { .. } => level(0.0),
            GroundKind::Slope { .. } => Spot { height: at.y * self.lean.0, normal: self.lean.1, holds: true },
            GroundKind::Stairs { rise, tread, count } => {
                let climbed = if at.y < FIRST { 0.0 } else { ((at.y - FIRST) / tread).floor() + 1.0 };
                level(rise * climbed.min(f64::from(count)))
            }
            GroundKind::Gaps { width, spacing } => {
                let into = (at.y - FIRST).rem_euclid(spacing);
                Spot { holds: at.y < FIRST || into >= width, ..level(0.0) }
            }
            GroundKind::Uneven { .. } => {
                let (mut height, mut lean) = (0.0, DVec2::ZERO);
                for wave in &self.waves {
                    let (sin, cos) = real::sin_cos(wave.along.dot(at) + wave.phase);
                    // level under the start, so that everybody stands well
                    height += wave.height * (sin - real::sin(wave.phase));
                    lean += wave.along * (wave.height * cos);
                }
                Spot { height, normal: DVec3::new(-lean.x, 1.0, -lean.y).normalize(), holds: true }
            }
            GroundKind::Mesh { ref surface, .. } => {
                let found = surface.as_ref().and_then(|surface| surface.ground(at, self.kind.ceiling()));
                found.map_or(Spot { holds: false, ..level(NOTHING) }, |(height, normal)| Spot {
                    height,
                    normal,
                    holds: true,
                })
            }
        }
    }

    /// The ground that a point may touch: on a mesh the topmost face no more than `reach` m over it, so that what is beside a kerb does
    /// not stand on it.
    pub fn spot_under(&self, point: DVec3, reach: f64) -> Spot {
        let at = DVec2::new(point.x, point.z);
        let GroundKind::Mesh { surface: Some(surface), .. } = &self.kind else { return self.spot(at) };
        let nothing = Spot { height: NOTHING, normal: DVec3::Y, holds: false };
        let found = surface.ground(at, self.kind.ceiling().min(point.y + reach));
        found.map_or(nothing, |(height, normal)| Spot { height, normal, holds: true })
    }

    /// Where on the way from one point to another the first wall of a mesh stands, and its unit normal towards the one.
    pub fn wall(&self, from: DVec3, to: DVec3) -> Option<(DVec3, DVec3)> {
        let GroundKind::Mesh { surface: Some(surface), .. } = &self.kind else { return None };
        surface.wall(from, to).map(|(share, normal)| (from.lerp(to, share), normal))
    }

    /// How the ground frame is turned about the origin at a time: identity for everything but a platform.
    pub fn turn(&self, time: f64) -> DQuat {
        let GroundKind::Platform { pitch, roll } = &self.kind else { return DQuat::IDENTITY };
        DQuat::from_rotation_z(along(roll, time)) * DQuat::from_rotation_x(-along(pitch, time))
    }
}

/// The value at a time of (s, value) points, straight lines between, constant beyond the ends; 0 where there are none.
fn along(points: &[[f64; 2]], time: f64) -> f64 {
    let after = points.partition_point(|point| point[0] <= time);
    match (after.checked_sub(1).and_then(|before| points.get(before)), points.get(after)) {
        (Some(before), Some(next)) => {
            before[1] + (next[1] - before[1]) * (time - before[0]) / (next[0] - before[0]).max(1e-9)
        }
        (Some(only), None) | (None, Some(only)) => only[1],
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terrain(kind: GroundKind) -> Terrain {
        Terrain::new(&Ground { kind, ..Ground::default() })
    }

    /// The unit normal that the heights around a place say.
    fn leaning(terrain: &Terrain, at: DVec2) -> DVec3 {
        let (e, height) = (1e-5, |x: f64, z: f64| terrain.spot(DVec2::new(x, z)).height);
        let x = (height(at.x + e, at.y) - height(at.x - e, at.y)) / (2.0 * e);
        let z = (height(at.x, at.y + e) - height(at.x, at.y - e)) / (2.0 * e);
        DVec3::new(-x, 1.0, -z).normalize()
    }

    #[test]
    fn a_slope_rises_ahead_and_its_normal_leans_back() {
        let slope = terrain(GroundKind::Slope { angle: 25_f64.to_radians() });
        let spot = slope.spot(DVec2::new(3.0, 2.0));
        assert!((spot.height - 2.0 * real::tan(25_f64.to_radians())).abs() < 1e-12 && spot.normal.z < -0.4);
        assert!(spot.normal.distance(leaning(&slope, DVec2::new(3.0, 2.0))) < 1e-9);
    }

    #[test]
    fn stairs_climb_a_rise_a_tread_and_end() {
        for rise in [0.17, -0.17] {
            let stairs = terrain(GroundKind::Stairs { rise, tread: 0.3, count: 4 });
            for (z, treads) in
                [(-5.0, 0.0), (0.999, 0.0), (1.001, 1.0), (1.299, 1.0), (1.301, 2.0), (1.95, 4.0), (50.0, 4.0)]
            {
                let spot = stairs.spot(DVec2::new(0.4, z));
                assert!((spot.height - rise * treads).abs() < 1e-12 && spot.normal == DVec3::Y && spot.holds, "{z}");
            }
        }
    }

    #[test]
    fn gaps_begin_a_metre_ahead_and_come_back_at_their_spacing() {
        let gaps = terrain(GroundKind::Gaps { width: 0.2, spacing: 1.2 });
        for (z, holds) in
            [(-3.0, true), (0.99, true), (1.01, false), (1.19, false), (1.21, true), (2.21, false), (2.41, true)]
        {
            assert_eq!(gaps.spot(DVec2::new(0.0, z)).holds, holds, "{z}");
        }
    }

    #[test]
    fn uneven_ground_is_as_high_from_trough_to_crest_as_asked() {
        for seed in 0..20 {
            let ground = terrain(GroundKind::Uneven { height: 0.05, wavelength: 1.5, seed });
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for index in 0..250_000 {
                let at = DVec2::new(f64::from(index % 500) * 0.06 - 15.0, f64::from(index / 500) * 0.06 - 15.0);
                let height = ground.spot(at).height;
                (low, high) = (low.min(height), high.max(height));
            }
            assert!((0.045..=0.05).contains(&(high - low)), "seed {seed}: {:.4} m of 0.05", high - low);
            let at = DVec2::new(0.7, -2.1);
            assert!(
                ground.spot(at).normal.distance(leaning(&ground, at)) < 1e-8 && ground.spot(DVec2::ZERO).height == 0.0
            );
        }
    }

    #[test]
    fn a_platform_held_still_is_a_plane_through_the_origin() {
        let turning =
            terrain(GroundKind::Platform { pitch: vec![[0.0, 0.0], [2.0, 0.4]], roll: vec![[0.0, 0.0], [2.0, 0.2]] });
        let held = turning.held_at(1.0);
        for place in [DVec3::new(0.4, 0.0, -0.7), DVec3::new(-0.2, 0.0, 0.3)] {
            let at = turning.turn(1.0) * place;
            let spot = held.spot(DVec2::new(at.x, at.z));
            assert!((spot.height - at.y).abs() < 1e-12 && spot.normal.distance(turning.turn(1.0) * DVec3::Y) < 1e-12);
            assert_eq!(turning.spot(DVec2::new(at.x, at.z)).height, 0.0);
        }
    }

    #[test]
    fn a_platform_pitches_its_front_up_and_rolls_its_left_up() {
        let turned = |pitch: f64, roll: f64| {
            terrain(GroundKind::Platform { pitch: vec![[1.0, 0.0], [3.0, pitch]], roll: vec![[1.0, 0.0], [3.0, roll]] })
        };
        assert_eq!(turned(0.5, 0.5).turn(0.5), DQuat::IDENTITY);
        assert!(((turned(0.5, 0.0).turn(9.0) * DVec3::Z).y - real::sin(0.5)).abs() < 1e-12, "the front");
        assert!(((turned(0.0, 0.5).turn(9.0) * DVec3::X).y - real::sin(0.5)).abs() < 1e-12, "the left");
        assert!(((turned(0.5, 0.0).turn(2.0) * DVec3::Z).y - real::sin(0.25)).abs() < 1e-12, "half-way");
    }
}

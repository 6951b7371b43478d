//! The held-out shoves that the tables of the articulated body draw, and how shares of them are told. N, s, Ns, rad.
//!
//! They are the paper's, 10 to 500 N for 0.1 to 0.5 s from anywhere, sorted into five bins of impulse. Their seeds are such
//! that nothing was tuned on. For `tests/benches/{ragdoll,clips}.rs`.

use glam::DVec3;
use std::path::PathBuf;
use surefoot::maths::seed::Seed;
use surefoot::measure::{KnownPush, PushPoint};
use surefoot::model::scenario::{Direction, Push, Scenario};
use surefoot::model::{Body, Role};

/// The first seed of the held-out shoves: tuning used 1 to 400 000.
pub const HELD_OUT: u64 = 5_000_000;
/// Ns, the edges of the bins.
pub const EDGES: [f64; 6] = [0.0, 50.0, 100.0, 150.0, 200.0, 250.0];
/// Wanted of who does not look ahead (`--effort 0`), % that stand, a bin.
pub const WANTED: [f64; 5] = [100.0, 98.0, 95.0, 88.0, 55.0];
/// Wanted of who looks ahead (`--effort 1`), % that stand, a bin.
pub const AHEAD: [f64; 5] = [100.0, 100.0, 100.0, 99.0, 95.0];
/// kg, whom the shoves are made for.
pub const HEAVY: f64 = 89.5;
/// Shoves a bin where no number is given.
pub const COUNT: usize = 64;
/// Rigs that nobody here made.
pub const OTHERS: [&str; 2] = ["gdquest_mannequiny.glb", "m2m_human_male.glb"];

/// The files of those rigs that are there.
pub fn files(names: &[&str]) -> Vec<PathBuf> {
    let folder = crate::data::place().join("rigs");
    names.iter().map(|name| folder.join(name)).filter(|path| path.exists()).collect()
}

/// One of the paper's shoves.
#[derive(Clone, Copy, Debug)]
pub struct Shove {
    /// s.
    pub start: f64,
    /// s.
    pub duration: f64,
    /// N.
    pub force: f64,
    /// rad, 0 forwards, positive towards the left.
    pub heading: f64,
}

impl Shove {
    /// Ns.
    pub fn impulse(&self) -> f64 {
        self.force * self.duration
    }

    /// As a run takes it: at the chest, or what is nearest to one.
    pub fn known(&self, body: &Body) -> KnownPush {
        let chest = [Role::Chest, Role::Spine, Role::Hips].into_iter().find_map(|role| body.joint(role)).unwrap_or(0);
        let force = DVec3::new(self.heading.sin(), 0.0, self.heading.cos()) * self.force;
        KnownPush { start: self.start, end: self.start + self.duration, force, at: PushPoint::Joint(chest) }
    }

    /// As a person would write it, for a clip of so many s.
    pub fn scenario(&self, length: f64) -> Scenario {
        let Shove { start, duration, force, heading } = *self;
        let push = Push { start, duration, force, toward: Direction::Heading(heading), at: Role::Chest };
        Scenario { duration: length, push: vec![push], ..Scenario::default() }
    }
}

/// The held-out shoves whose impulses lie in a bin.
pub fn drawn(bin: usize, count: usize) -> Vec<Shove> {
    (HELD_OUT..)
        .map(|seed| {
            let mut draw = Seed::new(seed);
            let start = draw.between(0.5, 1.5);
            let duration = draw.between(0.1, 0.5);
            let force = draw.between(10.0, 500.0);
            Shove { start, duration, force, heading: draw.between(0.0, std::f64::consts::TAU) }
        })
        .filter(|shove| (EDGES[bin]..EDGES[bin + 1]).contains(&shove.impulse()))
        .take(count)
        .collect()
}

/// %.
pub fn share(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}

/// Wilson's interval for a share, %.
pub fn wilson(part: usize, whole: usize) -> [f64; 2] {
    let (n, p, z) = (whole as f64, part as f64 / whole as f64, 1.96);
    let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    [100.0 * (middle - half).max(0.0), 100.0 * (middle + half).min(1.0)]
}

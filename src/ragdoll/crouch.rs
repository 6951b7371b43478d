//! How far the trunk leans of a body that holds its pelvis low on level ground. Radians and metres, (y, z) of the stand: up, ahead.
//!
//! Over a bent knee the shank leans forward, and an ankle has no range for a knee bent by 70 degrees under hips that are over it: the heel
//! comes up, only the ball bears, and a plan that has the pressure under the ankle waits in vain for the body to go ahead. So the hips go back
//! and the trunk forward, as far as the ankle needs.

use super::figure::{Figure, Part};
use crate::maths::real;
use crate::model::Side;
use glam::{DVec2, DVec3};

/// rad of its range that an ankle keeps: the body goes ahead over a foot before its heel rises. Of 12 drawn walks, crouched by 0.12 to 0.26 on six
/// bodies, none comes to its speed with 0.05, four with 0.1, all with 0.15 and more; and how much is enough.
const SPARE: f64 = 0.18;
const ENOUGH: f64 = 0.15;
/// rad of it that the ankle of who crouches where he stands keeps: heels that come up at the end of the range have him step.
const STANDS: f64 = 0.05;
/// rad, the farthest that a trunk leans: as the posed body's (`whole_body::stoop`), which squats to 50 degrees.
const MOST: f64 = 0.9;
/// How finely the depth of crouches is gone through: of an ankle that has no range for one half as deep, deeper ones ask less again.
const STEPS: u32 = 100;
/// How often an interval is halved: to 1e-3 rad.
const HALVED: usize = 10;

/// rad, how far a trunk leans whose pelvis is held so much lower than in the stand, m: as little as leaves its ankles range; `goes`: to step.
pub(super) fn lean(figure: &Figure, by: f64, goes: bool) -> f64 {
    if by <= 0.0 {
        return 0.0;
    }
    let spare = if goes { SPARE } else { STANDS };
    let stood = Stood::of(figure);
    let (mut least, mut most) = (0.0, MOST);
    for _ in 0..HALVED {
        let lean = 0.5 * (least + most);
        if stood.flexes(by, lean) > stood.range - spare { least = lean } else { most = lean }
    }
    0.5 * (least + most)
}

/// m, to `most`: how much lower than in the stand the pelvis may be held for its ankles to keep enough of their range under a trunk that leans as
/// far as it may. Who walks lower tiptoes, and hardly gets on.
pub fn deepest(figure: &Figure, most: f64) -> f64 {
    let stood = Stood::of(figure);
    let lower = |step: u32| most * f64::from(step) / f64::from(STEPS);
    (1..=STEPS).map(lower).take_while(|by| stood.flexes(*by, MOST) <= stood.range - ENOUGH).last().unwrap_or(0.0)
}

/// m, by how much lower the centre of mass is for the lean that goes with that, beyond what the pelvis is lower.
pub fn sinks(figure: &Figure, by: f64, lean: f64) -> f64 {
    if by <= 0.0 { 0.0 } else { Stood::of(figure).sinks(by, lean) }
}

/// What of a body in its stand this depends on, as if its feet stood side by side.
struct Stood {
    /// kg and m from the hips: what turns with the trunk, and where the arms hang from it.
    trunk: (f64, DVec2),
    arms: (f64, DVec2),
    /// m, what hangs from there: the arms' centre of mass.
    hangs: DVec2,
    /// kg, of both legs.
    thighs: f64,
    shanks: f64,
    feet: f64,
    /// m, thigh and shank; the hips over the ankles; the pelvis's origin from the hips.
    lengths: [f64; 2],
    hips: f64,
    pelvis: DVec2,
    /// kg m, of all but the feet, ahead of the ankles.
    moment: f64,
    /// rad, how far the shank leans in the stand, and how far the ankle flexes from there.
    shank: f64,
    range: f64,
}

fn side_on(at: DVec3) -> DVec2 {
    DVec2::new(at.y, at.z)
}

impl Stood {
    fn of(figure: &Figure) -> Stood {
        let mut at: Vec<DVec3> = Vec::with_capacity(figure.links.len());
        for link in &figure.links {
            at.push(link.parent.map_or(DVec3::ZERO, |parent| at[parent]) + link.anchor);
        }
        let [hip, knee, ankle] = figure.legs[Side::Left as usize].map(|link| side_on(at[link]));
        let (mut trunk, mut arms, mut hung) = ((0.0, DVec2::ZERO), (0.0, DVec2::ZERO), DVec2::ZERO);
        let (mut thighs, mut shanks, mut feet, mut moment) = (0.0, 0.0, 0.0, 0.0);
        let mut shoulder = hip;
        for (link, at) in figure.links.iter().zip(&at) {
            let centre = side_on(*at + link.centre);
            moment += match link.part {
                Part::Foot(_) | Part::Toes(_) => 0.0,
                _ => link.mass * (centre - ankle).y,
            };
            match link.part {
                Part::Thigh(_) => thighs += link.mass,
                Part::Shank(_) => shanks += link.mass,
                Part::Foot(_) | Part::Toes(_) => feet += link.mass,
                Part::UpperArm(_) | Part::Forearm(_) | Part::Hand(_) => {
                    if matches!(link.part, Part::UpperArm(_)) {
                        shoulder = side_on(*at);
                    }
                    arms.0 += link.mass;
                    hung += centre * link.mass;
                }
                _ => {
                    trunk.0 += link.mass;
                    trunk.1 += (centre - hip) * link.mass;
                }
            }
        }
        trunk.1 /= f64::max(trunk.0, 1e-9);
        let hangs = if arms.0 > 0.0 { hung / arms.0 - shoulder } else { DVec2::ZERO };
        arms.1 = shoulder - hip;
        let shank = knee - ankle;
        Stood {
            trunk,
            arms,
            hangs,
            thighs,
            shanks,
            feet,
            lengths: [hip.distance(knee), shank.length()],
            hips: hip.x - ankle.x,
            pelvis: side_on(at[0]) - hip,
            moment,
            shank: real::atan2(shank.y, shank.x),
            range: figure.leg_ranges[Side::Left as usize][2][1].min(figure.leg_ranges[Side::Right as usize][2][1]),
        }
    }

    /// rad, how far an ankle flexes from the stand where the pelvis is so much lower, m, and the trunk leans by `lean` rad: the hips are where
    /// the body is as far ahead of its ankles as it stands.
    fn flexes(&self, by: f64, lean: f64) -> f64 {
        let (sin, cos) = real::sin_cos(lean);
        let turned = |at: DVec2| DVec2::new(at.x * cos - at.y * sin, at.x * sin + at.y * cos);
        let height = self.hips - by + self.pelvis.x - turned(self.pelvis).x;
        let above = turned(self.trunk.1).y * self.trunk.0 + (turned(self.arms.1) + self.hangs).y * self.arms.0;
        let carried = self.trunk.0 + self.arms.0 + 0.5 * self.thighs;
        let mut knee = DVec2::ZERO;
        for _ in 0..6 {
            let hips = (self.moment - above - 0.5 * (self.thighs + self.shanks) * knee.y) / carried;
            knee = self.knee(DVec2::new(height, hips));
        }
        real::atan2(knee.y, knee.x) - self.shank
    }

    /// m, as [`sinks`] says; legs that bend are lower in the middle by half of what the hips are.
    fn sinks(&self, by: f64, lean: f64) -> f64 {
        let (sin, cos) = real::sin_cos(lean);
        let drop = |at: DVec2| at.x - (at.x * cos - at.y * sin);
        let carried = self.trunk.0 + self.arms.0 + self.thighs + self.shanks + self.feet;
        let above = self.trunk.0 + self.arms.0;
        let lower = by - self.pelvis.x + self.pelvis.x * cos - self.pelvis.y * sin;
        let [thighs, shanks] = [0.75, 0.25].map(|share| share * by);
        let moved = lower * above
            + drop(self.trunk.1) * self.trunk.0
            + drop(self.arms.1) * self.arms.0
            + thighs * self.thighs
            + shanks * self.shanks;
        moved / carried - by
    }

    /// m from the ankle: the knee, ahead of a leg whose hip is there.
    fn knee(&self, hip: DVec2) -> DVec2 {
        let [thigh, shank] = self.lengths;
        let far = hip.length().clamp(0.2 * (thigh + shank), 0.999 * (thigh + shank));
        let along = (shank * shank + far * far - thigh * thigh) / (2.0 * far);
        let way = hip.normalize_or(DVec2::X);
        way * along + DVec2::new(-way.y, way.x) * (shank * shank - along * along).max(0.0).sqrt()
    }
}

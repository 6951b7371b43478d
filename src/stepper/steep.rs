//! The gait up ground that ankles have no range for: feet that land under bent knees stand on their balls, heels up, until the leg is long.
//!
//! An ankle flexes by 30 degrees; the slope takes of that what it leans by, and the shank of a bent knee leans forwards by as much again. Where
//! only the ball bears, the pressure cannot be under the ankle: a plan that has it there waits in vain for ξ to run ahead, and the body stops over
//! its foot. So the pressure is planned under the ball, and with it the foothold, which comes nearer to the body by as much. Of a body of links
//! alone: heels of the kinematic drive rise under a pose that is found anyway. Metres; a rise is metres a metre.

use super::gait::Rhythm;
use super::walk::Phase;
use super::{Params, Physique, State, rise};
use crate::maths::curve::smooth3;
use crate::model::Side;
use glam::DVec2;

/// The rise from which on feet stand on their balls, 12 degrees, and from there to where they do so altogether, 13.4. Between the two ways
/// walks are worst: with 0.08 the least score of 30 drawn walks up 12 to 16 degrees is 0.52, with 0.02 and 0.03 it is 0.83.
const STEEP: f64 = 0.2126;
const OVER: f64 = 0.025;
/// Share of the sole's length by which the pressure is ahead of the ball's middle: between it and the tip.
const AHEAD: f64 = 0.15;

/// Times the usual, how far the pressure rolls under such a foot and how high its steps go. Of 20 drawn walks up 25 degrees on five bodies the mean
/// score is 0.75 with these and steps 1.1 times as long, 0.72 with those and feet 1.15 times as high; 0.87 with these and steps as long as elsewhere.
const ROLLED: f64 = 0.5;
const HIGHER: f64 = 1.3;

/// m/s on legs of 0.83 m, and that for each metre by which the ground falls in one: downhill no walk is faster than the first and the second
/// over the fall, 1.1 m/s down 6 degrees, 0.72 down 15 and 0.63 down 25. Of walks of 12 s of four bodies down 6 to 25 degrees none of 24 fell at
/// 0.6 m/s, 7 at 0.9, 9 at 1.0 and 12 at 1.2, as fast as they were asked to go.
const DOWNHILL: [f64; 2] = [0.5, 0.06];

/// Shares of the leg's length from which on a foot is long, and up to which its length counts. People's is a third.
const LONG: [f64; 2] = [0.38, 0.47];
/// Times by how much the ground rises over the length by which a foot is longer, how much higher one goes that is not to stand on its ball: it turns
/// up to the ground late, and long feet scrape.
const TOES: f64 = 2.5;
/// Times that length, how much higher one goes ahead that bends at its toes, on any ground: they hang down when it leaves.
const DRAGS: f64 = 0.5;

/// rad, how far the heel of such a foot rises at the end of its stance in a slow walk and in a brisk one, and m/s on legs of 0.83 m, which those
/// are. A heel that the ankle's range alone holds up comes down while the leg stretches: the leg is straight before the other foot has landed,
/// carries no more and drags its foot back, the sooner the longer the steps. Of 160 drawn walks up 15 and 25 degrees at 0.35 to 0.9 m/s on five
/// bodies, half of them shoved, 92 slide a foot by more than 30 mm with 0.3 rad at any speed, 29 with these. With 0.42 at any speed the feet of slow
/// walks turn by 7 degrees in a frame as they leave; with 0.6 in brisk ones one of the 160 falls.
const RAISES: [f64; 2] = [0.3, 0.55];
/// As [`RAISES`] says.
const PACES: [f64; 2] = [0.4, 0.7];
/// The share of the other foot's swing from which on that heel rises.
const RAISED: f64 = 0.4;

/// How far feet stand on their balls, 0 to 1.
pub fn share(params: &Params, state: &State) -> f64 {
    if params.balls.is_some() { smooth3((climbs(state) - STEEP) / OVER) } else { 0.0 }
}

/// By how much the ground rises a metre ahead of who walks forwards.
fn climbs(state: &State) -> f64 {
    let (way, normal) = (state.gait.velocity.normalize_or_zero(), rise::normal(state));
    -(normal.x * way.x + normal.z * way.y) / normal.y.max(0.1) * state.ahead.dot(way)
}

/// m/s on legs of 0.83 m, the fastest walk that way where the ground falls; infinite elsewhere.
pub fn fastest(state: &State, way: DVec2) -> f64 {
    let normal = rise::normal(state);
    let falls = (normal.x * way.x + normal.z * way.y) / normal.y.max(0.1);
    if falls > 0.0 { DOWNHILL[0] + DOWNHILL[1] / falls } else { f64::INFINITY }
}

/// m, how high feet go.
pub fn lift(params: &Params, physique: &Physique, state: &State) -> f64 {
    let share = share(params, state);
    let [least, most] = LONG.map(|share| share * physique.leg_length);
    let long = (physique.tip - physique.heel).clamp(least, most) - least;
    let ahead = state.gait.velocity.normalize_or_zero().dot(state.ahead).max(0.0);
    let drags = if params.balls.is_some() { DRAGS * ahead } else { 0.0 };
    let toes = (drags + TOES * climbs(state).max(0.0)) * long;
    params.lift_height * (1.0 + (HIGHER - 1.0) * share) + toes * (1.0 - share)
}

/// The foot whose heel is to rise now, and how far, rad.
pub fn heel(params: &Params, state: &State) -> Option<(Side, f64)> {
    let gait = &state.gait;
    let most = raises(params, gait.velocity.length()) * share(params, state);
    if most <= 0.0 || gait.spot || gait.last {
        return None;
    }
    let passed = (state.time - gait.since) / (gait.until - gait.since).max(gait.tick);
    match gait.phase {
        Phase::Single => Some((gait.side.other(), most * smooth3((passed - RAISED) / (1.0 - RAISED)))),
        Phase::Double => Some((gait.side, most)),
        Phase::Rest | Phase::Start => None,
    }
}

/// rad, how far the heel rises of who walks that fast, m/s.
fn raises(params: &Params, speed: f64) -> f64 {
    let brisk = (speed * params.tempo / params.size - PACES[0]) / (PACES[1] - PACES[0]);
    RAISES[0] + (RAISES[1] - RAISES[0]) * brisk.clamp(0.0, 1.0)
}

/// The rhythm with the pressure's roll where feet that stand on their balls bear.
pub fn on_balls(params: &Params, physique: &Physique, state: &State, rhythm: Rhythm) -> Rhythm {
    let (Some(ball), share) = (params.balls, share(params, state)) else { return rhythm };
    let middle = (ball + AHEAD * (physique.tip - physique.heel)).min(physique.tip - params.margin);
    let [from, to] = rhythm.roll;
    let half = 0.5 * ROLLED * (to - from);
    Rhythm { roll: [from + (middle - half - from) * share, to + (middle + half - to) * share], ..rhythm }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::real;
    use crate::model::Terrain;
    use crate::stepper::Style;
    use glam::{DVec2, DVec3};

    /// A body that walks `heading` rad from straight up a slope of so many degrees, facing that way, and its tuning.
    fn walking(degrees: f64, heading: f64, balls: Option<f64>) -> (Params, State) {
        let physique = Physique::REFERENCE;
        let params = Params { balls, ..Params::embodied(&physique, &Style::default()) };
        let mut state = State::standing(&params, &physique, &Terrain::flat(), DVec2::ZERO, 0.0);
        let (sin, cos) = real::sin_cos(degrees.to_radians());
        state.feet.iter_mut().for_each(|foot| foot.normal = DVec3::new(0.0, cos, -sin));
        let (x, z) = real::sin_cos(heading);
        (state.ahead, state.gait.velocity) = (DVec2::new(x, z), DVec2::new(x, z) * 0.4);
        (params, state)
    }

    fn on(degrees: f64, heading: f64, balls: Option<f64>) -> f64 {
        let (params, state) = walking(degrees, heading, balls);
        share(&params, &state)
    }

    #[test]
    fn walks_are_slower_the_steeper_they_go_down_and_are_not_bounded_elsewhere() {
        let most = |degrees: f64, heading: f64| {
            let (_, state) = walking(degrees, 0.0, None);
            let (x, z) = real::sin_cos(heading);
            fastest(&state, DVec2::new(x, z))
        };
        assert!(most(10.0, 0.0).is_infinite() && most(0.0, 0.0).is_infinite(), "up and on the level");
        let [gentle, steep] = [-6.0, -25.0].map(|degrees| most(degrees, 0.0));
        assert!(0.6 < steep && steep < 0.65 && 1.0 < gentle && gentle < 1.1, "{gentle} {steep}");
        assert!((most(25.0, std::f64::consts::PI) - steep).abs() < 1e-9, "backwards down");
        assert!(most(-25.0, 1.4) > gentle, "across");
    }

    #[test]
    fn feet_stand_on_their_balls_up_what_is_steep_and_nowhere_else() {
        for (degrees, heading) in [(12.0, 0.0), (0.0, 0.0), (-20.0, 0.0), (20.0, 1.6), (20.0, 3.0)] {
            assert_eq!(on(degrees, heading, Some(0.13)), 0.0, "{degrees} degrees, {heading}");
        }
        assert_eq!(on(15.0, 0.0, Some(0.13)), 1.0);
        assert_eq!(on(15.0, 0.0, None), 0.0, "the kinematic drive, and feet that do not bend");
    }

    #[test]
    fn the_heel_of_the_foot_that_is_left_rises_towards_the_other_ones_landing_and_stays_up() {
        let (params, mut state) = walking(20.0, 0.0, Some(0.13));
        state.gait.side = Side::Left;
        (state.gait.since, state.gait.until) = (1.0, 1.4);
        let mut rises = |phase: Phase, time: f64| {
            (state.gait.phase, state.time) = (phase, time);
            heel(&params, &state)
        };
        let stands = [1.0, 1.15, 1.3, 1.39].map(|time| rises(Phase::Single, time).expect("a foot"));
        assert!(stands.iter().all(|(side, _)| *side == Side::Right), "the other one swings");
        assert_eq!((stands[0].1, stands[1].1), (0.0, 0.0));
        assert!(0.0 < stands[2].1 && stands[2].1 < stands[3].1 && stands[3].1 > 0.95 * RAISES[0], "{stands:?}");
        assert_eq!(rises(Phase::Double, 1.2), Some((Side::Left, RAISES[0])), "the one that leaves next");
        assert_eq!(rises(Phase::Rest, 1.2), None);
    }

    #[test]
    fn the_heel_rises_farther_in_a_brisk_walk_on_legs_of_any_length() {
        for long in [0.6, 1.0, 1.5] {
            let (mut params, mut state) = walking(20.0, 0.0, Some(0.13));
            (params.size, params.tempo, state.gait.phase) = (long, f64::sqrt(long), Phase::Double);
            let mut rises = |speed: f64| {
                state.gait.velocity = DVec2::new(0.0, speed * f64::sqrt(long));
                heel(&params, &state).map_or(0.0, |(_, rise)| rise)
            };
            let found = [0.2, 0.4, 0.55, 0.7, 1.2].map(&mut rises);
            let wanted = [0.3, 0.3, 0.425, 0.55, 0.55];
            assert!(
                found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-9),
                "legs {long}: {found:?}"
            );
        }
    }

    #[test]
    fn no_heel_rises_on_gentle_ground_or_where_the_walk_ends() {
        let (params, mut state) = walking(20.0, 0.0, Some(0.13));
        (state.gait.phase, state.gait.last) = (Phase::Double, true);
        assert_eq!(heel(&params, &state), None);
        let (params, mut state) = walking(8.0, 0.0, Some(0.13));
        state.gait.phase = Phase::Double;
        assert_eq!(heel(&params, &state), None);
    }

    #[test]
    fn feet_that_are_long_for_their_legs_go_higher_and_uphill_more_so() {
        let usual = Physique::REFERENCE;
        let long = Physique { tip: usual.tip + 0.15, ..usual };
        let lifts = |physique: &Physique, degrees: f64, aside: f64, balls: Option<f64>| {
            let (params, mut state) = walking(degrees, 0.0, balls);
            state.gait.velocity += DVec2::new(aside, -aside);
            lift(&params, physique, &state) - params.lift_height
        };
        assert_eq!(lifts(&usual, 10.0, 0.0, Some(0.13)), 0.0);
        let [level, uphill] = [0.0, 10.0].map(|degrees| lifts(&long, degrees, 0.0, Some(0.13)));
        assert!(0.02 < level && level + 0.02 < uphill && uphill < 0.15, "{level} {uphill}");
        assert_eq!(lifts(&long, 0.0, 0.0, None), 0.0, "a foot that does not bend has no toes that hang down");
        assert!(lifts(&long, 0.0, 0.4, Some(0.13)) < 1e-9, "nor does one that goes aside");
    }
}

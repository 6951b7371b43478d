//! The push-off: in a brisk walk the heel of the foot that is left rises while both feet bear. Of a body of links alone: heels of the kinematic
//! drive rise under a pose that is found anyway. Radians, m/s.
//!
//! A foot that lies flat until it leaves ends each step on a straight leg, which holds the body back and drags its toes over the ground: steps
//! are no longer than 0.52 m then on legs of 0.83 m, whatever is planned, and no walk is faster than 1.3 m/s.

use super::gait::Rhythm;
use super::walk::{self, Phase};
use super::{Params, Physique, State, rise};
use crate::maths::curve::smooth3;
use crate::model::Side;

/// rad, how far the heel is to rise while both feet bear, in a walk of short strides and in one of long ones: there is time for a third of it,
/// the rest follows in the swing. Measured on five bodies at 1.3 to 1.6 m/s: with 0.15 and 0.3 some still drag their toes, with 0.9 scores are as
/// with 0.7.
const RISES: [f64; 2] = [0.7, 0.9];
/// rad, how far it is up when the other foot lands, and the share of that foot's swing from which on it rises, in a walk of long strides. People's
/// rises in the last third; of drawn walks 0.75 to 0.9 and 0.4 to 0.6 rad are all as good, from 0.3 to 0.65 on they are worse.
const LANDED: f64 = 0.6;
const FROM: f64 = 0.82;
/// Share of the time on one foot after which the pressure stays under the ball, whose heel then rises; times the usual, how long both feet bear.
const RUN: f64 = 0.8;
const DOUBLE: f64 = 0.84;
/// Times the usual, how long a step takes: at 1.2 m/s 153 of them a minute, not 174; people take 110. The mean scores of 60 drawn walks of 0.4 to
/// 1.5 m/s are 0.982 with 1.12, 0.979 with 1.16, 0.973 with 1.2, 0.976 with 1.25; of 448 hard shoves 25 fell who walks with 1.12, 21 with 1.2 and
/// 19 without long strides.
const LONGER: f64 = 1.2;
/// m/s ahead at legs of 0.83 m, from which on heels rise and from which on in full. With 0.8 and 1.1, legs of 0.58 m drag their toes at 0.5 to 0.6 m/s.
const WALKS: [f64; 2] = [0.4, 0.8];
/// The same: from the first on strides are long, from the second on in full, up to the third; from the fourth on they are not. From 0.4 on, a body
/// at 0.5 m/s that is pulled at is 7 % too fast; in full up to 2.0, 2 of 10 walks of 1.5 to 1.8 m/s fall.
const STRIDES: [f64; 4] = [0.65, 0.9, 1.5, 1.7];

/// How far a walk is one of long strides, 0 to 1, whose heels rise before the other foot lands: ahead, on level ground without edges, of feet that
/// bend, and where nothing asks for the quickest steps.
pub fn strides(params: &Params, physique: &Physique, state: &State) -> f64 {
    if state.gait.longest.is_finite() || !walk::in_time(params, state) || share(params, state) <= 0.0 {
        return 0.0;
    }
    let [from, full, until, none] = STRIDES;
    let pace = pace(params, state);
    let brisk = ((pace - from) / (full - from)).min((none - pace) / (none - until)).clamp(0.0, 1.0);
    brisk * params.upright * (1.0 - walk::quick(params, physique, state))
}

/// m/s ahead, at legs of 0.83 m.
fn pace(params: &Params, state: &State) -> f64 {
    state.gait.velocity.dot(state.ahead) * params.tempo / params.size
}

/// How far heels rise, 0 to 1: on level ground, of feet that bend. Who was just shoved keeps his soles on the ground.
fn share(params: &Params, state: &State) -> f64 {
    let gait = &state.gait;
    if params.balls.is_none() || gait.spot || gait.last || state.shoved < params.tempo || !rise::on_level(state) {
        return 0.0;
    }
    ((pace(params, state) - WALKS[0]) / (WALKS[1] - WALKS[0])).clamp(0.0, 1.0)
}

/// The rhythm of a walk whose strides are so long, 0 to 1.
pub fn rolled(rhythm: Rhythm, strides: f64) -> Rhythm {
    let less = |usual: f64| 1.0 - (1.0 - usual) * strides;
    let longer = 1.0 + (LONGER - 1.0) * strides;
    Rhythm {
        step: rhythm.step * longer,
        double: rhythm.double * longer * less(DOUBLE),
        run: rhythm.run * less(RUN),
        ..rhythm
    }
}

/// The foot whose heel is to rise now, and how far, rad.
pub fn heel(params: &Params, physique: &Physique, state: &State) -> Option<(Side, f64)> {
    let gait = &state.gait;
    let (share, strides) = (share(params, state), strides(params, physique, state));
    let passed = (state.time - gait.since) / (gait.until - gait.since).max(gait.tick);
    let (side, rise) = match gait.phase {
        Phase::Single => (gait.side.other(), LANDED * strides * smooth3((passed - FROM) / (1.0 - FROM))),
        Phase::Double => (gait.side, share * (RISES[0] + (RISES[1] - RISES[0]) * strides)),
        Phase::Rest | Phase::Start => return None,
    };
    (rise > 0.0).then_some((side, rise))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Terrain;
    use crate::stepper::Style;
    use glam::DVec2;

    /// A body between two steps of a walk straight ahead, and its tuning.
    fn walking(speed: f64) -> (Params, State) {
        let physique = Physique::REFERENCE;
        let params = Params { balls: Some(0.13), ..Params::embodied(&physique, &Style::default()) };
        let mut state = State::standing(&params, &physique, &Terrain::flat(), DVec2::ZERO, 0.0);
        (state.gait.phase, state.gait.velocity) = (Phase::Double, state.ahead * speed);
        (params, state)
    }

    #[test]
    fn the_heel_of_the_foot_that_leaves_rises_the_more_the_faster_the_walk() {
        let rises = |speed: f64| {
            let (params, state) = walking(speed);
            heel(&params, &Physique::REFERENCE, &state).map(|(side, rise)| {
                assert_eq!(side, state.gait.side);
                rise
            })
        };
        let [slow, middling, fast] = [0.1, 0.5, 1.5].map(rises);
        assert_eq!((slow, fast), (None, Some(RISES[1])));
        assert!(middling.is_some_and(|rise| 0.0 < rise && rise < RISES[0]), "{middling:?}");
        assert_eq!(rises(-1.0), None, "backwards");
    }

    #[test]
    fn the_heel_of_the_foot_that_bears_rises_before_the_other_one_lands_in_a_walk_of_long_strides() {
        let (params, mut state) = walking(1.2);
        state.gait.phase = Phase::Single;
        (state.gait.since, state.gait.until) = (1.0, 1.4);
        let mut rises = |time: f64| {
            state.time = time;
            heel(&params, &Physique::REFERENCE, &state)
        };
        assert_eq!((rises(1.1), rises(1.3)), (None, None));
        let [late, last] = [1.36, 1.4].map(|time| rises(time).expect("a heel rises"));
        assert!(late.0 == state.gait.side.other() && 0.0 < late.1 && late.1 < last.1, "{late:?} {last:?}");
        assert!((last.1 - LANDED).abs() < 1e-9, "{last:?}");
    }

    #[test]
    fn strides_are_long_in_a_walk_ahead_that_nothing_hurries_nor_bounds() {
        let long = |speed: f64, change: fn(&mut State)| {
            let (params, mut state) = walking(speed);
            change(&mut state);
            strides(&params, &Physique::REFERENCE, &state)
        };
        assert_eq!(long(1.2, |_| ()), 1.0);
        assert!((0.0..1.0).contains(&long(0.8, |_| ())));
        assert_eq!(long(1.8, |_| ()), 0.0, "too fast");
        assert_eq!(long(1.2, |state| state.gait.longest = 0.6), 0.0, "edges");
        assert_eq!(long(1.2, |state| state.gait.lasting = glam::DVec2::new(0.0, -60.0)), 0.0, "a pull");
    }

    #[test]
    fn feet_that_do_not_bend_do_not_push_off() {
        let (params, state) = walking(1.2);
        assert_eq!(heel(&Params { balls: None, ..params }, &Physique::REFERENCE, &state), None);
    }

    #[test]
    fn no_heel_rises_at_rest_at_a_stop_soon_after_a_shove_or_where_it_is_not_level() {
        let changes: [fn(&mut State); 4] = [
            |state| state.gait.phase = Phase::Rest,
            |state| state.gait.last = true,
            |state| state.shoved = 0.1,
            |state| state.gait.grade = 0.1,
        ];
        for (number, change) in changes.into_iter().enumerate() {
            let (params, mut state) = walking(1.2);
            assert!(heel(&params, &Physique::REFERENCE, &state).is_some());
            change(&mut state);
            assert_eq!(heel(&params, &Physique::REFERENCE, &state), None, "change {number}");
        }
    }
}

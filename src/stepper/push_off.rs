//! The push-off: in a brisk walk the heel of the foot that is left rises while both feet bear. Of a body of links alone: heels of the kinematic
//! drive rise under a pose that is found anyway. Radians, m/s.
//!
//! A foot that lies flat until it leaves ends each step on a straight leg, which holds the body back and drags its toes over the ground: steps
//! are no longer than 0.52 m then on legs of 0.83 m, whatever is planned, and no walk is faster than 1.3 m/s.

use super::walk::Phase;
use super::{Params, State, rise};
use crate::model::Side;

/// rad, how far the heel is to rise; while both feet bear there is time for 0.2 of it, the rest follows in the swing. Measured on five bodies at
/// 1.3 to 1.6 m/s: with 0.15 and 0.3 some still drag their toes, with 0.9 scores are as with 0.7.
const RISES: f64 = 0.7;
/// m/s ahead at legs of 0.83 m, from which on heels rise and from which on in full. With 0.8 and 1.1, legs of 0.58 m drag their toes at 0.5 to 0.6 m/s.
const WALKS: [f64; 2] = [0.4, 0.8];

/// The foot whose heel is to rise now, and how far, rad: on level ground, of feet that bend. Who was just shoved keeps his soles on the ground.
pub fn heel(params: &Params, state: &State) -> Option<(Side, f64)> {
    let gait = &state.gait;
    if params.balls.is_none()
        || gait.phase != Phase::Double
        || gait.spot
        || gait.last
        || state.shoved < params.tempo
        || !rise::on_level(state)
    {
        return None;
    }
    let speed = gait.velocity.dot(state.ahead) * params.tempo / params.size;
    let share = (speed - WALKS[0]) / (WALKS[1] - WALKS[0]);
    (share > 0.0).then_some((gait.side, RISES * share.min(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Physique, Terrain};
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
            heel(&params, &state).map(|(side, rise)| {
                assert_eq!(side, state.gait.side);
                rise
            })
        };
        let [slow, middling, fast] = [0.1, 0.5, 1.5].map(rises);
        assert_eq!((slow, fast), (None, Some(RISES)));
        assert!(middling.is_some_and(|rise| 0.0 < rise && rise < RISES), "{middling:?}");
        assert_eq!(rises(-1.0), None, "backwards");
    }

    #[test]
    fn feet_that_do_not_bend_do_not_push_off() {
        let (params, state) = walking(1.2);
        assert_eq!(heel(&Params { balls: None, ..params }, &state), None);
    }

    #[test]
    fn no_heel_rises_on_one_foot_at_a_stop_soon_after_a_shove_or_where_it_is_not_level() {
        let changes: [fn(&mut State); 4] = [
            |state| state.gait.phase = Phase::Single,
            |state| state.gait.last = true,
            |state| state.shoved = 0.1,
            |state| state.gait.grade = 0.1,
        ];
        for (number, change) in changes.into_iter().enumerate() {
            let (params, mut state) = walking(1.2);
            assert!(heel(&params, &state).is_some());
            change(&mut state);
            assert_eq!(heel(&params, &state), None, "change {number}");
        }
    }
}

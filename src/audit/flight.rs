//! Flights: a body without contact falls at 9.81 m/s², whatever it does.
//!
//! Clip space, SI. The path of the centre of mass through a flight, unfiltered (a filter would smear the take-off's push into it), is
//! fitted by a parabola; a flight under 0.2 s at 30 fps has too few frames for one and is passed over.

use super::Mark;
use super::contacts::Footfalls;
use super::track::Track;
use crate::measure::GRAVITY;
use crate::model::findings::Rule;

/// Frames that a fit needs, ends left out.
const LEAST: usize = 7;
/// Shares of gravity between which a flight is one: a file's unit is often a guess.
const FALLS: (f64, f64) = (0.62, 1.7);
/// Share of gravity under which no body flies: something that is not seen carries it.
const CARRIED: f64 = 0.2;

/// Spans without contact, first and last frame.
pub fn flights(track: &Track, feet: &Footfalls) -> Vec<(usize, usize)> {
    super::spans(track.len(), |frame| feet.bearing(frame) == 0)
}

/// Every mark of the rule.
pub fn marks(track: &Track, feet: &Footfalls) -> Vec<Mark> {
    let last = track.len() - 1;
    flights(track, feet)
        .into_iter()
        .filter(|(start, end)| *start > 0 && *end < last)
        .filter_map(|(start, end)| {
            let fall = fall(track, start, end)?;
            let share = fall / GRAVITY;
            let seconds = (end - start + 1) as f64 / track.capture.fps;
            let off = share > CARRIED && !(FALLS.0..=FALLS.1).contains(&share);
            off.then(|| Mark {
                start,
                end,
                rule: Rule::Ballistic,
                side: None,
                measured: fall,
                predicted: GRAVITY,
                delta: (fall - GRAVITY).abs() * seconds * seconds / 8.0,
                limit: (1.0 - FALLS.0) * GRAVITY * seconds * seconds / 8.0,
                why: format!("in flight the body falls at {fall:.1} m/s² instead of {GRAVITY}"),
            })
        })
        .collect()
}

/// m/s²: how fast the centre of mass falls in a span, by least squares; `None` for too few frames.
fn fall(track: &Track, start: usize, end: usize) -> Option<f64> {
    let edge = (0.02 * track.capture.fps).round() as usize + 1;
    let (from, to) = (start + edge, end.checked_sub(edge)?);
    if to < from + LEAST - 1 {
        return None;
    }
    let middle = 0.5 * (from + to) as f64;
    // Least squares of y = a + b t + c t²; with t about the middle the odd sums vanish.
    let (mut s0, mut s2, mut s4, mut sy, mut sy2) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for frame in from..=to {
        let t = (frame as f64 - middle) / track.capture.fps;
        let y = track.capture.centre_of_mass(frame).y;
        let square = t * t;
        s0 += 1.0;
        s2 += square;
        s4 += square * square;
        sy += y;
        sy2 += y * square;
    }
    let determinant = s0 * s4 - s2 * s2;
    (determinant > 1e-15).then(|| -2.0 * (s0 * sy2 - s2 * sy) / determinant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::contacts::footfalls;
    use crate::audit::fixture::jump;
    use crate::model::Capture;

    fn found(capture: &Capture) -> (Vec<(usize, usize)>, Vec<Mark>) {
        let track = Track::new(capture);
        let feet = footfalls(&track);
        (flights(&track, &feet), marks(&track, &feet))
    }

    #[test]
    fn a_jump_that_falls_as_bodies_fall_is_a_flight_and_not_told() {
        for seconds in [0.3, 0.45, 0.6] {
            let (flights, marks) = found(&jump(seconds, 1.0));
            assert_eq!(flights.len(), 1, "{flights:?}");
            let (start, end) = flights[0];
            let length = (end - start + 1) as f64 / 120.0;
            assert!(start.abs_diff(120) <= 5 && (length - seconds).abs() < 0.06, "{flights:?}");
            assert!(marks.is_empty(), "{marks:?}");
        }
    }

    #[test]
    fn a_jump_at_six_tenths_and_one_at_twice_its_speed_are_told() {
        for (speed, seconds) in [(0.6, 0.4), (2.0, 0.6)] {
            let (_, marks) = found(&jump(seconds, speed));
            assert_eq!(marks.len(), 1, "{speed}: {marks:?}");
            let expected = GRAVITY * speed * speed;
            assert!((marks[0].measured - expected).abs() < 0.1 * expected, "{:?} {expected}", marks[0]);
            assert!(marks[0].start.abs_diff(120) <= 5, "{marks:?}");
        }
    }

    #[test]
    fn a_flight_of_too_few_frames_is_passed_over() {
        let capture = jump(0.12, 0.6);
        let mut coarse = capture.clone();
        coarse.fps = 30.0;
        let joints = capture.body.joints.len();
        let every = |frame: &usize| frame.is_multiple_of(4);
        coarse.positions = (0..capture.frames()).filter(every).flat_map(|frame| capture.at(frame).to_vec()).collect();
        coarse.turns = (0..capture.frames()).filter(every).flat_map(|frame| capture.turns_at(frame).to_vec()).collect();
        assert_eq!(coarse.positions.len() % joints, 0);
        assert!(found(&coarse).1.is_empty());
    }
}

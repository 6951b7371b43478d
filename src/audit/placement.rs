//! The pendulum's own rule: where a step had to land, from the state at touchdown, against where it landed.
//!
//! Clip space, SI. At touchdown the extrapolated centre of mass ξ = c + v/ω leads a walker's foot by an offset that is his own (Hof,
//! "The extrapolated center of mass concept suggests a simple control of balance in walking", 2008). Along the way the offset of a
//! steady walker is v T / (e^{ωT} - 1), which stands for the paper's step distance of one who does not stop; sideways it is a constant on
//! each foot's own side, less what a curve needs: a centripetal acceleration v·dψ/dt moves the support by its share of it over ω². What
//! is left is the walker's, and is taken from the clip: the median over its other steps, drawn to a population's where there are few.

use super::contacts::{Contact, Footfalls, Step};
use super::track::Track;
use super::{Mark, foot_name};
use crate::maths::pendulum;
use crate::maths::quat::wrap_angle;
use crate::maths::real;
use crate::model::Side;
use crate::model::findings::Rule;
use glam::DVec2;

/// m a (m/s · rad/s), at a leg of 0.83 m: how far a curve moves the support inwards.
const CURVE: f64 = 0.05;
/// m, forward and sideways: what is left of a step's offset in people, mean over captured walks, at a leg of 0.83 m.
const POPULATION: DVec2 = DVec2::new(0.025, 0.035);
/// Steps that the population counts as, forward and sideways: a clip's steps scatter by 0.025 and 0.02 m, clips by 0.054 and 0.028.
const PRIOR: DVec2 = DVec2::new(0.25, 0.5);
/// m: a foothold that is off by more is flagged, forward and sideways, at a leg of 0.83 m, where many steps tell the walker's own.
const PLACED: DVec2 = DVec2::new(0.11, 0.09);
/// m at a leg of 0.83 m: a clip whose steps scatter by more (a standard deviation, by their median error) dances or fights; there a step
/// must be off by so many of them.
const IRREGULAR: f64 = 0.08;
/// See [`IRREGULAR`].
const SCATTER: f64 = 4.0;
/// s at a leg of 0.83 m: a step comes no later after the other foot's; later ones end a stand, and no walker's offset tells of them.
const WALKING: f64 = 1.1;
/// s at a leg of 0.83 m: a foot that stays longer stands.
const STANDING: f64 = 1.8;
/// m/s: below that speed the way is where the pelvis looks.
const WALKS: f64 = 0.3;

/// A step with the state that it was taken in.
#[derive(Clone, Copy, Debug)]
pub struct Taken {
    /// Which.
    pub step: Step,
    /// s, of the touchdown.
    pub time: f64,
    /// m, (x, z): ξ at touchdown.
    pub xi: DVec2,
    /// m, (x, z): the centre of mass.
    pub com: DVec2,
    /// Unit, (x, z): along the way.
    pub ahead: DVec2,
    /// Unit, (x, z): outwards, to the foot's own side.
    pub out: DVec2,
    /// m/s, horizontal.
    pub speed: f64,
    /// 1/s.
    pub omega: f64,
    /// m, (along, out): the model's offset of the foothold from ξ, without the walker's own.
    pub model: DVec2,
    /// m, (along, out): what the foothold's offset leaves of it.
    pub rest: DVec2,
    /// m, the paper's step distance of a step that stops.
    pub stopping: f64,
}

/// A step judged.
#[derive(Clone, Copy, Debug)]
pub struct Judged {
    /// The step.
    pub taken: Taken,
    /// m, (x, z): where the foot had to be.
    pub predicted: DVec2,
    /// m, (along, out): the actual foothold less that.
    pub error: DVec2,
    /// m, (along, out): errors that are told, wider the fewer steps tell the walker's own.
    pub limit: DVec2,
}

impl Taken {
    /// m, (x, z), of (along, out).
    fn axes(&self, offset: DVec2) -> DVec2 {
        self.ahead * offset.x + self.out * offset.y
    }
}

/// Every step whose beginning and end the clip shows, with its state.
pub fn taken(track: &Track, feet: &Footfalls) -> Vec<Taken> {
    feet.steps.iter().filter_map(|step| state(track, feet, *step)).collect()
}

/// Judges them: each against the model and the median of the others.
pub fn judge(track: &Track, taken: &[Taken]) -> Vec<Judged> {
    judge_by(track, taken, POPULATION, PLACED)
}

/// The same steps seen without the velocity: footholds against the centre of mass itself. Not what the audit does: it shows how much of
/// what is found the pendulum finds.
pub fn without_velocity(taken: &Taken) -> Taken {
    let foothold = taken.xi - taken.com + taken.axes(taken.model + taken.rest);
    let rest = DVec2::new(foothold.dot(taken.ahead), foothold.dot(taken.out));
    Taken { xi: taken.com, model: DVec2::ZERO, rest, ..*taken }
}

/// Judges with a population's offset and limits (m, forward and sideways, at a leg of 0.83 m) of one's own.
pub fn judge_by(track: &Track, taken: &[Taken], population: DVec2, placed: DVec2) -> Vec<Judged> {
    let size = track.size();
    (0..taken.len())
        .map(|index| {
            let step = taken[index];
            let others = (0..taken.len()).filter(|other| *other != index);
            let count = others.clone().count() as f64;
            let own = |axis: usize| {
                let values: Vec<f64> = others.clone().map(|other| taken[other].rest[axis]).collect();
                (count * median(&values) + PRIOR[axis] * population[axis] * size) / (count + PRIOR[axis])
            };
            let own = DVec2::new(own(0), own(1));
            let offset = step.model + own;
            let predicted = step.xi + step.axes(offset);
            let scatter = |axis: usize| {
                let misses: Vec<f64> =
                    others.clone().map(|other| (taken[other].rest[axis] - own[axis]).abs()).collect();
                1.48 * median(&misses)
            };
            let limit = |axis: usize| {
                let told = placed[axis] * size * (1.0 + 1.0 / (count + PRIOR[axis])).sqrt();
                let scatter = scatter(axis);
                if scatter > IRREGULAR * size { told.max(SCATTER * scatter) } else { told }
            };
            Judged { taken: step, predicted, error: step.rest - own, limit: DVec2::new(limit(0), limit(1)) }
        })
        .collect()
}

/// Every mark of the rule.
pub fn marks(feet: &Footfalls, judged: &[Judged]) -> Vec<Mark> {
    judged.iter().filter_map(|judged| mark(&feet.contacts[judged.taken.step.to], judged)).collect()
}

fn mark(landing: &Contact, judged: &Judged) -> Option<Mark> {
    let (error, limit) = (judged.error, judged.limit);
    let worst = (error.x.abs() / limit.x).max(error.y.abs() / limit.y);
    let part = |value: f64, plus: &str, minus: &str| {
        format!("{:.0} cm too far {}", 100.0 * value.abs(), if value > 0.0 { plus } else { minus })
    };
    let mut words = Vec::new();
    if error.x.abs() > 0.5 * limit.x {
        words.push(part(error.x, "ahead", "behind"));
    }
    if error.y.abs() > 0.5 * limit.y {
        words.push(part(error.y, "out", "in"));
    }
    let offset = |place: DVec2| (place - judged.taken.com).length();
    let far = error.length();
    (worst > 1.0).then(|| Mark {
        start: landing.start,
        end: landing.end,
        rule: Rule::FootPlacement,
        side: Some(landing.side),
        measured: offset(landing.place),
        predicted: offset(judged.predicted),
        delta: far,
        limit: far / worst,
        why: format!("the {} foot comes down {}", foot_name(landing.side), words.join(" and ")),
    })
}

fn state(track: &Track, feet: &Footfalls, step: Step) -> Option<Taken> {
    let landing: &Contact = &feet.contacts[step.to];
    let stance = feet.contact_before(other(step.side), landing.start)?;
    let hz = track.capture.fps;
    if (landing.end - landing.start) as f64 / hz > STANDING * track.tempo() {
        return None;
    }
    let at = landing.touch_down;
    let (from, share) = (at.floor() as usize, at.fract());
    let to = (from + 1).min(track.len() - 1);
    let com = track.com[from].lerp(track.com[to], share);
    let velocity = track.velocity[from].lerp(track.velocity[to], share);
    let floor = landing.height;
    let omega = track.omega(from, floor);
    let (com, velocity) = (DVec2::new(com.x, com.z), DVec2::new(velocity.x, velocity.z));
    let speed = velocity.length();
    let ahead = if speed > WALKS * track.tempo() { velocity / speed } else { track.facing[from] };
    let left = DVec2::new(ahead.y, -ahead.x);
    let out = if step.side == Side::Left { left } else { -left };
    let xi = pendulum::extrapolated(com, velocity, omega);
    let interval = ((at - stance.touch_down) / hz).max(0.15);
    if interval > WALKING * track.tempo() {
        return None;
    }
    let steady = speed * interval / (real::exp(omega * interval) - 1.0);
    let inwards = turn_rate(track, from, hz) * speed * CURVE / track.tempo();
    let model = DVec2::new(-steady, -inwards * out.dot(left));
    let offset = landing.place - xi;
    let rest = DVec2::new(offset.dot(ahead), offset.dot(out)) - model;
    let height = track.com[from].y - floor;
    Some(Taken {
        step,
        time: at / hz,
        xi,
        com,
        ahead,
        out,
        speed,
        omega,
        model,
        rest,
        stopping: pendulum::step_distance(speed, 0.0, height.max(0.1), 0.0),
    })
}

/// rad/s, positive to the left: how fast the way turns, over a fifth of a second.
fn turn_rate(track: &Track, frame: usize, hz: f64) -> f64 {
    let half = (0.1 * hz).round().max(1.0) as usize;
    let (before, after) = (frame.saturating_sub(half), (frame + half).min(track.len() - 1));
    let heading = |frame: usize| {
        let velocity = track.velocity[frame];
        let slow = velocity.length() < WALKS * track.tempo();
        (!slow).then(|| real::atan2(velocity.x, velocity.z))
    };
    match (heading(before), heading(after)) {
        (Some(first), Some(last)) if after > before => {
            (wrap_angle(last - first) * hz / (after - before) as f64).clamp(-4.0, 4.0)
        }
        _ => 0.0,
    }
}

fn other(side: Side) -> Side {
    if side == Side::Left { Side::Right } else { Side::Left }
}

/// The middle one; 0 of none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => 0.0,
        count if count % 2 == 1 => sorted[count / 2],
        count => 0.5 * (sorted[count / 2 - 1] + sorted[count / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::contacts::footfalls;
    use crate::audit::fixture::{Gait, move_plant, walk};
    use crate::model::Capture;
    use glam::DVec3;

    fn judged(capture: &Capture) -> (Vec<Judged>, Vec<Mark>) {
        let track = Track::new(capture);
        let feet = footfalls(&track);
        let judged = judge(&track, &taken(&track, &feet));
        let marks = marks(&feet, &judged);
        (judged, marks)
    }

    #[test]
    fn a_pendulum_that_steps_where_it_must_leaves_no_error() {
        for (speed, step_secs) in [(0.6, 0.6), (1.0, 0.5), (1.4, 0.4)] {
            let (judged, marks) = judged(&walk(Gait { speed, step_secs, ..Gait::default() }));
            assert!(judged.len() >= 7, "{}", judged.len());
            assert!(judged.iter().all(|judged| judged.error.abs().max_element() < 0.02), "{judged:?}");
            assert!(marks.is_empty());
        }
    }

    #[test]
    fn a_moved_plant_is_told_with_its_foot_its_frames_and_its_way() {
        let gait = Gait::default();
        let clean = walk(gait);
        let step = 6; // of the clip's 12
        let side = gait.foothold(step).0;
        let start = ((step - 1) as f64 * gait.step_secs * gait.fps) as usize;
        let span = (start, start + (gait.step_secs * gait.fps) as usize);
        let out = DVec3::X * side.sign();
        for (shift, word, sign) in [
            (DVec3::Z, "ahead", DVec2::X),
            (-DVec3::Z, "behind", -DVec2::X),
            (out, "out", DVec2::Y),
            (-out, "in", -DVec2::Y),
        ] {
            let mut planted = clean.clone();
            move_plant(&mut planted, side, span, 20, shift * 0.2);
            let (judged, marks) = judged(&planted);
            let mark = marks.iter().find(|mark| mark.start <= span.1 && mark.end >= span.0 && mark.side == Some(side));
            let mark = mark.unwrap_or_else(|| panic!("20 cm {word}: {marks:?}"));
            assert!(mark.why.contains(&format!("too far {word}")), "{}", mark.why);
            assert!(mark.start.abs_diff(span.0) <= 6 && mark.end.abs_diff(span.1) <= 6, "{mark:?} {span:?}");
            assert!((0.12..0.28).contains(&mark.delta), "{mark:?}");
            let error = judged.iter().map(|judged| judged.error.dot(sign)).fold(f64::MIN, f64::max);
            assert!((error - 0.2).abs() < 0.05, "{word}: {error}");
        }
    }

    #[test]
    fn without_the_velocity_a_step_of_another_speed_is_off_and_with_it_it_is_not() {
        // Two halves of unlike speed: each foothold is right for its own.
        let track_of = |speed: f64| walk(Gait { speed, step_secs: 0.5, ..Gait::default() });
        let rests = |capture: &Capture, bare: bool| -> f64 {
            let track = Track::new(capture);
            let steps = taken(&track, &footfalls(&track));
            let rests: Vec<f64> =
                steps.iter().map(|step| if bare { without_velocity(step).rest.x } else { step.rest.x }).collect();
            median(&rests)
        };
        let (slow, fast) = (track_of(0.5), track_of(1.3));
        let with = (rests(&slow, false) - rests(&fast, false)).abs();
        let without = (rests(&slow, true) - rests(&fast, true)).abs();
        assert!(with < 0.03, "{with}");
        assert!(without > 0.12, "{without}");
    }

    #[test]
    fn the_judge_without_velocity_predicts_from_the_centre_of_mass() {
        let capture = walk(Gait::default());
        let track = Track::new(&capture);
        let feet = footfalls(&track);
        let step = taken(&track, &feet)[3];
        let bare = without_velocity(&step);
        let place = feet.contacts[step.step.to].place;
        let foothold = bare.com + bare.ahead * bare.rest.x + bare.out * bare.rest.y;
        assert_eq!(bare.xi, step.com);
        assert!(foothold.distance(place) < 1e-9, "{foothold} {place}");
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(&[]), 0.0);
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
    }
}

//! When and where each foot bears: the floor, the contacts on it, the steps between them.
//!
//! Clip space, m, s. A foot bears while some point of its sole hardly moves and is about as low as ground can be there: a foot that
//! rolls from heel to toe has such a point all the way, a swinging one has none. The floor is the mode of the heights at which slow feet are
//! (a low percentile would follow a sunken foot). Stairs and rough ground have a floor a contact.

use super::track::{FootTrack, Track};
use crate::measure::GRAVITY;
use crate::model::Side;
use glam::{DMat3, DVec2, DVec3};

/// m/s at a leg of 0.83 m: a sole's stillest point slower than this is on the ground; faster than the second, it has left.
const SPEED: (f64, f64) = (0.45, 0.9);
/// m/s and s: a toe that pushes off is still loaded up to that speed, for no longer. Told as the lift-off; the rules keep to [`SPEED`].
const PUSHES_OFF: (f64, f64) = (1.3, 0.06);
/// m/s: feet slower than this tell where the floor is.
const SLOW: f64 = 0.25;
/// m: a still foot may be that far over the floor and bear: lifted clips, steps of a stair.
const REACH: f64 = 0.14;
/// s: a contact is no shorter, a gap in one no longer.
const SHORTEST: f64 = 0.07;
/// s.
const GAP: f64 = 0.05;
/// m: a foot that rises no more within a gap, and gets no farther while the other swings, or while it does not, was no swing.
const LIFT: f64 = 0.03;
/// m.
const SLID: f64 = 0.3;
/// s.
const LONGEST_GAP: f64 = 0.4;
/// m and s: nor was one that rises with the whole body and comes down where it was, or is still there.
const LIFTED: f64 = 0.075;
/// m.
const STAYED: f64 = 0.1;
/// s.
const SHORT_GAP: f64 = 0.2;
/// s: a foot that is still higher than [`REACH`] must be so for that long: at the top of a jump feet are still for 0.1 s.
const HIGH: f64 = 0.16;
/// m, and of gravity: feet that are over the floor by more while the body falls faster, on an average, are at the top of a flight.
const FLIES: (f64, f64) = (0.03, 0.25);
/// m: heights of contacts that differ by more stand on different floors.
const SAME_FLOOR: f64 = 0.035;
/// m: soles are guessed to that; a foot whose floor is farther from the other's stood on something for a while.
const SAME_FEET: f64 = 0.03;

/// The ground as the feet show it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// m: where the floor is for each foot (the sole of a mesh-less foot is a guess, so each has its own), at x = z = 0.
    pub floor: [f64; 2],
    /// How it rises along x and z: captured floors are off level by a per cent or two.
    pub slope: DVec2,
    /// The contacts stand at heights of their own: stairs, rocks.
    pub uneven: bool,
}

/// A foot on the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// Which foot.
    pub side: Side,
    /// First frame.
    pub start: usize,
    /// Last frame, inclusive.
    pub end: usize,
    /// Frames and a fraction: when it came down.
    pub touch_down: f64,
    /// Frames and a fraction: when its toe left, some hundredths of a second after `end`, which is the last frame it surely stands.
    pub lift_off: f64,
    /// m: the median height of its lowest point.
    pub height: f64,
    /// m, (x, z): where the foot stands: its place while it is flattest.
    pub place: DVec2,
    /// The clip begins or ends within it.
    pub cut: (bool, bool),
}

/// A swing between two contacts of a foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Which foot.
    pub side: Side,
    /// Index of the contact that it leaves.
    pub from: usize,
    /// Index of the contact that it makes.
    pub to: usize,
}

/// What the feet do.
#[derive(Clone, Debug)]
pub struct Footfalls {
    /// The ground.
    pub ground: Ground,
    /// By start, left before right.
    pub contacts: Vec<Contact>,
    /// By touchdown.
    pub steps: Vec<Step>,
    /// (frames) index of the contact of each foot.
    pub of: [Vec<Option<usize>>; 2],
}

/// Finds it all.
pub fn footfalls(track: &Track) -> Footfalls {
    footfalls_on(track, None)
}

/// Finds it all on a floor that a person names, m, instead of the one that the feet show.
pub fn footfalls_on(track: &Track, told: Option<f64>) -> Footfalls {
    let mut floor = told.map_or_else(|| floors(track), |told| [told; 2]);
    let mut contacts: Vec<Contact> =
        Side::BOTH.into_iter().flat_map(|side| contacts_of(track, side, floor[side as usize])).collect();
    contacts.sort_by_key(|contact| (contact.start, contact.side as usize));
    for index in 0..contacts.len() {
        let own = |other: &&Contact| other.side == contacts[index].side && other.start > contacts[index].end;
        let next = contacts.iter().find(own).map_or(track.len(), |next| next.start);
        contacts[index].lift_off = lift_off(track, &contacts[index], next);
    }
    let (slope, rise) = if told.is_some() { (DVec2::ZERO, 0.0) } else { tilt(&contacts, &floor, track.size()) };
    floor = floor.map(|floor| floor + rise);
    let mut ground = Ground { floor, slope, uneven: false };
    ground.uneven = uneven(&contacts, &ground, track.size());
    let mut of = [vec![None; track.len()], vec![None; track.len()]];
    for (index, contact) in contacts.iter().enumerate() {
        of[contact.side as usize][contact.start..=contact.end].fill(Some(index));
    }
    let mut steps: Vec<Step> = Vec::new();
    for side in Side::BOTH {
        let own: Vec<usize> = (0..contacts.len()).filter(|index| contacts[*index].side == side).collect();
        steps.extend(own.windows(2).map(|pair| Step { side, from: pair[0], to: pair[1] }));
    }
    steps.sort_by_key(|step| (contacts[step.to].start, step.side as usize));
    Footfalls { ground, contacts, steps, of }
}

impl Contact {
    /// The last frame that is told of it.
    pub fn last(&self) -> usize {
        self.lift_off.floor().max(self.end as f64) as usize
    }
}

impl Ground {
    /// m: the floor for a foot at a place.
    pub fn under(&self, side: Side, at: DVec2) -> f64 {
        self.floor[side as usize] + self.slope.dot(at)
    }
}

impl Footfalls {
    /// m: the ground under a foot that is at a place in a frame: its contact's own on uneven ground.
    pub fn under(&self, side: Side, frame: usize, at: DVec2) -> f64 {
        match self.of[side as usize][frame] {
            Some(index) if self.ground.uneven => self.contacts[index].height,
            _ => self.ground.under(side, at),
        }
    }

    /// m: the floor in a frame: the lower of the feet that bear, else of all.
    pub fn floor_at(&self, frame: usize, at: DVec2) -> f64 {
        let bearing = Side::BOTH.into_iter().filter(|side| self.of[*side as usize][frame].is_some());
        let lowest = bearing.map(|side| self.under(side, frame, at)).fold(f64::MAX, f64::min);
        if lowest < f64::MAX {
            lowest
        } else {
            self.ground.under(Side::Left, at).min(self.ground.under(Side::Right, at))
        }
    }

    /// How many feet bear.
    pub fn bearing(&self, frame: usize) -> usize {
        self.of.iter().filter(|of| of[frame].is_some()).count()
    }

    /// The last contact of a foot that began before a frame.
    pub fn contact_before(&self, side: Side, frame: usize) -> Option<&Contact> {
        self.contacts.iter().rev().find(|contact| contact.side == side && contact.start < frame)
    }
}

/// m: the mode of the heights of each slow foot; of both together where one tells too little or stands apart.
fn floors(track: &Track) -> [f64; 2] {
    let slow = SLOW * track.tempo();
    let of = |foot: &FootTrack| -> Vec<f64> {
        foot.low.iter().zip(&foot.still).filter(|(_, still)| **still < slow).map(|(low, _)| *low).collect()
    };
    let each = track.feet.each_ref().map(of);
    let mut both = [each[0].as_slice(), each[1].as_slice()].concat();
    if both.is_empty() {
        both = track.feet.iter().flat_map(|foot| foot.low.iter().copied()).collect();
    }
    let common = mode(&both, 0.01 * track.size());
    each.map(|heights| {
        let own = if heights.len() * 8 >= both.len() { mode(&heights, 0.01 * track.size()) } else { common };
        if (own - common).abs() < SAME_FEET * track.size() { own } else { common }
    })
}

/// The value around which most lie, by a triangular kernel of that half width.
fn mode(values: &[f64], width: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    // Ten thousand values say where the mode is as well as a million.
    let step = sorted.len().div_ceil(4000).max(1);
    let sorted: Vec<f64> = sorted.into_iter().step_by(step).collect();
    let (mut best, mut most) = (sorted.first().copied().unwrap_or(0.0), f64::MIN);
    let mut from = 0;
    for value in &sorted {
        while sorted[from] < value - width {
            from += 1;
        }
        let mut weight = 0.0;
        let mut mean = 0.0;
        for other in sorted[from..].iter().take_while(|other| **other <= value + width) {
            let share = 1.0 - (other - value).abs() / width;
            weight += share;
            mean += share * other;
        }
        if weight > most + 1e-9 {
            (best, most) = (mean / weight.max(1e-12), weight);
        }
    }
    best
}

fn contacts_of(track: &Track, side: Side, floor: f64) -> Vec<Contact> {
    let foot = &track.feet[side as usize];
    let frames = foot.low.len();
    let (on, off) = (SPEED.0 * track.tempo(), SPEED.1 * track.tempo());
    let reach = REACH * track.size();
    let other = &track.feet[1 - side as usize];
    let near = |frame: usize| {
        let height = foot.low[frame] - floor;
        height < reach || foot.low[frame] < other.low[frame] + 0.02
    };
    let mut spans: Vec<(usize, usize)> = Vec::new();
    let mut open: Option<usize> = None;
    for frame in 0..frames {
        let bears = near(frame) && foot.still[frame] < if open.is_some() { off } else { on };
        match (open, bears) {
            (None, true) => open = Some(frame),
            (Some(start), false) => {
                spans.push((start, frame - 1));
                open = None;
            }
            _ => {}
        }
    }
    spans.extend(open.map(|start| (start, frames - 1)));
    let high = (HIGH * track.capture.fps * track.tempo()).ceil() as usize;
    spans.retain(|(start, end)| {
        let lowest = foot.low[*start..=*end].iter().copied().fold(f64::MAX, f64::min);
        let over = lowest - floor;
        let fall: f64 = track.acceleration[*start..=*end].iter().map(|acceleration| -acceleration.y).sum();
        let flies = over > FLIES.0 * track.size() && fall > FLIES.1 * GRAVITY * (end - start + 1) as f64;
        !flies && (over < reach || end - start + 1 >= high)
    });
    let least = |seconds: f64| (seconds * track.capture.fps * track.tempo()).round() as usize;
    let mut merged: Vec<(usize, usize)> = Vec::new();
    for span in spans {
        match merged.last_mut() {
            Some(last) if span.0 - last.1 <= least(GAP) + 1 || is_no_swing(track, side, *last, span) => last.1 = span.1,
            _ => merged.push(span),
        }
    }
    merged.retain(|(start, end)| end - start + 1 >= least(SHORTEST).max(2) || *start == 0 || *end + 1 == frames);
    merged.into_iter().map(|(start, end)| contact(track, side, start, end, on)).collect()
}

/// Whether a foot bears all through the gap between two spans in which it is still: it is lifted with the whole body, or slides. It
/// stays low, gets nowhere near a step's length, and the other foot is on its way meanwhile, or the gap is too short for a swing.
fn is_no_swing(track: &Track, side: Side, before: (usize, usize), after: (usize, usize)) -> bool {
    let foot = &track.feet[side as usize];
    let other = &track.feet[1 - side as usize];
    let (from, to) = (before.1, after.0);
    let seconds = (to - from) as f64 / track.capture.fps / track.tempo();
    let travel = foot.place(from).distance(foot.place(to)) / track.size();
    let level = foot.low[from].min(foot.low[to]);
    let rise = foot.low[from..=to].iter().map(|low| low - level).fold(0.0, f64::max) / track.size();
    let swings = (from..=to).any(|frame| other.still[frame] > 1.2 * track.tempo());
    let slides = swings && rise < LIFT && seconds < LONGEST_GAP && travel < SLID;
    slides || (rise < LIFTED && seconds < SHORT_GAP && travel < STAYED)
}

fn contact(track: &Track, side: Side, start: usize, end: usize, on: f64) -> Contact {
    let foot = &track.feet[side as usize];
    let mut lows: Vec<f64> = foot.low[start..=end].to_vec();
    lows.sort_by(f64::total_cmp);
    let touch_down = match start.checked_sub(1) {
        Some(before) if foot.still[before] > on => {
            let (from, to) = (foot.still[before], foot.still[start]);
            before as f64 + ((from - on) / (from - to).max(1e-9)).clamp(0.0, 1.0)
        }
        _ => start as f64,
    };
    let tilt = |frame: usize| {
        let [heel, ball, _] = foot.points[frame];
        (heel.y - ball.y).abs()
    };
    let mut flattest: Vec<usize> = (start..=end).collect();
    flattest.sort_by(|a, b| tilt(*a).total_cmp(&tilt(*b)).then(a.cmp(b)));
    flattest.truncate((flattest.len() / 2).max(1));
    let median = |pick: &dyn Fn(DVec2) -> f64| {
        let mut values: Vec<f64> = flattest.iter().map(|frame| pick(foot.place(*frame))).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let place = DVec2::new(median(&|place| place.x), median(&|place| place.y));
    let last = track.len() - 1;
    let (height, cut) = (lows[lows.len() / 2], (start == 0, end == last));
    Contact { side, start, end, touch_down, lift_off: end as f64, height, place, cut }
}

/// Frames and a fraction: when the stillest point of a foot that has left is too fast to push any more, before frame `next`.
fn lift_off(track: &Track, contact: &Contact, next: usize) -> f64 {
    let foot = &track.feet[contact.side as usize];
    let tempo = track.tempo();
    let (fast, longest) = (PUSHES_OFF.0 * tempo, PUSHES_OFF.1 * tempo * track.capture.fps);
    let limit = (contact.end as f64 + longest).min(next.saturating_sub(1).max(contact.end) as f64);
    let after = (contact.end + 1..track.len()).find(|frame| foot.still[*frame] >= fast);
    let crossed = after.map_or(f64::MAX, |after| {
        let (from, to) = (foot.still[after - 1], foot.still[after]);
        (after - 1) as f64 + ((fast - from) / (to - from).max(1e-9)).clamp(0.0, 1.0)
    });
    crossed.clamp(contact.end as f64, limit)
}

/// The slope of the plane through the contacts, and its height at the origin over the level floor: least absolute errors, so that a span
/// that was lifted does not tilt it, drawn to level by a prior of 0.7 per cent.
fn tilt(contacts: &[Contact], floor: &[f64; 2], size: f64) -> (DVec2, f64) {
    const ERROR: f64 = 0.01;
    const PRIOR: f64 = 0.007;
    let points: Vec<(DVec2, f64)> =
        contacts.iter().map(|contact| (contact.place, contact.height - floor[contact.side as usize])).collect();
    if points.len() < 4 {
        return (DVec2::ZERO, 0.0);
    }
    let middle = points.iter().map(|point| point.0).sum::<DVec2>() / points.len() as f64;
    let mut plane = DVec3::ZERO; // slope along x, along z, height at the middle
    let miss = |plane: DVec3, point: &(DVec2, f64)| {
        let at = point.0 - middle;
        point.1 - plane.dot(DVec3::new(at.x, at.y, 1.0))
    };
    for _ in 0..40 {
        let (mut matrix, mut right) = (DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1e-6) / (PRIOR * PRIOR)), DVec3::ZERO);
        for point in &points {
            let at = point.0 - middle;
            let row = DVec3::new(at.x, at.y, 1.0);
            let weight = 0.5 / (ERROR * size * miss(plane, point).abs().max(0.003 * size));
            matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * weight;
            right += row * (weight * point.1);
        }
        plane = matrix.inverse() * right;
    }
    let slope = DVec2::new(plane.x, plane.y);
    if !plane.is_finite() || slope.length() > 0.04 {
        return (DVec2::ZERO, 0.0);
    }
    (slope, plane.z - slope.dot(middle))
}

/// Whether a third of the contacts stand off the floor by more than a sole's error.
fn uneven(contacts: &[Contact], ground: &Ground, size: f64) -> bool {
    let off =
        |contact: &&Contact| (contact.height - ground.under(contact.side, contact.place)).abs() > SAME_FLOOR * size;
    contacts.len() >= 4 && contacts.iter().filter(off).count() * 3 > contacts.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::fixture::{Gait, shift_all, shift_foot, stand, walk};

    /// Frames: (side, first, last) of every whole stance of a gait.
    fn stances(gait: &Gait) -> Vec<(Side, usize, usize)> {
        let steps = (gait.seconds / gait.step_secs) as usize;
        let frame = |step: usize| (step as f64 * gait.step_secs * gait.fps).round() as usize;
        (1..steps - 1).map(|step| (gait.foothold(step + 1).0, frame(step), frame(step + 1))).collect()
    }

    #[test]
    fn every_stance_of_a_walk_is_one_contact_to_some_frames_and_to_the_centimetre() {
        for fps in [30.0, 60.0, 120.0] {
            let gait = Gait { fps, ..Gait::default() };
            let capture = walk(gait);
            let feet = footfalls(&Track::new(&capture));
            let near = (0.07 * fps) as usize + 1;
            for (step, (side, start, end)) in stances(&gait).into_iter().enumerate() {
                let found: Vec<&Contact> = feet
                    .contacts
                    .iter()
                    .filter(|contact| contact.side == side && contact.start < end && contact.end > start)
                    .collect();
                assert_eq!(found.len(), 1, "{fps} fps, step {step}: {found:?}");
                assert!(found[0].start.abs_diff(start) <= near && found[0].end.abs_diff(end) <= near, "{found:?}");
                let place = gait.foothold(step + 2).1;
                assert!(found[0].place.distance(DVec2::new(place.x, place.z)) < 0.01, "{found:?} {place}");
            }
            assert!(!feet.ground.uneven);
        }
    }

    #[test]
    fn a_lift_off_follows_the_last_frame_that_stands_within_hundredths_of_a_second() {
        for fps in [30.0, 120.0] {
            let capture = walk(Gait { fps, ..Gait::default() });
            let feet = footfalls(&Track::new(&capture));
            let mut later = 0;
            for (index, contact) in feet.contacts.iter().enumerate() {
                let waits = (contact.lift_off - contact.end as f64) / fps;
                assert!(
                    (0.0..=PUSHES_OFF.1 + 1e-9).contains(&waits) && contact.last() < capture.frames(),
                    "{contact:?}"
                );
                later += usize::from(waits > 0.0);
                let next = feet.contacts[index + 1..].iter().find(|next| next.side == contact.side);
                assert!(next.is_none_or(|next| contact.last() < next.start), "{contact:?}");
                assert!(!contact.cut.1 || waits == 0.0, "{contact:?}");
            }
            assert!(later > 5, "{fps} fps: {later} of {}", feet.contacts.len());
        }
    }

    #[test]
    fn a_floor_that_is_not_at_zero_and_tilts_is_found() {
        let slope = DVec2::new(0.0, 0.015);
        let gait = Gait { floor: 0.8, slope, ..Gait::default() };
        let capture = walk(gait);
        let ground = footfalls(&Track::new(&capture)).ground;
        assert!((ground.slope - slope).length() < 0.006, "{ground:?}");
        for z in [0.0, 3.0, 6.0] {
            let under = ground.under(Side::Left, DVec2::new(0.0, z));
            assert!((under - 0.8 - 0.015 * z).abs() < 0.015, "{under} at {z}");
        }
        assert!(!ground.uneven);
    }

    #[test]
    fn stairs_have_a_floor_a_contact() {
        let gait = Gait { rise: 0.15, ..Gait::default() };
        let capture = walk(gait);
        let feet = footfalls(&Track::new(&capture));
        assert!(feet.ground.uneven);
        let heights: Vec<f64> = feet.contacts.iter().map(|contact| contact.height).collect();
        assert!(heights.len() >= 9, "{heights:?}");
        for (from, to) in feet.contacts.iter().zip(&feet.contacts[1..]) {
            assert!((to.height - from.height - 0.15).abs() < 0.02, "{heights:?}");
        }
    }

    #[test]
    fn a_sunk_span_does_not_take_the_floor_along() {
        let mut capture = walk(Gait::default());
        for frame in 100..190 {
            shift_all(&mut capture, frame, DVec3::Y * -0.06);
        }
        let ground = footfalls(&Track::new(&capture)).ground;
        assert!(ground.floor.iter().all(|floor| floor.abs() < 0.01), "{ground:?}");
    }

    #[test]
    fn feet_that_stand_are_one_contact_each_and_take_no_step() {
        let capture = stand(3.0);
        let feet = footfalls(&Track::new(&capture));
        assert_eq!(feet.contacts.len(), 2);
        assert!(feet.contacts.iter().all(|contact| contact.cut == (true, true)));
        assert!(feet.steps.is_empty() && (0..capture.frames()).all(|frame| feet.bearing(frame) == 2));
    }

    #[test]
    fn markers_that_shake_by_two_millimetres_break_no_contact() {
        let gait = Gait::default();
        let steady = walk(gait);
        let mut shaken = steady.clone();
        let mut seed = crate::maths::seed::Seed::new(5);
        for frame in 0..shaken.frames() {
            for side in Side::BOTH {
                let noise = DVec3::new(seed.between(-1.0, 1.0), seed.between(-1.0, 1.0), seed.between(-1.0, 1.0));
                shift_foot(&mut shaken, frame, side, noise * 0.002);
            }
        }
        let count = |capture: &crate::model::Capture| footfalls(&Track::new(capture)).contacts.len();
        assert_eq!(count(&shaken), count(&steady));
    }
}

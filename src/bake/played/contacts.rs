//! What of a run stands: while a foot is pressed to the ground and a point of it does not move, that point is one contact.
//!
//! The ground's frame, m, rad. A foot that lies flat holds ankle and toes, one that is raised holds the ball or the heel that it
//! turns about. One that goes on creeping is cut where it has gone too far from where it was held; one that slides holds nothing.

use super::Run;
use super::hold::{Held, Hold, point_of};
use super::leg::Foot;
use crate::maths::real;
use crate::measure::{GRAVITY, Scuff};
use crate::model::{BodyPose, Plant, Side, report::Part};
use crate::sim::PRESSED;
use glam::{DQuat, DVec2, DVec3};

/// m/s at legs of 0.83 m: a point that is faster slides.
const SLIDES: f64 = 0.06;
/// m at legs of 0.83 m and rad: as far may a held point or foot be from the run's.
const PLACE: f64 = 3.5e-3;
/// As [`PLACE`] says.
const TURN: f64 = 1.5 * std::f64::consts::PI / 180.0;
/// rad: on rolling ground, and on an edge of a sole, a foot that stands still may lean so far against the ground.
const LEANS: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// rad: a sole that leans by less is not raised.
const RAISED: f64 = 0.9 * std::f64::consts::PI / 180.0;
/// rad: a foot whose heel has risen over its toes by more stands on its ball. A millimetre at the ankle, of which the knee of a leg that is almost straight
/// makes a few: held flat for longer, the leg would be too far from the run's.
const BENT: f64 = 0.4 * std::f64::consts::PI / 180.0;
/// Ticks: a shorter contact is none; nor is a shorter one that follows on another of its foot, as a heel rises before the foot leaves.
const LEAST: usize = 5;
const LEAST_ON: usize = 3;
/// Ticks between contacts of a foot that creeps: room to go over from one to the next.
const BETWEEN: usize = 6;
/// Ticks in which a foot may not be pressed and stand all the same.
const HOPS: usize = 2;

/// A contact in the making: which part, from which tick to which.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    part: Part,
    from: usize,
    to: usize,
}

/// A foot at every tick of the stand, in the ground's frame.
pub(super) struct Track<'a> {
    run: &'a Run<'a>,
    side: Side,
    feet: Vec<Foot>,
    points: [Vec<DVec3>; 2], // heel, ball
    pressed: Vec<bool>,
    size: f64, // legs over 0.83 m, 1 at most: large rigs are held as near as others
}

impl<'a> Track<'a> {
    pub(super) fn new(run: &'a Run<'a>, poses: &[BodyPose], side: Side) -> Track<'a> {
        let Run { body, terrain, dt, .. } = *run;
        let feet: Vec<Foot> = poses
            .iter()
            .enumerate()
            .map(|(index, pose)| {
                Foot::of(body, pose, &pose.positions(body), side).seen_from(terrain.turn(index as f64 * dt))
            })
            .collect();
        let points = [Part::Heel, Part::Ball].map(|part| {
            let offset = point_of(body, side, part);
            feet.iter().map(|foot| foot.ankle + foot.foot * offset).collect()
        });
        let least = PRESSED * body.mass * GRAVITY * dt;
        let stood = |index: usize| {
            let time = index as f64 * dt;
            run.stood[side as usize].iter().any(|[from, to]| *from - 1e-9 <= time && time <= *to + 1e-9)
        };
        let by =
            |index: usize| stood(index) && run.pressed.get(index).is_some_and(|pressed| pressed[side as usize] > least);
        // It stands from the start: the ground has not pressed yet.
        let first = (0..feet.len()).find(|index| by(*index)).unwrap_or(0);
        let mut pressed: Vec<bool> = (0..feet.len()).map(|index| index < first || by(index)).collect();
        for index in 1..pressed.len() {
            let next = (index..(index + HOPS + 1).min(pressed.len())).find(|later| pressed[*later]);
            pressed[index] |= pressed[index - 1] && next.is_some();
        }
        Track { run, side, feet, points, pressed, size: (body.leg_length / 0.83).min(1.0) }
    }

    /// The contacts as the run has them.
    pub(super) fn spans(&self) -> Vec<Span> {
        let count = self.feet.len();
        let mut flat = self.gathered(&|index| self.lies(index).then_some(Part::Flat));
        for index in 0..flat.len() {
            let before = index.checked_sub(1).map(|before| flat[before].to);
            let after = flat.get(index + 1).map(|after| after.from);
            flat[index] = self.settled(&flat[index], before, after);
        }
        flat.retain(|span| span.to + 1 >= span.from + LEAST);
        let taken = |index: usize| flat.iter().any(|span| span.from <= index && index <= span.to);
        let mut rolls = self.gathered(&|index| if taken(index) { None } else { self.rolls(index) });
        for roll in &mut rolls {
            // Parts that follow on one another meet, at one end; else there is room to go over from one to the next.
            let before = flat.iter().rev().find(|span| span.to < roll.from).map(|span| span.to);
            let after = flat.iter().find(|span| span.from > roll.to).map(|span| span.from);
            if let Some(before) = before {
                roll.from = if roll.from == before + 1 { before } else { roll.from.max(before + BETWEEN) };
            }
            if let Some(after) = after {
                let meets = before.is_some_and(|before| before == roll.from);
                roll.to =
                    if roll.to + 1 == after && !meets { after } else { roll.to.min(after.saturating_sub(BETWEEN)) };
            }
        }
        let least = |span: &Span| if flat.iter().any(|flat| flat.to == span.from) { LEAST_ON } else { LEAST };
        rolls.retain(|span| span.to < count && span.to + 1 >= span.from + least(span));
        flat.extend(rolls);
        flat.sort_by_key(|span| span.from);
        flat
    }

    /// Spans in which a part holds, as `part` says, cut where what it holds has gone too far.
    fn gathered(&self, part: &dyn Fn(usize) -> Option<Part>) -> Vec<Span> {
        let parts: Vec<Option<Part>> = (0..self.feet.len()).map(part).collect();
        let mut spans = Vec::new();
        let mut from = 0;
        while from < parts.len() {
            let to = (from..parts.len()).take_while(|index| parts[*index] == parts[from]).last().unwrap_or(from);
            if let Some(part) = parts[from] {
                self.pieces(Span { part, from, to }, &mut spans);
            }
            from = to + 1;
        }
        spans
    }

    /// The same from touchdown to lift-off, as far as the foot is no farther than it may be from where it stands.
    fn settled(&self, span: &Span, before: Option<usize>, after: Option<usize>) -> Span {
        let mut wide = *span;
        let centre = self.median(span);
        let fits = |index: usize| self.is_near(&centre, index, span.part);
        while wide.from < wide.to && !fits(wide.from) {
            wide.from += 1;
        }
        while wide.to > wide.from && !fits(wide.to) {
            wide.to -= 1;
        }
        let last = self.feet.len() - 1;
        let (least, most) =
            (before.map_or(0, |before| before + BETWEEN), after.map_or(last, |after| after.saturating_sub(BETWEEN)));
        while wide.to < most && self.pressed[wide.to + 1] && fits(wide.to + 1) {
            wide.to += 1;
        }
        // So does one that comes down; what pressed by a tick pressed in the time before it.
        while wide.from > least && self.pressed[wide.from] && fits(wide.from - 1) {
            wide.from -= 1;
        }
        wide
    }

    /// Whether what a part holds is no farther than it may be from there at a tick.
    fn is_near(&self, centre: &[DVec3; 4], index: usize, part: Part) -> bool {
        let marks = self.marks(index, part);
        let off = |place: usize| marks[place].distance(centre[place]);
        let bent = part == Part::Flat && self.risen(index) >= BENT;
        off(0).max(off(1)) <= PLACE * self.size && off(2).max(off(3)) <= TURN && !bent
    }

    /// Whether the foot stands on all of its sole at a tick.
    fn lies(&self, index: usize) -> bool {
        let ankle = |index: usize| self.feet[index].ankle;
        let ball = |index: usize| self.points[1][index];
        let still = self.slow(index, &ankle) && self.slow(index, &ball);
        let flat = self.leans(index) < LEANS && self.risen(index) < BENT;
        self.pressed[index] && flat && still && self.near(index, Part::Flat)
    }

    /// What it turns about at a tick: raised, or flat and turned over the ground.
    fn rolls(&self, index: usize) -> Option<Part> {
        let about = |part: Part| {
            let point = |index: usize| self.points[usize::from(part == Part::Ball)][index];
            self.near(index, part) && self.slow(index, &point)
        };
        if !self.pressed[index] {
            return None;
        }
        let toe_down = self.ahead(index).dot(self.ground(index).1) < 0.0;
        let raised = self.leans(index) > RAISED;
        let [first, second] = if toe_down { [Part::Ball, Part::Heel] } else { [Part::Heel, Part::Ball] };
        if about(first) { Some(first) } else { (!raised && about(second)).then_some(second) }
    }

    /// Whether a point hardly moves just before a tick or just after it.
    fn slow(&self, index: usize, point: &dyn Fn(usize) -> DVec3) -> bool {
        let last = self.feet.len() - 1;
        let (before, after) = (index.saturating_sub(2), (index + 2).min(last));
        let within = |a: usize, b: usize| {
            a < b && point(a).distance(point(b)) < SLIDES * self.size.sqrt() * (b - a) as f64 * self.run.dt
        };
        within(before, index) || within(index, after)
    }

    /// Whether what a part holds is as high over the ground as where it stands.
    fn near(&self, index: usize, part: Part) -> bool {
        let shape = &self.run.body.feet[self.side as usize];
        let (at, normal) = self.ground(index);
        let over = |point: DVec3| (point - at).dot(normal);
        let flat = |part: Part| (shape.level * point_of(self.run.body, self.side, part)).y + shape.ankle_height;
        let rolling = LEANS * (shape.tip - shape.heel) * 0.25;
        match part {
            Part::Flat => (over(self.feet[index].ankle) - shape.ankle_height).abs() < PLACE * self.size + rolling,
            Part::Ball => (over(self.points[1][index]) - flat(part)).abs() < PLACE * self.size,
            Part::Heel => (over(self.points[0][index]) - flat(part)).abs() < PLACE * self.size,
        }
    }

    /// m and a unit vector: a point of the ground under the ankle, and its normal.
    fn ground(&self, index: usize) -> (DVec3, DVec3) {
        let at = self.feet[index].ankle;
        let spot = self.run.terrain.spot(DVec2::new(at.x, at.z));
        (DVec3::new(at.x, spot.height, at.z), spot.normal)
    }

    /// Unit: where the foot points, along its sole.
    fn ahead(&self, index: usize) -> DVec3 {
        let shape = &self.run.body.feet[self.side as usize];
        self.feet[index].foot * shape.level.inverse() * DVec3::new(shape.forward.x, 0.0, shape.forward.y)
    }

    /// Unit: square to its sole.
    fn up(&self, index: usize) -> DVec3 {
        self.feet[index].foot * self.run.body.feet[self.side as usize].level.inverse() * DVec3::Y
    }

    /// rad, by how much its heel has risen over its toes: who is so stands on his ball, however still he stands. Toes of a foot that lies flat
    /// may be bent too, as it lands.
    fn risen(&self, index: usize) -> f64 {
        let (foot, shape) = (&self.feet[index], &self.run.body.feet[self.side as usize]);
        let along = foot.foot * shape.level.inverse() * shape.toe_level;
        along.angle_between(foot.toe).min(self.leans(index))
    }

    /// rad, against the ground.
    fn leans(&self, index: usize) -> f64 {
        self.up(index).angle_between(self.ground(index).1)
    }

    /// Cuts a span where what it holds has gone too far.
    fn pieces(&self, whole: Span, spans: &mut Vec<Span>) {
        let least = if whole.part == Part::Flat { LEAST } else { LEAST_ON };
        let mut from = whole.from;
        while from + least <= whole.to + 1 {
            let mut extent = Extent::default();
            let fits = |index: &usize| {
                self.take(&mut extent, *index, whole.part);
                self.fits(&extent)
            };
            let to = (from..=whole.to).take_while(fits).last().unwrap_or(from);
            if to + 1 >= from + least {
                spans.push(Span { part: whole.part, from, to });
                from = to + BETWEEN;
            } else {
                from += 1;
            }
        }
    }

    fn take(&self, extent: &mut Extent, index: usize, part: Part) {
        self.marks(index, part).iter().enumerate().for_each(|(place, mark)| extent.take(place, *mark));
    }

    /// What is held in a span: the median of its marks, or their middle where the median is too far from some.
    fn centre(&self, span: &Span) -> [DVec3; 4] {
        let median = self.median(span);
        if (span.from..=span.to).all(|index| self.is_near(&median, index, span.part)) {
            return median;
        }
        let mut extent = Extent::default();
        (span.from..=span.to).for_each(|index| self.take(&mut extent, index, span.part));
        extent.middle()
    }

    /// The median of a span's marks, which a few ticks at its ends do not move.
    fn median(&self, span: &Span) -> [DVec3; 4] {
        let marks: Vec<[DVec3; 4]> = (span.from..=span.to).map(|index| self.marks(index, span.part)).collect();
        let mut values = Vec::with_capacity(marks.len());
        let mut median = |place: usize, axis: usize| {
            values.clear();
            values.extend(marks.iter().map(|marks| marks[place][axis]));
            values.sort_by(f64::total_cmp);
            // Of an even number the middle of both: the mirror image has the mirrored median.
            let middle = [values.len().saturating_sub(1) / 2, values.len() / 2];
            middle.iter().filter_map(|at| values.get(*at)).sum::<f64>() * 0.5
        };
        [0, 1, 2, 3].map(|place| DVec3::new(median(place, 0), median(place, 1), median(place, 2)))
    }

    fn fits(&self, extent: &Extent) -> bool {
        extent.half() <= PLACE * self.size && extent.turned() <= TURN
    }

    /// What a part holds at a tick: points (m), and where the sole's normal and the foot point.
    fn marks(&self, index: usize, part: Part) -> [DVec3; 4] {
        match part {
            Part::Flat => [self.feet[index].ankle, self.points[1][index], self.up(index), self.ahead(index)],
            Part::Ball => [self.points[1][index], self.points[1][index], DVec3::Y, DVec3::Z],
            Part::Heel => [self.points[0][index], self.points[0][index], DVec3::Y, DVec3::Z],
        }
    }

    /// What is held in them.
    pub(super) fn holds(&self, spans: &[Span]) -> Vec<Hold> {
        let mut holds: Vec<Hold> = spans.iter().map(|span| self.hold(span)).collect();
        // Who rolls on over a ball or a heel rolls over that of the foot that stood.
        for index in 1..holds.len() {
            let (before, after) = (holds[index - 1], holds[index]);
            if before.to != after.from {
                continue;
            }
            let (flat, roll) = if before.part == Part::Flat { (before, index) } else { (after, index - 1) };
            if flat.part == Part::Flat && holds[roll].part != Part::Flat {
                let part = holds[roll].part;
                holds[roll].point = flat.flat.ankle + flat.flat.foot * point_of(self.run.body, self.side, part);
                holds[roll].plant = flat.plant;
                holds[roll].flat = flat.flat;
            }
        }
        holds
    }

    fn hold(&self, span: &Span) -> Hold {
        let Span { part, from, to } = *span;
        let centre = self.centre(span);
        let body = self.run.body;
        let shape = &body.feet[self.side as usize];
        let middle = (from + to) / 2;
        let heading = if part == Part::Flat { centre[3] } else { self.ahead(middle) };
        let yaw = real::atan2(heading.x, heading.z);
        let point = centre[0];
        let spot = self.run.terrain.spot(DVec2::new(point.x, point.z));
        let mean = centre[2].normalize_or(spot.normal);
        // A sole lies on its ground, where that is no farther than it may be held from the run.
        let lies = part != Part::Flat || (from..=to).all(|index| self.up(index).angle_between(spot.normal) < TURN);
        let normal = if lies { spot.normal } else { mean };
        let tilt = if normal == DVec3::Y { DQuat::IDENTITY } else { DQuat::from_rotation_arc(DVec3::Y, normal) };
        let turned = tilt * DQuat::from_rotation_y(yaw - real::atan2(shape.forward.x, shape.forward.y));
        let (foot, toe) = (turned * shape.level, turned * shape.toe_level);
        let mut ankle = match part {
            Part::Flat => point,
            _ => point - foot * point_of(body, self.side, part),
        };
        let on = DVec3::new(ankle.x, spot.height, ankle.z);
        let over = (ankle - on).dot(spot.normal) - shape.ankle_height;
        if lies && over.abs() < PLACE * self.size {
            ankle -= spot.normal * over;
        }
        let plant = Plant { ankle: ankle - normal * shape.ankle_height, yaw, normal };
        let held = if part == Part::Flat { ankle } else { point };
        Hold::new(part, [from, to], plant, Foot { ankle, foot, toe }, held)
    }
}

/// How far marks go apart.
#[derive(Clone, Copy, Debug)]
struct Extent {
    low: [DVec3; 4],
    high: [DVec3; 4],
}

impl Default for Extent {
    fn default() -> Extent {
        Extent { low: [DVec3::INFINITY; 4], high: [DVec3::NEG_INFINITY; 4] }
    }
}

impl Extent {
    fn take(&mut self, place: usize, mark: DVec3) {
        self.low[place] = self.low[place].min(mark);
        self.high[place] = self.high[place].max(mark);
    }

    fn middle(&self) -> [DVec3; 4] {
        [0, 1, 2, 3].map(|place| 0.5 * (self.low[place] + self.high[place]))
    }

    /// m, from the middle to the farthest point.
    fn half(&self) -> f64 {
        0.5 * (0..2).map(|place| (self.high[place] - self.low[place]).length()).fold(0.0, f64::max)
    }

    /// rad, likewise of directions.
    fn turned(&self) -> f64 {
        0.5 * (2..4).map(|place| (self.high[place] - self.low[place]).length()).fold(0.0, f64::max)
    }
}

/// When the ground presses on a foot that holds nothing, up to a tick; in order of start, left before right.
pub(super) fn scuffs(run: &Run, held: &[Held; 2], last: usize) -> Vec<Scuff> {
    let least = PRESSED * run.body.mass * GRAVITY * run.dt;
    let mut scuffs = Vec::new();
    for side in Side::BOTH {
        let holds = |index: usize| held[side as usize].holding(index as f64 * run.dt).is_some();
        let presses = |index: usize| run.pressed.get(index).is_some_and(|pressed| pressed[side as usize] > least);
        let mut open: Option<Scuff> = None;
        // What pressed by a tick pressed in the time before it.
        for index in 1..=last {
            let (before, now) = ((index - 1) as f64 * run.dt, index as f64 * run.dt);
            if presses(index) && !(holds(index - 1) && holds(index)) {
                open.get_or_insert(Scuff { side, start: before, end: now }).end = now;
            } else {
                scuffs.extend(open.take());
            }
        }
        scuffs.extend(open);
    }
    scuffs.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.side.cmp(&b.side)));
    scuffs
}

/// The spans without the ticks at which something is too far from the run, and without those within `around` of them.
pub(super) fn cut(spans: &[Span], beyond: &[usize], around: usize) -> Vec<Span> {
    let mut kept: Vec<Span> = Vec::new();
    for span in spans {
        let near = |tick: &&usize| **tick + LEAST >= span.from && **tick <= span.to + LEAST;
        let mut bad: Vec<usize> = beyond.iter().filter(near).copied().collect();
        if bad.is_empty() {
            kept.push(*span);
            continue;
        }
        // On the way in or out: the end itself is too far off.
        bad.iter_mut().for_each(|tick| *tick = (*tick).clamp(span.from, span.to));
        let mut from = span.from;
        for tick in bad.into_iter().chain([span.to + around]) {
            let to = tick.saturating_sub(around).min(span.to);
            if to + 1 >= from + LEAST && tick > from {
                kept.push(Span { from, to, ..*span });
            }
            from = from.max(tick + around);
        }
    }
    // Parts that met meet again, the flat foot's end where it is now.
    for pair in spans.windows(2).filter(|pair| pair[0].to == pair[1].from) {
        let before = kept.iter().rposition(|span| span.part == pair[0].part && within(span, &pair[0]));
        let after = kept.iter().position(|span| span.part == pair[1].part && within(span, &pair[1]));
        let (Some(before), Some(after)) = (before, after) else { continue };
        if kept[after].from - kept[before].to > BETWEEN {
            continue;
        }
        if kept[before].part == Part::Flat {
            kept[after].from = kept[before].to;
        } else {
            kept[before].to = kept[after].from;
        }
    }
    kept
}

/// Whether a span is a piece of another.
fn within(span: &Span, whole: &Span) -> bool {
    whole.from <= span.from && span.to <= whole.to
}

//! Scuffs: a foot that bears on the ground and does not hold still. It slides, or rolls on the tip or the edge of its sole.
//!
//! Scenario space, m, s. A contact is what an engine may lock; the ground carries a foot that scuffs as well, where its sole touches.
//! From when to when a foot scuffs the motion says (a body's run knows what pressed on its feet); whether its sole touches then is
//! measured, and so is how far it slides.

use super::{Frame, HeldContact, Track};
use crate::model::{Side, Terrain, report::Part};
use glam::{DQuat, DVec2, DVec3};

/// m at the reference leg: a point of the sole that is no higher over the ground touches it. The keys may have a foot off its run by as much.
const TOUCHES: f64 = 0.005;
/// m: points that are no higher than the lowest by that are the lowest.
const BESIDE: f64 = 0.001;
/// m, by which the ground is lower past an edge, and how often the way between two corners of a sole is halved to find one: to 0.02 mm.
const LOWER: f64 = 0.01;
const HALVES: usize = 14;

/// A foot that bears and does not hold still, as the motion says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scuff {
    /// Which foot.
    pub side: Side,
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
}

/// What of a sole touches the ground at a sample: the plane there, and the points.
#[derive(Clone, Debug)]
pub struct Touching {
    /// A point of the ground and its normal, in the world.
    pub plane: HeldContact,
    /// m.
    pub points: Vec<DVec3>,
}

/// The same at every sample of a scuff.
#[derive(Clone, Debug)]
pub(super) struct Touched {
    first: usize,
    samples: Vec<Option<Touching>>,
}

impl Touched {
    pub(super) fn new(track: &Track, scuff: &Scuff) -> Touched {
        let samples = track.motion.samples_in(scuff.start, scuff.end);
        Touched { first: samples.start, samples: samples.map(|sample| touching(track, scuff.side, sample)).collect() }
    }

    /// Where it touches in a span of time (s) of the scuff, and what of it.
    pub(super) fn in_span(&self, track: &Track, [start, end]: [f64; 2]) -> impl Iterator<Item = &Touching> {
        let span = track.motion.samples_in(start, end);
        let [from, to] = [span.start, span.end].map(|at| at.saturating_sub(self.first).min(self.samples.len()));
        self.samples[from..to.max(from)].iter().flatten()
    }
}

/// What of a foot's sole touches the ground at a sample; `None` where it is in the air or the ground is not known.
pub fn touching(track: &Track, side: Side, sample: usize) -> Option<Touching> {
    let time = track.motion.time(sample);
    let ground = track.terrain.as_ref()?.held_at(time);
    let mut points = Vec::new();
    sole_points(track, sample, side, &mut points);
    let edges = over_edges(&ground, &points);
    points.extend(edges.iter().map(|edge| edge.of(&points)).collect::<Vec<DVec3>>());
    let over = |point: &DVec3| height(&ground, *point);
    let lowest = points.iter().copied().min_by(|a, b| over(a).total_cmp(&over(b)))?;
    let least = TOUCHES * track.motion.body.leg_length / 0.83;
    if over(&lowest) > least {
        return None;
    }
    points.retain(|point| over(point) <= least);
    let spot = ground.spot(DVec2::new(lowest.x, lowest.z));
    let plane = HeldContact {
        side,
        part: Part::Flat,
        start: time,
        end: time,
        point: DVec3::new(lowest.x, spot.height, lowest.z),
        normal: spot.normal,
        frame: Frame::World,
    };
    Some(Touching { plane, points })
}

/// The sole's vertices at a sample, m, in the plane on which it lies when it stands flat: a bevel goes on turning to the tip as the
/// support has it, whose hull reaches over the bevel too.
fn sole_points(track: &Track, sample: usize, side: Side, out: &mut Vec<DVec3>) {
    let body = track.motion.body;
    let foot = &body.feet[side as usize];
    let flat = |level: DQuat, offset: DVec3, height: f64| {
        let levelled = level * offset;
        level.inverse() * DVec3::new(levelled.x, -height, levelled.z)
    };
    let stiff = |offset: &DVec3| track.rigid_point(sample, foot.ankle, flat(foot.level, *offset, foot.ankle_height));
    out.extend(foot.rear_sole.iter().map(stiff));
    match foot.toe {
        Some(toe) => {
            let shift = body.joints[toe].rest - body.joints[foot.ankle].rest;
            let over = foot.ankle_height + (foot.level * shift).y;
            let bends = |offset: &DVec3| track.rigid_point(sample, toe, flat(foot.toe_level, *offset - shift, over));
            out.extend(foot.front_sole.iter().map(bends));
        }
        None => out.extend(foot.front_sole.iter().map(stiff)),
    }
}

/// A point of a sole, on the line between two of its corners, as a share of the way from one to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Between {
    corners: [usize; 2],
    share: f64,
}

impl Between {
    fn of(&self, corners: &[DVec3]) -> DVec3 {
        corners[self.corners[0]].lerp(corners[self.corners[1]], self.share)
    }
}

/// Where the lines between the corners of a sole cross an edge of the ground, on what is higher: on such a point a foot stands that has
/// come off the ground behind the edge and hangs over what is lower before it.
fn over_edges(ground: &Terrain, corners: &[DVec3]) -> Vec<Between> {
    let mut found = Vec::new();
    if !ground.has_edges() {
        return found;
    }
    let under = |point: DVec3| {
        let spot = ground.spot(DVec2::new(point.x, point.z));
        if spot.holds { spot.height } else { f64::NEG_INFINITY }
    };
    let heights: Vec<f64> = corners.iter().map(|corner| under(*corner)).collect();
    for one in 0..corners.len() {
        for other in 0..one {
            let (first, second) = (heights[one], heights[other]);
            if first.max(second) - first.min(second) <= LOWER || first == second {
                continue;
            }
            let pair = if first > second { [one, other] } else { [other, one] };
            let (mut share, mut past) = (0.0, 1.0);
            for _ in 0..HALVES {
                let between = Between { corners: pair, share: 0.5 * (share + past) };
                let on = under(between.of(corners)) > first.max(second) - LOWER;
                *(if on { &mut share } else { &mut past }) = between.share;
            }
            found.push(Between { corners: pair, share });
        }
    }
    found
}

/// m over the ground, along its normal.
fn height(ground: &Terrain, point: DVec3) -> f64 {
    let spot = ground.spot(DVec2::new(point.x, point.z));
    (point.y - spot.height) * spot.normal.y
}

/// Each of them, and how far it slides, mm: the way over the ground, in the mean, of the lowest points of its sole, sample by sample.
pub fn slides(track: &Track, scuffs: &[Scuff]) -> Vec<(Scuff, f64)> {
    scuffs.iter().map(|scuff| (*scuff, 1000.0 * slide(track, scuff))).collect()
}

fn slide(track: &Track, scuff: &Scuff) -> f64 {
    let samples = track.motion.samples_in(scuff.start, scuff.end);
    let (mut here, mut next) = (Vec::new(), Vec::new());
    let mut way = 0.0;
    for sample in samples.clone().take(samples.len().saturating_sub(1)) {
        let Some(terrain) = &track.terrain else { break };
        here.clear();
        next.clear();
        sole_points(track, sample, scuff.side, &mut here);
        sole_points(track, sample + 1, scuff.side, &mut next);
        let (now, then) = (terrain.held_at(track.motion.time(sample)), terrain.held_at(track.motion.time(sample + 1)));
        for edge in over_edges(&now, &here) {
            let (at, goes) = (edge.of(&here), edge.of(&next));
            here.push(at);
            next.push(goes);
        }
        let ground = terrain.turn(track.motion.time(sample + 1)) * terrain.turn(track.motion.time(sample)).inverse();
        way += way_over((&here, &next), (&now, &then), ground);
    }
    way
}

/// m, the way over the ground, in the mean, of the lowest points of a sole that is here and then there, on ground that was so, is so and
/// turned by that meanwhile.
pub(crate) fn way_over((here, next): (&[DVec3], &[DVec3]), (now, then): (&Terrain, &Terrain), ground: DQuat) -> f64 {
    let over = |index: usize| height(now, here[index]) + height(then, next[index]);
    let lowest = (0..here.len()).map(over).fold(f64::INFINITY, f64::min);
    let moved = (0..here.len()).filter(|index| over(*index) < lowest + 2.0 * BESIDE).map(|index| {
        let moved = next[index] - ground * here[index];
        let normal = now.spot(DVec2::new(here[index].x, here[index].z)).normal;
        (moved - normal * moved.dot(normal)).length()
    });
    let (sum, count) = moved.fold((0.0, 0.0), |(sum, count), moved| (sum + moved, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// The spans of time in which a foot scuffs and touches, as contacts that nothing holds in: for what asks only whether it is on the ground.
pub fn grounded(track: &Track, scuffs: &[Scuff]) -> Vec<HeldContact> {
    let mut spans: Vec<HeldContact> = Vec::new();
    let step = 1.0 / track.motion.hz;
    for scuff in scuffs {
        let mut last: Option<usize> = None;
        for sample in track.motion.samples_in(scuff.start, scuff.end) {
            let Some(found) = touching(track, scuff.side, sample) else { continue };
            let time = track.motion.time(sample);
            match spans.last_mut().filter(|_| last.is_some_and(|last| last + 1 == sample)) {
                Some(span) => span.end = time + step,
                None => spans.push(HeldContact { start: time - step, end: time + step, ..found.plane }),
            }
            last = Some(sample);
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::super::{Motion, fixture, hover::hover};
    use super::*;
    use crate::model::scenario::{Ground, GroundKind};

    /// A body that stands and slides forwards by 30 mm in its second second, over the ground by `over` m.
    fn slid(over: f64) -> (crate::model::Body, Vec<crate::model::BodyPose>) {
        let body = fixture::body();
        let poses = fixture::poses(&body, 241, |pose, sample| {
            pose.hips.y += over;
            pose.hips.z += 0.03 * (sample / 120.0 - 1.0).clamp(0.0, 1.0);
        });
        (body, poses)
    }

    #[test]
    fn a_foot_that_slides_30_mm_on_the_ground_is_said_to_and_one_over_it_does_not_touch() {
        let scuff = Scuff { side: Side::Left, start: 1.0, end: 2.0 };
        for (over, touches) in [(0.0, true), (0.004, true), (0.012, false)] {
            let (body, poses) = slid(over);
            let motion: Motion = fixture::motion(&body, &poses);
            let track = Track::over(motion, &Terrain::flat()).expect("sound");
            assert_eq!(touching(&track, Side::Left, 150).is_some(), touches, "{over}");
            let found = slides(&track, &[scuff]);
            assert!((found[0].1 - 30.0).abs() < 0.5, "{found:?}");
            let spans = grounded(&track, &[scuff]);
            let all = hover(&spans, 2.0).total;
            assert!(if touches { (all - 1.0).abs() < 0.02 } else { all == 2.0 }, "{over}: {all} s in the air");
        }
    }

    #[test]
    fn a_sole_that_leans_over_an_edge_touches_it_between_its_corners() {
        let kind = GroundKind::Stairs { rise: -0.17, tread: 0.3, count: 4 };
        let stairs = Terrain::new(&Ground { kind, ..Ground::default() });
        // Its heel is up by 5 cm behind the edge, which is 1 m ahead, its tip as far down before it.
        let sole = [-0.04, 0.04].map(|x| [DVec3::new(x, 0.05, 0.9), DVec3::new(x, -0.05, 1.1)]).concat();
        assert!(sole.iter().all(|corner| height(&stairs, *corner) > TOUCHES));
        let edges: Vec<DVec3> = over_edges(&stairs, &sole).iter().map(|edge| edge.of(&sole)).collect();
        assert_eq!(edges.len(), 4, "along both sides and both diagonals: {edges:?}");
        for edge in edges {
            assert!(edge.z < 1.0 && edge.z > 0.9999 && height(&stairs, edge).abs() < 1e-4, "{edge}");
        }
        assert_eq!(over_edges(&Terrain::flat(), &sole), []);
    }
}

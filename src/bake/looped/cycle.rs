//! Finds the cycle in a performance: two touchdowns of one foot, a stride apart, or a span of a stand whose ends agree.
//!
//! A stride is judged by the one before it: the more alike the two are all the way, the steadier the walk. Of strides that are about as
//! steady the last one is taken. A base clip's walk or stand has the clip's own cycle. Scenario space, metres, seconds.

use crate::bake::base::Over;
use crate::bake::contacts::FootContact;
use crate::bake::perform::Performance;
use crate::bake::timeline::Timeline;
use crate::measure::KnownPush;
use crate::model::Side;
use crate::model::scenario::GroundKind;
use glam::DVec3;

/// s: contacts that follow on one another within this are one.
const SAME: f64 = 1e-3;
/// Moments at which two cycles are compared.
const MOMENTS: usize = 8;
/// s, the shortest and the longest cycle of a stand.
const STAND: [f64; 2] = [1.0, 4.0];
/// Cycles of a stand that are tried.
const TRIED: usize = 40;
/// s before balance is lost that are passed over.
const LOSING: f64 = 1.0;
/// Cycles whose difference is at most this many times the least are as good.
const AS_GOOD: f64 = 1.1;
/// How much what the ends differ by counts beside the most that the two cycles do.
const ENDS: f64 = 2.0;
/// The most that the ends of a cycle may differ by: a walk's, a stand's.
const MOST: [Off; 2] = [Off { angle: 0.2, place: 0.06, speed: 0.25 }, Off { angle: 0.06, place: 0.02, speed: 0.05 }];
/// Part of a stride's way that may lie across where the walk is told to go, and is taken out.
const ASTRAY: f64 = 0.05;

/// A cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cycle {
    /// s of the performance.
    pub start: f64,
    /// s.
    pub period: f64,
    /// m, from its start to its end.
    pub travel: DVec3,
    /// It takes steps.
    pub walks: bool,
    /// It is a base clip's own.
    pub clips: bool,
    /// What the performed ends differ by.
    pub off: Off,
}

/// What two moments of a motion differ by, the way between them apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Off {
    /// rad, the joint that is turned the most.
    pub angle: f64,
    /// m, hips.
    pub place: f64,
    /// m/s, centre of mass.
    pub speed: f64,
}

impl Off {
    fn within(&self, most: &Off, size: f64) -> bool {
        self.angle <= most.angle && self.place <= most.place * size && self.speed <= most.speed * size.sqrt()
    }

    fn cost(&self, size: f64) -> f64 {
        self.angle + self.place / size + self.speed / size.sqrt()
    }
}

/// A cycle to be judged.
struct Candidate {
    start: f64,
    period: f64,
    travel: DVec3,
}

/// Cycles, the best first; or why there is none, with what would give one. Never empty.
pub(super) fn find(performance: &Performance, fps: f64) -> Result<Vec<Cycle>, String> {
    let timeline = &performance.timeline;
    let end = performance.lost.map_or(timeline.stands(), |lost| timeline.stands().min(lost - LOSING));
    if timeline.terrain.moves() {
        return Err("the ground turns under it, and does not begin again. Loops are of ground that holds".into());
    }
    match &timeline.over {
        Some(Over::Walk(walked)) => {
            let period = walked.gait.period;
            let travel = |start: f64| {
                let way = walked.frame(start + period).pose.hips - walked.frame(start).pose.hips;
                DVec3::new(way.x, 0.0, way.z)
            };
            let list = clips_own(performance, period, end, &travel);
            let found = best(timeline, list, true)?;
            return clips_cycles(found).ok_or_else(|| {
                format!(
                    "a base clip that walks is looped before it is disturbed, and from its second cycle on: give it {:.1} s",
                    2.0 * period + 0.1
                )
            });
        }
        Some(Over::Stand(stood)) if stood.base.loops && stood.base.seconds() > 0.0 => {
            let cycles = (STAND[0] / stood.base.seconds()).ceil().max(1.0);
            let period = cycles * stood.base.seconds();
            let mut list = clips_own(performance, period, end, &|_| DVec3::ZERO);
            list.retain(|one| stands(&performance.contacts, one.start - period, one.start + period));
            let found = best(timeline, list, false)?;
            return clips_cycles(found).ok_or_else(|| {
                format!(
                    "the base clip is looped where both feet stand for two of its cycles without a disturbance: give the scenario {:.1} s more",
                    2.0 * period
                )
            });
        }
        _ => {}
    }
    let strides = strides(performance, end);
    let stepped = !strides.is_empty();
    let ground = &timeline.terrain.kind;
    let goes_on = matches!(ground, GroundKind::Flat | GroundKind::Slope { .. });
    let walk = if goes_on { best(timeline, strides, true) } else { Ok(Vec::new()) };
    if walk.as_ref().is_ok_and(|cycles| !cycles.is_empty()) {
        return walk;
    }
    let stand = best(timeline, spans(performance, end, fps), false);
    if stand.as_ref().is_ok_and(|cycles| !cycles.is_empty()) {
        return stand;
    }
    Err(match walk {
        _ if stepped && !goes_on => {
            "on stairs, gaps and rolling ground no stride is like the one before. A walk on flat ground or a slope has a cycle".into()
        }
        Err(why) => why,
        _ => {
            let steps = Side::BOTH.map(|side| downs(&performance.contacts, side, end).len());
            let [left, right] = steps;
            format!(
                "there are {left} touchdowns of the left foot and {right} of the right one in {end:.1} s, and no two strides on end without a \
                 disturbance, nor {:.0} s of standing. A walk has its cycle after about four strides: give the [[walk]], and the \
                 scenario's duration, 5 s or more before anything pushes",
                2.0 * STAND[0]
            )
        }
    })
}

/// Times (s) at which a foot is off the ground within a span.
pub(super) fn airs(contacts: &[FootContact], side: Side, from: f64, to: f64) -> Vec<[f64; 2]> {
    let mut own: Vec<&FootContact> =
        contacts.iter().filter(|contact| contact.side == side && contact.end > from && contact.start < to).collect();
    own.sort_by(|a, b| a.start.total_cmp(&b.start));
    let mut list = Vec::new();
    let mut at = from;
    for contact in own {
        if contact.start - at > SAME {
            list.push([at, contact.start]);
        }
        at = at.max(contact.end);
    }
    if to - at > SAME {
        list.push([at, to]);
    }
    list
}

/// Whether both feet stay on the ground.
fn stands(contacts: &[FootContact], from: f64, to: f64) -> bool {
    Side::BOTH.iter().all(|side| airs(contacts, *side, from, to).is_empty())
}

/// s, when a foot comes down.
fn downs(contacts: &[FootContact], side: Side, end: f64) -> Vec<f64> {
    airs(contacts, side, 0.0, end).iter().map(|air| air[1]).filter(|down| *down < end - SAME).collect()
}

/// Whether nothing pushes then but what pushes all the while.
fn undisturbed(pushes: &[KnownPush], from: f64, to: f64) -> bool {
    pushes.iter().all(|push| push.end <= from || push.start >= to || covers(push, from, to))
}

/// Whether a push lasts all the while.
pub(super) fn covers(push: &KnownPush, from: f64, to: f64) -> bool {
    push.start <= from + SAME && push.end >= to - SAME
}

/// Cycles of a base clip: each begins where the clip does.
fn clips_own(performance: &Performance, period: f64, end: f64, travel: &dyn Fn(f64) -> DVec3) -> Vec<Candidate> {
    let first = performance.pushes.iter().map(|push| push.start).fold(f64::INFINITY, f64::min);
    let walks = matches!(performance.timeline.over, Some(Over::Walk(_)));
    (1..)
        .map(|cycle| f64::from(cycle) * period)
        .take_while(|start| period > 0.0 && start + period <= end + 1e-6)
        .filter(|start| undisturbed(&performance.pushes, start - period, start + period))
        .filter(|start| !walks || start + period <= first)
        .map(|start| Candidate { start, period, travel: travel(start) })
        .collect()
}

/// Strides from touchdown to touchdown, with one like it before.
fn strides(performance: &Performance, end: f64) -> Vec<Candidate> {
    let contacts = &performance.contacts;
    let mut list = Vec::new();
    for side in Side::BOTH {
        let own = downs(contacts, side, end);
        let other = downs(contacts, side.other(), end);
        for pair in own.windows(2) {
            let (start, period) = (pair[0], pair[1] - pair[0]);
            let once = |from: f64| other.iter().filter(|down| **down > from && **down < from + period).count() == 1;
            if start < period || !once(start) || !once(start - period) {
                continue;
            }
            if undisturbed(&performance.pushes, start - period, start + period)
                && let Some(travel) = way(performance, side, start, start + period)
            {
                list.push(Candidate { start, period, travel });
            }
        }
    }
    list
}

/// m, how far a foot that comes down at both times has come; on flat ground along where the walk is told to go.
fn way(performance: &Performance, side: Side, from: f64, to: f64) -> Option<DVec3> {
    let plant = |time: f64| {
        let down =
            performance.contacts.iter().find(|contact| contact.side == side && (contact.start - time).abs() < 1e-6);
        down.map(|contact| contact.plant.ankle)
    };
    let way = plant(to)? - plant(from)?;
    let tick = performance.trace.ticks.get((from / performance.trace.dt).round() as usize)?;
    let told = DVec3::new(tick.walk.x, 0.0, tick.walk.y).normalize_or_zero();
    let along = told * way.dot(told);
    let flat = performance.timeline.terrain.is_flat();
    Some(if flat && (way - along).length() < ASTRAY * way.length() { along } else { way })
}

/// Spans of the last stand that is long enough, which end with it.
fn spans(performance: &Performance, end: f64, fps: f64) -> Vec<Candidate> {
    let mut busy: Vec<[f64; 2]> =
        Side::BOTH.iter().flat_map(|side| airs(&performance.contacts, *side, 0.0, end)).collect();
    let passing = performance.pushes.iter().filter(|push| !covers(push, 0.0, end));
    busy.extend(passing.map(|push| [push.start, push.end]));
    busy.sort_by(|a, b| a[0].total_cmp(&b[0]));
    busy.push([end, end]);
    let mut free: Option<[f64; 2]> = None;
    let mut at = 0.0;
    for [from, to] in busy {
        if from.min(end) - at >= 2.0 * STAND[0] {
            free = Some([at, from.min(end)]);
        }
        at = at.max(to);
    }
    let Some([from, to]) = free else { return Vec::new() };
    let (least, most) = ((STAND[0] * fps).ceil(), (STAND[1].min(0.5 * (to - from)) * fps).floor());
    let step = ((most - least) / TRIED as f64).ceil().max(1.0);
    let periods = (0..=TRIED).map(|index| least + step * index as f64).filter(|frames| *frames <= most);
    periods
        .map(|frames| frames / fps)
        .map(|period| Candidate { start: to - period, period, travel: DVec3::ZERO })
        .collect()
}

fn clips_cycles(found: Vec<Cycle>) -> Option<Vec<Cycle>> {
    let own: Vec<Cycle> = found.into_iter().map(|cycle| Cycle { clips: true, ..cycle }).collect();
    (!own.is_empty()).then_some(own)
}

/// The best of them, best first: of walks that are about as good the last, of stands the longest. None for none; an error where none
/// is good enough.
fn best(timeline: &Timeline, list: Vec<Candidate>, walks: bool) -> Result<Vec<Cycle>, String> {
    let size = (timeline.body.leg_length / 0.83).max(1e-3);
    let mut judged: Vec<(Candidate, f64, Off)> = list
        .into_iter()
        .map(|one| {
            let (worst, off) = apart(timeline, &one, size);
            (one, worst + ENDS * off.cost(size), off)
        })
        .collect();
    judged.sort_by(|a, b| a.1.total_cmp(&b.1));
    let Some((_, least, off)) = judged.first() else { return Ok(Vec::new()) };
    let (most, as_good) = (&MOST[usize::from(!walks)], least * AS_GOOD + 1e-3);
    if !off.within(most, size) {
        return Err(format!(
            "no two {} are alike: the best differ by {:.0} degrees, {:.0} cm and {:.2} m/s. Give it more time to become steady",
            if walks { "strides" } else { "moments of the stand" },
            off.angle.to_degrees(),
            off.place * 100.0,
            off.speed
        ));
    }
    let order = |one: &Candidate| if walks { one.start } else { one.period };
    let good = judged.partition_point(|(_, cost, _)| *cost <= as_good);
    judged[..good].sort_by(|a, b| order(&b.0).total_cmp(&order(&a.0)));
    judged.retain(|(_, _, off)| off.within(most, size));
    let cycle = |(one, _, off): &(Candidate, f64, Off)| Cycle {
        start: one.start,
        period: one.period,
        travel: one.travel,
        walks,
        clips: false,
        off: *off,
    };
    Ok(judged.iter().map(cycle).collect())
}

/// What a cycle and the one before it differ by: the most of it, and what its ends differ by.
fn apart(timeline: &Timeline, one: &Candidate, size: f64) -> (f64, Off) {
    let mut worst = 0.0_f64;
    let mut last = Off::default();
    for moment in 1..=MOMENTS {
        let time = one.start + one.period * moment as f64 / MOMENTS as f64;
        last = off(timeline, time - one.period, time, one.travel);
        worst = worst.max(last.cost(size));
    }
    (worst, last)
}

fn off(timeline: &Timeline, from: f64, to: f64, travel: DVec3) -> Off {
    let speed = |time: f64| {
        let step = timeline.dt.min(0.5 * time);
        (timeline.com_at(time) - timeline.com_at(time - step)) / step.max(1e-9)
    };
    let (a, b) = (timeline.pose_at(from), timeline.pose_at(to));
    let angle = a.turns.iter().zip(&b.turns).map(|(a, b)| a.angle_between(*b)).fold(0.0, f64::max);
    Off { angle, place: (a.hips + travel).distance(b.hips), speed: (speed(to) - speed(from)).length() }
}

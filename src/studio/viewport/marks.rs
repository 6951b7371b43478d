//! What is known of the balance at a time of a bake: soles, footprints gone and coming, support, regions, trail, pushes.
//!
//! Scenario space, metres, newtons. [`Tracks`] are made once a bake and answer for any time in microseconds. Soles are
//! drawn where their foot is planted, so that they hold still as the contacts do.

use crate::bake::Baked;
use crate::bake::contacts::FootContact;
use crate::maths::hull::convex_hull;
use crate::maths::pendulum::{GRAVITY, rate};
use crate::measure::{KnownPush, PushPoint};
use crate::model::report::Part;
use crate::model::scenario::Trigger;
use crate::model::{Body, Physique, Plant, Side, Terrain};
use crate::picture::figure::flat;
use crate::picture::marks::placed_mark;
use crate::picture::{Overlay, Push, SoleMark};
use crate::rig::Rig;
use crate::stepper::support::Tread;
use crate::stepper::{Params, Support};
use glam::{DQuat, DVec2, DVec3};

/// s, contacts of a foot that are nearer to each other leave one print.
const JOINED: f64 = 2e-3;
/// Entries of the series between two points of the trail.
const TRAIL_STRIDE: usize = 3;
/// s, the trail is no longer.
const TRAIL: f64 = 6.0;

/// Marks of one moment. The default is none.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    /// Centre of mass, ξ, centre of pressure, pushes, soles that hold, past footprints.
    pub overlay: Overlay,
    /// Where feet will stand.
    pub coming: Vec<SoleMark>,
    /// Outline of the support, on the ground; empty in the air.
    pub support: Vec<DVec3>,
    /// The controller's regions.
    pub regions: Option<Regions>,
    /// The way of the centre of mass until now, on the ground.
    pub trail: Vec<DVec3>,
    /// m, how high the ground is below the centre of mass.
    pub ground: f64,
}

/// The paper's three regions, as the scenario's dials and `[stepper]` have them: within the inner one nothing is to do, up to the outline
/// the ankles hold, beyond it is stepped.
#[derive(Clone, Debug, PartialEq)]
pub struct Regions {
    /// m, where ξ, or what else is the trigger, should be.
    pub middle: DVec3,
    /// m, the inner region's radius.
    pub inner: f64,
    /// Outline of the middle region.
    pub sway: Vec<DVec3>,
    /// Where it is now.
    pub now: Region,
}

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Inner.
    Rest,
    /// Middle.
    Sway,
    /// Outer.
    Step,
}

/// What [`Marks`] are read from, at any time of a bake.
#[derive(Clone, Debug)]
pub struct Tracks {
    dt: f64,
    /// m, centre of mass every `dt`.
    com: Vec<DVec3>,
    /// m, pressure every `dt`; shorter where it falls.
    cop: Vec<DVec2>,
    /// Contacts and the marks of their soles in the ground's frame.
    contacts: Vec<(FootContact, SoleMark)>,
    /// Unbroken stands of a foot: from, to (s), and their print.
    stands: Vec<(f64, f64, SoleMark)>,
    /// Pushes, and the point that each acts on every `dt` from its start.
    pushes: Vec<(KnownPush, Vec<DVec3>)>,
    terrain: Terrain,
    params: Params,
    physique: Physique,
}

impl Marks {
    /// Of a bake at a time. For many times make [`Tracks`] once.
    pub fn of(baked: &Baked, _rig: &Rig, time: f64) -> Marks {
        Tracks::new(baked).at(time)
    }
}

impl Tracks {
    /// Of a bake.
    pub fn new(baked: &Baked) -> Tracks {
        let performance = &baked.performance;
        let timeline = &performance.timeline;
        let body = &timeline.body;
        let mark = |contact: &FootContact| (*contact, sole(body, contact.side, contact.part, &contact.plant));
        Tracks {
            dt: timeline.dt,
            com: timeline.centres(),
            cop: performance.trace.ticks.iter().map(|tick| tick.cop).collect(),
            contacts: performance.contacts.iter().map(mark).collect(),
            stands: stands(body, &performance.contacts),
            pushes: performance.pushes.iter().map(|push| (*push, points(baked, push))).collect(),
            terrain: timeline.terrain.clone(),
            params: Params::new(&performance.physique, &performance.style),
            physique: performance.physique,
        }
    }

    /// The marks at a time.
    pub fn at(&self, time: f64) -> Marks {
        let turn = self.terrain.turn(time);
        let turned = |mark: &SoleMark| carried(mark, turn);
        let Some(last) = self.com.len().checked_sub(1) else { return Marks::default() };
        let index = ((time / self.dt.max(1e-9)).round().max(0.0) as usize).min(last);
        let com = self.com[index];
        let held: Vec<&(FootContact, SoleMark)> =
            Side::BOTH.iter().filter_map(|side| self.contact(*side, time)).collect();
        let soles: Vec<SoleMark> = held.iter().map(|(_, mark)| turned(mark)).collect();
        let floor = |contact: &FootContact| (turn * contact.plant.ankle).y;
        let lowest = held.iter().map(|(contact, _)| floor(contact)).fold(f64::INFINITY, f64::min);
        let mut before =
            self.contacts.iter().filter(|(contact, _)| contact.start <= time).map(|(contact, _)| floor(contact));
        let ground = if lowest.is_finite() { lowest } else { before.next_back().unwrap_or(0.0) };
        let corners: Vec<DVec3> = soles.iter().flat_map(|mark| mark.held.iter().copied()).collect();
        let support = hull_on(&corners);
        let xi = self.xi(index, ground);
        Marks {
            regions: self.regions(&held, turn, flat(com), xi),
            overlay: Overlay {
                com: Some(com),
                xi: Some(xi),
                cop: self.cop.get(index).copied().filter(|_| !soles.is_empty()),
                pushes: self.acting(time),
                prints: self.stands.iter().filter(|stand| stand.1 < time).map(|stand| turned(&stand.2)).collect(),
                soles,
            },
            coming: self.stands.iter().filter(|stand| stand.0 > time).map(|stand| turned(&stand.2)).collect(),
            support,
            trail: self.trail(index, ground),
            ground,
        }
    }

    /// The latest contact of a foot that holds at that time.
    fn contact(&self, side: Side, time: f64) -> Option<&(FootContact, SoleMark)> {
        let holds = |(contact, _): &&(FootContact, SoleMark)| {
            contact.side == side && contact.start <= time + 1e-6 && time <= contact.end + 1e-6
        };
        self.contacts.iter().filter(holds).max_by(|a, b| a.0.start.total_cmp(&b.0.start))
    }

    /// What pushes at a time, where it does.
    fn acting(&self, time: f64) -> Vec<Push> {
        let acts =
            |(push, _): &&(KnownPush, Vec<DVec3>)| push.start <= time && time <= push.end && push.force.length() > 1e-6;
        let at = |(push, points): &(KnownPush, Vec<DVec3>)| {
            let place = ((time - push.start) / self.dt.max(1e-9)).clamp(0.0, 1e6);
            let index = (place as usize).min(points.len().checked_sub(1)?);
            let next = (index + 1).min(points.len() - 1);
            let point = points[index].lerp(points[next], (place - index as f64).clamp(0.0, 1.0));
            Some(Push { point, force: push.force })
        };
        self.pushes.iter().filter(acts).filter_map(at).collect()
    }

    /// c + v/ω on the ground.
    fn xi(&self, index: usize, ground: f64) -> DVec2 {
        let last = self.com.len() - 1;
        let (before, after) = (index.saturating_sub(1), (index + 1).min(last));
        let seconds = ((after - before) as f64 * self.dt).max(1e-9);
        let velocity = flat(self.com[after] - self.com[before]) / seconds;
        let com = self.com[index];
        flat(com) + velocity / rate((com.y - ground).max(0.05)).max(0.1 * GRAVITY.sqrt())
    }

    /// Around the feet that hold; `None` in the air. The trigger is ξ or the centre of mass above the ground.
    fn regions(&self, held: &[&(FootContact, SoleMark)], turn: DQuat, com: DVec2, xi: DVec2) -> Option<Regions> {
        let plants: Vec<&Plant> = held.iter().map(|(contact, _)| &contact.plant).collect();
        let (params, physique) = (&self.params, &self.physique);
        let area = |margin: f64| match plants[..] {
            [one] => Some(Support::one(params, physique, one, Tread::Whole, margin)),
            [left, right] => Some(Support::two(params, physique, [left, right], [Tread::Whole; 2], margin)),
            _ => None,
        };
        let ahead = plants.iter().map(|plant| DVec2::from_angle(plant.yaw)).sum::<DVec2>().normalize_or(DVec2::X);
        let ankles = plants.iter().map(|plant| plant.ankle).sum::<DVec3>() / plants.len().max(1) as f64;
        let middle = turn * (ankles + DVec3::new(ahead.y, 0.0, ahead.x) * params.com_forward);
        let trigger = match params.trigger {
            Trigger::Extrapolated => xi,
            Trigger::Projected => com,
        };
        // The areas lie in the ground's own frame.
        let on_ground = |point: DVec2| turn * level_with(&plants, point);
        let seen = turn.inverse() * DVec3::new(trigger.x, middle.y, trigger.y);
        let now = if trigger.distance(flat(middle)) < params.inner {
            Region::Rest
        } else if area(0.0)?.outside(flat(seen)) + params.outer <= 0.0 {
            Region::Sway
        } else {
            Region::Step
        };
        let sway = area(params.outer)?.outline().into_iter().map(on_ground).collect();
        Some(Regions { middle, inner: params.inner, sway, now })
    }

    fn trail(&self, index: usize, ground: f64) -> Vec<DVec3> {
        let first = index.saturating_sub((TRAIL / self.dt.max(1e-9)) as usize);
        let mut trail: Vec<DVec3> = (first.div_ceil(TRAIL_STRIDE) * TRAIL_STRIDE..=index)
            .step_by(TRAIL_STRIDE)
            .map(|at| DVec3::new(self.com[at].x, ground, self.com[at].z))
            .collect();
        trail.push(DVec3::new(self.com[index].x, ground, self.com[index].z));
        // What stands still has none.
        trail.dedup_by(|a, b| a.distance_squared(*b) < 1e-6);
        trail
    }
}

/// The points that a push acts on, from its start to its end.
fn points(baked: &Baked, push: &KnownPush) -> Vec<DVec3> {
    let timeline = &baked.performance.timeline;
    let body = &timeline.body;
    let count = ((push.end - push.start) / timeline.dt.max(1e-4)).ceil().clamp(0.0, 1e5) as usize;
    let point = |index: usize| {
        let pose = timeline.pose_at(push.start + index as f64 * timeline.dt);
        let positions = pose.positions(body);
        match push.at {
            PushPoint::Centre => pose.centre_of_mass(body, &positions),
            PushPoint::Joint(joint) => positions.get(joint).copied().unwrap_or(pose.hips),
            PushPoint::Segment(joint, offset) => match (positions.get(joint), pose.turns.get(joint)) {
                (Some(position), Some(turn)) => *position + *turn * offset,
                _ => pose.hips,
            },
            PushPoint::World(point) => point,
        }
    };
    (0..=count).map(point).collect()
}

/// The sole of a foot that is planted there.
fn sole(body: &Body, side: Side, part: Part, plant: &Plant) -> SoleMark {
    let shape = &body.feet[side as usize];
    let turn = DQuat::from_rotation_y(plant.yaw - shape.forward.x.atan2(shape.forward.y));
    let place = |offset: &DVec3| {
        let level = turn * DVec3::new(offset.x, 0.0, offset.z);
        let rise = -(plant.normal.x * level.x + plant.normal.z * level.z) / plant.normal.y.max(0.1);
        plant.ankle + level + DVec3::Y * rise
    };
    placed_mark(body, side, part, &place)
}

/// Contacts of a foot that follow each other without a gap are one stand.
fn stands(body: &Body, contacts: &[FootContact]) -> Vec<(f64, f64, SoleMark)> {
    let mut stands: Vec<(f64, f64, SoleMark)> = Vec::new();
    for side in Side::BOTH {
        let mut own: Vec<&FootContact> = contacts.iter().filter(|contact| contact.side == side).collect();
        own.sort_by(|a, b| a.start.total_cmp(&b.start));
        let first = stands.len();
        for contact in own {
            match stands[first..].last_mut().filter(|stand| contact.start <= stand.1 + JOINED) {
                Some(stand) => stand.1 = stand.1.max(contact.end),
                None => stands.push((contact.start, contact.end, sole(body, side, Part::Flat, &contact.plant))),
            }
        }
    }
    stands
}

/// The point of the ground under a foot's plane, of the nearest foot.
fn level_with(plants: &[&Plant], point: DVec2) -> DVec3 {
    let far = |plant: &&&Plant| flat(plant.ankle).distance_squared(point);
    let nearest = plants.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
    let height = nearest.map_or(0.0, |plant| {
        let (to, normal) = (point - flat(plant.ankle), plant.normal);
        plant.ankle.y - (normal.x * to.x + normal.z * to.y) / normal.y.max(0.1)
    });
    DVec3::new(point.x, height, point.y)
}

/// A mark turned about the origin.
fn carried(mark: &SoleMark, turn: DQuat) -> SoleMark {
    if turn == DQuat::IDENTITY {
        return mark.clone();
    }
    let all = |points: &[DVec3]| points.iter().map(|point| turn * *point).collect();
    SoleMark { whole: all(&mark.whole), held: all(&mark.held), ..*mark }
}

/// The convex hull seen from above, each corner at its own height.
fn hull_on(points: &[DVec3]) -> Vec<DVec3> {
    let hull = convex_hull(&points.iter().map(|point| flat(*point)).collect::<Vec<_>>());
    let back = |corner: &DVec2| points.iter().copied().find(|point| flat(*point) == *corner);
    hull.iter().filter_map(back).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{BakeOptions, bake};
    use crate::model::Scenario;
    use crate::model::scenario::SupportModel;
    use crate::rig;

    fn mannequin() -> Rig {
        let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        rig::load_bytes("builtin", rig::mannequin::BUILTIN, &none, None).expect("the rig inside")
    }

    #[test]
    fn regions_are_those_of_the_scenario() {
        let rig = mannequin();
        let at_rest = |change: &dyn Fn(&mut Scenario)| {
            let mut scenario = Scenario { duration: 1.0, ..Scenario::default() };
            change(&mut scenario);
            let baked = bake(&rig, &scenario, &BakeOptions::default()).expect("a stand bakes");
            Tracks::new(&baked).at(0.5).regions.expect("both feet are down")
        };
        let wide = |regions: &Regions| {
            let across = regions.sway.iter().map(|point| point.x);
            across.clone().fold(f64::MIN, f64::max) - across.fold(f64::MAX, f64::min)
        };
        let people = at_rest(&|_| ());
        assert_eq!(people.sway.len(), 6, "two soles side by side: {:?}", people.sway);
        let ready = at_rest(&|scenario| scenario.character.style.readiness = 1.0);
        let narrower = wide(&people) - wide(&ready);
        assert!((0.02..0.08).contains(&narrower), "who is ready steps {narrower} m before the edge");
        let circles = at_rest(&|scenario| scenario.stepper.support = SupportModel::Circles);
        assert!(circles.sway.len() > 20 && wide(&circles) > wide(&people), "{:?}", circles.sway);
    }

    #[test]
    fn marks_of_a_shove_tell_its_feet_its_push_and_where_it_goes() {
        let rig = mannequin();
        let scenario = Scenario::demo();
        let baked = bake(&rig, &scenario, &BakeOptions::default()).expect("the demo bakes");
        let tracks = Tracks::new(&baked);
        let push = baked.performance.pushes[0];
        let still = tracks.at(0.0);
        assert_eq!(still.overlay.soles.len(), 2);
        assert!(still.overlay.prints.is_empty() && still.overlay.pushes.is_empty() && !still.coming.is_empty());
        assert_eq!(still.regions.as_ref().map(|regions| regions.now == Region::Step), Some(false));
        let pushed = tracks.at(0.5 * (push.start + push.end));
        assert_eq!(pushed.overlay.pushes.len(), 1);
        let end = tracks.at(baked.report.duration);
        assert!(end.coming.is_empty() && !end.overlay.prints.is_empty() && end.trail.len() > 10);
        // The marks lie under the feet of the pose.
        let body = &baked.performance.timeline.body;
        let pose = baked.performance.timeline.pose_at(baked.report.duration);
        let positions = pose.positions(body);
        for sole in &end.overlay.soles {
            let middle = sole.whole.iter().sum::<DVec3>() / sole.whole.len() as f64;
            let ankle = positions[body.feet[sole.side as usize].ankle];
            assert!(flat(middle - ankle).length() < 0.12 && middle.y.abs() < 1e-6, "{middle} {ankle}");
        }
        let started = std::time::Instant::now();
        for index in 0..200 {
            let marks = tracks.at(baked.report.duration * f64::from(index) / 200.0);
            assert!(marks.overlay.com.is_some());
        }
        let each = started.elapsed() / 200;
        assert!(each < std::time::Duration::from_millis(1), "{each:?}");
    }
}

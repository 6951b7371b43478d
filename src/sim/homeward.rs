//! Back into the stance of a base clip once the body has caught itself: one foot after the other is set where it stands in the clip. The
//! weight goes over the foot that stays, the other one is lifted, carried and put down without hurry. Scenario space, SI.

use super::run::Course;
use crate::maths::curve::smooth3;
use crate::maths::hull::{convex_hull, signed_distance};
use crate::maths::pendulum::pivot_for;
use crate::maths::quat::{wrap_angle, yaw_of};
use crate::model::Side;
use crate::ragdoll::{Controller, Guide, Wish};
use glam::{DQuat, DVec2, DVec3};

/// m at legs of 0.83 m, and rad: a foot that is nearer to where it stands in the clip is not set anew.
const NEAR: f64 = 0.04;
const TURNED: f64 = 0.14;
/// rad, by which it may face elsewhere than before where that spares it a step.
const FACES: f64 = 0.2;
/// m at legs of 0.83 m, what a second step costs, and what a radian of a foot's turn does.
const AGAIN: f64 = 0.3;
const TURN: f64 = 0.3;

/// m/s and m at legs of 0.83 m: slower, and with ξ that far inside the soles, it is quiet; s at such legs, since it last fought and for how
/// long it must have been quiet before a foot is set.
const SLOW: f64 = 0.15;
const WITHIN: f64 = 0.03;
const CALM: f64 = 0.3;
const QUIET: f64 = 0.1;
/// rad/s at such legs, how fast the body turns to where it is to face.
const TURNS: f64 = 0.8;

/// s at such legs, in which the weight begins to go over to the foot that stays; m at such legs, how far beyond ξ the pressure is moved for
/// that at most.
const BEGINS: f64 = 0.25;
const SHIFTS: f64 = 0.12;
/// m at such legs, how far the pressure that brings ξ to where the foot lands is inside the sole that stays when the other foot is lifted, and
/// how far outside ξ may be then. Of 126 seeded shoves of 35 to 100 N s over seven idles on six bodies 98 % stand and 84 % are back in them;
/// lifted where ξ itself is 12 mm inside that sole 76 % are: its pressure could not keep ξ there any more.
const STEERS: f64 = 0.005;
const OUTSIDE: f64 = 0.05;
/// s at such legs, the shortest and the longest shift of the weight.
const SHIFT_TIME: [f64; 2] = [0.1, 2.0];
/// s at such legs, how long it is left alone after a shift that did not succeed.
const WAITS: f64 = 1.0;
/// s at such legs: a step on the spot, for each leg length of 0.83 m of way, for each radian that the foot turns, and the longest. Without
/// more time for turns feet land 0.2 rad short of theirs, and are set anew.
const STEP_TIME: [f64; 4] = [0.4, 0.25, 0.3, 0.8];
/// Share of the way from the foot that stays to where the other one lands, over which ξ is to be then.
const LANDS: f64 = 0.35;
/// s at such legs, in which ξ is brought there at the least.
const SHORTEST: f64 = 0.1;
/// m at such legs, how high a foot goes; shares of its time in which it rises and comes down.
const LIFT: f64 = 0.06;
const RISES: f64 = 0.35;
const COMES_DOWN: f64 = 0.4;
/// m at such legs, that an ankle keeps from the other one on its way, and share of its time in which it goes around it.
const CLEAR: f64 = 0.16;
const AROUND: f64 = 0.6;
/// m at such legs: with ξ farther out of the sole that stays the law steps by itself; with both feet down, nearer to the edge.
const TIPS: f64 = 0.4;
const EDGE: f64 = 0.01;
/// s: a foot that was to be in the air stands by then only if it has landed.
const LEFT: f64 = 0.1;

/// A foot's way home.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Errand {
    side: Side,
    /// m, where its ankle is to stand and where it stood, (x, z).
    ankle: DVec2,
    from: DVec2,
    /// rad, where the body is to face, its foot as in the clip.
    heading: f64,
    /// s, when the weight began to shift, when the foot was lifted, and how long its step takes.
    since: f64,
    lifted: Option<f64>,
    time: f64,
}

/// The way home of a body.
#[derive(Clone, Debug, Default)]
pub(super) struct Homeward {
    errand: Option<Errand>,
    faces: f64, // rad
    quiet: f64, // s
    waits: f64, // s
}

/// What a tick is about.
struct Scene<'a> {
    course: &'a Course<'a>,
    control: &'a Controller,
    size: f64,
    tempo: f64,
    xi: DVec2,
}

impl Scene<'_> {
    /// m, where the ankle of a foot is and rad, how it is turned.
    fn foot(&self, side: Side) -> (DVec2, f64) {
        let state = &self.control.states()[self.course.figure.legs[side as usize][2]];
        (flat(state.origin), yaw_of(state.turn))
    }

    fn sole(&self, side: Side) -> Vec<DVec2> {
        self.course.figure.sole_at(self.control.states(), side).map(flat).to_vec()
    }

    /// m at legs of 0.83 m, how far a point is inside these soles.
    fn inside(&self, soles: &[DVec2], point: DVec2) -> f64 {
        -signed_distance(&convex_hull(soles), point) / self.size
    }
}

impl Homeward {
    /// Sets what guides the law in the coming tick of `dt` s, or that nothing does.
    pub(super) fn lead(&mut self, course: &Course, control: &mut Controller, dt: f64) {
        let tempo = control.tempo();
        let scene = Scene { course, control, size: tempo * tempo, tempo, xi: control.extrapolated() };
        let guide = self.guide(&scene, dt);
        if guide.is_none() {
            self.errand = None;
        }
        control.guide = guide;
    }

    fn guide(&mut self, scene: &Scene, dt: f64) -> Option<Guide> {
        let (control, tempo) = (scene.control, scene.tempo);
        self.waits = (self.waits - dt).max(0.0);
        if control.occupied() {
            self.quiet = 0.0;
            return None;
        }
        let both = scene.inside(&Side::BOTH.map(|side| scene.sole(side)).concat(), scene.xi);
        if self.errand.is_none() {
            let still = flat(control.report.velocity).length() < SLOW * tempo && both > WITHIN;
            self.quiet = if still && control.at_ease() > CALM * tempo { self.quiet + dt } else { 0.0 };
            if self.quiet < QUIET * tempo || self.waits > 0.0 {
                return None;
            }
            self.errand = errand(scene);
            self.faces = control.looks();
        }
        let mut errand = self.errand?;
        let most = TURNS * dt / tempo;
        self.faces += wrap_angle(errand.heading - self.faces).clamp(-most, most);
        let stays = scene.sole(errand.side.other());
        let inside = scene.inside(&stays, scene.xi);
        match errand.lifted {
            Some(when) if inside < -TIPS || control.time - when > LEFT && control.swing.is_none() => return None,
            Some(_) => {}
            None if both < EDGE => return None,
            None => {
                let passed = (control.time - errand.since) / tempo;
                errand.time = takes(scene, &errand);
                let needed = pivot_for(scene.xi, lands(scene, &errand), control.rate(), errand.time);
                let steers = scene.inside(&stays, needed) > STEERS;
                if steers && inside > -OUTSIDE && passed > SHIFT_TIME[0] {
                    (errand.from, _) = scene.foot(errand.side);
                    errand.lifted = Some(control.time);
                } else if passed > SHIFT_TIME[1] {
                    self.waits = WAITS * tempo;
                    return None;
                }
            }
        }
        self.errand = Some(errand);
        let (pressure, swing) = match errand.lifted {
            None => (shift(scene, &errand), None),
            Some(when) => step(scene, &errand, control.time - when),
        };
        Some(Guide {
            pressure: DVec3::new(pressure.x, 0.0, pressure.y),
            floor: 0.0,
            climbs: 0.0,
            heading: self.faces,
            velocity: DVec2::ZERO,
            lean: 0.0,
            heel: None,
            spot: false,
            ends: false,
            swing,
            leaves: None,
            stride: None,
            strides: 0.0,
            in_time: false,
            balls: 0.0,
        })
    }
}

/// m, where the pressure is to be for the weight to come over the foot that stays.
fn shift(scene: &Scene, errand: &Errand) -> DVec2 {
    let begun = smooth3((scene.control.time - errand.since) / (BEGINS * scene.tempo));
    let off = scene.xi - middle(&scene.sole(errand.side.other()));
    scene.xi + off.clamp_length_max(SHIFTS * scene.size) * begun
}

/// s, how long the foot's step takes.
fn takes(scene: &Scene, errand: &Errand) -> f64 {
    let (ankle, yaw) = scene.foot(errand.side);
    let (far, turns) = (errand.ankle.distance(ankle) / scene.size, wrap_angle(yaw - errand.heading).abs());
    let [least, way, turn, most] = STEP_TIME;
    (least + way * far + turn * turns).min(most) * scene.tempo
}

/// m, where ξ is to be when the foot lands.
fn lands(scene: &Scene, errand: &Errand) -> DVec2 {
    let stance = errand.side.other();
    middle(&scene.sole(stance)) + (errand.ankle - scene.foot(stance).0) * LANDS
}

/// The same while the other foot goes home, and where that is to be, `passed` s after it was lifted.
fn step(scene: &Scene, errand: &Errand, passed: f64) -> (DVec2, Option<Wish>) {
    let (by, _) = scene.foot(errand.side.other());
    let left = (errand.time - passed).max(0.0);
    let pressure = pivot_for(scene.xi, lands(scene, errand), scene.control.rate(), left.max(SHORTEST * scene.tempo));
    let share = (passed / errand.time).clamp(0.0, 1.0);
    let up = smooth3(share / RISES).min(smooth3((1.0 - share) / COMES_DOWN));
    let lift = LIFT * scene.size;
    let round = around(errand.from, errand.ankle, by, CLEAR * scene.size) * (1.0 - smooth3(share / AROUND));
    let (side, yaw) = (errand.side, errand.heading);
    (pressure, Some(Wish { side, ankle: errand.ankle + round, yaw, left, lift, height: Some(lift * up) }))
}

/// m, by how much a way is to go round a point that it would come nearer to than that.
fn around(from: DVec2, to: DVec2, by: DVec2, clear: f64) -> DVec2 {
    let way = to - from;
    let along = (by - from).dot(way) / way.length_squared().max(1e-9);
    if along <= 0.0 || along >= 1.0 {
        return DVec2::ZERO;
    }
    let beside = from + way * along - by;
    // A path to a goal that comes back to its place in time is half as far out on its way.
    beside.normalize_or_zero() * (2.0 * (clear - beside.length()).max(0.0))
}

/// The next foot to be set for the body to stand as in the clip; `None` where it does.
fn errand(scene: &Scene) -> Option<Errand> {
    let [left, right] = scene.course.start.map(|plant| flat(plant.ankle));
    let apart = left - right;
    let looks = scene.control.looks();
    let mut best: Option<(f64, Option<Errand>)> = None;
    for side in Side::BOTH {
        let ((at, yaw), (by, beside)) = (scene.foot(side), scene.foot(side.other()));
        let heading = looks + wrap_angle(beside - looks).clamp(-FACES, FACES);
        let turned = DQuat::from_rotation_y(heading) * DVec3::new(apart.x, 0.0, apart.y);
        let ankle = by + flat(turned) * side.sign();
        let far = at.distance(ankle) / scene.size;
        let [own, other] = [yaw, beside].map(|yaw| wrap_angle(yaw - heading).abs());
        let goes = far > NEAR || own > TURNED || other > TURNED;
        let again = if other > TURNED { AGAIN } else { 0.0 };
        let cost = if goes { far + TURN * (own + other) + again } else { 0.0 };
        if best.as_ref().is_none_or(|best| cost < best.0) {
            let since = scene.control.time;
            let errand = Errand { side, ankle, from: at, heading, since, lifted: None, time: STEP_TIME[0] };
            best = Some((cost, goes.then_some(errand)));
        }
    }
    best.and_then(|best| best.1)
}

/// m, the middle of a sole: of its heel and of its tip.
fn middle(sole: &[DVec2]) -> DVec2 {
    match sole {
        [a, b, .., y, z] => 0.25 * (*a + *b + *y + *z),
        _ => DVec2::ZERO,
    }
}

fn flat(v: DVec3) -> DVec2 {
    DVec2::new(v.x, v.z)
}

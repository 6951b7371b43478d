//! Captures whose truth is known: a walk of an inverted pendulum that steps where it must, a stand, a jump, a seat.
//!
//! Clip space, SI. The body is the measures' synthetic one. Its centre of mass is where the pendulum has it (hips are moved until it is),
//! its feet are flat; legs reach them by two-bone inverse kinematics.

use crate::maths::quat::shortest_arc;
use crate::maths::real;
use crate::maths::two_bone_ik::two_bone_ik;
use crate::measure::{GRAVITY, fixture};
use crate::model::{Body, Capture, Role, Side};
use glam::{DQuat, DVec2, DVec3, dvec3};

/// A steady walk along +Z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gait {
    /// m/s.
    pub speed: f64,
    /// s.
    pub step_secs: f64,
    /// m between the feet.
    pub width: f64,
    /// Hz.
    pub fps: f64,
    /// s.
    pub seconds: f64,
    /// m, of the ground at the origin.
    pub floor: f64,
    /// How the ground rises along x and z.
    pub slope: DVec2,
    /// m a step: stairs.
    pub rise: f64,
}

impl Default for Gait {
    fn default() -> Gait {
        Gait {
            speed: 1.0,
            step_secs: 0.5,
            width: 0.14,
            fps: 60.0,
            seconds: 6.0,
            floor: 0.0,
            slope: DVec2::ZERO,
            rise: 0.0,
        }
    }
}

/// Height of the centre of mass over the ground, m.
fn carried(body: &Body) -> f64 {
    fixture::com(body).y - 0.06
}

impl Gait {
    /// Which foot bears in a step, and where it stands, (x, y, z).
    pub fn foothold(&self, step: usize) -> (Side, DVec3) {
        let side = Side::BOTH[step % 2];
        let place = dvec3(0.5 * self.width * side.sign(), 0.0, self.speed * self.step_secs * step as f64);
        let height = self.floor + self.slope.dot(DVec2::new(place.x, place.z)) + self.rise * step as f64;
        (side, place + DVec3::Y * height)
    }

    fn pose(&self, body: &Body, time: f64) -> (DVec3, [DVec3; 2]) {
        let omega = (GRAVITY / carried(body)).sqrt();
        let step = (time / self.step_secs).floor().max(0.0);
        let (since, step) = (time - step * self.step_secs, step as usize + 1);
        let half = 0.5 * self.step_secs;
        let (side, stance) = self.foothold(step);
        let length = self.speed * self.step_secs;
        let ahead = 0.5 * length * real::sinh(omega * (since - half)) / real::sinh(omega * half);
        let aside = -0.5 * side.sign() * self.width * real::cosh(omega * (since - half)) / real::cosh(omega * half);
        let (u, share) = (since / self.step_secs, smooth(since / self.step_secs));
        let rise = self.rise * (u - 0.5) + self.slope.y * ahead;
        // The foot stands at the middle of heel and bending line; the centre of mass goes over that.
        let com = stance + dvec3(aside, carried(body) + rise, ahead);
        let (from, to) = (self.foothold(step - 1).1, self.foothold(step + 1).1);
        let lift = (0.08 + 1.5 * self.rise.abs()) * real::sin(std::f64::consts::PI * u).powi(2);
        let swing = from.lerp(to, share) + DVec3::Y * lift;
        let mut feet = [stance; 2];
        feet[side.other() as usize] = swing;
        (com, feet.map(|place| place - DVec3::Z * 0.03))
    }
}

fn smooth(u: f64) -> f64 {
    u * u * (3.0 - 2.0 * u)
}

/// Walks.
pub(crate) fn walk(gait: Gait) -> Capture {
    let body = fixture::body();
    let frames = (gait.seconds * gait.fps) as usize;
    posed(&body, gait.fps, frames, |time| gait.pose(&body, time))
}

/// Stands on both feet and hardly sways.
pub(crate) fn stand(seconds: f64) -> Capture {
    let body = fixture::body();
    let feet = Side::BOTH.map(|side| DVec3::X * 0.09 * side.sign());
    posed(&body, 60.0, (seconds * 60.0) as usize, |time| {
        (dvec3(0.005 * real::sin(2.0 * time), carried(&body), 0.03 + 0.005 * real::cos(1.3 * time)), feet)
    })
}

/// Stands, flies for so many seconds as bodies fall, stands; played at that share of its speed while it flies.
pub(crate) fn jump(flight: f64, speed: f64) -> Capture {
    let body = fixture::body();
    posed(&body, 120.0, (120.0 * (2.0 + flight / speed)) as usize, |time| {
        let since = ((time - 1.0) * speed).clamp(0.0, flight);
        let up = 0.5 * GRAVITY * since * (flight - since);
        let feet = Side::BOTH.map(|side| dvec3(0.09 * side.sign(), up, 0.0));
        (dvec3(0.0, carried(&body) + up, 0.03), feet)
    })
}

/// Sits on what is not in the clip, feet on the ground.
pub(crate) fn seat(seconds: f64) -> Capture {
    let body = fixture::body();
    let feet = Side::BOTH.map(|side| dvec3(0.1 * side.sign(), 0.0, 0.35));
    posed(&body, 60.0, (seconds * 60.0) as usize, |time| (dvec3(0.02 * real::sin(time), 0.62, 0.0), feet))
}

/// A body whose centre of mass and soles (below the ankles) are where a function of time says.
pub(crate) fn posed(body: &Body, fps: f64, frames: usize, at: impl Fn(f64) -> (DVec3, [DVec3; 2])) -> Capture {
    let rest: Vec<DVec3> = body.joints.iter().map(|joint| joint.rest).collect();
    let joints = rest.len();
    let mut capture = Capture {
        name: "made".to_owned(),
        fps,
        body: body.clone(),
        positions: rest.repeat(frames),
        turns: vec![DQuat::IDENTITY; joints * frames],
        units_to_metres: 1.0,
        up: "+Y".to_owned(),
        confidence: 1.0,
        method: "made".to_owned(),
        notes: Vec::new(),
        pushes: Vec::new(),
    };
    for frame in 0..frames {
        let (com, soles) = at(frame as f64 / fps);
        for _ in 0..3 {
            let shift = com - capture.centre_of_mass(frame);
            for place in &mut capture.positions[frame * joints..(frame + 1) * joints] {
                *place += shift;
            }
            for side in Side::BOTH {
                let ankle = soles[side as usize] + DVec3::Y * body.feet[side as usize].ankle_height;
                put_foot(&mut capture, frame, side, ankle);
            }
        }
    }
    capture
}

/// Moves a foot by so much in frames; the leg follows.
pub(crate) fn shift_foot(capture: &mut Capture, frame: usize, side: Side, shift: DVec3) {
    let ankle = capture.at(frame)[capture.body.feet[side as usize].ankle];
    put_foot(capture, frame, side, ankle + shift);
}

/// Moves all of a body in a frame.
pub(crate) fn shift_all(capture: &mut Capture, frame: usize, shift: DVec3) {
    let joints = capture.body.joints.len();
    for place in &mut capture.positions[frame * joints..(frame + 1) * joints] {
        *place += shift;
    }
}

/// A plant moved: its foot stands aside from `start` to `end`, and swings there and back for so many frames.
pub(crate) fn move_plant(capture: &mut Capture, side: Side, (start, end): (usize, usize), swing: usize, shift: DVec3) {
    for frame in start.saturating_sub(swing)..=(end + swing).min(capture.frames() - 1) {
        let out = if frame < start { start - frame } else { frame.saturating_sub(end) };
        shift_foot(capture, frame, side, shift * smooth(1.0 - out as f64 / swing.max(1) as f64));
    }
}

fn put_foot(capture: &mut Capture, frame: usize, side: Side, ankle: DVec3) {
    let roles = [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot, Role::LeftToes];
    let index = |role: Role| {
        let role = if side == Side::Left { role } else { role.mirrored() };
        capture.body.joint(role).expect("the body has legs and toes")
    };
    let [hip, knee, foot, toes] = roles.map(index);
    let rest = |joint: usize| capture.body.joints[joint].rest;
    let (thigh, shank, toe) = (rest(knee) - rest(hip), rest(foot) - rest(knee), rest(toes) - rest(foot));
    let base = frame * capture.body.joints.len();
    let root = capture.positions[base + hip];
    let leg = thigh.length() + shank.length();
    let stretch = (root.distance(ankle) / (0.999 * leg)).max(1.0);
    let solved = two_bone_ik(root, ankle, thigh.length() * stretch, shank.length() * stretch, DVec3::Z, 0.9999);
    capture.positions[base + knee] = solved.middle;
    capture.positions[base + foot] = solved.end;
    capture.positions[base + toes] = solved.end + toe;
    capture.turns[base + hip] = shortest_arc(thigh.normalize(), (solved.middle - root).normalize_or(DVec3::NEG_Y));
    capture.turns[base + knee] =
        shortest_arc(shank.normalize(), (solved.end - solved.middle).normalize_or(DVec3::NEG_Y));
}

/// Left and right exchanged.
pub(crate) fn mirrored(capture: &Capture) -> Capture {
    let body = &capture.body;
    let other: Vec<usize> =
        body.joints.iter().map(|joint| body.joint(joint.role.mirrored()).expect("a symmetric body")).collect();
    let mut made = capture.clone();
    for frame in 0..capture.frames() {
        let base = frame * other.len();
        for (joint, from) in other.iter().enumerate() {
            let (place, turn) = (capture.at(frame)[*from], capture.turns_at(frame)[*from]);
            made.positions[base + joint] = dvec3(-place.x, place.y, place.z);
            made.turns[base + joint] = DQuat::from_xyzw(turn.x, -turn.y, -turn.z, turn.w);
        }
    }
    made
}

/// The same motion of a body of another size, at the rate that gravity gives it.
pub(crate) fn resized(capture: &Capture, scale: f64) -> Capture {
    let mut made = capture.clone();
    made.fps = capture.fps / scale.sqrt();
    made.positions.iter_mut().for_each(|place| *place *= scale);
    let body = &mut made.body;
    body.joints.iter_mut().for_each(|joint| joint.rest *= scale);
    for segment in &mut body.segments {
        segment.centre *= scale;
        segment.inertia *= scale * scale;
    }
    for foot in &mut body.feet {
        for length in [&mut foot.ankle_height, &mut foot.heel, &mut foot.ball, &mut foot.tip, &mut foot.half_width] {
            *length *= scale;
        }
        foot.rear_sole.iter_mut().chain(&mut foot.front_sole).for_each(|point| *point *= scale);
    }
    body.height *= scale;
    body.leg_length *= scale;
    made
}

/// Frames at other times, as shares of frames.
pub(crate) fn at_speed(capture: &Capture, speed: f64) -> Capture {
    let last = capture.frames() - 1;
    let mut made = capture.clone();
    made.positions.clear();
    made.turns.clear();
    for frame in 0..=(last as f64 / speed) as usize {
        let at = (frame as f64 * speed).min(last as f64);
        let (from, to) = (at.floor() as usize, (at.floor() as usize + 1).min(last));
        for joint in 0..capture.body.joints.len() {
            made.positions.push(capture.at(from)[joint].lerp(capture.at(to)[joint], at.fract()));
            made.turns.push(capture.turns_at(from)[joint].slerp(capture.turns_at(to)[joint], at.fract()));
        }
    }
    made
}

//! A walk in the numbers by which gait laboratories describe one: step length, cadence, double support, joint angles.
//!
//! Scenario space on level ground, SI, radians. Events come from the contacts: a foot touches down where a contact of it
//! starts after none, lifts off where the last one ends. Means over whole strides (touchdown to next touchdown of the
//! same foot) inside the span that is asked for. Angles as `joints` reads them; table and spreads of people: see
//! [`Gait::rows`]. Running (no double support) is not described.

use super::{HeldContact, Track, dynamics, joints};
use crate::maths::quat::yaw_of;
use crate::maths::real;
use crate::model::{Role, Side, report::Part};
use glam::{DVec2, DVec3};

/// Means over the strides that were found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gait {
    /// How many strides there were, left and right.
    pub strides: usize,
    /// m/s.
    pub speed: f64,
    /// m, along the way, from where the other foot touched down before.
    pub step_length: f64,
    /// Steps a minute.
    pub cadence: f64,
    /// Share of the stride with both feet down.
    pub double_support: f64,
    /// m, ankle to ankle across the way.
    pub step_width: f64,
    /// m, highest less lowest centre of mass.
    pub com_travel: f64,
    /// rad, half of the pelvis's turning to and fro.
    pub pelvis_rotation: f64,
    /// rad, half of its tilting to and fro.
    pub pelvis_list: f64,
    /// rad, flexion of the hip at touchdown.
    pub hip_contact: f64,
    /// rad, its least flexion.
    pub hip_push_off: f64,
    /// rad, most flexion of the knee in the first quarter of the stride.
    pub knee_loading: f64,
    /// rad, most flexion in the swing.
    pub knee_swing: f64,
    /// rad, most dorsiflexion while the foot stands.
    pub ankle_stance: f64,
    /// rad, least (most plantar) flexion from half of the stance to shortly after lift-off.
    pub ankle_push_off: f64,
    /// rad, toe over heel at touchdown.
    pub strike_pitch: f64,
    /// Share of the stride from touchdown until the foot is flat; 0 where the contacts do not tell.
    pub flat_after: f64,
}

/// One row of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// What and its unit.
    pub name: &'static str,
    /// Measured.
    pub value: f64,
    /// Mean of people.
    pub mean: f64,
    /// Usual spread about it.
    pub spread: f64,
}

/// Measures the strides that lie wholly in `from..to` s; `None` where there are none.
pub fn gait(track: &Track, contacts: &[HeldContact], from: f64, to: f64) -> Option<Gait> {
    let com = dynamics::dynamics(track, &[]).com;
    let events = Side::BOTH.map(|side| stances(contacts, side));
    let mut sum = Gait::default();
    for side in Side::BOTH {
        for pair in events[side as usize].windows(2) {
            let (start, end) = (pair[0].0, pair[1].0);
            if start < from || end > to || end - start < 0.2 {
                continue;
            }
            if let Some(stride) = stride(track, contacts, &com, &events, side, (start, pair[0].1, end)) {
                sum.add(&stride);
            }
        }
    }
    (sum.strides > 0).then(|| sum.mean())
}

impl Gait {
    fn values(&mut self) -> [&mut f64; 16] {
        [
            &mut self.speed,
            &mut self.step_length,
            &mut self.cadence,
            &mut self.double_support,
            &mut self.step_width,
            &mut self.com_travel,
            &mut self.pelvis_rotation,
            &mut self.pelvis_list,
            &mut self.hip_contact,
            &mut self.hip_push_off,
            &mut self.knee_loading,
            &mut self.knee_swing,
            &mut self.ankle_stance,
            &mut self.ankle_push_off,
            &mut self.strike_pitch,
            &mut self.flat_after,
        ]
    }

    fn add(&mut self, stride: &Gait) {
        let mut stride = *stride;
        for (sum, value) in self.values().into_iter().zip(stride.values()) {
            *sum += *value;
        }
        self.strides += 1;
    }

    fn mean(mut self) -> Gait {
        let count = self.strides as f64;
        self.values().into_iter().for_each(|value| *value /= count);
        self
    }

    /// Against adults on level ground (textbook means and spreads), lengths for a leg of `leg` m by Froude's rule.
    pub fn rows(&self, leg: f64) -> Vec<Row> {
        let (size, pace) = (leg / 0.83, (leg / 0.83).sqrt());
        let degrees = f64::to_degrees;
        // At that speed of an ordinary adult, by the walk ratio: length = 0.0065 m a step a minute.
        let speed = self.speed / pace;
        let cadence = (60.0 * speed / 0.0065).sqrt();
        // 24 % at 1.2 m/s falling to 16 % at 1.8, on the same line below.
        let double = 24.0 - (speed - 1.2) * (8.0 / 0.6);
        let row = |name, value, mean, spread| Row { name, value, mean, spread };
        vec![
            row("walk ratio, m per step/min", self.step_length / size / (self.cadence * pace), 0.0065, 0.0006),
            row("step length, m", self.step_length / size, 0.0065 * cadence, 0.05),
            row("cadence, steps/min", self.cadence * pace, cadence, 8.0),
            row("double support, % of cycle", 100.0 * self.double_support, double, 4.0),
            row("step width, m", self.step_width / size, 0.10, 0.03),
            row("CoM vertical travel, cm", 100.0 * self.com_travel / size, 4.0, 1.0),
            row("pelvis rotation, deg", degrees(self.pelvis_rotation), 5.0, 1.0),
            row("pelvis list, deg", degrees(self.pelvis_list), 5.0, 1.0),
            row("hip flexion at contact, deg", degrees(self.hip_contact), 30.0, 6.0),
            row("hip at push-off, deg", degrees(self.hip_push_off), -10.0, 6.0),
            row("knee, loading, deg", degrees(self.knee_loading), 18.0, 6.0),
            row("knee, swing, deg", degrees(self.knee_swing), 60.0, 6.0),
            row("ankle, dorsiflexion, deg", degrees(self.ankle_stance), 10.0, 4.0),
            row("ankle, push-off, deg", degrees(self.ankle_push_off), -18.0, 6.0),
            row("foot pitch at heel strike, deg", degrees(self.strike_pitch), 20.0, 6.0),
            row("flat after, % of cycle", 100.0 * self.flat_after, 10.0, 2.0),
        ]
    }
}

impl Row {
    /// Within the spread?
    pub fn fits(&self) -> bool {
        (self.value - self.mean).abs() <= self.spread + 1e-9
    }
}

/// (touchdown, lift-off) s of one foot: contacts that touch are one stance.
fn stances(contacts: &[HeldContact], side: Side) -> Vec<(f64, f64)> {
    let mut own: Vec<&HeldContact> = contacts.iter().filter(|contact| contact.side == side).collect();
    own.sort_by(|a, b| a.start.total_cmp(&b.start));
    let mut stances: Vec<(f64, f64)> = Vec::new();
    for contact in own {
        match stances.last_mut() {
            Some(last) if contact.start <= last.1 + 1e-3 => last.1 = last.1.max(contact.end),
            _ => stances.push((contact.start, contact.end)),
        }
    }
    stances
}

fn stride(
    track: &Track,
    contacts: &[HeldContact],
    com: &[DVec3],
    events: &[Vec<(f64, f64)>; 2],
    side: Side,
    (start, lift, end): (f64, f64, f64),
) -> Option<Gait> {
    let body = track.motion.body;
    let samples = track.motion.samples_in(start, end);
    if samples.len() < 8 {
        return None;
    }
    let (first, last) = (samples.start, samples.end - 1);
    let length = end - start;
    let flat = |point: DVec3| DVec2::new(point.x, point.z);
    let way = flat(com[last] - com[first]);
    let along = way.try_normalize()?;
    let feet = body.feet.each_ref();
    let ankle = |sample: usize, side: Side| track.positions(sample)[feet[side as usize].ankle];
    // The other foot's touchdown before this one; where it lies outside of the motion, the one after.
    let others = &events[side.other() as usize];
    let from = track.motion.time(0);
    let other = others.iter().rev().find(|(down, _)| *down < start - 1e-6 && *down > from + 1e-6);
    let later = others.iter().find(|(down, _)| *down > start);
    let other_down = track.motion.samples_in(other.or(later)?.0, end).start;
    let apart = flat(ankle(first, side) - ankle(other_down, side.other())) * if other.is_some() { 1.0 } else { -1.0 };
    let both: f64 = events[side.other() as usize]
        .iter()
        .map(|(from, to)| (to.min(lift) - from.max(start)).max(0.0) + (to.min(end) - from.max(end)).max(0.0))
        .sum();
    let span = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |all, v| (all.0.min(v), all.1.max(v)));
        high - low
    };
    let heading = real::atan2(along.x, along.y);
    let pelvis = |sample: usize| track.motion.poses[sample].turns[0];
    let (leg, knee, foot) = match side {
        Side::Left => (Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot),
        Side::Right => (Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot),
    };
    let angles: Vec<[f64; 3]> = samples
        .clone()
        .map(|sample| {
            let all = joints::angles(body, &track.motion.poses[sample]);
            let flexion = |role: Role| {
                all.iter().find(|angle| angle.role == role && angle.axis == "flexion").map_or(0.0, |angle| angle.value)
            };
            [leg, knee, foot].map(flexion)
        })
        .collect();
    let phase = |index: usize| track.motion.time(first + index) - start;
    let stance = lift - start;
    let over = |joint: usize, from: f64, to: f64| {
        angles.iter().enumerate().filter(move |(i, _)| (from..=to).contains(&phase(*i))).map(move |(_, a)| a[joint])
    };
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::NEG_INFINITY, f64::max);
    let least = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
    let flat_from = contacts
        .iter()
        .filter(|contact| contact.side == side && contact.part == Part::Flat && contact.start >= start - 1e-6)
        .map(|contact| contact.start)
        .fold(f64::INFINITY, f64::min);
    let sole = feet[side as usize];
    let ahead = track.motion.poses[first].turns[sole.ankle]
        * (sole.level.inverse() * DVec3::new(sole.forward.x, 0.0, sole.forward.y));
    Some(Gait {
        strides: 1,
        speed: way.length() / length,
        step_length: apart.dot(along),
        cadence: 120.0 / length,
        double_support: both / length,
        step_width: apart.perp_dot(along).abs(),
        com_travel: span(&mut samples.clone().map(|sample| com[sample].y)),
        pelvis_rotation: 0.5
            * span(&mut samples.clone().map(|s| crate::maths::quat::wrap_angle(yaw_of(pelvis(s)) - heading))),
        pelvis_list: 0.5 * span(&mut samples.clone().map(|s| real::asin((pelvis(s) * DVec3::X).y))),
        hip_contact: angles[0][0],
        hip_push_off: least(&mut over(0, 0.3 * length, 0.8 * length)),
        knee_loading: most(&mut over(1, 0.0, 0.25 * length)),
        knee_swing: most(&mut over(1, stance, length)),
        ankle_stance: most(&mut over(2, 0.0, stance)),
        ankle_push_off: least(&mut over(2, 0.5 * stance, stance + 0.1 * length)),
        strike_pitch: real::asin(ahead.y.clamp(-1.0, 1.0)),
        flat_after: if flat_from < lift { (flat_from - start) / length } else { 0.0 },
    })
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;
    use crate::measure::Motion;
    use crate::model::BodyPose;

    #[test]
    fn a_body_carried_along_at_a_known_pace_is_described_by_it() {
        let body = fixture::body();
        let hz = 120.0;
        let poses: Vec<BodyPose> = (0..360)
            .map(|sample| {
                let mut pose = BodyPose::rest(&body);
                pose.hips.z += 1.2 * f64::from(sample) / hz;
                pose.hips.y += 0.02 * real::sin(f64::from(sample) / hz * 4.0 * std::f64::consts::PI);
                pose
            })
            .collect();
        let motion = Motion { body: &body, hz, per_frame: 4, poses: &poses };
        let track = Track::new(motion).expect("a sound motion");
        // Strides of 1 s, each foot down for 0.6 s, half a stride apart: 20 % of the cycle on both feet.
        let held = |side: Side, start: f64| HeldContact {
            side,
            part: Part::Flat,
            start,
            end: start + 0.6,
            point: DVec3::ZERO,
            normal: DVec3::Y,
            frame: super::super::Frame::World,
        };
        let contacts: Vec<HeldContact> =
            (0..3).flat_map(|i| [held(Side::Left, f64::from(i)), held(Side::Right, f64::from(i) - 0.5)]).collect();
        let gait = gait(&track, &contacts, 0.0, 3.0).expect("strides");
        assert!((gait.speed - 1.2).abs() < 0.01 && (gait.cadence - 120.0).abs() < 0.1, "{gait:?}");
        assert!((gait.double_support - 0.2).abs() < 0.01, "{}", gait.double_support);
        assert!((gait.com_travel - 0.04).abs() < 0.003, "{}", gait.com_travel);
        assert!((gait.step_length - 0.6).abs() < 0.02, "half a second apart: {}", gait.step_length);
        assert!(gait.knee_swing.abs() < 1e-6, "the body is rigid");
        assert!(gait.rows(0.83).iter().any(|row| !row.fits()), "nobody walks like that");
    }
}

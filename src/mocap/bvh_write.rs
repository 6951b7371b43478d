//! A BVH file's text with other values in some frames: what is not touched keeps its characters.
//!
//! New values stand in the file's channel order and with as many decimals as its frames have (three at least). Angles are the ones
//! nearest to where the file's own go: the change of a joint's angles goes on smoothly from frame to frame, so that a file without
//! jumps of 360 degrees gets none, and one that has them keeps its own. A joint without position channels keeps its offset; one with
//! fewer than three rotation channels gets the turn nearest to what is wanted.

use super::bvh::{Axis, Bvh};
use crate::maths::real;
use crate::rig::Trs;
use glam::{DMat3, DQuat, DVec3};
use std::collections::BTreeMap;

/// New local transforms by frame and joint, file units; scale is left out.
pub type Edits = BTreeMap<(usize, usize), Trs>;

/// Decimals: at least, at most.
const DECIMALS: (usize, usize) = (3, 12);
/// Near gimbal lock: cosine of the middle angle under which the outer two turn about one axis.
const LOCK: f64 = 1e-7;
/// Steps of the search for the angles of fewer channels.
const STEPS: usize = 40;

/// The text with those edits. `bvh` is `text` parsed. Edits of frames or joints that are not there are left out.
pub fn write(text: &str, bvh: &Bvh, edits: &Edits) -> String {
    let mut values = new_values(bvh, edits).into_iter().peekable();
    let mut written = String::with_capacity(text.len() + 64);
    let (mut copied, mut index) = (0, 0);
    let mut words = Words { text, at: bvh.motion_byte };
    let decimals = decimals(text, bvh);
    while values.peek().is_some() {
        let Some((start, end)) = words.next() else { break };
        if let Some((_, value)) = values.next_if(|(at, _)| *at == index)
            && (value - bvh.values[index]).abs() > 0.5 * 10_f64.powi(-(decimals as i32))
        {
            written.push_str(&text[copied..start]);
            let number = format!("{value:.decimals$}");
            let zero = number.trim_start_matches('-').bytes().all(|byte| matches!(byte, b'0' | b'.'));
            written.push_str(if zero { number.trim_start_matches('-') } else { &number });
            copied = end;
        }
        index += 1;
    }
    written.push_str(&text[copied..]);
    written
}

/// Index into `Bvh::values` to its new value, rising.
fn new_values(bvh: &Bvh, edits: &Edits) -> BTreeMap<usize, f64> {
    let mut values = BTreeMap::new();
    for (&(frame, index), local) in edits {
        if frame >= bvh.frames() || index >= bvh.joints.len() {
            continue;
        }
        let joint = &bvh.joints[index];
        let start = frame * bvh.width + joint.first;
        let old = |at: usize| bvh.values[at];
        let slots: Vec<usize> = (0..joint.channels.len()).filter(|at| is_turn(joint.channels[*at])).collect();
        // Where the file's own angles are, and the change that the frame before has.
        let expected: Vec<f64> = slots
            .iter()
            .map(|slot| {
                let at = start + slot;
                let change = at.checked_sub(bvh.width).and_then(|before| Some(values.get(&before)? - old(before)));
                old(at) + change.unwrap_or(0.0)
            })
            .collect();
        let axes: Vec<usize> = slots.iter().map(|slot| axis_of(joint.channels[*slot])).collect();
        let angles = angles(&axes, local.rotation, &expected);
        for (slot, angle) in slots.iter().zip(angles) {
            values.insert(start + slot, angle);
        }
        for (slot, channel) in joint.channels.iter().enumerate() {
            if let Axis::Position(axis) = channel {
                values.insert(start + slot, local.translation[*axis]);
            }
        }
    }
    values.retain(|_, value| value.is_finite());
    values
}

fn is_turn(channel: Axis) -> bool {
    matches!(channel, Axis::Rotation(_))
}

fn axis_of(channel: Axis) -> usize {
    match channel {
        Axis::Position(axis) | Axis::Rotation(axis) => axis,
    }
}

/// Degrees about those axes, in that order, that make `turn`: of all that do, the nearest to `expected`.
pub fn angles(axes: &[usize], turn: DQuat, expected: &[f64]) -> Vec<f64> {
    let found = match axes {
        [a, b, c] if a != b && b != c && a != c => three(*a, *b, *c, turn, expected),
        _ => search(axes, turn, expected),
    };
    let nearest = |angle: f64, expected: f64| angle + 360.0 * ((expected - angle) / 360.0).round();
    found.into_iter().zip(expected).map(|(angle, expected)| nearest(angle, *expected)).collect()
}

/// R = A(alpha) B(beta) C(gamma) about three different axes, in closed form: two ways, the nearer one.
fn three(a: usize, b: usize, c: usize, turn: DQuat, expected: &[f64]) -> Vec<f64> {
    let matrix = DMat3::from_quat(turn.normalize());
    let at = |row: usize, column: usize| matrix.col(column)[row];
    let even = (a + 1) % 3 == b; // X Y Z and its rotations
    let sign = if even { 1.0 } else { -1.0 };
    let beta = real::asin((sign * at(a, c)).clamp(-1.0, 1.0));
    let apart = |one: f64, other: f64| ((one - other + 180.0).rem_euclid(360.0) - 180.0).abs();
    if (1.0 - at(a, c) * at(a, c)).max(0.0).sqrt() < LOCK {
        // Locked: the first keeps its angle, the third takes the rest.
        let alpha = expected[0].to_radians();
        let rest = (about(a, alpha) * about(b, beta)).inverse() * turn;
        let gamma = 2.0 * real::atan2(DVec3::new(rest.x, rest.y, rest.z)[c], rest.w);
        return vec![expected[0], beta.to_degrees(), gamma.to_degrees()];
    }
    let alpha = real::atan2(-sign * at(b, c), at(c, c));
    let gamma = real::atan2(-sign * at(a, b), at(a, a));
    let one = [alpha, beta, gamma].map(f64::to_degrees);
    let other = [one[0] + 180.0, 180.0 - one[1], one[2] + 180.0];
    let far = |angles: &[f64; 3]| angles.iter().zip(expected).map(|(x, y)| apart(*x, *y).powi(2)).sum::<f64>();
    if far(&other) < far(&one) { other.to_vec() } else { one.to_vec() }
}

/// Any number of axes: Gauss-Newton from `expected`, damped.
fn search(axes: &[usize], turn: DQuat, expected: &[f64]) -> Vec<f64> {
    let mut angles: Vec<f64> = expected.iter().map(|angle| angle.to_radians()).collect();
    for _ in 0..STEPS {
        let mut globals = Vec::with_capacity(axes.len());
        let mut made = DQuat::IDENTITY;
        for (axis, angle) in axes.iter().zip(&angles) {
            globals.push(made * DVec3::AXES[*axis]);
            made *= about(*axis, *angle);
        }
        let off = turn * made.inverse();
        let off = if off.w < 0.0 { -off } else { off }.to_scaled_axis();
        if off.length() < 1e-12 {
            break;
        }
        // (J Jt + damping) y = off; step = Jt y.
        let mut normal = DMat3::from_diagonal(DVec3::splat(1e-6));
        for axis in &globals {
            normal += DMat3::from_cols(*axis * axis.x, *axis * axis.y, *axis * axis.z);
        }
        let y = normal.inverse() * off;
        for (angle, axis) in angles.iter_mut().zip(&globals) {
            *angle += axis.dot(y);
        }
    }
    angles.into_iter().map(f64::to_degrees).collect()
}

fn about(axis: usize, angle: f64) -> DQuat {
    DQuat::from_axis_angle(DVec3::AXES[axis], angle)
}

/// Decimals of the first frame's values: the most that one has.
fn decimals(text: &str, bvh: &Bvh) -> usize {
    let mut words = Words { text, at: bvh.motion_byte };
    let mut most = DECIMALS.0;
    for _ in 0..bvh.width {
        let Some((start, end)) = words.next() else { break };
        let word = &text[start..end];
        let places = match (word.find(['e', 'E']), word.find('.')) {
            (Some(_), _) => 6,
            (None, Some(point)) => word.len() - point - 1,
            (None, None) => 0,
        };
        most = most.max(places);
    }
    most.min(DECIMALS.1)
}

/// Where the words of the motion stand, blanks as the parser knows them.
struct Words<'a> {
    text: &'a str,
    at: usize,
}

impl Words<'_> {
    fn next(&mut self) -> Option<(usize, usize)> {
        let bytes = self.text.as_bytes();
        let blank = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\r' | b'\n');
        let start = self.at + bytes[self.at..].iter().position(|byte| !blank(byte))?;
        let end = bytes[start..].iter().position(blank).map_or(bytes.len(), |length| start + length);
        self.at = end;
        Some((start, end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::seed::Seed;

    const TEXT: &str = "HIERARCHY\r\nROOT Hips\r\n{\r\n OFFSET 0 0 0\r\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\r\n\
        JOINT Knee\r\n{ OFFSET 0 -3 0\r\n CHANNELS 1 Xrotation\r\n End Site\r\n { OFFSET 0 -3 0 } } }\r\n\
        MOTION\r\nFrames: 3\r\nFrame Time: 0.04\r\n1\t2.000  3.10 179.0 0 10 45\r\n1 2 3 -179.0 0 11 46.5\r\n1 2 3 -177 0 +12 48\r\n";

    fn turn_of(axes: &[usize], degrees: &[f64]) -> DQuat {
        axes.iter().zip(degrees).fold(DQuat::IDENTITY, |turn, (axis, angle)| turn * about(*axis, angle.to_radians()))
    }

    #[test]
    fn without_edits_every_byte_stays_and_with_one_only_its_words_change() {
        let bvh = Bvh::parse("t.bvh", TEXT).expect("a file");
        assert_eq!(write(TEXT, &bvh, &Edits::new()), TEXT);
        let same: Edits = (0..3)
            .flat_map(|frame| (0..3).map(move |joint| (frame, joint)))
            .map(|at| (at, bvh.local(at.0, at.1)))
            .collect();
        assert_eq!(write(TEXT, &bvh, &same), TEXT, "what is the same keeps its characters");
        let mut moved = bvh.local(1, 0);
        moved.translation.y += 0.25;
        let text = write(TEXT, &bvh, &Edits::from([((1, 0), moved)]));
        assert_eq!(text, TEXT.replace("1 2 3 -179.0 0 11 46.5", "1 2.250 3 -179.0 0 11 46.5"));
    }

    #[test]
    fn angles_go_on_where_the_files_own_go_and_do_not_jump() {
        let bvh = Bvh::parse("t.bvh", TEXT).expect("a file");
        let mut edits = Edits::new();
        for frame in 0..3 {
            let mut local = bvh.local(frame, 0);
            local.rotation = DQuat::from_rotation_z(4_f64.to_radians()) * local.rotation;
            edits.insert((frame, 0), local);
            // A hinge that should turn about Y too can only bend.
            let knee = turn_of(&[1, 0], &[3.0, 50.0 + frame as f64]);
            edits.insert((frame, 1), Trs { rotation: knee, ..Trs::IDENTITY });
        }
        let after = Bvh::parse("t.bvh", &write(TEXT, &bvh, &edits)).expect("a file");
        let z: Vec<f64> = (0..3).map(|frame| after.values[frame * 7 + 3]).collect();
        assert_eq!(z, [183.0, -175.0, -173.0], "the file's own jump stays where it was, and no other comes");
        for frame in 0..3 {
            assert!(after.local(frame, 0).rotation.angle_between(edits[&(frame, 0)].rotation) < 1e-4);
            assert!((after.values[frame * 7 + 6] - (50.0 + frame as f64)).abs() < 0.2);
        }
    }

    #[test]
    fn every_order_of_three_axes_gives_the_turn_back() {
        let mut random = Seed::new(5);
        for axes in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0], [2, 0, 2]] {
            for round in 0..200 {
                let mut wanted: Vec<f64> = (0..3).map(|_| random.between(-180.0, 180.0)).collect();
                if round % 10 == 0 {
                    wanted[1] = 90.0; // locked
                }
                if axes == [2, 0, 2] && real::sin(wanted[1].to_radians()).abs() < 0.1 {
                    continue; // locked there
                }
                let turn = turn_of(&axes, &wanted);
                let near: Vec<f64> = wanted.iter().map(|angle| angle + random.between(-5.0, 5.0)).collect();
                let found = angles(&axes, turn, &near);
                let off = turn_of(&axes, &found).angle_between(turn).to_degrees();
                assert!(off < 1e-3, "{axes:?} {wanted:?} -> {found:?}: {off} degrees off");
                let far = found.iter().zip(&near).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(far < 30.0 || wanted[1].abs() > 80.0 || axes == [2, 0, 2], "{axes:?} {wanted:?} -> {found:?}");
            }
        }
    }
}

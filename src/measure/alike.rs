//! Which clips look the same: a signature of each motion, and the ones that an earlier one resembles.
//!
//! A signature holds the places of six joints at fixed times from the start, over the body's height: heights, not metres, f32.
//! Two clips differ by the root mean square over the joints at the moment where that is largest, so a step that only one of
//! them takes is not diluted by seconds of standing. After its end a clip holds its last pose. Compare clips of one body
//! only; what they are called, what pushed them and what their contacts say is left out.

use crate::model::{Body, Role};
use glam::DVec3;

/// The joints that are looked at.
const JOINTS: [Role; 6] = [Role::Hips, Role::Head, Role::LeftHand, Role::RightHand, Role::LeftFoot, Role::RightFoot];
/// Numbers a moment.
const WIDTH: usize = 3 * JOINTS.len();
/// s, between moments, through [`EVEN`] of them; then ever longer, to a minute.
const EVERY: f64 = 0.125;
const EVEN: usize = 56;
const LATER: usize = 18;
const GROWTH: f64 = 1.13;

/// What still passes for the same, of the height: 2 cm of 1.7 m.
pub const ALIKE: f64 = 0.02 / 1.7;

/// The moments of a signature, s.
pub fn moments() -> impl Iterator<Item = f64> {
    let last = EVERY * (EVEN - 1) as f64;
    let even = (0..EVEN).map(|at| EVERY * at as f64);
    even.chain((1..=LATER).map(move |at| last * GROWTH.powi(at as i32)))
}

/// The signature of a motion of a body: `places` gives (body joints) m at a time, s, and is asked in rising order. Empty,
/// and like no other, where a place is no number.
pub fn signature(body: &Body, duration: f64, mut places: impl FnMut(f64) -> Vec<DVec3>) -> Vec<f32> {
    let height = if body.height > 1e-6 { body.height } else { 1.0 };
    // A joint that the body lacks is where the next one up is.
    let joint = |role: Role| {
        let mut at = Some(role);
        while let Some(role) = at {
            if let Some(joint) = body.joint(role) {
                return joint;
            }
            at = role.parent();
        }
        0
    };
    let joints = JOINTS.map(joint);
    let end = if duration.is_finite() { duration.max(0.0) } else { 0.0 };
    let mut signature: Vec<f32> = Vec::with_capacity(WIDTH * (EVEN + LATER));
    let mut held = false;
    for time in moments() {
        if held {
            // The last pose.
            signature.extend_from_within(signature.len() - WIDTH..);
            continue;
        }
        let all = places(time.min(end));
        for joint in joints {
            let place = all.get(joint).copied().unwrap_or(DVec3::NAN) / height;
            if !place.is_finite() {
                return Vec::new();
            }
            signature.extend(place.to_array().map(|value| value as f32));
        }
        held = time >= end;
    }
    signature
}

/// How far two signatures are apart, of the height; infinite where they cannot be compared.
pub fn difference(one: &[f32], other: &[f32]) -> f64 {
    if one.len() != other.len() || one.is_empty() {
        return f64::INFINITY;
    }
    let moments = one.chunks(WIDTH).zip(other.chunks(WIDTH));
    f64::from(moments.map(|(a, b)| apart(a, b)).fold(0.0, f32::max)).sqrt()
}

/// The mean square over the joints at a moment.
fn apart(one: &[f32], other: &[f32]) -> f32 {
    let squares = one.iter().zip(other).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f32>() / JOINTS.len() as f32
}

/// For each signature the first one that it resembles to within `limit` (of the height) and that resembles none itself.
/// So chains do not grow: each is within the limit of the one that is named.
pub fn near_duplicates(signatures: &[Vec<f32>], limit: f64) -> Vec<Option<usize>> {
    let mut found = vec![None; signatures.len()];
    let keys = telling(signatures);
    // If the mean over six joints is within the limit, no single number is out by more than this.
    let most = (limit * (JOINTS.len() as f64).sqrt() * (1.0 + 1e-5)) as f32;
    let square = (limit * limit) as f32;
    let pick = |signature: &[f32]| keys.map(|key| signature.get(key).copied().unwrap_or(0.0));
    // Those that resemble none before them, by the most telling number.
    let mut originals: Vec<([f32; KEYS], usize)> = Vec::new();
    for (index, signature) in signatures.iter().enumerate() {
        if signature.is_empty() {
            continue;
        }
        let own = pick(signature);
        let from = originals.partition_point(|(other, _)| other[0] < own[0] - most);
        let near = originals[from..].iter().take_while(|(other, _)| other[0] <= own[0] + most);
        let like =
            near.filter(|(other, _)| other.iter().zip(&own).all(|(a, b)| (a - b).abs() <= most)).filter(|(_, at)| {
                let other = &signatures[*at];
                other.len() == signature.len()
                    && signature.chunks(WIDTH).zip(other.chunks(WIDTH)).all(|(a, b)| apart(a, b) <= square)
            });
        found[index] = like.map(|(_, at)| *at).min();
        if found[index].is_none() {
            let place = originals.partition_point(|(other, _)| other[0] < own[0]);
            originals.insert(place, (own, index));
        }
    }
    found
}

/// Numbers that are looked at before all others.
const KEYS: usize = 6;

/// The numbers in which signatures differ the most, no two of one moment.
fn telling(signatures: &[Vec<f32>]) -> [usize; KEYS] {
    let length = signatures.iter().map(Vec::len).max().unwrap_or(0);
    let same: Vec<&Vec<f32>> = signatures.iter().filter(|signature| signature.len() == length).collect();
    let stride = same.len().div_ceil(2000).max(1);
    let spread = |at: usize| {
        let (mut sum, mut square, mut count) = (0.0, 0.0, 0.0);
        for signature in same.iter().step_by(stride) {
            let value = f64::from(signature[at]);
            (sum, square, count) = (sum + value, square + value * value, count + 1.0);
        }
        square - sum * sum / f64::max(count, 1.0)
    };
    let mut order: Vec<(f64, usize)> = (0..length).map(|at| (spread(at), at)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut keys: Vec<usize> = Vec::new();
    for (_, at) in order {
        if keys.len() < KEYS && keys.iter().all(|key| key / WIDTH != at / WIDTH) {
            keys.push(at);
        }
    }
    std::array::from_fn(|at| keys.get(at).copied().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::seed::Seed;
    use crate::measure::fixture;

    /// A body whose hips go to the left by `far` m within a second, with a step of a foot between.
    fn swayed(far: f64, step: f64) -> Vec<f32> {
        let body = fixture::body();
        let foot = body.joint(Role::LeftFoot).expect("a foot");
        signature(&body, 3.0, |time| {
            let moved = DVec3::X * far * time.min(1.0);
            let mut places: Vec<DVec3> = body.joints.iter().map(|joint| joint.rest + moved).collect();
            if (1.0..1.3).contains(&time) {
                places[foot] += DVec3::Y * step;
            }
            places
        })
    }

    #[test]
    fn motions_within_the_limit_are_found_and_others_are_not() {
        let height = fixture::body().height;
        let within = |part: f64| part * ALIKE * height;
        let all = [swayed(0.3, 0.0), swayed(0.3 + within(0.9), 0.0), swayed(0.3 + within(1.2), 0.0), swayed(0.3, 0.0)];
        assert!((difference(&all[0], &all[1]) - 0.9 * ALIKE).abs() < 1e-5, "{}", difference(&all[0], &all[1]));
        // The third is near the second, but that one is no original.
        assert_eq!(near_duplicates(&all, ALIKE), [None, Some(0), None, Some(0)]);
    }

    #[test]
    fn one_short_step_tells_two_motions_apart() {
        let all = [swayed(0.3, 0.0), swayed(0.3, 0.10)];
        assert!(difference(&all[0], &all[1]) > 1.5 * ALIKE, "{}", difference(&all[0], &all[1]));
        assert_eq!(near_duplicates(&all, ALIKE), [None, None]);
    }

    #[test]
    fn broken_or_missing_motions_are_like_none() {
        let body = fixture::body();
        let broken = signature(&body, 3.0, |_| vec![DVec3::NAN; body.joints.len()]);
        assert!(broken.is_empty() && signature(&body, 1.0, |_| Vec::new()).is_empty());
        assert_eq!(near_duplicates(&[broken.clone(), broken], ALIKE), [None, None]);
        assert_eq!(
            near_duplicates(&[vec![0.0; WIDTH], vec![0.0; 2 * WIDTH], vec![0.0; WIDTH]], 1.0)[1..],
            [None, Some(0)]
        );
        assert!(near_duplicates(&[], 1.0).is_empty());
    }

    #[test]
    fn a_shorter_clip_that_stands_at_its_end_is_like_a_longer_one() {
        let body = fixture::body();
        let places = |time: f64| body.joints.iter().map(|joint| joint.rest + DVec3::Z * time.min(1.0)).collect();
        let (short, long) = (signature(&body, 2.0, places), signature(&body, 5.0, places));
        assert!(difference(&short, &long) < 1e-7 && short.len() == long.len());
    }

    /// A cloud of random signatures: `groups` well apart, each with `size` that differ by less than the limit.
    fn cloud(groups: usize, size: usize, within: f64) -> Vec<Vec<f32>> {
        let mut seed = Seed::new(7);
        let length = WIDTH * (EVEN + LATER);
        let centres: Vec<Vec<f32>> =
            (0..groups).map(|_| (0..length).map(|_| seed.between(-0.4, 0.4) as f32).collect()).collect();
        let mut all = Vec::new();
        for _ in 0..size {
            for centre in &centres {
                let by = seed.between(0.0, within) as f32;
                all.push(centre.iter().map(|value| value + by).collect());
            }
        }
        all
    }

    #[test]
    fn agrees_with_comparing_each_with_each() {
        let mut all = cloud(40, 6, 2.0 * ALIKE);
        all.push(Vec::new());
        let quick = near_duplicates(&all, ALIKE);
        let mut slow: Vec<Option<usize>> = Vec::new();
        for index in 0..all.len() {
            let like =
                (0..index).find(|other| slow[*other].is_none() && difference(&all[*other], &all[index]) <= ALIKE);
            slow.push(like);
        }
        let originals = slow.iter().filter(|like| like.is_none()).count();
        assert!((41..160).contains(&originals), "{originals} originals: the test must have both kinds");
        assert_eq!(quick, slow);
    }

    #[test]
    fn ten_thousand_take_a_moment_not_a_minute() {
        // Each with each would be 5e7 comparisons; the worst case for a search by one number is a narrow cloud.
        let all = cloud(2000, 1, 0.0);
        let narrow = |at: usize| all[at % 2000].iter().map(|value| value * 0.1 + (at / 2000) as f32 * 1e-4).collect();
        let narrow: Vec<Vec<f32>> = (0..10_000).map(narrow).collect();
        let started = std::time::Instant::now();
        let found = near_duplicates(&narrow, ALIKE * 0.2);
        let took = started.elapsed().as_secs_f64();
        assert!((0..10_000).all(|at| found[at] == (at >= 2000).then_some(at % 2000)), "each is like its own");
        assert!(took < 10.0, "{took:.1} s; 0.1 s on a machine at rest");
    }
}

//! Clips that are keyed for effect all through: what they show is not a fault in a motion but another kind of motion.
//!
//! Clip space, SI. Two signs, each of the whole clip. Blows: where a good part of it is blows or throws of the body, what leads into them and
//! out of them belongs to them. Balance: where the ground would have to push far outside of the feet in a good part of the frames in which
//! the body moves. One fault is one span: so the worst second is left out of that count, and what is left must still be as bad. Only a clip that
//! is too short to have another half, and shows no gait, is judged with it.

use super::balance::Balance;
use super::domain::{Domain, Reason};
use super::track::Track;
use crate::model::findings::{ClipFlag, Rule};

/// Of the frames: more blows make a fight of the whole clip, where no gait is judged.
const BLOWS: f64 = 0.33;
/// m at a leg of 0.83 m: a ZMP that far out is no error of measurement.
const FAR: f64 = 0.17;
/// Of the moving frames without the worst span: captured walkers, with any one fault planted, have up to 0.18.
const THROUGHOUT: f64 = 0.22;
/// The same of a clip that is shorter than twice such a span, with it.
const MOSTLY: f64 = 0.25;
/// s: as long is one fault, with what leads to it and away from it.
const FAULT: f64 = 1.2;
/// Of the frames: where more show a body that something else carries, it may do so in the others.
const CARRIED: f64 = 0.25;
/// m/s at a leg of 0.83 m: the centre of mass moves.
const MOVES: f64 = 0.05;
/// s: a body that moves for less shows nothing.
const LEAST: f64 = 0.25;
/// Judged steps that are a gait.
const GAIT: usize = 2;

/// What a clip is, if it is keyed all through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Keyed {
    /// Blows and what belongs to them.
    Fight,
    /// Not physical: in that share of the moving frames nothing could balance.
    Unphysical(f64),
}

/// Looks at the whole clip, of which so many steps were judged.
pub fn keyed(track: &Track, domain: &Domain, balance: &[Option<Balance>], steps: usize) -> Option<Keyed> {
    let frames = track.len();
    let violent = |frame: &usize| matches!(domain.reasons[*frame], Some(Reason::Action | Reason::Thrown));
    let blows = (0..frames).filter(violent).count();
    if steps < GAIT && blows as f64 > BLOWS * frames as f64 {
        return Some(Keyed::Fight);
    }
    let carried = |frame: &usize| {
        matches!(domain.reasons[*frame], Some(Reason::Low | Reason::Hands | Reason::Unsupported | Reason::NoFloor))
    };
    if (0..frames).filter(carried).count() as f64 > CARRIED * frames as f64 {
        return None;
    }
    let moves = |frame: usize| {
        let upright = domain.reasons[frame].is_none() || violent(&frame);
        upright && track.velocity[frame].length() > MOVES * track.tempo()
    };
    let far =
        |frame: usize| balance[frame].filter(|_| moves(frame)).is_some_and(|found| found.out > FAR * track.size());
    let seen: Vec<bool> = (0..frames).map(|frame| moves(frame) && balance[frame].is_some()).collect();
    let out: Vec<bool> = (0..frames).map(far).collect();
    let count = |list: &[bool]| list.iter().filter(|set| **set).count();
    let (all, bad) = (count(&seen), count(&out));
    if (all as f64) < LEAST * track.capture.fps {
        return None;
    }
    let fault = (FAULT * track.capture.fps).round() as usize;
    if frames < 2 * fault {
        let share = bad as f64 / all as f64;
        return (steps < GAIT && share > MOSTLY).then_some(Keyed::Unphysical(share));
    }
    let worst = (0..=frames - fault).map(|from| (count(&out[from..from + fault]), from)).max()?;
    let left = all - count(&seen[worst.1..worst.1 + fault]);
    let share = (bad - worst.0) as f64 / left.max(1) as f64;
    (left as f64 >= LEAST * track.capture.fps && share > THROUGHOUT).then_some(Keyed::Unphysical(share))
}

impl Keyed {
    /// Says nothing of any frame of the clip.
    pub fn silence(self, domain: &mut Domain) {
        let count = |wanted: Reason| domain.reasons.iter().filter(|reason| **reason == Some(wanted)).count();
        let violent = [Some(Reason::Action), Some(Reason::Thrown)];
        let fight = self == Keyed::Fight;
        let reason = match fight {
            true if count(Reason::Thrown) > count(Reason::Action) => Reason::Thrown,
            true => Reason::Action,
            false => Reason::Keyed,
        };
        for slot in &mut domain.reasons {
            // Blows keep their own word among blows.
            if matches!(slot, None | Some(Reason::Hands)) || (!fight && violent.contains(slot)) {
                *slot = Some(reason);
            }
        }
    }

    /// What is told of the whole clip: a fight is a fight.
    pub fn mark(self, track: &Track) -> Option<ClipFlag> {
        let Keyed::Unphysical(share) = self else { return None };
        Some(ClipFlag {
            rule: Rule::Balance,
            severity: (0.5 + share).min(1.0),
            why: format!(
                "keyed, not physical: in {:.0} % of the frames in which the body moves the ground would have to push over {:.0} cm outside of the feet; no frame of it is judged by itself",
                100.0 * share,
                100.0 * FAR * track.size()
            ),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::fixture::{Gait, shift_all, stand, walk};
    use crate::audit::{AuditOptions, audit};
    use crate::maths::real;
    use crate::model::Capture;
    use glam::DVec3;

    /// Everything above the ankles goes to and fro by so many metres within so many frames from one on: no feet could do that.
    fn shaken(capture: &mut Capture, (start, end): (usize, usize), metres: f64) {
        for frame in start..=end {
            let way = metres * real::sin(0.35 * (frame - start) as f64);
            let joints = capture.body.joints.len();
            let feet = capture.body.feet.each_ref().map(|foot| (foot.ankle, foot.toe));
            shift_all(capture, frame, DVec3::X * way);
            for joint in feet.into_iter().flat_map(|(ankle, toe)| std::iter::once(ankle).chain(toe)) {
                capture.positions[frame * joints + joint].x -= way;
            }
        }
    }

    #[test]
    fn a_clip_that_is_shaken_all_through_is_one_word_and_one_that_is_shaken_once_is_told_where() {
        let clean = stand(6.0);
        let last = clean.frames() - 1;
        let mut thrown = clean.clone();
        shaken(&mut thrown, (0, last), 0.06);
        let found = audit(&thrown, &AuditOptions::default());
        assert!(found.flags.is_empty(), "{:?}", found.flags);
        assert_eq!(found.clip_flags.len(), 1);
        assert!(found.clip_flags[0].why.contains("not physical"), "{:?}", found.clip_flags);
        assert_eq!((found.abstained[0].start, found.abstained[0].end), (0, last), "{:?}", found.abstained);
        assert!(found.abstained[0].why.contains("keyed"));

        let mut once = clean;
        let middle = last / 2;
        shaken(&mut once, (middle, middle + 40), 0.06);
        let found = audit(&once, &AuditOptions::default());
        assert!(found.clip_flags.is_empty(), "{:?}", found.clip_flags);
        assert!(!found.flags.is_empty());
        assert!(
            found.flags.iter().all(|flag| flag.start + 12 >= middle && flag.end <= middle + 52),
            "{:?}",
            found.flags
        );
    }

    #[test]
    fn one_fault_in_a_walk_is_no_style() {
        let mut capture = walk(Gait::default());
        shaken(&mut capture, (150, 200), 0.06);
        let found = audit(&capture, &AuditOptions::default());
        assert!(found.clip_flags.is_empty(), "{:?}", found.clip_flags);
        assert!(found.flags.iter().any(|flag| flag.rule == Rule::Balance), "{:?}", found.flags);
    }
}

//! Findings to a corrected clip: what was flagged is repaired, the rest stays as it was to the bit.
//!
//! The way of a correction: the audit's flags -> one pass a rule, each a file of its own ([`heights`], [`slides`], [`placement`],
//! [`balance`], [`flight`]), that proposes [`Fix`]es: spans of frames posed anew ([`posing`]) -> the audit again -> what made its span no
//! cleaner, or raised a flag where none was, is taken back ([`verdict`]). What a pass may touch is the flagged span and the swings beside
//! it that must lead there and away. Clip space (metres, Y up), SI; frames count from 0. [`locals`] leads back to the file's own nodes, [`told`]
//! to what a baked clip tells of itself.
//! Leaves out: arms (they ride on the pelvis), and ground that is not level.

pub mod balance;
pub mod flight;
pub mod heights;
mod leave;
pub mod locals;
pub mod placement;
pub mod posing;
pub mod retime;
pub mod seen;
pub mod slides;
pub mod told;
mod verdict;

pub use leave::Target;

use crate::audit::{AuditOptions, audit};
use crate::model::findings::{Findings, Flag, Rule};
use crate::model::{Capture, Side};
use posing::Piece;
use seen::with_seen;
use std::collections::BTreeMap;

/// Passes over the whole list of rules at most.
const ROUNDS: usize = 3;
/// Proposals for one flag that are tried, one after the other.
const ATTEMPTS: usize = 3;

/// Of the leg's length: no repair moves a foot or the pelvis farther.
const FARTHEST: f64 = 0.5;

/// What a person may set.
#[derive(Clone, Debug, Default)]
pub struct CorrectOptions {
    /// How the clip is judged.
    pub audit: AuditOptions,
    /// Rules whose flags are repaired; all of them if empty.
    pub only: Vec<Rule>,
    /// A clip that plays at the wrong speed may get another frame rate.
    pub retime: bool,
    /// Flags that stay as they are: nothing is done about them, and no repair is judged by them.
    pub leave: Vec<Target>,
}

/// A corrected clip.
#[derive(Clone, Debug)]
pub struct Corrected {
    /// The motion; frames that are not in `changed` are the source's, bit for bit.
    pub capture: Capture,
    /// Frame to the joints of it that were turned or moved anew relative to their parents.
    pub changed: BTreeMap<usize, Vec<usize>>,
    /// What was found before.
    pub before: Findings,
    /// What is found now.
    pub after: Findings,
    /// What was done, in order.
    pub done: Vec<Done>,
    /// m: how far the point of the sole that bears goes, in the contacts whose foot was held; the worst.
    pub slip: f64,
    /// By how much faster the clip plays now; 1 unless it was retimed.
    pub speed: f64,
    /// Sentences for a person: what could not be mended, and why.
    pub notes: Vec<String>,
}

/// One repair that stayed.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Done {
    /// First frame that it touches.
    pub start: usize,
    /// Last.
    pub end: usize,
    /// The rule whose flag it answers.
    pub rule: Rule,
    /// Of one foot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub foot: Option<&'static str>,
    /// m: the farthest that a foot or the pelvis went.
    pub moved_m: f64,
    /// A sentence for a person.
    pub what: String,
    /// Contacts whose foot is held, frames.
    #[serde(skip)]
    pub held: Vec<(Side, usize, usize)>,
    /// The flags that it answers. With these in [`CorrectOptions::leave`] it is not done.
    #[serde(skip)]
    pub answers: Vec<Target>,
}

/// A proposal: frames posed anew.
#[derive(Clone, Debug)]
pub struct Fix {
    /// The frames.
    pub piece: Piece,
    /// Which flags it answers; the first names it.
    pub flags: Vec<Flag>,
    /// m: the farthest that a foot or the pelvis goes.
    pub moved: f64,
    /// A sentence.
    pub what: String,
    /// Contacts whose foot it holds.
    pub held: Vec<(Side, usize, usize)>,
}

/// A pass over the flags of some rules.
#[derive(Clone, Copy, PartialEq)]
enum Pass {
    /// Penetration and float.
    Heights,
    /// Balance, where the pelvis's own path is what is odd.
    Body,
    /// Foot-slide and drift.
    Slides,
    /// Foot-placement.
    Plants,
    /// Balance, whatever is left of it.
    Balance,
    /// Ballistic.
    Flights,
}

/// What moves the whole body comes first: feet are judged by where the body is.
const ORDER: [Pass; 6] = [Pass::Heights, Pass::Body, Pass::Slides, Pass::Plants, Pass::Balance, Pass::Flights];

impl Pass {
    fn rules(self) -> &'static [Rule] {
        match self {
            Pass::Heights => &[Rule::Penetration, Rule::Float],
            Pass::Slides => &[Rule::FootSlide, Rule::Drift],
            Pass::Plants => &[Rule::FootPlacement],
            Pass::Body | Pass::Balance => &[Rule::Balance],
            Pass::Flights => &[Rule::Ballistic],
        }
    }
}

/// Corrects a clip.
pub fn correct(source: &Capture, options: &CorrectOptions) -> Corrected {
    let before = audit(source, &options.audit);
    let (mut capture, mut after, mut speed) = (source.clone(), before.clone(), 1.0);
    let mut notes = Vec::new();
    if let Some(faster) = retime::speed(source, &before, options.audit.floor) {
        if options.retime && wanted(options, Rule::Timing) {
            match retime::retimed(source, &before, &options.audit) {
                Some((clip, found)) => (speed, capture, after) = (clip.fps / source.fps, clip, found),
                None => notes.push(format!(
                    "playing {faster:.2} times as fast would not mend the clip's timing: it keeps its speed"
                )),
            }
        } else {
            notes.push(format!(
                "the clip plays at {:.2} of its speed; --retime gives it another frame rate",
                1.0 / faster
            ));
        }
    }
    let known = after.clone();
    let mut done: Vec<Done> = Vec::new();
    for _ in 0..ROUNDS {
        let count = done.len();
        for pass in ORDER {
            let rules: Vec<Rule> = pass.rules().iter().copied().filter(|rule| wanted(options, *rule)).collect();
            for attempt in 0..ATTEMPTS {
                let open = leave::open(&after, options);
                if !open.flags.iter().any(|flag| rules.contains(&flag.rule)) {
                    break;
                }
                let fixes = propose(&capture, &open, pass, &rules, attempt, options.audit.floor);
                let kept = verdict::apply(&mut capture, &mut after, &known, fixes, options);
                done.extend(kept);
            }
        }
        if done.len() == count || after.flags.iter().all(|flag| options.leaves(flag)) {
            break;
        }
    }
    for flag in after.flags.iter().filter(|flag| wanted(options, flag.rule) && !options.leaves(flag)) {
        notes.push(format!("frames {}-{}: could not mend that {}", flag.start, flag.end, flag.why));
    }
    for flag in after.clip_flags.iter().filter(|flag| flag.rule == Rule::Balance && wanted(options, flag.rule)) {
        notes.push(format!("{}: nothing in it was corrected", flag.why));
    }
    let changed = changed(source, &capture);
    restore(source, &mut capture, &changed);
    let slip = slip(&capture, &done, options.audit.floor);
    Corrected { capture, changed, before, after, done, slip, speed, notes }
}

/// What was changed by nothing that counts is the source's again, bit for bit.
fn restore(source: &Capture, capture: &mut Capture, changed: &BTreeMap<usize, Vec<usize>>) {
    let joints = source.body.joints.len();
    for frame in (0..source.frames()).filter(|frame| !changed.contains_key(frame)) {
        let range = frame * joints..(frame + 1) * joints;
        capture.positions[range.clone()].copy_from_slice(&source.positions[range.clone()]);
        capture.turns[range.clone()].copy_from_slice(&source.turns[range]);
    }
}

/// m: the worst of the contacts that were held.
fn slip(capture: &Capture, done: &[Done], floor: Option<f64>) -> f64 {
    let held: Vec<_> = done.iter().flat_map(|done| &done.held).collect();
    if held.is_empty() {
        return 0.0;
    }
    with_seen(capture, floor, |seen| {
        let slips = held.iter().filter_map(|(side, start, end)| {
            let contact = &seen.feet.contacts[seen.contact(*side, *start, *end)?];
            Some(slides::slip(seen, contact, *start, *end))
        });
        slips.fold(0.0, f64::max)
    })
    .unwrap_or(0.0)
}

fn wanted(options: &CorrectOptions, rule: Rule) -> bool {
    options.only.is_empty() || options.only.contains(&rule)
}

/// Fixes that do not meet: where two do, the earlier flag's is proposed.
fn propose(
    capture: &Capture,
    findings: &Findings,
    pass: Pass,
    rules: &[Rule],
    attempt: usize,
    floor: Option<f64>,
) -> Vec<Fix> {
    with_seen(capture, floor, |seen| {
        let mut fixes: Vec<Fix> = match pass {
            Pass::Heights => heights::fixes(seen, findings, rules, attempt),
            Pass::Slides => slides::fixes(seen, findings, rules, attempt),
            Pass::Plants => placement::fixes(seen, findings, attempt),
            Pass::Body => balance::fixes(seen, findings, attempt, true),
            Pass::Balance => balance::fixes(seen, findings, attempt, false),
            Pass::Flights => flight::fixes(seen, findings, attempt),
        };
        // What would have to go farther is no clip with a fault but another motion; flights and plants have bounds of their own.
        let most = FARTHEST * capture.body.leg_length;
        fixes.retain(|fix| fix.moved < most || matches!(pass, Pass::Flights | Pass::Plants));
        fixes.sort_by_key(|fix| fix.piece.start);
        let mut free = 0;
        fixes.retain(|fix| {
            let clear = fix.piece.start >= free;
            if clear {
                free = fix.piece.end() + 1;
            }
            clear
        });
        fixes
    })
    .unwrap_or_default()
}

/// Flags of a rule, those of one fault together: no more than so many frames apart.
fn flag_group(flags: &[Flag], rule: Rule, join: usize) -> Vec<Vec<Flag>> {
    let mut groups: Vec<Vec<Flag>> = Vec::new();
    for flag in flags.iter().filter(|flag| flag.rule == rule) {
        match groups.last_mut() {
            Some(group) if group.iter().any(|last| flag.start <= last.end + join) => group.push(flag.clone()),
            _ => groups.push(vec![flag.clone()]),
        }
    }
    groups
}

/// Joints whose turn relative to their parent is another, and the hips where they are elsewhere.
fn changed(source: &Capture, capture: &Capture) -> BTreeMap<usize, Vec<usize>> {
    const SAME: f64 = 1e-9; // m, and the sine of half an angle
    let body = &source.body;
    let mut changed = BTreeMap::new();
    for frame in 0..source.frames().min(capture.frames()) {
        let (was, is) = (source.turns_at(frame), capture.turns_at(frame));
        let joints: Vec<usize> = (0..body.joints.len())
            .filter(|joint| match body.joints[*joint].parent {
                Some(parent) if is[*joint] == was[*joint] && is[parent] == was[parent] => false,
                Some(parent) => {
                    let relative = |turns: &[glam::DQuat]| turns[parent].inverse() * turns[*joint];
                    let by = relative(was).inverse() * relative(is);
                    glam::DVec3::new(by.x, by.y, by.z).length() > SAME
                }
                None => {
                    source.at(frame)[*joint].distance(capture.at(frame)[*joint]) > SAME || is[*joint] != was[*joint]
                }
            })
            .collect();
        if !joints.is_empty() {
            changed.insert(frame, joints);
        }
    }
    changed
}

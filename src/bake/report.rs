//! What a clip says about itself: the clip read back as a reader would, measured, and told in document space.
//!
//! Nothing is taken from the simulation that can be measured on the keys. Of an `in-place` clip the same motion keyed with
//! its travel is measured, and a note says so.

use super::base;
use super::contacts::{self, FootContact};
use super::key_times::within;
use super::obeys;
use super::perform::Performance;
use super::played::{Played, drift};
use super::ragdoll::Driven;
use super::root_motion::RootMotion;
use crate::maths::pendulum::GRAVITY;
use crate::measure::{self, Findings, Frame, KnownPush, Motion, PushPoint, Setting, measure_in};
use crate::model::report::{
    Assist, BaseReport, BodyReport, Contact, Disturbance, Drift, Event, JointTorque, Outcome, Plausibility, Scuff,
    Search,
};
use crate::model::scenario::{GroundKind, Scenario};
use crate::model::{Body, BodyPose, Clip, ClipReport, Role, Side};
use crate::ragdoll::control::MOST_TORQUE;
use crate::rig::Rig;
use crate::stepper::Phase;
use crate::stepper::footing::{SLOWEST_STAIR_STEP, STAIR_STEP};
use crate::stepper::walk::most_speed;
use glam::DVec3;

/// Samples a frame (DESIGN, "Measures").
const PER_FRAME: usize = 4;

/// What the report is made from.
pub struct ReportInput<'a> {
    /// The rig that was baked on.
    pub rig: &'a Rig,
    /// The keys that are measured: the clip's own, with the travel where `root` took it out.
    pub clip: &'a Clip,
    /// The motion that they came from.
    pub performance: &'a Performance,
    /// What was asked.
    pub scenario: &'a Scenario,
    /// The seed that was used.
    pub seed: u64,
    /// Where the travel went.
    pub root: RootMotion,
}

/// The report, everything measured, and warnings for a person.
pub fn report(input: &ReportInput) -> (ClipReport, Option<Findings>, Vec<String>) {
    let performance = input.performance;
    let body = &performance.timeline.body;
    let mut poses = read_back(input);
    let hz = input.clip.fps * PER_FRAME as f64;
    // Who falls is measured while the feet carry.
    let falls = performance.timeline.falls();
    if falls {
        poses.truncate(((performance.timeline.stands() * hz).floor() as usize + 1).max(5));
    }
    let motion = Motion { body, hz, per_frame: PER_FRAME, poses: &poses };
    let terrain = &performance.timeline.terrain;
    let held = contacts::held(&performance.contacts, Frame::of(terrain));
    let crouched = performance.trace.ticks.iter().map(|tick| tick.crouched).fold(0.0, f64::max);
    let crouched = crouched - performance.trace.ticks.first().map_or(0.0, |tick| tick.crouched);
    let scuffs = performance.timeline.played.as_ref().map_or(&[][..], Played::scuffs);
    let goes = obeys::goes_at(input.scenario, input.clip.duration);
    let setting = Setting { terrain, loads: &performance.timeline.loads, crouched, scuffs, goes };
    let mut findings = measure_in(motion, &setting, &held, &performance.pushes);
    let duration = input.clip.duration;
    let steps = performance.trace.steps.iter().filter(|step| within(step.land, duration)).count() as u32;
    let outcome = outcome(performance, findings.as_ref(), steps, duration);
    if let Some(found) = &mut findings {
        // A fall may begin where what is measured ends.
        found.falls = outcome == Outcome::Fall;
    }
    let mut plausibility = findings.as_ref().map_or_else(Plausibility::default, Findings::plausibility);
    if input.root == RootMotion::InPlace {
        plausibility.notes.push("measured with the travel that in-place leaves out".into());
    }
    if falls {
        let lost = performance.timeline.stands();
        plausibility.notes.push(format!("measured until balance is lost at {lost:.2} s"));
    }
    let base = performance.timeline.over.as_ref().map(|over| {
        // A base clip is met at the very last key, which may be between two samples.
        let mut sampler = input.rig.sampler(input.clip);
        let mut off = |time: f64| base::error(body, &sampler.sample(time).pose(), &over.frame(time).pose);
        let end = if falls { (poses.len() - 1) as f64 / hz } else { performance.timeline.duration() };
        let ((first_deg, first_mm), (last_deg, last_mm)) = (off(0.0), off(end));
        BaseReport { clip: over.base().name.clone(), first_deg, first_mm, last_deg, last_mm }
    });
    let footless = footless(body, findings.as_ref());
    plausibility.notes.extend(footless.clone());
    let strayed = performance.articulated.as_ref().and_then(|_| obeys::strayed(input.scenario, performance));
    plausibility.notes.extend(strayed.clone());
    let fallen = findings.as_ref().and_then(|findings| findings.balance.fallen);
    let slips: Vec<f64> =
        findings.as_ref().map(|f| f.feet.slips.iter().map(|slip| slip.mm).collect()).unwrap_or_default();
    let report = ClipReport {
        version: 1,
        generator: concat!("surefoot ", env!("CARGO_PKG_VERSION")).into(),
        fps: input.clip.fps,
        duration,
        seed: input.seed,
        root_motion: input.root.name().into(),
        drive: if performance.articulated.is_some() { "ragdoll" } else { "stepper" }.into(),
        scenario: input.scenario.title.clone(),
        outcome,
        steps,
        body: BodyReport { mass: body.mass, height: body.height },
        contacts: performance
            .contacts
            .iter()
            .enumerate()
            .map(|(index, contact)| {
                told(input.rig, contact, Frame::of(terrain), slips.get(index).copied().unwrap_or(0.0))
            })
            .collect(),
        scuffs: findings.iter().flat_map(|found| &found.scuffs).map(scuffed).collect(),
        events: events(
            performance,
            (fallen, findings.as_ref().and_then(|findings| findings.balance.rest_from)),
            duration,
        ),
        disturbances: disturbances(input),
        assist: performance.articulated.as_ref().map_or_else(Assist::default, |driven| {
            let help = driven.run.help;
            Assist { peak_nm: help.torque[0], rms_nm: help.torque[1], peak_n: help.force[0], rms_n: help.force[1] }
        }),
        torques: performance.articulated.as_ref().map_or(Vec::new(), torques),
        plausibility,
        drift: drift(performance, &poses, hz),
        search: performance.articulated.as_ref().map(|driven| {
            let searched = driven.run.search;
            Search { effort: searched.effort, tried: searched.tried, chosen: searched.chosen }
        }),
        base,
        looped: None,
    };
    let mut warnings = warnings(input, outcome, fallen);
    warnings.extend(performance.timeline.over.iter().flat_map(|over| over.notes().to_vec()));
    if outcome != Outcome::Fall {
        warnings.extend(report.base.as_ref().and_then(|based| base::apart::apart(input.scenario, based)));
    }
    warnings.extend(footless);
    warnings.extend(strayed);
    (report, findings, warnings)
}

/// How far the keys' poses are from the run's, while it stands.
fn drift(performance: &Performance, poses: &[BodyPose], hz: f64) -> Option<Drift> {
    let (timeline, played) = (&performance.timeline, performance.timeline.played.as_ref()?);
    let times = (0..poses.len()).map(|sample| sample as f64 / hz).take_while(|time| *time <= timeline.stands() + 1e-9);
    // Over a clip that walks, where it is not that clip.
    let [from, to] = played.away().map_or([0.0, f64::INFINITY], |[_, alone]| alone);
    let off = |(time, pose)| drift::between(&timeline.body, played.joints(), &played.run_at(time), pose);
    let most = times
        .zip(poses)
        .filter(|(time, _)| (from..=to).contains(time))
        .map(off)
        .fold(drift::Drift::default(), drift::Drift::or);
    Some(Drift { position_mm: 1000.0 * most.place, angle_deg: most.turn.to_degrees() })
}

/// What the joints gave, the hardest worked first.
fn torques(driven: &Driven) -> Vec<JointTorque> {
    let one = |(role, peak): &(Role, f64)| JointTorque {
        joint: role.name().into(),
        peak_nm: *peak,
        share: peak / MOST_TORQUE,
    };
    driven.run.torques.iter().map(one).collect()
}

/// What a rig without foot bones costs, said where it costs something.
fn footless(body: &Body, findings: Option<&Findings>) -> Option<String> {
    let slip = findings?.feet.slip_max_mm;
    let lacks = body.feet.iter().any(|foot| !body.joints[foot.ankle].animated);
    lacks.then(|| format!("this rig has no feet; soles turn with the shank: contacts slip by up to {slip:.0} mm"))
}

/// Poses at `PER_FRAME` times the clip's rate, from the keys.
fn read_back(input: &ReportInput) -> Vec<BodyPose> {
    let hz = input.clip.fps * PER_FRAME as f64;
    let count = (input.clip.duration * hz + 1e-6).floor() as usize + 1;
    let times = (0..count).map(|sample| sample as f64 / hz);
    let mut sampler = input.rig.sampler(input.clip);
    times.map(|time| sampler.sample(time).pose()).collect()
}

fn outcome(performance: &Performance, findings: Option<&Findings>, steps: u32, duration: f64) -> Outcome {
    if performance.lost_within(duration).is_some() {
        return Outcome::Fall;
    }
    findings.map_or(Outcome::Still, |findings| findings.balance.outcome(steps))
}

/// A contact as the file says it.
pub(super) fn told(rig: &Rig, contact: &FootContact, frame: Frame, slip_mm: f64) -> Contact {
    let similarity = &rig.document_from_scenario;
    Contact {
        foot: contact.side,
        part: contact.part,
        start: contact.start,
        end: contact.end,
        frame: frame.name().into(),
        position: similarity.point(contact.plant.ankle).to_array(),
        normal: (similarity.rotation * contact.plant.normal).to_array(),
        slip_mm,
    }
}

/// A scuff as the file says it.
fn scuffed((scuff, slid_mm): &(measure::Scuff, f64)) -> Scuff {
    Scuff { foot: scuff.side, start: scuff.start, end: scuff.end, slid_mm: *slid_mm }
}

/// s, between contacts that follow on one another.
const SAME: f64 = 1e-4;

/// From when to when a foot stands, s: as the body's run had it, whose feet may also stand without holding still; else as the
/// clip's contacts say, which leave sooner than the simulated ones where nothing rests on them.
fn stood(performance: &Performance, side: Side) -> Vec<[f64; 2]> {
    let runs = performance.timeline.played.as_ref().is_some_and(|played| played.away().is_none());
    if let (Some(driven), true) = (&performance.articulated, runs) {
        let stands = performance.timeline.stands();
        let clipped = |[down, up]: [f64; 2]| [down, if up < stands - SAME { up } else { f64::INFINITY }];
        return driven.run.stood[side as usize].iter().copied().map(clipped).collect();
    }
    let mut spans: Vec<[f64; 2]> = Vec::new();
    for contact in performance.contacts.iter().filter(|contact| contact.side == side) {
        match spans.last_mut() {
            Some(span) if contact.start - span[1] <= SAME => span[1] = contact.end,
            _ => spans.push([contact.start, contact.end]),
        }
    }
    spans
}

/// `fallen`, `rest_from`: s, when the clip is measured to have fallen, and since when it has been at rest at the end.
fn events(performance: &Performance, (fallen, rest_from): (Option<f64>, Option<f64>), duration: f64) -> Vec<Event> {
    let mut events = Vec::new();
    let mut event = |time: f64, name: &str, foot: Option<Side>| {
        if within(time, duration) {
            events.push(Event { time, name: name.into(), foot, bone: None, impulse: None });
        }
    };
    let thrown = |push: &KnownPush| performance.balls.iter().any(|ball| ball.hit.is_some_and(|hit| hit.push == *push));
    for push in performance.pushes.iter().filter(|push| !thrown(push)) {
        event(push.start, "push_start", None);
        event(push.end, "push_end", None);
    }
    for side in Side::BOTH {
        for (index, [down, up]) in stood(performance, side).into_iter().enumerate() {
            if index > 0 {
                event(down, "foot_down", Some(side));
            }
            if up < duration - SAME {
                event(up, "foot_up", Some(side));
            }
        }
    }
    if let Some(lost) = performance.lost.or(fallen) {
        event(lost, "balance_lost", None);
    }
    if let (Some(time), false) = (rest_from, performance.trace.steps.is_empty()) {
        event(time, "balance_regained", None);
    }
    let body = &performance.timeline.body;
    for hit in performance.balls.iter().filter_map(|ball| ball.hit).filter(|hit| within(hit.push.start, duration)) {
        let bone = Some(body.joints[hit.joint].role.name().to_owned());
        let impulse = Some(hit.impulse.length());
        events.push(Event { time: hit.push.start, name: "ball_hit".into(), foot: None, bone, impulse });
    }
    events.sort_by(|a, b| a.time.total_cmp(&b.time));
    events
}

fn disturbances(input: &ReportInput) -> Vec<Disturbance> {
    let body = &input.performance.timeline.body;
    let rotation = input.rig.document_from_scenario.rotation;
    let one = |push: &KnownPush, kind: &str| Disturbance {
        kind: kind.into(),
        start: push.start,
        end: push.end,
        force: (rotation * push.force).to_array(),
        bone: match push.at {
            PushPoint::Joint(joint) | PushPoint::Segment(joint, _) => body.joints[joint].role.name().into(),
            _ => "hips".into(),
        },
    };
    let pulls = &input.scenario.pull;
    input
        .performance
        .pushes
        .iter()
        .map(|push| {
            let pulled = pulls
                .iter()
                .any(|pull| (pull.start - push.start).abs() < 1e-9 && (pull.force - push.force.length()).abs() < 1e-6);
            let thrown = input.performance.balls.iter().any(|ball| ball.hit.is_some_and(|hit| hit.push == *push));
            one(
                push,
                if thrown {
                    "throw"
                } else if pulled {
                    "pull"
                } else {
                    "push"
                },
            )
        })
        .chain(weights(input))
        .collect()
}

/// What each hand carries: half of the mean weight of a box while it is held.
fn weights(input: &ReportInput) -> Vec<Disturbance> {
    let rotation = input.rig.document_from_scenario.rotation;
    let duration = input.clip.duration;
    let mut list = Vec::new();
    for load in &input.performance.timeline.loads {
        let [start, end] = [load.span[0].max(0.0), load.span[1].min(duration)];
        let Some(mass) = load.mean_mass(start, end) else { continue };
        for hand in [Role::LeftHand, Role::RightHand] {
            list.push(Disturbance {
                kind: "carry".into(),
                start,
                end,
                force: (rotation * DVec3::NEG_Y * (0.5 * mass * GRAVITY)).to_array(),
                bone: hand.name().into(),
            });
        }
    }
    list
}

fn warnings(input: &ReportInput, outcome: Outcome, fallen: Option<f64>) -> Vec<String> {
    let mut warnings = Vec::new();
    let performance = input.performance;
    let lost = performance.lost_within(input.clip.duration);
    let articulated = performance.articulated.is_some();
    let scenario = input.scenario;
    // Over a base clip that walks it is to walk on.
    let walks_on = matches!(performance.timeline.over, Some(base::Over::Walk(_)));
    let milder = match () {
        () if !scenario.push.is_empty() || !scenario.pull.is_empty() => "A weaker push",
        () if !scenario.throw.is_empty() => "Lighter balls",
        () if !scenario.walk.is_empty() => "A slower walk",
        () => "Less to do",
    };
    let remedy = if articulated { "more --assist" } else { "a higher agility" };
    match (outcome, lost) {
        (Outcome::Fall, Some(lost)) if performance.timeline.falls() => {
            warnings.push(format!(
                "balance is lost at {lost:.2} s and the character falls. {milder} or {remedy} stays up"
            ));
        }
        (Outcome::Fall, Some(lost)) => {
            let shows = if articulated { "" } else { ": who is to fall needs `--drive ragdoll`" };
            warnings.push(format!(
                "balance is lost at {lost:.2} s and the clip ends there{shows}. {milder} or {remedy} stays up"
            ));
        }
        (Outcome::Fall, None) => warnings.push(format!(
            "the clip is measured as a fall at {:.2} s (too low, or more than feet on the ground), though the simulation keeps its balance. {milder} or {remedy} stays up",
            fallen.unwrap_or(input.clip.duration)
        )),
        _ => {
            if let Some(lost) = performance.lost {
                warnings.push(format!(
                    "balance is lost at {lost:.2} s, after the end of the clip: it ends in what becomes a fall"
                ));
            } else if let Some(needed) = needed(performance).filter(|_| !walks_on) {
                warnings.push(format!(
                    "the character is not at rest when the clip ends at {:.2} s: give the scenario duration = {:.1}",
                    input.clip.duration,
                    (needed * 10.0).ceil() / 10.0
                ));
            }
        }
    }
    warnings.extend(slowed(input));
    warnings.extend(obeys::stopped(scenario, performance));
    warnings.extend(performance.articulated.as_ref().and_then(|_| obeys::unheeded(scenario)));
    let most = most_speed(&performance.physique);
    let wanted = scenario.walk.iter().map(|walk| walk.speed).fold(0.0, f64::max);
    if wanted > most {
        warnings.push(format!("a body of this size runs above {most:.2} m/s: it walks at that, not at {wanted:.2}"));
    }
    warnings
}

/// s, the duration with which it would be at rest; `None` where it is, or walks on. An articulated body's is estimated: its run ends with
/// the clip.
fn needed(performance: &Performance) -> Option<f64> {
    let trace = &performance.trace;
    if performance.articulated.is_some() {
        let last = trace.ticks.last()?;
        let stands = last.walk.length() < 1e-6 && matches!(last.gait, Phase::Rest);
        let end = (trace.ticks.len() - 1) as f64 * trace.dt;
        return (stands && trace.rest <= 0.0)
            .then_some(end + SETTLES * (performance.physique.com_height / 0.96).sqrt());
    }
    (trace.ticks.len() > performance.timeline.com.len()).then(|| (trace.ticks.len() - 1) as f64 * trace.dt)
}

/// s, in which an articulated body that still moves comes to rest: a step, the other foot beside it, and quiet.
const SETTLES: f64 = 1.5;

/// Stairs are walked a tread a step, whatever speed was wanted; by the articulated body kerbs alone, as slowly as it is wanted.
fn slowed(input: &ReportInput) -> Option<String> {
    let GroundKind::Stairs { tread, count, .. } = input.scenario.ground.kind else { return None };
    let tempo = (input.performance.physique.com_height / 0.96).sqrt();
    let [least, most] = [SLOWEST_STAIR_STEP, STAIR_STEP].map(|step| tread / (step * tempo));
    let led = input.performance.articulated.is_some();
    let wanted = || input.scenario.walk.iter().map(|walk| walk.speed).filter(|speed| *speed > 0.0);
    let quick = wanted().fold(0.0, f64::max);
    let slowest = wanted().fold(f64::INFINITY, f64::min);
    let told = |bound: &str, wanted: f64, other: &str| {
        format!("stairs are walked a tread a step: at {bound} m/s on them, not {wanted:.2} (a {other})")
    };
    if quick > most {
        Some(told(&format!("most {most:.2}"), quick, "longer tread allows more"))
    } else {
        let slow = slowest < least && count > 1 && !led;
        slow.then(|| told(&format!("least {least:.2}"), slowest, "shorter tread allows less"))
    }
}

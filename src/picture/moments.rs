//! Which moments of a clip a sheet shows: before, the hit, every lift and landing, the way between, the end.

use crate::model::{ClipReport, Side};

/// A moment worth a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// s.
    pub time: f64,
    /// What happens; empty between events.
    pub label: String,
}

/// At most `count` moments in the order of time, the telling ones first, the largest gaps of the action filled.
pub fn choose_moments(report: &ClipReport, count: usize) -> Vec<Moment> {
    let end = report.duration.max(0.0);
    // (importance, moment): the smaller the number, the sooner it has a place.
    let mut found: Vec<(u32, Moment)> = vec![(1, moment(end, "end"))];
    let pushes: Vec<_> = report.disturbances.iter().filter(sudden).collect();
    if let Some(first) = pushes.iter().map(|push| push.start).min_by(f64::total_cmp) {
        found.push((0, moment((first - 0.08).max(0.0), "before")));
    } else {
        found.push((0, moment(0.0, "start")));
    }
    for push in &pushes {
        let newtons = glam::DVec3::from(push.force).length();
        let into = (push.end - push.start).clamp(0.0, 0.24) * 0.5;
        found.push((2, moment(push.start + into, &format!("{} {newtons:.0} N", push.kind))));
    }
    for event in &report.events {
        let foot = event.foot.map_or("", |foot| if foot == Side::Left { "left " } else { "right " });
        let (rank, label) = match event.name.as_str() {
            "foot_down" => (3, format!("{foot}foot down")),
            "foot_up" => (4, format!("{foot}foot up")),
            "ball_hit" => (3, "ball hits".to_owned()),
            "balance_lost" => (2, "balance lost".to_owned()),
            "balance_regained" => (3, "balance regained".to_owned()),
            _ => continue,
        };
        found.push((rank, moment(event.time.clamp(0.0, end), &label)));
    }
    found.retain(|(_, moment)| moment.time.is_finite());
    found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.time.total_cmp(&b.1.time)));
    let mut chosen: Vec<Moment> = Vec::new();
    for (_, next) in found {
        // Two pictures of one instant say nothing more than one.
        if chosen.len() < count && chosen.iter().all(|have| (have.time - next.time).abs() > 0.034) {
            chosen.push(next);
        }
    }
    chosen.sort_by(|a, b| a.time.total_cmp(&b.time));
    fill(&mut chosen, count, report, end);
    chosen
}

/// `count` moments at equal distances over the whole clip.
pub fn even_moments(duration: f64, count: usize) -> Vec<Moment> {
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count).map(|at| moment(duration.max(0.0) * at as f64 / last, "")).collect()
}

/// A load is carried all the time and is no moment.
fn sudden(disturbance: &&crate::model::report::Disturbance) -> bool {
    disturbance.kind != "carry"
}

fn moment(time: f64, label: &str) -> Moment {
    Moment { time, label: label.to_owned() }
}

/// Halves the largest gap until there are enough; time after the last event counts for little.
fn fill(chosen: &mut Vec<Moment>, count: usize, report: &ClipReport, end: f64) {
    let pushed = report.disturbances.iter().filter(sudden).map(|push| push.end);
    let last = report.events.iter().map(|event| event.time).chain(pushed).filter(|time| time.is_finite());
    let quiet = last.fold(0.0, f64::max) + 0.5;
    let first = report.disturbances.iter().filter(sudden).map(|push| push.start).fold(f64::INFINITY, f64::min);
    // Time as it is felt: quick where something happens.
    let felt = |time: f64| {
        let still = if first.is_finite() { first.min(time) * 0.1 } else { 0.0 };
        let after = (time - quiet).max(0.0);
        let busy = if first.is_finite() { (time.min(quiet) - first).max(0.0) } else { time.min(quiet) };
        still + busy + after * 0.15
    };
    while chosen.len() < count && chosen.len() > 1 {
        let gaps = chosen.windows(2).enumerate();
        let widest = gaps.max_by(|a, b| {
            let gap = |pair: &[Moment]| felt(pair[1].time) - felt(pair[0].time);
            gap(a.1).total_cmp(&gap(b.1)).then(b.0.cmp(&a.0))
        });
        let Some((at, pair)) = widest else { return };
        let goal = (felt(pair[0].time) + felt(pair[1].time)) / 2.0;
        let (mut low, mut high) = (pair[0].time, pair[1].time);
        if high - low < 0.02 || end <= 0.0 {
            return;
        }
        for _ in 0..40 {
            let middle = (low + high) / 2.0;
            if felt(middle) < goal { low = middle } else { high = middle }
        }
        chosen.insert(at + 1, moment(low, ""));
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::model::report::{Assist, BodyReport, Contact, Disturbance, Event, Outcome, Part, Plausibility};

    /// A push from the left at 0.6 s, one step with the right foot and one after it with the left.
    pub(crate) fn pushed() -> ClipReport {
        let event = |time: f64, name: &str, foot: Option<Side>| Event {
            time,
            name: name.to_owned(),
            foot,
            bone: None,
            impulse: None,
        };
        let contact = |foot: Side, part: Part, start: f64, end: f64| Contact {
            foot,
            part,
            start,
            end,
            frame: "world".to_owned(),
            position: [0.0; 3],
            normal: [0.0, 1.0, 0.0],
            slip_mm: 0.2,
        };
        ClipReport {
            version: 1,
            generator: "test".to_owned(),
            fps: 30.0,
            duration: 3.0,
            seed: 1,
            root_motion: "root".to_owned(),
            drive: "stepper".to_owned(),
            scenario: "shove from the left".to_owned(),
            outcome: Outcome::Step,
            steps: 2,
            body: BodyReport { mass: 72.0, height: 1.78 },
            contacts: vec![
                contact(Side::Left, Part::Flat, 0.0, 1.05),
                contact(Side::Left, Part::Ball, 1.05, 1.15),
                contact(Side::Left, Part::Flat, 1.5, 3.0),
                contact(Side::Right, Part::Flat, 0.0, 0.75),
                contact(Side::Right, Part::Flat, 1.05, 3.0),
            ],
            scuffs: Vec::new(),
            events: vec![
                event(0.6, "push_start", None),
                event(0.8, "push_end", None),
                event(0.75, "foot_up", Some(Side::Right)),
                event(1.05, "foot_down", Some(Side::Right)),
                event(1.15, "foot_up", Some(Side::Left)),
                event(1.5, "foot_down", Some(Side::Left)),
            ],
            disturbances: vec![Disturbance {
                kind: "push".to_owned(),
                start: 0.6,
                end: 0.8,
                force: [-300.0, 0.0, 0.0],
                bone: "chest".to_owned(),
            }],
            assist: Assist::default(),
            torques: Vec::new(),
            base: None,
            looped: None,
            drift: None,
            search: None,
            plausibility: Plausibility { score: 0.91, zmp_inside: 0.98, slip_max_mm: 0.4, ..Plausibility::default() },
        }
    }

    #[test]
    fn every_lift_and_landing_the_push_and_both_ends_have_their_picture() {
        let moments = choose_moments(&pushed(), 12);
        assert_eq!(moments.len(), 12);
        for label in
            ["before", "push 300 N", "right foot up", "right foot down", "left foot up", "left foot down", "end"]
        {
            assert!(moments.iter().any(|moment| moment.label == label), "{label} is missing in {moments:?}");
        }
        assert!(moments.windows(2).all(|pair| pair[0].time < pair[1].time), "{moments:?}");
        let busy = moments.iter().filter(|moment| (0.5..2.0).contains(&moment.time)).count();
        assert!(busy >= 10, "the action has {busy} of 12");
    }

    #[test]
    fn few_places_go_to_what_tells_most() {
        let labels: Vec<String> = choose_moments(&pushed(), 4).into_iter().map(|moment| moment.label).collect();
        assert_eq!(labels, ["before", "push 300 N", "right foot down", "end"]);
        assert!(choose_moments(&pushed(), 0).is_empty());
    }

    #[test]
    fn a_clip_of_no_length_has_one_moment_and_does_not_hang() {
        let report = ClipReport { duration: 0.0, events: vec![], disturbances: vec![], ..pushed() };
        assert_eq!(choose_moments(&report, 12).len(), 1);
        let broken = ClipReport { duration: f64::NAN, ..pushed() };
        assert!(choose_moments(&broken, 12).len() <= 12);
    }
}

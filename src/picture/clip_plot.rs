//! A clip's run as a plot: speeds, centre of mass, ξ and CoP against the support, contacts, what was meant and done to it.
//!
//! Scenario space, metres, seconds. What is drawn is the controller's run behind the clip; the clip's own centre of mass
//! differs from it by what the balance filter moved. [`panels`] and [`margin`] are for others who draw the same.

use super::plot::{Bar, Colour, Line, Panel, Plot, Row, svg};
use crate::bake::Performance;
use crate::maths::hull::{convex_hull, signed_distance};
use crate::model::report::Part;
use crate::model::scenario::Scenario;
use crate::model::{Physique, Plant, Side};
use crate::sim::{Script, TickState};
use glam::DVec2;

/// The bytes of an SVG file.
pub fn clip_plot(performance: &Performance, scenario: &Scenario) -> String {
    svg(&plot(performance, scenario))
}

fn plot(performance: &Performance, scenario: &Scenario) -> Plot {
    let duration = performance.timeline.duration();
    let rows = contact_rows(performance).into_iter().chain(lane_rows(scenario, duration)).collect();
    Plot { title: scenario.title.clone(), duration, panels: panels(performance, scenario), rows, columns: 1 }
}

/// Speed, and forward and to the left the centre of mass, ξ and the centre of pressure over the support.
pub fn panels(performance: &Performance, scenario: &Scenario) -> Vec<Panel> {
    let trace = &performance.trace;
    let duration = performance.timeline.duration();
    let script = Script::of(scenario, Vec::new());
    let ticks: Vec<(f64, &TickState)> = (trace.ticks.iter().enumerate())
        .map(|(index, tick)| (index as f64 * trace.dt, tick))
        .take_while(|(time, _)| *time <= duration + 1e-9)
        .collect();
    let line = |name: &str, colour: Colour, dashed: bool, value: &dyn Fn(f64, &TickState) -> f64| Line {
        name: name.into(),
        colour,
        dashed,
        points: ticks.iter().map(|(time, tick)| (*time, value(*time, tick))).collect(),
    };
    let commanded = |time: f64| script.intent(time).walk.map_or(0.0, DVec2::length);
    let speed = |_: f64, tick: &TickState| DVec2::new(tick.velocity.x, tick.velocity.z).length();
    let marks: Vec<(f64, f64)> = performance.pushes.iter().map(|push| (push.start, push.end)).collect();
    let mut panels = vec![Panel {
        label: "speed, m/s".into(),
        lines: vec![
            line("commanded", Colour::Grey, true, &|time, _| commanded(time)),
            line("centre of mass", Colour::Blue, false, &speed),
        ],
        band: Vec::new(),
        marks: marks.clone(),
    }];
    for (label, axis) in [("forward, m", DVec2::Y), ("to the left, m", DVec2::X)] {
        let com = |_: f64, tick: &TickState| DVec2::new(tick.com.x, tick.com.z).dot(axis);
        panels.push(Panel {
            label: label.into(),
            lines: vec![
                line("centre of mass", Colour::Blue, false, &com),
                line("ξ", Colour::Orange, false, &|_, tick| tick.xi.dot(axis)),
                line("centre of pressure", Colour::Green, true, &|_, tick| tick.cop.dot(axis)),
            ],
            band: (ticks.iter())
                .map(|(time, tick)| {
                    let (low, high) = support(&performance.physique, tick, axis);
                    (*time, low, high)
                })
                .collect(),
            marks: marks.clone(),
        });
    }
    panels
}

/// m, how far ξ is inside of the hull of the whole soles that carry, negative outside: the margin of stability. `None` in flight.
/// Hof, Gazendam and Sinke, "The condition for dynamic stability", 2005.
pub fn margin(physique: &Physique, tick: &TickState) -> Option<f64> {
    let carrying = Side::BOTH.into_iter().filter(|side| tick.planted[*side as usize]);
    let soles: Vec<DVec2> = carrying.flat_map(|side| corners(physique, &tick.feet[side as usize])).collect();
    let distance = -signed_distance(&convex_hull(&soles), tick.xi);
    distance.is_finite().then_some(distance)
}

/// How far the soles that carry reach along an axis.
fn support(physique: &Physique, tick: &TickState, axis: DVec2) -> (f64, f64) {
    let carrying = Side::BOTH.into_iter().filter(|side| tick.planted[*side as usize]);
    carrying
        .flat_map(|side| corners(physique, &tick.feet[side as usize]))
        .map(|corner| corner.dot(axis))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |all, one| (all.0.min(one), all.1.max(one)))
}

/// The sole's corners on the ground.
fn corners(physique: &Physique, plant: &Plant) -> [DVec2; 4] {
    let (ahead, left) = (DVec2::from_angle(-plant.yaw).perp(), DVec2::from_angle(-plant.yaw));
    let ankle = DVec2::new(plant.ankle.x, plant.ankle.z);
    let (heel, tip, half) = (ahead * physique.heel, ahead * physique.tip, left * physique.half_width);
    [ankle + heel - half, ankle + heel + half, ankle + tip + half, ankle + tip - half]
}

fn contact_rows(performance: &Performance) -> Vec<Row> {
    let foot = |(side, label, colour): (Side, &str, Colour)| Row {
        label: label.into(),
        bars: (performance.contacts.iter())
            .filter(|contact| contact.side == side)
            .map(|contact| Bar {
                start: contact.start,
                end: contact.end,
                colour: if contact.part == Part::Flat { colour } else { Colour::Grey },
                text: match contact.part {
                    Part::Heel => "h".into(),
                    Part::Ball => "b".into(),
                    Part::Flat => String::new(),
                },
            })
            .collect(),
    };
    [(Side::Left, "left foot", Colour::Blue), (Side::Right, "right foot", Colour::Orange)].map(foot).into()
}

/// A row for every lane that has entries.
fn lane_rows(scenario: &Scenario, duration: f64) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut lane = |label: &str, colour: Colour, bars: Vec<(f64, f64, String)>| {
        if !bars.is_empty() {
            let bars = bars.into_iter().map(|(start, end, text)| Bar { start, end, colour, text }).collect();
            rows.push(Row { label: label.into(), bars });
        }
    };
    let until = |starts: &[f64], index: usize, length: Option<f64>| {
        let next = starts.iter().copied().filter(|start| *start > starts[index]).fold(duration, f64::min);
        length.map_or(next, |length| next.min(starts[index] + length))
    };
    let starts: Vec<f64> = scenario.walk.iter().map(|walk| walk.start).collect();
    let walks = scenario.walk.iter().enumerate().map(|(index, walk)| {
        let text = format!("{:.1} m/s, {:.0}°", walk.speed, walk.heading.to_degrees());
        (walk.start, until(&starts, index, walk.duration), text)
    });
    lane("walk", Colour::Grey, walks.collect());
    let starts: Vec<f64> = scenario.turn.iter().map(|turn| turn.start).collect();
    let turns = scenario.turn.iter().enumerate().map(|(index, turn)| {
        (turn.start, until(&starts, index, turn.duration), format!("{:.0}°", turn.facing.to_degrees()))
    });
    lane("turn", Colour::Grey, turns.collect());
    let starts: Vec<f64> = scenario.crouch.iter().map(|crouch| crouch.start).collect();
    let crouches = (scenario.crouch.iter().enumerate())
        .map(|(index, crouch)| (crouch.start, until(&starts, index, crouch.duration), format!("{:.2}", crouch.amount)));
    lane("crouch", Colour::Grey, crouches.collect());
    let starts: Vec<f64> = scenario.stand.iter().map(|stand| stand.start).collect();
    let stands = (scenario.stand.iter().enumerate())
        .map(|(index, stand)| (stand.start, until(&starts, index, stand.duration), format!("{:?}", stand.on)));
    lane("stand", Colour::Grey, stands.collect());
    for (label, pushes) in [("push", &scenario.push), ("pull", &scenario.pull)] {
        let bars = pushes.iter().map(|push| (push.start, push.end(), format!("{:.0} N", push.force)));
        lane(label, Colour::Red, bars.collect());
    }
    let balls = scenario.throw.iter().flat_map(|throw| {
        (0..throw.count).map(move |ball| {
            let start = throw.start + f64::from(ball) * throw.interval;
            (start, start + 0.02, String::new())
        })
    });
    lane("balls", Colour::Red, balls.collect());
    let boxes = (scenario.carry.iter()).map(|carry| {
        let (first, last) = (carry.mass.first(), carry.mass.last());
        let kilograms = |point: Option<&[f64; 2]>| point.map_or(0.0, |point| point[1]);
        let text = format!("{:.0} to {:.0} kg", kilograms(first), kilograms(last));
        (carry.start, carry.end.unwrap_or(duration), text)
    });
    lane("carry", Colour::Red, boxes.collect());
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_sole_reaches_from_its_heel_to_its_tip_along_its_yaw() {
        let physique = Physique::REFERENCE;
        let ahead = Plant::level(DVec3::ZERO, 0.0);
        let along = |plant: &Plant, axis: DVec2| {
            corners(&physique, plant).map(|corner| corner.dot(axis)).into_iter().fold(f64::NEG_INFINITY, f64::max)
        };
        assert!((along(&ahead, DVec2::Y) - physique.tip).abs() < 1e-12);
        let left = Plant::level(DVec3::ZERO, std::f64::consts::FRAC_PI_2);
        assert!((along(&left, DVec2::X) - physique.tip).abs() < 1e-12, "a foot turned left points along +X");
    }
}

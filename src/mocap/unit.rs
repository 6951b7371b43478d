//! How long a file's unit is: by what the file says where a body of that size can be, else by the sizes that people have.
//!
//! A grown leg (hip to knee to ankle) is 0.72 to 1.0 m, a person's 0.55 to 1.15 m. A file that says or is expected to be in metres
//! may hold a child or a figure with a large head; a unit that is guessed must make a person.

use crate::maths::real;
use crate::model::Body;
use crate::rig::Rig;

/// Heights, m, that are taken as they stand.
const HEIGHTS: std::ops::RangeInclusive<f64> = 0.4..=3.5;
/// The same for legs.
const LEGS: std::ops::RangeInclusive<f64> = 0.15..=1.9;
/// Of a person: height and leg, m.
const PERSON: (std::ops::RangeInclusive<f64>, std::ops::RangeInclusive<f64>) = (0.95..=2.4, 0.55..=1.15);
/// m: an ordinary leg.
const LEG: f64 = 0.83;
/// Units in the wild, metres each, and how much less likely than the first (in the logarithm of a leg).
const UNITS: [(f64, f64); 10] = [
    (1.0, 0.0),
    (0.01, 0.0),
    (0.001, 0.05),
    (0.1, 0.15),
    (0.056_444, 0.15), // CMU's: inches over 0.45
    (0.0254, 0.25),
    (0.3048, 0.3),
    (1.0 / 25.4, 0.3), // metres taken for inches and made millimetres of
    (1e-4, 0.3),       // centimetres a hundredfold: an armature's scale applied twice
    (10.0, 0.4),
];

/// A unit and, where it was not what was expected, why.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// m.
    pub metres: f64,
    /// A sentence for a person.
    pub note: Option<String>,
}

/// The unit of a body whose leg and height are that long in the file. `said`: metres a unit by the file or its format.
pub fn of(leg: f64, height: f64, said: f64) -> Unit {
    if HEIGHTS.contains(&(height * said)) && LEGS.contains(&(leg * said)) {
        return Unit { metres: said, note: None };
    }
    let person = |unit: f64| PERSON.0.contains(&(height * unit)) && PERSON.1.contains(&(leg * unit));
    let far = |(unit, less): &(f64, f64)| real::ln(leg * unit / LEG).abs() + less;
    let fitting = UNITS.iter().filter(|(unit, _)| person(*unit));
    match fitting.min_by(|a, b| far(a).total_cmp(&far(b))) {
        // Centimetres where nothing was said are nothing to tell.
        Some((unit, _)) if said == 1.0 && [0.01, 0.001].contains(unit) => Unit { metres: *unit, note: None },
        Some((unit, _)) => {
            Unit { metres: *unit, note: Some(format!("a leg is {leg:.2} units long: taken as {unit:.4} m each")) }
        }
        None if leg > 0.0 && leg.is_finite() => Unit {
            metres: LEG / leg,
            note: Some(format!("no known unit makes a person of a leg {leg:.3} units long: scaled to {LEG} m")),
        },
        None => Unit { metres: said, note: None },
    }
}

/// Makes every length of a rig `factor` times as long: as if its file's unit were so much longer.
pub fn resize(rig: &mut Rig, factor: f64) {
    if (factor - 1.0).abs() < 1e-12 {
        return;
    }
    let Body { joints, segments, feet, mass, height, leg_length, flanks, belly, flesh } = &mut rig.body;
    joints.iter_mut().for_each(|joint| joint.rest *= factor);
    let heavier = factor * factor; // mass goes with the height squared, as where it was derived
    for segment in segments {
        segment.mass *= heavier;
        segment.centre *= factor;
        segment.inertia *= heavier * factor * factor;
    }
    for part in flesh {
        part.middle *= factor;
        part.half *= factor;
    }
    for foot in feet {
        for length in [&mut foot.ankle_height, &mut foot.heel, &mut foot.ball, &mut foot.tip, &mut foot.half_width] {
            *length *= factor;
        }
        foot.rear_sole.iter_mut().chain(&mut foot.front_sole).for_each(|vertex| *vertex *= factor);
    }
    *mass *= heavier;
    for length in flanks.iter_mut().chain([height, leg_length, belly]) {
        *length *= factor;
    }
    for part in &mut rig.mesh {
        part.positions.iter_mut().for_each(|point| *point *= factor);
    }
    rig.document_from_scenario.scale /= factor;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legs_of_real_files_show_their_unit() {
        let cases = [
            (13.9, 26.1, 0.056_444),  // CMU
            (21.7, 47.5, 1.0 / 25.4), // Meta's
            (80.0, 155.0, 0.01),      // Bandai Namco
            (84.0, 166.0, 0.01),      // CMU from ASF
            (8.6, 17.3, 0.1),         // MakeHuman
            (840.0, 1700.0, 0.001),   // a marker system
            (33.0, 67.0, 0.0254),     // inches
            (56.0, 118.0, 0.01),      // a child
            (0.55, 1.18, 1.0),        // the same in metres
            (0.25, 1.03, 1.0),        // a figure with a large head
        ];
        for (leg, height, metres) in cases {
            assert!((of(leg, height, 1.0).metres - metres).abs() < 1e-6, "{leg}: {:?}", of(leg, height, 1.0));
        }
        assert_eq!(of(85.0, 170.0, 0.01), Unit { metres: 0.01, note: None }, "as the file says");
        assert_eq!(of(0.85, 1.7, 0.01).metres, 1.0, "the file says centimetres, but that is no body");
        let odd = of(5.0, 10.6, 1.0);
        assert!((odd.metres * 5.0 - LEG).abs() < 1e-9 && odd.note.is_some_and(|note| note.contains("no known unit")));
    }
}

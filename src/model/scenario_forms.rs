//! Values of a scenario's text that may be written in several forms: a direction as a word, degrees or a vector, a radius
//! as one or as a span, a mass as one or as a curve. What is in none of its forms is told, and read as something harmless.

use super::role::Role;
use super::scenario::Direction;
use super::scenario_reader::Reader;
use glam::DVec3;
use toml::de::DeValue;

/// front, back, left, right, degrees, or three numbers.
pub(super) fn direction(entry: &mut Reader<'_, '_>, key: &'static str) -> Direction {
    const NAMES: [(&str, Direction); 4] = [
        ("front", Direction::Front),
        ("back", Direction::Back),
        ("left", Direction::Left),
        ("right", Direction::Right),
    ];
    const FORMS: &str = "give \"front\", \"back\", \"left\", \"right\", degrees (90 is its left), or [x, y, z]";
    match entry.peek(key) {
        None => entry.missing(key, FORMS),
        Some(DeValue::String(_)) => return entry.choice(key, &NAMES).unwrap_or(Direction::Front),
        Some(DeValue::Array(_)) => {
            return entry.numbers::<3>(key).map_or(Direction::Front, |xyz| Direction::Vector(DVec3::from_array(xyz)));
        }
        Some(DeValue::Integer(_) | DeValue::Float(_)) => {
            return entry.degrees(key).map_or(Direction::Front, Direction::Heading);
        }
        Some(_) => entry.wrong_type(key, "a direction", FORMS),
    }
    Direction::Front
}

/// A humanoid bone by its VRM name.
pub(super) fn role(entry: &mut Reader<'_, '_>, default: &str) -> Role {
    let names: Vec<(&str, Role)> = Role::ALL.iter().map(|role| (role.name(), *role)).collect();
    let default = Role::from_name(default).unwrap_or(Role::Hips);
    entry.choice("at", &names).unwrap_or(default)
}

/// One radius, or the least and the greatest.
pub(super) fn radius(entry: &mut Reader<'_, '_>) -> [f64; 2] {
    match entry.peek("radius") {
        None => [0.08, 0.2],
        Some(DeValue::Array(_)) => entry.numbers::<2>("radius").unwrap_or([0.1, 0.1]),
        Some(_) => entry.number("radius").map_or([0.1, 0.1], |radius| [radius, radius]),
    }
}

/// Kilograms, or (s, kg) points.
pub(super) fn mass_curve(entry: &mut Reader<'_, '_>) -> Vec<[f64; 2]> {
    match entry.peek("mass") {
        None => {
            entry.missing("mass", "give kilograms, or [[seconds, kilograms], ...]");
            vec![[0.0, 1.0]]
        }
        Some(DeValue::Array(_)) => entry.points("mass").unwrap_or_else(|| vec![[0.0, 1.0]]),
        Some(_) => vec![[0.0, entry.number("mass").unwrap_or(1.0)]],
    }
}

/// m: across, up, forward, or (s, those) points; `otherwise` where nothing is said.
pub(super) fn size_curve(entry: &mut Reader<'_, '_>, otherwise: DVec3) -> Vec<(f64, DVec3)> {
    let first = match entry.peek("size") {
        Some(DeValue::Array(array)) => array.iter().next().map(|first| matches!(first.get_ref(), DeValue::Array(_))),
        _ => None,
    };
    match first {
        Some(true) => {
            let points = entry.timed("size").unwrap_or_default();
            let points: Vec<_> = points.into_iter().map(|(time, size)| (time, DVec3::from_array(size))).collect();
            if points.is_empty() { vec![(0.0, otherwise)] } else { points }
        }
        _ => vec![(0.0, entry.numbers::<3>("size").map_or(otherwise, DVec3::from_array))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario_text::parse;

    #[test]
    fn every_form_of_a_direction_is_read() {
        let forms = [
            ("\"back\"", Direction::Back),
            ("180", Direction::Heading(180.0_f64.to_radians())),
            ("-45.5", Direction::Heading((-45.5_f64).to_radians())),
            ("[1, 0.0, -2]", Direction::Vector(DVec3::new(1.0, 0.0, -2.0))),
        ];
        for (form, direction) in forms {
            let text = format!("[[push]]\nstart = 1\nduration = 0.1\nforce = 100\ntoward = {form}\n");
            let scenario = parse("x.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
            assert_eq!(scenario.push[0].toward, direction);
            assert_eq!(scenario.push[0].at, Role::Chest);
        }
    }
}

//! The text form of a scenario: TOML with degrees, read with the place of every value kept, so that each fault names
//! its line. No I/O: the text comes as a `&str`.
//!
//! Where the TOML itself is broken only the faults of syntax are told, since what follows a broken line is guesswork;
//! otherwise every fault of the document is, unknown keys and wrong types here, the rest by [`Scenario::validate`].

use super::role::Role;
use super::scenario::{
    Base, Carry, Character, Crouch, Direction, Feet, Ground, GroundKind, Push, Scenario, Stand, Style, Throw, Turn,
    Walk,
};
use super::scenario_reader::{Places, Reader};
use super::scenario_rules::Fault;
use glam::DVec3;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// Reads a scenario. `name` is the file's, for messages and for a missing title.
pub fn parse(name: &str, text: &str) -> Result<Scenario, ScenarioErrors> {
    read(name, text).map(|(scenario, _)| scenario)
}

/// As [`parse`], with the places of its values, for faults that are found later.
pub fn read(name: &str, text: &str) -> Result<(Scenario, ScenarioSource), ScenarioErrors> {
    let (document, broken) = DeTable::parse_recoverable(text);
    let mut source = ScenarioSource { name: name.to_owned(), text: text.to_owned(), places: Places::default() };
    if !broken.is_empty() {
        let faults = broken.iter().map(|error| syntax_fault(text, error)).collect();
        return Err(source.collect(faults));
    }
    let mut faults = Vec::new();
    let reader = Reader::new(document.get_ref(), &mut source.places, &mut faults);
    let scenario = scenario(name, reader);
    if faults.is_empty() {
        let broken_rules = scenario.validate();
        if broken_rules.is_empty() {
            return Ok((scenario, source));
        }
        return Err(source.errors(&broken_rules));
    }
    // Rules are checked beside what could be read, but not on the values that could not.
    let misread: Vec<String> = faults.iter().map(|fault| fault.path.clone()).collect();
    let rules = scenario.validate();
    let further = rules.into_iter().filter(|rule| !misread.iter().any(|path| touches(path, &rule.path)));
    faults.extend(further.map(|fault| source.locate(&fault)));
    Err(source.collect(faults))
}

/// The text of a scenario and where in it each value stands.
#[derive(Clone, Debug)]
pub struct ScenarioSource {
    name: String,
    text: String,
    places: Places,
}

/// Everything that is wrong with a scenario's text, in the order of the text.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{}", self.lines().join("\n"))]
pub struct ScenarioErrors {
    /// The file's name.
    pub name: String,
    /// The whole text.
    pub text: String,
    /// At least one.
    pub faults: Vec<TextFault>,
}

/// A fault with its place in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextFault {
    /// Keys and indices joined by dots; empty where the syntax is broken.
    pub path: String,
    /// Bytes of the text, on character boundaries.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What would be right.
    pub remedy: String,
}

impl ScenarioErrors {
    /// Line and column of a fault, from 1; columns count characters.
    pub fn line_column(&self, fault: &TextFault) -> (usize, usize) {
        let before = self.text.get(..fault.span.start).unwrap_or(&self.text);
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }

    /// One line a fault: `shove.toml:4:9: message (remedy)`.
    pub fn lines(&self) -> Vec<String> {
        let line = |fault: &TextFault| {
            let (line, column) = self.line_column(fault);
            format!("{}:{line}:{column}: {} ({})", self.name, fault.message, fault.remedy)
        };
        self.faults.iter().map(line).collect()
    }
}

impl ScenarioSource {
    /// Those faults, at their places in this text.
    pub fn errors(&self, faults: &[Fault]) -> ScenarioErrors {
        self.collect(faults.iter().map(|fault| self.locate(fault)).collect())
    }

    fn locate(&self, fault: &Fault) -> TextFault {
        TextFault {
            path: fault.path.clone(),
            span: whole_characters(&self.text, self.places.find(&fault.path)),
            message: format!("`{}`: {}", fault.path, fault.message),
            remedy: fault.remedy.clone(),
        }
    }

    fn collect(&self, mut faults: Vec<TextFault>) -> ScenarioErrors {
        for fault in &mut faults {
            fault.span = whole_characters(&self.text, fault.span.clone());
        }
        faults.sort_by(|a, b| (a.span.start, a.span.end, &a.path).cmp(&(b.span.start, b.span.end, &b.path)));
        ScenarioErrors { name: self.name.clone(), text: self.text.clone(), faults }
    }
}

fn scenario(name: &str, mut root: Reader<'_, '_>) -> Scenario {
    let default = Scenario::default();
    let title = root.string("title").unwrap_or_else(|| title_from(name));
    let duration = root.number("duration").unwrap_or(default.duration);
    let seed = root.whole("seed").unwrap_or(default.seed);
    let character = root.table("character").map(character).unwrap_or_default();
    let ground = root.table("ground").map(ground).unwrap_or_default();
    let base = root.table("base").and_then(base);
    let walk = root.lane("walk", |entry| Walk {
        start: entry.required_number("start"),
        duration: entry.number("duration"),
        speed: entry.required_number("speed"),
        heading: entry.degrees("heading").unwrap_or(0.0),
        facing: entry.degrees("facing"),
    });
    let turn = root.lane("turn", |entry| Turn {
        start: entry.required_number("start"),
        duration: entry.number("duration"),
        facing: entry.required_number("facing").to_radians(),
    });
    let crouch = root.lane("crouch", |entry| Crouch {
        start: entry.required_number("start"),
        duration: entry.number("duration"),
        amount: entry.required_number("amount"),
    });
    let stand = root.lane("stand", |entry| Stand {
        start: entry.required_number("start"),
        duration: entry.number("duration"),
        on: entry.required_choice(
            "on",
            &[("both", Feet::Both), ("left", Feet::Left), ("right", Feet::Right)],
            Feet::Both,
        ),
    });
    let push = root.lane("push", |entry| force(entry, "chest"));
    let pull = root.lane("pull", |entry| force(entry, "hips"));
    let throw = root.lane("throw", |entry| Throw {
        start: entry.required_number("start"),
        count: entry.count("count").unwrap_or(1),
        interval: entry.number("interval").unwrap_or(0.3),
        radius: radius(entry),
        density: entry.number("density").unwrap_or(50.0),
        speed: entry.number("speed").unwrap_or(9.0),
        from: direction(entry, "from"),
        at: role(entry, "chest"),
        spread: entry.number("spread").unwrap_or(0.2),
    });
    let carry = root.lane("carry", |entry| Carry {
        start: entry.required_number("start"),
        end: entry.number("end"),
        mass: mass_curve(entry),
        size: entry.numbers::<3>("size").map_or(DVec3::new(0.4, 0.3, 0.3), DVec3::from_array),
    });
    root.finish();
    Scenario { title, duration, seed, character, ground, base, walk, turn, crouch, stand, push, pull, throw, carry }
}

fn character(mut table: Reader<'_, '_>) -> Character {
    let default = Character::default();
    let dial = |table: &mut Reader<'_, '_>, key| table.number(key).unwrap_or(0.5);
    let character = Character {
        mass: table.number("mass"),
        leg_scale: table.number("leg_scale").unwrap_or(default.leg_scale),
        crouch: table.number("crouch").unwrap_or(default.crouch),
        agility: table.number("agility").unwrap_or(default.agility),
        style: Style {
            step_height: dial(&mut table, "step_height"),
            stance_width: dial(&mut table, "stance_width"),
            readiness: dial(&mut table, "readiness"),
            recovery_time: dial(&mut table, "recovery_time"),
            arms: dial(&mut table, "arms"),
        },
    };
    table.finish();
    character
}

fn ground(mut table: Reader<'_, '_>) -> Ground {
    let kinds = ["flat", "slope", "stairs", "uneven", "gaps", "platform"].map(|kind| (kind, kind));
    let kind = match table.choice("kind", &kinds).unwrap_or("flat") {
        "slope" => GroundKind::Slope { angle: table.required_number("angle").to_radians() },
        "stairs" => GroundKind::Stairs {
            rise: table.required_number("rise"),
            tread: table.required_number("tread"),
            count: table.count("count").unwrap_or(10),
        },
        "uneven" => GroundKind::Uneven {
            height: table.required_number("height"),
            wavelength: table.required_number("wavelength"),
            seed: table.whole("seed").unwrap_or(0),
        },
        "gaps" => GroundKind::Gaps { width: table.required_number("width"), spacing: table.required_number("spacing") },
        "platform" => {
            let in_radians = |points: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
                points.into_iter().map(|[time, angle]| [time, angle.to_radians()]).collect()
            };
            GroundKind::Platform {
                pitch: table.points("pitch").map(in_radians).unwrap_or_default(),
                roll: table.points("roll").map(in_radians).unwrap_or_default(),
            }
        }
        _ => GroundKind::Flat,
    };
    let friction = table.number("friction").unwrap_or(1.0);
    table.finish();
    Ground { kind, friction }
}

fn base(mut table: Reader<'_, '_>) -> Option<Base> {
    let base = Base { clip: table.string("clip"), file: table.string("file") };
    if base.clip.is_none() && base.file.is_none() {
        table.missing("clip", "name a clip of the rig, as in `clip = \"Idle\"`, or a motion `file`");
    }
    table.finish();
    Some(base)
}

fn force(entry: &mut Reader<'_, '_>, bone: &str) -> Push {
    Push {
        start: entry.required_number("start"),
        duration: entry.required_number("duration"),
        force: entry.required_number("force"),
        toward: direction(entry, "toward"),
        at: role(entry, bone),
    }
}

/// front, back, left, right, degrees, or three numbers.
fn direction(entry: &mut Reader<'_, '_>, key: &'static str) -> Direction {
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
fn role(entry: &mut Reader<'_, '_>, default: &str) -> Role {
    let names: Vec<(&str, Role)> = Role::ALL.iter().map(|role| (role.name(), *role)).collect();
    let default = Role::from_name(default).unwrap_or(Role::Hips);
    entry.choice("at", &names).unwrap_or(default)
}

/// One radius, or the least and the greatest.
fn radius(entry: &mut Reader<'_, '_>) -> [f64; 2] {
    match entry.peek("radius") {
        None => [0.08, 0.2],
        Some(DeValue::Array(_)) => entry.numbers::<2>("radius").unwrap_or([0.1, 0.1]),
        Some(_) => entry.number("radius").map_or([0.1, 0.1], |radius| [radius, radius]),
    }
}

/// Kilograms, or (s, kg) points.
fn mass_curve(entry: &mut Reader<'_, '_>) -> Vec<[f64; 2]> {
    match entry.peek("mass") {
        None => {
            entry.missing("mass", "give kilograms, or [[seconds, kilograms], ...]");
            vec![[0.0, 1.0]]
        }
        Some(DeValue::Array(_)) => entry.points("mass").unwrap_or_else(|| vec![[0.0, 1.0]]),
        Some(_) => vec![[0.0, entry.number("mass").unwrap_or(1.0)]],
    }
}

/// "dir/shove_left.toml" -> "shove_left".
fn title_from(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let stem = file.strip_suffix(".toml").unwrap_or(file);
    let stem: String = stem.chars().take(200).collect();
    if stem.trim().is_empty() { Scenario::default().title } else { stem }
}

fn syntax_fault(text: &str, error: &toml::de::Error) -> TextFault {
    TextFault {
        path: String::new(),
        span: error.span().unwrap_or(text.len()..text.len()),
        message: format!("this is not TOML: {}", error.message()),
        remedy: "`surefoot new scenario` writes an example of every key".to_owned(),
    }
}

/// Whether one path is the other or lies in it.
fn touches(a: &str, b: &str) -> bool {
    let within = |inner: &str, outer: &str| {
        inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('.') || outer.is_empty())
    };
    within(a, b) || within(b, a)
}

/// The nearest range inside of the text that cuts no character.
fn whole_characters(text: &str, span: Range<usize>) -> Range<usize> {
    let start = text.floor_char_boundary(span.start);
    let end = text.ceil_char_boundary(span.end.max(start));
    start..end
}

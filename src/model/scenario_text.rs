//! The text form of a scenario: TOML with degrees, read with the place of every value kept, so that each fault names
//! its line. No I/O: the text comes as a `&str`.
//!
//! Where the TOML itself is broken only the faults of syntax are told, since what follows a broken line is guesswork;
//! otherwise every fault of the document is, unknown keys and wrong types here, the rest by [`Scenario::validate`].

use super::scenario::{Carry, Crouch, Feet, Marker, Push, Scenario, Stand, Throw, Turn, Walk};
use super::scenario_errors::{ScenarioErrors, ScenarioSource, TextFault};
use super::scenario_forms::{direction, mass_curve, radius, role, size_curve};
use super::scenario_reader::Reader;
use super::scenario_tables::{base, character, ground, stepper};
use glam::DVec3;
use toml::de::DeTable;

/// Reads a scenario. `name` is the file's, for messages and for a missing title.
pub fn parse(name: &str, text: &str) -> Result<Scenario, ScenarioErrors> {
    read(name, text).map(|(scenario, _)| scenario)
}

/// As [`parse`], with the places of its values, for faults that are found later.
pub fn read(name: &str, text: &str) -> Result<(Scenario, ScenarioSource), ScenarioErrors> {
    let (document, broken) = DeTable::parse_recoverable(text);
    let mut source = ScenarioSource::new(name, text);
    if !broken.is_empty() {
        let remedy = "`surefoot new scenario` writes an example of every key";
        let faults = broken.iter().map(|error| syntax_fault(text, error, remedy)).collect();
        return Err(source.collect(faults));
    }
    let mut faults = Vec::new();
    let reader = Reader::new("the scenario", document.get_ref(), source.places_mut(), &mut faults);
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
    let further = scenario.validate().into_iter().filter(|rule| !misread.iter().any(|path| touches(path, &rule.path)));
    faults.extend(further.map(|fault| source.locate(&fault)));
    Err(source.collect(faults))
}

/// A commented scenario with every key; its live part is [`Scenario::demo`].
pub fn example_text() -> &'static str {
    include_str!("scenario_example.toml")
}

fn scenario(name: &str, mut root: Reader<'_, '_>) -> Scenario {
    let default = Scenario::default();
    let title = root.string("title").unwrap_or_else(|| title_from(name));
    let duration = root.number("duration").unwrap_or(default.duration);
    let seed = root.whole("seed").unwrap_or(default.seed);
    let character = root.table("character").map(character).unwrap_or_default();
    let ground = root.table("ground").map(ground).unwrap_or_default();
    let stepper = root.table("stepper").map(stepper).unwrap_or_default();
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
        size: size_curve(entry, DVec3::new(0.4, 0.3, 0.3)),
    });
    let marker = root.lane("marker", |entry| Marker {
        time: entry.required_number("time"),
        name: entry.string("name").unwrap_or_default(),
    });
    root.finish();
    Scenario {
        title,
        duration,
        seed,
        character,
        ground,
        stepper,
        base,
        walk,
        turn,
        crouch,
        stand,
        push,
        pull,
        throw,
        carry,
        marker,
    }
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

/// "dir/shove_left.toml" -> "shove_left".
pub(super) fn title_from(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let stem = file.strip_suffix(".toml").unwrap_or(file);
    let stem: String = stem.chars().take(200).collect();
    if stem.trim().is_empty() { Scenario::default().title } else { stem }
}

pub(super) fn syntax_fault(text: &str, error: &toml::de::Error, remedy: &str) -> TextFault {
    TextFault {
        path: String::new(),
        span: error.span().unwrap_or(text.len()..text.len()),
        message: format!("this is not TOML: {}", error.message()),
        remedy: remedy.to_owned(),
    }
}

/// Whether one path is the other or lies in it.
fn touches(a: &str, b: &str) -> bool {
    let within = |inner: &str, outer: &str| {
        inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('.') || outer.is_empty())
    };
    within(a, b) || within(b, a)
}

#[cfg(test)]
mod tests {
    use super::super::scenario::Base;
    use super::*;
    use proptest::prelude::*;

    /// The example with everything that is commented out switched on.
    fn whole_example() -> String {
        let uncomment = |line: &str| match line.strip_prefix("# ") {
            Some(rest) if rest.starts_with('[') || rest.split(' ').nth(1) == Some("=") => rest.to_owned(),
            _ => line.to_owned(),
        };
        example_text().lines().map(uncomment).collect::<Vec<_>>().join("\n")
    }

    /// The only fault of that text: (line, message and remedy).
    fn only_fault(text: &str) -> (usize, String) {
        let errors = parse("shove.toml", text).expect_err("a faulty text");
        assert_eq!(errors.faults.len(), 1, "{errors}");
        let fault = &errors.faults[0];
        (errors.line_column(fault).0, format!("{} / {}", fault.message, fault.remedy))
    }

    #[test]
    fn the_example_is_the_demo() {
        assert_eq!(parse("example.toml", example_text()).expect("a good example"), Scenario::demo());
    }

    #[test]
    fn the_example_shows_every_key_and_all_of_it_parses() {
        let text = whole_example();
        let scenario = parse("example.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(scenario.character.mass, Some(75.0));
        let lanes = [
            scenario.walk.len(),
            scenario.turn.len(),
            scenario.crouch.len(),
            scenario.stand.len(),
            scenario.push.len(),
            scenario.pull.len(),
            scenario.throw.len(),
            scenario.carry.len(),
        ];
        assert_eq!(lanes, [1; 8]);
        assert_eq!(scenario.base, Some(Base { clip: Some("Idle".to_owned()), file: Some("walk.bvh".to_owned()) }));
        assert!((scenario.turn[0].facing - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!(scenario.carry[0].mass, [[0.0, 2.0], [4.0, 25.0]]);
    }

    #[test]
    fn an_empty_text_is_four_seconds_of_standing_named_after_the_file() {
        let scenario = parse("dir/calm day.toml", "").expect("nothing is required");
        assert_eq!(scenario, Scenario { title: "calm day".to_owned(), ..Scenario::default() });
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line_and_the_likely_one() {
        let (line, message) = only_fault("title = \"a\"\nduraton = 3.0\n");
        assert_eq!(line, 2);
        assert_eq!(message, "unknown key `duraton` / did you mean `duration`?");
    }

    #[test]
    fn an_unknown_lane_is_named_at_its_header() {
        let (line, message) = only_fault("\n[[pushh]]\nstart = 1.0\n");
        assert_eq!(line, 2);
        assert!(message.contains("unknown key `pushh`") && message.contains("did you mean `push`?"), "{message}");
    }

    #[test]
    fn each_planted_fault_names_its_line_and_remedy() {
        let push = |line: &str, with: &str| {
            let lines =
                ["[[push]]", "start = 1.0", "duration = 0.2", "force = 100.0", "toward = \"right\"", "at = \"chest\""];
            let key = line.split(' ').next().unwrap_or(line);
            lines
                .iter()
                .map(|old| if old.split(' ').next() == Some(key) { with.to_owned() } else { (*old).to_owned() })
                .collect::<Vec<_>>()
                .join("\n")
        };
        let cases = [
            (push("start", "start = \"soon\""), 2, "must be a number, this is text"),
            (push("start", "start = -0.5"), 2, "times count from 0"),
            (push("start", "start = 9.0"), 2, "start earlier"),
            (push("start", "start = nan"), 2, "not a finite number"),
            (push("start", "start = 3.9"), 3, "at most 0.1 s here"),
            (push("start", ""), 1, "has no `start`"),
            (push("duration", "duration = 0"), 3, "more than 0"),
            (push("force", "force = -100"), 4, "turn `toward` round"),
            (push("force", "force = 1e9"), 4, "give 0 to 20000 N"),
            (push("force", "force = 1e999"), 4, "not a finite number"),
            (push("force", "force = inf"), 4, "not a finite number"),
            (push("toward", "toward = \"rihgt\""), 5, "did you mean \"right\"?"),
            (push("toward", "toward = [0, 0, 0]"), 5, "not zero"),
            (push("toward", "toward = [1, 2]"), 5, "must be 3 numbers, this is a list of 2"),
            (push("toward", "toward = true"), 5, "must be a direction"),
            (push("at", "at = \"Chest\""), 6, "did you mean \"chest\"?"),
            ("[push]\nstart = 1.0".to_owned(), 1, "`[[push]]`"),
            ("push = [3]".to_owned(), 1, "must be a table"),
            ("character = 3".to_owned(), 1, "`[character]`"),
            ("seed = -4".to_owned(), 1, "whole number from 0"),
            ("seed = 1.5".to_owned(), 1, "whole number"),
            ("seed = 99999999999999999999".to_owned(), 1, "out of range"),
            ("seed = 9223372036854775807".to_owned(), 1, "out of range"),
            ("title = \"  \"".to_owned(), 1, "title is empty"),
            ("duration = 601".to_owned(), 1, "at most 600 s"),
            ("[ground]\nkind = \"ice\"".to_owned(), 2, "give \"flat\""),
            ("[ground]\nkind = \"flat\"\nangle = 4".to_owned(), 3, "unknown key `angle`"),
            ("[ground]\nkind = \"slope\"".to_owned(), 1, "has no `angle`"),
            ("[ground]\nkind = \"mesh\"".to_owned(), 1, "has no `file`"),
            ("[ground]\nkind = \"mesh\"\nfile = \" \"".to_owned(), 3, "name of the file is empty"),
            ("[ground]\nkind = \"mesh\"\nfile = \"a.glb\"\nceiling = 0".to_owned(), 4, "0 m is out of range"),
            (
                "[[carry]]\nstart = 0\nmass = 1\nsize = [[0, [1, 1, 1]], [0, [1, 1, 2]]]".to_owned(),
                4,
                "does not come after",
            ),
            (
                "[[carry]]\nstart = 0\nmass = 1\nsize = [[0, [1, 1, 1]], [1, [1, 0, 2]]]".to_owned(),
                4,
                "0 m is out of range",
            ),
            (
                "[[carry]]\nstart = 0\nmass = 1\nsize = [[0, [1, 1, 1]], [1, [1, -2, 2]]]".to_owned(),
                4,
                "-2 m is out of range",
            ),
            ("[[carry]]\nstart = 0\nmass = 1\nsize = [[0, 0.3], [1, 0.4]]".to_owned(), 4, "must be 3 numbers"),
            (
                "[[carry]]\nstart = 0\nmass = 1\nsize = [[0, [1, 1, 1]], 3]".to_owned(),
                4,
                "pairs of a time and three lengths",
            ),
            ("[[carry]]\nstart = 0\nmass = 1\nsize = [0.3, 0.3]".to_owned(), 4, "must be 3 numbers"),
            ("[character]\nagility = 1.01".to_owned(), 2, "give 0 to 1"),
            ("[character]\narms = 1\nbreathing = -0.5".to_owned(), 3, "give 0 to 1"),
            ("title = \"a\"\ntitle = \"b\"".to_owned(), 2, "duplicate key"),
            ("title = \"a".to_owned(), 1, "not TOML"),
            ("[[walk]]\nstart = 1\nspeed = 1\n[[walk]]\nstart = 1.0\nspeed = 0".to_owned(), 5, "two [[walk]] entries"),
            ("[base]\nclip = 3".to_owned(), 2, "must be text"),
        ];
        for (text, line, part) in cases {
            let errors = parse("shove.toml", &text).expect_err(&text);
            let hit = errors.faults.iter().find(|fault| {
                let (at, _) = errors.line_column(fault);
                at == line && format!("{} / {}", fault.message, fault.remedy).contains(part)
            });
            assert!(hit.is_some(), "no `{part}` on line {line} of\n{text}\nbut\n{errors}");
        }
    }

    #[test]
    fn several_faults_come_together_in_the_order_of_the_text() {
        let text = "duraton = 3\n[[push]]\nstart = \"x\"\nduration = 0.1\nforce = -4\ntoward = \"left\"\n";
        let errors = parse("shove.toml", text).expect_err("three faults");
        let lines: Vec<usize> = errors.faults.iter().map(|fault| errors.line_column(fault).0).collect();
        assert_eq!(lines, [1, 3, 5], "{errors}");
    }

    #[test]
    fn a_value_that_could_not_be_read_is_told_once() {
        let (_, message) = only_fault("duration = \"long\"\n");
        assert!(message.contains("must be a number"), "{message}");
        let (_, message) = only_fault("[[carry]]\nstart = 0\nmass = [[0, \"x\"]]\n");
        assert!(message.contains("must be a number"), "{message}");
    }

    #[test]
    fn deep_nesting_is_an_error_not_a_crash() {
        for text in
            [format!("a = {}", "[".repeat(200_000)), format!("a{} = 1", ".a".repeat(100_000)), "[a.".repeat(50_000)]
        {
            parse("deep.toml", &text).expect_err("too deep");
        }
    }

    #[test]
    fn a_byte_order_mark_and_windows_lines_are_fine() {
        let text = format!("\u{feff}{}", example_text().replace('\n', "\r\n"));
        assert_eq!(parse("example.toml", &text).expect("a good example"), Scenario::demo());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn arbitrary_text_never_panics(text in "\\PC{0,200}|[\\[\\]=\\n.\"'a-z0-9{}, #-]{0,300}") {
            check(&text)?;
        }

        #[test]
        fn a_mutated_example_never_panics(
            edits in prop::collection::vec((any::<prop::sample::Index>(), 0_usize..4, "[\\PC\\n]{0,3}"), 1..8)
        ) {
            let mut text: Vec<char> = whole_example().chars().collect();
            for (at, removed, put) in edits {
                let at = at.index(text.len());
                let end = (at + removed).min(text.len());
                text.splice(at..end, put.chars());
            }
            check(&text.into_iter().collect::<String>())?;
        }

        #[test]
        fn a_replaced_value_never_panics(at in any::<prop::sample::Index>(), value in prop::sample::select(vec![
            "0", "-1", "1e308", "nan", "inf", "true", "\"left\"", "[]", "[[]]", "{}", "1979-05-27", "0xff", "[[0,0],[0,0]]",
        ])) {
            let example = whole_example();
            let mut lines: Vec<String> = example.lines().map(str::to_owned).collect();
            let keyed: Vec<usize> = (0..lines.len()).filter(|&line| lines[line].contains(" = ")).collect();
            let line = keyed[at.index(keyed.len())];
            let key = lines[line].split(" = ").next().unwrap_or("x").to_owned();
            lines[line] = format!("{key} = {value}");
            check(&lines.join("\n"))?;
        }
    }

    /// Good, or faults whose places lie in the text.
    fn check(text: &str) -> Result<(), TestCaseError> {
        match parse("any.toml", text) {
            Ok(scenario) => prop_assert_eq!(scenario.validate(), vec![]),
            Err(errors) => {
                prop_assert!(!errors.faults.is_empty());
                for fault in &errors.faults {
                    prop_assert!(text.get(fault.span.clone()).is_some(), "{:?}", fault);
                    prop_assert!(!fault.message.is_empty() && !fault.remedy.is_empty());
                }
                prop_assert_eq!(errors.lines().len(), errors.faults.len());
            }
        }
        Ok(())
    }
}

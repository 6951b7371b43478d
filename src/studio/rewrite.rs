//! A scenario into a text that a person wrote: what did not change stays as it stands, with its comments, order and spelling.
//!
//! Entries of a lane are told apart by their place. Whatever cannot be kept that way is written anew: the text that comes out always reads as
//! the scenario that was meant. No I/O.

use crate::model::Scenario;
use crate::model::scenario_text::parse;
use crate::model::scenario_write::write;
use toml_edit::{ArrayOfTables, DocumentMut, Item, Table, Value};

/// How far a text is changed: the least that does it is taken.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Reach {
    /// Values that are said; entries of lanes.
    Said,
    /// And what was not said so far.
    More,
    /// And what is said but goes without saying now.
    Less,
}

/// The text with the scenario in it.
pub fn rewrite(old: &str, scenario: &Scenario) -> String {
    let plain = write(scenario);
    let (Ok(kept), Ok(new)) = (old.parse::<DocumentMut>(), plain.parse::<DocumentMut>()) else { return plain };
    let says = |text: &str| parse("the text", text).is_ok_and(|read| read == *scenario);
    if says(old) {
        return old.to_owned();
    }
    for reach in [Reach::Said, Reach::More, Reach::Less] {
        let mut merged = kept.clone();
        merge(merged.as_table_mut(), new.as_table(), reach);
        let text = merged.to_string();
        if says(&text) {
            return text;
        }
    }
    plain
}

/// Brings `new` into `old`.
fn merge(old: &mut Table, new: &Table, reach: Reach) {
    let gone: Vec<String> = old
        .iter()
        .filter(|(key, item)| !new.contains_key(key) && (reach == Reach::Less || item.is_array_of_tables()))
        .map(|(key, _)| key.to_owned())
        .collect();
    for key in gone {
        old.remove(&key);
    }
    for (key, item) in new.iter() {
        match (old.get_mut(key), item) {
            (Some(Item::Value(there)), Item::Value(value)) => replace(there, value),
            (Some(Item::Table(there)), Item::Table(table)) => merge(there, table, reach),
            (Some(Item::ArrayOfTables(there)), Item::ArrayOfTables(entries)) => lane(there, entries, reach),
            (None, Item::Value(_)) if reach == Reach::Said => {}
            _ => drop(old.insert(key, item.clone())),
        }
    }
}

fn lane(old: &mut ArrayOfTables, new: &ArrayOfTables, reach: Reach) {
    while old.len() > new.len() {
        old.remove(old.len() - 1);
    }
    for (index, entry) in new.iter().enumerate() {
        match old.get_mut(index) {
            Some(there) => merge(there, entry, reach),
            None => old.push(entry.clone()),
        }
    }
}

/// Another value with the same comment behind it; the same one keeps its spelling.
fn replace(there: &mut Value, value: &Value) {
    let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
    let same = match (number(there), number(value)) {
        (Some(there), Some(value)) => there == value,
        _ => there.to_string().trim() == value.to_string().trim(),
    };
    if !same {
        let decor = there.decor().clone();
        *there = value.clone();
        *there.decor_mut() = decor;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studio::document::{Document, Edit, Lane, Place};

    const OLD: &str = "# The guard is shoved.\ntitle = \"shove\"   # a working title\nduration = 4\nseed = 0\n\n[character]\nmass = 90 # with armour\n\n# The hit itself.\n[[push]]\nstart = 1.0\nduration = 0.2\nforce = 300 # found by trying\ntoward = \"right\"\nat = \"chest\"\n\n[[push]]\nstart = 2\nduration = 0.1\nforce = 100\ntoward = 45\n";

    fn changed(edits: Vec<Edit>) -> (Scenario, String) {
        let mut document = Document::of("builtin".into(), parse("old", OLD).expect("a good text"));
        edits.into_iter().for_each(|edit| document.apply(edit));
        let text = rewrite(OLD, &document.scenario);
        assert_eq!(parse("new", &text).expect("a good text"), document.scenario, "{text}");
        (document.scenario, text)
    }

    #[test]
    fn nothing_changed_is_the_same_text() {
        assert_eq!(changed(vec![]).1, OLD);
    }

    #[test]
    fn a_value_changes_where_it_stands_and_comments_stay() {
        let scenario = parse("old", OLD).expect("a good text");
        let stronger = crate::model::scenario::Push { force: 350.0, ..scenario.push[0] };
        let place = Place { lane: Lane::Push, index: 0 };
        let (_, text) = changed(vec![Edit::Replace(place, crate::studio::document::Entry::Push(stronger))]);
        assert_eq!(text, OLD.replace("force = 300 # found", "force = 350.0 # found"));
    }

    #[test]
    fn entries_come_and_go_and_what_a_person_wrote_above_stays() {
        let (_, text) = changed(vec![
            Edit::Remove(Place { lane: Lane::Push, index: 1 }),
            Edit::Add(Lane::Walk.entry(0.5)),
            Edit::Title("harder".into()),
        ]);
        assert!(text.starts_with("# The guard is shoved.\ntitle = \"harder\"   # a working title"), "{text}");
        assert!(
            text.contains("# The hit itself.") && text.contains("[[walk]]") && !text.contains("start = 2"),
            "{text}"
        );
    }

    #[test]
    fn what_goes_back_to_its_default_is_no_longer_said() {
        let mut character = parse("old", OLD).expect("a good text").character;
        character.mass = None;
        let (_, text) = changed(vec![Edit::Character(character)]);
        assert!(!text.contains("mass"), "{text}");
    }

    #[test]
    fn a_text_that_is_none_is_written_anew() {
        let scenario = Scenario::demo();
        assert_eq!(rewrite("= [", &scenario), write(&scenario));
    }
}

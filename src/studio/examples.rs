//! Scenarios inside of the program, to start from. All of them act on the built-in rig.

use crate::model::{Scenario, scenario_text};

/// Name, what it shows, and text.
const EXAMPLES: [(&str, &str, &str); 3] = [
    (
        "Shoved while standing",
        "a push from the left that takes a step to answer",
        "title = \"shoved while standing\"\nduration = 4.0\nseed = 7\n\n[[push]]\nstart = 0.6\nduration = 0.2\nforce = 420.0\ntoward = \"right\"\nat = \"chest\"\n",
    ),
    (
        "Pushed while walking",
        "walks off, is hit from the side and from behind, goes on and stops",
        "title = \"pushed while walking\"\nduration = 7.0\nseed = 3\n\n[[walk]]\nstart = 0.3\nspeed = 1.2\n\n[[walk]]\nstart = 5.2\nspeed = 0.0\n\n[[push]]\nstart = 2.0\nduration = 0.2\nforce = 300.0\ntoward = \"left\"\nat = \"chest\"\n\n[[push]]\nstart = 3.6\nduration = 0.2\nforce = 250.0\ntoward = \"front\"\nat = \"hips\"\n",
    ),
    (
        "Up the stairs",
        "climbs six stairs at an easy pace and stands on the landing",
        "title = \"up the stairs\"\nduration = 8.0\nseed = 1\n\n[ground]\nkind = \"stairs\"\nrise = 0.16\ntread = 0.32\ncount = 6\n\n[[walk]]\nstart = 0.3\nspeed = 0.7\n\n[[walk]]\nstart = 6.2\nspeed = 0.0\n",
    ),
];

/// Their names, and what they show.
pub fn names() -> impl Iterator<Item = (&'static str, &'static str)> {
    EXAMPLES.iter().map(|(name, what, _)| (*name, *what))
}

/// One of them.
pub fn scenario(index: usize) -> Option<Scenario> {
    let (name, _, text) = EXAMPLES.get(index)?;
    scenario_text::parse(name, text).ok()
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_example_is_a_good_scenario() {
        for index in 0..super::names().count() {
            assert!(super::scenario(index).is_some_and(|scenario| scenario.validate().is_empty()), "{index}");
        }
    }
}

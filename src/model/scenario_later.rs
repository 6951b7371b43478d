//! What a scenario may say that this version of the program cannot bake yet: it is refused by name rather than passed over.

use super::scenario::{Character, Scenario};
use super::scenario_errors::Fault;

impl Scenario {
    /// What the scenario asks for that this version cannot bake.
    pub fn unavailable(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        let mut not_yet = |path: String, what: &str| {
            faults.push(Fault {
                path,
                message: format!("{what} not available yet in this version"),
                remedy: "take it out of the scenario for now".to_owned(),
            });
        };
        let (character, ordinary) = (&self.character, Character::default());
        let dials = [("crouch", character.crouch != ordinary.crouch)];
        for (key, turned) in dials {
            if turned {
                not_yet(format!("character.{key}"), &format!("`{key}` is"));
            }
        }
        if self.base.is_some() {
            not_yet("base".to_owned(), "a base clip is");
        }
        let lanes = [("crouch", self.crouch.len()), ("stand", self.stand.len())];
        for (lane, count) in lanes {
            for index in 0..count {
                not_yet(format!("{lane}.{index}"), &format!("[[{lane}]] is"));
            }
        }
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario::Base;

    #[test]
    fn the_demo_can_be_baked() {
        assert_eq!(Scenario::demo().unavailable(), []);
    }

    #[test]
    fn a_dial_that_does_nothing_yet_may_stand_where_it_is() {
        let mut scenario = Scenario::demo();
        scenario.character.crouch = 0.2;
        scenario.character.leg_scale = 1.2;
        scenario.character.style.recovery_time = 0.9;
        scenario.character.style.arms = 0.9;
        let paths: Vec<String> = scenario.unavailable().into_iter().map(|fault| fault.path).collect();
        assert_eq!(paths, ["character.crouch"]);
    }

    #[test]
    fn what_cannot_be_baked_yet_is_named() {
        let base = Base { clip: Some("Idle".to_owned()), file: None };
        let scenario = Scenario { base: Some(base), ..Scenario::demo() };
        let faults = scenario.unavailable();
        assert_eq!(faults.iter().map(|fault| fault.path.as_str()).collect::<Vec<_>>(), ["base"]);
        assert!(faults[0].message.contains("not available yet in this version"));
    }
}

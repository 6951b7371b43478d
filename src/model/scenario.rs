//! The scenario: what a person writes to say what happens to the character.

/// The scenario document.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {}

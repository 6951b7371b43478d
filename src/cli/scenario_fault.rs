//! Draws the faults of a scenario: its lines, the faulty text underlined, the remedy under it.

use crate::model::ScenarioErrors;
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, SourceCode};
use std::fmt;
use std::io::IsTerminal;

/// More than these are not drawn: whoever mends the first ones sees the rest next time.
const MOST_DRAWN: usize = 20;

/// The faults as text for stderr; in colour on a terminal.
pub fn draw(errors: &ScenarioErrors) -> String {
    let colour = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    draw_with(errors, theme)
}

fn draw_with(errors: &ScenarioErrors, theme: GraphicalTheme) -> String {
    let handler = GraphicalReportHandler::new_themed(theme).with_width(110).with_context_lines(1);
    let source = NamedSource::new(&errors.name, errors.text.clone());
    let mut text = String::new();
    for fault in errors.faults.iter().take(MOST_DRAWN) {
        let label = LabeledSpan::at(fault.span.clone(), "here");
        let drawn = Drawn { message: &fault.message, remedy: &fault.remedy, label, source: &source };
        if handler.render_report(&mut text, &drawn).is_err() {
            let (line, column) = errors.line_column(fault);
            text.push_str(&format!("{}:{line}:{column}: {} ({})\n", errors.name, fault.message, fault.remedy));
        }
    }
    let more = errors.faults.len().saturating_sub(MOST_DRAWN);
    if more > 0 {
        text.push_str(&format!("... and {more} more\n"));
    }
    text
}

/// One fault as miette wants it.
#[derive(Debug)]
struct Drawn<'e> {
    message: &'e str,
    remedy: &'e str,
    label: LabeledSpan,
    source: &'e NamedSource<String>,
}

impl fmt::Display for Drawn<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.message)
    }
}

impl std::error::Error for Drawn<'_> {}

impl Diagnostic for Drawn<'_> {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.remedy))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(self.label.clone())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario_text::parse;

    fn drawn(text: &str) -> String {
        draw_with(&parse("shove.toml", text).expect_err("a fault"), GraphicalTheme::unicode_nocolor())
    }

    #[test]
    fn a_fault_shows_its_file_line_text_and_remedy() {
        let drawn = drawn(
            "title = \"a\"\nduraton = 3.0\n\n[[push]]\nstart = 1.0\nduration = 0.2\nforce = \"300\"\ntoward = \"left\"\n",
        );
        insta::assert_snapshot!(drawn, @r#"
          × unknown key `duraton`
           ╭─[shove.toml:2:1]
         1 │ title = "a"
         2 │ duraton = 3.0
           · ───┬───
           ·    ╰── here
         3 │ 
           ╰────
          help: did you mean `duration`?
          × `force` must be a number, this is text
           ╭─[shove.toml:7:9]
         6 │ duration = 0.2
         7 │ force = "300"
           ·         ──┬──
           ·           ╰── here
         8 │ toward = "left"
           ╰────
          help: give a plain number, without quotes
        "#);
    }

    #[test]
    fn faults_at_the_edges_of_a_text_can_be_drawn() {
        for text in ["a", "x = ", "=", "\u{feff}\"", "é = 1", "[[push]]", "\r\n\r\n[[pull]]\r\n", "title = \"ü", "[\n"]
        {
            let drawn = drawn(text);
            assert!(drawn.contains("help:"), "{text:?}: {drawn}");
        }
    }

    #[test]
    fn very_many_faults_are_cut_short() {
        let drawn = drawn(&(0..300).map(|i| format!("k{i} = 1\n")).collect::<String>());
        assert!(drawn.contains("and 280 more"), "{drawn}");
    }
}

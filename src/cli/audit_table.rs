//! The table of an audit: one row a frame, comma-separated, metres and seconds; empty where there is nothing (a margin in flight).

use super::waivers::Waived;
use crate::model::findings::{Findings, Rule};
use crate::picture::report_frames::FrameRow;
use std::fmt::Write;

/// The first line.
pub const HEAD: &str = "frame,time,com_x,com_y,com_z,speed,xi_x,xi_z,zmp_x,zmp_z,margin,left_contact,right_contact,\
                        left_sole_height,right_sole_height,flags,clip,file\n";

/// The rows of a clip. Flags that are waived are not in them.
pub fn rows(file: &str, rows: &[FrameRow], findings: &Findings, waived: &Waived) -> String {
    let mut flags: Vec<Vec<Rule>> = vec![Vec::new(); rows.len()];
    for (flag, reason) in findings.flags.iter().zip(&waived.flags) {
        let end = (flag.end + 1).min(rows.len());
        for frame in flags.get_mut(flag.start..end).into_iter().flatten().filter(|_| reason.is_none()) {
            frame.push(flag.rule);
        }
    }
    let names = format!("{},{}", cell(&findings.clip), cell(file));
    let mut text = String::with_capacity(rows.len() * 160);
    for (row, rules) in rows.iter().zip(&mut flags) {
        rules.sort();
        rules.dedup();
        let rules: Vec<&str> = rules.iter().map(|rule| rule.name()).collect();
        let or_empty = |value: Option<f64>| value.map(|value| format!("{value:.4}")).unwrap_or_default();
        writeln!(
            text,
            "{},{:.4},{:.4},{:.4},{:.4},{:.4},{:.4},{:.4},{},{},{},{},{},{:.4},{:.4},{},{names}",
            row.frame,
            row.time,
            row.com.x,
            row.com.y,
            row.com.z,
            row.speed,
            row.xi.x,
            row.xi.y,
            or_empty(row.zmp.map(|zmp| zmp.x)),
            or_empty(row.zmp.map(|zmp| zmp.y)),
            or_empty(row.margin),
            row.parts[0].unwrap_or_default(),
            row.parts[1].unwrap_or_default(),
            row.soles[0],
            row.soles[1],
            rules.join("|"),
        )
        .expect("a string takes all");
    }
    text
}

/// A cell of any text (RFC 4180). One that a spreadsheet would run as a formula gets a quote before it.
fn cell(text: &str) -> String {
    let text = if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{text}") } else { text.to_owned() };
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_quoted_and_formulas_disarmed() {
        assert_eq!(cell("walk"), "walk");
        assert_eq!(cell("a,\"b\"\n"), "\"a,\"\"b\"\"\n\"");
        assert_eq!(cell("=cmd()"), "'=cmd()");
    }
}

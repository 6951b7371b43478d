//! Findings for people: one clip worst first, or many clips as one table.

use super::audit::{Audited, Unread};
use crate::model::findings::{Findings, Rule};
use std::path::PathBuf;

/// Share of the frames: where so many are not judged, the table says why.
const MOSTLY: f64 = 0.5;
/// Spans of one abstention past that many are counted, not listed.
const MOST_LISTED: usize = 6;

/// One clip.
pub fn clip(clip: &Audited) -> String {
    let Audited { path, findings, waived, .. } = clip;
    let seconds = findings.frames as f64 / findings.fps;
    let mut text = format!("file       {}\n", path.display());
    text.push_str(&format!(
        "clip       {}: {seconds:.2} s, {} frames at {} fps, unit {} m, up {}, confidence {:.2}\n",
        findings.clip,
        findings.frames,
        short(findings.fps),
        short(findings.units_to_metres),
        findings.up,
        findings.confidence
    ));
    let standing = waived.standing();
    let accepted = waived.flags.len() + waived.clip_flags.len() - standing;
    let accepted = if accepted > 0 { format!(", {accepted} waived") } else { String::new() };
    let unjudged = 100.0 * unjudged(findings);
    let unjudged = if unjudged > 0.0 { format!("; {unjudged:.0} % of the frames not judged") } else { String::new() };
    text.push_str(&match standing {
        0 => format!("verdict    no flags{accepted}{unjudged}\n"),
        1 => format!("verdict    1 flag, {:.1} % of the frames{accepted}{unjudged}\n", 100.0 * share(clip)),
        many => format!("verdict    {many} flags, {:.1} % of the frames{accepted}{unjudged}\n", 100.0 * share(clip)),
    });
    for (flag, reason) in findings.clip_flags.iter().zip(&waived.clip_flags) {
        let reason = reason.as_ref().map(|reason| format!("  [waived: {reason}]")).unwrap_or_default();
        text.push_str(&format!("  whole clip  {}: {}{reason}\n", flag.rule.name(), flag.why));
    }
    let rows: Vec<[String; 6]> = worst_first(clip).into_iter().map(|index| flag_row(clip, index)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths = [0, 1, 2, 3, 4].map(width);
    for row in &rows {
        let mut line = String::from("  ");
        for (column, width) in widths.into_iter().enumerate() {
            let pad = " ".repeat(width - row[column].chars().count());
            let right = column == 4;
            line.push_str(&if right { format!("{pad}{}  ", row[column]) } else { format!("{}{pad}  ", row[column]) });
        }
        line.push_str(&row[5]);
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text.push_str(&steps(findings));
    text.push_str(&abstained(findings));
    for (index, note) in findings.notes.iter().enumerate() {
        text.push_str(&format!("{:<11}{note}\n", if index == 0 { "note" } else { "" }));
    }
    text
}

/// Many clips.
pub fn summary(clips: &[Audited], unread: &[Unread]) -> String {
    let count = |clip: &Audited, rule: Rule| {
        let flags = clip.findings.flags.iter().map(|flag| flag.rule).zip(&clip.waived.flags);
        let clip_flags = clip.findings.clip_flags.iter().map(|flag| flag.rule).zip(&clip.waived.clip_flags);
        flags.chain(clip_flags).filter(|(other, reason)| *other == rule && reason.is_none()).count()
    };
    let rules: Vec<Rule> =
        Rule::ALL.into_iter().filter(|rule| clips.iter().any(|clip| count(clip, *rule) > 0)).collect();
    let shared = shared_folders(clips);
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut head = vec!["clip".to_owned(), "seconds".to_owned()];
    head.extend(rules.iter().map(|rule| rule.name().to_owned()));
    head.extend(["flagged %", "not judged %", "confidence", "worst"].map(str::to_owned));
    rows.push(head);
    for clip in clips {
        let mut row = vec![name(clip, shared), format!("{:.1}", clip.findings.frames as f64 / clip.findings.fps)];
        row.extend(rules.iter().map(|rule| match count(clip, *rule) {
            0 => "-".to_owned(),
            count => count.to_string(),
        }));
        let unjudged = match unjudged(&clip.findings) {
            0.0 => "-".to_owned(),
            share => format!("{:.0}", 100.0 * share),
        };
        row.extend([
            format!("{:.1}", 100.0 * share(clip)),
            unjudged,
            format!("{:.2}", clip.findings.confidence),
            worst(clip),
        ]);
        rows.push(row);
    }
    let last = rows[0].len() - 1;
    let widths: Vec<usize> =
        (0..last).map(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0)).collect();
    let mut text = String::new();
    for row in &rows {
        let mut line = String::new();
        for (column, cell) in row[..last].iter().enumerate() {
            let pad = " ".repeat(widths[column] - cell.chars().count());
            line.push_str(&if column == 0 { format!("{cell}{pad}  ") } else { format!("{pad}{cell}  ") });
        }
        line.push_str(&row[last]);
        text.push_str(line.trim_end());
        text.push('\n');
    }
    for failure in unread {
        text.push_str(&format!("{}\n", failure.cause.lines().next().unwrap_or_default()));
    }
    let frames: usize = clips.iter().map(|clip| clip.findings.frames).sum();
    let flagged: f64 = clips.iter().map(|clip| share(clip) * clip.findings.frames as f64).sum();
    let seconds: f64 = clips.iter().map(|clip| clip.findings.frames as f64 / clip.findings.fps).sum();
    let with_flags = clips.iter().filter(|clip| clip.waived.standing() > 0).count();
    text.push_str(&format!(
        "{} clips, {:.1} min: {with_flags} with flags, in {:.1} % of the frames{}\n",
        clips.len(),
        seconds / 60.0,
        100.0 * flagged / (frames.max(1) as f64),
        if unread.is_empty() { String::new() } else { format!("; {} could not be read", unread.len()) }
    ));
    text
}

/// Names as they are but for what would drive a terminal.
pub fn plain(text: &str) -> String {
    let harmless = |letter: char| letter == '\n' || !letter.is_control();
    text.chars().map(|letter| if harmless(letter) { letter } else { '\u{fffd}' }).collect()
}

/// Share of the frames that a standing flag covers; clip flags apart.
pub fn share(clip: &Audited) -> f64 {
    let flags = clip.findings.flags.iter().zip(&clip.waived.flags);
    covered(&clip.findings, flags.filter(|(_, reason)| reason.is_none()).map(|(flag, _)| (flag.start, flag.end)))
}

/// Why nothing is said of most of a clip, in short; empty where most of it was judged.
fn silence(findings: &Findings) -> String {
    if unjudged(findings) < MOSTLY {
        return String::new();
    }
    let frames = |why: &str| -> usize {
        let spans = findings.abstained.iter().filter(|span| span.why == why);
        spans.map(|span| span.end + 1 - span.start).sum()
    };
    let longest = findings.abstained.iter().map(|span| span.why.as_str()).rev().max_by_key(|why| frames(why));
    longest.map(|why| format!("not judged: {}", why.split(':').next().unwrap_or(why))).unwrap_or_default()
}

/// Share of the frames of which nothing is said.
fn unjudged(findings: &Findings) -> f64 {
    covered(findings, findings.abstained.iter().map(|span| (span.start, span.end)))
}

fn covered(findings: &Findings, spans: impl Iterator<Item = (usize, usize)>) -> f64 {
    let mut covered = vec![false; findings.frames];
    for (start, end) in spans {
        let end = (end + 1).min(covered.len());
        if let Some(span) = covered.get_mut(start..end) {
            span.fill(true);
        }
    }
    covered.iter().filter(|covered| **covered).count() as f64 / covered.len().max(1) as f64
}

/// The file as it lies below the folder that all share, with the clip's name where that is another.
fn name(clip: &Audited, shared: usize) -> String {
    let path: PathBuf = clip.path.components().skip(shared).collect();
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    match stem == clip.findings.clip {
        true => path.display().to_string(),
        false => format!("{}: {}", path.display(), clip.findings.clip),
    }
}

/// How many of their first components all paths share; never a file's own name.
fn shared_folders(clips: &[Audited]) -> usize {
    let folders = |clip: &Audited| clip.path.parent().map(|parent| parent.components().count()).unwrap_or(0);
    let Some(first) = clips.first() else { return 0 };
    clips.iter().fold(folders(first), |shared, clip| {
        let pairs = first.path.components().zip(clip.path.components());
        pairs.take(shared.min(folders(clip))).take_while(|(a, b)| a == b).count()
    })
}

/// Indices of flags: standing ones before waived ones, then by severity.
fn worst_first(clip: &Audited) -> Vec<usize> {
    let flags = &clip.findings.flags;
    let mut order: Vec<usize> = (0..flags.len()).collect();
    order.sort_by(|a, b| {
        let waived = |index: usize| clip.waived.flags[index].is_some();
        waived(*a)
            .cmp(&waived(*b))
            .then(flags[*b].severity.total_cmp(&flags[*a].severity))
            .then(flags[*a].start.cmp(&flags[*b].start))
    });
    order
}

/// Frames, seconds, rule, foot, centimetres, why.
fn flag_row(clip: &Audited, index: usize) -> [String; 6] {
    let flag = &clip.findings.flags[index];
    let at = |frame: usize| frame as f64 / clip.findings.fps;
    let reason = clip.waived.flags[index].as_ref().map(|reason| format!("  [waived: {reason}]")).unwrap_or_default();
    [
        format!("{}-{}", flag.start, flag.end),
        format!("{:.2}-{:.2} s", at(flag.start), at(flag.end)),
        flag.rule.name().to_owned(),
        flag.foot.unwrap_or_default().to_owned(),
        centimetres(flag.delta_m),
        format!("{}{reason}", flag.why),
    ]
}

fn worst(clip: &Audited) -> String {
    match worst_first(clip).first().filter(|index| clip.waived.flags[**index].is_none()) {
        Some(index) => {
            let flag = &clip.findings.flags[*index];
            let foot = flag.foot.map(|foot| format!(" {foot}")).unwrap_or_default();
            let off = centimetres(flag.delta_m);
            let off = if off.is_empty() { off } else { format!(" {off}") };
            format!("{}{foot}{off} at {}-{}", flag.rule.name(), flag.start, flag.end)
        }
        None => {
            let standing =
                clip.findings.clip_flags.iter().zip(&clip.waived.clip_flags).find(|(_, reason)| reason.is_none());
            standing.map_or_else(
                || silence(&clip.findings),
                |(flag, _)| {
                    format!(
                        "{} of the whole clip: {}",
                        flag.rule.name(),
                        flag.why.split(':').next().unwrap_or_default()
                    )
                },
            )
        }
    }
}

fn steps(findings: &Findings) -> String {
    let mut errors: Vec<f64> = findings.steps.iter().map(|step| step.error_m).collect();
    errors.sort_by(f64::total_cmp);
    match errors.len() {
        0 => "steps      none judged\n".to_owned(),
        count => {
            let middle = 0.5 * (errors[(count - 1) / 2] + errors[count / 2]);
            format!("steps      {count}, {:.1} cm from the prediction in the median\n", 100.0 * middle)
        }
    }
}

/// A line a reason, in the order of their first frames.
fn abstained(findings: &Findings) -> String {
    let mut reasons: Vec<&str> = Vec::new();
    for span in &findings.abstained {
        if !reasons.contains(&span.why.as_str()) {
            reasons.push(&span.why);
        }
    }
    let mut text = String::new();
    for (index, why) in reasons.into_iter().enumerate() {
        let spans: Vec<String> = findings
            .abstained
            .iter()
            .filter(|span| span.why == why)
            .map(|span| format!("{}-{}", span.start, span.end))
            .collect();
        let more = match spans.len().saturating_sub(MOST_LISTED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let shown = spans[..spans.len().min(MOST_LISTED)].join(", ");
        let head = if index == 0 { "abstained" } else { "" };
        text.push_str(&format!("{head:<11}{why}: frames {shown}{more}\n"));
    }
    text
}

/// Empty where the rule measures no length.
fn centimetres(metres: f64) -> String {
    if metres == 0.0 || !metres.is_finite() { String::new() } else { format!("{:.1} cm", 100.0 * metres) }
}

/// A number without zeros at its end.
fn short(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

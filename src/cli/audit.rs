//! `surefoot audit`: clips to findings, as text for people, JSON, a table, a page; exit 1 with `--strict` and a flag that stands.
//!
//! Files are read and judged side by side; results come in the order of the files, whatever the number of jobs. A file that cannot be
//! read among several is told with its cause, the rest goes on, and the exit is 2.

use super::args::AuditArgs;
use super::waivers::{self, Waived, Waivers};
use super::{audit_json, audit_table, audit_text, say, tell};
use crate::audit::{AuditOptions, audit};
use crate::disk::clip_files::{self, ClipFile};
use crate::disk::writer::{self, Output};
use crate::disk::{Exit, Failure};
use crate::mocap;
use crate::model::Capture;
use crate::model::findings::Findings;
use crate::picture::report_frames::frame_rows;
use crate::picture::report_page::{ClipView, MOST_BYTES, clip_json, report_page};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// A clip that was judged.
pub struct Audited {
    /// Its file, as it was named.
    pub path: PathBuf,
    /// What was found.
    pub findings: Findings,
    /// What of it a person accepted.
    pub waived: Waived,
    /// What each waiver covered here.
    used: Vec<usize>,
    /// Rows of the table, where it is wanted.
    table: String,
    /// Data of the page, where it is wanted.
    page: String,
}

/// A file that was not.
pub struct Unread {
    /// Its name.
    pub path: PathBuf,
    /// Why: begins with the file's name.
    pub cause: String,
    /// The program is to blame, not the file.
    pub broke_down: bool,
}

/// Audits.
pub fn run(args: &AuditArgs) -> Result<Exit, Failure> {
    let (files, several) = clip_files::expand(&args.clips)?;
    let json_file = args.json.as_ref().filter(|path| path.as_os_str() != "-");
    let outputs: Vec<&Path> = [json_file, args.csv.as_ref(), args.html.as_ref(), args.write_waivers.as_ref()]
        .into_iter()
        .flatten()
        .map(PathBuf::as_path)
        .collect();
    let mut inputs: Vec<PathBuf> = Vec::new();
    for file in &files {
        inputs.push(file.path.clone());
        inputs.push(file.path.with_extension("bones.toml"));
    }
    inputs.extend(args.waive.clone());
    writer::check(&outputs, &inputs)?;
    let waivers = args.waive.as_deref().map(waivers::read).transpose()?.unwrap_or_default();
    let work = Work {
        args,
        reading: mocap::Options { fps: args.fps, up: args.up.as_deref().and_then(mocap::up_axis), unit: args.unit },
        options: AuditOptions { floor: args.floor, ..AuditOptions::default() },
        waivers: &waivers,
        share: MOST_BYTES / files.len().max(1),
    };
    let (clips, unread) = work.all(&files)?;
    let told_alone = unread.len() == 1 && clips.is_empty() && files.len() == 1;
    if told_alone {
        let failure = &unread[0];
        let exit = if failure.broke_down { Exit::Failed } else { Exit::BadInput };
        return Err(Failure { exit, message: failure.cause.clone(), faults: None });
    }
    let several = several || clips.len() + unread.len() > 1;
    for idle in waivers.idle(&used(&clips, waivers.len())) {
        tell(&format!("warning: {idle}"));
    }
    write(args, &clips, several, &inputs)?;
    let json_out = args.json.is_some() && json_file.is_none();
    if json_out {
        say(&audit_json::text(&clips, several))?;
    } else if several {
        say(&audit_text::plain(&audit_text::summary(&clips, &unread)))?;
    } else {
        for clip in &clips {
            say(&audit_text::plain(&audit_text::clip(clip)))?;
        }
    }
    finish(args, &clips, &unread, several && !json_out)
}

/// What stands at the end: unread files before flags.
fn finish(args: &AuditArgs, clips: &[Audited], unread: &[Unread], told: bool) -> Result<Exit, Failure> {
    // The summary has told them already.
    for failure in unread.iter().filter(|_| !told) {
        tell(&audit_text::plain(&format!("error: {}", failure.cause)));
    }
    let broke_down = unread.iter().any(|failure| failure.broke_down);
    match unread.len() {
        0 => {}
        count => {
            let exit = if broke_down { Exit::Failed } else { Exit::BadInput };
            return Err(Failure {
                exit,
                message: format!("{count} of {} clips could not be read", count + clips.len()),
                faults: None,
            });
        }
    }
    if clips.is_empty() {
        return Err(Failure::bad_input(match &args.clip {
            Some(name) => format!("no clip {name:?} in any of the files"),
            None => "no clip in any of the files".to_owned(),
        }));
    }
    let standing: usize = clips.iter().map(|clip| clip.waived.standing()).sum();
    if args.strict && standing > 0 {
        tell(&format!("strict: {standing} {} not waived", if standing == 1 { "flag is" } else { "flags are" }));
        return Ok(Exit::Refused);
    }
    Ok(Exit::Done)
}

fn write(args: &AuditArgs, clips: &[Audited], several: bool, inputs: &[PathBuf]) -> Result<(), Failure> {
    let mut outputs: Vec<Output> = Vec::new();
    let mut put = |path: &Option<PathBuf>, text: &dyn Fn() -> String| {
        if let Some(path) = path.as_ref().filter(|path| path.as_os_str() != "-") {
            outputs.push(Output { path: path.clone(), bytes: text().into_bytes() });
        }
    };
    put(&args.json, &|| audit_json::text(clips, several));
    put(&args.csv, &|| {
        let rows: Vec<&str> = clips.iter().map(|clip| clip.table.as_str()).collect();
        format!("{}{}", audit_table::HEAD, rows.concat())
    });
    put(&args.html, &|| {
        let title = match clips {
            [one] => one.findings.clip.clone(),
            many => format!("{} clips", many.len()),
        };
        report_page(&title, &clips.iter().map(|clip| clip.page.clone()).collect::<Vec<_>>())
    });
    put(&args.write_waivers, &|| {
        let all: Vec<_> = clips.iter().map(|clip| (clip.path.as_path(), &clip.findings, &clip.waived)).collect();
        waivers::write(&all)
    });
    if outputs.is_empty() {
        return Ok(());
    }
    writer::write(&outputs, inputs)?;
    for output in &outputs {
        tell(&audit_text::plain(&format!("wrote {}", output.path.display())));
    }
    Ok(())
}

/// How often each waiver covered something.
fn used(clips: &[Audited], waivers: usize) -> Vec<usize> {
    (0..waivers).map(|index| clips.iter().map(|clip| clip.used[index]).sum()).collect()
}

/// What is the same for every file.
struct Work<'a> {
    args: &'a AuditArgs,
    reading: mocap::Options,
    options: AuditOptions,
    waivers: &'a Waivers,
    /// Bytes that a file may take of the page.
    share: usize,
}

impl Work<'_> {
    /// Every file, in order.
    fn all(&self, files: &[ClipFile]) -> Result<(Vec<Audited>, Vec<Unread>), Failure> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.args.jobs.map_or(0, usize::from))
            .build()
            .map_err(|error| Failure::failed(format!("cannot start the jobs: {error}")))?;
        let bar = if files.len() > 1 { ProgressBar::new(files.len() as u64) } else { ProgressBar::hidden() };
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} clips, {eta} left") {
            bar.set_style(style);
        }
        let judged: Vec<Vec<Result<Audited, Unread>>> = pool.install(|| {
            let one = |file: &ClipFile| {
                let outcome = self.guarded(file);
                bar.inc(1);
                outcome
            };
            files.par_iter().map(one).collect()
        });
        bar.finish_and_clear();
        let (mut clips, mut unread) = (Vec::new(), Vec::new());
        for outcome in judged.into_iter().flatten() {
            match outcome {
                Ok(clip) => clips.push(clip),
                Err(failure) => unread.push(failure),
            }
        }
        Ok((clips, unread))
    }

    /// One file; a panic, which would be a bug, is that file's alone.
    fn guarded(&self, file: &ClipFile) -> Vec<Result<Audited, Unread>> {
        catch_unwind(AssertUnwindSafe(|| self.one(file))).unwrap_or_else(|_| {
            let what = "surefoot broke down on this file\n  help: this is a bug. Please report it with the file";
            let cause = format!("{}: {what}", file.path.display());
            vec![Err(Unread { path: file.path.clone(), cause, broke_down: true })]
        })
    }

    fn one(&self, file: &ClipFile) -> Vec<Result<Audited, Unread>> {
        let unread = |cause: String| Unread { path: file.path.clone(), cause, broke_down: false };
        let opened = match clip_files::open(file, self.args.clip.as_deref()) {
            Ok(None) => return Vec::new(),
            Ok(Some(opened)) => opened,
            Err(cause) => return vec![Err(unread(cause))],
        };
        let share = self.share / opened.wanted.len().max(1);
        let one = |index: &usize| match opened.capture(*index, &self.reading) {
            Ok(capture) => Ok(self.clip(&file.path, &capture, share)),
            Err(cause) => Err(unread(cause)),
        };
        opened.wanted.iter().map(one).collect()
    }

    fn clip(&self, path: &Path, capture: &Capture, share: usize) -> Audited {
        let findings = audit(capture, &self.options);
        let mut used = vec![0; self.waivers.len()];
        let waived = self.waivers.apply(path, &findings, &mut used);
        let (mut table, mut page) = (String::new(), String::new());
        if self.args.csv.is_some() || self.args.html.is_some() {
            let rows = frame_rows(capture, &findings);
            let file = path.display().to_string();
            if self.args.csv.is_some() {
                table = audit_table::rows(&file, &rows, &findings, &waived);
            }
            if self.args.html.is_some() {
                let view = ClipView {
                    file: &file,
                    capture,
                    findings: &findings,
                    rows: &rows,
                    waived: &waived.flags,
                    waived_clip: &waived.clip_flags,
                };
                page = clip_json(&view, share);
            }
        }
        Audited { path: path.to_path_buf(), findings, waived, used, table, page }
    }
}

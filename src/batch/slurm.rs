//! A batch as scripts for Slurm: an array of chunks, a merge that waits for it, and one that submits both. POSIX sh.
//!
//! The array's numbers are chunks from 0. A cluster takes 1001 of them unless its `MaxArraySize` says otherwise, so chunks grow
//! until there are no more than that. A chunk that was killed is queued again and goes on where it was.

use super::farm::{FarmFile, FarmJob};
use std::fmt::Write;

/// Chunks at most: `MaxArraySize` is 1001 by default and one more than the largest number.
const MOST_CHUNKS: usize = 1000;
/// Letters of a job's name.
const MOST_NAME: usize = 40;

/// The scripts.
pub fn scripts(job: &FarmJob) -> Vec<FarmFile> {
    let job = &FarmJob { chunk: job.chunk.max(job.count.div_ceil(MOST_CHUNKS)).max(1), ..job.clone() };
    vec![file("chunks.sh", chunks(job)), file("merge.sh", merge(job)), file("submit.sh", submit(job))]
}

fn chunks(job: &FarmJob) -> String {
    let last = job.chunk_count().saturating_sub(1);
    let mut text = head(job, "", job.patience());
    let _ = write!(
        text,
        "#SBATCH --array=0-{last}\n\
         #SBATCH --requeue\n\
         # Bakes the variations of one chunk; which one, SLURM_ARRAY_TASK_ID says. submit.sh submits it.\n\
         set -eu\n\
         count={}\n\
         size={}\n\
         first=$((SLURM_ARRAY_TASK_ID * size + 1))\n\
         last=$((first + size - 1))\n\
         if [ \"$last\" -gt \"$count\" ]; then last=$count; fi\n\
         exec {} --tolerant --only \"$first-$last\" --jobs \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
        job.count,
        job.chunk,
        command(job),
    );
    text
}

fn merge(job: &FarmJob) -> String {
    let mut text = head(job, "_merge", job.patience());
    let _ = write!(
        text,
        "#SBATCH --requeue\n\
         # Finds all chunks done and makes manifest, sheet and coverage; what is missing it bakes.\n\
         set -eu\n\
         exec {} --jobs \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
        command(job),
    );
    text
}

fn submit(job: &FarmJob) -> String {
    format!(
        "#!/bin/sh\n\
         # Submits {} chunks of up to {} variations, and the merge that waits for them. What it is given goes to both:\n\
         #   ./submit.sh --partition=cpu --cpus-per-task=8\n\
         set -eu\n\
         here=$(CDPATH='' cd -- \"$(dirname -- \"$0\")\" && pwd -P)\n\
         cd -- \"$here\"\n\
         mkdir -p logs\n\
         array=$(sbatch --parsable --output=logs/chunk_%a_%A.log \"$@\" ./chunks.sh)\n\
         array=${{array%%;*}}\n\
         merge=$(sbatch --parsable --output=logs/merge_%j.log \"$@\" --dependency=\"afterok:$array\" --kill-on-invalid-dep=yes ./merge.sh)\n\
         printf 'chunks: job %s\\nmerge:  job %s\\n' \"$array\" \"${{merge%%;*}}\"\n",
        job.chunk_count(),
        job.chunk,
    )
}

/// What a script begins with.
fn head(job: &FarmJob, part: &str, seconds: u64) -> String {
    let letter = |letter: char| if letter.is_ascii_alphanumeric() || "-_.".contains(letter) { letter } else { '_' };
    let name: String = job.title(MOST_NAME).chars().map(letter).collect();
    format!("#!/bin/sh\n#SBATCH --job-name={name}{part}\n#SBATCH --ntasks=1\n#SBATCH --time={}\n", seconds.div_ceil(60))
}

/// The program and what every run is given, for sh.
fn command(job: &FarmJob) -> String {
    let mut words = vec![job.program.as_str(), "batch", &job.sweep, "-o", &job.output];
    words.extend(job.flags.iter().map(String::as_str));
    words.into_iter().map(quoted).collect::<Vec<String>>().join(" ")
}

/// One word for sh, whatever is in it.
fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

fn file(name: &'static str, text: String) -> FarmFile {
    FarmFile { name, bytes: text.into_bytes(), script: true }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::farm::tests::job;

    fn text(job: &FarmJob, name: &str) -> String {
        let file = scripts(job).into_iter().find(|file| file.name == name).expect("the script");
        String::from_utf8(file.bytes).expect("UTF-8")
    }

    /// What a script's program is called with, by a real sh: the program prints its arguments, each ended by a NUL.
    #[cfg(unix)]
    fn called(job: &FarmJob, script: &str, task: usize) -> Vec<String> {
        let text = text(job, script).replacen("exec surefoot", "exec printf '%s\\0'", 1);
        let mut shell = std::process::Command::new("sh");
        shell.arg("-c").arg(text).env("SLURM_ARRAY_TASK_ID", task.to_string()).env_remove("SLURM_CPUS_PER_TASK");
        let output = shell.output().expect("sh runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let words = String::from_utf8(output.stdout).expect("UTF-8");
        words.trim_end_matches('\0').split('\0').map(str::to_owned).collect()
    }

    #[cfg(unix)]
    #[test]
    fn a_shell_gives_every_chunk_its_numbers_and_paths_as_they_are() {
        for (count, size) in [(100, 24), (96, 24), (5, 1), (3, 50)] {
            let job = FarmJob { flags: vec!["--merge".to_owned()], ..job(count, size) };
            for (task, (first, last)) in job.chunks().enumerate() {
                let only = format!("{first}-{last}");
                let wanted =
                    ["batch", &job.sweep, "-o", &job.output, "--merge", "--tolerant", "--only", &only, "--jobs", "1"];
                assert_eq!(called(&job, "chunks.sh", task), wanted);
            }
            assert!(text(&job, "chunks.sh").contains(&format!("#SBATCH --array=0-{}\n", job.chunk_count() - 1)));
            let wanted = ["batch", &job.sweep, "-o", &job.output, "--merge", "--jobs", "1"];
            assert_eq!(called(&job, "merge.sh", 0), wanted);
        }
    }

    #[test]
    fn chunks_grow_until_a_cluster_takes_them() {
        let text = text(&job(10_000, 1), "chunks.sh");
        assert!(text.contains("--array=0-999\n") && text.contains("\nsize=10\n"), "{text}");
        assert!(self::text(&job(10_001, 1), "chunks.sh").contains("--array=0-909\n"), "eleven each");
    }

    #[test]
    fn directives_hold_only_what_a_cluster_reads_as_one_word() {
        let job = FarmJob { name: "hit; rm -rf ~ \"x\" \n#SBATCH --uid=0".to_owned(), ..job(3, 1) };
        for name in ["chunks.sh", "merge.sh"] {
            let text = text(&job, name);
            let directives: Vec<&str> = text.lines().filter(|line| line.starts_with("#SBATCH")).collect();
            assert!((4..=5).contains(&directives.len()), "{directives:?}");
            let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_.=#% ".contains(letter);
            assert!(
                directives.iter().all(|line| line.chars().all(plain) && line.split(' ').count() == 2),
                "{directives:?}"
            );
        }
    }

    #[test]
    fn words_are_quoted_where_they_must_be() {
        assert_eq!(
            ["a/b.toml", "", "it's", "a b", "$x", "é"].map(quoted),
            ["a/b.toml", "''", r"'it'\''s'", "'a b'", "'$x'", "'é'"]
        );
    }
}

//! A batch as an Open Job Description bundle (template schema 2023-09, without extensions), as AWS Deadline Cloud takes it.
//!
//! A chunk's first and last variation are two integer parameters of a task that go together: their ranges are expressions, which
//! have no limit on their length where lists of strings end at 1024. The commands are given as arguments, so no shell reads a path.

use super::farm::{FarmFile, FarmJob};
use serde_json::{Value, json};

/// Letters of a job's name, by the specification.
const MOST_NAME: usize = 128;

/// The bundle's files.
pub fn bundle(job: &FarmJob) -> Vec<FarmFile> {
    let values = [("SweepFile", &job.sweep), ("OutputFolder", &job.output), ("Surefoot", &job.program)];
    let list: Vec<Value> = values.iter().map(|(name, value)| json!({ "name": name, "value": value })).collect();
    let plain: serde_json::Map<String, Value> =
        values.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect();
    let mut inputs = vec![&job.sweep];
    inputs.extend(&job.inputs);
    inputs.dedup();
    let assets = json!({ "assetReferences": {
        "inputs": { "filenames": inputs, "directories": [] },
        "outputs": { "directories": [&job.output] },
        "referencedPaths": [],
    } });
    vec![
        file("template.json", &template(job)),
        file("parameter_values.json", &json!({ "parameterValues": list })),
        file("asset_references.json", &assets),
        // `openjd run -p file://...` reads a plain object.
        file("openjd_parameters.json", &Value::Object(plain)),
    ]
}

fn template(job: &FarmJob) -> Value {
    let (chunks, count) = (job.chunk_count(), job.count);
    let mut steps = Vec::new();
    let mut merge =
        json!({ "name": "Merge", "description": "Finds all clips there and makes manifest, sheet and coverage." });
    if chunks > 0 {
        let (first, last) = ranges(job);
        let only = ["--tolerant", "--only", "{{Task.Param.First}}-{{Task.Param.Last}}"];
        steps.push(json!({
            "name": "Chunks",
            "description": "Bakes the variations First to Last.",
            "parameterSpace": {
                "taskParameterDefinitions": [
                    { "name": "First", "type": "INT", "range": first },
                    { "name": "Last", "type": "INT", "range": last },
                ],
                "combination": "(First, Last)",
            },
            "script": script(job, &only),
        }));
        merge["dependencies"] = json!([{ "dependsOn": "Chunks" }]);
    }
    merge["script"] = script(job, &[]);
    steps.push(merge);
    json!({
        "specificationVersion": "jobtemplate-2023-09",
        // What stands in braces could be read as a reference.
        "name": job.title(MOST_NAME).replace('{', "(").replace('}', ")"),
        "description": format!("{count} variations in {chunks} chunks of up to {}; written by `surefoot batch --openjd`.", job.chunk.max(1)),
        "parameterDefinitions": [
            path("SweepFile", "FILE", "IN", "CHOOSE_INPUT_FILE", "Sweep", "The sweep. What it names is found beside it."),
            path("OutputFolder", "DIRECTORY", "OUT", "CHOOSE_DIRECTORY", "Output folder", "Clips, manifest, sheet and coverage. What is done there is kept."),
            {
                "name": "Surefoot",
                "type": "STRING",
                "description": "What the workers call the program: a name on their path, or a path.",
                "default": job.program,
                "minLength": 1,
                "userInterface": { "control": "LINE_EDIT", "label": "Surefoot" },
            },
        ],
        "steps": steps,
    })
}

fn path(name: &str, object: &str, flow: &str, control: &str, label: &str, description: &str) -> Value {
    json!({
        "name": name,
        "type": "PATH",
        "objectType": object,
        "dataFlow": flow,
        "description": description,
        "minLength": 1,
        "userInterface": { "control": control, "label": label },
    })
}

fn script(job: &FarmJob, only: &[&str]) -> Value {
    let mut args = vec!["batch".to_owned(), "{{Param.SweepFile}}".into(), "-o".into(), "{{Param.OutputFolder}}".into()];
    args.extend(only.iter().map(|arg| (*arg).to_owned()));
    args.extend(job.flags.iter().cloned());
    json!({ "actions": { "onRun": {
        "command": "{{Param.Surefoot}}",
        "args": args,
        "timeout": job.patience(),
        // An interrupt leaves whole files only.
        "cancelation": { "mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 30 },
    } } })
}

/// The expressions of first and last variations.
fn ranges(job: &FarmJob) -> (String, String) {
    let (size, chunks) = (job.chunk.max(1), job.chunk_count());
    // a..b by steps; one value is no range
    let steps = |from: usize, count: usize| match count {
        1 => from.to_string(),
        count => format!("{from}-{}:{size}", from + size * (count - 1)),
    };
    let first = steps(1, chunks);
    let whole = job.count / size;
    let last = match (whole, job.count % size) {
        (whole, 0) => steps(size, whole),
        (0, _) => job.count.to_string(),
        (whole, _) => format!("{},{}", steps(size, whole), job.count),
    };
    (first, last)
}

fn file(name: &'static str, value: &Value) -> FarmFile {
    let mut bytes = format!("{value:#}").into_bytes();
    bytes.push(b'\n');
    FarmFile { name, bytes, script: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::farm::tests::job;

    fn read(job: &FarmJob, name: &str) -> Value {
        let files = bundle(job);
        let file = files.iter().find(|file| file.name == name).expect("the file");
        serde_json::from_slice(&file.bytes).expect("JSON")
    }

    /// The numbers of a range expression, as the specification reads it.
    fn expanded(expression: &str) -> Vec<usize> {
        let number = |text: &str| text.parse::<usize>().expect("a number");
        let element = |element: &str| {
            let (range, step) = element.split_once(':').unwrap_or((element, "1"));
            let (from, to) = range.split_once('-').unwrap_or((range, range));
            (number(from)..=number(to)).step_by(number(step)).collect::<Vec<usize>>()
        };
        expression.split(',').flat_map(element).collect()
    }

    #[test]
    fn the_ranges_are_the_chunks_whatever_the_size() {
        for count in [1, 2, 5, 23, 24, 25, 288, 10_000] {
            for size in [0, 1, 2, 7, 24, 287, 288, 289, usize::MAX] {
                let job = job(count, size);
                let (first, last) = ranges(&job);
                let found: Vec<(usize, usize)> = expanded(&first).into_iter().zip(expanded(&last)).collect();
                assert_eq!(expanded(&first).len(), expanded(&last).len(), "{count} by {size}: {first} and {last}");
                assert_eq!(found, job.chunks().collect::<Vec<_>>(), "{count} by {size}: {first} and {last}");
            }
        }
        assert_eq!(ranges(&job(288, 24)), ("1-265:24".to_owned(), "24-288:24".to_owned()));
        assert_eq!(ranges(&job(100, 24)), ("1-97:24".to_owned(), "24-96:24,100".to_owned()));
    }

    #[test]
    fn paths_stay_values_and_the_merge_waits_for_the_chunks() {
        let job = job(100, 24);
        let template = read(&job, "template.json");
        assert_eq!(template["specificationVersion"], "jobtemplate-2023-09");
        assert!(!template.to_string().contains("/studio"), "the template has no path of this machine");
        assert_eq!(template["steps"][1]["dependencies"][0]["dependsOn"], template["steps"][0]["name"]);
        let args = &template["steps"][0]["script"]["actions"]["onRun"]["args"];
        let wanted = [
            "batch",
            "{{Param.SweepFile}}",
            "-o",
            "{{Param.OutputFolder}}",
            "--tolerant",
            "--only",
            "{{Task.Param.First}}-{{Task.Param.Last}}",
        ];
        assert_eq!(*args, json!(wanted));
        let values = read(&job, "parameter_values.json");
        assert_eq!(values["parameterValues"][0], json!({ "name": "SweepFile", "value": job.sweep }));
        assert_eq!(read(&job, "openjd_parameters.json")["OutputFolder"], json!(job.output));
        let assets = read(&job, "asset_references.json");
        assert_eq!(assets["assetReferences"]["inputs"]["filenames"], json!([job.sweep, job.inputs[0], job.inputs[1]]));
    }

    #[test]
    fn a_name_cannot_be_a_reference_and_is_as_long_as_allowed() {
        let named = |name: &str| {
            let template = read(&FarmJob { name: name.to_owned(), ..job(3, 1) }, "template.json");
            template["name"].as_str().expect("text").to_owned()
        };
        assert_eq!(named("hit\n{{Param.X}}\treactions"), "hit ((Param.X)) reactions");
        assert_eq!(named(&"{{".repeat(500)), "(".repeat(MOST_NAME));
        assert_eq!(named("\n"), "surefoot");
    }

    #[test]
    fn a_sweep_of_nothing_has_only_its_merge() {
        let template = read(&job(0, 24), "template.json");
        assert_eq!(template["steps"].as_array().map(Vec::len), Some(1));
        assert!(template["steps"][0].get("dependencies").is_none());
    }
}

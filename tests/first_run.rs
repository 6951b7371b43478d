//! The run that `src/lib.rs` shows: this file's function and the example there are the same lines.

/// The example, as it stands in the documentation.
fn example() -> Result<(), Box<dyn std::error::Error>> {
    use surefoot::bake::{BakeOptions, bake};
    use surefoot::model::{Scenario, report::Outcome};
    use surefoot::{export, rig};

    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound)); // the built-in rig is one file
    let rig = rig::load_bytes("builtin", rig::mannequin::BUILTIN, &alone, None)?;
    let baked = bake(&rig, &Scenario::demo(), &BakeOptions::default())?; // shoved from the left, 60 N s
    assert_eq!(baked.report.outcome, Outcome::Step);
    let glb = export::glb(&rig, &[(baked.clip, baked.report)])?.bytes;
    assert_eq!(&glb[..4], b"glTF");
    Ok(())
}

#[test]
fn the_example_of_the_library_runs_as_it_is_written() {
    example().expect("it runs");
    let shown: Vec<&str> = include_str!("../src/lib.rs")
        .lines()
        .map(|line| line.strip_prefix("//!").unwrap_or_default().trim())
        .skip_while(|line| *line != "```")
        .skip(1)
        .take_while(|line| *line != "```")
        .filter(|line| !line.starts_with('#'))
        .collect();
    let run: Vec<&str> = include_str!("first_run.rs")
        .lines()
        .skip_while(|line| !line.starts_with("fn example()"))
        .skip(1)
        .take_while(|line| line.trim() != "Ok(())")
        .map(str::trim)
        .collect();
    assert!(run.len() > 8, "{run:#?}");
    assert_eq!(shown, run);
}

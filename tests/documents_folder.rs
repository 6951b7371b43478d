//! The folder that the documents' commands run in: the files that they name, made of what is in the repository. Short and few, so that hundreds of
//! commands take seconds: scenarios of 1.2 s, a sweep of 6 where the page shows 48.

use crate::common::builtin;
use crate::shell::Shell;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use surefoot::bake::{BakeOptions, bake};
use surefoot::export::glb;
use surefoot::model::scenario_text;

const SHOVE: &str = "title = \"shove\"\nduration = 1.2\nseed = 7\n\n[[push]]\nstart = 0.3\nduration = 0.2\nforce = 100.0\ntoward = \"right\"\nat = \"chest\"\n";
const WALK: &str = "title = \"walk\"\nduration = 7.0\n\n[[walk]]\nstart = 0.3\nspeed = 1.1\n";
const STANCE: &str = "title = \"stance\"\nduration = 6.0\nseed = 3\n\n[character]\nbreathing = 0.7\n";
const SWEEP: &str = "scenario = \"shove.toml\"\nrigs = [\"hero.glb\"]\nname = \"{push.0.toward}_s{seed}\"\n\n[vary]\n\"push.0.toward\" = [\"left\", \"front\"]\nseed = [1, 2]\n\n[bake]\ndrive = \"stepper\"\n";
const WAIVERS: &str = "[[waive]]\nclip = \"*\"\nrule = \"foot-slide\"\nreason = \"this take has it on purpose\"\n";

/// The built-in rig with a clip "Idle".
fn hero() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let rig = builtin();
        let scenario = scenario_text::parse("stance.toml", STANCE).expect("a scenario");
        let options = BakeOptions { name: Some("Idle".into()), ..BakeOptions::default() };
        let baked = bake(&rig, &scenario, &options).expect("bakes");
        glb(&rig, &[(baked.clip, baked.report)]).expect("writes").bytes
    })
}

/// A folder with all of them.
pub fn folder() -> Shell {
    let gallery = Path::new(env!("CARGO_MANIFEST_DIR")).join("exports/gallery");
    let own = |name: &str| fs::read(gallery.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let take = own("audit/walk.bvh");
    let shell = Shell::new();
    let put = |name: &str, bytes: &[u8]| {
        let path = shell.path(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("the test's own folder");
        fs::write(path, bytes).expect("the test's own folder");
    };
    put("hero.glb", hero());
    put("hero.fbx", crate::fbx_text::text(&builtin(), crate::fbx_text::CENTIMETRES).as_bytes());
    put("shove.toml", SHOVE.as_bytes());
    put("over_idle.toml", format!("{SHOVE}\n[base]\nclip = \"Idle\"\n").as_bytes());
    put("walk.toml", WALK.as_bytes());
    put("stance.toml", STANCE.as_bytes());
    put("shoves.toml", SWEEP.as_bytes());
    for name in ["walk.bvh", "take_07.bvh", "mocap/walk_01.bvh", "mocap/walk_02.bvh"] {
        put(name, &take);
    }
    put("mocap/waivers.toml", WAIVERS.as_bytes());
    for name in [
        "audit/walk.bvh",
        "audit/walk.toml",
        "idle/scenario.toml",
        "idle/stance.toml",
        "idle/stance.vrma",
        "walk/scenario.toml",
    ] {
        put(&format!("exports/gallery/{name}"), &own(name));
    }
    put("exports/gallery/sweep/shove.toml", SHOVE.as_bytes());
    let sweep = String::from_utf8(own("sweep/sweep.toml")).expect("UTF-8");
    let mut small = sweep;
    for (many, few) in [("step = 45", "step = 180"), ("seed = [1, 2]", "seed = [1]")] {
        assert!(
            small.contains(many),
            "the gallery's sweep has no `{many}` now: make a small one of it here in another way"
        );
        small = small.replace(many, few);
    }
    put("exports/gallery/sweep/sweep.toml", small.as_bytes());
    shell
}

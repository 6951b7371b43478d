//! Files of grounds: broken, cut short, too large, not read, found beside a scenario by every command; how fast a large one answers.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::common::builtin;
use crate::mesh_ground::{FLOOR, boxes, container, glb, kerb, read, scenario, surface};
use crate::shell::Shell;
use glam::{DVec2, DVec3};
use serde_json::json;
use std::sync::Arc;
use surefoot::bake::{BakeError, BakeOptions, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::scenario::{Ground, GroundKind};
use surefoot::model::{Surface, Terrain};

#[test]
fn bad_meshes_are_named_with_place_and_remedy() {
    let floor = boxes(&[FLOOR]);
    let scaled = |factor: f64| glb(&floor, json!({ "scale": [factor, factor, factor] }));
    let mut holes = floor.clone();
    holes.positions[3] = DVec3::new(f64::NAN, 0.0, 0.0);
    let no_nodes = container(&json!({ "asset": { "version": "2.0" }, "nodes": [{}] }), &[]);
    let outside = json!({
        "asset": { "version": "2.0" }, "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }], "buffers": [{ "byteLength": 36, "uri": "level.bin" }]
    });
    let mut beyond = floor.clone();
    beyond.indices[5] = 4000;
    let mut flattened = floor.clone();
    flattened.positions.iter_mut().for_each(|point| *point = DVec3::X * point.x);
    let cases: [(&str, Vec<u8>, &[&str]); 10] = [
        ("empty", Vec::new(), &["is empty"]),
        ("text", b"hello".to_vec(), &["is not a glTF file"]),
        ("no triangles", no_nodes, &["no triangles", "export the level's meshes"]),
        ("NaN", glb(&holes, json!({})), &["meshes[0].primitives[0].attributes.POSITION", "vertex 3", "finite"]),
        ("outer buffer", outside.to_string().into_bytes(), &["buffers[0].uri", "level.bin"]),
        ("indices", glb(&beyond, json!({})), &["meshes[0].primitives[0].indices", "4000", "vertices"]),
        ("centimetres", scaled(400.0), &["8000.000 m", "centimetres", "0.01"]),
        ("tiny", scaled(0.0001), &["0.002 m", "metres"]),
        ("a line", glb(&flattened, json!({})), &["none of its", "area"]),
        ("cut short", glb(&floor, json!({}))[..200].to_vec(), &["cut short"]),
    ];
    for (name, bytes, words) in cases {
        let error = read(&bytes).expect_err(name);
        println!("{name}: {error}");
        assert!(error.starts_with("level.glb: "), "{name}: {error}");
        assert!(words.iter().all(|word| error.contains(word)), "{name}: {error}");
    }
    let mut thin = floor.clone();
    let first = thin.positions.len() as u32;
    thin.positions.extend([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]);
    thin.indices.extend([first, first + 1, first + 2]);
    assert_eq!(read(&glb(&thin, json!({}))).expect("the rest is there").dropped, 1);
}

#[test]
fn files_cut_short_or_with_flipped_bits_are_read_or_refused() {
    let whole = glb(&kerb(&mut Seed::new(1)).0, json!({ "translation": [0.1, 0.0, 0.2] }));
    let (mut read_well, mut refused) = (0, 0);
    let mut look = |bytes: &[u8]| match read(bytes) {
        Ok(surface) => {
            read_well += 1;
            let spot = surface.ground(DVec2::new(0.3, 0.4), 2.0);
            assert!(spot.is_none_or(|(height, normal)| height.is_finite() && normal.is_normalized()));
            let _ = surface.wall(DVec3::new(0.0, 0.1, 0.0), DVec3::new(0.0, 0.1, 9.0));
        }
        Err(error) => {
            refused += 1;
            assert!(error.starts_with("level.glb: ") && error.len() < 500, "{error}");
        }
    };
    for length in (0..whole.len()).step_by(7) {
        look(&whole[..length]);
    }
    let mut draw = Seed::new(9);
    for _ in 0..3000 {
        let mut bytes = whole.clone();
        for _ in 0..draw.between(1.0, 6.0) as usize {
            let at = draw.between(0.0, bytes.len() as f64 - 1.0) as usize;
            bytes[at] ^= 1 << (draw.between(0.0, 7.99) as u32);
        }
        look(&bytes);
    }
    println!("{read_well} read, {refused} refused");
    assert!(read_well > 100 && refused > 300);
}

#[test]
fn a_ground_that_was_not_read_or_holds_nobody_is_refused() {
    let rig = builtin();
    let far = surface(&boxes(&[([5.0, 0.0, 5.0], [9.0, 1.0, 9.0])]));
    let mut unread = scenario("unread", "", &far);
    let missing = bake(&rig, &unread, &BakeOptions::default()).expect_err("nothing is under the start");
    assert!(matches!(&missing, BakeError::NoGround { what } if what.contains("nothing under the start")), "{missing}");
    if let GroundKind::Mesh { surface, .. } = &mut unread.ground.kind {
        *surface = None;
    }
    let unread = bake(&rig, &unread, &BakeOptions::default()).expect_err("nobody read it");
    assert!(matches!(&unread, BakeError::NoGround { what } if what.contains("was not read")), "{unread}");
}

#[test]
fn two_hundred_thousand_triangles_are_asked_quickly() {
    let (side, cell) = (316_u32, 0.1);
    let mut draw = Seed::new(5);
    let heights: Vec<f64> = (0..=side * side + 2 * side).map(|_| draw.between(0.0, 0.02)).collect();
    let at = |column: u32, row: u32| {
        let place = |index: u32| f64::from(index) * cell - 0.5 * cell * f64::from(side);
        DVec3::new(place(column), heights[(column * (side + 1) + row) as usize], place(row))
    };
    let mut triangles = Vec::new();
    for column in 0..side {
        for row in 0..side {
            let [a, b, c, d] = [at(column, row), at(column, row + 1), at(column + 1, row + 1), at(column + 1, row)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let begun = std::time::Instant::now();
    let surface = Surface::new(triangles);
    let built = begun.elapsed();
    // As a walk asks: about places near each other. The best of ten: the machine does other things too.
    let count = 20_000;
    let (mut held, mut each) = (0, f64::INFINITY);
    for _ in 0..10 {
        let begun = std::time::Instant::now();
        for _ in 0..count {
            let at = DVec2::new(draw.between(-1.0, 1.0), draw.between(2.0, 4.0));
            held += usize::from(surface.ground(at, 2.0).is_some());
        }
        each = each.min(begun.elapsed().as_secs_f64() / f64::from(count));
    }
    println!("{} triangles: grid in {:.2} s, {:.0} ns a question", surface.len(), built.as_secs_f64(), 1e9 * each);
    let kind = GroundKind::Mesh { file: "level.glb".into(), ceiling: Some(2.0), surface: Some(Arc::new(surface)) };
    assert!(Terrain::new(&Ground { kind, friction: 1.0 }).spot(DVec2::ZERO).holds && held == 200_000);
    // A walk asks some 300,000 times: at 10 µs each that were 3 s.
    assert!(each < 1e-5, "{:.0} ns", 1e9 * each);
}

#[test]
fn bake_batch_and_farm_find_the_mesh_beside_its_scenario_and_notice_when_it_changes() {
    const SCENARIO: &str = "title = \"on a kerb\"\nduration = 1.5\n[ground]\nkind = \"mesh\"\nfile = \"maps/level.gltf\"\n\
         [[push]]\nstart = 0.3\nduration = 0.2\nforce = 150\ntoward = \"left\"\n";
    const SWEEP: &str = "scenario = \"in/kerb.toml\"\nrigs = [\"builtin\"]\n[vary]\n\"push.0.force\" = [100, 150]\n[bake]\ndrive = \"stepper\"\n";
    let shell = Shell::with(&[("sweep.toml", SWEEP)]);
    std::fs::create_dir_all(shell.path("in/maps")).expect("a folder");
    std::fs::write(shell.path("in/kerb.toml"), SCENARIO).expect("a file");
    let put = |height: f64| {
        let whole = glb(&boxes(&[FLOOR, ([0.4, -0.3, -6.0], [6.0, height, 14.0])]), json!({}));
        let text = u32::from_le_bytes([whole[12], whole[13], whole[14], whole[15]]) as usize;
        let mut document: serde_json::Value = serde_json::from_slice(&whole[20..20 + text]).expect("JSON");
        document["buffers"][0]["uri"] = json!("level.bin");
        std::fs::write(shell.path("in/maps/level.gltf"), document.to_string()).expect("a file");
        std::fs::write(shell.path("in/maps/level.bin"), &whole[28 + text..]).expect("a file");
    };
    let missing = "bake builtin in/kerb.toml -o out.glb --drive stepper";
    shell.run(missing).exits(2).says(&["[ground]", "maps/level.gltf", "no such file", "scenario's folder"]);
    put(0.15);
    shell.run(missing).exits(0);
    let told = shell.run("batch sweep.toml -o clips").exits(0);
    assert!(told.out.contains("2 variations"), "{}", told.out);
    shell.run("batch sweep.toml --openjd job -o clips").exits(0);
    let job = std::fs::read_to_string(shell.path("job/asset_references.json")).expect("the job's files");
    assert!(job.contains("level.gltf") && job.contains("level.bin"), "{job}");
    let times = |shell: &Shell| -> Vec<std::time::SystemTime> {
        let clips = shell.files().into_iter().filter(|name| name.starts_with("clips/") && name.ends_with(".glb"));
        let written = |name: String| std::fs::metadata(shell.path(&name)).and_then(|there| there.modified());
        clips.map(|name| written(name).expect("a file")).collect()
    };
    let first = times(&shell);
    assert_eq!(first.len(), 2);
    shell.run("batch sweep.toml -o clips").exits(0);
    assert_eq!(times(&shell), first, "nothing changed, nothing is baked again");
    put(0.12); // the buffer alone differs
    shell.run("batch sweep.toml -o clips").exits(0);
    assert!(times(&shell).iter().zip(&first).all(|(now, then)| now > then), "the level changed");
    std::fs::write(shell.path("in/maps/level.bin"), [0; 12]).expect("a file");
    shell.run("batch sweep.toml -o other").exits(2).says(&["[ground]", "level.gltf", "buffers[0]", "cut short"]);
}

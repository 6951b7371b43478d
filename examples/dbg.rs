//! debug
#[path = "../tests/limits_grid.rs"]
#[allow(dead_code)]
mod limits_grid;
use limits_grid::*;
use serde_json::{Value, json};
use surefoot::bake::{BakeOptions, bake};
fn main() {
    std::fs::create_dir_all("/tmp/blk").unwrap();
    for (name, rig) in rigs().into_iter().filter(|(n, _)| n.contains("m2m_human_male") || n.contains("builtin") || n.contains("gdq")) {
    for (d, i) in [(90., 60.), (0., 80.)] {
        let sc = shove(&rig.body, d, i);
        let b = bake(&rig, &sc, &BakeOptions::default()).unwrap();
        let made = surefoot::export::glb(&rig, &[(b.clip.clone(), b.report.clone())]).unwrap();
        let file = format!("{name}_{d}_{i}.glb");
        std::fs::write(format!("/tmp/blk/{file}"), &made.bytes).unwrap();
        let mut s = rig.sampler(&b.clip);
        let samples: Vec<Value> = (0..480).map(|k| { let t = k as f64 / 120.0; let g = s.node_globals(t).to_vec();
            let nodes: Vec<Value> = rig.joint_nodes.iter().flatten().map(|n| { let p = rig.document_from_scenario.point(g[*n].translation); json!([n, p.x, p.y, p.z]) }).collect();
            json!({"time": t, "nodes": nodes}) }).collect();
        let names: Vec<Option<&str>> = rig.nodes.iter().map(|n| n.name.as_deref()).collect();
        let feet: Vec<usize> = rig.body.feet.iter().flat_map(|f| [rig.joint_nodes[f.ankle], f.toe.and_then(|t| rig.joint_nodes[t])]).flatten().collect();
        let contacts: Vec<Value> = b.performance.contacts.iter().map(|c| json!([c.side as usize, format!("{:?}", c.part), c.start, c.end])).collect();
        let dump = json!({"file": file, "clip": made.names[0], "unit": rig.document_from_scenario.scale, "names": names, "samples": samples, "feet": feet, "contacts": contacts});
        std::fs::write(format!("/tmp/blk/{file}.pose.json"), dump.to_string()).unwrap();
        for ch in &b.clip.channels { let nm = match ch.target { surefoot::model::Target::Node(n) => rig.nodes[n].name.clone().unwrap_or_default(), t => format!("{t:?}") };
            let same = match &ch.values { surefoot::model::KeyValues::Rotation(k) => { let st = ch.interpolation.stride(); if st == 3 { (1..ch.times.len()-1).filter(|i| k[3*i] != k[3*i+2]).count() } else {0} }, _ => 0 };
            if ch.times.len() > 1 { print!("{nm}.{}:{}/c{} ", ch.values.path().chars().next().unwrap(), ch.times.len(), same); } }
        println!();
        println!("{file} keys {:.3}", Keys::of(&b.clip).share);
    }}
}

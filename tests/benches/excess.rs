//! Temporary: where joints leave their ranges.
#![expect(clippy::print_stdout, reason = "the table")]
#[path = "../limits_grid.rs"]
mod limits_grid;
use limits_grid::{EIGHT, rigs, shove};
use rayon::prelude::*;
use std::collections::BTreeMap;
use surefoot::bake::perform;
use surefoot::measure::joints;
use surefoot::model::Side;
use surefoot::model::report::Part;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let verbose = std::env::args().any(|word| word == "-v");
    let trace = std::env::args().any(|word| word == "-t");
    let only: Vec<f64> = words.iter().filter_map(|w| w.parse().ok()).collect();
    let names: Vec<&String> = words.iter().filter(|w| w.parse::<f64>().is_err()).collect();
    let mut table: BTreeMap<String, (usize, f64, f64)> = BTreeMap::new();
    for (name, rig) in rigs() {
        if !names.is_empty() && !names.iter().any(|word| name.contains(word.as_str())) {
            continue;
        }
        let mut cells: Vec<(f64, f64)> =
            EIGHT.iter().flat_map(|d| [20.0, 40.0, 60.0, 80.0, 100.0].iter().map(move |i| (*d, *i))).collect();
        if only.len() == 2 {
            cells = vec![(only[0], only[1])];
        }
        let out: Vec<Vec<(String, f64, f64, String)>> = cells
            .par_iter()
            .map(|(d, i)| {
                let p = perform(&rig.body, &shove(&rig.body, *d, *i), 7).unwrap();
                let t = &p.timeline;
                let body = &t.body;
                let rest = joints::angles(body, &surefoot::model::BodyPose::rest(body));
                let solved = t.solve_all();
                let all: Vec<_> = solved.iter().map(|s| joints::angles(body, &s.pose)).collect();
                let mut found = Vec::new();
                let phase = |side: Side, time: f64| {
                    let c = p.contacts.iter().find(|c| c.side == side && c.start <= time && time < c.end);
                    let next = p.contacts.iter().filter(|c| c.side == side && c.start > time).map(|c| c.start).fold(f64::INFINITY, f64::min);
                    match c {
                        Some(c) => {
                            let what = match c.part { Part::Flat => "flat", Part::Ball => "ball", Part::Heel => "heel" };
                            let other = p.contacts.iter().any(|o| o.side == side.other() && o.start <= time && time < o.end);
                            format!("{what}{}", if other { "2" } else { "1" })
                        }
                        None => {
                            let from = p.contacts.iter().filter(|c| c.side == side && c.end <= time).map(|c| c.end).fold(0.0, f64::max);
                            let u = (time - from) / (next - from);
                            if u < 0.33 { "air-early".into() } else if u < 0.67 { "air-mid".into() } else { "air-late".into() }
                        }
                    }
                };
                let load = |side: Side, index: usize| {
                    let f = t.feet.at(side, index as f64 * t.dt).ankle;
                    let o = t.feet.at(side.other(), index as f64 * t.dt).ankle;
                    let cop = p.trace.ticks[index].cop;
                    let way = glam::DVec2::new(f.x - o.x, f.z - o.z);
                    let rel = cop - glam::DVec2::new(o.x, o.z);
                    (rel.dot(way) / way.length_squared()).clamp(-0.5, 1.5)
                };
                for a in 0..rest.len() {
                    let low = rest[a].range[0].min(if rest[a].role.name().contains("LowerLeg") { 0.0 } else { rest[a].value });
                    let high = rest[a].range[1].max(rest[a].value);
                    let by = |k: usize| {
                        let v = all[k][a].value;
                        let b = (low - v).max(v - high).to_degrees();
                        if b > 1.0 { b } else { 0.0 }
                    };
                    let mut k = 0;
                    while k < all.len() {
                        if by(k) <= 0.0 { k += 1; continue; }
                        let start = k;
                        let mut best = k;
                        while k < all.len() && by(k) > 0.0 { if by(k) > by(best) { best = k; } k += 1; }
                        let side = if rest[a].role.name().starts_with("left") { Side::Left } else { Side::Right };
                        let sign = if all[best][a].value > high { "+" } else { "-" };
                        let joint = rest[a].role.name().trim_start_matches("left").trim_start_matches("right");
                        let time = best as f64 * t.dt;
                        let get = |role: &str, axis: &str| all[best].iter().find(|x| x.axis == axis && x.role.name() == format!("{}{role}", if side == Side::Left { "left" } else { "right" })).map_or(0.0, |x| x.value.to_degrees());
                        let ph = |k: usize| phase(side, k as f64 * t.dt);
                        let text = format!("{name} {d} {i}: {} {}{sign} by {:.1} at {:.2} s for {:.2} s [{}->{}->{}] load {:.2} | hip f {:.0} a {:.0} r {:.0} knee {:.0} foot f {:.0} i {:.0} lowering {:.0} mm",
                            rest[a].role.name(), rest[a].axis, by(best), time, (k - start) as f64 * t.dt, ph(start), ph(best), ph(k - 1), load(side, best),
                            get("UpperLeg", "flexion"), get("UpperLeg", "abduction"), get("UpperLeg", "rotation"), get("LowerLeg", "flexion"), get("Foot", "flexion"), get("Foot", "inversion"), t.lowering[best] * 1000.0);
                        found.push((format!("{joint} {}{sign} {}", rest[a].axis, ph(best)), by(best), (k - start) as f64 * t.dt, text));
                    }
                }
                if trace {
                    for c in &p.contacts { println!("{:?} {:?} {:.2}-{:.2} {:.2},{:.2} yaw {:.0}", c.side, c.part, c.start, c.end, c.plant.ankle.x, c.plant.ankle.z, c.plant.yaw.to_degrees()); }
                    for k in (55..all.len()).step_by(3) {
                        let mut line = format!("{:.2}", k as f64 * t.dt);
                        for side in Side::BOTH {
                            let get = |role: &str, axis: &str| all[k].iter().find(|x| x.axis == axis && x.role.name() == format!("{}{role}", if side == Side::Left { "left" } else { "right" })).map_or(0.0, |x| x.value.to_degrees());
                            line += &format!(" | {:9} load {:5.2} hip {:4.0} {:4.0} {:4.0} knee {:4.0} foot {:4.0} {:4.0}", phase(side, k as f64 * t.dt), load(side, k), get("UpperLeg", "flexion"), get("UpperLeg", "abduction"), get("UpperLeg", "rotation"), get("LowerLeg", "flexion"), get("Foot", "flexion"), get("Foot", "inversion"));
                        }
                        println!("{line} low {:.0}", t.lowering[k] * 1000.0);
                    }
                }
                found
            })
            .collect();
        for clip in out {
            for (key, by, time, text) in clip {
                if verbose {
                    println!("{text}");
                }
                let e = table.entry(key).or_default();
                e.0 += 1;
                e.1 = e.1.max(by);
                e.2 += time;
            }
        }
    }
    let mut rows: Vec<_> = table.into_iter().collect();
    rows.sort_by(|a, b| b.1.0.cmp(&a.1.0));
    for (key, (n, by, time)) in rows {
        println!("{n:>4} x {key:<32} worst {by:>5.1} mean {:.2} s", time / n as f64);
    }
}

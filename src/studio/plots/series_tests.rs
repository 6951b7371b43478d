//! Tests of the curves: pushes show, units are right, gaps are gaps.

use super::series::*;
use crate::bake::ragdoll::{Drive, Helped};
use crate::bake::{BakeOptions, Baked, bake};
use crate::disk::resolve::builtin_rig;
use crate::model::scenario::{Scenario, Walk};
use crate::picture::clip_plot::margin;
use crate::picture::plot::Colour;
use crate::ragdoll::control::Assist;
use egui_plot::PlotPoint;

fn baked(scenario: &Scenario, drive: Drive) -> (Baked, Series) {
    let rig = builtin_rig().expect("the built-in rig loads");
    let baked = bake(&rig, scenario, &BakeOptions { drive, ..BakeOptions::default() }).expect("the simulation holds");
    let series = series(&baked, scenario, &rig);
    (baked, series)
}

fn points(series: &Series, kind: Kind, curve: usize) -> Vec<PlotPoint> {
    let chart = series.charts.iter().find(|chart| chart.kind == kind).expect("every kind");
    chart.curves[curve].stretches.concat()
}

fn extent(points: &[PlotPoint]) -> (f64, f64) {
    points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), point| (a.min(point.y), b.max(point.y)))
}

#[test]
fn a_push_shows_in_the_speed_and_the_margin_is_negative_while_it_steps() {
    let (baked, series) = baked(&Scenario::demo(), Drive::Stepper);
    let speed = points(&series, Kind::Speed, 1);
    let (before, after): (Vec<PlotPoint>, Vec<PlotPoint>) = speed.iter().partition(|point| point.x < 0.55);
    // 60 N s on 89.5 kg: 0.67 m/s if nothing held against it.
    let peak = extent(&after).1;
    assert!(extent(&before).1 < 0.05 && (0.35..0.75).contains(&peak), "{:?} {peak}", extent(&before));
    let margin = points(&series, Kind::Margin, 0);
    assert!(margin[0].y > 0.02 && margin[0].y < 0.15, "a stand is some centimetres inside: {}", margin[0].y);
    let step = baked.performance.trace.steps[0];
    let out: Vec<f64> = margin.iter().filter(|point| point.y < 0.0).map(|point| point.x).collect();
    let first = *out.first().expect("the demo's push needs a step");
    assert!(first > 0.6 && first < step.land, "outside from {first} s; the foot lands at {} s", step.land);
    for (time, tick) in baked.performance.trace.ticks.iter().enumerate().map(|(at, tick)| (at as f64 * 0.01, tick)) {
        let told = series.charts[Kind::Margin as usize].curves[0].at(time);
        let own = margin_of(&baked, tick);
        assert!(told.is_none_or(|told| own.is_some_and(|own| (told - own).abs() < 1e-9)), "at {time}");
    }
    let height = points(&series, Kind::Height, 0);
    assert!((0.8..1.1).contains(&height[0].y), "metres: {}", height[0].y);
    assert_eq!(series.pushes, [(0.6, 0.8)]);
}

fn margin_of(baked: &Baked, tick: &crate::sim::TickState) -> Option<f64> {
    margin(&baked.performance.physique, tick)
}

#[test]
fn a_walk_is_commanded_and_slip_and_zmp_are_in_millimetres_and_centimetres() {
    let walk = Walk { start: 0.3, duration: Some(2.5), speed: 1.1, heading: 0.0, facing: None };
    let scenario = Scenario { duration: 4.5, walk: vec![walk], ..Scenario::default() };
    let (baked, series) = baked(&scenario, Drive::Stepper);
    assert_eq!(series.charts[0].curves[0].at(1.0), Some(1.1));
    assert_eq!(series.charts[0].curves[0].at(0.1), Some(0.0));
    let slip = extent(&[points(&series, Kind::Slip, 0), points(&series, Kind::Slip, 1)].concat()).1;
    assert!((slip - baked.report.plausibility.slip_max_mm).abs() < 1e-6);
    let findings = baked.findings.as_ref().expect("measured");
    let farthest = findings.zmp_distances.iter().flatten().fold(f64::NEG_INFINITY, |most, out| most.max(*out));
    assert!((extent(&points(&series, Kind::Zmp, 0)).1 - 100.0 * farthest).abs() < 1e-9);
    let forward = points(&series, Kind::Forward, 2);
    assert!(forward.last().expect("points").y > 1.5, "it walked ahead");
    assert!(series.charts[Kind::Forward as usize].band.iter().flatten().all(|[_, low, high]| low < high));
    assert!(series.charts[Kind::Torques as usize].note.as_ref().is_some_and(|note| note.contains("stepper")));
}

#[test]
fn a_ragdoll_tells_the_torques_of_its_hardest_joints() {
    let drive = Drive::Ragdoll(Helped::Within(Assist { torque: 0.0, force: 0.0 }));
    let mut scenario = Scenario::demo();
    scenario.push[0].force = 120.0;
    let (baked, series) = baked(&scenario, drive);
    let chart = &series.charts[Kind::Torques as usize];
    assert_eq!(chart.curves.len(), JOINTS);
    for (curve, told) in chart.curves.iter().zip(&baked.report.torques) {
        let peak = extent(&curve.stretches.concat()).1;
        // The report's peak is over the whole run, which may go on past the clip's end.
        assert_eq!(curve.name, told.joint);
        assert!(peak > 5.0 && peak <= told.peak_nm + 1e-3, "{}: {peak} of {}", curve.name, told.peak_nm);
    }
}

#[test]
fn a_long_curve_keeps_its_peaks_and_a_gap_stays_a_gap() {
    let value = |at: usize| match at {
        5_000..6_000 => None,
        7_777 => Some(9.0),
        _ => Some(0.0),
    };
    let long = curve("x", Colour::Blue, (0..20_000).map(|at| (at as f64 * 0.01, value(at))));
    assert_eq!(long.stretches.len(), 2);
    assert!(long.stretches.concat().len() <= MOST_POINTS + 8, "{}", long.stretches.concat().len());
    assert_eq!((long.at(77.77), long.at(55.0), long.at(1.0)), (Some(9.0), None, Some(0.0)));
    assert_eq!(long.at(199.99), Some(0.0), "up to its end");
}

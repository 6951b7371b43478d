//! A clip in one small picture, for a grid of many: four moments side by side, seen half from the front, half from its left.
//!
//! Scenario space, metres. It is made to be cheap, four samples a pixel and one view: soles that hold, prints where feet
//! stood in the moments before, the push's arrow and the shadow, but no marks of the balance. All moments have one scale;
//! each is as wide as its body needs, and its camera goes with the body.

use super::compose::{self, Frame, Grain, picture};
use super::marks::{self, Overlay, SoleMark};
use super::moments::{Moment, choose_moments};
use super::raster::Camera;
use super::sheet::SheetInput;
use super::skin::{surfaces, transforms_of_globals};
use super::stage::Stage;
use super::text::{self, Face, Pen};
use super::{balance, footing};
use crate::maths::real;
use crate::model::report::Part;
use crate::model::{Clip, ClipReport, Prop, Side};
use crate::rig::Rig;
use glam::{DVec2, DVec3};
use image::{Rgba, RgbaImage, imageops};
use std::cell::RefCell;

/// px.
pub const CELL_WIDTH: u32 = 320;
/// px.
pub const CELL_HEIGHT: u32 = 130;

/// Moments at most.
const MOMENTS: usize = 4;
/// How finely.
const COARSE: Grain = Grain { samples: 2, shadow: 0.03, points: false };
/// From where: to the left of the face, rad; half-way between two of the eight directions in which one mostly pushes.
const ASIDE: f64 = std::f64::consts::FRAC_PI_8;
/// px over the head and under the feet.
const ROOM: [f64; 2] = [13.0, 11.0];
/// px between moments.
const GAP: u32 = 1;
/// m, a foot that is nearer to where it stood has not moved.
const MOVED: f64 = 0.03;

/// The small picture of a clip as a reader of its keys sees it.
pub fn clip_cell(rig: &Rig, clip: &Clip, report: &ClipReport, props: &[Prop]) -> RgbaImage {
    let sampler = RefCell::new(rig.sampler(clip));
    let pose = |time: f64| transforms_of_globals(rig, sampler.borrow_mut().node_globals(time));
    let (moments, layout) = (Vec::new(), compose::Layout::default());
    cell(&SheetInput { rig, pose: &pose, report, overlay: None, props, moments, layout })
}

/// The small picture. `input.moments`, of which it takes four, may be empty: then it finds them. `layout` and `overlay` are
/// the large sheet's.
pub fn cell(input: &SheetInput) -> RgbaImage {
    let mut image = RgbaImage::from_pixel(CELL_WIDTH, CELL_HEIGHT, Rgba([214, 221, 227, 255]));
    let moments = if input.moments.is_empty() { telling(input) } else { input.moments.clone() };
    let mut frames: Vec<Frame> = moments.iter().take(MOMENTS).map(|moment| frame(input, moment)).collect();
    if frames.is_empty() {
        return image;
    }
    leave_prints(&mut frames);
    let mut left = 0;
    for (frame, (camera, width)) in frames.iter().zip(cameras(&frames)) {
        let drawn = picture(frame, &camera, width as usize, CELL_HEIGHT as usize, COARSE);
        imageops::replace(&mut image, &drawn, i64::from(left), 0);
        let pen = Pen { face: Face::Figures, size: 9.5, color: [60, 66, 74] };
        text::write(&mut image, left as f32 + 3.0, 1.0, pen, &format!("{:.2}", frame.time));
        left += width + GAP;
    }
    image
}

/// Before it, the hit, what came of that (the first foot down, balance lost, the farthest sway), the end.
fn telling(input: &SheetInput) -> Vec<Moment> {
    let report = input.report;
    let end = report.duration.max(0.0);
    let sudden = report.disturbances.iter().filter(|push| push.kind != "carry" && push.start.is_finite());
    let Some(hit) = sudden.min_by(|a, b| a.start.total_cmp(&b.start)) else {
        return choose_moments(report, MOMENTS);
    };
    let into = hit.start + (hit.end - hit.start).clamp(0.0, 0.24) * 0.5;
    let after = |name: &str| {
        let times = report.events.iter().filter(|event| event.name == name).map(|event| event.time);
        times.filter(|time| *time > into + 0.05).min_by(f64::total_cmp)
    };
    let came = after("balance_lost").or_else(|| after("foot_down")).unwrap_or_else(|| farthest(input, into, end));
    let mut times = vec![(hit.start - 0.08).max(0.0), into, came, end];
    times.retain(|time| time.is_finite());
    times.iter_mut().for_each(|time| *time = time.clamp(0.0, end));
    times.sort_by(f64::total_cmp);
    times.dedup_by(|a, b| (*a - *b).abs() < 0.03);
    times.into_iter().map(|time| Moment { time, label: String::new() }).collect()
}

/// When the centre of mass is the farthest from where it was hit, within two seconds.
fn farthest(input: &SheetInput, from: f64, end: f64) -> f64 {
    let start = balance::com_at(input, from);
    let span = (end - from).clamp(0.0, 2.0);
    let times = (1..=24).map(|at| from + span * f64::from(at) / 24.0);
    let far = times.map(|time| (balance::com_at(input, time).distance(start), time));
    far.filter(|(far, _)| far.is_finite()).max_by(|a, b| a.0.total_cmp(&b.0)).map_or(from, |(_, time)| time)
}

fn frame<'a>(input: &SheetInput<'a>, moment: &Moment) -> Frame<'a> {
    let time = moment.time;
    let transforms = (input.pose)(time);
    let held = Side::BOTH.into_iter().filter_map(|side| footing::contact_at(input.report, side, time));
    let soles = held.map(|contact| {
        let mark = footing::sole(input.rig, contact.foot, contact.part, &transforms);
        footing::laid(input, contact, time, mark)
    });
    let overlay = Overlay {
        com: Some(balance::centre_of_mass(input.rig, &transforms)),
        soles: soles.collect(),
        pushes: balance::pushes(input, time, &transforms),
        ..Overlay::default()
    };
    let surfaces = surfaces(input.rig, &transforms);
    Frame { time, label: String::new(), surfaces, overlay, stage: Stage::at(input.props, time) }
}

/// Where feet stood in the moments before and stand no more.
fn leave_prints(frames: &mut [Frame]) {
    let middle = |mark: &SoleMark| mark.whole.iter().sum::<DVec3>() / mark.whole.len().max(1) as f64;
    let mut stood: Vec<SoleMark> = Vec::new();
    for frame in frames {
        let soles = &frame.overlay.soles;
        let same = |a: &SoleMark, b: &SoleMark| a.side == b.side && middle(a).distance(middle(b)) < MOVED;
        frame.overlay.prints =
            stood.iter().filter(|print| !soles.iter().any(|sole| same(sole, print))).cloned().collect();
        for sole in soles.iter().filter(|sole| sole.part == Part::Flat) {
            if !stood.iter().any(|print| same(sole, print)) {
                stood.push(sole.clone());
            }
        }
    }
}

/// A camera a moment and how wide its picture is, px: together they fill the cell.
fn cameras(frames: &[Frame]) -> Vec<(Camera, u32)> {
    let (toward, right) =
        (DVec3::new(real::sin(ASIDE), 0.0, real::cos(ASIDE)), DVec3::new(real::cos(ASIDE), 0.0, -real::sin(ASIDE)));
    let boxes: Vec<(DVec3, DVec3)> = frames.iter().map(compose::bounds).collect();
    let floors: Vec<f64> = frames.iter().zip(&boxes).map(|(frame, found)| compose::floor(frame, found)).collect();
    let tall = boxes.iter().zip(&floors).map(|((_, high), floor)| high.y - floor).fold(0.3, f64::max).min(6.0);
    let distance = 2.5 * tall.max(1.0);
    let spans: Vec<(f64, f64)> = frames.iter().map(|frame| span(frame, right)).collect();
    let gaps = f64::from(GAP) * (frames.len() - 1) as f64;
    let room = f64::from(CELL_WIDTH) - gaps;
    let wide: f64 = spans.iter().map(|(low, high)| high - low).sum();
    let margin = 8.0 * frames.len() as f64; // px
    let height = f64::from(CELL_HEIGHT);
    let scale = ((height - ROOM[0] - ROOM[1]) / tall).min((room - margin).max(40.0) / wide.max(0.3));
    let spare = ((room - wide * scale) / frames.len() as f64).max(0.0);
    let mut given = 0.0;
    let mut taken = 0;
    let mut cameras = Vec::with_capacity(frames.len());
    for (at, ((low, high), floor)) in spans.into_iter().zip(floors).enumerate() {
        given += (high - low) * scale + spare;
        let last = at + 1 == frames.len();
        let width = if last { room as u32 } else { (given.round() as u32).min(room as u32) }.saturating_sub(taken);
        taken += width;
        let (body_low, body_high) = boxes[at];
        let depth = ((body_low + body_high) / 2.0).dot(toward);
        let target = right * ((low + high) / 2.0) + toward * depth + DVec3::Y * (floor + tall * 0.5);
        let eye = target + toward * distance + DVec3::Y * (tall * 0.32);
        let centre = DVec2::new(f64::from(width) / 2.0, (ROOM[0] + height - ROOM[1]) / 2.0);
        cameras.push((Camera::looking_at(eye, target, scale * distance, centre), width.max(1)));
    }
    cameras
}

/// How far body and arrows reach along an axis, m.
fn span(frame: &Frame, axis: DVec3) -> (f64, f64) {
    let points = frame.surfaces.iter().flat_map(|surface| &surface.positions).filter(|point| point.is_finite());
    let tails = frame.overlay.pushes.iter().map(|push| marks::arrow_ends(push, &frame.surfaces).0);
    let along = points.copied().chain(tails).map(|point| point.dot(axis));
    let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), at| (a.min(at), b.max(at)));
    let middle = frame.overlay.com.filter(|com| com.is_finite()).map_or(0.0, |com| com.dot(axis));
    if low > high || high - low > 12.0 { (middle - 0.5, middle + 0.5) } else { (low, high) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{BakeOptions, Baked, bake};
    use crate::model::Scenario;
    use crate::model::report::Outcome;
    use crate::model::scenario::{Direction, Push};
    use crate::picture::png;
    use crate::rig::{self, mannequin};

    fn builtin() -> Rig {
        let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        rig::load_bytes("builtin", mannequin::BUILTIN, &alone, None).expect("the built-in rig loads")
    }

    fn shoved(rig: &Rig, impulse: f64, heading: f64) -> Baked {
        let toward = Direction::Heading(heading);
        let push = Push { start: 0.6, duration: 0.2, force: impulse / 0.2, toward, at: crate::model::Role::Chest };
        let scenario = Scenario { duration: 3.0, push: vec![push], ..Scenario::demo() };
        bake(rig, &scenario, &BakeOptions::default()).expect("the simulation holds")
    }

    fn drawn(rig: &Rig, baked: &Baked) -> RgbaImage {
        clip_cell(rig, &baked.clip, &baked.report, &[])
    }

    /// Columns that show a colour near that one.
    fn columns(image: &RgbaImage, near: impl Fn([u8; 3]) -> bool) -> Vec<u32> {
        let seen = image.enumerate_pixels().filter(|(_, _, pixel)| near([pixel[0], pixel[1], pixel[2]]));
        seen.map(|(x, _, _)| x).collect()
    }

    fn red([r, g, b]: [u8; 3]) -> bool {
        r > 140 && g < 95 && b < 75
    }

    fn tan([r, g, b]: [u8; 3]) -> bool {
        r > 150 && g.abs_diff(r) > 30 && r > b && b < 130 && g > 90
    }

    #[test]
    fn a_step_shows_four_bodies_one_arrow_and_the_same_bytes_again() {
        let rig = builtin();
        let baked = shoved(&rig, 60.0, std::f64::consts::FRAC_PI_2);
        assert_eq!(baked.report.outcome, Outcome::Step);
        let image = drawn(&rig, &baked);
        assert_eq!((image.width(), image.height()), (CELL_WIDTH, CELL_HEIGHT));
        let bodies = columns(&image, tan);
        let quarter = |at: u32| bodies.iter().filter(|x| **x / 80 == at).count();
        assert!((0..4).all(|at| quarter(at) > 350), "{:?}", [quarter(0), quarter(1), quarter(2), quarter(3)]);
        let arrow = columns(&image, red);
        let (first, last) = (arrow.iter().min().copied(), arrow.iter().max().copied());
        assert!(arrow.len() > 40, "{} pixels of arrow", arrow.len());
        assert!(first >= Some(60) && last <= Some(160), "only in the second picture: {first:?} to {last:?}");
        assert_eq!(png(&image), png(&drawn(&rig, &baked)));
    }

    #[test]
    fn pushes_of_eight_directions_all_show_their_arrow() {
        let rig = builtin();
        for at in 0..8 {
            let baked = shoved(&rig, 50.0, f64::from(at) * std::f64::consts::FRAC_PI_4);
            let arrow = columns(&drawn(&rig, &baked), red).len();
            assert!(arrow > 10, "direction {at}: {arrow} pixels");
        }
    }

    #[test]
    fn the_third_picture_is_the_landing_the_farthest_sway_or_the_fall() {
        let rig = builtin();
        let pose = |_: f64| vec![glam::DAffine3::IDENTITY; rig.nodes.len()];
        let telling_of = |report: &ClipReport| {
            let (moments, layout) = (Vec::new(), compose::Layout::default());
            let input = SheetInput { rig: &rig, pose: &pose, report, overlay: None, props: &[], moments, layout };
            telling(&input).into_iter().map(|moment| moment.time).collect::<Vec<f64>>()
        };
        let report = crate::picture::moments::tests::pushed();
        assert_eq!(telling_of(&report), [0.52, 0.7, 1.05, 3.0]);
        let mut fell = report.clone();
        fell.events.push(crate::model::report::Event {
            name: "balance_lost".to_owned(),
            time: 0.95,
            ..fell.events[0].clone()
        });
        assert_eq!(telling_of(&fell), [0.52, 0.7, 0.95, 3.0]);
        let mut walked = report.clone();
        walked.disturbances.clear();
        assert_eq!(telling_of(&walked).len(), 4, "nothing hits: other moments");
        let broken = ClipReport { duration: f64::NAN, ..report };
        assert!(telling_of(&broken).iter().all(|time| time.is_finite()));
    }

    #[test]
    fn where_a_foot_stood_before_it_leaves_a_print() {
        let mark = |x: f64| SoleMark {
            side: Side::Left,
            part: Part::Flat,
            whole: vec![DVec3::X * x, DVec3::X * x + DVec3::Z * 0.2],
            held: Vec::new(),
        };
        let frame =
            |soles: Vec<SoleMark>| Frame { overlay: Overlay { soles, ..Overlay::default() }, ..Frame::default() };
        let mut frames = [frame(vec![mark(0.1)]), frame(vec![mark(0.11)]), frame(vec![]), frame(vec![mark(0.5)])];
        leave_prints(&mut frames);
        assert_eq!(frames.each_ref().map(|frame| frame.overlay.prints.len()), [0, 0, 1, 1]);
    }

    #[test]
    fn poses_that_are_not_numbers_and_clips_of_no_length_do_no_harm() {
        let rig = builtin();
        let nowhere = |_: f64| vec![glam::DAffine3::from_scale(DVec3::NAN); rig.nodes.len()];
        let flung = |_: f64| vec![glam::DAffine3::from_translation(DVec3::X * 1e9); rig.nodes.len()];
        for pose in [&nowhere as &dyn Fn(f64) -> Vec<glam::DAffine3>, &flung] {
            for duration in [3.0, 0.0, f64::NAN] {
                let report = ClipReport { duration, ..crate::picture::moments::tests::pushed() };
                let (moments, layout) = (Vec::new(), compose::Layout::default());
                let input = SheetInput { rig: &rig, pose, report: &report, overlay: None, props: &[], moments, layout };
                assert_eq!(cell(&input).width(), CELL_WIDTH);
            }
        }
    }
}

//! What each lane of a scenario comes to on drawn cases, by joint torques alone or at the program's defaults.
//!
//! `cargo bench --bench goals` prints a row a lane. Words after `--` choose lanes by a part of their name; `--auto` bakes at the defaults
//! instead, `--stepper` poses the body; `--seed N` draws other cases, `--count N` more of them, and `-v` prints each clip. The bodies
//! are the built-in rig, on longer and shorter legs too, and third-party ones where they are there. `-f` prints those that fall.
//!
//! Columns: clips, falls, their mean and least plausibility, speed along the way as a share of what was asked for; in how many clips
//! both feet are off the ground for more than 0.05 s, joints are past their ranges in more than 1 % of the frames, a foot slides by
//! more than 30 mm.

#![expect(clippy::print_stdout, reason = "the table")]

#[path = "../common.rs"]
mod common;
#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
#[path = "../people.rs"]
mod people;

use glam::DVec3;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::report::{ClipReport, Outcome};
use surefoot::model::{Role, scenario_text};
use surefoot::ragdoll::control::Assist;
use surefoot::rig::Rig;

/// Cases a lane where no number is given.
const COUNT: u64 = 20;
/// m, legs for which a speed is as it is written: others go Froude-equal.
const LEG: f64 = 0.83;

/// What a case is drawn from: its own numbers, and 1 for legs of 0.83 m, their Froude-equal speed else.
struct Drawn {
    draw: Seed,
    tempo: f64,
}

impl Drawn {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        self.draw.between(from, to)
    }

    fn walk(&mut self, from: f64, to: f64) -> String {
        format!("[[walk]]\nstart = 0.5\nspeed = {:.3}\n", self.between(from, to) * self.tempo)
    }

    /// So many N for 0.2 s from anywhere.
    fn shove(&mut self, start: f64, force: f64) -> String {
        let toward = self.between(-180.0, 180.0);
        format!("[[push]]\nstart = {start:.2}\nduration = 0.2\nforce = {force}\ntoward = {toward:.0}\n")
    }

    fn shoved(&mut self, lanes: String) -> String {
        let start = self.between(5.0, 9.0);
        lanes + &self.shove(start, 100.0)
    }

    /// A platform that leans by 0.6 to all of that, one way or the other, at 10 degrees a second without a rest; friction 1, 100 N every 5 s.
    fn platform(&mut self, most: [f64; 2]) -> String {
        let lane = |draw: &mut Drawn, most: f64| {
            let (mut time, mut at, mut keys) = (0.0, 0.0, String::from("[0, 0]"));
            while most > 0.0 && time < 60.0 {
                let to = draw.between(0.6, 1.0) * if draw.between(0.0, 1.0) < 0.5 { -most } else { most };
                time += f64::max((to - at).abs() / 10.0, 0.1);
                at = to;
                keys += &format!(", [{time:.2}, {at:.1}]");
            }
            keys
        };
        let [pitch, roll] = most.map(|most| lane(self, most));
        let ground = format!("[ground]\nkind = \"platform\"\nfriction = 1.0\npitch = [{pitch}]\nroll = [{roll}]\n");
        (1..12).fold(ground, |text, time| text + &self.shove(5.0 * f64::from(time), 100.0))
    }
}

/// A lane: its name, s, how long its clips are, and what a case of it says.
type Lane = (&'static str, f64, fn(&mut Drawn) -> String);

fn slope(drawn: &mut Drawn, degrees: f64) -> String {
    format!("[ground]\nkind = \"slope\"\nangle = {degrees}\n{}", drawn.walk(0.35, 0.9))
}

fn stairs(drawn: &mut Drawn, rise: f64) -> String {
    let ground = format!("rise = {rise}\ntread = {:.3}\ncount = 8", drawn.between(0.28, 0.34));
    format!("[ground]\nkind = \"stairs\"\n{ground}\n{}", drawn.walk(0.3, 0.6))
}

fn gaps(drawn: &mut Drawn) -> String {
    let ground = format!("width = 0.2\nspacing = {:.3}", drawn.between(0.8, 1.6));
    format!("[ground]\nkind = \"gaps\"\n{ground}\n{}", drawn.walk(0.5, 1.1))
}

fn uneven(drawn: &mut Drawn) -> String {
    let ground =
        format!("height = 0.05\nwavelength = {:.2}\nseed = {:.0}", drawn.between(1.0, 3.0), drawn.between(1.0, 999.0));
    format!("[ground]\nkind = \"uneven\"\n{ground}\n{}", drawn.walk(0.4, 1.1))
}

fn headed(drawn: &mut Drawn, heading: f64, from: f64, to: f64) -> String {
    drawn.walk(from, to) + &format!("heading = {heading:.0}\nfacing = 0\n")
}

fn one_foot(drawn: &mut Drawn) -> String {
    let on = if drawn.between(0.0, 1.0) < 0.5 { "left" } else { "right" };
    let stand = format!("[[stand]]\nstart = 1\nduration = 20\non = \"{on}\"\n");
    (1..5).fold(stand, |text, time| text + &drawn.shove(4.0 * f64::from(time), 20.0))
}

fn turn(drawn: &mut Drawn) -> String {
    let way = if drawn.between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
    format!("[[turn]]\nstart = 1\nfacing = {:.0}\n", way * drawn.between(45.0, 180.0))
}

/// The paper's range: 10 to 500 N for 0.1 to 0.5 s from anywhere.
fn pushed(drawn: &mut Drawn, from: f64) -> String {
    let (start, duration) = (drawn.between(from, from + 2.0), drawn.between(0.1, 0.5));
    let (force, toward) = (drawn.between(10.0, 500.0), drawn.between(-180.0, 180.0));
    format!("[[push]]\nstart = {start:.2}\nduration = {duration:.2}\nforce = {force:.0}\ntoward = {toward:.0}\n")
}

fn dragged(drawn: &mut Drawn) -> String {
    let walk = drawn.walk(0.6, 1.2);
    format!("{walk}[[pull]]\nstart = 2\nduration = 18\nforce = 80\ntoward = {:.0}\n", drawn.between(-180.0, 180.0))
}

fn slippery(drawn: &mut Drawn, friction: f64) -> String {
    format!("[ground]\nfriction = {friction}\n{}", drawn.walk(0.4, 1.2))
}

fn low(drawn: &mut Drawn) -> String {
    let amount = drawn.between(0.1, 0.3);
    drawn.walk(0.4, 0.9) + &format!("[[crouch]]\nstart = 3\nduration = 10\namount = {amount:.2}\n")
}

const LANES: [Lane; 33] = [
    ("up 5", 20.0, |drawn| slope(drawn, 5.0)),
    ("up 15", 20.0, |drawn| slope(drawn, 15.0)),
    ("up 25", 20.0, |drawn| slope(drawn, 25.0)),
    ("down 5", 20.0, |drawn| slope(drawn, -5.0)),
    ("down 15", 20.0, |drawn| slope(drawn, -15.0)),
    ("down 25", 20.0, |drawn| slope(drawn, -25.0)),
    ("up 15 shoved", 20.0, |drawn| {
        let lanes = slope(drawn, 15.0);
        drawn.shoved(lanes)
    }),
    ("up 25 shoved", 20.0, |drawn| {
        let lanes = slope(drawn, 25.0);
        drawn.shoved(lanes)
    }),
    ("down 25 shoved", 20.0, |drawn| {
        let lanes = slope(drawn, -25.0);
        drawn.shoved(lanes)
    }),
    ("stairs up", 20.0, |drawn| stairs(drawn, 0.17)),
    ("stairs up shoved", 20.0, |drawn| {
        let lanes = stairs(drawn, 0.17);
        drawn.shoved(lanes)
    }),
    ("stairs down", 26.0, |drawn| stairs(drawn, -0.17)),
    ("stairs down shoved", 26.0, |drawn| {
        let lanes = stairs(drawn, -0.17);
        drawn.shoved(lanes)
    }),
    ("gaps", 20.0, gaps),
    ("gaps shoved", 20.0, |drawn| {
        let lanes = gaps(drawn);
        drawn.shoved(lanes)
    }),
    ("uneven", 20.0, uneven),
    ("uneven shoved", 20.0, |drawn| {
        let lanes = uneven(drawn);
        drawn.shoved(lanes)
    }),
    ("platform pitch 45", 60.0, |drawn| drawn.platform([45.0, 0.0])),
    ("platform roll 45", 60.0, |drawn| drawn.platform([0.0, 45.0])),
    ("platform both 32", 60.0, |drawn| drawn.platform([32.0, 32.0])),
    ("one foot", 22.0, one_foot),
    ("turn", 5.5, turn),
    ("walk to 0.6", 12.0, |drawn| drawn.walk(0.2, 0.6)),
    ("walk to 1.2", 12.0, |drawn| drawn.walk(0.6, 1.2)),
    ("walk to 1.8", 12.0, |drawn| drawn.walk(1.2, 1.8)),
    ("backwards", 12.0, |drawn| headed(drawn, 180.0, 0.3, 0.6)),
    ("sideways", 12.0, |drawn| headed(drawn, 90.0, 0.2, 0.4)),
    ("pushed", 8.0, |drawn| pushed(drawn, 0.5)),
    ("pushed at 1.2", 10.0, |drawn| drawn.walk(1.2, 1.2) + &pushed(drawn, 3.0)),
    ("dragged by 80 N", 20.0, dragged),
    ("friction 0.1", 16.0, |drawn| slippery(drawn, 0.1)),
    ("friction 0.3", 16.0, |drawn| slippery(drawn, 0.3)),
    ("walk crouched", 16.0, low),
];

/// What a clip came to.
struct Came {
    name: String,
    report: ClipReport,
    /// m/s along the way that was asked for over the last half of the clip, over what was asked; 0 where none was.
    pace: f64,
}

fn came(lane: &Lane, seed: u64, bodies: &[(Rig, f64)], drive: Drive) -> Came {
    let (title, duration, says) = lane;
    let at = seed as usize % bodies.len();
    let (rig, legs) = &bodies[at];
    let own = title.bytes().fold(0u64, |sum, byte| sum.wrapping_mul(31).wrapping_add(u64::from(byte)));
    let tempo = (legs * rig.body.leg_length / LEG).sqrt();
    let lanes = says(&mut Drawn { draw: Seed::new(seed ^ (own << 20)), tempo });
    let text = format!("title = \"goal\"\nduration = {duration}\n[character]\nleg_scale = {legs}\n{lanes}");
    let scenario = scenario_text::parse("goal", &text).unwrap_or_else(|errors| panic!("{errors:?}\n{text}"));
    let options = BakeOptions { drive, seed: Some(seed), ..BakeOptions::default() };
    let baked = bake(rig, &scenario, &options).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let pace = scenario.walk.first().map_or(0.0, |walk| {
        let hips = rig.body.joint(Role::Hips).expect("hips");
        let mut sampler = rig.sampler(&baked.clip);
        let (half, end) = (0.5 * baked.clip.duration, baked.clip.duration);
        let way = DVec3::new(walk.heading.sin(), 0.0, walk.heading.cos());
        let [from, to] = [half, end].map(|time| sampler.sample(time).positions[hips]);
        (to - from).dot(way) / (end - half) / walk.speed
    });
    Came { name: format!("{seed}, body {at}: {}", lanes.replace('\n', " ")), report: baked.report, pace }
}

fn told(came: &Came) -> String {
    let found = &came.report.plausibility;
    let Came { name, report, pace } = came;
    let notes = found.notes.join("; ");
    format!(
        "  {:?} {:.3} {} steps, pace {pace:.2}, {}: {name} {notes}",
        report.outcome, found.score, report.steps, report.drive
    )
}

fn row(title: &str, found: &[Came]) -> String {
    let share = |holds: &dyn Fn(&ClipReport) -> bool| found.iter().filter(|came| holds(&came.report)).count();
    let scores = found.iter().map(|came| came.report.plausibility.score);
    let (mean, least) = (scores.clone().sum::<f64>() / found.len() as f64, scores.fold(1.0, f64::min));
    let pace = found.iter().map(|came| came.pace).sum::<f64>() / found.len() as f64;
    let falls = share(&|report| report.outcome == Outcome::Fall);
    let hovers = share(&|report| report.plausibility.hover_longest_s > 0.05);
    let bent = share(&|report| report.plausibility.joint_excess_share > 0.01);
    let slides = share(&|report| report.plausibility.scuff_max_mm > 30.0);
    format!(
        "{title:<20} {:>5} {falls:>5} {mean:>6.3} {least:>6.2} {pace:>5.2} {hovers:>6} {bent:>6} {slides:>6}",
        found.len()
    )
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let flag = |name: &str| words.iter().any(|word| word == name);
    let number = |name: &str| words.iter().skip_while(|word| *word != name).nth(1).and_then(|word| word.parse().ok());
    let (seed, count) = (number("--seed").unwrap_or(0), number("--count").unwrap_or(COUNT));
    let chosen: Vec<&String> =
        words.iter().filter(|word| !word.starts_with('-') && word.parse::<u64>().is_err()).collect();
    let drive = if flag("--auto") {
        Drive::Auto(Helped::Auto)
    } else if flag("--stepper") {
        Drive::Stepper
    } else {
        Drive::Ragdoll(Helped::Within(Assist::default()))
    };
    let bodies = people::people(&[1.0, 0.7, 1.3], &["gdquest_mannequiny.glb", "m2m_human_male.glb"]);
    println!("{:<20} clips falls  score  least  pace hovers ranges slides", format!("{} bodies", bodies.len()));
    for lane in LANES {
        if !chosen.is_empty() && !chosen.iter().any(|word| lane.0.contains(word.as_str())) {
            continue;
        }
        let found: Vec<Came> =
            (seed..seed + count).into_par_iter().map(|seed| came(&lane, seed, &bodies, drive)).collect();
        println!("{}", row(lane.0, &found));
        let shown = found.iter().filter(|came| flag("-v") || flag("-f") && came.report.outcome == Outcome::Fall);
        shown.for_each(|came| println!("{}", told(came)));
    }
}

//! Looks ahead for a way to keep the feet: copies of the body are run on with other dials of its law, and the first that stands well is
//! taken. Scenario space, SI.
//!
//! It decides when a push is felt (not before) and whenever a corrective step begins; only where the body as it is would fall, or would
//! stand in a way that nobody lets pass, is anything else tried. Who is led is also gone back for after a fall ([`super::retrace`]). It may
//! know the rest of the push: a clip is authored. The draws hang on the seed and on the tick, the budget is counted in ticks: the same input
//! finds the same, on any machine.

use super::ArticulatedOptions;
use super::looks::Looks;
use super::run::{Course, Run};
use crate::maths::seed::Seed;
use crate::ragdoll::Tuning;

/// s after its beginning, when a push is felt: the quickest of people's answers to a shove (0.1 to 0.15 s from experience of platforms that jerk).
pub(super) const FELT: f64 = 0.1;
/// s, how far ahead a copy is run.
const AHEAD: f64 = 2.2;
/// s at rest, after which a copy need not go on.
const RESTS: f64 = 0.2;
/// Of the standing height, under which a copy has fallen. It is given up sooner than a body: who gets that low hardly gets up.
const FALLEN: f64 = 0.62;
/// What a fall costs at once; a s later it is [`LATER`] less.
const FALLS: f64 = 100.0;
const LATER: f64 = 10.0;
/// What a joint's jump costs, a step, and not to be at rest in the end, of the cost of [`Looks`].
const JUMP: f64 = 0.5;
const STEP: f64 = 0.1;
const LATE: f64 = 1.0;
/// Steps: two catch a shove (Hof 2010: at most two), and as many again set the feet side by side.
const MANY: f64 = 4.0;
/// What it costs who is led to go on as nobody does: less than a fall.
const ABSURD: f64 = 40.0;
/// How patient the plan of who is led may be: it gives up at once, as usual, or late.
const PATIENCE: [f64; 3] = [0.0, 1.0, 3.0];
/// Times the ticks of all other decisions, what rescues may take.
const RESCUES: usize = 3;
/// Candidates at a decision and ticks in all, by effort. Of 512 shoves of a walk of 1.2 m/s by up to 500 N for half a second, 496 are stood
/// with 120 and 40 000, and 491 with 60 and 20 000, which takes a fifth less time; of 7 that are not, 2 are with 2 000 and 3 000 000.
const EFFORTS: [(usize, usize); 4] = [(0, 0), (120, 40_000), (300, 100_000), (2_000, 3_000_000)];

/// What the draws of a search that is made again are apart from those of the first: any large odd number.
const AGAIN: u64 = 0x9e37_79b9_7f4a_7c15;

/// How a run is looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ahead {
    /// 0 to 3, how far it looks ahead.
    pub effort: u8,
    /// How often it has been searched for before: other draws of the same seed.
    pub again: u8,
    /// s, when it gives balance up, whatever it could do.
    pub gives_up: Option<f64>,
}

/// What was looked for, and found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Searched {
    /// 0 to 3.
    pub effort: u8,
    /// Copies that were run with other dials.
    pub tried: u32,
    /// Decisions at which one of them was taken.
    pub chosen: u32,
}

/// A search on its way.
pub(super) struct Search {
    done: Searched,
    left: usize,
    /// Ticks for rescues, and how often one was tried.
    spare: usize,
    rescued: u64,
    seed: u64,
    dt: f64,
}

/// How a copy ends.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ending {
    good: bool,
    /// Less is better.
    cost: f64,
}

impl Search {
    pub(super) fn new(options: &ArticulatedOptions) -> Search {
        let effort = options.ahead.effort.min(3);
        let done = Searched { effort, ..Searched::default() };
        Search {
            done,
            left: EFFORTS[usize::from(effort)].1,
            spare: RESCUES * EFFORTS[usize::from(effort)].1,
            rescued: 0,
            seed: options.seed.wrapping_add(AGAIN.wrapping_mul(u64::from(options.ahead.again))),
            dt: options.dt,
        }
    }

    pub(super) fn done(&self) -> Searched {
        self.done
    }

    /// Whether the tick at `time` may be one to decide at: only then a copy from before it is worth its time.
    pub(super) fn may_decide(&self, run: &Run, time: f64) -> bool {
        let begins = run.control.swing.is_none() || self.felt(run, time);
        self.left > 0 && begins
    }

    /// Whether it is, now that its law has decided.
    pub(super) fn decides(&self, run: &Run, time: f64) -> bool {
        let unfelt = |start: f64| (start..start + FELT - 1e-9).contains(&time);
        let steps = run.control.swing.is_some_and(|swing| !swing.comfort) && !run.control.follows();
        self.felt(run, time) || steps && !run.acting.iter().any(|push| unfelt(push.start))
    }

    /// Whether a push is felt now.
    fn felt(&self, run: &Run, time: f64) -> bool {
        let felt = |start: f64| (start + FELT..start + FELT + self.dt - 1e-9).contains(&time);
        run.acting.iter().any(|push| felt(push.start))
    }

    /// Other dials from `time` on, where the own do not do and others do better.
    pub(super) fn better(&mut self, course: &Course, run: &Run, time: f64) -> Option<Tuning> {
        let own = run.control.tuning;
        let first = self.roll(course, run, &own, time, f64::INFINITY);
        if first.good {
            return None;
        }
        self.draw(course, run, time, first.cost)
    }

    /// Other dials from `time` on, with which a body that falls later, or goes on as nobody does, goes on as people do.
    pub(super) fn rescue(&mut self, course: &Course, run: &Run, time: f64) -> Option<Tuning> {
        let share = self.spare.min(EFFORTS[usize::from(self.done.effort)].1 / 2);
        self.spare -= share;
        let left = std::mem::replace(&mut self.left, share);
        let found = self.draw(course, run, time, ABSURD);
        self.spare += std::mem::replace(&mut self.left, left);
        self.rescued += 1;
        found
    }

    /// The best dials drawn at `time` that cost less than `most`.
    fn draw(&mut self, course: &Course, run: &Run, time: f64, most: f64) -> Option<Tuning> {
        let own = run.control.tuning;
        let (mut best, mut dials) = (most, None);
        let fresh = run.control.character;
        let tick = (time / self.dt).round() as u64;
        let mut draw = Seed::new(self.seed.wrapping_add(self.rescued).wrapping_mul(7919).wrapping_add(tick));
        for index in 0..EFFORTS[usize::from(self.done.effort)].0 {
            if self.left == 0 {
                break;
            }
            let near = dials.unwrap_or(own);
            let mut next = match index {
                0 if own != fresh => fresh,
                _ if index % 2 == 0 => fresh.drawn_near(&mut draw, 1.0),
                _ => near.drawn_near(&mut draw, 0.5),
            };
            if run.goes() {
                next.patience = PATIENCE[(draw.bits() % 3) as usize];
            }
            self.done.tried += 1;
            let ending = self.roll(course, run, &next, time, best);
            if ending.cost < best {
                (best, dials) = (ending.cost, Some(next));
            }
            if ending.good {
                break;
            }
        }
        self.done.chosen += u32::from(dials.is_some());
        dials
    }

    /// Runs a copy on with those dials, as long as it costs less than `most`.
    fn roll(&mut self, course: &Course, run: &Run, tuning: &Tuning, time: f64, most: f64) -> Ending {
        let mut copy = run.clone();
        copy.control.tuning = *tuning;
        let over = copy.acting.iter().map(|push| push.start + push.duration).fold(0.0, f64::max);
        let mut looks = Looks::new(course, self.dt);
        let ticks = (AHEAD / self.dt).round() as usize;
        for tick in 0..ticks {
            let now = time + tick as f64 * self.dt;
            self.left = self.left.saturating_sub(1);
            let ticked = copy.tick(course, now);
            looks.see(course, &copy, &ticked, now);
            let stood = tick as f64 * self.dt;
            if ticked.lies || ticked.height < FALLEN || copy.go_on(course, now).is_err() {
                return Ending { good: false, cost: FALLS - LATER * stood };
            }
            if copy.rest > RESTS && now > over {
                break;
            }
            if looks.cost() >= most {
                return Ending { good: false, cost: looks.cost() };
            }
        }
        let (seen, jumps) = (looks.cost(), looks.jumps() as f64);
        let taken = copy.control.report.steps.saturating_sub(run.control.report.steps) as f64;
        // Who goes on as he is led has caught himself: feet that walk slide and roll as they do.
        let goes = copy.goes();
        let absurd = if course.led() && looks.absurd() { ABSURD } else { 0.0 };
        let late = if goes || copy.rest > RESTS { 0.0 } else { LATE };
        let fair = if goes { !looks.absurd() } else { seen <= 0.0 && jumps <= 0.0 };
        let good = fair && taken <= MANY;
        Ending { good, cost: absurd + seen + JUMP * jumps + STEP * taken + late }
    }
}

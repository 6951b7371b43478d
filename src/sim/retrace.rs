//! Where a led body falls, or goes on as nobody does, another way on is looked for from shortly before. Scenario space, SI.
//!
//! A walk is under way all the time, so that the moment at which a shove undoes it is known only afterwards. Copies of the last two
//! seconds are kept; from the youngest to the oldest, each is searched ([`Search::rescue`]) until one goes on as people do.
//! A push that is not felt yet changes nothing before it is.

use super::looks::Looks;
use super::run::{Course, Run, Ticked};
use super::search::{FELT, Search};
use std::collections::VecDeque;

/// Ticks between two copies, how many are kept, and for how many ticks before a fall it is too late to do anything.
const EVERY: usize = 10;
const KEPT: usize = 24;
const TOO_LATE: usize = 8;

/// What is gone back to: the tick, the body then, and what had been seen of it.
type Copied = (usize, Run, Looks);

/// Copies of a body as it was lately.
pub(super) struct Retrace {
    dt: f64,
    kept: VecDeque<Copied>,
    looks: Looks,
    /// Nothing was found once: it goes on as it does.
    resigned: bool,
}

impl Retrace {
    pub(super) fn new(course: &Course, dt: f64) -> Retrace {
        Retrace { dt, kept: VecDeque::new(), looks: Looks::new(course, dt), resigned: false }
    }

    /// Keeps the body as it is before that tick.
    pub(super) fn keep(&mut self, run: &Run, tick: usize) {
        if !tick.is_multiple_of(EVERY) || self.resigned {
            return;
        }
        if self.kept.len() == KEPT {
            self.kept.pop_front();
        }
        self.kept.push_back((tick, run.clone(), self.looks.clone()));
    }

    /// The tick to go on from and the body with other dials, where it `falls` at `tick` or goes on as nobody does.
    pub(super) fn back(
        &mut self,
        search: &mut Search,
        course: &Course,
        (run, ticked): (&Run, &Ticked),
        (tick, falls): (usize, bool),
    ) -> Option<(usize, Run)> {
        if self.resigned {
            return None;
        }
        let at = |tick: usize| tick as f64 * self.dt;
        self.looks.see(course, run, ticked, at(tick));
        if !falls && !self.looks.absurd() {
            return None;
        }
        let unfelt = |from: f64, start: f64| from < start + FELT - 1e-9 && start < at(tick);
        while let Some((from, mut copy, looks)) = self.kept.pop_back() {
            let early = from + TOO_LATE <= tick && !copy.acting.iter().any(|push| unfelt(at(from), push.start));
            if early && let Some(tuning) = search.rescue(course, &copy, at(from)) {
                copy.control.tuning = tuning;
                self.looks = looks;
                return Some((from, copy));
            }
        }
        self.resigned = true;
        None
    }
}

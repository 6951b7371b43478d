//! The corrections of one clip and what a person said of each: to decide, accepted, rejected. Pure; frames count from 0, m.
//!
//! A rejected one stays in the list though the correction leaves it out, so that it can be taken back.

use crate::correct::{Done, Target};
use crate::model::findings::{Flag, Rule};

/// What a person said of a correction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decision {
    /// Nothing yet.
    #[default]
    Pending,
    /// It is written when the clip is saved.
    Accepted,
    /// It is left out, of the preview too.
    Rejected,
}

/// What is done about one fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Repair {
    /// The rule whose flags it answers.
    pub rule: Rule,
    /// Of one foot.
    pub foot: Option<&'static str>,
    /// First frame that it touches.
    pub start: usize,
    /// Last.
    pub end: usize,
    /// m: the farthest that a foot or the pelvis goes.
    pub moved_m: f64,
    /// Sentences for a person.
    pub what: String,
    /// The flags.
    pub answers: Vec<Target>,
    /// What was said of it.
    pub decision: Decision,
}

/// All of a clip, by their first frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Repairs {
    /// By start.
    pub list: Vec<Repair>,
}

impl Repair {
    fn of(done: &Done) -> Repair {
        Repair {
            rule: done.rule,
            foot: done.foot,
            start: done.start,
            end: done.end,
            moved_m: done.moved_m,
            what: done.what.clone(),
            answers: done.answers.clone(),
            decision: Decision::Pending,
        }
    }

    /// Whether it answers one of these.
    pub fn answers_any(&self, others: &[Target]) -> bool {
        meet(&self.answers, others)
    }
}

impl Repairs {
    /// A correction came: decisions stay, and so does what was rejected.
    pub fn take(&mut self, done: &[Done]) {
        let mut list: Vec<Repair> = Vec::new();
        for done in done {
            // What mends the rest of the same flag is the same repair to a person.
            match list.iter_mut().find(|repair| repair.answers_any(&done.answers)) {
                Some(repair) => {
                    (repair.start, repair.end) = (repair.start.min(done.start), repair.end.max(done.end));
                    repair.moved_m = repair.moved_m.max(done.moved_m);
                    repair.what = format!("{}; then {}", repair.what, done.what);
                    repair.answers.extend(&done.answers);
                }
                None => list.push(Repair::of(done)),
            }
        }
        let (rejected, known): (Vec<Repair>, Vec<Repair>) =
            std::mem::take(&mut self.list).into_iter().partition(|repair| repair.decision == Decision::Rejected);
        for repair in &mut list {
            let before = known.iter().find(|known| known.answers_any(&repair.answers));
            repair.decision = before.map_or(Decision::Pending, |known| known.decision);
        }
        list.extend(rejected.into_iter().filter(|repair| repair.decision == Decision::Rejected));
        list.sort_by_key(|repair| (repair.start, repair.end, repair.rule));
        self.list = list;
    }

    /// Flags of those with that decision.
    pub fn flags(&self, decision: Decision) -> Vec<Target> {
        let of = self.list.iter().filter(|repair| repair.decision == decision);
        of.flat_map(|repair| repair.answers.iter().copied()).collect()
    }

    /// How many have that decision.
    pub fn count(&self, decision: Decision) -> usize {
        self.list.iter().filter(|repair| repair.decision == decision).count()
    }

    /// Which of them answers a flag.
    pub fn of_flag(&self, flag: &Flag) -> Option<usize> {
        let target = [Target::of(flag)];
        self.list.iter().position(|repair| repair.answers_any(&target))
    }

    /// Decides one; whether the clip has to be corrected again.
    pub fn decide(&mut self, index: usize, decision: Decision) -> bool {
        let Some(repair) = self.list.get_mut(index) else { return false };
        let was = std::mem::replace(&mut repair.decision, decision);
        (was == Decision::Rejected) != (decision == Decision::Rejected)
    }

    /// Accepts all that are not decided.
    pub fn accept_all(&mut self) {
        for repair in &mut self.list {
            if repair.decision == Decision::Pending {
                repair.decision = Decision::Accepted;
            }
        }
    }
}

/// Whether some of these are some of those.
pub fn meet(these: &[Target], those: &[Target]) -> bool {
    these.iter().any(|one| those.iter().any(|other| one.meets(other)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn done(start: usize, flag: (usize, usize)) -> Done {
        let answers = vec![Target { rule: Rule::FootSlide, foot: Some("left"), start: flag.0, end: flag.1 }];
        let (rule, foot, what) = (Rule::FootSlide, Some("left"), "held".to_owned());
        Done { start, end: start + 30, rule, foot, moved_m: 0.1, what, held: Vec::new(), answers }
    }

    #[test]
    fn decisions_outlive_another_correction() {
        let mut repairs = Repairs::default();
        repairs.take(&[done(0, (5, 9)), done(20, (31, 40)), done(60, (70, 80))]);
        repairs.accept_all();
        assert!(!repairs.decide(0, Decision::Pending) && repairs.decide(1, Decision::Rejected));
        // Without the second, the third begins elsewhere.
        repairs.take(&[done(0, (5, 9)), done(55, (69, 80))]);
        let decisions: Vec<Decision> = repairs.list.iter().map(|repair| repair.decision).collect();
        assert_eq!(decisions, [Decision::Pending, Decision::Rejected, Decision::Accepted]);
        assert_eq!((repairs.flags(Decision::Rejected).len(), repairs.list[2].start), (1, 55));
        assert!(repairs.decide(1, Decision::Accepted), "it has to be done again");
        repairs.take(&[done(0, (5, 9)), done(20, (31, 40)), done(55, (69, 80))]);
        assert_eq!((repairs.list.len(), repairs.count(Decision::Accepted)), (3, 2));
    }

    #[test]
    fn two_repairs_of_a_flag_are_decided_as_one() {
        let mut repairs = Repairs::default();
        repairs.take(&[done(20, (31, 40)), done(25, (38, 44))]);
        assert_eq!(repairs.list.len(), 1);
        assert_eq!((repairs.list[0].start, repairs.list[0].end, repairs.list[0].answers.len()), (20, 55, 2));
        assert!(!repairs.decide(7, Decision::Accepted));
    }
}

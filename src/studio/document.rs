//! What the studio edits: a rig and a scenario. Plain, compared and cloned; changed by one `apply` and nothing else.
//!
//! Panels read it and give [`Edit`]s. Times s, angles rad, forces N, scenario space.

use crate::model::Role;
use crate::model::Scenario;
use crate::model::scenario::{
    Base, Carry, Character, Crouch, Direction, Feet, Ground, Marker, Push, Stand, Stepper, Throw, Turn, Walk,
};
use crate::model::sweep::BakeSettings;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The document.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The rig's file, or `builtin`.
    pub rig: PathBuf,
    /// Which node is which bone, beyond what the rig and its override file say; `None` takes a bone away.
    pub bones: BTreeMap<Role, Option<usize>>,
    /// What happens.
    pub scenario: Scenario,
    /// How it is baked; not a part of the scenario's file.
    pub bake: BakeSettings,
}

/// A lane of the timeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "the lanes of a scenario")]
pub enum Lane {
    Walk,
    Turn,
    Crouch,
    Stand,
    Push,
    Pull,
    Throw,
    Carry,
}

/// An entry of a lane.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the lanes of a scenario")]
pub enum Entry {
    Walk(Walk),
    Turn(Turn),
    Crouch(Crouch),
    Stand(Stand),
    Push(Push),
    Pull(Push),
    Throw(Throw),
    Carry(Carry),
}

/// Which entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Of that lane.
    pub lane: Lane,
    /// The number from 0.
    pub index: usize,
}

/// A change.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Another rig.
    Rig(PathBuf),
    /// Other bones.
    Bones(BTreeMap<Role, Option<usize>>),
    /// The title.
    Title(String),
    /// s.
    Duration(f64),
    /// The seed.
    Seed(u64),
    /// Body and dials.
    Character(Character),
    /// The ground.
    Ground(Ground),
    /// Which of the paper's variants the stepper is.
    Stepper(Stepper),
    /// The clip under the reaction.
    Base(Option<Base>),
    /// One more, at the end of its lane.
    Add(Entry),
    /// Another in its place; of the same lane.
    Replace(Place, Entry),
    /// One less.
    Remove(Place),
    /// All of it.
    Scenario(Box<Scenario>),
    /// The marks on the timeline.
    Markers(Vec<Marker>),
    /// How it is baked.
    Bake(BakeSettings),
}

impl Lane {
    /// From top to bottom.
    pub const ALL: [Lane; 8] =
        [Lane::Walk, Lane::Turn, Lane::Crouch, Lane::Stand, Lane::Push, Lane::Pull, Lane::Throw, Lane::Carry];

    /// What it is called.
    pub fn name(self) -> &'static str {
        ["Walk", "Turn", "Crouch", "Stand", "Push", "Pull", "Throw", "Carry"][self as usize]
    }

    /// What happens in it.
    pub fn hint(self) -> &'static str {
        [
            "walks at a speed and heading until the next entry; speed 0 stops",
            "turns on the spot to a facing",
            "lowers the body; 0.5 halves the legs",
            "stands on one foot or both",
            "a force for a moment, at a bone",
            "a lasting force: drags, or is dragged",
            "balls that fly at the body",
            "a box in both hands whose mass may change",
        ][self as usize]
    }

    /// A new entry that starts then, of a size that shows.
    pub fn entry(self, start: f64) -> Entry {
        match self {
            Lane::Walk => Entry::Walk(Walk { start, duration: None, speed: 1.2, heading: 0.0, facing: None }),
            Lane::Turn => Entry::Turn(Turn { start, duration: None, facing: std::f64::consts::FRAC_PI_2 }),
            Lane::Crouch => Entry::Crouch(Crouch { start, duration: None, amount: 0.3 }),
            Lane::Stand => Entry::Stand(Stand { start, duration: None, on: Feet::Left }),
            Lane::Push => {
                Entry::Push(Push { start, duration: 0.2, force: 250.0, toward: Direction::Right, at: Role::Chest })
            }
            Lane::Pull => {
                Entry::Pull(Push { start, duration: 2.0, force: 60.0, toward: Direction::Back, at: Role::Hips })
            }
            Lane::Throw => Entry::Throw(Throw {
                start,
                count: 3,
                interval: 0.3,
                radius: [0.08, 0.2],
                density: 50.0,
                speed: 9.0,
                from: Direction::Front,
                at: Role::Chest,
                spread: 0.2,
            }),
            Lane::Carry => Entry::Carry(Carry {
                start,
                end: None,
                mass: vec![[start, 5.0]],
                size: vec![(start, glam::DVec3::new(0.4, 0.3, 0.3))],
            }),
        }
    }
}

impl Entry {
    /// Its lane.
    pub fn lane(&self) -> Lane {
        match self {
            Entry::Walk(_) => Lane::Walk,
            Entry::Turn(_) => Lane::Turn,
            Entry::Crouch(_) => Lane::Crouch,
            Entry::Stand(_) => Lane::Stand,
            Entry::Push(_) => Lane::Push,
            Entry::Pull(_) => Lane::Pull,
            Entry::Throw(_) => Lane::Throw,
            Entry::Carry(_) => Lane::Carry,
        }
    }

    /// s, when it starts.
    pub fn start(&self) -> f64 {
        match self {
            Entry::Walk(walk) => walk.start,
            Entry::Turn(turn) => turn.start,
            Entry::Crouch(crouch) => crouch.start,
            Entry::Stand(stand) => stand.start,
            Entry::Push(push) | Entry::Pull(push) => push.start,
            Entry::Throw(throw) => throw.start,
            Entry::Carry(carry) => carry.start,
        }
    }

    /// s, when it ends, where it says so.
    pub fn end(&self) -> Option<f64> {
        match self {
            Entry::Walk(walk) => walk.duration.map(|duration| walk.start + duration),
            Entry::Turn(turn) => turn.duration.map(|duration| turn.start + duration),
            Entry::Crouch(crouch) => crouch.duration.map(|duration| crouch.start + duration),
            Entry::Stand(stand) => stand.duration.map(|duration| stand.start + duration),
            Entry::Push(push) | Entry::Pull(push) => Some(push.end()),
            Entry::Throw(throw) => Some(throw.start + throw.interval * f64::from(throw.count)),
            Entry::Carry(carry) => carry.end,
        }
    }

    /// The same, moved to start then; the length stays.
    pub fn moved(&self, to: f64) -> Entry {
        let mut moved = self.clone();
        let by = to - self.start();
        match &mut moved {
            Entry::Walk(walk) => walk.start = to,
            Entry::Turn(turn) => turn.start = to,
            Entry::Crouch(crouch) => crouch.start = to,
            Entry::Stand(stand) => stand.start = to,
            Entry::Push(push) | Entry::Pull(push) => push.start = to,
            Entry::Throw(throw) => throw.start = to,
            Entry::Carry(carry) => {
                carry.start = to;
                carry.end = carry.end.map(|end| end + by);
                carry.mass.iter_mut().for_each(|point| point[0] += by);
                carry.size.iter_mut().for_each(|point| point.0 = (point.0 + by).max(0.0));
            }
        }
        moved
    }

    /// The same, ending then; at least a tick long. Balls keep their interval and change their number.
    pub fn stretched(&self, end: f64) -> Entry {
        let mut stretched = self.clone();
        let length = (end - self.start()).max(0.01);
        match &mut stretched {
            Entry::Walk(walk) => walk.duration = Some(length),
            Entry::Turn(turn) => turn.duration = Some(length),
            Entry::Crouch(crouch) => crouch.duration = Some(length),
            Entry::Stand(stand) => stand.duration = Some(length),
            Entry::Push(push) | Entry::Pull(push) => push.duration = length,
            Entry::Throw(throw) => throw.count = ((length / throw.interval.max(0.01)).round() as u32).max(1),
            Entry::Carry(carry) => carry.end = Some(carry.start + length),
        }
        stretched
    }
}

impl Document {
    /// The built-in rig, shoved from the left.
    pub fn demo() -> Document {
        Document::of(PathBuf::from("builtin"), Scenario::demo())
    }

    /// A scenario on a rig, baked as the command line would without flags.
    pub fn of(rig: PathBuf, scenario: Scenario) -> Document {
        Document { rig, bones: BTreeMap::new(), scenario, bake: BakeSettings::default() }
    }

    /// Entries of a lane.
    pub fn entries(&self, lane: Lane) -> Vec<Entry> {
        let scenario = &self.scenario;
        match lane {
            Lane::Walk => scenario.walk.iter().copied().map(Entry::Walk).collect(),
            Lane::Turn => scenario.turn.iter().copied().map(Entry::Turn).collect(),
            Lane::Crouch => scenario.crouch.iter().copied().map(Entry::Crouch).collect(),
            Lane::Stand => scenario.stand.iter().copied().map(Entry::Stand).collect(),
            Lane::Push => scenario.push.iter().copied().map(Entry::Push).collect(),
            Lane::Pull => scenario.pull.iter().copied().map(Entry::Pull).collect(),
            Lane::Throw => scenario.throw.iter().copied().map(Entry::Throw).collect(),
            Lane::Carry => scenario.carry.iter().cloned().map(Entry::Carry).collect(),
        }
    }

    /// One of them.
    pub fn entry(&self, place: Place) -> Option<Entry> {
        self.entries(place.lane).into_iter().nth(place.index)
    }

    /// Changes it. An edit of an entry that is not there, or into another lane, changes nothing.
    pub fn apply(&mut self, edit: Edit) {
        match edit {
            Edit::Rig(rig) => {
                self.rig = rig;
                self.bones.clear();
            }
            Edit::Bones(bones) => self.bones = bones,
            Edit::Title(title) => self.scenario.title = title,
            Edit::Duration(duration) => self.scenario.duration = duration,
            Edit::Seed(seed) => self.scenario.seed = seed,
            Edit::Character(character) => self.scenario.character = character,
            Edit::Ground(ground) => self.scenario.ground = ground,
            Edit::Stepper(stepper) => self.scenario.stepper = stepper,
            Edit::Base(base) => self.scenario.base = base,
            Edit::Scenario(scenario) => self.scenario = *scenario,
            Edit::Markers(markers) => self.scenario.marker = markers,
            Edit::Bake(bake) => self.bake = bake,
            Edit::Add(entry) => {
                let lane = entry.lane();
                let mut entries = self.entries(lane);
                entries.push(entry);
                self.set(lane, entries);
            }
            Edit::Replace(place, entry) => {
                let mut entries = self.entries(place.lane);
                if let Some(slot) = entries.get_mut(place.index).filter(|_| entry.lane() == place.lane) {
                    *slot = entry;
                    self.set(place.lane, entries);
                }
            }
            Edit::Remove(place) => {
                let mut entries = self.entries(place.lane);
                if place.index < entries.len() {
                    entries.remove(place.index);
                    self.set(place.lane, entries);
                }
            }
        }
    }

    fn set(&mut self, lane: Lane, entries: Vec<Entry>) {
        let scenario = &mut self.scenario;
        match lane {
            Lane::Walk => scenario.walk.clear(),
            Lane::Turn => scenario.turn.clear(),
            Lane::Crouch => scenario.crouch.clear(),
            Lane::Stand => scenario.stand.clear(),
            Lane::Push => scenario.push.clear(),
            Lane::Pull => scenario.pull.clear(),
            Lane::Throw => scenario.throw.clear(),
            Lane::Carry => scenario.carry.clear(),
        }
        for entry in entries {
            match entry {
                Entry::Walk(walk) => scenario.walk.push(walk),
                Entry::Turn(turn) => scenario.turn.push(turn),
                Entry::Crouch(crouch) => scenario.crouch.push(crouch),
                Entry::Stand(stand) => scenario.stand.push(stand),
                Entry::Push(push) => scenario.push.push(push),
                Entry::Pull(pull) => scenario.pull.push(pull),
                Entry::Throw(throw) => scenario.throw.push(throw),
                Entry::Carry(carry) => scenario.carry.push(carry),
            }
        }
    }
}

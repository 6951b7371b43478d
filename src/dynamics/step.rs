//! A tick of a tree and of the loose bodies beside it, in equal parts: semi-implicit Euler with the joints' springs and dampers at the end
//! of each part, contacts and limits by impulses, and no joint above its torque.

use super::contacts::{Met, Touch, Weld};
use super::factor::Vector;
use super::inertia::Held;
use super::loose::Loose;
use super::state::Articulation;
use super::tree::MOST;

/// How often a part of a tick is taken again because a joint would give more than it can.
const AGAIN: usize = 4;

/// Lists what may be touched, given the tree, the loose bodies and the share of the tick that has passed.
pub type Find<'a> = &'a mut dyn FnMut(&Articulation, &[Loose], f64, &mut Vec<Touch>);

/// What a tick needs beside the tree, kept from tick to tick.
#[derive(Clone, Debug, Default)]
pub struct Around {
    /// Bodies beside the tree.
    pub loose: Vec<Loose>,
    /// Those of them that are fixed to links.
    pub welds: Vec<Weld>,
    /// What was given at contacts in the last tick, part by part.
    pub met: Vec<Met>,
    touches: Vec<Touch>,
    kept: Vec<(usize, usize)>,
    before: Vec<Loose>,
}

impl Around {
    /// With these bodies, some of them fixed to links.
    pub fn with(loose: Vec<Loose>, welds: Vec<Weld>) -> Around {
        Around { loose, welds, ..Around::default() }
    }
}

impl Articulation {
    /// A tick of `dt` s in that many parts. `find` lists, for the part that begins `share` of the tick in, what may be touched.
    pub fn step(&mut self, around: &mut Around, dt: f64, parts: usize, find: Find) {
        let parts = parts.max(1);
        let part = dt / parts as f64;
        self.drive.given = [0.0; MOST];
        around.met.clear();
        for index in 0..parts {
            around.touches.clear();
            let mut touches = std::mem::take(&mut around.touches);
            find(self, &around.loose, index as f64 / parts as f64, &mut touches);
            around.touches = touches;
            self.part(around, part, 1.0 / parts as f64);
        }
    }

    fn part(&mut self, around: &mut Around, dt: f64, share: f64) {
        let mut held = Held { joints: 0, torque: [0.0; MOST] };
        around.before.clear();
        around.before.extend_from_slice(&around.loose);
        for again in 0..=AGAIN {
            around.loose.copy_from_slice(&around.before);
            let next = self.speeds(around, dt, &held);
            let torque = self.torques(&next, dt, &held);
            if again < AGAIN && self.hold_strained(&torque, &mut held) {
                continue;
            }
            self.speed = next;
            for (given, torque) in self.drive.given.iter_mut().zip(&torque) {
                *given += share * torque;
            }
            break;
        }
        self.collect(&around.touches, &around.kept, &mut around.met);
        self.travel(dt);
        around.loose.iter_mut().for_each(|body| body.travel(dt));
    }

    /// The speeds at the end of a part.
    fn speeds(&mut self, around: &mut Around, dt: f64, held: &Held) -> Vector {
        let mut next = self.assemble(dt, held);
        next.iter_mut().zip(&self.speed).for_each(|(next, speed)| *next += speed);
        around.loose.iter_mut().for_each(|body| body.fall(dt));
        self.rows.clear();
        self.add_limits(&next, dt);
        self.add_contacts(&around.touches, &around.loose, (&next, dt), &mut around.kept);
        self.add_welds(&around.welds, &around.loose, (&next, dt));
        self.rows.solve(&self.tree, &self.factors, &mut next, &mut around.loose);
        next
    }

    /// N m, what the drives give where the speeds at the end are those.
    fn torques(&self, next: &Vector, dt: f64, held: &Held) -> Vector {
        let mut torque = [0.0; MOST];
        for link in 1..self.tree.links.len() {
            for way in self.tree.freedoms_of(link) {
                let drive = &self.drive;
                torque[way] = match held.joints & (1 << link) {
                    0 => drive.stiffness[way] * (drive.ahead[way] - dt * next[way]) - drive.damping[way] * next[way],
                    _ => held.torque[way],
                };
            }
        }
        torque
    }

    /// Holds joints that would give more than they can at what they can; whether there are any that were not held.
    fn hold_strained(&self, torque: &Vector, held: &mut Held) -> bool {
        let mut strained = false;
        for link in 1..self.tree.links.len() {
            if held.joints & (1 << link) != 0 {
                continue;
            }
            let size = self.tree.freedoms_of(link).map(|way| torque[way].powi(2)).sum::<f64>().sqrt();
            if size > self.drive.most {
                held.joints |= 1 << link;
                for way in self.tree.freedoms_of(link) {
                    held.torque[way] = torque[way] * (self.drive.most / size);
                }
                strained = true;
            }
        }
        strained
    }
}

//! What the links of a figure weigh and fill: masses and inertias from the body's segments, boxes from its mesh, and what each joint
//! carries. Metres, kilograms, a link's own frame.

use super::figure::{Figure, Freedom, Maker, Part};
use crate::maths::real;
use crate::model::Side;
use glam::{DMat3, DQuat, DVec3};

/// Share of the height by which a pelvis reaches under its centre of mass.
const UNDER_CENTRE: f64 = 0.10;

impl Maker<'_> {
    /// Masses and inertias of the segments that move with each link.
    pub(super) fn gather_masses(&mut self, link_of: &[usize]) {
        let mut moments = vec![DVec3::ZERO; self.links.len()];
        let mut parts = vec![Vec::new(); self.links.len()];
        for segment in &self.body.segments {
            let link = link_of[segment.joint];
            let turn = self.stand.turns[segment.joint];
            let centre = self.positions[segment.joint] + turn * segment.centre - self.positions[self.joints[link]];
            let matrix = DMat3::from_quat(turn);
            self.links[link].mass += segment.mass;
            moments[link] += segment.mass * centre;
            parts[link].push((segment.mass, centre, matrix * segment.inertia * matrix.transpose()));
        }
        for (index, link) in self.links.iter_mut().enumerate() {
            // A body whose hand has no segment of its own still needs a little of it, or its joint has nothing to turn.
            if link.mass <= 0.0 {
                link.mass = 1e-3 * self.body.mass;
                parts[index].push((link.mass, DVec3::ZERO, DMat3::IDENTITY * (link.mass * 1e-3)));
            }
            link.centre = moments[index] / link.mass;
            for (mass, centre, inertia) in &parts[index] {
                link.inertia += *inertia + steiner(*mass, *centre - link.centre);
            }
        }
    }

    /// Boxes from the mesh; where it shows none, from the reach of the links and their masses at the density of flesh. Feet
    /// from their soles.
    pub(super) fn shape(&mut self, link_of: &[usize]) {
        for index in 0..self.links.len() {
            let origin = self.positions[self.joints[index]];
            let inside: Vec<DVec3> = (0..self.body.joints.len())
                .filter(|joint| {
                    let own = link_of[*joint] == index && !self.is_finger(*joint);
                    let hung = self
                        .joints
                        .iter()
                        .position(|own| own == joint)
                        .is_some_and(|other| self.links[other].parent == Some(index));
                    own || hung
                })
                .map(|joint| self.positions[joint] - origin)
                .collect();
            let last = !self.links.iter().any(|link| link.parent == Some(index));
            let link = &mut self.links[index];
            // The last of a limb reaches beyond its joints.
            let beyond = if last { link.centre * 1.8 } else { link.centre };
            let (mut low, mut high) = (beyond.min(link.centre), beyond.max(link.centre));
            for point in &inside {
                (low, high) = (low.min(*point), high.max(*point));
            }
            if link.part == Part::Pelvis {
                // Some rigs have their hips bone on the ground, between the feet.
                low.y = low.y.max(link.centre.y - UNDER_CENTRE * self.body.height);
            }
            let volume = link.mass / 1000.0;
            let long = (high - low).max_element().max(0.5 * real::cbrt(volume));
            let side = (volume / long).sqrt();
            let half = (0.5 * (high - low)).max(DVec3::splat(0.5 * side));
            link.half = half;
            link.middle = 0.5 * (low + high);
        }
        for flesh in &self.body.flesh {
            // A link that has swallowed another (a locked hand) keeps the box around both.
            let alone = |link: usize| self.body.flesh.iter().filter(|other| link_of[other.joint] == link).count() == 1;
            let link = link_of[flesh.joint];
            if self.joints[link] == flesh.joint && alone(link) {
                let turn = self.stand.turns[flesh.joint];
                let link = &mut self.links[link];
                (link.half, link.middle, link.turn) = (flesh.half, turn * flesh.middle, turn * flesh.turn);
            }
        }
        for side in Side::BOTH {
            let foot = self.links.iter().position(|link| link.part == Part::Foot(side)).unwrap_or(0);
            let shape = &self.body.feet[side as usize];
            let ahead = self.stand.turns[shape.ankle]
                * shape.level.inverse()
                * DVec3::new(shape.forward.x, 0.0, shape.forward.y);
            let turn = DQuat::from_rotation_y(real::atan2(ahead.x, ahead.z));
            let height = (0.9 * shape.ankle_height).max(0.02 * self.body.height);
            let link = &mut self.links[foot];
            link.turn = turn;
            link.half = DVec3::new(shape.half_width, 0.5 * height, 0.5 * (shape.foremost() - shape.heel));
            let middle = DVec3::new(0.0, 0.5 * height - shape.ankle_height, 0.5 * (shape.foremost() + shape.heel));
            link.middle = turn * middle;
        }
    }

    fn is_finger(&self, joint: usize) -> bool {
        let name = self.body.joints[joint].role.name();
        ["Thumb", "Index", "Middle", "Ring", "Little", "Eye", "jaw"].iter().any(|part| name.contains(part))
    }

    /// What each joint carries.
    pub(super) fn carry(&mut self) {
        for index in 0..self.links.len() {
            let origin = self.positions[self.joints[index]];
            let mut total = DMat3::ZERO;
            for (other, link) in self.links.iter().enumerate() {
                let mut at = Some(other);
                while at.is_some_and(|at| at != index) {
                    at = at.and_then(|at| self.links[at].parent);
                }
                if at == Some(index) {
                    total +=
                        link.inertia + steiner(link.mass, self.positions[self.joints[other]] + link.centre - origin);
                }
            }
            let carried = match self.links[index].freedom {
                Freedom::Hinge { axis, .. } => axis.dot(total * axis),
                _ => (total.x_axis.x + total.y_axis.y + total.z_axis.z) / 3.0,
            };
            self.links[index].carried = carried;
        }
    }
}

/// Half sides and middle of a link's box. A pelvis whose joint is far below the hips (a root on the floor) reaches down to
/// under the hips only: it would scrape along the ground.
pub(super) fn above_legs(figure: &Figure, index: usize) -> (DVec3, DVec3) {
    let link = &figure.links[index];
    let (mut half, mut middle) = (link.half, link.middle);
    if index == 0 {
        let hips = figure.legs.map(|leg| figure.links[leg[0]].anchor.y);
        let (low, high) = (middle.y - half.y, middle.y + half.y);
        let least = (hips[0].min(hips[1]) - 0.2 * figure.leg_length).min(high - 0.1 * figure.leg_length);
        if low < least {
            (half.y, middle.y) = (0.5 * (high - least), 0.5 * (high + least));
        }
    }
    (half, middle)
}

/// kg m², of a point mass at an offset.
pub fn steiner(mass: f64, offset: DVec3) -> DMat3 {
    let outer = DMat3::from_cols(offset * offset.x, offset * offset.y, offset * offset.z);
    (DMat3::IDENTITY * offset.length_squared() - outer) * mass
}

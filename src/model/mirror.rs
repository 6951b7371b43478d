//! A body's and a scenario's mirror image in the plane x = 0, and to which side a scenario goes. Scenario space, SI.

use super::body::{Body, BodyJoint, Flesh, FootShape, Segment, Side};
use super::pose::BodyPose;
use super::role::Role;
use super::scenario::{Direction, Feet, GroundKind, Push, Scenario, Stand, Throw, Turn, Walk};
use crate::maths::mirror;
use crate::maths::quat::wrap_angle;
use crate::maths::real;
use glam::DVec3;

/// Share of the height by which a rig that is its own mirror image may be off it: what its file and its makers round (0.2 mm for 1.7 m).
const ALIKE: f64 = 1.2e-4;
/// Of a unit vector or rad: what goes less to a side goes to none.
const ASIDE: f64 = 1e-9;

impl Body {
    /// Its mirror image, and for each of the joints which of the image's is its own image. Where both sides have the same joints, each
    /// takes its twin's place in the list: a body that is the same on both sides is its own image.
    pub fn mirrored(&self) -> (Body, Vec<usize>) {
        let twins = self.twins();
        let mut joints = self.joints.clone();
        for (joint, twin) in self.joints.iter().zip(&twins) {
            joints[*twin] = BodyJoint {
                role: joint.role.mirrored(),
                parent: joint.parent.map(|parent| twins[parent]),
                rest: mirror::point(joint.rest),
                animated: joint.animated,
            };
        }
        let segment = |segment: &Segment| Segment {
            joint: twins[segment.joint],
            mass: segment.mass,
            centre: mirror::point(segment.centre),
            inertia: mirror::tensor(segment.inertia),
        };
        let flesh = |flesh: &Flesh| Flesh {
            joint: twins[flesh.joint],
            middle: mirror::point(flesh.middle),
            half: flesh.half,
            turn: mirror::turn(flesh.turn),
        };
        let [left, right] = self.feet.each_ref().map(|foot| foot.mirrored(&twins));
        let body = Body {
            joints,
            segments: paired(&self.segments, &|segment| segment.joint, &twins, &segment),
            feet: [right, left],
            flanks: [self.flanks[1], self.flanks[0]],
            flesh: paired(&self.flesh, &|flesh| flesh.joint, &twins, &flesh),
            ..*self
        };
        (body, twins)
    }

    /// For each joint its twin on the other side; a joint without one is its own. If the list then held a child before its parent, every
    /// joint is its own.
    fn twins(&self) -> Vec<usize> {
        let twin = |(index, joint): (usize, &BodyJoint)| self.joint(joint.role.mirrored()).unwrap_or(index);
        let twins: Vec<usize> = self.joints.iter().enumerate().map(twin).collect();
        let in_order = |(index, joint): (usize, &BodyJoint)| joint.parent.is_none_or(|up| twins[up] < twins[index]);
        let ordered = self.joints.iter().enumerate().all(in_order);
        if ordered { twins } else { (0..self.joints.len()).collect() }
    }

    /// Whether it is the other one but for what a file and its makers round.
    pub fn is_alike(&self, other: &Body) -> bool {
        let most = ALIKE * self.height;
        let joint = |(a, b): (&BodyJoint, &BodyJoint)| {
            (a.role, a.parent, a.animated) == (b.role, b.parent, b.animated) && a.rest.distance(b.rest) < most
        };
        let segment = |(a, b): (&Segment, &Segment)| {
            a.joint == b.joint && (a.mass - b.mass).abs() < ALIKE * self.mass && a.centre.distance(b.centre) < most
        };
        let as_many = (self.joints.len(), self.segments.len()) == (other.joints.len(), other.segments.len());
        as_many
            && self.joints.iter().zip(&other.joints).all(joint)
            && self.segments.iter().zip(&other.segments).all(segment)
            && self.feet.iter().zip(&other.feet).all(|(a, b)| a.is_alike(b, most))
    }
}

/// Which side a role is of.
fn side_of(role: Role) -> Option<Side> {
    let name = role.name();
    let side = |side: Side, word: &str| name.starts_with(word).then_some(side);
    side(Side::Left, "left").or(side(Side::Right, "right"))
}

impl FootShape {
    fn mirrored(&self, twins: &[usize]) -> FootShape {
        let sole = |points: &[DVec3]| points.iter().copied().map(mirror::point).collect();
        FootShape {
            ankle: twins[self.ankle],
            toe: self.toe.map(|toe| twins[toe]),
            level: mirror::turn(self.level),
            toe_level: mirror::turn(self.toe_level),
            forward: mirror::ground(self.forward),
            rear_sole: sole(&self.rear_sole),
            front_sole: sole(&self.front_sole),
            ..*self
        }
    }

    fn is_alike(&self, other: &FootShape, most: f64) -> bool {
        let lengths = |foot: &FootShape| [foot.ankle_height, foot.heel, foot.ball, foot.tip, foot.half_width];
        let near = lengths(self).iter().zip(lengths(other)).all(|(a, b)| (a - b).abs() < most);
        // A turn counts by what it does at the toes.
        let turned = |a: glam::DQuat, b: glam::DQuat| a.angle_between(b) * self.tip.abs() < most;
        let turns = turned(self.level, other.level) && turned(self.toe_level, other.toe_level);
        near && turns && (self.forward - other.forward).length() * self.tip.abs() < most
    }
}

/// The images of what hangs on joints, each in the place of its twin where all have one.
fn paired<T>(items: &[T], joint: &dyn Fn(&T) -> usize, twins: &[usize], image: &dyn Fn(&T) -> T) -> Vec<T> {
    let twin = |index: usize| {
        let own = joint(&items[index]);
        let before = items[..index].iter().filter(|item| joint(item) == own).count();
        items.iter().filter(|item| joint(item) == twins[own]).nth(before)
    };
    let pairs: Option<Vec<&T>> = (0..items.len()).map(twin).collect();
    pairs.unwrap_or_else(|| items.iter().collect()).into_iter().map(image).collect()
}

impl BodyPose {
    /// Its mirror image on the mirrored body; `twins` as of [`Body::mirrored`].
    pub fn mirrored(&self, twins: &[usize]) -> BodyPose {
        let turns = twins.iter().map(|twin| mirror::turn(self.turns[*twin])).collect();
        BodyPose { hips: mirror::point(self.hips), turns }
    }
}

impl Scenario {
    /// The scenario as it is played, so that it and its mirror image come out of the very same numbers: as it is or, if what first goes to
    /// a side goes to the right, its mirror image (then true). Headings are rounded to a billionth: 330 degrees are -30.
    pub fn to_the_left(&self) -> (Scenario, bool) {
        let mut own = self.clone();
        let mirrored = self.side() == Some(Side::Right);
        if mirrored {
            own.mirror();
        }
        own.round();
        (own, mirrored)
    }

    /// To which side the first thing goes that is not its own mirror image; none on ground that has no mirror image.
    pub fn side(&self) -> Option<Side> {
        if matches!(self.ground.kind, GroundKind::Uneven { .. } | GroundKind::Mesh { .. }) {
            return None;
        }
        let lateral = |toward: Direction, at: Role| match toward.unit(0.0).x {
            x if x.abs() > ASIDE => x,
            _ => side_of(at).map_or(0.0, Side::sign),
        };
        let heading = |walk: &Walk| if walk.speed == 0.0 { 0.0 } else { real::sin(walk.heading) };
        let facing = |walk: &Walk| walk.facing.map_or(0.0, real::sin);
        let on = |stand: &Stand| match stand.on {
            Feet::Both => 0.0,
            Feet::Left => 1.0,
            Feet::Right => -1.0,
        };
        let first = (self.push.iter().chain(&self.pull).map(|push| (push.start, lateral(push.toward, push.at))))
            .chain(self.throw.iter().map(|throw| (throw.start, lateral(throw.from, throw.at))))
            .chain(self.walk.iter().flat_map(|walk| [(walk.start, heading(walk)), (walk.start, facing(walk))]))
            .chain(self.turn.iter().map(|turn| (turn.start, real::sin(turn.facing))))
            .chain(self.stand.iter().map(|stand| (stand.start, on(stand))))
            .chain(self.rolls())
            .filter(|(_, side)| side.abs() > ASIDE)
            .min_by(|a, b| a.0.total_cmp(&b.0));
        first.map(|(_, side)| if side > 0.0 { Side::Left } else { Side::Right })
    }

    /// When a platform begins to roll (s), and which way.
    fn rolls(&self) -> Option<(f64, f64)> {
        let GroundKind::Platform { roll, .. } = &self.ground.kind else { return None };
        let first = roll.iter().position(|[_, angle]| angle.abs() > ASIDE)?;
        Some((first.checked_sub(1).map_or(0.0, |before| roll[before][0]), roll[first][1]))
    }

    fn mirror(&mut self) {
        let flip = |angle: &mut f64| *angle = mirror::flipped(*angle);
        for Push { toward, at, .. } in self.push.iter_mut().chain(&mut self.pull) {
            (*toward, *at) = (toward.mirrored(), at.mirrored());
        }
        for Throw { from, at, .. } in &mut self.throw {
            (*from, *at) = (from.mirrored(), at.mirrored());
        }
        for Walk { heading, facing, .. } in &mut self.walk {
            flip(heading);
            facing.iter_mut().for_each(flip);
        }
        self.turn.iter_mut().for_each(|Turn { facing, .. }| flip(facing));
        for Stand { on, .. } in &mut self.stand {
            *on = match on {
                Feet::Both => Feet::Both,
                Feet::Left => Feet::Right,
                Feet::Right => Feet::Left,
            };
        }
        if let GroundKind::Platform { roll, .. } = &mut self.ground.kind {
            roll.iter_mut().for_each(|[_, angle]| flip(angle));
        }
    }

    fn round(&mut self) {
        let round = |angle: &mut f64| *angle = (wrap_angle(*angle) / ASIDE).round() * ASIDE;
        let pushed = self.push.iter_mut().chain(&mut self.pull).map(|push| &mut push.toward);
        for direction in pushed.chain(self.throw.iter_mut().map(|throw| &mut throw.from)) {
            if let Direction::Heading(angle) = direction {
                round(angle);
            }
        }
        for walk in &mut self.walk {
            round(&mut walk.heading);
            walk.facing.iter_mut().for_each(round);
        }
    }
}

impl Direction {
    fn mirrored(self) -> Direction {
        match self {
            Direction::Front | Direction::Back => self,
            Direction::Left => Direction::Right,
            Direction::Right => Direction::Left,
            Direction::Heading(angle) => Direction::Heading(mirror::flipped(angle)),
            Direction::Vector(vector) => Direction::Vector(mirror::point(vector)),
        }
    }
}

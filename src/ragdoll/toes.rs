//! The toes of a foot as a link of their own: where a foot bends, what of it is toes, and what their joint gives.
//!
//! Metres, kilograms, scenario axes as of the figure. All toes are one box from the joint at their root (metatarsophalangeal) to the tip,
//! on a hinge across the foot: a heel that rises turns about that joint, and the ball of the foot stays where it is. What bears at the ball is
//! the toes' box, for their joint is over it: a sole's edge before the joint would move on along the ground as the heel rises. A foot whose rig
//! has no such joint, or has it where no foot bends, stays one box.

use super::bulk::steiner;
use super::figure::{Figure, Freedom, Link, Part};
use super::forces::{Corner, Forces};
use super::sole::{BALL, POINTS, TIP};
use super::world::{LinkState, World};
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::model::{Body, Role, Side};
use glam::{DMat3, DQuat, DVec3};

/// rad, least and most extension of the toes from flat: people's go up to 60 to 70 degrees (AAOS: 70; a walk takes 40 to 60), and they are
/// measured by 60 (`measure::joints`), a degree of which is for what a clip is beside its run. Down by less than people's: a figure does not grasp.
const RANGE: [f64; 2] = [-0.35, 1.03];
/// N m/rad and N m s/rad of a foot's toe joint, at 75 kg and legs of 0.83 m: what walks of people were simulated with (Falisse, Afschrift
/// and De Groote 2022, PLoS ONE 17: e0256311; Sasaki, Neptune and Kautz 2009 take the same spring).
const SPRING: [f64; 2] = [25.0, 2.0];
/// The toes' share of the foot's mass, of their share of its length: 0.22 of 1.57 kg over a quarter of the length (Delp et al. 1990, as
/// gait2392 of OpenSim has it).
const THIN: f64 = 0.55;
/// Shares of the sole's length: from the heel to the toe joint at least, of a foot and of one that is `LONG` for its leg, and from there to the
/// tip. People's is at 0.7, that of shod figures at 0.5 to 0.6; boots as long as their leg, as toy figures have them, do not roll over it.
const BEHIND: [f64; 2] = [0.5, 0.6];
const AHEAD: f64 = 0.08;
/// Share of the leg's length. People's soles are 0.3 to 0.36.
const LONG: f64 = 0.5;
/// Share of the ankle's height: higher over the sole than that there is no toe joint. It is at 0.15 to 0.33 on rigs with feet; about a
/// hinge as high as 0.7 of it, which a foot without a mesh had, the sole's two parts come apart as it bends, and one goes 5 cm into the ground.
const HIGH: f64 = 0.5;
/// Share of a foot's inertia about any axis that is left to it without its toes, at least.
const LEFT: f64 = 0.2;
/// Share of what toes could be spared under a flat foot that they are spared: the ball bears it instead of the tip.
const SPARED: f64 = 0.5;
/// Shares of a swing from which and by which toes are bent up as far as their foot points down, as people's are before they land on them: else
/// they stay behind where they touch, and snap level in one frame.
const LEVELS: [f64; 2] = [0.3, 0.6];

/// How a foot bends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend {
    pub(super) role: Role,
    pub(super) freedom: Freedom,
    ahead: DVec3,
    aside: f64,      // m, to the left of the ankle
    over: f64,       // m, over the sole
    span: [f64; 3],  // m, ahead of the ankle: heel, joint, tip
    half_width: f64, // m
    weighed: bool,   // the toes have a mass of their own
}

/// The toes' links of both feet, and how these bend.
pub(super) type Bends = [Option<(usize, Bend)>; 2];

/// Where the foot of a body that stands so bends, if it does.
pub(super) fn bend(body: &Body, positions: &[DVec3], turns: &[DQuat], side: Side) -> Option<Bend> {
    let shape = &body.feet[side as usize];
    let joint = shape.toe?;
    let own = &body.joints[joint];
    if !own.animated || own.parent != Some(shape.ankle) || body.joint(own.role) != Some(joint) {
        return None;
    }
    let turn = turns[shape.ankle] * shape.level.inverse();
    let ahead = turn * DVec3::new(shape.forward.x, 0.0, shape.forward.y);
    let ahead = DVec3::new(ahead.x, 0.0, ahead.z).normalize_or_zero();
    let at = positions[joint] - positions[shape.ankle];
    let span = [shape.heel, at.dot(ahead), shape.foremost()];
    let (aside, over) = (at.dot(DVec3::Y.cross(ahead)), at.y + shape.ankle_height);
    let long = span[2] - span[0];
    let behind = BEHIND[usize::from(long > LONG * body.leg_length)];
    let along = span[1] > span[0] + behind * long && span[2] > span[1] + AHEAD * long;
    let within = aside.abs() < shape.half_width && (0.0..HIGH * shape.ankle_height).contains(&over);
    let axis = ahead.cross(DVec3::Y);
    let freedom = Freedom::Hinge { axis, range: RANGE };
    let weighed = body.segments.iter().any(|segment| segment.joint == joint && segment.mass > 0.0);
    let bend = Bend { role: own.role, freedom, ahead, aside, over, span, half_width: shape.half_width, weighed };
    (along && within && long.is_finite() && axis.length() > 0.5).then_some(bend)
}

/// Takes the toes from the feet.
pub(super) fn divide(links: &mut [Link], legs: &[[usize; 3]; 2], bends: &Bends) {
    for (bend, [.., foot]) in bends.iter().zip(legs) {
        if let Some((toes, bend)) = bend
            && let Ok([foot, toes]) = links.get_disjoint_mut([*foot, *toes])
        {
            take(bend, foot, toes);
        }
    }
}

/// Takes the toes from a foot: its box ends at their joint, theirs begins there.
fn take(bend: &Bend, foot: &mut Link, toes: &mut Link) {
    let [heel, joint, tip] = bend.span;
    let long = tip - joint;
    foot.half.z = 0.5 * (joint - heel);
    foot.middle -= bend.ahead * (0.5 * long);
    let high = (2.0 * bend.over).clamp(0.5 * foot.half.y, 2.0 * foot.half.y);
    toes.turn = foot.turn;
    toes.half = DVec3::new(bend.half_width, 0.5 * high, 0.5 * long);
    let left = DVec3::Y.cross(bend.ahead);
    toes.middle = bend.ahead * (0.5 * long) + DVec3::Y * (0.5 * high - bend.over) - left * bend.aside;
    if bend.weighed {
        return;
    }
    // As much as leaves the foot an inertia.
    let mut share = (THIN * long / (tip - heel)).clamp(0.04, 0.3);
    let (mass, centre, inertia) = (foot.mass, foot.centre, foot.inertia);
    let turn = DMat3::from_quat(toes.turn);
    let square = 4.0 * toes.half * toes.half;
    let own = DVec3::new(square.y + square.z, square.z + square.x, square.x + square.y) / 12.0;
    for _ in 0..8 {
        (foot.mass, toes.mass) = (mass * (1.0 - share), mass * share);
        toes.centre = toes.middle;
        foot.centre = (centre * mass - (toes.anchor + toes.centre) * toes.mass) / foot.mass;
        toes.inertia = turn * DMat3::from_diagonal(own * toes.mass) * turn.transpose();
        let moved = steiner(foot.mass, foot.centre - centre)
            + toes.inertia
            + steiner(toes.mass, toes.anchor + toes.centre - centre);
        foot.inertia = inertia - moved;
        let least = inertia * LEFT;
        if is_positive(foot.inertia - least) {
            return;
        }
        share *= 0.5;
    }
    foot.inertia = inertia;
}

/// Whether a symmetric matrix is positive definite (Sylvester).
fn is_positive(m: DMat3) -> bool {
    let minor = m.x_axis.x * m.y_axis.y - m.x_axis.y * m.y_axis.x;
    m.x_axis.x > 0.0 && minor > 0.0 && m.determinant() > 0.0
}

impl Figure {
    /// The toes' link of a foot, if it has one, and where its joint is in the foot's frame.
    fn fore(&self, side: Side) -> Option<(usize, DVec3)> {
        self.toes[side as usize].map(|toes| (toes, self.links[toes].anchor))
    }

    /// m, in a foot's frame: the middle of its ball.
    pub(super) fn ball(&self, side: Side) -> DVec3 {
        let [_, _, left, right, ..] = self.soles[side as usize];
        0.5 * (left + right)
    }

    /// The axis about which a foot's heel rises, in its frame, pointing to the left: its toes' hinge, and across it where it has none.
    pub(super) fn heel_axis(&self, side: Side) -> DVec3 {
        match self.toes[side as usize].map(|toes| self.links[toes].freedom) {
            Some(Freedom::Hinge { axis, .. }) => axis * axis.x.signum(),
            _ => DVec3::X,
        }
    }

    /// m, how far ahead of the ankles balls are, of the foot of which it is less; none where a foot does not bend.
    pub fn balls_ahead(&self) -> Option<f64> {
        let [left, right] = Side::BOTH.map(|side| self.ball(side).with_y(0.0).length());
        self.toes.iter().all(Option::is_some).then_some(left.min(right))
    }

    /// How long a sole is, as a share of the leg's length. People's are 0.3 to 0.36.
    pub(super) fn sole_share(&self, side: Side) -> f64 {
        let [heel, .., tip, _] = self.soles[side as usize];
        heel.distance(tip) / self.leg_length
    }

    /// The link that what presses on a link counts for: toes are part of their foot.
    pub(super) fn bears(&self, link: usize) -> usize {
        match (self.links[link].part, self.links[link].parent) {
            (Part::Toes(_), Some(foot)) => foot,
            _ => link,
        }
    }

    /// m, where a corner (its number in the sole, its place in the foot's frame where the toes are flat) is: those of ball and tip go with the toes.
    pub(super) fn carried(&self, states: &[LinkState], side: Side, index: usize, corner: DVec3) -> DVec3 {
        let (link, from) = match self.fore(side) {
            Some((toes, anchor)) if index >= BALL => (toes, anchor),
            _ => (self.legs[side as usize][2], DVec3::ZERO),
        };
        states[link].origin + states[link].turn * (corner - from)
    }

    /// m, about what a foot turns that stands on that one of its corners, where it is not the corner: the toe joint.
    pub(super) fn pivot(&self, states: &[LinkState], side: Side, index: usize) -> Option<DVec3> {
        self.fore(side).filter(|_| index >= BALL).map(|(toes, _)| states[toes].origin)
    }

    /// m, the corners of a sole where the links are.
    pub fn sole_at(&self, states: &[LinkState], side: Side) -> [DVec3; POINTS] {
        let sole = &self.soles[side as usize];
        std::array::from_fn(|index| self.carried(states, side, index, sole[index]))
    }

    /// m, the corners of what of a foot is rigid, its frame: to the ball where it has toes.
    pub fn stiff_sole(&self, side: Side) -> &[DVec3] {
        let sole = &self.soles[side as usize];
        if self.fore(side).is_some() { &sole[..TIP] } else { sole }
    }

    /// m, the corners of a foot's sole that a link (the foot or its toes) has, its frame.
    pub(super) fn sole_of(&self, side: Side, link: usize) -> Vec<DVec3> {
        match self.fore(side) {
            Some((toes, anchor)) if toes == link => {
                self.soles[side as usize][BALL..].iter().map(|corner| *corner - anchor).collect()
            }
            Some(_) => self.soles[side as usize][..BALL].to_vec(),
            None => self.soles[side as usize].to_vec(),
        }
    }

    /// The left and the right side of that part, m, each from its rear to its front, in that link's frame.
    pub(super) fn sole_sides(&self, side: Side, link: usize) -> [[DVec3; 2]; 2] {
        let sole = &self.soles[side as usize];
        let (ends, anchor) = match self.fore(side) {
            Some((toes, anchor)) if toes == link => ([BALL, TIP], anchor),
            Some(_) => ([0, BALL], DVec3::ZERO),
            None => ([0, TIP], DVec3::ZERO),
        };
        [0, 1].map(|line| ends.map(|end| sole[end + line] - anchor))
    }

    /// N m/rad and N m s/rad that a toe joint gives of itself.
    pub(super) fn toe_spring(&self) -> [f64; 2] {
        let size = self.leg_length / 0.83;
        let scale = self.mass / 75.0 * size;
        [SPRING[0] * scale, SPRING[1] * scale * size.sqrt()]
    }
}

/// How far the toes of a foot that comes down with its heel high lie along the ground by a share of its swing.
pub(super) fn levels(share: f64) -> f64 {
    smooth3((share - LEVELS[0]) / (LEVELS[1] - LEVELS[0]))
}

/// What a foot's toes are to do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Asked {
    /// N m about their hinge (under 0 bends them down): of the planned forces on the foot's front corners, and of those behind.
    pub(super) about: [f64; 2],
    /// 0 in line with the foot to 1 along the ground, where that bends them up.
    pub(super) level: f64,
    /// Out of the ground on which the foot comes down.
    pub(super) up: DVec3,
}

/// N m about the hinge of a foot's toes, of the planned forces on its front corners and of those behind.
pub(super) fn asked(
    figure: &Figure,
    states: &[LinkState],
    forces: &Forces,
    corners: &[(usize, Corner)],
    side: usize,
) -> [f64; 2] {
    let Some(toes) = figure.toes[side] else { return [0.0; 2] };
    let Freedom::Hinge { axis, .. } = figure.links[toes].freedom else { return [0.0; 2] };
    let (at, axis) = (states[toes].origin, states[figure.legs[side][2]].turn * axis);
    // Corners are named so many a foot, the rear ones first.
    let about = |front: bool| {
        let which = |name: usize, corner: &Corner| corner.foot == side && (name % POINTS >= TIP) == front;
        forces.on(corners, &which, at).1.dot(axis)
    };
    [about(true), about(false)]
}

/// rad, how far toes are bent up that lie along the ground, `up` out of it, under a foot that points that way.
fn along(points: DVec3, up: DVec3) -> f64 {
    let over = points.dot(up);
    real::atan2(-over, (points - up * over).length()).clamp(0.0, RANGE[1])
}

/// The joints of the toes for the coming tick: their springs and dampers, and what they are to give beyond so that the tips bear as is
/// planned.
pub(super) fn drive(figure: &Figure, world: &mut World, states: &[LinkState], asked: &[Asked; 2]) {
    for (toes, Asked { about: [front, rear], level, up }) in figure.toes.iter().zip(asked) {
        let Some(link) = *toes else { continue };
        let Freedom::Hinge { axis, .. } = figure.links[link].freedom else { continue };
        let parent = figure.links[link].parent.unwrap_or(0);
        let angle = super::short(states[parent].turn.inverse() * states[link].turn).dot(axis);
        let [stiffness, damping] = figure.toe_spring();
        // Under a flat foot forces at heel and tip are as good as some at the ball.
        let wanted = front - SPARED * front.min(-rear).max(0.0);
        let more = (wanted - stiffness * angle.max(0.0)).max(0.0);
        let points = states[parent].turn * DVec3::Y.cross(axis);
        let raised = level * along(points, *up);
        let ahead = axis * (raised - angle - more / stiffness.max(1e-9));
        world.drive(link, DVec3::splat(stiffness), DVec3::splat(damping), ahead);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::fixture;
    use crate::model::{BodyPose, Terrain};
    use crate::ragdoll::{Controller, Locks, Tuning};

    /// The synthetic humanoid, its toes part of its feet's mass or with one of their own, and its stand with knees a little bent.
    fn humanoid(weighed: bool) -> (Body, BodyPose) {
        let mut body = fixture::body();
        if !weighed {
            let toes = body.feet.clone().map(|foot| foot.toe.expect("toes"));
            body.segments.retain(|segment| !toes.contains(&segment.joint));
            body.mass = body.segments.iter().map(|segment| segment.mass).sum();
        }
        let mut stand = BodyPose::rest(&body);
        for leg in [[Role::LeftUpperLeg, Role::LeftLowerLeg], [Role::RightUpperLeg, Role::RightLowerLeg]] {
            for (role, turn) in leg.into_iter().zip([-0.25, 0.25]) {
                stand.turns[body.joint(role).expect("a leg")] = DQuat::from_rotation_x(turn);
            }
        }
        let foot = body.feet[0].ankle;
        stand.hips.y -= stand.positions(&body)[foot].y - body.feet[0].ankle_height;
        (body, stand)
    }

    fn locked() -> Locks {
        Locks { toes: true, ..Locks::default() }
    }

    #[test]
    fn toes_take_their_mass_and_their_box_from_the_foot_and_nothing_is_lost() {
        for weighed in [false, true] {
            let (body, stand) = humanoid(weighed);
            let (whole, bent) = (Figure::new(&body, &stand, locked()), Figure::new(&body, &stand, Locks::default()));
            assert!((whole.mass - body.mass).abs() < 1e-9 && (bent.mass - body.mass).abs() < 1e-9);
            assert_eq!(bent.links.len(), whole.links.len() + 2);
            for side in Side::BOTH {
                let one = &whole.links[whole.legs[side as usize][2]];
                let foot = &bent.links[bent.legs[side as usize][2]];
                let toes = &bent.links[bent.toes[side as usize].expect("it bends")];
                assert!((0.04..0.35).contains(&(toes.mass / one.mass)), "{} of {} kg", toes.mass, one.mass);
                let (a, b) = (foot.centre, toes.anchor + toes.centre);
                assert!(((a * foot.mass + b * toes.mass) / one.mass).distance(one.centre) < 1e-9);
                let sum = foot.inertia
                    + toes.inertia
                    + steiner(foot.mass, a - one.centre)
                    + steiner(toes.mass, b - one.centre);
                assert!((sum - one.inertia).to_cols_array().iter().all(|value| value.abs() < 1e-9), "{sum}");
                assert!(is_positive(foot.inertia) && is_positive(toes.inertia), "{weighed}");
                // Boxes: heel to joint, joint to tip, both on the ground.
                let shape = &body.feet[side as usize];
                assert!((foot.middle.z - foot.half.z - shape.heel).abs() < 1e-9);
                assert!((foot.middle.z + foot.half.z - toes.anchor.z).abs() < 1e-9);
                assert!((toes.middle.z - toes.half.z).abs() < 1e-9);
                assert!((toes.anchor.z + toes.middle.z + toes.half.z - shape.tip).abs() < 1e-9);
                for (middle, half) in [(foot.middle, foot.half), (toes.anchor + toes.middle, toes.half)] {
                    assert!((middle.y - half.y + shape.ankle_height).abs() < 1e-9);
                }
            }
        }
    }

    /// Both heels raised by that angle over toes that lie flat.
    fn tiptoe(body: &Body, stand: &BodyPose, angle: f64) -> BodyPose {
        let (mut pose, rise) = (stand.clone(), DQuat::from_rotation_x(angle));
        let positions = stand.positions(body);
        for foot in &body.feet {
            pose.turns[foot.ankle] = rise * stand.turns[foot.ankle];
        }
        let (ankle, ball) = (positions[body.feet[0].ankle], positions[body.feet[0].toe.expect("toes")]);
        pose.hips += ball + rise * (ankle - ball) - ankle;
        pose
    }

    #[test]
    fn on_tiptoe_the_ball_and_the_tip_bear_and_the_toes_stay_while_the_heels_come_down() {
        let (body, stand) = humanoid(false);
        let figure = Figure::new(&body, &stand, Locks::default());
        let pose = tiptoe(&body, &stand, 0.3);
        let terrain = Terrain::flat();
        let mut world = World::new(&figure, &figure.placed(&body, &pose), &terrain, 0.01, 2).expect("a tree");
        let mut control = Controller::new(&figure, &world, Tuning::default());
        let mut states = Vec::new();
        world.read(&mut states);
        let heel = |states: &[LinkState]| figure.sole_at(states, Side::Left)[0].y;
        let ball = |states: &[LinkState]| states[figure.toes[0].expect("toes")].origin;
        assert!(heel(&states) > 0.04, "{} m", heel(&states));
        let bearing: Vec<usize> = control.corners(&figure, &terrain).iter().map(|(name, _)| name % POINTS).collect();
        assert!(bearing.len() == 8 && bearing.iter().all(|name| *name >= BALL), "{bearing:?}");
        // It may step then: it comes down backwards.
        let (mut down, mut stood) = (None, None);
        for tick in 0..100 {
            world.clear_forces();
            control.tick(&figure, &mut world, &terrain);
            world.step(&terrain, 0.01 * f64::from(tick + 1));
            world.read(&mut states);
            assert_eq!(World::broken(&figure, &states), None);
            if control.swing.is_some() {
                break;
            }
            // From when it bears on.
            let at = if tick < 2 { continue } else { *stood.get_or_insert(ball(&states)) };
            assert!(ball(&states).distance(at) < 0.0015, "the ball moves by {} m", ball(&states).distance(at));
            if heel(&states) < 0.015 {
                down.get_or_insert(tick);
            }
        }
        assert!(down.is_some_and(|tick| tick > 3), "the heels come down at tick {down:?}");
    }

    #[test]
    fn toes_lie_along_the_ground_that_the_foot_comes_down_on_whichever_way_it_leans() {
        for leans in [-0.4, 0.0, 0.3, 0.44] {
            let up = DQuat::from_rotation_x(-leans) * DVec3::Y;
            let points = |down: f64| DQuat::from_rotation_x(down - leans) * DVec3::Z;
            for (down, bent) in [(0.0, 0.0), (0.35, 0.35), (-0.2, 0.0), (1.4, RANGE[1])] {
                let found = along(points(down), up);
                assert!((found - bent).abs() < 1e-9, "ground up by {leans}, foot down by {down}: {found}");
            }
        }
    }

    #[test]
    fn a_rig_whose_toe_joints_are_nowhere_a_foot_bends_keeps_its_feet_whole() {
        type Moves = fn(&mut Body, usize);
        let places: [(&str, Moves); 9] = [
            ("behind the heel", |body, toe| body.joints[toe].rest.z = -0.2),
            ("under the ankle", |body, toe| body.joints[toe].rest.z = 0.0),
            ("at the tip", |body, toe| body.joints[toe].rest.z = 0.188),
            ("above the ankle", |body, toe| body.joints[toe].rest.y = 0.2),
            ("well over the sole", |body, toe| body.joints[toe].rest.y = 0.05),
            ("in the ground", |body, toe| body.joints[toe].rest.y = -0.05),
            ("beside the foot", |body, toe| body.joints[toe].rest.x += 0.1),
            ("nowhere", |body, toe| body.joints[toe].rest.x = f64::NAN),
            ("moved by no node", |body, toe| body.joints[toe].animated = false),
        ];
        for (name, misplaced) in places {
            let (mut body, stand) = humanoid(false);
            let whole = Figure::new(&body, &stand, locked());
            for side in 0..2 {
                let toe = body.feet[side].toe.expect("toes");
                misplaced(&mut body, toe);
            }
            let figure = Figure::new(&body, &stand, Locks::default());
            assert_eq!((figure.toes, figure.links.len()), ([None; 2], whole.links.len()), "{name}");
            for (link, own) in figure.links.iter().zip(&whole.links) {
                assert_eq!((link.part, link.mass, link.inertia), (own.part, own.mass, own.inertia), "{name}");
                assert_eq!((link.half, link.middle), (own.half, own.middle), "{name}");
            }
            assert_eq!(figure.stiff_sole(Side::Left), figure.soles[0], "{name}");
        }
    }
}

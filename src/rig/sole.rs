//! The shape of a foot's sole, from the vertices that move with it, or from the joints where there is no mesh.
//!
//! Metres; offsets from the ankle joint in scenario axes at rest. A foot that the bind pose holds pitched or rolled is
//! first laid down: the plane on which it would rest is the face of its lower hull under the middle of the sole. What
//! it leaves out: soft soles, arches, and heels so high that the sole is no plane.

use super::sole_frame::{across, along, angle_of, aside, ball_line, extent, heading, lies_flat, toe_turn};
use super::sole_plane::{resting_normal, thin};
use crate::model::{FootShape, Side};
use glam::{DQuat, DVec2, DVec3};

/// A foot whose sole is off level by less than this is taken as level, rad.
const LEVEL_WITHIN: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// Sole vertices lie within this share of the height over the plane (15 mm for 1.7 m).
const BAND: f64 = 0.0088;
/// Sine of the roll over which a mesh is no foot (25 degrees).
const MOST_ROLL: f64 = 0.4226;
/// What is known of a foot.
pub(super) struct FootInput<'a> {
    /// Left or right.
    pub side: Side,
    /// Index of the ankle joint.
    pub ankle: usize,
    /// m over the ground at rest.
    pub ankle_y: f64,
    /// Index of the toe joint and its offset from the ankle.
    pub toe: Option<(usize, DVec3)>,
    /// m, the body's.
    pub height: f64,
    /// What is drawn of the foot.
    pub vertices: &'a [FootVertex],
}

/// A vertex that mostly moves with the foot or its toes.
#[derive(Clone, Copy, Debug)]
pub(super) struct FootVertex {
    /// m, from the ankle.
    pub offset: DVec3,
    /// Whether the toe joint has more of it than the foot joint.
    pub toe: bool,
}

/// A sole, and what had to be assumed.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub shape: FootShape,
    /// Sentences.
    pub notes: Vec<String>,
    /// By the mesh; else by the joints.
    pub of_mesh: bool,
}

/// The sole by the mesh where it makes one, else by the joints.
pub(super) fn foot_shape(input: &FootInput) -> Measured {
    if input.vertices.len() < 4 {
        return Measured { shape: from_joints(input), notes: Vec::new(), of_mesh: false };
    }
    match from_mesh(input).filter(|(shape, _)| is_plausible(shape)) {
        Some((shape, notes)) => Measured { shape, notes, of_mesh: true },
        None => {
            let note =
                format!("the mesh around the {} foot makes no sole; it is made from the joints", name(input.side));
            Measured { shape: from_joints(input), notes: vec![note], of_mesh: false }
        }
    }
}

/// A foot stands under its ankle, is not much wider than long, and was not lying on its side.
fn is_plausible(shape: &FootShape) -> bool {
    let normal = shape.level.inverse() * DVec3::Y;
    let length = shape.tip - shape.heel;
    let rolled = aside(normal, shape.forward).abs() > MOST_ROLL;
    let under = shape.heel < 0.25 * length && shape.tip > 0.1 * length && shape.ankle_height > 0.0;
    !rolled && under && 2.0 * shape.half_width < 1.5 * length
}

pub(super) fn name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}

/// A sole of ordinary proportions around the joints.
fn from_joints(input: &FootInput) -> FootShape {
    let height = input.height;
    let ankle_height = input.ankle_y.clamp(0.02 * height, 0.12 * height);
    let toe = input.toe.map(|(_, offset)| DVec2::new(offset.x, offset.z)).filter(|flat| flat.length() > 0.02 * height);
    let (forward, ball) = match toe {
        Some(flat) => (flat.normalize(), flat.length().min(0.2 * height)),
        None => (DVec2::Y, 0.0715 * height),
    };
    // The ball lies at 0.72 of a foot whose heel is 0.25 of it behind the ankle.
    let length = ball / 0.47;
    let (heel, tip, half_width) = (-0.25 * length, 0.75 * length, 0.19 * length);
    let across = DVec2::new(forward.y, -forward.x);
    let place = |along: f64, aside: f64| {
        let flat = forward * along + across * aside * half_width;
        DVec3::new(flat.x, -ankle_height, flat.y)
    };
    let outline = |stations: &[(f64, f64)]| -> Vec<DVec3> {
        stations.iter().flat_map(|&(along, aside)| [place(along, aside), place(along, -aside)]).collect()
    };
    FootShape {
        ankle: input.ankle,
        toe: input.toe.map(|toe| toe.0),
        level: DQuat::IDENTITY,
        toe_level: DQuat::IDENTITY,
        ankle_height,
        forward,
        heel,
        ball,
        tip,
        half_width,
        rear_sole: outline(&[(heel, 0.3), (heel + 0.08 * length, 0.6), (ball, 1.0)]),
        front_sole: outline(&[(ball, 1.0), (tip - 0.1 * length, 0.75), (tip, 0.3)]),
    }
}

/// The sole of the mesh; none where its points have no area.
fn from_mesh(input: &FootInput) -> Option<(FootShape, Vec<String>)> {
    let mut warnings = Vec::new();
    let all: Vec<DVec3> = input.vertices.iter().map(|vertex| vertex.offset).collect();
    let toe_share = input.vertices.iter().filter(|vertex| vertex.toe).count() as f64 / all.len() as f64;
    // Points that do not turn with the foot must not decide how it lies.
    let rear: Vec<DVec3> = input.vertices.iter().filter(|vertex| !vertex.toe).map(|vertex| vertex.offset).collect();
    let rear = if rear.len() >= 4 { rear } else { all.clone() };

    let mut level = DQuat::IDENTITY;
    let mut forward = heading(input, &all, level);
    // The way that the foot points and the plane that it rests on depend on each other a little.
    for _ in 0..2 {
        let (near, far) = extent(all.iter().map(|point| along(level * *point, forward)))?;
        let (left, right) = extent(rear.iter().map(|point| aside(level * *point, forward)))?;
        let ball = ball_line(input, level, forward, near, far);
        let middle = forward * ((near + ball) / 2.0) + across(forward) * ((left + right) / 2.0);
        let turned: Vec<DVec3> = all.iter().map(|point| level * *point).collect();
        let normal = resting_normal(&turned, middle);
        level = DQuat::from_rotation_arc(normal, DVec3::Y) * level;
        forward = heading(input, &all, level);
    }
    if angle_of(level) < LEVEL_WITHIN || lies_flat(input, &rear, &all) {
        level = DQuat::IDENTITY;
        forward = heading(input, &all, level);
    } else {
        warnings.push(format!(
            "the {} foot is {:.0} degrees off level in the bind pose; it is laid flat to stand",
            name(input.side),
            angle_of(level).to_degrees()
        ));
    }

    // Toes that bend: laid flat on their own, where they are not already as flat as the foot.
    let toe_points: Vec<DVec3> =
        input.vertices.iter().filter(|vertex| vertex.toe).map(|vertex| vertex.offset).collect();
    let mut toe = input.toe.filter(|_| toe_share > 0.04 && toe_points.len() >= 3);
    if let (Some(_), None) = (input.toe, toe) {
        warnings.push(format!("the {} toe joint moves no part of the sole; the foot does not bend", name(input.side)));
    }
    let toe_level = match toe {
        Some(_) => toe_turn(&toe_points, level, forward),
        None => level,
    };
    let toe_offset = toe.map_or(DVec3::ZERO, |(_, offset)| offset);
    let lay = |vertex: &FootVertex| {
        if vertex.toe && toe.is_some() {
            level * toe_offset + toe_level * (vertex.offset - toe_offset)
        } else {
            level * vertex.offset
        }
    };

    let laid: Vec<DVec3> = input.vertices.iter().map(lay).collect();
    let (whole_near, whole_far) = extent(laid.iter().map(|point| along(*point, forward)))?;
    let lowest = extent(laid.iter().map(|point| point.y))?.0;
    let mut band = BAND * input.height;
    let mut chosen: Vec<usize>;
    // A rounded sole has few points near its lowest: widen the band until they make a sole.
    loop {
        chosen = (0..laid.len()).filter(|&index| laid[index].y <= lowest + band).collect();
        let (near, far) = extent(chosen.iter().map(|&index| along(laid[index], forward)))?;
        if (chosen.len() >= 4 && far - near > 0.6 * (whole_far - whole_near)) || band > 0.05 * input.height {
            break;
        }
        band *= 1.5;
    }
    let (heel, tip) = extent(chosen.iter().map(|&index| along(laid[index], forward)))?;
    if tip - heel < 0.02 * input.height {
        return None;
    }
    let mut ball = ball_line(input, level, forward, heel, tip);
    if ball < heel + 0.45 * (tip - heel) || ball > heel + 0.95 * (tip - heel) {
        toe = None;
        ball = heel + 0.72 * (tip - heel);
    }

    // A foot that bends turns about its toe joint, and its sprung tip still comes down in a push-off.
    let tip = match toe {
        Some(_) => tip,
        None => {
            bearing_tip(chosen.iter().map(|&index| (along(laid[index], forward), laid[index].y - lowest)), ball, tip)
        }
    };

    let near_ball: Vec<f64> = chosen
        .iter()
        .filter(|&&index| (along(laid[index], forward) - ball).abs() < 0.2 * (tip - heel))
        .map(|&index| aside(laid[index], forward))
        .collect();
    let (left, right) = match extent(near_ball.iter().copied()) {
        Some((left, right)) if right - left > 0.1 * (tip - heel) => (left, right),
        _ => extent(chosen.iter().map(|&index| aside(laid[index], forward)))?,
    };

    let in_front = |index: usize| match toe {
        Some(_) => input.vertices[index].toe,
        None => along(laid[index], forward) > ball,
    };
    let flat = |index: usize| DVec2::new(along(laid[index], forward), aside(laid[index], forward));
    let mut parts = [false, true].map(|front| {
        let points: Vec<usize> = chosen.iter().copied().filter(|&index| in_front(index) == front).collect();
        thin(&points, &flat, &laid).into_iter().map(|index| input.vertices[index].offset).collect::<Vec<_>>()
    });
    // Where the two parts meet, both have the ends of the ball line: a coarse mesh may have no vertices there.
    for end in [left, right] {
        let point = forward * ball + across(forward) * end;
        let levelled = DVec3::new(point.x, lowest, point.y);
        parts[0].push(level.inverse() * levelled);
        let at_toe = match toe {
            Some(_) => toe_offset + toe_level.inverse() * (levelled - level * toe_offset),
            None => level.inverse() * levelled,
        };
        parts[1].push(at_toe);
    }
    let [rear_sole, front_sole] = parts;
    let shape = FootShape {
        ankle: input.ankle,
        toe: toe.map(|entry| entry.0),
        level,
        toe_level,
        ankle_height: -lowest,
        forward,
        heel,
        ball,
        tip,
        half_width: (right - left) / 2.0,
        rear_sole,
        front_sole,
    };
    Some((shape, warnings))
}

/// Where a stiff foot turns over its tip: what a bevelled or sprung tip holds over the ground counts against it, since a
/// foot that turned about a point in the air would hover; and turned by 45 degrees no point of it comes under the ground.
/// `points`: along the foot and over its plane, m.
fn bearing_tip(points: impl Iterator<Item = (f64, f64)>, ball: f64, tip: f64) -> f64 {
    let bearing = points.map(|(along, over)| along - over).fold(f64::NEG_INFINITY, f64::max);
    if bearing > ball { bearing } else { tip }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::real;

    /// Corners and edge points of a box foot: heel 7 cm behind the ankle, tip 18 cm ahead, 9 cm wide, 8 cm to the ankle.
    fn box_foot() -> Vec<FootVertex> {
        let mut vertices = Vec::new();
        for step in 0..=10 {
            let z = -0.07 + 0.025 * f64::from(step);
            for x in [-0.045, 0.0, 0.045] {
                for y in [-0.08, -0.03] {
                    vertices.push(FootVertex { offset: DVec3::new(x, y, z), toe: z > 0.1 });
                }
            }
        }
        vertices
    }

    fn input(vertices: &[FootVertex], toe: Option<DVec3>) -> FootInput<'_> {
        FootInput {
            side: Side::Left,
            ankle: 3,
            ankle_y: 0.08,
            toe: toe.map(|offset| (4, offset)),
            height: 1.7,
            vertices,
        }
    }

    fn assert_near(value: f64, wanted: f64, within: f64, what: &str) {
        assert!((value - wanted).abs() <= within, "{what}: {value:.4}, wanted {wanted:.4} within {within}");
    }

    fn measured(input: &FootInput) -> (FootShape, Vec<String>) {
        let found = foot_shape(input);
        (found.shape, found.notes)
    }

    const TOE: DVec3 = DVec3::new(0.0, -0.06, 0.11);

    #[test]
    fn a_box_foot_has_its_own_heel_ball_tip_and_width() {
        let vertices = box_foot();
        let (shape, warnings) = measured(&input(&vertices, Some(TOE)));
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!((shape.level, shape.toe_level, shape.toe), (DQuat::IDENTITY, DQuat::IDENTITY, Some(4)));
        assert_near(shape.heel, -0.07, 1e-9, "heel");
        assert_near(shape.ball, 0.11, 1e-9, "ball");
        assert_near(shape.tip, 0.18, 1e-9, "tip");
        assert_near(shape.ankle_height, 0.08, 1e-9, "ankle height");
        assert_near(shape.half_width, 0.045, 1e-9, "half width");
        assert_near(shape.forward.y, 1.0, 1e-9, "forward");
        for point in shape.rear_sole.iter().chain(&shape.front_sole) {
            assert_near(point.y, -0.08, 1e-9, "a sole point");
        }
        assert!(shape.rear_sole.len() <= 24 && shape.front_sole.len() <= 24, "thinned");
    }

    #[test]
    fn a_foot_pitched_by_twenty_degrees_is_laid_flat() {
        for degrees in [20.0f64, -20.0, 35.0, -35.0] {
            let pitch = DQuat::from_rotation_x(degrees.to_radians());
            let vertices: Vec<FootVertex> =
                box_foot().iter().map(|vertex| FootVertex { offset: pitch * vertex.offset, ..*vertex }).collect();
            let (shape, warnings) = measured(&input(&vertices, Some(pitch * TOE)));
            assert_eq!(warnings.len(), 1, "it says so: {warnings:?}");
            assert!(shape.level.angle_between(pitch.inverse()) < 1e-5, "level {} against {pitch}", shape.level);
            assert_eq!(shape.level, shape.toe_level, "the toes were straight");
            assert_near(shape.heel, -0.07, 1e-6, "heel");
            assert_near(shape.ball, 0.11, 1e-6, "ball");
            assert_near(shape.tip, 0.18, 1e-6, "tip");
            assert_near(shape.ankle_height, 0.08, 1e-6, "ankle height");
            for point in &shape.rear_sole {
                assert_near((shape.level * *point).y, -0.08, 1e-6, "a levelled sole point");
            }
        }
    }

    #[test]
    fn a_lifted_heel_over_flat_toes_turns_the_foot_and_not_the_toes() {
        let pitch = DQuat::from_rotation_x(25f64.to_radians());
        let toe = pitch * TOE;
        let vertices: Vec<FootVertex> = box_foot()
            .iter()
            .map(|vertex| {
                let offset = if vertex.toe { toe + (vertex.offset - TOE) } else { pitch * vertex.offset };
                FootVertex { offset, ..*vertex }
            })
            .collect();
        let (shape, _) = measured(&input(&vertices, Some(toe)));
        assert!(shape.level.angle_between(pitch.inverse()) < 0.02, "level {}", shape.level);
        assert_eq!(shape.toe_level, DQuat::IDENTITY);
        assert_near(shape.ankle_height, 0.08, 2e-3, "ankle height");
        assert_near(shape.tip, 0.18, 2e-3, "tip");
        for point in &shape.front_sole {
            let laid = shape.level * toe + shape.toe_level * (*point - toe);
            assert_near(laid.y, -shape.ankle_height, 2e-3, "a levelled toe point");
        }
    }

    #[test]
    fn without_toes_the_ball_stands_at_its_proportion() {
        let vertices: Vec<FootVertex> = box_foot().iter().map(|vertex| FootVertex { toe: false, ..*vertex }).collect();
        let (shape, _) = measured(&input(&vertices, None));
        assert_eq!(shape.toe, None);
        assert_near(shape.ball, -0.07 + 0.72 * 0.25, 1e-9, "ball");
        assert!(shape.front_sole.iter().all(|point| point.z >= shape.ball - 1e-9), "front points lie ahead of it");
        // A toe joint whose mesh hangs on the foot bends nothing.
        let (shape, warnings) = measured(&input(&vertices, Some(TOE)));
        assert_eq!((shape.toe, warnings.len()), (None, 1));
        assert_near(shape.ball, 0.11, 1e-9, "ball at the joint all the same");
    }

    #[test]
    fn a_bevelled_tip_of_a_stiff_foot_ends_where_it_bears() {
        // The front edge is 11 mm up and 12 mm ahead of the last that touches, as on a shoe with a bevelled sole.
        let mut vertices: Vec<FootVertex> =
            box_foot().iter().map(|vertex| FootVertex { toe: false, ..*vertex }).collect();
        let bevel = [-0.03, 0.0, 0.03].map(|x| FootVertex { offset: DVec3::new(x, -0.069, 0.192), toe: false });
        vertices.extend(bevel);
        let (shape, _) = measured(&input(&vertices, None));
        assert_near(shape.tip, 0.192 - 0.011, 1e-9, "tip");
        assert_near(shape.foremost(), 0.192, 1e-9, "foremost");
        assert!(shape.front_sole.iter().any(|point| point.z > 0.19), "the bevel is of the sole all the same");
        // A millimetre up is no bevel: people's tips are rounded.
        let nearly = [-0.03, 0.03].map(|x| FootVertex { offset: DVec3::new(x, -0.079, 0.192), toe: false });
        vertices.extend(nearly);
        assert_near(measured(&input(&vertices, None)).0.tip, 0.192 - 0.001, 1e-9, "tip");
    }

    #[test]
    fn a_foot_turned_out_points_where_its_toes_point() {
        let turn = DQuat::from_rotation_y(15f64.to_radians());
        let vertices: Vec<FootVertex> =
            box_foot().iter().map(|vertex| FootVertex { offset: turn * vertex.offset, toe: false }).collect();
        let (shape, _) = measured(&input(&vertices, None));
        assert_near(real::atan2(shape.forward.x, shape.forward.y).to_degrees(), 15.0, 0.1, "by the mesh alone");
        assert_near(shape.tip, 0.18, 1e-3, "tip");
    }

    #[test]
    fn without_a_mesh_the_joints_make_a_plausible_sole() {
        let (shape, _) = measured(&input(&[], Some(TOE)));
        assert_near(shape.ball, 0.11, 1e-9, "ball");
        let length = shape.tip - shape.heel;
        assert!((0.2..0.3).contains(&length), "foot length {length}");
        assert_near(shape.ankle_height, 0.08, 1e-9, "ankle height");
        assert_eq!(shape.rear_sole.len() + shape.front_sole.len(), 12);
    }

    #[test]
    fn broken_meshes_make_no_panic() {
        for offset in [DVec3::ZERO, DVec3::splat(1e300), DVec3::new(0.0, -0.08, 0.0)] {
            let vertices = vec![FootVertex { offset, toe: false }; 9];
            let (shape, _) = measured(&input(&vertices, Some(TOE)));
            assert!(shape.tip > shape.heel, "{shape:?}");
        }
    }

    #[test]
    fn a_mesh_that_is_no_foot_is_not_believed() {
        let roll = DQuat::from_rotation_z(40f64.to_radians());
        let vertices: Vec<FootVertex> =
            box_foot().iter().map(|vertex| FootVertex { offset: roll * vertex.offset, ..*vertex }).collect();
        let (shape, warnings) = measured(&input(&vertices, Some(TOE)));
        assert_eq!((shape.level, warnings.len()), (DQuat::IDENTITY, 1));
        assert_near(shape.ball, 0.11, 1e-9, "ball, by the joints");
    }
}

//! The dynamics against closed forms.

mod touching;

use super::*;
use crate::maths::real;
use glam::{DMat3, DQuat, DVec3};

const G: f64 = 9.81;

fn solid(half: DVec3, mass: f64) -> DMat3 {
    let square = half * half;
    DMat3::from_diagonal(DVec3::new(square.y + square.z, square.x + square.z, square.x + square.y) * (mass / 3.0))
}

fn link(parent: Option<usize>, joint: Joint, anchor: DVec3, mass: f64, centre: DVec3) -> Link {
    let inertia = solid(DVec3::new(0.05, 0.1, 0.04), mass);
    Link { parent, joint, anchor, mass, centre, inertia, range: Range::Free }
}

/// A root so heavy that it is as good as fixed, if its weight is carried.
fn fixed() -> Link {
    Link { inertia: DMat3::IDENTITY * 1e9, ..link(None, Joint::Free, DVec3::ZERO, 1e7, DVec3::ZERO) }
}

fn made(links: Vec<Link>) -> Articulation {
    let placed = vec![(DVec3::ZERO, DQuat::IDENTITY); links.len()];
    Articulation::new(Tree::new(links).expect("a tree"), &placed, f64::INFINITY)
}

/// Steps with nothing to touch.
fn fly(body: &mut Articulation, dt: f64, seconds: f64) {
    let mut around = Around::default();
    for _ in 0..(seconds / dt).round() as usize {
        body.step(&mut around, dt, 1, &mut |_, _, _, _| {});
    }
}

#[test]
fn a_pendulum_swings_in_its_period() {
    let (mass, long) = (2.0, 0.5);
    for joint in [Joint::Hinge { axis: DVec3::Z }, Joint::Ball] {
        let rod = link(Some(0), joint, DVec3::ZERO, mass, DVec3::NEG_Y * long);
        let mut body = made(vec![fixed(), rod]);
        body.push(0, DVec3::Y * (G * (1e7 + mass)), DVec3::ZERO, DVec3::ZERO);
        body.tilt(1, DVec3::Z * 0.02);
        let (dt, mut around) = (1e-3, Around::default());
        let mut crossings = Vec::new();
        let mut before = body.place(1).1.to_scaled_axis().z;
        for tick in 0..6000 {
            body.step(&mut around, dt, 1, &mut |_, _, _, _| {});
            let now = body.place(1).1.to_scaled_axis().z;
            if before > 0.0 && now <= 0.0 {
                crossings.push((f64::from(tick) + before / (before - now)) * dt);
            }
            before = now;
        }
        let period = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
        let about = rod.inertia.z_axis.z + mass * long * long;
        let wanted = std::f64::consts::TAU * (about / (mass * G * long)).sqrt();
        assert!((period / wanted - 1.0).abs() < 2e-3, "{joint:?}: {period} s, not {wanted}");
    }
}

/// Seven links that turn every way.
fn tumbling() -> Articulation {
    let ball =
        |parent, x: f64, y: f64| link(Some(parent), Joint::Ball, DVec3::new(x, y, 0.02), 3.0, DVec3::new(x, y, 0.0));
    let hinge =
        |parent, x: f64, y: f64| Link { joint: Joint::Hinge { axis: DVec3::new(0.6, 0.0, 0.8) }, ..ball(parent, x, y) };
    let mut body = made(vec![
        link(None, Joint::Free, DVec3::ZERO, 10.0, DVec3::new(0.0, 0.05, 0.01)),
        ball(0, 0.0, 0.3),
        ball(0, 0.1, -0.2),
        hinge(2, 0.0, -0.4),
        ball(3, 0.05, -0.3),
        hinge(1, 0.2, 0.1),
        ball(0, -0.1, -0.2),
    ]);
    for freedom in 0..body.tree.freedoms() {
        body.speed[freedom] = ((freedom * 7 % 11) as f64 - 5.0) * 0.4;
    }
    body.follow();
    body
}

#[test]
fn in_flight_momentum_is_gravitys_alone_and_energy_is_kept_the_better_the_shorter_the_step() {
    let mut lost = Vec::new();
    for dt in [1e-3, 5e-4, 2.5e-4] {
        let mut body = tumbling();
        let (was, mass) = (body.momentum(), 28.0);
        fly(&mut body, dt, 0.5);
        let now = body.momentum();
        assert!(now.linear.distance(was.linear + DVec3::NEG_Y * (mass * G * 0.5)) < 1e-6, "{now:?}");
        let energy = |m: &Momentum| m.kinetic + m.potential;
        lost.push((energy(&now) - energy(&was)).abs());
    }
    // Explicit Euler's own error in free fall is first order; so is what is left.
    assert!(
        lost[1] < 0.6 * lost[0] && lost[2] < 0.6 * lost[1] && lost[2] < 0.5,
        "{lost:?} J of {}",
        tumbling().momentum().kinetic
    );
}

/// m, the centre of mass.
fn centre(body: &Articulation) -> DVec3 {
    let (mut moment, mut mass) = (DVec3::ZERO, 0.0);
    for (index, link) in body.tree.links.iter().enumerate() {
        let (origin, turn) = body.place(index);
        moment += link.mass * (origin + turn * link.centre);
        mass += link.mass;
    }
    moment / mass
}

#[test]
fn in_flight_the_turning_momentum_about_the_centre_of_mass_stays() {
    let about = |body: &Articulation| {
        let momentum = body.momentum();
        momentum.angular - centre(body).cross(momentum.linear)
    };
    let mut drift = Vec::new();
    for dt in [1e-3, 2.5e-4] {
        let mut body = tumbling();
        let was = about(&body);
        fly(&mut body, dt, 0.5);
        drift.push(about(&body).distance(was) / was.length());
    }
    assert!(drift[0] < 0.01 && drift[1] < 0.3 * drift[0], "{drift:?}");
}

#[test]
fn a_spring_and_a_damper_come_to_rest_where_they_balance_the_weight() {
    let (mass, long, stiff) = (2.0, 0.5, 80.0);
    let rod = link(Some(0), Joint::Hinge { axis: DVec3::Z }, DVec3::ZERO, mass, DVec3::X * long);
    let mut body = made(vec![fixed(), rod]);
    body.push(0, DVec3::Y * (G * (1e7 + mass)), DVec3::ZERO, DVec3::ZERO);
    let mut around = Around::default();
    for _ in 0..500 {
        let angle = body.place(1).1.to_scaled_axis().z;
        body.drive(1, DVec3::splat(stiff), DVec3::splat(8.0), DVec3::NEG_Z * angle);
        body.step(&mut around, 0.01, 2, &mut |_, _, _, _| {});
    }
    let angle = body.place(1).1.to_scaled_axis().z;
    assert!((stiff * angle + mass * G * long * real::cos(angle)).abs() < 1e-6, "at {angle} rad");
    assert!((body.given(1) - stiff * angle.abs()).abs() < 1e-6, "{} N m", body.given(1));
}

#[test]
fn no_joint_gives_more_than_it_can_and_what_it_gives_is_what_acts() {
    let rod = link(Some(0), Joint::Ball, DVec3::ZERO, 2.0, DVec3::X * 0.5);
    let root = link(None, Joint::Free, DVec3::ZERO, 3.0, DVec3::ZERO);
    let tree = Tree::new(vec![root, rod]).expect("a tree");
    let mut body = Articulation::new(tree, &[(DVec3::ZERO, DQuat::IDENTITY); 2], 12.0);
    let mut around = Around::default();
    let mut strained = 0;
    for tick in 0..100 {
        let turn = DVec3::new(0.3, f64::from(tick % 7) - 3.0, 0.5);
        body.drive(1, DVec3::splat(200.0), DVec3::splat(3.0), turn);
        let spin = body.momentum().angular;
        body.step(&mut around, 0.01, 2, &mut |_, _, _, _| {});
        assert!(body.given(1) <= 12.0 + 1e-9, "{} N m", body.given(1));
        strained += u32::from(body.given(1) > 11.9);
        // A joint's torque acts on both its links: all that changes the whole is gravity.
        assert!(body.momentum().linear.x.abs() < 1e-9 && spin.is_finite());
    }
    assert!(strained > 10, "{strained}");
}

/// Three seconds in which a torque (N m) turns the first of some links that hang from a fixed one; `see` is shown each tick.
fn turned(links: Vec<Link>, torque: DVec3, mut see: impl FnMut(&Articulation)) {
    let hang = links.len();
    let (mut body, mut around) = (made(links), Around::default());
    for _ in 0..300 {
        body.let_go();
        body.push(0, DVec3::Y * (G * 1e7), DVec3::ZERO, DVec3::ZERO);
        body.push(1, DVec3::ZERO, DVec3::ZERO, torque);
        (1..hang).for_each(|link| body.drive(link, DVec3::ZERO, DVec3::splat(1.5), DVec3::ZERO));
        body.step(&mut around, 0.01, 2, &mut |_, _, _, _| {});
        see(&body);
    }
}

#[test]
fn joints_stop_at_the_ends_of_their_ranges() {
    let range = Range::Ball(Swing {
        along: DVec3::NEG_Y,
        about: [DVec3::X, DVec3::Z],
        swing: [[-1.5, 0.3], [-0.3, 0.6]],
        twist: [-0.4, 0.4],
    });
    let thigh = Link { range, ..link(Some(0), Joint::Ball, DVec3::NEG_Y * 0.1, 8.0, DVec3::NEG_Y * 0.2) };
    let hinge = Joint::Hinge { axis: DVec3::X };
    let shank =
        Link { range: Range::Hinge([0.0, 2.4]), ..link(Some(1), hinge, DVec3::NEG_Y * 0.4, 4.0, DVec3::NEG_Y * 0.2) };
    for torque in [DVec3::X * 60.0, DVec3::NEG_X * 60.0, DVec3::Z * 40.0, DVec3::NEG_Z * 40.0, DVec3::Y * 10.0] {
        let (mut past, mut moved) = (0.0_f64, 0.0_f64);
        turned(vec![fixed(), thigh, shank], torque, |body| {
            let turned = body.relative[1].to_scaled_axis();
            moved = moved.max(turned.length());
            past = past.max(turned.x - 0.3).max(-1.5 - turned.x).max(turned.z - 0.6).max(-0.3 - turned.z);
            past = past.max(-body.angle[2]).max(body.angle[2] - 2.4);
        });
        assert!(past < 0.03 && moved > 0.25, "{torque}: {past} rad past, moved {moved}");
    }
}

#[test]
fn a_joint_whose_angles_are_read_about_axes_of_its_own_stops_at_their_ends() {
    for reading in [Reading::Turns, Reading::Swing] {
        let range = [[-1.5, 0.3], [-0.3, 0.6], [-0.4, 0.4]];
        let (before, after) = (DQuat::from_rotation_z(0.1), DQuat::from_rotation_x(-0.1));
        let axes = Axes { reading, before, after, range };
        let thigh = Link {
            range: Range::Axes(axes),
            ..link(Some(0), Joint::Ball, DVec3::NEG_Y * 0.1, 8.0, DVec3::NEG_Y * 0.2)
        };
        for torque in [DVec3::X * 60.0, DVec3::NEG_X * 60.0, DVec3::Z * 40.0, DVec3::NEG_Z * 40.0, DVec3::Y * 10.0] {
            let (mut past, mut moved) = (0.0_f64, 0.0_f64);
            turned(vec![fixed(), thigh], torque, |body| {
                moved = moved.max(body.relative[1].to_scaled_axis().length());
                for ((angle, _), [low, high]) in axes.angles(body.relative[1]).into_iter().zip(range) {
                    past = past.max(angle - high).max(low - angle);
                }
            });
            assert!(past < 0.03 && moved > 0.25, "{reading:?} {torque}: {past} rad past, moved {moved}");
        }
    }
}

#[test]
fn the_same_run_gives_the_same_bits() {
    let run = || {
        let mut body = tumbling();
        fly(&mut body, 1e-3, 0.2);
        (0..7).map(|link| body.place(link)).collect::<Vec<_>>()
    };
    assert_eq!(run(), run());
}

#[test]
fn what_is_no_tree_is_said() {
    let root = link(None, Joint::Free, DVec3::ZERO, 1.0, DVec3::ZERO);
    let limb = link(Some(0), Joint::Ball, DVec3::Y, 1.0, DVec3::ZERO);
    assert_eq!(Tree::new(vec![]).expect_err("none"), TreeError::Order(0));
    assert_eq!(Tree::new(vec![root, Link { parent: Some(2), ..limb }]).expect_err("order"), TreeError::Order(1));
    assert_eq!(Tree::new(vec![root, Link { parent: None, ..limb }]).expect_err("order"), TreeError::Order(1));
    for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(Tree::new(vec![root, Link { mass, ..limb }]).expect_err("mass"), TreeError::Mass(1));
    }
    let anchor = DVec3::new(f64::NAN, 0.0, 0.0);
    assert_eq!(Tree::new(vec![root, Link { anchor, ..limb }]).expect_err("place"), TreeError::Mass(1));
    let chain: Vec<Link> =
        (0..9).map(|at| if at == 0 { root } else { Link { parent: Some(at - 1), ..limb } }).collect();
    assert_eq!(Tree::new(chain).expect_err("deep"), TreeError::Large(5));
    let wide: Vec<Link> = (0..20).map(|at| if at == 0 { root } else { limb }).collect();
    assert_eq!(Tree::new(wide).expect_err("wide"), TreeError::Large(15));
}

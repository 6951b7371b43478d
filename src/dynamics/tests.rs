//! The dynamics against closed forms.

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

/// Corners of a box that may touch a plane through the origin.
fn corners(half: DVec3, normal: DVec3, friction: f64) -> impl FnMut(&Articulation, &[Loose], f64, &mut Vec<Touch>) {
    move |body, _, _, touches| {
        let (origin, turn) = body.place(0);
        for corner in 0..8_u32 {
            let sign = |bit: u32| if corner & bit == 0 { -1.0 } else { 1.0 };
            let at = origin + turn * (half * DVec3::new(sign(1), sign(2), sign(4)));
            let gap = at.dot(normal);
            if gap < 0.05 {
                let surface = DVec3::ZERO;
                touches.push(Touch {
                    link: 0,
                    key: corner,
                    at,
                    normal,
                    gap,
                    friction,
                    bounce: 0.0,
                    surface,
                    other: None,
                });
            }
        }
    }
}

fn block(half: DVec3, mass: f64, turn: DQuat) -> Articulation {
    let link = Link { inertia: solid(half, mass), ..link(None, Joint::Free, DVec3::ZERO, mass, DVec3::ZERO) };
    Articulation::new(Tree::new(vec![link]).expect("a tree"), &[(turn * (DVec3::Y * half.y), turn)], 1.0)
}

#[test]
fn a_block_slides_down_a_slope_as_coulomb_says_or_sticks() {
    let half = DVec3::new(0.2, 0.05, 0.3);
    for (degrees, friction) in [(30.0_f64, 0.2), (30.0, 0.4), (20.0, 0.1), (20.0, 0.5), (10.0, 0.2)] {
        let angle = degrees.to_radians();
        let turn = DQuat::from_rotation_x(-angle);
        let (normal, up) = (turn * DVec3::Y, turn * DVec3::Z);
        let mut body = block(half, 4.0, turn);
        let (mut around, mut find) = (Around::default(), corners(half, normal, friction));
        for _ in 0..200 {
            body.step(&mut around, 0.01, 2, &mut find);
        }
        let speed = -body.motion_at(0, body.place(0).0).0.dot(up);
        let wanted = (2.0 * G * (real::sin(angle) - friction * real::cos(angle))).max(0.0);
        // Where it sticks, contacts that give a little (SOFT) let it creep.
        assert!(
            (speed - wanted).abs() < 0.01 * wanted + 2e-3,
            "{degrees} degrees, {friction}: {speed} m/s, not {wanted}"
        );
    }
}

#[test]
fn a_standing_box_presses_with_its_weight_under_its_centre() {
    let (half, mass) = (DVec3::new(0.1, 0.5, 0.15), 60.0);
    let mut body = block(half, mass, DQuat::IDENTITY);
    // Leant on, not over: the pressure moves by the moment over the weight.
    body.push(0, DVec3::X * 50.0, DVec3::Y * 0.5, DVec3::ZERO);
    let (mut around, mut find) = (Around::default(), corners(half, DVec3::Y, 0.8));
    for _ in 0..100 {
        body.step(&mut around, 0.01, 2, &mut find);
    }
    let up: f64 = around.met.iter().map(|met| met.impulse.y).sum();
    let at: f64 = around.met.iter().map(|met| met.impulse.y * met.touch.at.x).sum::<f64>() / up;
    let along: f64 = around.met.iter().map(|met| met.impulse.x).sum();
    assert!((up / (mass * G * 0.01) - 1.0).abs() < 1e-3, "{up} N s");
    assert!((at - 50.0 * 0.5 / (mass * G)).abs() < 1e-3, "at {at} m");
    assert!((along + 0.5).abs() < 1e-3, "held by {along} N s");
    let sunk = half.y - body.place(0).0.y;
    assert!((0.0..0.0015).contains(&sunk), "{sunk} m deep");
}

/// A foot, a shank and a trunk, held upright by springs.
fn upright(half: DVec3) -> Articulation {
    let foot = Link { inertia: solid(half, 3.0), ..link(None, Joint::Free, DVec3::ZERO, 3.0, DVec3::ZERO) };
    let shank = link(Some(0), Joint::Ball, DVec3::Y * half.y, 8.0, DVec3::Y * 0.2);
    let trunk = link(Some(1), Joint::Ball, DVec3::Y * 0.4, 40.0, DVec3::Y * 0.3);
    let tree = Tree::new(vec![foot, shank, trunk]).expect("a tree");
    Articulation::new(tree, &[(DVec3::Y * half.y, DQuat::IDENTITY); 3], 1e4)
}

/// What is from nowhere in the momentum that a standing body gains in a tick, and in its moment about the world's origin: the most of 3 s,
/// as shares of what the weight gives, at a lever of 1 m. The platform under it turns to `most` rad and back.
fn from_nowhere(most: f64, dt: f64) -> [f64; 2] {
    let (half, mass) = (DVec3::new(0.25, 0.04, 0.25), 51.0);
    let mut body = upright(half);
    let mut around = Around::default();
    let (mut off, mut gained, mut given) = ([0.0_f64; 2], [0.0_f64; 2], [0.0_f64; 2]);
    for tick in 0..(3.0 / dt).round() as usize {
        let tilt = |time: f64| DQuat::from_rotation_z(most * real::sin(3.0 * time));
        let time = tick as f64 * dt;
        for link in [1, 2] {
            let turn = body.place(link - 1).1.inverse() * body.place(link).1;
            body.drive(link, DVec3::splat(4000.0), DVec3::splat(200.0), -turn.to_scaled_axis());
        }
        let before = body.momentum();
        let spin = (tilt(time + dt) * tilt(time).inverse()).to_scaled_axis() / dt;
        let (weight, mut weighed) = (DVec3::NEG_Y * (mass * G * dt), DVec3::ZERO);
        body.step(&mut around, dt, 2, &mut |body, loose, share, touches| {
            weighed += centre(body).cross(0.5 * weight);
            let normal = tilt(time + share * dt) * DVec3::Y;
            corners(half, normal, 0.9)(body, loose, share, touches);
            touches.iter_mut().for_each(|touch| touch.surface = spin.cross(touch.at));
        });
        let pressed: DVec3 = around.met.iter().map(|met| met.impulse).sum();
        let moment: DVec3 = around.met.iter().map(|met| met.touch.at.cross(met.impulse)).sum();
        let now = body.momentum();
        let gains = [now.linear - before.linear, now.angular - before.angular];
        let gives = [pressed, moment];
        for (index, (gain, give)) in gains.into_iter().zip(gives).enumerate() {
            off[index] = off[index].max((gain - give - [weight, weighed][index]).length() / weight.length());
            gained[index] = gained[index].max(gain.length() / weight.length());
            given[index] = given[index].max(give.length() / weight.length());
        }
    }
    assert!(body.place(2).1.angle_between(DQuat::IDENTITY) < 0.3, "it stands: {:?}", body.place(2));
    assert!(given[0] > 0.9 && (most == 0.0 || gained[0] > 0.02 && gained[1] > 0.02), "{given:?}, {gained:?}");
    off
}

#[test]
fn what_the_ground_gives_is_what_the_body_gains_at_rest_and_on_a_platform_that_turns() {
    let rest = from_nowhere(0.0, 0.01);
    assert!(rest[0] < 1e-9 && rest[1] < 1e-9, "{rest:?}");
    let (coarse, fine) = (from_nowhere(0.12, 0.01), from_nowhere(0.12, 0.0025));
    assert!(coarse[0] < 1e-9 && fine[0] < 1e-9, "{coarse:?}, {fine:?}");
    // A turning body's moment is integrated to first order: it is off by thousandths of a millimetre of the weight's lever, and by less the
    // shorter the tick. A force that acted beside where it is said to would be off by as much at any.
    assert!(coarse[1] < 1e-5 && fine[1] < 0.5 * coarse[1], "{coarse:?}, {fine:?}");
}

fn ball(mass: f64, place: DVec3, velocity: DVec3) -> Loose {
    let inertia = DVec3::splat(0.4 * mass * 0.01);
    Loose { mass, inertia, place, turn: DQuat::IDENTITY, velocity, spin: DVec3::ZERO, falls: false }
}

#[test]
fn what_a_ball_gives_it_loses() {
    let mut body = tumbling();
    let mut around = Around::with(vec![ball(1.5, DVec3::new(0.0, 0.35, 0.2), DVec3::NEG_Z * 8.0)], Vec::new());
    let (was, before) = (body.momentum(), around.loose[0].velocity);
    let mut given = DVec3::ZERO;
    for _ in 0..20 {
        body.step(&mut around, 0.005, 2, &mut |body, loose, _, touches| {
            let at = body.place(1).0 + DVec3::Z * 0.05;
            let apart = loose[0].place - at;
            let touch = Touch {
                link: 1,
                key: 1,
                at,
                normal: DVec3::NEG_Z,
                gap: apart.z - 0.1,
                friction: 0.5,
                bounce: 0.3,
                surface: DVec3::ZERO,
                other: Some(0),
            };
            touches.push(touch);
        });
        given += around.met.iter().map(|met| met.impulse).sum::<DVec3>();
    }
    let gained = body.momentum().linear - was.linear - DVec3::NEG_Y * (28.0 * G * 0.1);
    let lost = 1.5 * (before - around.loose[0].velocity);
    assert!(given.z < -5.0, "it hits: {given}");
    assert!(
        gained.distance(given) < 1e-9 && lost.distance(given) < 1e-9,
        "given {given}, gained {gained}, lost {lost}"
    );
}

#[test]
fn a_box_held_in_two_hands_is_carried_and_nothing_is_won_or_lost() {
    let hand = |x: f64| link(Some(0), Joint::Ball, DVec3::X * x, 1.0, DVec3::Z * 0.2);
    let mut body = made(vec![link(None, Joint::Free, DVec3::ZERO, 20.0, DVec3::ZERO), hand(0.2), hand(-0.2)]);
    let held = Loose { inertia: DVec3::splat(0.3), falls: true, ..ball(12.0, DVec3::Z * 0.4, DVec3::ZERO) };
    let weld = |link: usize, x: f64| Weld {
        link,
        body: 0,
        at: [DVec3::new(-x, 0.0, 0.4), DVec3::ZERO],
        turn: DQuat::IDENTITY,
    };
    let mut around = Around::with(vec![held], vec![weld(1, 0.2), weld(2, -0.2)]);
    for _ in 0..50 {
        body.push(0, DVec3::X * 30.0, DVec3::ZERO, DVec3::ZERO);
        body.step(&mut around, 0.01, 2, &mut |_, _, _, _| {});
        body.let_go();
    }
    let whole = body.momentum().linear + 12.0 * around.loose[0].velocity;
    assert!(whole.distance(DVec3::new(15.0, -34.0 * G * 0.5, 0.0)) < 1e-6, "{whole}");
    for (link, x) in [(1, 0.2), (2, -0.2)] {
        let (origin, turn) = body.place(link);
        let gap = (origin + turn * DVec3::new(-x, 0.0, 0.4)).distance(around.loose[0].place);
        assert!(gap < 0.003, "{gap} m apart");
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
        let mut body = made(vec![fixed(), thigh, shank]);
        let mut around = Around::default();
        let (mut past, mut moved) = (0.0_f64, 0.0_f64);
        for _ in 0..300 {
            body.let_go();
            body.push(0, DVec3::Y * (G * 1e7), DVec3::ZERO, DVec3::ZERO);
            body.push(1, DVec3::ZERO, DVec3::ZERO, torque);
            for link in 1..3 {
                body.drive(link, DVec3::ZERO, DVec3::splat(1.5), DVec3::ZERO);
            }
            body.step(&mut around, 0.01, 2, &mut |_, _, _, _| {});
            let turned = body.relative[1].to_scaled_axis();
            moved = moved.max(turned.length());
            past = past.max(turned.x - 0.3).max(-1.5 - turned.x).max(turned.z - 0.6).max(-0.3 - turned.z);
            past = past.max(-body.angle[2]).max(body.angle[2] - 2.4);
        }
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
            let mut body = made(vec![fixed(), thigh]);
            let mut around = Around::default();
            let (mut past, mut moved) = (0.0_f64, 0.0_f64);
            for _ in 0..300 {
                body.let_go();
                body.push(0, DVec3::Y * (G * 1e7), DVec3::ZERO, DVec3::ZERO);
                body.push(1, DVec3::ZERO, DVec3::ZERO, torque);
                body.drive(1, DVec3::ZERO, DVec3::splat(1.5), DVec3::ZERO);
                body.step(&mut around, 0.01, 2, &mut |_, _, _, _| {});
                moved = moved.max(body.relative[1].to_scaled_axis().length());
                for ((angle, _), [low, high]) in axes.angles(body.relative[1]).into_iter().zip(range) {
                    past = past.max(angle - high).max(low - angle);
                }
            }
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

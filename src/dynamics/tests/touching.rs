//! What bodies give each other where they touch: the ground, balls, a box in the hands.

use super::*;

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

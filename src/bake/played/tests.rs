//! Contacts, held feet and drift of played runs that are made up.

use super::*;
use crate::maths::real;
use crate::measure::fixture;
use crate::model::{Role, report::Part};

/// Two seconds of a stand in which the left foot rolls onto its ball from 1 s on, over a toe joint that is a link's, and slides by
/// `slides` m in the first half second.
fn rolling(body: &Body, anatomy: &Anatomy, slides: f64) -> Vec<BodyPose> {
    let leg = &anatomy.legs[0];
    let toe = leg.toe.expect("it has toes");
    let mut stand = BodyPose::rest(body);
    for leg in &anatomy.legs {
        stand.turns[leg.upper] = DQuat::from_rotation_x(-0.3);
        stand.turns[leg.lower] = DQuat::from_rotation_x(0.3);
    }
    let lowest = stand.positions(body)[leg.foot].y - body.joints[leg.foot].rest.y;
    stand.hips.y -= lowest;
    let positions = stand.positions(body);
    let ball = positions[toe];
    (0..=200)
        .map(|tick| {
            let time = 0.01 * f64::from(tick);
            let mut pose = stand.clone();
            let pitch = 0.4 * crate::maths::curve::smooth3((time - 1.0) / 0.8);
            let now = leg::Foot::of(body, &pose, &positions, Side::Left);
            let foot = DQuat::from_rotation_x(pitch) * now.foot;
            // Half a millimetre of tremble on top.
            let tremble = DVec3::new(0.0005 * real::sin(37.0 * time), 0.0, slides * (2.0 * time).min(1.0));
            let ankle = ball - DQuat::from_rotation_x(pitch) * (ball - now.ankle) + tremble;
            leg::reach(
                body,
                anatomy,
                &mut pose,
                &positions,
                (Side::Left, None),
                &leg::Foot { ankle, foot, toe: now.toe },
            );
            pose
        })
        .collect()
}

/// Of that, with the left toes so far (rad) off the ground.
fn played(slides: f64, raised: f64) -> (Body, Anatomy, Played) {
    let body = fixture::body();
    let anatomy = Anatomy::new(&body);
    let mut poses = rolling(&body, &anatomy, slides);
    let toes = [Role::LeftToes, Role::RightToes].map(|role| body.joint(role).expect("toes"));
    poses.iter_mut().for_each(|pose| pose.turns[toes[0]] = DQuat::from_rotation_x(-raised) * pose.turns[toes[0]]);
    let mut joints: Vec<usize> = vec![0];
    joints.extend(anatomy.legs.iter().flat_map(|leg| [leg.upper, leg.lower, leg.foot]).chain(toes));
    let run = Run {
        body: &body,
        anatomy: &anatomy,
        terrain: &Terrain::flat(),
        dt: 0.01,
        pressed: &vec![[4.0; 2]; poses.len()],
        stood: &[vec![[0.0, 2.0]], vec![[0.0, 2.0]]],
        joints: &joints,
    };
    let played = Played::new(&run, poses, 200);
    (body, anatomy, played)
}

#[test]
fn a_foot_that_rolls_over_its_ball_holds_the_ball_while_the_heel_rises_as_it_did() {
    let (body, anatomy, played) = played(0.0, 0.0);
    let own: Vec<FootContact> = played.contacts().into_iter().filter(|one| one.side == Side::Left).collect();
    let parts: Vec<Part> = own.iter().map(|one| one.part).collect();
    assert_eq!(parts, [Part::Flat, Part::Ball], "{own:?}");
    assert!(own[0].end == own[1].start && (1.0..1.3).contains(&own[0].end) && own[1].end > 1.99, "{own:?}");
    let toe = anatomy.legs[0].toe.expect("toes");
    let (mut first, mut last) = (None, None::<DVec3>);
    for sample in 0..=800 {
        let time = 0.0025 * f64::from(sample);
        let pose = played.pose_at(&body, &anatomy, &Terrain::flat(), time);
        let positions = pose.positions(&body);
        let at = *first.get_or_insert(positions[toe]);
        assert!(positions[toe].distance(at) < 1e-6, "the ball moves by {} m at {time} s", positions[toe].distance(at));
        // No jump of the ankle: a heel that rises by 5 cm in 0.8 s goes at 0.1 m/s or so.
        let ankle = positions[anatomy.legs[0].foot];
        assert!(last.is_none_or(|last| last.distance(ankle) < 0.4 * 0.0025), "the ankle jumps at {time} s");
        last = Some(ankle);
        let off = drift::between(&body, played.joints(), &played.run_at(time), &pose);
        assert!(off.within(&MOST), "{off:?} at {time} s");
    }
}

#[test]
fn a_foot_that_stands_flat_with_its_toes_off_the_ground_is_in_contact_all_along() {
    let (body, anatomy, played) = played(0.0, 5f64.to_radians());
    let toe = anatomy.legs[0].toe.expect("toes");
    let first = played.contacts().into_iter().find(|one| one.side == Side::Left).expect("it stands");
    assert!(first.part == Part::Flat && first.start == 0.0 && first.end > 0.99, "{first:?}");
    let pose = played.pose_at(&body, &anatomy, &Terrain::flat(), 0.5);
    let off = drift::between(&body, &[toe], &played.run_at(0.5), &pose);
    assert!(off.within(&MOST), "the toes are where they were: {off:?}");
}

#[test]
fn a_foot_that_creeps_is_held_in_pieces_and_one_that_slides_not_at_all() {
    let pieces = |slides: f64| {
        let contacts = played(slides, 0.0).2.contacts();
        contacts
            .iter()
            .filter(|one| one.side == Side::Left && one.end < 0.55)
            .map(|one| one.end - one.start)
            .sum::<f64>()
    };
    let (creeps, slips) = (pieces(0.015), pieces(0.1));
    assert!((0.2..0.5).contains(&creeps), "{creeps} s of contact while it creeps by 3 cm a second");
    assert!(slips < 1e-9, "{slips} s of contact while it slides by 20 cm a second");
}

#[test]
fn the_least_shift_goes_as_far_along_each_leg_as_it_must() {
    let (a, b) = (DVec3::new(0.3, -1.0, 0.0).normalize(), DVec3::new(-0.2, -1.0, 0.3).normalize());
    let shift = least(&[(a, 0.003), (b, -0.001)]);
    assert!((shift.dot(a) - 0.003).abs() < 5e-4 && (shift.dot(b) + 0.001).abs() < 5e-4, "{shift}");
    assert!(least(&[(a, 0.003), (a, 0.003)]).length() < 0.0031, "the same leg twice asks for no more");
    assert_eq!(least(&[]), DVec3::ZERO);
}

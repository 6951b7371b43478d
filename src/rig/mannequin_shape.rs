//! The built-in rig's body as tables of rings: trunk, neck, head, and the left arm and leg, whose mirror image is the right.
//!
//! Metres, scenario axes, for a height of 1.7 m. Limbs begin in balls about their joints, so that a raised arm or
//! thigh turns in its socket; dark bands at the joints are slightly sunk.

use super::mannequin::{Bone, SHOULDER, arm_direction, bone};
use super::mannequin_mesh::{Ring, Row, Share, Surface, chain, ease, rings};
use crate::maths::real;
use crate::model::Role;
use glam::DVec3;

/// Index of the material: skin, joint bands, shoes.
const BODY: usize = 0;
const BAND: usize = 1;
const SHOE: usize = 2;

/// The whole surface, not yet shaded.
pub(super) fn surface(bones: &[Bone]) -> Surface {
    let mut surface = Surface::new(3);
    trunk(&mut surface, bones);
    neck_and_head(&mut surface, bones);
    let first = surface.positions.len();
    let first_triangles: Vec<usize> = surface.triangles.iter().map(Vec::len).collect();
    leg(&mut surface, bones);
    foot(&mut surface, bones);
    arm(&mut surface, bones);
    hand(&mut surface, bones);
    surface.mirror(first, &first_triangles, &|joint| {
        let name = bones[joint].name;
        Role::from_name(name).map_or(joint, |role| bone(bones, role.mirrored()))
    });
    surface
}

/// A row of a symmetric level ring: height, z of the centre, half width, front, back, power, material.
type Level = (f64, f64, f64, f64, f64, f64, usize);

fn level(rows: &[Level]) -> Vec<Ring> {
    rows.iter()
        .map(|&(y, z, side, front, back, power, material)| {
            Ring::level(DVec3::new(0.0, y, z), [side, side, front, back], power, material)
        })
        .collect()
}

fn trunk(surface: &mut Surface, bones: &[Bone]) {
    const TABLE: &[Level] = &[
        (0.822, -0.004, 0.004, 0.010, 0.010, 2.0, BODY),
        (0.827, -0.004, 0.020, 0.032, 0.036, 2.0, BODY),
        (0.845, -0.004, 0.044, 0.058, 0.070, 2.1, BODY),
        (0.878, -0.004, 0.092, 0.078, 0.098, 2.2, BODY),
        (0.918, -0.004, 0.137, 0.090, 0.114, 2.3, BODY),
        (0.960, -0.003, 0.154, 0.094, 0.112, 2.3, BODY),
        (0.998, -0.002, 0.150, 0.092, 0.098, 2.3, BODY),
        (1.030, 0.000, 0.139, 0.089, 0.086, 2.3, BODY),
        (1.045, 0.000, 0.132, 0.085, 0.080, 2.3, BODY),
        (1.048, 0.000, 0.124, 0.078, 0.073, 2.3, BAND),
        (1.066, 0.000, 0.121, 0.077, 0.071, 2.3, BAND),
        (1.069, 0.000, 0.126, 0.083, 0.077, 2.3, BODY),
        (1.090, 0.001, 0.123, 0.086, 0.077, 2.3, BODY),
        (1.130, 0.001, 0.123, 0.090, 0.079, 2.3, BODY),
        (1.165, 0.000, 0.129, 0.093, 0.083, 2.3, BODY),
        (1.186, -0.001, 0.134, 0.093, 0.085, 2.3, BODY),
        (1.189, -0.001, 0.128, 0.087, 0.080, 2.3, BAND),
        (1.206, -0.002, 0.131, 0.090, 0.083, 2.3, BAND),
        (1.209, -0.002, 0.142, 0.102, 0.091, 2.3, BODY),
        (1.245, -0.004, 0.154, 0.115, 0.100, 2.4, BODY),
        (1.285, -0.007, 0.163, 0.121, 0.107, 2.4, BODY),
        (1.325, -0.010, 0.168, 0.113, 0.110, 2.4, BODY),
        (1.360, -0.013, 0.168, 0.094, 0.106, 2.3, BODY),
        (1.388, -0.016, 0.158, 0.074, 0.094, 2.2, BODY),
        (1.410, -0.018, 0.132, 0.058, 0.076, 2.1, BODY),
        (1.428, -0.019, 0.096, 0.052, 0.064, 2.0, BODY),
        (1.442, -0.018, 0.066, 0.051, 0.056, 2.0, BODY),
        (1.447, -0.018, 0.050, 0.045, 0.048, 2.0, BODY),
        (1.445, -0.018, 0.020, 0.020, 0.020, 2.0, BODY),
    ];
    let [hips, spine, chest, upper, left, right] =
        [Role::Hips, Role::Spine, Role::Chest, Role::UpperChest, Role::LeftShoulder, Role::RightShoulder]
            .map(|role| bone(bones, role));
    let weigh = move |place: DVec3| {
        let mut shares =
            chain(&[(hips, 0.0, 1.0), (spine, 1.058, 0.05), (chest, 1.18, 0.05), (upper, 1.28, 0.05)], place.y);
        // The tops of the shoulders follow the collar bones half way.
        let collar = 0.5 * ease((place.x.abs() - 0.05) / 0.11) * ease((place.y - 1.27) / 0.10);
        if collar > 0.01 {
            for share in &mut shares {
                share.1 *= 1.0 - collar;
            }
            shares.push((if place.x > 0.0 { left } else { right }, collar));
        }
        shares
    };
    surface.tube(&level(TABLE), 0, 32, &weigh);
}

fn neck_and_head(surface: &mut Surface, bones: &[Bone]) {
    const NECK: &[Level] = &[
        (1.405, -0.020, 0.020, 0.020, 0.020, 2.0, BAND),
        (1.412, -0.020, 0.052, 0.048, 0.050, 2.0, BAND),
        (1.445, -0.016, 0.052, 0.048, 0.052, 2.0, BAND),
        (1.485, -0.008, 0.050, 0.047, 0.053, 2.0, BAND),
        (1.525, 0.000, 0.052, 0.050, 0.056, 2.0, BAND),
        (1.550, 0.002, 0.020, 0.020, 0.020, 2.0, BAND),
    ];
    const HEAD: &[Level] = &[
        (1.478, 0.062, 0.006, 0.006, 0.006, 2.0, BODY),
        (1.478, 0.056, 0.022, 0.022, 0.022, 2.1, BODY),
        (1.486, 0.044, 0.040, 0.042, 0.044, 2.2, BODY),
        (1.504, 0.030, 0.052, 0.060, 0.062, 2.3, BODY),
        (1.528, 0.018, 0.061, 0.074, 0.078, 2.3, BODY),
        (1.556, 0.012, 0.067, 0.081, 0.090, 2.3, BODY),
        (1.586, 0.010, 0.072, 0.084, 0.099, 2.3, BODY),
        (1.616, 0.008, 0.074, 0.085, 0.102, 2.2, BODY),
        (1.644, 0.004, 0.071, 0.080, 0.096, 2.1, BODY),
        (1.668, 0.000, 0.061, 0.067, 0.081, 2.0, BODY),
        (1.686, -0.003, 0.045, 0.048, 0.058, 2.0, BODY),
        (1.697, -0.004, 0.025, 0.026, 0.030, 2.0, BODY),
        (1.700, -0.005, 0.005, 0.005, 0.006, 2.0, BODY),
    ];
    let [upper, neck, head] = [Role::UpperChest, Role::Neck, Role::Head].map(|role| bone(bones, role));
    surface.tube(&level(NECK), 0, 20, &move |place| {
        chain(&[(upper, 0.0, 1.0), (neck, 1.425, 0.02), (head, 1.505, 0.03)], place.y)
    });
    let first = surface.positions.len();
    surface.tube(&level(HEAD), 1, 28, &move |_| vec![(head, 1.0)]);
    for place in &mut surface.positions[first..] {
        *place = face(*place);
    }
}

/// A hint of a face: a nose, sockets for the eyes, flat cheeks.
fn face(place: DVec3) -> DVec3 {
    if place.z < 0.03 {
        return place;
    }
    let bump = |x: f64, y: f64, wide: f64, high: f64| {
        real::exp(-((place.x.abs() - x) / wide).powi(2) - ((place.y - y) / high).powi(2))
    };
    let nose = 0.015 * bump(0.0, 1.556, 0.013, 0.020) + 0.008 * bump(0.0, 1.584, 0.012, 0.024);
    let sockets = -0.007 * bump(0.033, 1.590, 0.022, 0.020);
    let brow = 0.004 * bump(0.024, 1.617, 0.034, 0.013);
    let jaw = -0.003 * bump(0.036, 1.535, 0.020, 0.030);
    place + DVec3::Z * (nose + sockets + brow + jaw)
}

fn leg(surface: &mut Surface, bones: &[Bone]) {
    // Down from the hip joint; half extents outwards, inwards, front, back.
    const TABLE: &[Row] = &[
        (-0.092, [0.0, 0.0], [0.006, 0.006, 0.006, 0.006], 2.0, BODY),
        (-0.086, [0.0, 0.0], [0.032, 0.030, 0.032, 0.034], 2.0, BODY),
        (-0.065, [0.0, 0.0], [0.060, 0.054, 0.062, 0.068], 2.0, BODY),
        (-0.030, [0.0, 0.0], [0.079, 0.070, 0.082, 0.093], 2.0, BODY),
        (0.015, [0.0, 0.0], [0.087, 0.079, 0.091, 0.104], 2.0, BODY),
        (0.060, [0.0, 0.0], [0.088, 0.082, 0.094, 0.102], 2.0, BODY),
        (0.115, [0.0, 0.002], [0.085, 0.080, 0.094, 0.092], 2.0, BODY),
        (0.180, [0.0, 0.004], [0.079, 0.074, 0.090, 0.081], 2.0, BODY),
        (0.245, [0.0, 0.005], [0.071, 0.067, 0.081, 0.071], 2.0, BODY),
        (0.305, [0.0, 0.004], [0.062, 0.059, 0.070, 0.061], 2.0, BODY),
        (0.350, [0.0, 0.003], [0.055, 0.053, 0.061, 0.054], 2.0, BODY),
        (0.374, [0.0, 0.003], [0.052, 0.050, 0.058, 0.050], 2.0, BODY),
        (0.378, [0.0, 0.003], [0.046, 0.045, 0.053, 0.045], 2.1, BAND),
        (0.396, [0.0, 0.004], [0.047, 0.046, 0.056, 0.044], 2.1, BAND),
        (0.415, [0.0, 0.004], [0.047, 0.046, 0.057, 0.044], 2.1, BAND),
        (0.434, [0.0, 0.004], [0.046, 0.045, 0.054, 0.046], 2.1, BAND),
        (0.450, [0.0, 0.003], [0.044, 0.043, 0.049, 0.047], 2.1, BAND),
        (0.454, [0.0, 0.003], [0.049, 0.047, 0.053, 0.053], 2.1, BODY),
        (0.485, [0.0, 0.000], [0.053, 0.051, 0.049, 0.064], 2.0, BODY),
        (0.525, [0.001, -0.003], [0.057, 0.055, 0.046, 0.075], 2.0, BODY),
        (0.565, [0.001, -0.005], [0.057, 0.054, 0.044, 0.077], 2.0, BODY),
        (0.610, [0.0, -0.007], [0.051, 0.049, 0.042, 0.070], 2.0, BODY),
        (0.660, [0.0, -0.009], [0.043, 0.042, 0.039, 0.056], 2.0, BODY),
        (0.710, [0.0, -0.011], [0.037, 0.036, 0.037, 0.044], 2.0, BODY),
        (0.760, [0.0, -0.012], [0.034, 0.034, 0.036, 0.038], 2.0, BODY),
        (0.783, [0.0, -0.012], [0.035, 0.035, 0.037, 0.039], 2.0, BODY),
        (0.786, [0.0, -0.012], [0.030, 0.030, 0.033, 0.034], 2.0, BAND),
        (0.815, [0.0, -0.012], [0.031, 0.031, 0.036, 0.036], 2.0, BAND),
        (0.840, [0.0, -0.012], [0.028, 0.028, 0.036, 0.034], 2.0, BAND),
        (0.855, [0.0, -0.012], [0.006, 0.006, 0.006, 0.006], 2.0, BAND),
    ];
    let [upper, lower, foot] = [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot].map(|role| bone(bones, role));
    let hip = bones[upper].place;
    let table = rings(hip, DVec3::NEG_Y, DVec3::X, DVec3::Z, TABLE);
    surface.tube(&table, 0, 20, &move |place| {
        chain(&[(upper, -1.0, 1.0), (lower, 0.415, 0.042), (foot, 0.825, 0.02)], hip.y - place.y)
    });
}

fn foot(surface: &mut Surface, bones: &[Bone]) {
    // Along z from the ankle; offsets to the left and up from 0.03 over the ground; half extents left, right, up, down.
    const TABLE: &[Row] = &[
        (-0.076, [0.0, 0.0], [0.006, 0.006, 0.006, 0.010], 2.3, SHOE),
        (-0.074, [0.0, 0.0], [0.018, 0.018, 0.022, 0.034], 2.4, SHOE),
        (-0.064, [0.0, 0.0], [0.030, 0.030, 0.040, 0.038], 2.5, SHOE),
        (-0.044, [0.0, 0.0], [0.036, 0.036, 0.056, 0.040], 2.5, SHOE),
        (-0.016, [0.0, 0.0], [0.039, 0.038, 0.070, 0.040], 2.4, SHOE),
        (0.016, [0.0, 0.0], [0.039, 0.038, 0.071, 0.040], 2.3, SHOE),
        (0.044, [0.0, 0.0], [0.041, 0.039, 0.056, 0.040], 2.3, SHOE),
        (0.078, [0.0, 0.0], [0.045, 0.042, 0.040, 0.040], 2.4, SHOE),
        (0.110, [0.0, 0.0], [0.049, 0.045, 0.028, 0.040], 2.5, SHOE),
        (0.140, [0.0, 0.0], [0.049, 0.046, 0.021, 0.040], 2.6, SHOE),
        (0.168, [-0.003, 0.0], [0.042, 0.042, 0.016, 0.040], 2.6, SHOE),
        (0.186, [-0.006, -0.002], [0.030, 0.032, 0.010, 0.036], 2.5, SHOE),
        (0.194, [-0.008, -0.006], [0.016, 0.018, 0.004, 0.020], 2.3, SHOE),
        (0.196, [-0.008, -0.010], [0.004, 0.004, 0.002, 0.006], 2.0, SHOE),
    ];
    let [foot, toes] = [Role::LeftFoot, Role::LeftToes].map(|role| bone(bones, role));
    let (ankle, ball) = (bones[foot].place, bones[toes].place);
    let from = DVec3::new(ankle.x, 0.03, ankle.z);
    let first = surface.positions.len();
    let table = rings(from, DVec3::Z, DVec3::X, DVec3::Y, TABLE);
    surface.tube(&table, 0, 20, &move |place| chain(&[(foot, -1.0, 1.0), (toes, ball.z, 0.016)], place.z));
    for place in &mut surface.positions[first..] {
        // The sole is flat.
        place.y = place.y.max(0.0);
    }
}

fn arm(surface: &mut Surface, bones: &[Bone]) {
    // Down from the shoulder joint; half extents outwards, inwards, front, back.
    const TABLE: &[Row] = &[
        (-0.062, [-0.006, 0.0], [0.006, 0.006, 0.006, 0.006], 2.0, BODY),
        (-0.057, [-0.006, 0.0], [0.026, 0.026, 0.026, 0.026], 2.0, BODY),
        (-0.040, [-0.005, 0.0], [0.046, 0.046, 0.047, 0.047], 2.0, BODY),
        (-0.010, [-0.003, 0.0], [0.056, 0.055, 0.058, 0.057], 2.0, BODY),
        (0.025, [0.0, 0.0], [0.058, 0.056, 0.060, 0.057], 2.0, BODY),
        (0.065, [0.0, 0.0], [0.056, 0.050, 0.055, 0.052], 2.0, BODY),
        (0.110, [0.0, 0.0], [0.048, 0.046, 0.049, 0.047], 2.0, BODY),
        (0.155, [0.0, 0.001], [0.043, 0.043, 0.048, 0.044], 2.0, BODY),
        (0.200, [0.0, 0.001], [0.040, 0.040, 0.045, 0.042], 2.0, BODY),
        (0.236, [0.0, 0.0], [0.037, 0.037, 0.040, 0.038], 2.0, BODY),
        (0.257, [0.0, 0.0], [0.036, 0.036, 0.037, 0.037], 2.0, BODY),
        (0.260, [0.0, -0.001], [0.032, 0.032, 0.033, 0.033], 2.0, BAND),
        (0.272, [0.0, -0.002], [0.033, 0.033, 0.033, 0.035], 2.0, BAND),
        (0.285, [0.0, -0.002], [0.033, 0.033, 0.033, 0.036], 2.0, BAND),
        (0.298, [0.0, -0.002], [0.033, 0.033, 0.033, 0.035], 2.0, BAND),
        (0.309, [0.0, -0.001], [0.033, 0.033, 0.034, 0.034], 2.0, BAND),
        (0.312, [0.0, 0.0], [0.038, 0.037, 0.039, 0.037], 2.0, BODY),
        (0.340, [0.0, 0.0], [0.041, 0.039, 0.043, 0.038], 2.0, BODY),
        (0.380, [0.0, 0.0], [0.040, 0.037, 0.042, 0.037], 2.0, BODY),
        (0.425, [0.0, 0.0], [0.034, 0.032, 0.036, 0.033], 2.0, BODY),
        (0.470, [0.0, 0.0], [0.028, 0.027, 0.030, 0.029], 2.0, BODY),
        (0.511, [0.0, 0.0], [0.024, 0.024, 0.028, 0.027], 2.0, BODY),
        (0.514, [0.0, 0.0], [0.021, 0.021, 0.025, 0.024], 2.0, BAND),
        (0.534, [0.0, 0.0], [0.020, 0.020, 0.026, 0.025], 2.1, BAND),
        (0.541, [0.0, 0.0], [0.020, 0.020, 0.027, 0.026], 2.1, BAND),
        (0.544, [0.0, 0.0], [0.022, 0.022, 0.031, 0.030], 2.3, BODY),
        (0.572, [0.0, 0.001], [0.020, 0.021, 0.042, 0.039], 2.6, BODY),
        (0.605, [0.0, 0.001], [0.017, 0.018, 0.046, 0.043], 2.8, BODY),
        (0.630, [0.0, 0.001], [0.014, 0.016, 0.045, 0.043], 2.8, BODY),
        (0.640, [0.0, 0.001], [0.010, 0.011, 0.039, 0.037], 2.6, BODY),
        (0.643, [0.0, 0.001], [0.003, 0.003, 0.020, 0.020], 2.0, BODY),
    ];
    let [upper, lower, hand] = [Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand].map(|role| bone(bones, role));
    let down = arm_direction();
    let table = rings(SHOULDER, down, DVec3::new(-down.y, down.x, 0.0), DVec3::Z, TABLE);
    surface.tube(&table, 0, 18, &move |place| {
        chain(&[(upper, -1.0, 1.0), (lower, 0.285, 0.034), (hand, 0.532, 0.016)], (place - SHOULDER).dot(down))
    });
}

fn hand(surface: &mut Surface, bones: &[Bone]) {
    let down = arm_direction();
    let out = DVec3::new(-down.y, down.x, 0.0);
    let [hand, proximal, middle, tip, metacarpal, thumb, thumb_tip] = [
        Role::LeftHand,
        Role::LeftMiddleProximal,
        Role::LeftMiddleIntermediate,
        Role::LeftMiddleDistal,
        Role::LeftThumbMetacarpal,
        Role::LeftThumbProximal,
        Role::LeftThumbDistal,
    ]
    .map(|role| bone(bones, role));
    let fingers = move |place: DVec3| {
        let at = (place - SHOULDER).dot(down);
        chain(&[(hand, -1.0, 1.0), (proximal, 0.628, 0.010), (middle, 0.661, 0.008), (tip, 0.685, 0.008)], at)
    };
    for (ahead, length, radius) in
        [(0.031, 0.093, 0.0100), (0.0105, 0.103, 0.0105), (-0.010, 0.096, 0.0100), (-0.029, 0.076, 0.0088)]
    {
        let from = SHOULDER + down * 0.615 + DVec3::Z * ahead;
        let heading = (down + DVec3::Z * ahead * 1.2 - out * 0.06).normalize();
        finger(surface, from, heading, out, length, radius, &fingers);
    }
    let (root, knuckle, end) = (bones[metacarpal].place, bones[thumb].place, bones[thumb_tip].place);
    let heading = (end - root).normalize();
    let stations =
        [(metacarpal, -1.0, 1.0), (thumb, root.distance(knuckle), 0.008), (thumb_tip, root.distance(end), 0.006)];
    finger(surface, root - heading * 0.006, heading, out, 0.098, 0.0125, &move |place| {
        chain(&stations, (place - root).dot(heading))
    });
}

/// A finger: a rounded rod, a little thinner towards its end.
fn finger(
    surface: &mut Surface,
    from: DVec3,
    heading: DVec3,
    out: DVec3,
    length: f64,
    radius: f64,
    weigh: &dyn Fn(DVec3) -> Vec<Share>,
) {
    let left = (out - heading * out.dot(heading)).normalize_or(DVec3::X);
    // Left x front runs against the path, as in the other limbs.
    let front = left.cross(heading);
    let rows: Vec<Row> = [
        (0.0, 0.4),
        (0.04, 0.95),
        (0.35, 1.0),
        (0.42, 0.96),
        (0.65, 0.92),
        (0.8, 0.88),
        (0.9, 0.78),
        (0.96, 0.55),
        (1.0, 0.1),
    ]
    .iter()
    .map(|&(share, thick): &(f64, f64)| (share * length, [0.0, 0.0], [radius * thick; 4], 2.2, BODY))
    .collect();
    surface.tube(&rings(from, heading, left, front, &rows), 0, 8, weigh);
}

//! Left for right: the reflection in the plane x = 0. Exact, twice it is nothing, and it makes no minus nought.

use glam::{DMat3, DQuat, DVec2, DVec3};

/// A number that changes its sign.
pub fn flipped(number: f64) -> f64 {
    0.0 - number
}

/// A place, a velocity, a force.
pub fn point(point: DVec3) -> DVec3 {
    DVec3::new(flipped(point.x), point.y, point.z)
}

/// The same over the ground, (x, z).
pub fn ground(point: DVec2) -> DVec2 {
    DVec2::new(flipped(point.x), point.y)
}

/// A moment, a spin: what turns.
pub fn axial(axis: DVec3) -> DVec3 {
    DVec3::new(axis.x, flipped(axis.y), flipped(axis.z))
}

/// A rotation.
pub fn turn(turn: DQuat) -> DQuat {
    DQuat::from_xyzw(turn.x, flipped(turn.y), flipped(turn.z), turn.w)
}

/// A tensor, such as an inertia.
pub fn tensor(tensor: DMat3) -> DMat3 {
    let [x, y, z] = [tensor.x_axis, tensor.y_axis, tensor.z_axis];
    let along = |column: DVec3| DVec3::new(column.x, flipped(column.y), flipped(column.z));
    DMat3::from_cols(along(x), point(y), point(z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_turned_and_reflected_is_reflected_and_turned_the_other_way() {
        let (at, by) = (DVec3::new(0.3, -1.2, 2.0), DQuat::from_scaled_axis(DVec3::new(0.4, 0.7, -1.1)));
        assert!((turn(by) * point(at)).distance(point(by * at)) < 1e-15);
        let force = DVec3::new(5.0, 1.0, -3.0);
        assert_eq!(point(at).cross(point(force)), axial(at.cross(force)));
        assert_eq!((point(point(at)), turn(turn(by))), (at, by));
    }

    #[test]
    fn a_tensor_of_reflected_masses_is_the_reflected_tensor() {
        let of = |at: DVec3| DMat3::from_cols(at * at.x, at * at.y, at * at.z);
        let at = DVec3::new(0.3, -1.2, 2.0);
        assert_eq!(tensor(of(at)), of(point(at)));
    }

    #[test]
    fn nought_stays_nought() {
        assert!(point(DVec3::ZERO).x.is_sign_positive() && turn(DQuat::IDENTITY).y.is_sign_positive());
    }
}

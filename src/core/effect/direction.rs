//! Directions and rotations with derivatives.

use super::Dual;

/// Two unit vectors perpendicular to `axis`: the coordinate axis most nearly perpendicular to it, projected and
/// normalised, and the one that completes the right-handed triple (axis, first, second).
pub(super) fn across(axis: [f64; 3]) -> [[f64; 3]; 2] {
    let axis = nalgebra::Vector3::from(axis);
    let nearest = axis.iamin();
    let unit = nalgebra::Vector3::ith(nearest, 1.0);
    let first = (unit - axis * axis.dot(&unit)).normalize();
    [first.into(), axis.cross(&first).into()]
}

/// A vector rotated by `tilt_1`, then by `tilt_2`, about the two axes of [`across`] for `nominal`.
pub(super) fn tilted(
    direction: [Dual; 3],
    nominal: [f64; 3],
    tilt_1: Dual,
    tilt_2: Dual,
) -> [Dual; 3] {
    let [first, second] = across(nominal);
    turned(turned(direction, first, tilt_1), second, tilt_2)
}

/// A vector rotated about a unit vector (Rodrigues): `v cos + (t x v) sin + t (t.v) (1 - cos)`.
fn turned(v: [Dual; 3], t: [f64; 3], angle: Dual) -> [Dual; 3] {
    let (c, s) = (angle.cos(), angle.sin());
    let along = (v[0] * t[0] + v[1] * t[1] + v[2] * t[2]) * (-c + 1.0);
    let aside = [
        v[2] * t[1] - v[1] * t[2],
        v[0] * t[2] - v[2] * t[0],
        v[1] * t[0] - v[0] * t[1],
    ];
    std::array::from_fn(|k| v[k] * c + aside[k] * s + along * t[k])
}

/// Rotation `Rx(roll) Ry(pitch) Rz(yaw)`, row by row.
pub(super) fn rotation([roll, pitch, yaw]: [Dual; 3]) -> [[Dual; 3]; 3] {
    let [zero, one] = [0.0, 1.0].map(Dual::constant);
    let (c, s) = (roll.cos(), roll.sin());
    let about_x = [[one, zero, zero], [zero, c, -s], [zero, s, c]];
    let (c, s) = (pitch.cos(), pitch.sin());
    let about_y = [[c, zero, s], [zero, one, zero], [-s, zero, c]];
    let (c, s) = (yaw.cos(), yaw.sin());
    let about_z = [[c, -s, zero], [s, c, zero], [zero, zero, one]];
    product(&product(&about_x, &about_y), &about_z)
}

/// A vector rotated by Rodrigues' parameters, half of `turn` (rad): `v + (t x v + t x (t x v)/2) / (1 + t.t/4)`.
pub(super) fn rotated(v: [Dual; 3], turn: [Dual; 3]) -> [Dual; 3] {
    let cross = |a: [Dual; 3], b: [Dual; 3]| {
        let entry = |i: usize, k: usize| a[i] * b[k] - a[k] * b[i];
        [entry(1, 2), entry(2, 0), entry(0, 1)]
    };
    let once = cross(turn, v);
    let twice = cross(turn, once);
    let shrink = length_factor(turn);
    let shrink = shrink * shrink;
    std::array::from_fn(|k| v[k] + (once[k] + twice[k] * 0.5) * shrink)
}

/// Twice the vector part of the quaternion of the rotation with the Rodrigues parameters `turn / 2`.
pub(super) fn rotation_row(turn: [Dual; 3]) -> [Dual; 3] {
    let factor = length_factor(turn);
    turn.map(|angle| angle * factor)
}

/// `1 / sqrt(1 + t.t/4)`.
fn length_factor(t: [Dual; 3]) -> Dual {
    let square = (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]) * 0.25 + 1.0;
    square.sqrt().recip()
}

/// Product of two matrices.
pub(super) fn product(a: &[[Dual; 3]; 3], b: &[[Dual; 3]; 3]) -> [[Dual; 3]; 3] {
    let entry = |i: usize, k: usize| a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k];
    std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k)))
}

/// Roll, pitch and yaw of a rotation, as in [`rotation`].
pub(super) fn angles(r: &[[Dual; 3]; 3]) -> [Dual; 3] {
    let level = (r[1][2] * r[1][2] + r[2][2] * r[2][2]).sqrt();
    [
        (-r[1][2]).atan2(r[2][2]),
        r[0][2].atan2(level),
        (-r[0][1]).atan2(r[0][0]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilt_turns_and_keeps_the_length() {
        let axis = [0.0, 0.6, -0.8];
        let [first, second] = across(axis);
        assert_eq!(first, [1.0, 0.0, 0.0]);
        assert_eq!(second, [0.0, -0.8, -0.6]);
        let [a, b] = [0.1, -0.2].map(Dual::constant);
        let turned = tilted(axis.map(Dual::constant), axis, a, b).map(|d| d.value);
        let about =
            |v: [f64; 3], angle: f64| nalgebra::Rotation3::new(nalgebra::Vector3::from(v) * angle);
        let expected = about(second, -0.2) * about(first, 0.1) * nalgebra::Vector3::from(axis);
        assert!((nalgebra::Vector3::from(turned) - expected).norm() < 1e-15);
    }

    #[test]
    fn a_rotation_and_its_row_are_those_of_a_quaternion() {
        let turn = [0.3, -0.2, 0.5];
        let half = nalgebra::Vector3::from(turn) * 0.5;
        let quaternion = nalgebra::Quaternion::from_parts(1.0, half);
        let expected = nalgebra::UnitQuaternion::from_quaternion(quaternion);
        let v = nalgebra::Vector3::new(1.0, -2.0, 0.7);
        let turn = turn.map(Dual::constant);
        let rotated = rotated([v.x, v.y, v.z].map(Dual::constant), turn).map(|d| d.value);
        assert!((nalgebra::Vector3::from(rotated) - expected * v).norm() < 1e-15);
        let row = rotation_row(turn).map(|d| d.value);
        assert!((nalgebra::Vector3::from(row) - expected.vector() * 2.0).norm() < 1e-15);
    }

    #[test]
    fn angles_come_back() {
        let given = [0.3, -0.4, 2.9];
        let back = angles(&rotation(given.map(Dual::constant)));
        for k in 0..3 {
            assert!((back[k].value - given[k]).abs() < 1e-14);
        }
    }
}

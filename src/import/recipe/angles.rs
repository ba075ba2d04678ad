//! Conventions of orientations that are stated as three angles.

use std::str::FromStr;

use nalgebra::{UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Quantity, QuantityKind as Kind, Recipe};

/// Axes of three angles: `R = R1(a1) R2(a2) R3(a3)`, each a rotation about an axis of the frame that those before have turned. In
/// reverse order, they turn about fixed axes. Written as three letters, such as `zyx`; neighbours differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub struct AngleOrder([usize; 3]);

impl AngleOrder {
    /// The order of roll, pitch and yaw of an inclinometer: `R = Rx Ry Rz`.
    pub const XYZ: Self = Self([0, 1, 2]);
    /// The order of yaw, pitch and roll in aeronautics, and of A, B and C of KUKA: `R = Rz Ry Rx`.
    pub const ZYX: Self = Self([2, 1, 0]);

    /// Sorts values of the axes x, y, z into the order of the rotations, for orders about three different axes.
    #[must_use]
    pub fn sort<T: Copy>(self, of_axes: [T; 3]) -> [T; 3] {
        self.0.map(|axis| of_axes[axis])
    }

    /// The product of the rotations as a text, such as `Rz Ry Rx`.
    #[must_use]
    pub fn product(self) -> String {
        self.0.map(|axis| ["Rx", "Ry", "Rz"][axis]).join(" ")
    }

    /// Whether the rotations are about three different axes.
    fn has_three_axes(self) -> bool {
        self.0[0] != self.0[2]
    }

    /// Position of the rotation about an axis in the order.
    fn place_of(self, axis: usize) -> Option<usize> {
        self.0.iter().position(|known| *known == axis)
    }

    /// The orientation of three angles (rad).
    #[must_use]
    pub fn orientation(self, angles: [f64; 3]) -> UnitQuaternion<f64> {
        let turns = self
            .0
            .into_iter()
            .zip(angles)
            .map(|(axis, angle)| UnitQuaternion::from_scaled_axis(Vector3::ith(axis, angle)));
        turns.fold(UnitQuaternion::identity(), |whole, turn| whole * turn)
    }
}

impl FromStr for AngleOrder {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let axis = |letter: char| match letter.to_ascii_lowercase() {
            'x' => Some(0),
            'y' => Some(1),
            'z' => Some(2),
            _ => None,
        };
        let axes: Option<Vec<usize>> = text.chars().map(axis).collect();
        match axes.as_deref() {
            Some([first, second, third]) if first != second && second != third => {
                Ok(Self([*first, *second, *third]))
            }
            _ => Err(format!(
                "found {text:?}, expected the axes of three turns, such as zyx or zxz"
            )),
        }
    }
}

impl TryFrom<String> for AngleOrder {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl std::fmt::Display for AngleOrder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0
            .iter()
            .try_for_each(|axis| f.write_str(["x", "y", "z"][*axis]))
    }
}

impl From<AngleOrder> for String {
    fn from(order: AngleOrder) -> Self {
        order.to_string()
    }
}

/// Conventions of the angles of a recording; an absent one is `xyz`, as of an inclinometer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Angles {
    /// That of `angle_1_rad` to `angle_3_rad`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commanded: Option<AngleOrder>,
    /// That of `meas_angle_1_rad` to `meas_angle_3_rad`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<AngleOrder>,
}

impl Recipe {
    /// States the order of the angles. Those that were assigned for another order keep their axes.
    pub fn order_angles(&mut self, order: AngleOrder) {
        let stated = self.angles.unwrap_or_default();
        for (kind, before) in [
            (Kind::CommandedAngle, stated.commanded),
            (Kind::TrackedAngle, stated.measured),
        ] {
            let Some(before) =
                before.filter(|before| before.has_three_axes() && order.has_three_axes())
            else {
                continue;
            };
            for entry in &mut self.channels {
                let quantity = Quantity::parse(&entry.quantity).filter(|q| q.kind == kind);
                if let Some(quantity) = quantity
                    && let Some(index) = order.place_of(before.0[quantity.index])
                {
                    entry.quantity = Quantity { kind, index }.column();
                }
            }
        }
        self.angles = Some(Angles {
            commanded: Some(order),
            measured: Some(order),
        });
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::geometry::Pose;

    use super::*;

    #[test]
    fn all_conventions_are_products_of_turns() {
        let about = |axis: usize, angle: f64| {
            let mut angles = [0.0; 3];
            angles[axis] = angle;
            Pose::from_angles([0.0; 3], angles).orientation
        };
        let mut count = 0;
        for (i, first) in ["x", "y", "z"].iter().enumerate() {
            for (j, second) in ["x", "y", "z"].iter().enumerate() {
                for (k, third) in ["x", "y", "z"].iter().enumerate() {
                    let text = [*first, *second, *third].concat();
                    let Ok(order) = text.parse::<AngleOrder>() else {
                        assert!(i == j || j == k, "{text}");
                        continue;
                    };
                    count += 1;
                    assert_eq!(order.to_string(), text);
                    let expected = about(i, 0.3) * about(j, -0.5) * about(k, 0.7);
                    assert!(order.orientation([0.3, -0.5, 0.7]).angle_to(&expected) < 1e-12);
                }
            }
        }
        assert_eq!(count, 12);
        assert_eq!("ZYX".parse(), Ok(AngleOrder::ZYX));
        for text in ["", "xy", "xxy", "xyw", "xyzx"] {
            let error = text.parse::<AngleOrder>().expect_err(text);
            assert!(
                error.contains("expected the axes of three turns"),
                "{error}"
            );
        }
    }

    /// Reference: SciPy 1.17, Rotation.from_euler with capital letters, angles 0.3, -0.5, 0.7, quaternion w first.
    #[test]
    fn conventions_are_those_of_scipy() {
        for (text, expected) in [
            (
                "xyz",
                [
                    0.912627138986,
                    0.052132410890,
                    -0.279443894078,
                    0.293777172331,
                ],
            ),
            (
                "zyx",
                [
                    0.887272187680,
                    0.363237369728,
                    -0.180145857997,
                    0.219895766329,
                ],
            ),
            (
                "zxz",
                [
                    0.850300645292,
                    -0.242472351691,
                    0.049151579021,
                    0.464521359639,
                ],
            ),
            (
                "yxz",
                [
                    0.887272187680,
                    -0.180145857997,
                    0.219895766329,
                    0.363237369728,
                ],
            ),
        ] {
            let order: AngleOrder = text.parse().expect(text);
            let [w, x, y, z] = expected;
            let expected = Pose::from_parts([0.0; 3], [w, x, y, z]).orientation;
            let found = order.orientation([0.3, -0.5, 0.7]);
            assert!(found.angle_to(&expected) < 1e-9, "{text}");
        }
    }
}

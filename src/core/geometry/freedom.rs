//! Degrees of freedom of a platform.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Twist;

/// One coordinate of platform motion, in the base frame.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum Coordinate {
    /// Translation along x.
    X,
    /// Translation along y.
    Y,
    /// Translation along z.
    Z,
    /// Rotation about x.
    Rx,
    /// Rotation about y.
    Ry,
    /// Rotation about z.
    Rz,
}

impl Coordinate {
    /// All six, in the order of [`Twist`].
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::Rx, Self::Ry, Self::Rz];

    /// Index into a [`Twist`].
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// Name to display: "translation along x", "rotation about z".
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Self::X => "translation along x",
            Self::Y => "translation along y",
            Self::Z => "translation along z",
            Self::Rx => "rotation about x",
            Self::Ry => "rotation about y",
            Self::Rz => "rotation about z",
        }
    }
}

/// The set of coordinates in which a platform is free, in [`Twist`] order, without duplicates.
///
/// Spatial: all six. Planar: x, y, rz. Point mass: x, y, z. Planar point mass: x, y.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Freedom(Vec<Coordinate>);

impl Freedom {
    /// Freedom in the given coordinates; order and duplicates do not matter.
    #[must_use]
    pub fn new(coordinates: &[Coordinate]) -> Self {
        let mut sorted = coordinates.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        Self(sorted)
    }

    /// All six coordinates.
    #[must_use]
    pub fn spatial() -> Self {
        Self(Coordinate::ALL.to_vec())
    }

    /// Number of free coordinates.
    #[must_use]
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The free coordinates in [`Twist`] order.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.0
    }

    /// A twist whose free components are `value(index)`, called in [`Twist`] order; the others are zero.
    pub fn twist(&self, mut value: impl FnMut(usize) -> f64) -> Twist {
        let mut twist = Twist::zeros();
        for coordinate in &self.0 {
            twist[coordinate.index()] = value(coordinate.index());
        }
        twist
    }

    /// A full twist from the free components.
    #[must_use]
    pub fn expand(&self, free: &[f64]) -> Twist {
        let mut twist = Twist::zeros();
        for (coordinate, value) in self.0.iter().zip(free) {
            twist[coordinate.index()] = *value;
        }
        twist
    }
}

//! The parameters common to all poses: identity, unit and prior.

use crate::geometry::Coordinate;

/// Identity of a parameter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ParameterId {
    /// Component of a cable's entry point (m).
    EntryPoint {
        /// Index of the cable.
        cable: usize,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// Offset of the laser's target plane (m).
    PlaneOffset,
    /// Coordinate of the home pose (m or rad).
    Home(Coordinate),
    /// Error of a cable's tension reading at home (N).
    HomeTension {
        /// Index of the cable.
        cable: usize,
    },
    /// Parameter of a free effect.
    Effect {
        /// Index among the free effects.
        effect: usize,
        /// Index among its parameters.
        parameter: usize,
    },
    /// Parameter of the estimated deviation of a part.
    Deviation {
        /// Index among the estimated deviations.
        deviation: usize,
        /// Index among its parameters.
        parameter: usize,
    },
}

/// One estimated parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Identity.
    pub id: ParameterId,
    /// Name to display: `cable-3 entry point x`.
    pub name: String,
    /// SI unit.
    pub unit: &'static str,
    /// Standard deviation of the prior; `None` if it has no prior.
    pub prior_sd: Option<f64>,
}

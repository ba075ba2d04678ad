//! Observations: what the adjustment compares with its prediction, row by row.

use crate::geometry::Coordinate;

/// What a row of the adjustment compares with its prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObservationKind {
    /// Length of a cable.
    Length(usize),
    /// Equilibrium of forces along, or of torques about, an axis; stands for the tension readings.
    Equilibrium(Coordinate),
    /// Laser distance.
    Laser,
    /// Swivel angle of a pulley.
    Swivel(usize),
    /// Position by the external instrument, axis 0, 1, 2.
    TrackerPosition(usize),
    /// Orientation by the external instrument, axis 0, 1, 2.
    TrackerOrientation(usize),
    /// Roll, pitch, yaw: 0, 1, 2.
    Inclination(usize),
}

/// One observation at a solution: a reading or an equilibrium equation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Row of the measurements.
    pub row: usize,
    /// What is observed.
    pub kind: ObservationKind,
    /// Prediction minus reading, in standard deviations of the reading.
    pub standardised: f64,
    /// Standard deviation of the reading (SI unit of the reading, 1 for equilibrium rows).
    pub sd: f64,
    /// Share of an error of this reading that shows in its residual, 0 to 1; `None` where
    /// the common parameters are not determined.
    pub redundancy: Option<f64>,
}

impl Observation {
    /// Prediction minus reading in SI units.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.standardised * self.sd
    }

    /// Residual in its own standard deviations: standard normal if model and noise are right. `None`
    /// where the reading is hardly controlled by others.
    #[must_use]
    pub fn normalised(&self) -> Option<f64> {
        let redundancy = self.redundancy.filter(|r| *r > 1e-3)?;
        Some(self.standardised / redundancy.sqrt())
    }
}

//! Observations of the adjustment, with their residuals and their reliability.
//!
//! The residual of a reading is the least-squares estimate of its noise, with the opposite sign: prediction minus
//! reading, where the prediction is that of the whole adjustment. A reading that shares its row with others, as the tension
//! does in the length of an elastic cable, gets its own part of the common error only. With the redundancy `r`, the share of
//! an error of the reading that shows in its residual, the residual in standard deviations of the reading is normal with the
//! variance `r` if model and noise are right (Baarda 1968).
//!
//! An error `d` in one reading shifts its normalised residual by `d sqrt(r) / sd`. A two-sided test at the level `alpha`
//! detects it with the probability `beta` if this shift is
//!
//! `delta_0 = q(1 - alpha / 2) + q(beta)`,  that is, if  `d = sd delta_0 / sqrt(r)`,
//!
//! with the normal quantile `q`: the smallest detectable error, or minimal detectable bias. (The neglected other tail has
//! a probability below `alpha / 2`.) The effect of such an error on the result is the external reliability; it is
//! proportional to the error, so an observation carries it per standard deviation of the reading.
//!
//! W. Baarda, A testing procedure for use in geodetic networks, 1968; W. Foerstner, Reliability analysis of parameter
//! estimation in linear models, 1987. The columns of the tables follow JAG3D.

use crate::geometry::Coordinate;
use crate::statistics::normal_quantile;

/// Kind of an observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObservationKind {
    /// Length of a cable.
    Length(usize),
    /// Tension of a cable.
    Tension(usize),
    /// Equilibrium of forces along, or of torques about, an axis: an equation without a sensor.
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
    /// Measured distance between two poses, by its index.
    Distance(usize),
}

impl ObservationKind {
    /// Cable of a reading of one cable.
    #[must_use]
    pub fn cable(self) -> Option<usize> {
        match self {
            Self::Length(cable) | Self::Tension(cable) | Self::Swivel(cable) => Some(cable),
            _ => None,
        }
    }

    /// Axis or angle of a reading with several components.
    #[must_use]
    pub fn component(self) -> Option<usize> {
        match self {
            Self::TrackerPosition(k) | Self::TrackerOrientation(k) | Self::Inclination(k) => {
                Some(k)
            }
            _ => None,
        }
    }
}

/// One observation at a solution: a reading or an equilibrium equation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Row of the measurements.
    pub row: usize,
    /// Kind of the observation.
    pub kind: ObservationKind,
    /// Prediction minus reading, in standard deviations of the reading.
    pub standardised: f64,
    /// Standard deviation of the reading (SI unit of the reading; N or N m for equations of equilibrium).
    pub sd: f64,
    /// Share of an error of this reading that shows in its residual, 0 to 1; `None` where
    /// the common parameters are not determined.
    pub redundancy: Option<f64>,
    /// The entry point that an error of this reading moves most; `None` if it moves none, or if the common parameters
    /// are not determined.
    pub pull: Option<EntryPointSensitivity>,
}

/// Sensitivity of the entry point that an error of a reading moves most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EntryPointSensitivity {
    /// Index of its cable.
    pub cable: usize,
    /// Displacement by an error of one standard deviation of the reading (m).
    pub per_sd_m: f64,
}

/// Below this redundancy a reading is hardly controlled by others.
const CONTROLLED: f64 = 1e-3;

impl Observation {
    /// Prediction minus reading in SI units.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.standardised * self.sd
    }

    /// Residual divided by its own standard deviation: standard normal if model and noise are right. `None`
    /// where the reading is hardly controlled by others.
    #[must_use]
    pub fn normalised(&self) -> Option<f64> {
        let redundancy = self.controlled()?;
        Some(self.standardised / redundancy.sqrt())
    }

    /// Internal and external reliability; `None` where the reading is hardly controlled by others.
    #[must_use]
    pub fn reliability(&self, test: DetectionTest) -> Option<Reliability> {
        let redundancy = self.controlled()?;
        let deviations = test.noncentrality() / redundancy.sqrt();
        Some(Reliability {
            smallest_error: deviations * self.sd,
            influence_m: self.pull.map_or(0.0, |pull| deviations * pull.per_sd_m),
        })
    }

    fn controlled(&self) -> Option<f64> {
        self.redundancy.filter(|r| *r > CONTROLLED)
    }
}

/// A two-sided test of single normalised residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectionTest {
    /// Probability that a reading without error fails the test.
    pub level: f64,
    /// Probability of detecting an error.
    pub power: f64,
}

impl DetectionTest {
    /// The power customary in geodesy.
    pub const USUAL_POWER: f64 = 0.8;

    /// Noncentrality `delta_0`: mean of the normalised residual at which the test has its power.
    #[must_use]
    pub fn noncentrality(self) -> f64 {
        normal_quantile(1.0 - 0.5 * self.level) + normal_quantile(self.power)
    }
}

/// Reliability of a reading under a test of single readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reliability {
    /// Smallest error of the reading that the test detects with its power (SI unit of the reading): internal reliability.
    pub smallest_error: f64,
    /// Displacement by that error of the entry point it moves most (m): external reliability.
    pub influence_m: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Baarda's figures: level 0.1 %, power 80 %.
    #[test]
    fn the_noncentrality_is_that_of_the_tables() {
        let baarda = DetectionTest {
            level: 0.001,
            power: 0.8,
        };
        assert!((baarda.noncentrality() - 4.132).abs() < 5e-4);
        let reading = Observation {
            row: 1,
            kind: ObservationKind::Laser,
            standardised: 1.0,
            sd: 2e-4,
            redundancy: Some(0.25),
            pull: Some(EntryPointSensitivity {
                cable: 3,
                per_sd_m: 1e-5,
            }),
        };
        let reliability = reading.reliability(baarda).expect("it is controlled");
        assert!((reliability.smallest_error - 4.132 * 2.0 * 2e-4).abs() < 1e-6);
        assert!((reliability.influence_m - 4.132 * 2.0 * 1e-5).abs() < 1e-7);
        let uncontrolled = Observation {
            redundancy: Some(1e-9),
            ..reading
        };
        assert_eq!(uncontrolled.reliability(baarda), None);
    }
}

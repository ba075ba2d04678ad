//! Identifies the reading that a row of a linearisation belongs to, in the terms of reports.

use super::Quantity;
use crate::estimation::{LinearRow, Linearisation, ObservationKind, ParameterId, RowKind};

/// The reading that a row belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ReadingId {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable, for readings of a cable.
    pub cable: Option<usize>,
    /// Axis or angle, for readings with several components.
    pub component: Option<usize>,
}

impl ReadingId {
    /// The reading of a row; `None` for equilibrium equations, and for priors except those that represent the tension
    /// readings at home.
    pub(super) fn of(row: &LinearRow, linear: &Linearisation) -> Option<Self> {
        let (quantity, cable, component) = match row.kind {
            RowKind::AssumedTension(_) => return None,
            RowKind::Prior(index) => match linear.parameters[index].id {
                ParameterId::HomeTension { cable } => (Quantity::Tension, Some(cable), None),
                _ => return None,
            },
            RowKind::Observation(kind) => match kind {
                ObservationKind::Equilibrium(_) => return None,
                ObservationKind::Length(cable) => (Quantity::Length, Some(cable), None),
                ObservationKind::Tension(cable) => (Quantity::Tension, Some(cable), None),
                ObservationKind::Laser => (Quantity::Laser, None, None),
                ObservationKind::Swivel(cable) => (Quantity::Swivel, Some(cable), None),
                ObservationKind::TrackerPosition(k) => (Quantity::TrackerPosition, None, Some(k)),
                ObservationKind::TrackerOrientation(k) => {
                    (Quantity::TrackerOrientation, None, Some(k))
                }
                ObservationKind::Inclination(k) => (Quantity::Inclination, None, Some(k)),
            },
        };
        Some(Self {
            quantity,
            cable,
            component,
        })
    }
}

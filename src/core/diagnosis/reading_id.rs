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
        let kind = match row.kind {
            RowKind::AssumedTension(_) => return None,
            RowKind::Prior(index) => match linear.parameters[index].id {
                ParameterId::HomeTension { cable } => ObservationKind::Tension(cable),
                _ => return None,
            },
            RowKind::Observation(kind) => kind,
        };
        Some(Self {
            quantity: Quantity::of(kind)?,
            cable: kind.cable(),
            component: kind.component(),
        })
    }
}

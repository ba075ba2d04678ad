//! `--tolerance-position` and `--volume`.

use anyhow::Result;
use tautline_workflow::history::Tolerance;

use crate::{BadInput, volume};

/// A tolerance of the position of the platform.
#[derive(Debug, clap::Args)]
pub struct PositionTolerance {
    /// Largest tolerable position error of the platform, as root mean square over the workspace (mm), for the date of the next
    /// calibration
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tolerance_position: Option<f64>,
    /// Volume in which the position has this tolerance, instead of the workspace (m)
    #[arg(
        long,
        value_name = "X0,X1,Y0,Y1,Z0,Z1",
        requires = "tolerance_position",
        allow_hyphen_values = true
    )]
    volume: Option<String>,
}

impl PositionTolerance {
    /// The tolerance, if it was given.
    pub fn given(&self) -> Result<Option<Tolerance>> {
        let Some(mm) = self.tolerance_position else {
            return Ok(None);
        };
        Ok(Some(Tolerance::Position {
            limit_m: metres("--tolerance-position", mm)?,
            volume: self.volume.as_deref().map(volume::parse).transpose()?,
        }))
    }
}

/// A tolerance in metres.
pub fn metres(name: &str, mm: f64) -> Result<f64> {
    match mm > 0.0 && mm.is_finite() {
        true => Ok(1e-3 * mm),
        false => Err(BadInput::new(format!(
            "{name}: found {mm}, expected a positive number of millimetres"
        ))),
    }
}

//! What commands read.

use std::path::Path;

use anyhow::Result;
use tautline_core::effect::measurements_as_modelled;
use tautline_core::measurement::Dataset;
use tautline_session::read_dataset;

use super::BadInput;

/// Reads a dataset folder, prints its notices, and puts the readings on the channels on which the robot's model has
/// them.
pub fn dataset(folder: &Path) -> Result<Dataset> {
    let read = read_dataset(folder)?;
    for notice in &read.notices {
        eprintln!("{notice}");
    }
    let robot = read.dataset.robot;
    let modelled = measurements_as_modelled(&robot, &read.dataset.measurements);
    Ok(Dataset {
        measurements: modelled.map_err(BadInput::new)?.into_owned(),
        robot,
    })
}

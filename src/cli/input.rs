//! What commands read.

use std::path::Path;

use anyhow::Result;
use tautline_core::effect::measurements_as_modelled;
use tautline_core::measurement::Dataset;
use tautline_session::{Session, import, read_dataset};

use super::BadInput;
use tautline_workflow::clock;
use tautline_workflow::comparison::as_session;

/// Reads a session, or begins one with a robot or a dataset folder; prints notices.
pub fn session(path: &Path) -> Result<Session> {
    let read = import(path, None)?;
    let (session, notices) = as_session(path, read.value, clock::now()).map_err(BadInput::new)?;
    for notice in read.notices.iter().chain(&notices) {
        eprintln!("{notice}");
    }
    Ok(session)
}

/// Reads a dataset folder and prints its notices.
pub fn dataset(folder: &Path) -> Result<Dataset> {
    let read = read_dataset(folder)?;
    for notice in &read.notices {
        eprintln!("{notice}");
    }
    Ok(read.dataset)
}

/// The same with the readings on the channels on which the robot's model has them.
pub fn as_modelled(dataset: Dataset) -> Result<Dataset> {
    let Dataset {
        robot,
        measurements,
    } = dataset;
    let modelled = measurements_as_modelled(&robot, &measurements).map_err(BadInput::new)?;
    Ok(Dataset {
        measurements: modelled.into_owned(),
        robot,
    })
}

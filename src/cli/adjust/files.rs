//! Files with the identified values, for controllers without a connection.

use anyhow::Result;
use tautline_core::robot::Robot;
use tautline_link::adjusting::{Difference, plan_adjustment};
use tautline_link::export::{differences_csv, identified_constants};

use super::Arguments;
use super::identified::Identified;
use crate::input;
use crate::output::{note, write_file};

/// Writes the requested files.
pub fn write(arguments: &Arguments, model: &Robot, differences: &[Difference]) -> Result<()> {
    if let Some(path) = &arguments.csv {
        write_file(path, differences_csv(differences).as_bytes())?;
    }
    if let Some(path) = &arguments.structured_text {
        write_file(path, identified_constants(model).as_bytes())?;
    }
    Ok(())
}

/// Identifies a session or a dataset folder and writes the files, in which the values of the controller are unknown.
pub fn write_without_controller(arguments: &Arguments) -> Result<()> {
    let session = input::session(&arguments.session)?;
    let identified = Identified::of(&session, arguments.method)?;
    for doubt in &identified.doubts {
        note!("{}.", doubt.sentence);
    }
    let differences = plan_adjustment(&[], &identified.model, identified.solution());
    write(arguments, &identified.model, &differences)
}

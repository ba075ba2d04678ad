//! Files with the identified values, for controllers without a connection.

use anyhow::Result;
use tautline_core::robot::Robot;
use tautline_link::adjusting::Difference;
use tautline_link::export::{differences_csv, structured_text};
use tautline_link::parameters::parameters_and_home_lengths;

use super::Arguments;
use crate::output::write_file;

/// Writes the requested files.
pub fn write(arguments: &Arguments, model: &Robot, differences: &[Difference]) -> Result<()> {
    if let Some(path) = &arguments.csv {
        write_file(path, differences_csv(differences).as_bytes())?;
    }
    if let Some(path) = &arguments.structured_text {
        let title = format!("Identified parameters of {}", model.name);
        let text = structured_text(&title, &parameters_and_home_lengths(model));
        write_file(path, text.as_bytes())?;
    }
    Ok(())
}

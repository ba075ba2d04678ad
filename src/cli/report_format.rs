//! The format of a report by the name of its file.

use std::path::Path;

use anyhow::Result;
use tautline_workflow::report::{ReportError, ReportFormat};

use crate::BadInput;
use crate::output::is_standard;

/// The format that the file named with an option has; standard output gets HTML.
pub fn report_format(option: &str, path: &Path) -> Result<ReportFormat> {
    if is_standard(path) {
        return Ok(ReportFormat::Html);
    }
    let found = format!("{option}: found {}", path.display());
    match ReportFormat::of(path) {
        None => Err(BadInput::new(format!(
            "{found}, expected a name that ends with .html or .pdf"
        ))),
        Some(format) if !format.is_available() => Err(BadInput::new(format!(
            "{found}; {}",
            ReportError::PdfLeftOut
        ))),
        Some(format) => Ok(format),
    }
}

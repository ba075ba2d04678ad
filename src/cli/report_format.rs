//! The format of a report by the name of its file.

use std::path::Path;

use anyhow::Result;
use tautline_workflow::report::{ReportError, ReportFormat};

use crate::BadInput;
use crate::output::is_standard;

/// The format that the file named with an option has; standard output gets HTML.
pub fn report_format(option: &str, path: &Path) -> Result<ReportFormat> {
    match ReportFormat::of(path) {
        Some(ReportFormat::Dcc) => Err(unexpected(option, path, ".html or .pdf")),
        format => available(option, path, format, ".html or .pdf"),
    }
}

/// The format of the report of a session, which may also be a Digital Calibration Certificate.
pub fn session_report_format(option: &str, path: &Path) -> Result<ReportFormat> {
    let format = ReportFormat::of(path);
    available(option, path, format, ".html, .pdf or .xml")
}

fn available(
    option: &str,
    path: &Path,
    format: Option<ReportFormat>,
    expected: &str,
) -> Result<ReportFormat> {
    if is_standard(path) {
        return Ok(ReportFormat::Html);
    }
    match format {
        None => Err(unexpected(option, path, expected)),
        Some(format) if !format.is_available() => Err(BadInput::new(format!(
            "{option}: found {}; {}",
            path.display(),
            ReportError::PdfLeftOut
        ))),
        Some(format) => Ok(format),
    }
}

fn unexpected(option: &str, path: &Path, expected: &str) -> anyhow::Error {
    let found = path.display();
    BadInput::new(format!(
        "{option}: found {found}, expected a name that ends with {expected}"
    ))
}

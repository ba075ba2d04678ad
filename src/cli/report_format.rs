//! The format of a report by the name of its file.

use std::path::Path;

use anyhow::Result;
use tautline_workflow::report::ReportFormat;

use crate::BadInput;
use crate::output::is_standard;

/// The format that the file named with an option has; standard output gets HTML.
pub fn report_format(option: &str, path: &Path) -> Result<ReportFormat> {
    if is_standard(path) {
        return Ok(ReportFormat::Html);
    }
    ReportFormat::of(path).ok_or_else(|| {
        BadInput::new(format!(
            "{option}: found {}, expected a name that ends with .html or .pdf",
            path.display()
        ))
    })
}

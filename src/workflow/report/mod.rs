//! The report of a calibration: what was measured, identified and found, as HTML or PDF.
//!
//! `content` makes one document of plain data; `html` and `pdf` render it. Nothing
//! here reads a clock or asks the window for anything, so a report is the same wherever it is made, but for times, which
//! are those of the computer's time zone.

mod choice;
mod colours;
mod content;
mod deviations;
pub mod document;
mod html;
mod input;
mod pdf;
mod plots;
mod results;
#[cfg(test)]
mod tests;
pub mod tolerance;

use std::path::{Path, PathBuf};

use document::Document;
use tautline_session::{Timestamp, WriteError, write_bytes};

pub use choice::{Part, ReportChoice};
pub use colours::PLOT;
pub use input::{ComparisonInput, ReportInput};
pub use pdf::PdfError;
pub use results::{Results, completed};

/// How a report is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReportFormat {
    /// One HTML file that needs nothing else.
    Html,
    /// PDF, A4.
    Pdf,
}

impl ReportFormat {
    /// By the end of the file's name, whatever its case; `None` if it is another.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "html" | "htm" => Some(Self::Html),
            "pdf" => Some(Self::Pdf),
            _ => None,
        }
    }

    /// Title in reports and on screen.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Html => "HTML",
            Self::Pdf => "PDF",
        }
    }

    /// End of the file's name.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Html => "html",
            Self::Pdf => "pdf",
        }
    }
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The name of the file does not say how to store it.
    #[error("{}: found a name that does not end with .html or .pdf, expected one of them", .0.display())]
    Extension(PathBuf),
    /// The PDF cannot be made.
    #[error(transparent)]
    Pdf(#[from] PdfError),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The report as bytes of a file.
///
/// # Errors
/// If a PDF is asked for and the picture is no PNG.
pub fn render_report(
    input: &ReportInput<'_>,
    format: ReportFormat,
) -> Result<Vec<u8>, ReportError> {
    render(&content::document(input), format, input.now)
}

/// A document as bytes of a file.
fn render(
    document: &Document,
    format: ReportFormat,
    now: Timestamp,
) -> Result<Vec<u8>, ReportError> {
    Ok(match format {
        ReportFormat::Html => html::render(document).into_bytes(),
        ReportFormat::Pdf => pdf::render(document, now)?,
    })
}

/// The report of a comparison as bytes of a file.
///
/// # Errors
/// If the PDF cannot be made.
pub fn render_comparison(
    input: &ComparisonInput<'_>,
    format: ReportFormat,
) -> Result<Vec<u8>, ReportError> {
    render(&content::comparison::document(input), format, input.now)
}

/// Writes the report of a comparison in the format that the name of the file says, completely or not at all.
///
/// # Errors
/// If the name ends with neither .html nor .pdf, or the file cannot be written.
pub fn write_comparison(path: &Path, input: &ComparisonInput<'_>) -> Result<(), ReportError> {
    write_document(path, &content::comparison::document(input), input.now)
}

/// Writes the report in the format that the name of the file says, completely or not at all.
///
/// # Errors
/// If the name ends with neither .html nor .pdf, or the file cannot be written.
pub fn write_report(path: &Path, input: &ReportInput<'_>) -> Result<(), ReportError> {
    write_document(path, &content::document(input), input.now)
}

/// Writes a document in the format that the name of the file says, completely or not at all.
///
/// # Errors
/// If the name ends with neither .html nor .pdf, or the file cannot be written.
pub fn write_document(path: &Path, document: &Document, now: Timestamp) -> Result<(), ReportError> {
    let format =
        ReportFormat::of(path).ok_or_else(|| ReportError::Extension(path.to_path_buf()))?;
    write_bytes(path, &render(document, format, now)?)?;
    Ok(())
}

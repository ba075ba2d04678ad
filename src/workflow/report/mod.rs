//! Calibration reports as HTML or PDF: measurements, identification and diagnosis.
//!
//! `content` builds one document of plain data; `html` and `pdf` render it. Nothing
//! here reads a clock or depends on the window, so a report is the same wherever it is made, except for times, which
//! are in the time zone of the computer.

mod bars;
mod choice;
mod colours;
mod content;
mod dcc;
mod deviations;
pub mod document;
mod html;
mod input;
#[cfg(feature = "pdf")]
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
pub use content::certificate::{missing_details, overdue};
pub use dcc::DccError;
pub use input::{ComparisonInput, CoverageInterval, HistoryInput, MonteCarlo, ReportInput};
#[cfg(feature = "pdf")]
pub use pdf::PdfError;
pub(crate) use plots::signature_plot;
pub use results::{Results, completed};

/// File format of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReportFormat {
    /// One self-contained HTML file.
    Html,
    /// PDF, A4.
    Pdf,
    /// Digital Calibration Certificate (XML) of PTB, of a session only.
    Dcc,
}

impl ReportFormat {
    /// The format according to the file extension, ignoring case; `None` for other extensions.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "html" | "htm" => Some(Self::Html),
            "pdf" => Some(Self::Pdf),
            "xml" => Some(Self::Dcc),
            _ => None,
        }
    }

    /// The format for paper: PDF, or HTML in a build without it.
    pub const FOR_PAPER: Self = if cfg!(feature = "pdf") {
        Self::Pdf
    } else {
        Self::Html
    };

    /// Whether this build writes the format.
    #[must_use]
    pub fn is_available(self) -> bool {
        self != Self::Pdf || cfg!(feature = "pdf")
    }

    /// Title in reports and on screen.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Html => "HTML",
            Self::Pdf => "PDF",
            Self::Dcc => "DCC",
        }
    }

    /// File extension.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Html => "html",
            Self::Pdf => "pdf",
            Self::Dcc => "xml",
        }
    }
}

/// Errors of making a report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The file extension is not that of a report.
    #[error("{}: expected a name that ends with .html, .pdf or .xml", .0.display())]
    Extension(PathBuf),
    /// A Digital Calibration Certificate of something else than a session.
    #[error("a Digital Calibration Certificate is made of a session only; expected .html or .pdf")]
    NoSession,
    /// A Digital Calibration Certificate without results.
    #[error(transparent)]
    Dcc(#[from] DccError),
    /// A PDF is asked for in a build without it.
    #[error("this build cannot write PDF; use HTML, or the released program")]
    PdfLeftOut,
    /// The PDF cannot be created.
    #[cfg(feature = "pdf")]
    #[error(transparent)]
    Pdf(#[from] PdfError),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Renders the report as the bytes of a file.
///
/// # Errors
/// If the format is PDF and the picture is not a PNG.
pub fn render_report(
    input: &ReportInput<'_>,
    format: ReportFormat,
) -> Result<Vec<u8>, ReportError> {
    match format {
        ReportFormat::Dcc => Ok(dcc::render(input)?.into_bytes()),
        ReportFormat::Html | ReportFormat::Pdf => {
            render(&content::document(input), format, input.now)
        }
    }
}

/// Renders a document as the bytes of a file.
///
/// # Errors
/// If the PDF cannot be created.
pub fn render(
    document: &Document,
    format: ReportFormat,
    now: Timestamp,
) -> Result<Vec<u8>, ReportError> {
    Ok(match format {
        ReportFormat::Html => html::render(document).into_bytes(),
        #[cfg(feature = "pdf")]
        ReportFormat::Pdf => pdf::render(document, now)?,
        #[cfg(not(feature = "pdf"))]
        ReportFormat::Pdf => {
            let _only_a_pdf_is_dated = now;
            return Err(ReportError::PdfLeftOut);
        }
        ReportFormat::Dcc => return Err(ReportError::NoSession),
    })
}

/// Renders the report of a comparison as the bytes of a file.
///
/// # Errors
/// If the PDF cannot be created.
pub fn render_comparison(
    input: &ComparisonInput<'_>,
    format: ReportFormat,
) -> Result<Vec<u8>, ReportError> {
    render(&content::comparison::document(input), format, input.now)
}

/// Writes the report of a comparison in the format of the file extension, atomically.
///
/// # Errors
/// If the name ends with neither .html nor .pdf, or the file cannot be written.
pub fn write_comparison(path: &Path, input: &ComparisonInput<'_>) -> Result<(), ReportError> {
    write_document(path, &content::comparison::document(input), input.now)
}

/// Renders the report of the record of a robot as the bytes of a file.
///
/// # Errors
/// If the PDF cannot be created.
pub fn render_history(
    input: &HistoryInput<'_>,
    format: ReportFormat,
) -> Result<Vec<u8>, ReportError> {
    render(&content::history::document(input), format, input.now)
}

/// Writes the report of the record of a robot in the format of the file extension, atomically.
///
/// # Errors
/// If the name ends with neither .html nor .pdf, or the file cannot be written.
pub fn write_history(path: &Path, input: &HistoryInput<'_>) -> Result<(), ReportError> {
    write_document(path, &content::history::document(input), input.now)
}

/// Writes the report in the format of the file extension, atomically.
///
/// # Errors
/// If the name ends with neither .html nor .pdf, or the file cannot be written.
pub fn write_report(path: &Path, input: &ReportInput<'_>) -> Result<(), ReportError> {
    let format = ReportFormat::of(path).ok_or_else(|| ReportError::Extension(path.into()))?;
    Ok(write_bytes(path, &render_report(input, format)?)?)
}

/// Writes a document in the format of the file extension, atomically.
///
/// # Errors
/// If the name ends with neither .html nor .pdf, or the file cannot be written.
pub fn write_document(path: &Path, document: &Document, now: Timestamp) -> Result<(), ReportError> {
    let format =
        ReportFormat::of(path).ok_or_else(|| ReportError::Extension(path.to_path_buf()))?;
    write_bytes(path, &render(document, format, now)?)?;
    Ok(())
}

//! Input of reports.

use tautline_core::comparison::Comparison;
use tautline_session::{Session, Timestamp};

use super::choice::ReportChoice;
use crate::documents::diagnosis::Diagnosed;
use crate::identification::Identification;

/// Name and version of the program, as stated in reports.
pub const PROGRAM: &str = concat!("Tautline ", env!("CARGO_PKG_VERSION"));

/// Input of a report.
#[derive(Debug, Clone, Copy)]
pub struct ReportInput<'a> {
    /// The session.
    pub session: &'a Session,
    /// Its identification, if there is one.
    pub fit: Option<&'a Identification>,
    /// Its diagnosis, if there is one.
    pub diagnosis: Option<&'a Diagnosed>,
    /// Whether the session was changed after identification or diagnosis.
    pub outdated: bool,
    /// A picture of the robot (PNG), if there is one.
    pub picture: Option<&'a [u8]>,
    /// The selected parts, and the heading.
    pub choice: &'a ReportChoice,
    /// Time of the report.
    pub now: Timestamp,
}

/// Input of the report of a comparison.
#[derive(Debug, Clone, Copy)]
pub struct ComparisonInput<'a> {
    /// Names of the two sessions.
    pub names: [&'a str; 2],
    /// Their identifications.
    pub fits: [&'a Identification; 2],
    /// The comparison, second less first.
    pub comparison: &'a Comparison,
    /// The heading; a comparison has all its parts.
    pub choice: &'a ReportChoice,
    /// Time of the report.
    pub now: Timestamp,
}

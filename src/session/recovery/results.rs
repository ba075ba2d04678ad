//! Results added since the snapshot, one per line, each with a checksum. Results never change, so each is
//! written once, however often the session is edited afterwards.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};
use tautline_files::{Location, ReadError};

use super::journal::{append, checked, checked_line};
use crate::error::WriteError;
use crate::session::{ResultRecord, Session};

/// A result with its number.
#[derive(Serialize, Deserialize)]
struct Numbered<R> {
    /// Number of results before it.
    number: usize,
    result: R,
}

/// Appends the results from number `written` on; they are on disk when this returns.
pub(super) fn append_new(
    path: &Path,
    results: &[ResultRecord],
    written: usize,
) -> Result<(), WriteError> {
    for (number, result) in results.iter().enumerate().skip(written) {
        let body = serde_json::to_string(&Numbered { number, result });
        let body = body.map_err(|error| WriteError::io(path, error.into()))?;
        append(path, &checked_line(&body))?;
    }
    Ok(())
}

/// Adds the results that the session does not have yet; returns a notice for the operator.
pub(super) fn add(path: &Path, session: &mut Session) -> Option<String> {
    let bytes = match fs::read(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return None,
        Ok(bytes) => bytes,
        Err(error) => {
            let error = ReadError::io(&path.display().to_string(), Location::File, &error);
            return Some(format!("{error}; the latest results may be missing"));
        }
    };
    let mut is_torn = false;
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        let body = line.strip_suffix(b"\n").and_then(checked);
        let entry: Option<Numbered<ResultRecord>> =
            body.and_then(|body| serde_json::from_slice(body).ok());
        is_torn = entry.is_none();
        let known = session.results().len();
        match entry {
            Some(entry) if entry.number == known => session.add_result(entry.result),
            Some(entry) if entry.number > known => {
                let file = path.display();
                return Some(format!(
                    "{file}: result {} is damaged; it and the results after it are missing",
                    known + 1
                ));
            }
            // The snapshot already contains the result, or the line is incomplete and the result was written again after it.
            _ => {}
        }
    }
    is_torn.then(|| {
        let file = path.display();
        format!(
            "{file}: the program ended while a result was being written; that result is missing"
        )
    })
}

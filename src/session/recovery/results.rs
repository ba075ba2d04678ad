//! Results that were added since the snapshot, one per line, each with a check: they never change, so each is written
//! once, however often the session is edited afterwards.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::journal::{append, checked, checked_line};
use crate::error::{Place, ReadError, WriteError};
use crate::session::{ResultRecord, Session};

/// A result with its place.
#[derive(Serialize, Deserialize)]
struct Numbered<R> {
    /// Number of results before it.
    number: usize,
    result: R,
}

/// Appends the results from number `kept` on; they are on disk when this returns.
pub(super) fn keep(path: &Path, results: &[ResultRecord], kept: usize) -> Result<(), WriteError> {
    for (number, result) in results.iter().enumerate().skip(kept) {
        let body = serde_json::to_string(&Numbered { number, result });
        let body = body.map_err(|error| WriteError::io(path, error.into()))?;
        append(path, &checked_line(&body))?;
    }
    Ok(())
}

/// Adds the results that the session does not have yet; gives what is to be told.
pub(super) fn add(path: &Path, session: &mut Session) -> Option<String> {
    let bytes = match fs::read(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return None,
        Ok(bytes) => bytes,
        Err(error) => {
            let error = ReadError::io(&path.display().to_string(), Place::File, &error);
            return Some(format!("{error}; results computed last may be missing"));
        }
    };
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        let body = line.strip_suffix(b"\n").and_then(checked);
        let entry: Option<Numbered<ResultRecord>> =
            body.and_then(|body| serde_json::from_slice(body).ok());
        let known = session.results().len();
        match entry {
            // The snapshot was written after it.
            Some(entry) if entry.number < known => {}
            Some(entry) if entry.number == known => session.add_result(entry.result),
            // A line that was begun before one that was written to its end.
            None if line == b"\n" => {}
            _ => {
                return Some(format!(
                    "{}: result {} is damaged, it and those after it are missing",
                    path.display(),
                    known + 1
                ));
            }
        }
    }
    None
}

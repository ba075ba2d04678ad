//! The journal: one measured pose per line, each with a checksum.
//!
//! A line is a JSON array of two elements: the fingerprint of the rest of the line, and the pose. The fingerprint of an
//! incompletely written line does not match.

use std::fs::OpenOptions;
use std::io::{Read, Result as IoResult, Seek, SeekFrom, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::atomic::write_atomically;
use crate::error::WriteError;
use crate::fingerprint::Fingerprint;
use crate::session::{MeasuredPose, MeasurementTable};

/// One pose of the journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct JournalEntry {
    /// The readings, one row.
    pub table: MeasurementTable,
    /// Label of the pose that this one replaces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeats: Option<i64>,
    /// Start of the controller as reported by it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub started: Option<f64>,
}

/// A line with its checksum and line end.
pub(super) fn checked_line(body: &str) -> String {
    let check = Fingerprint::of(body.as_bytes()).to_hex();
    format!("[\"{check}\",{body}]\n")
}

/// The text of a line (without its line end) if its checksum matches.
pub(super) fn checked(line: &[u8]) -> Option<&[u8]> {
    let inside = line.strip_prefix(b"[\"")?.strip_suffix(b"]")?;
    let (check, rest) = inside.split_at_checked(16)?;
    let body = rest.strip_prefix(b"\",")?;
    (Fingerprint::of(body).to_hex().as_bytes() == check).then_some(body)
}

/// The content of a journal.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Journal {
    /// Poses in the order of measurement.
    pub entries: Vec<JournalEntry>,
    /// Numbers of damaged lines, from 1, except the last line.
    pub damaged: Vec<usize>,
    /// Whether the last line is incomplete.
    pub is_torn: bool,
}

impl JournalEntry {
    pub fn of(pose: &MeasuredPose) -> Self {
        Self {
            table: MeasurementTable::of(&pose.readings),
            repeats: pose.repeats,
            started: pose.started.filter(|started| started.is_finite()),
        }
    }

    /// The line with its line end.
    pub fn line(&self) -> IoResult<String> {
        Ok(checked_line(&serde_json::to_string(self)?))
    }

    /// The pose of a line (without its line end), if its checksum matches.
    fn parse(line: &[u8]) -> Option<Self> {
        serde_json::from_slice(checked(line)?).ok()
    }
}

impl Journal {
    /// Reads a journal, skipping damaged lines.
    pub fn parse(bytes: &[u8]) -> Self {
        let mut journal = Self::default();
        let mut lines = bytes.split_inclusive(|byte| *byte == b'\n').enumerate();
        let mut next = lines.next();
        while let Some((k, line)) = next {
            next = lines.next();
            let complete = line.strip_suffix(b"\n");
            match complete.and_then(JournalEntry::parse) {
                Some(entry) => journal.entries.push(entry),
                None if complete == Some(b"") => {}
                None if next.is_none() => journal.is_torn = true,
                None => journal.damaged.push(k + 1),
            }
        }
        journal
    }
}

/// Replaces a journal atomically.
pub(super) fn write(path: &Path, entries: &[JournalEntry]) -> Result<(), WriteError> {
    write_atomically(path, |out| {
        let mut lines = entries.iter().map(JournalEntry::line);
        lines.try_for_each(|line| out.write_all(line?.as_bytes()))
    })
}

/// Appends a line; it is on disk when this returns.
pub(super) fn append(path: &Path, line: &str) -> Result<(), WriteError> {
    append_line(path, line).map_err(|error| WriteError::io(path, error))
}

fn append_line(path: &Path, line: &str) -> IoResult<()> {
    let mut options = OpenOptions::new();
    let mut file = options.read(true).append(true).create(true).open(path)?;
    let mut text = String::with_capacity(line.len() + 1);
    // An incomplete line of an earlier failure is terminated first.
    if file.metadata()?.len() > 0 {
        let mut last = [0];
        file.seek(SeekFrom::End(-1))?;
        file.read_exact(&mut last)?;
        if last != *b"\n" {
            text.push('\n');
        }
    }
    text.push_str(line);
    file.write_all(text.as_bytes())?;
    file.sync_data()
}

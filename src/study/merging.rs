//! Merging of chunks: only a complete study, of one version and one division into chunks, is merged.

use std::fs;
use std::path::{Path, PathBuf};

use tautline_session::{read_versioned, write_versioned};

use crate::StudyError;
use crate::chunk::{ChunkNumber, Rows, read_chunk};
use crate::plan::{PLAN, StudyPlan};
use crate::result::{StudyResult, Tallies};
use crate::run::belongs;

/// File of the merged result in the folder of a study.
pub const RESULT: &str = "result.json";

/// Merges the chunks in the folder of a study and writes the result beside them. One chunk is in memory at a time.
///
/// # Errors
/// If a chunk is missing, damaged, or of another study, version or division; the message names the file.
pub fn merge(plan: &StudyPlan, folder: &Path) -> Result<StudyResult, StudyError> {
    let chunks = chunks(folder, plan.calibrations())?;
    let fingerprint = plan.fingerprint();
    let mut tallies = Tallies::new(plan);
    for (part, path) in &chunks {
        let (origin, rows) = read_chunk(path)?;
        let named = |message: String| StudyError::Input(format!("{}: {message}", path.display()));
        belongs(&origin, (plan, &fingerprint), *part).map_err(named)?;
        tallies.add(plan, origin.range[0], &rows).map_err(named)?;
    }
    let result = tallies.result(plan, fingerprint);
    write_versioned(&folder.join(RESULT), &result)?;
    Ok(result)
}

/// All calibrations of the chunks present in a folder, in the order of the study.
///
/// # Errors
/// If a chunk is damaged; the message names the file.
pub fn calibrations(folder: &Path) -> Result<Rows, StudyError> {
    let mut all = Rows::default();
    for (_, path) in present(folder)? {
        all.append(read_chunk(&path)?.1);
    }
    Ok(all)
}

/// Reads the result written by [`merge`].
///
/// # Errors
/// If there is none, or it is invalid or belongs to another study; the message names the file.
pub fn read_result(plan: &StudyPlan, folder: &Path) -> Result<StudyResult, StudyError> {
    let path = folder.join(RESULT);
    let fail = |message: &str| StudyError::Input(format!("{}: {message}", path.display()));
    if !path.exists() {
        return Err(fail(
            "not found, expected the result that the command study merge writes",
        ));
    }
    let result = read_versioned::<StudyResult>(&path)?.value;
    if result.study != plan.fingerprint() || result.cells.len() != plan.cells.len() {
        return Err(fail(&format!(
            "found the result of a study other than {PLAN}: merge again"
        )));
    }
    Ok(result)
}

/// The chunks in a folder, in order.
fn present(folder: &Path) -> Result<Vec<(ChunkNumber, PathBuf)>, StudyError> {
    let fail = |message: String| StudyError::Input(format!("{}: {message}", folder.display()));
    let entries =
        fs::read_dir(folder).map_err(|error| fail(format!("cannot be read ({error})")))?;
    let mut found = Vec::new();
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(middle) = name
            .strip_prefix("chunk-")
            .and_then(|rest| rest.strip_suffix(".parquet"))
        else {
            continue;
        };
        let part = ChunkNumber::parse(&middle.replace("-of-", "/"));
        let part = part.ok().filter(|part| part.file_name() == name);
        let part =
            part.ok_or_else(|| fail(format!("found {name}, which is not the name of a chunk")))?;
        found.push((part, entry.path()));
    }
    found.sort_by_key(|(part, _)| (part.of, part.number));
    Ok(found)
}

/// The chunks in a folder, in order, if they are all parts of one division.
fn chunks(folder: &Path, calibrations: u64) -> Result<Vec<(ChunkNumber, PathBuf)>, StudyError> {
    let fail = |message: String| StudyError::Input(format!("{}: {message}", folder.display()));
    let found = present(folder)?;
    if calibrations == 0 && found.is_empty() {
        return Ok(found);
    }
    let Some((first, _)) = found.first() else {
        return Err(fail(
            "found no chunk, expected those that the command study run writes".to_owned(),
        ));
    };
    let of = first.of;
    if let Some((other, _)) = found.iter().find(|(part, _)| part.of != of) {
        return Err(fail(format!(
            "found chunks of a division into {of} and of one into {}, expected one division",
            other.of
        )));
    }
    let missing = (1..=of).find(|number| {
        found
            .get(*number as usize - 1)
            .is_none_or(|(part, _)| part.number != *number)
    });
    match missing {
        Some(number) => Err(fail(format!(
            "found {} of {of} chunks; number {number} is missing",
            found.len()
        ))),
        None => Ok(found),
    }
}

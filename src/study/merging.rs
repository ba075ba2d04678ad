//! Joining chunks: only a whole study of one version, cut in one way, is merged.

use std::fs;
use std::path::{Path, PathBuf};

use tautline_session::{read_versioned, write_versioned};

use crate::StudyError;
use crate::chunk::{Part, Rows, read_chunk};
use crate::plan::{PLAN, StudyPlan};
use crate::result::{StudyResult, Tallies};
use crate::run::belongs;

/// File of the merged result in the folder of a study.
pub const RESULT: &str = "result.json";

/// Merges the chunks in the folder of a study and writes the result beside them. One chunk is in memory at a time.
///
/// # Errors
/// One sentence that names the file, if a chunk is missing, damaged, of another study, version or cut.
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

/// Every calibration of the chunks in a folder, in the order of the study, as many as are there.
///
/// # Errors
/// One sentence that names the file, if a chunk is damaged.
pub fn calibrations(folder: &Path) -> Result<Rows, StudyError> {
    let mut all = Rows::default();
    for (_, path) in present(folder)? {
        all.append(read_chunk(&path)?.1);
    }
    Ok(all)
}

/// Reads the result that [`merge`] has written.
///
/// # Errors
/// One sentence that names the file, if there is none, it is not valid, or belongs to another study.
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
            "found the result of another study than {PLAN}, expected to merge it again"
        )));
    }
    Ok(result)
}

/// The chunks in a folder in their order.
fn present(folder: &Path) -> Result<Vec<(Part, PathBuf)>, StudyError> {
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
        let part = Part::parse(&middle.replace("-of-", "/"));
        let part = part.ok().filter(|part| part.file_name() == name);
        let part =
            part.ok_or_else(|| fail(format!("found {name}, which is the name of no chunk")))?;
        found.push((part, entry.path()));
    }
    found.sort_by_key(|(part, _)| (part.of, part.number));
    Ok(found)
}

/// The chunks in a folder in their order: all parts of one cut.
fn chunks(folder: &Path, calibrations: u64) -> Result<Vec<(Part, PathBuf)>, StudyError> {
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
            "found chunks of a cut into {of} and of one into {}, expected one cut",
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
            "found {} of {of} chunks, number {number} is missing",
            found.len()
        ))),
        None => Ok(found),
    }
}

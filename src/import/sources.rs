//! Several files, or the files of a folder.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use tautline_session::{Loaded, Location, ReadError};

use crate::formats::read_watched;
use crate::input::Watch;
use crate::memory::MemoryBudget;
use crate::source::Source;

/// Reads files, and all supported files in folders; others in a folder are reported in a notice.
/// Their content takes its memory of `budget`; `goes_on` receives the fraction read and returns whether to continue.
///
/// # Errors
/// If a given file cannot be read or needs too much memory, a folder contains no readable file, or reading was stopped.
pub fn read_sources(
    paths: &[PathBuf],
    budget: &MemoryBudget,
    goes_on: &dyn Fn(f64) -> bool,
) -> Result<Loaded<Vec<Source>>, ReadError> {
    let watch = Watch::new(bytes(paths), goes_on, budget);
    let mut sources = Vec::new();
    let mut notices = Vec::new();
    for path in paths {
        if path.is_dir() {
            read_folder(path, &watch, &mut sources, &mut notices)?;
        } else {
            sources.push(read_watched(path, &watch)?);
        }
    }
    make_names_unique(&mut sources);
    Ok(Loaded {
        value: sources,
        notices,
    })
}

fn read_folder(
    folder: &Path,
    watch: &Watch<'_>,
    sources: &mut Vec<Source>,
    notices: &mut Vec<String>,
) -> Result<(), ReadError> {
    let file = folder.display().to_string();
    let failed = |error| ReadError::io(&file, Location::File, &error);
    let mut paths: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        paths.push(entry.map_err(failed)?.path());
    }
    paths.sort();
    let before = sources.len();
    for path in paths {
        if path.is_dir() {
            notices.push(format!("{}: nested folder, not read", path.display()));
            continue;
        }
        match read_watched(&path, watch) {
            Ok(source) => sources.push(source),
            Err(error) if watch.is_stopped() => return Err(error),
            Err(error) => notices.push(format!("{error}: not read")),
        }
    }
    if sources.len() == before {
        return Err(ReadError::new(
            &file,
            Location::File,
            "found no file with readings in this folder",
        ));
    }
    Ok(())
}

/// Total size of files and of those in folders (bytes).
fn bytes(paths: &[PathBuf]) -> u64 {
    let of_file = |path: &Path| fs::metadata(path).map_or(0, |data| data.len());
    let of_folder = |folder: &Path| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| of_file(&entry.path())).sum()
    };
    paths
        .iter()
        .map(|path| match path.is_dir() {
            true => of_folder(path),
            false => of_file(path),
        })
        .sum()
}

/// Makes the names of series unique, since recipes refer to them.
pub(crate) fn make_names_unique(sources: &mut [Source]) {
    let mut seen = HashSet::new();
    for series in sources.iter_mut().flat_map(|source| &mut source.series) {
        let name = series.name.clone();
        let mut number = 1;
        while !seen.insert(series.name.clone()) {
            number += 1;
            series.name = format!("{name} #{number}");
        }
    }
}

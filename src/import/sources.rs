//! Several files, or the files of a folder.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use tautline_session::{Loaded, Place, ReadError};

use crate::formats::read_source;
use crate::source::Source;

/// Reads files, and those of folders that are read as tables of some kind; others in a folder are named in a notice.
///
/// # Errors
/// If a file that was named is not read, or a folder has none that is.
pub fn read_sources(paths: &[PathBuf]) -> Result<Loaded<Vec<Source>>, ReadError> {
    let mut sources = Vec::new();
    let mut notices = Vec::new();
    for path in paths {
        if path.is_dir() {
            read_folder(path, &mut sources, &mut notices)?;
        } else {
            sources.push(read_source(path)?);
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
    sources: &mut Vec<Source>,
    notices: &mut Vec<String>,
) -> Result<(), ReadError> {
    let file = folder.display().to_string();
    let failed = |error| ReadError::io(&file, Place::File, &error);
    let mut paths: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        paths.push(entry.map_err(failed)?.path());
    }
    paths.sort();
    let before = sources.len();
    for path in paths {
        if path.is_dir() {
            notices.push(format!("{}: folder in a folder, not read", path.display()));
            continue;
        }
        match read_source(&path) {
            Ok(source) => sources.push(source),
            Err(error) => notices.push(format!("{error}: not read")),
        }
    }
    if sources.len() == before {
        return Err(ReadError::new(
            &file,
            Place::File,
            "found no file with readings in this folder",
        ));
    }
    Ok(())
}

/// Recipes name series, so that no two may have one name.
fn make_names_unique(sources: &mut [Source]) {
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

//! Several files, or the files of a folder.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use tautline_channels::{MemoryBudget, Source, Watch, read_watched, text_head};
use tautline_files::{Location, ReadError};
use tautline_session::Loaded;

use crate::robots::is_description;

/// Reads a file with readings in any supported format.
///
/// # Errors
/// If its format is unknown, it describes a robot, or its content is invalid; names the place.
pub fn read_source(path: &Path) -> Result<Source, ReadError> {
    let budget = MemoryBudget::default();
    read_file(path, &Watch::new(0, &|_| true, &budget))
}

/// Whether a file is a robot description rather than readings.
pub(crate) fn holds_description(path: &Path) -> Result<bool, ReadError> {
    let text = text_head(path)?;
    Ok(text.is_some_and(|text| is_description(text.trim_start())))
}

fn read_file(path: &Path, watch: &Watch<'_>) -> Result<Source, ReadError> {
    let text = text_head(path)?.unwrap_or_default();
    match other_content(text.trim_start()) {
        Some(found) => {
            let file = path.display().to_string();
            Err(ReadError::new(&file, Location::File, found))
        }
        None => read_watched(path, watch),
    }
}

/// What a text file holds instead of readings, and what to do.
fn other_content(text: &str) -> Option<&'static str> {
    match text.chars().next()? {
        _ if is_description(text) => Some(
            "is the description of a robot, expected readings; import it by itself, with -o robot.json",
        ),
        '<' => Some(
            "is an XML file of unknown format, expected readings or a robot of CASPR, WireX, MuJoCo, Gazebo or URDF",
        ),
        '{' => Some("is a JSON file, expected readings; robots and sessions need no import"),
        _ => None,
    }
}

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
            sources.push(read_file(path, &watch)?);
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
        match read_file(&path, watch) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_of_text_say_what_they_are() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        for (text, found) in [
            (
                "<?xml version=\"1.0\"?>\n<cables default_cable_set=\"a\">",
                "is the description of a robot",
            ),
            ("<html></html>", "or a robot of CASPR"),
            ("{\"a\": 1}", "robots and sessions need no import"),
        ] {
            fs::write(&path, text).expect("written");
            let error = read_source(&path).expect_err("no readings").to_string();
            assert!(error.contains(found), "{error}");
        }
    }
}

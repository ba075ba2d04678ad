//! Sample sessions in folders: `NAME/session.json`, or several sessions of one robot, with a `README.md`.

use std::fs;
use std::path::{Path, PathBuf};

use tautline_session::read_session;

use crate::history::is_record;
use crate::plot::outline::outline;
use crate::wording::session_facts;

/// A sample session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sample {
    /// Its title.
    pub title: String,
    /// Subject of the demonstration, in one line.
    pub shows: String,
    /// Its session file, or the folder of a record.
    pub session: PathBuf,
    /// Whether the sample is the record of a robot.
    pub is_record: bool,
    /// Time of the measurement, and the robot.
    pub facts: String,
    /// A small picture of its robot, see [`outline`].
    pub outline: Vec<[i16; 4]>,
}

/// Sample sessions of the first folder that contains any, sorted by folder name.
#[must_use]
pub fn find(folders: &[PathBuf]) -> Vec<Sample> {
    let found = folders.iter().map(|folder| samples_in(folder));
    found
        .into_iter()
        .find(|samples| !samples.is_empty())
        .unwrap_or_default()
}

/// Folders that may contain the sample sessions: beside the program, and the working directory.
#[must_use]
pub fn places() -> Vec<PathBuf> {
    let program = std::env::current_exe().ok();
    let beside = program
        .iter()
        .flat_map(|path| path.ancestors().skip(1).take(4))
        .map(Path::to_owned);
    beside
        .chain(std::env::current_dir())
        .map(|folder| folder.join("sessions"))
        .collect()
}

fn samples_in(folder: &Path) -> Vec<Sample> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut folders: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    folders.sort();
    folders
        .iter()
        .flat_map(|folder| samples_of(folder))
        .collect()
}

/// The sessions of one folder, whose README has a title and, after an empty line, a description.
fn samples_of(folder: &Path) -> Vec<Sample> {
    let Ok(text) = fs::read_to_string(folder.join("README.md")) else {
        return Vec::new();
    };
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let title = lines
        .next()
        .unwrap_or_default()
        .trim_start_matches('#')
        .trim()
        .to_owned();
    let shows = lines.next().unwrap_or_default().to_owned();
    let session = |name: &str| Some(folder.join(name)).filter(|path| path.is_file());
    let sample = |suffix: &str, session: PathBuf| {
        let read = read_session(&session).ok().map(|loaded| loaded.value);
        let facts = read.as_ref().map(|read| {
            let robot = read.robot.label();
            session_facts(read.measured(), Some(&robot), None, None)
        });
        Sample {
            title: format!("{title}{suffix}"),
            shows: shows.clone(),
            session,
            is_record: false,
            facts: facts.unwrap_or_default(),
            outline: read.map_or_else(Vec::new, |read| outline(&read.robot)),
        }
    };
    let pair = [
        ("session.json", ""),
        ("before.json", ", before"),
        ("after.json", ", after"),
    ];
    let named = pair.iter();
    let named = named.filter_map(|(name, suffix)| Some(sample(suffix, session(name)?)));
    let found: Vec<Sample> = named.collect();
    if found.is_empty() && is_record(folder) {
        return vec![Sample {
            is_record: true,
            ..sample("", folder.to_owned())
        }];
    }
    found
}

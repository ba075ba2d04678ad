//! Comparison of two sessions, for terminal and screen.

mod document;
mod words;

use std::path::Path;

use tautline_core::comparison::{Comparison, Identified, compare};
use tautline_core::estimation::{Control, Progress};
use tautline_session::{Import, Session, Timestamp};

use crate::audit;
use crate::identification::{Identification, IdentificationError, identify_session};
pub use document::{ComparisonDocument, PulleyDocument};
pub use words::{by_chance, common_motion, differs, effect_name, unexplained, verdict};

/// Significance level of a comparison: probability of finding a difference between two sessions of an unchanged robot.
pub const LEVEL: f64 = 0.05;

/// Converts an import to a session, with notices; datasets and robots start a new session.
///
/// # Errors
/// One sentence, if it is a table.
pub fn as_session(
    path: &Path,
    import: Import,
    now: Timestamp,
) -> Result<(Session, Vec<String>), String> {
    match import {
        Import::Session(session) => {
            let broken = audit::notice(&session);
            let broken = broken.map(|text| format!("{}: {text}", path.display()));
            Ok((*session, broken.into_iter().collect()))
        }
        Import::Robot(robot) => Ok((Session::new(robot.name.clone(), *robot, now), Vec::new())),
        Import::Dataset(folder) => {
            let notices = folder.notices.clone();
            let name = folder.dataset.robot.name.clone();
            Ok((Session::of_dataset(name, *folder, now), notices))
        }
        _ => Err(format!(
            "{}: found a table, expected a session, a robot or a dataset folder",
            path.display()
        )),
    }
}

/// Identifies a session for a comparison, which needs a converged identification.
///
/// # Errors
/// If there is no such identification.
pub fn identify_to_compare(
    session: &Session,
    observe: &mut dyn FnMut(&Progress) -> Control,
) -> Result<Identification, IdentificationError> {
    let found = identify_session(session, observe)?;
    if found.solution.converged() {
        Ok(found)
    } else {
        Err(IdentificationError::NotConverged)
    }
}

/// Compares two identifications, the second less the first.
///
/// # Errors
/// One sentence, if the robots have different cables or the data of a session do not determine its geometry.
pub fn compare_identifications(
    [first, second]: [&Identification; 2],
    level: f64,
) -> Result<Comparison, String> {
    let [problem_a, problem_b] = [first.problem(), second.problem()];
    let problem_a = problem_a.map_err(|error| error.to_string())?;
    let problem_b = problem_b.map_err(|error| error.to_string())?;
    let [first, second] = [(&problem_a, first), (&problem_b, second)]
        .map(|(problem, Identification { solution, .. })| Identified { problem, solution });
    compare(&first, &second, level).map_err(|error| error.to_string())
}

//! Two sessions compared, for the terminal and the screen.

mod words;

use std::path::Path;

use tautline_core::comparison::{Comparison, Identified, compare};
use tautline_core::estimation::{Control, EstimationError, Problem, Progress};
use tautline_session::{Import, Session, Timestamp};

use crate::documents::identification::extrapolated;
use crate::identification::{Fit, FitOrder, fit};
pub use words::{by_chance, differs, effect_name, unexplained, verdict};

/// Probability with which two sessions of the same robot are called different.
pub const LEVEL: f64 = 0.05;

/// What was read as a session, with what there is to tell about it; datasets and robots begin one.
///
/// # Errors
/// If it is a table: one sentence.
pub fn as_session(
    path: &Path,
    import: Import,
    now: Timestamp,
) -> Result<(Session, Vec<String>), String> {
    match import {
        Import::Session(session) => Ok((*session, Vec::new())),
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

/// Identifies a session as its settings ask, for a result that can be relied on. Where they ask for the published method
/// it is the joint one, because the published one has no standard deviations.
///
/// # Errors
/// One sentence on why there is no such result.
pub fn identify(
    session: &Session,
    observe: &mut dyn FnMut(&Progress) -> Control,
) -> Result<Fit, String> {
    if session.measurements.is_empty() {
        return Err("there are no measured poses, so nothing can be identified".to_owned());
    }
    let order = FitOrder::of(session).map_err(|error| error.to_string())?;
    let found = fit(order, observe).map_err(|error| error.to_string())?;
    match extrapolated(&found.dataset, &found.solution) {
        None => Ok(found),
        Some(place) => Err(place),
    }
}

/// The same for a comparison, which an identification that has not converged has nothing to tell to.
///
/// # Errors
/// One sentence on why there is no such result.
pub fn identify_to_compare(
    session: &Session,
    observe: &mut dyn FnMut(&Progress) -> Control,
) -> Result<Fit, String> {
    let found = identify(session, observe)?;
    if found.solution.converged() {
        Ok(found)
    } else {
        Err("the identification did not converge".to_owned())
    }
}

/// Compares two identifications, the second less the first.
///
/// # Errors
/// One sentence, if the robots have other cables or one of the sessions leaves its geometry open.
pub fn compare_fits([first, second]: [&Fit; 2], level: f64) -> Result<Comparison, String> {
    let problem = |fit| problem(fit).map_err(|error| error.to_string());
    let (problem_a, problem_b) = (problem(first)?, problem(second)?);
    let [first, second] = [(&problem_a, first), (&problem_b, second)]
        .map(|(problem, Fit { solution, .. })| Identified { problem, solution });
    compare(&first, &second, level).map_err(|error| error.to_string())
}

/// What a fit is the solution of.
fn problem(fit: &Fit) -> Result<Problem<'_>, EstimationError> {
    let mut problem = Problem::new(&fit.dataset)?.with_method(fit.method);
    let effects = &fit.solution.globals.effects;
    problem.free_effects = effects.get(fit.held..).unwrap_or_default().to_vec();
    Ok(problem)
}

//! How far each phase is, in one line.

use super::document::{Document, Stored};
use super::screen::{Progress, Standing, Step};
use crate::documents::identification::Explains;
use crate::wording::count;

/// How far a phase of this session is.
#[must_use]
pub fn of(document: &Document, step: Step) -> Standing {
    match step {
        Step::Precalibration => precalibration(document),
        Step::Modeling => modeling(document),
        Step::Measuring => measuring(document),
        Step::Identification => identification(document),
        Step::Adjustment => Standing::new(Progress::NotStarted, "nothing written yet"),
    }
}

fn precalibration(document: &Document) -> Standing {
    let phases = &document.session().phases;
    if phases.winch.is_empty() && phases.force.is_empty() && phases.home.is_empty() {
        return Standing::new(Progress::NotStarted, "values of the drawing are used");
    }
    Standing::new(Progress::InProgress, "tables imported")
}

fn modeling(document: &Document) -> Standing {
    if document.session().phases.elongation.is_empty() {
        return Standing::new(Progress::NotStarted, "constant stiffness is used");
    }
    Standing::new(Progress::InProgress, "elongation measured")
}

fn measuring(document: &Document) -> Standing {
    match document.session().measurements.len() {
        0 => Standing::new(Progress::NotStarted, "no poses measured"),
        poses => Standing::new(Progress::Done, format!("{poses} poses measured")),
    }
}

fn identification(document: &Document) -> Standing {
    let Some(fit) = document.fit() else {
        return match document.stored() {
            Stored::None => Standing::new(Progress::NotStarted, "not identified"),
            Stored::Current => Standing::new(Progress::InProgress, "identifying again"),
            Stored::OutOfDate => Standing::new(Progress::OutOfDate, "data changed since"),
        };
    };
    if !document.fit_is_current() {
        return Standing::new(Progress::OutOfDate, "data changed since");
    }
    let explains = Explains::of(fit.solution.p_value());
    let found = document
        .diagnosis()
        .filter(|_| document.diagnosis_is_current());
    let found = found.map_or(0, |diagnosed| diagnosed.diagnosis.findings.len());
    match explains {
        _ if found > 0 => Standing::new(
            Progress::Attention,
            format!("{} to look at", count(found, "finding")),
        ),
        _ if !fit.solution.outside_surface.is_empty() => {
            Standing::new(Progress::Attention, "elongation is extrapolated")
        }
        _ if !fit.solution.converged() => Standing::new(Progress::Attention, "did not converge"),
        Explains::Yes => Standing::new(Progress::Done, explains.words()),
        _ => Standing::new(Progress::Attention, explains.words()),
    }
}

//! How far each phase is, in one line.

use super::document::Document;
use super::screen::{Progress, Standing, Step};

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
        return Standing::new(Progress::NotStarted, "not identified");
    };
    if !document.fit_is_current() {
        return Standing::new(Progress::OutOfDate, "data changed since");
    }
    let explained = fit.solution.p_value().is_none_or(|p| p > 0.01);
    if explained {
        Standing::new(Progress::Done, "the model explains the data")
    } else {
        Standing::new(Progress::Attention, "the model does not explain the data")
    }
}

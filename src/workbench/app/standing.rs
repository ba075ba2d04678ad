//! How far each phase is, in one line.

use tautline_session::{Outcome, Stage};

use super::commands::robot::missing;
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
        Step::Adjustment => adjustment(document),
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
    let session = document.session();
    let measured = session.measurements.len();
    let missing = missing(session);
    let poses = |count: usize| match count {
        1 => "1 pose".to_owned(),
        count => format!("{count} poses"),
    };
    match (measured, missing) {
        (0, 0) => Standing::new(Progress::NotStarted, "no poses measured"),
        (0, _) => Standing::new(Progress::NotStarted, format!("{} planned", poses(missing))),
        (_, 0) => Standing::new(Progress::Done, format!("{} measured", poses(measured))),
        _ => Standing::new(
            Progress::InProgress,
            format!("{} measured, {missing} to go", poses(measured)),
        ),
    }
}

fn adjustment(document: &Document) -> Standing {
    let session = document.session();
    let verified = |stage: Stage| session.verifications().iter().any(|run| run.stage == stage);
    let Some(last) = session.adjustments().last() else {
        return if verified(Stage::Before) {
            Standing::new(Progress::InProgress, "measured before the adjustment")
        } else {
            Standing::new(Progress::NotStarted, "nothing written yet")
        };
    };
    match &last.outcome {
        Outcome::Written if document.fit().is_some() && !document.fit_is_current() => {
            Standing::new(Progress::OutOfDate, "data changed since it was written")
        }
        Outcome::Written if verified(Stage::After) => {
            Standing::new(Progress::Done, "written and verified")
        }
        Outcome::Written => Standing::new(Progress::InProgress, "written, not verified"),
        Outcome::RolledBack => Standing::new(Progress::NotStarted, "rolled back"),
        Outcome::Failed(_) => Standing::new(Progress::Attention, "writing failed"),
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

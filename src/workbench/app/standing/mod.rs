//! How far each phase is, in one line.

mod modeling;
mod precalibration;

pub use modeling::{elongation, pulleys};
pub use precalibration::{force_sensors, home, winches};

use super::document::Document;
use super::screen::{Progress, Standing, Step};

/// How far a phase of this session is.
#[must_use]
pub fn of(document: &Document, step: Step) -> Standing {
    match step {
        Step::Precalibration => precalibration::whole(document.calibration()),
        Step::Modeling => elongation(document),
        Step::Measuring => measuring(document),
        Step::Identification => identification(document),
        Step::Adjustment => Standing::new(Progress::NotStarted, "nothing written yet"),
    }
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

//! How far each phase is, in one line.

mod adjustment;
mod measuring;
mod modeling;
mod precalibration;

pub use modeling::{elongation, pulleys};
pub use precalibration::{force_sensors, home, winches};

use super::document::{Document, Stored};
use super::screen::{Progress, Standing, Step};
use tautline_workflow::documents::identification::Explains;
use tautline_workflow::wording::count;

/// How far a phase of this session is.
#[must_use]
pub fn of(document: &Document, step: Step) -> Standing {
    match step {
        Step::Precalibration => precalibration::whole(document.calibration()),
        Step::Modeling => elongation(document),
        Step::Measuring => measuring::whole(document),
        Step::Identification => identification(document),
        Step::Adjustment => adjustment::whole(document),
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

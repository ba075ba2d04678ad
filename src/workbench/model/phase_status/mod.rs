//! State of each phase, in one line.

mod adjustment;
mod measuring;
mod modeling;
mod precalibration;

pub use self::modeling::{elongation, pulleys, tolerances};
pub use self::precalibration::{force_sensors, home, winches};

use super::open_session::StoredFit;
use super::phase::{Phase, PhaseStatus, Progress};
use super::{Model, OpenSession, findings};
use tautline_workflow::identification::FitVerdict;
use tautline_workflow::wording::count;

#[must_use]
pub fn of(model: &Model, open: &OpenSession, step: Phase) -> PhaseStatus {
    match step {
        Phase::Precalibration => precalibration::whole(open.calibration()),
        Phase::Modeling => elongation(open),
        Phase::Measuring => measuring::whole(open),
        Phase::Identification => identification(open),
        Phase::Adjustment => adjustment::whole(open, model.review().changes().count()),
    }
}

fn identification(open: &OpenSession) -> PhaseStatus {
    let Some(fit) = open.fit() else {
        return match open.stored() {
            StoredFit::None => PhaseStatus::new(Progress::NotStarted, "not identified"),
            StoredFit::Current => PhaseStatus::new(Progress::InProgress, "identifying again"),
            StoredFit::OutOfDate => PhaseStatus::new(Progress::OutOfDate, "data changed since"),
        };
    };
    if !open.fit_is_current() {
        return PhaseStatus::new(Progress::OutOfDate, "data changed since");
    }
    let explains = FitVerdict::of(fit.solution.p_value());
    let found = open.diagnosis().filter(|_| open.diagnosis_is_current());
    let found = found.map_or(0, |diagnosed| findings::undecided(open, diagnosed).len());
    match explains {
        _ if found > 0 => PhaseStatus::new(
            Progress::Attention,
            format!("{} to look at", count(found, "finding")),
        ),
        _ if !fit.solution.outside_surface.is_empty() => {
            PhaseStatus::new(Progress::Attention, "elongation is extrapolated")
        }
        _ if !fit.solution.converged() => PhaseStatus::new(Progress::Attention, "did not converge"),
        FitVerdict::Adequate if !open.missing().is_empty() => {
            let poses = fit.dataset.measurements.len();
            let planned = poses + open.missing().len();
            let line = format!("from {poses} of {planned} poses: {}", explains.words());
            PhaseStatus::new(Progress::InProgress, line)
        }
        FitVerdict::Adequate => PhaseStatus::new(Progress::Done, explains.words()),
        _ => PhaseStatus::new(Progress::Attention, explains.words()),
    }
}

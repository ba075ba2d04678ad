//! State of the parts of phase 2.

use tautline_core::robot::PartTolerances;
use tautline_workflow::wording::count;

use super::precalibration::begun;
use crate::model::OpenSession;
use crate::model::phase::{PhaseStatus, Progress};

/// Elongation of the cables, which the phase needs.
#[must_use]
pub fn elongation(open: &OpenSession) -> PhaseStatus {
    let calibration = open.calibration();
    match &calibration.elongation {
        Some(Err(_)) => PhaseStatus::new(Progress::Attention, "no elongation surface found"),
        Some(Ok(fit)) => {
            let (degree, worst) = (fit.choice.surface.degree, fit.largest_residual_m * 1e3);
            let line = format!("degree {degree}, within {worst:.3} mm");
            begun(line, &calibration.with_elongation)
        }
        None => {
            let cables = &open.session().robot.cables;
            let measured = |c: &&tautline_core::robot::Cable| c.cable.elongation_surface.is_some();
            let elastic = |c: &&tautline_core::robot::Cable| c.cable.axial_stiffness_n.is_some();
            if cables.iter().all(|c| measured(&c)) {
                PhaseStatus::new(Progress::Done, "measured surface in the robot description")
            } else if cables.iter().any(|c| elastic(&c)) {
                PhaseStatus::new(Progress::NotStarted, "constant stiffness")
            } else {
                PhaseStatus::new(Progress::NotStarted, "no stretch modelled")
            }
        }
    }
}

#[must_use]
pub fn pulleys(open: &OpenSession) -> PhaseStatus {
    let cables = &open.session().robot.cables;
    let eyelets = cables.iter().filter(|c| c.pulley.radius_m <= 0.0).count();
    let line = match (eyelets, cables.len()) {
        (0, count) => format!("{count} with radius and axis"),
        (eyelets, count) if eyelets == count => format!("{count} eyelets"),
        (eyelets, count) => format!("{} pulleys, {eyelets} eyelets", count - eyelets),
    };
    PhaseStatus::new(Progress::Done, line)
}

#[must_use]
pub fn tolerances(open: &OpenSession) -> PhaseStatus {
    match &open.session().robot.tolerances {
        None => PhaseStatus::new(Progress::NotStarted, "parts count as exact"),
        Some(PartTolerances::Typical(_)) => PhaseStatus::new(Progress::Done, "typical"),
        Some(PartTolerances::Stated(stated)) => {
            let line = format!("{} stated", count(stated.effects.len(), "tolerance"));
            PhaseStatus::new(Progress::Done, line)
        }
    }
}

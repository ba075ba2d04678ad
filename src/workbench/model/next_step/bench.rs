//! Next step of phases 1 and 2: apply the bench measurements, then measure poses.

use tautline_workflow::precalibration::Table;
use tautline_workflow::wording::sentence;

use super::{NextStep, Problem, Remedy, plan, status};
use crate::model::command::ImportCommand;
use crate::model::edit::Edit;
use crate::model::phase::{Phase, Progress};
use crate::model::{Model, OpenSession, phase_status};

/// Applies measured values, those of phase 1 all at once.
pub(super) fn of(model: &Model, open: &OpenSession, phase: Phase, poses: usize) -> NextStep {
    let status = status(model, open, phase);
    let calibration = open.calibration();
    let (proposal, values) = match phase {
        Phase::Precalibration => (&calibration.with_all(), "values"),
        _ => (&calibration.with_elongation, "elongation"),
    };
    let robot = proposal.robot.as_ref().ok().filter(|_| !proposal.is_used);
    if let (Some(robot), Progress::InProgress) = (robot, status.progress) {
        let name = format!("apply measured {values}");
        let edit = Edit::SetRobot(Box::new(robot.clone()), name.clone());
        let apply = Remedy::new(sentence(&name), edit, "Then: measure poses.");
        return NextStep::new(status, apply);
    }
    let session = open.session();
    let then = "Then: connect the controller and measure.";
    let remedy = match session.plan.is_empty() && session.measurements.is_empty() {
        true => plan(poses, then).in_phase(Phase::Measuring),
        false => Remedy::go(Phase::Measuring, "Poses are planned."),
    };
    NextStep::new(status, remedy)
}

/// Tables without usable values.
pub(super) fn problems(open: &OpenSession, phase: Phase) -> Vec<Problem> {
    let of = open.calibration();
    let tables = match phase {
        Phase::Precalibration => vec![
            (Table::Winch, phase_status::winches(of), &of.with_winches),
            (
                Table::Force,
                phase_status::force_sensors(of),
                &of.with_force_sensors,
            ),
            (Table::Home, phase_status::home(of), &of.with_home),
        ],
        _ => vec![(
            Table::Elongation,
            phase_status::elongation(open),
            &of.with_elongation,
        )],
    };
    let problems = tables.into_iter().filter_map(|(table, status, proposal)| {
        let why = match (status.progress, &proposal.robot) {
            (Progress::Attention, _) => &status.line,
            (Progress::InProgress, Err(why)) => why,
            _ => return None,
        };
        let title = format!("Import {} again…", table.file_name());
        let then = "Measure it again, and import or type what was read.";
        let again = Remedy::new(title, ImportCommand::Ask(table), then);
        Some(Problem::new(sentence(why), again))
    });
    problems.collect()
}

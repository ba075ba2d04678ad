//! Tables of a study.

use tautline_workflow::report::document::{Section, Table};
use tautline_workflow::wording::units::significant;

use super::group::{laser_name, title};
use crate::plan::StudyPlan;
use crate::result::{CellResult, ErrorRange, StudyResult};

/// Maximum number of rows of a table; the result file contains all of them.
const ROWS: usize = 300;
const NONE: &str = "–";

fn mm(metres: Option<f64>) -> String {
    metres.map_or_else(|| NONE.to_owned(), |metres| significant(1e3 * metres, 3))
}

fn rms(range: Option<ErrorRange>) -> String {
    mm(range.map(|range| range.rms_m))
}

fn percent(count: u64, of: u64) -> String {
    match of {
        0 => NONE.to_owned(),
        of => significant(100.0 * count as f64 / of as f64, 3),
    }
}

/// All cells.
pub fn cells(plan: &StudyPlan, result: &StudyResult) -> Section {
    let mut section = Section::new("All cells");
    let mut table = Table::new(
        "Position error over the workspace and error of the entry points: expected and simulated; AP of ISO 9283 without the repeatability of the robot",
        2,
        &[
            "Robot",
            "laser",
            "laser sd mm",
            "poses",
            "expected mm",
            "simulated mm",
            "AP mm",
            "entry points mm",
            "simulated mm",
        ],
    );
    for cell in result.cells.iter().take(ROWS) {
        let planned = &cell.planned;
        let found = cell.simulated.as_ref();
        let mark = if found.is_some_and(|found| found.is_marked) {
            " *"
        } else {
            ""
        };
        table.push([
            title(plan, cell),
            laser_name(&planned.combination.laser).to_owned(),
            mm(planned.laser_sd_m),
            planned.combination.poses.to_string(),
            mm(planned.expected.position_m),
            rms(found.and_then(|found| found.position)) + mark,
            rms(found.and_then(|found| found.accuracy)),
            mm(planned.expected.entry_m),
            rms(found.and_then(|found| found.entry)),
        ]);
    }
    section.table(table);
    section.note("* Simulation differs from theory by more than 5 %.");
    if result.cells.len() > ROWS {
        section.note(format!(
            "{} more cells are listed in the result file.",
            result.cells.len() - ROWS
        ));
    }
    section
}

/// Cells in which theory and simulation differ.
pub fn marked(plan: &StudyPlan, result: &StudyResult) -> Table {
    let mut table = Table::new(
        "Cells in which simulation and theory differ by more than 5 %",
        2,
        &[
            "Robot",
            "laser",
            "poses",
            "expected mm",
            "simulated mm",
            "ratio",
            "interval",
        ],
    );
    let marked = result.cells.iter().filter_map(|cell| {
        let found = cell.simulated.as_ref().filter(|found| found.is_marked)?;
        Some((cell, found, found.over_expected?))
    });
    for (cell, found, [ratio, low, high]) in marked.take(ROWS) {
        let CellResult { planned, .. } = cell;
        table.push([
            title(plan, cell),
            laser_name(&planned.combination.laser).to_owned(),
            planned.combination.poses.to_string(),
            mm(planned.expected.position_m),
            rms(found.position),
            format!("{ratio:.3}"),
            format!("{low:.3} to {high:.3}"),
        ]);
    }
    table
}

/// Detection and effect of faults.
pub fn faults(plan: &StudyPlan, result: &StudyResult) -> Table {
    let mut table = Table::new(
        "Calibrations with and without a fault",
        2,
        &[
            "Robot",
            "laser",
            "poses",
            "with fault",
            "detected %",
            "false alarms %",
            "named right",
            "wrong",
            "error with fault mm",
        ],
    );
    for cell in result.cells.iter().take(ROWS) {
        let Some(found) = &cell.simulated else {
            continue;
        };
        table.push([
            title(plan, cell),
            laser_name(&cell.planned.combination.laser).to_owned(),
            cell.planned.combination.poses.to_string(),
            found.with_fault.of.to_string(),
            percent(found.with_fault.count, found.with_fault.of),
            percent(found.without_fault.count, found.without_fault.of),
            found.doctor.right.to_string(),
            found.doctor.wrong.to_string(),
            rms(found.position_with_fault),
        ]);
    }
    table
}

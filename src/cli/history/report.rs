//! Human-readable form of a history.

use tautline_workflow::history::{
    RobotHistory, RobotRecord, changes, date, next_calibration, rows,
};

use crate::output::say;
use crate::table::{self, mm};

/// Prints one row for each session, then the changes and the date of the next calibration.
pub fn print(record: &RobotRecord, found: &RobotHistory) {
    say!("{}", record.title());
    let mut table = table::numbers(&[
        "Session",
        "measured",
        "poses",
        "model explains",
        "largest sd mm",
        "largest move since before mm",
        "accuracy after mm",
    ]);
    let millimetres = |value: Option<f64>| value.map_or_else(String::new, |m| mm(m, 2));
    for row in rows(record, found) {
        table::push(
            &mut table,
            &[
                row.name,
                row.time.map_or_else(String::new, date),
                row.poses.to_string(),
                row.verdict.words().to_owned(),
                mm(row.largest_sd_m, 2),
                millimetres(row.largest_move_m),
                millimetres(row.accuracy_after_m),
            ],
        );
    }
    say!("{table}");
    let told = changes(record, found).into_iter();
    for sentence in told.chain(next_calibration(record, found)) {
        say!("{sentence}");
    }
}

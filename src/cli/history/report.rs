//! Human-readable form of a history.

use tautline_workflow::history::{
    RobotHistory, RobotRecord, changes, date, next_calibration, rows,
};

use crate::output::say;
use crate::table::{self, mm};

/// Prints one row for each session, then the changes and the date of the next calibration.
pub fn print(record: &RobotRecord, found: &RobotHistory) {
    say!("{}", record.title());
    let millimetres = |value: Option<f64>| value.map_or_else(String::new, |m| mm(m, 2));
    table::rows(rows(record, found)).print(&[
        ("Session", &|row| row.name.clone()),
        ("measured", &|row| row.time.map_or_else(String::new, date)),
        ("poses", &|row| row.poses.to_string()),
        ("model explains", &|row| row.verdict.words().to_owned()),
        ("largest sd mm", &|row| mm(row.largest_sd_m, 2)),
        ("largest move since before mm", &|row| {
            millimetres(row.largest_move_m)
        }),
        ("accuracy after mm", &|row| {
            millimetres(row.accuracy_after_m)
        }),
    ]);
    let told = changes(record, found).into_iter();
    for sentence in told.chain(next_calibration(record, found)) {
        say!("{sentence}");
    }
}

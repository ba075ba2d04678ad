//! Events in the life of a robot between its calibrations: `time,event`.

use std::io::BufRead;

use tautline_files::ReadError;

use crate::error::Loaded;
use crate::phases::read_rows;
use crate::session::Timestamp;
use crate::table::Table;

/// Name of the file in the record of a robot.
pub const EVENTS: &str = "events.csv";
const COLUMNS: [&str; 2] = ["time", "event"];

/// An event that may have changed the robot: a repair, a crash, a new cable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RobotEvent {
    /// Time of the event.
    pub time: Timestamp,
    /// Description in a few words.
    pub text: String,
}

/// Reads events, in the order of time; `file` is the name for messages. A time is a date such as `2026-06-12`, or has the time of
/// day, too (RFC 3339, UTC).
///
/// # Errors
/// The first row without a time or without a text, with its line and column.
pub fn read_events(reader: impl BufRead, file: &str) -> Result<Loaded<Vec<RobotEvent>>, ReadError> {
    let table = Table::open(reader, file)?;
    let [time, text] = table.require_all(COLUMNS)?;
    let events = read_rows(table, &COLUMNS, |row| {
        let said = row.text(time);
        let midnight = format!("{said}T00:00:00Z");
        let parsed = said.parse().or_else(|_| midnight.parse());
        let event = row.text(text);
        if event.is_empty() {
            return Err(row.unexpected(text, "what happened"));
        }
        Ok(RobotEvent {
            time: parsed.map_err(|_| {
                row.unexpected(
                    time,
                    "a date such as 2026-06-12 or a time such as 2026-06-12T08:00:00Z",
                )
            })?,
            text: event.to_owned(),
        })
    })?;
    Ok(events.map(|mut events| {
        events.sort_by_key(|event| event.time);
        events
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_have_a_date_or_a_time_and_come_in_the_order_of_time() {
        let text =
            "time,event\n2026-09-03,cable-2 replaced\n2026-06-12T14:30:00Z,\"crash, north wall\"\n";
        let read = read_events(text.as_bytes(), "events.csv")
            .expect("read")
            .value;
        let told: Vec<String> = (read.iter())
            .map(|event| format!("{} {}", event.time, event.text))
            .collect();
        assert_eq!(
            told,
            [
                "2026-06-12T14:30:00Z crash, north wall",
                "2026-09-03T00:00:00Z cable-2 replaced"
            ]
        );
    }

    #[test]
    fn what_is_no_event_is_said_with_line_and_column() {
        for (rows, expected) in [
            (
                "03.09.2026,repair",
                "events.csv, line 2, column \"time\": found \"03.09.2026\", expected a date such as 2026-06-12 or a time such as \
                 2026-06-12T08:00:00Z",
            ),
            (
                "2026-09-03,",
                "events.csv, line 2, column \"event\": found an empty cell, expected what happened",
            ),
        ] {
            let text = format!("time,event\n{rows}\n");
            let error = read_events(text.as_bytes(), "events.csv").expect_err("refused");
            assert_eq!(error.to_string(), expected);
        }
    }
}

//! The sessions of a record as a table, for terminal, window and report.

use tautline_core::history::{History, RobotPart, SmoothedState};
use tautline_session::{Timestamp, csv_row};

use super::{RecordedSession, RobotHistory, RobotRecord};
use crate::identification::FitVerdict;

/// One session in the table of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordRow {
    /// Name of its file or folder.
    pub name: String,
    /// Time of the readings, if known.
    pub time: Option<Timestamp>,
    /// Operator who wrote values to the controller or accepted the robot in the session.
    pub operator: Option<String>,
    /// Number of its poses.
    pub poses: usize,
    /// Adequacy of the model of the session.
    pub verdict: FitVerdict,
    /// Largest standard deviation of a coordinate of a pulley, with all sessions taken into account (m).
    pub largest_sd_m: f64,
    /// Largest move of a pulley since the session before (m).
    pub largest_move_m: Option<f64>,
    /// Mean pose accuracy that was measured after the adjustment (m).
    pub accuracy_after_m: Option<f64>,
    /// Effects in its model, with their cables.
    pub findings: Vec<String>,
}

/// The table of a record, one row for each session in the order of time.
#[must_use]
pub fn rows(record: &RobotRecord, found: &RobotHistory) -> Vec<RecordRow> {
    let sessions = record.sessions.iter().enumerate();
    sessions
        .map(|(index, session)| row(index, session, &found.history))
        .collect()
}

fn row(index: usize, session: &RecordedSession, history: &History) -> RecordRow {
    let largest = |value: &dyn Fn(&[SmoothedState]) -> f64| {
        let parts = history.parts.iter().zip(&history.states);
        let pulleys = parts.filter(|(part, _)| matches!(part, RobotPart::Pulley(_)));
        pulleys.map(|(_, states)| value(states)).fold(0.0, f64::max)
    };
    let variance = |states: &[SmoothedState]| {
        let diagonal = states[index].covariance.diagonal();
        diagonal.iter().copied().fold(0.0, f64::max)
    };
    let moved =
        |before: usize| largest(&|states| (&states[index].value - &states[before].value).norm());
    RecordRow {
        name: session.name.clone(),
        time: session.time,
        operator: session.operator.clone(),
        poses: session.identification.dataset.measurements.len(),
        verdict: FitVerdict::of(session.identification.solution.p_value()),
        largest_sd_m: largest(&variance).sqrt(),
        largest_move_m: index.checked_sub(1).map(moved),
        accuracy_after_m: session.accuracy_after_m,
        findings: session.effects.clone(),
    }
}

/// The smoothed pulleys as CSV: one row for each session and cable, with coordinates and standard deviations (m).
#[must_use]
pub fn pulleys_csv(record: &RobotRecord, found: &RobotHistory) -> String {
    let mut table = csv_row(&[
        "session", "time", "cable", "x_m", "y_m", "z_m", "sd_x_m", "sd_y_m", "sd_z_m",
    ]);
    let history = &found.history;
    for (index, session) in record.sessions.iter().enumerate() {
        let time = session.time.map_or_else(String::new, |t| t.to_string());
        for (part, of) in history.parts.iter().enumerate() {
            let RobotPart::Pulley(cable) = of else {
                continue;
            };
            let state = &history.states[part][index];
            let mut columns = vec![String::new(); 6];
            for (k, axis) in history.axes[part].iter().enumerate() {
                columns[*axis] = state.value[k].to_string();
                let sd = state.covariance[(k, k)].max(0.0).sqrt();
                columns[3 + *axis] = sd.to_string();
            }
            let cable = &record.robot().cables[*cable].name;
            let mut row = vec![session.name.as_str(), &time, cable];
            row.extend(columns.iter().map(String::as_str));
            table += &csv_row(&row);
        }
    }
    table
}

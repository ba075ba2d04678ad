//! Table of the sessions of a record; two selected ones can be compared.

use std::sync::Arc;

use egui::{Button, Ui};
use tautline_workflow::history::{RecordRow, date, rows};
use tautline_workflow::identification::FitVerdict;
use tautline_workflow::wording::list;
use tautline_workflow::wording::units::mm;

use super::PanelState;
use crate::model::command::{Outbox, RecordCommand};
use crate::model::record::OpenRecord;
use crate::theme;
use crate::widgets::{Cell, TableColumn, UiExt, table};

pub(super) fn show(
    ui: &mut Ui,
    open: &Arc<OpenRecord>,
    panel: &mut PanelState,
    outbox: &mut Outbox,
) {
    let sessions = rows(&open.record, &open.found);
    let columns: Vec<_> = columns(ui)
        .into_iter()
        .filter(|one| one.is_used(&sessions))
        .collect();
    let heads: Vec<TableColumn<'_>> = columns.iter().map(|one| one.head).collect();
    let cells = sessions.iter().enumerate().map(|(index, row)| {
        let name = match panel.chosen.iter().position(|known| *known == index) {
            Some(side) => format!("{} ({})", row.name, ["A", "B"][side]),
            None => row.name.clone(),
        };
        let others = columns.iter().skip(1).map(|one| (one.cell)(row));
        [Cell::new(name)].into_iter().chain(others).collect()
    });
    let cells: Vec<Vec<Cell>> = cells.collect();
    let touched = table(ui, &heads, &cells, Some(panel.shown));
    if let Some(index) = touched.clicked {
        panel.shown = index;
        choose(&mut panel.chosen, index);
    }
    if let Some(index) = touched.double_clicked {
        outbox.send(RecordCommand::OpenSession(index));
    }
    ui.horizontal_wrapped(|ui| {
        let pair = <[usize; 2]>::try_from(panel.chosen.as_slice()).ok();
        let button = ui.add_enabled(pair.is_some(), Button::new("Compare A and B"));
        let button = button.on_disabled_hover_text("Click two sessions");
        if let Some(pair) = pair.filter(|_| button.clicked()) {
            outbox.send(RecordCommand::Compare(pair));
        }
        let button = ui.add_enabled(pair.is_some(), Button::new("Check B against A"));
        let button = button.on_disabled_hover_text("Click two sessions");
        if let Some(pair) = pair.filter(|_| button.clicked()) {
            outbox.send(RecordCommand::Check(pair));
        }
        let button = ui.button("Plan a health check");
        let button = button.on_hover_text(
            "Eight poses that show whether the robot is still as in the session that is shown",
        );
        if button.clicked() {
            outbox.send(RecordCommand::PlanCheck(Some(panel.shown)));
        }
    });
    ui.muted("Click two sessions to compare them, double-click one to open it.");
}

/// Column of the table, shown if a session has a value for it.
struct RecordColumn {
    head: TableColumn<'static>,
    cell: Box<dyn Fn(&RecordRow) -> Cell>,
    /// Whether a session has a value for the column.
    is_said: fn(&RecordRow) -> bool,
}

impl RecordColumn {
    fn is_used(&self, sessions: &[RecordRow]) -> bool {
        sessions.iter().any(self.is_said)
    }
}

fn columns(ui: &Ui) -> [RecordColumn; 8] {
    let palette = theme::of(ui);
    let always = |head, cell| RecordColumn {
        head,
        cell,
        is_said: |_| true,
    };
    let millimetres = |value: Option<f64>| {
        Cell::new(value.map_or_else(|| "–".to_owned(), |metres| mm(metres, 2)))
    };
    let model = move |row: &RecordRow| {
        let (words, colour) = match row.verdict {
            FitVerdict::Adequate => ("explains", palette.good),
            FitVerdict::Doubtful => ("hardly explains", palette.warning),
            FitVerdict::Inadequate => ("does not explain", palette.bad),
            FitVerdict::NoiseOverstated => ("less noise than stated", palette.warning),
            FitVerdict::Untested => ("cannot be tested", palette.muted),
        };
        Cell::new(words).coloured(colour)
    };
    [
        always(
            TableColumn::words("Session"),
            Box::new(|row| Cell::new(&row.name)),
        ),
        RecordColumn {
            head: TableColumn::words("Measured"),
            cell: Box::new(|row| Cell::new(row.time.map_or_else(|| "–".to_owned(), date))),
            is_said: |row| row.time.is_some(),
        },
        RecordColumn {
            head: TableColumn::words("Operator"),
            cell: Box::new(|row| Cell::new(row.operator.clone().unwrap_or_default())),
            is_said: |row| row.operator.is_some(),
        },
        always(
            TableColumn::number("Poses", ""),
            Box::new(|row| Cell::new(row.poses.to_string())),
        ),
        always(TableColumn::words("Model"), Box::new(model)),
        always(
            TableColumn::number("Largest move", "mm"),
            Box::new(move |row| millimetres(row.largest_move_m)),
        ),
        RecordColumn {
            head: TableColumn::number("Accuracy after", "mm"),
            cell: Box::new(move |row| millimetres(row.accuracy_after_m)),
            is_said: |row| row.accuracy_after_m.is_some(),
        },
        RecordColumn {
            head: TableColumn::words("Effects"),
            cell: Box::new(|row| Cell::new(list(&row.findings))),
            is_said: |row| !row.findings.is_empty(),
        },
    ]
}

/// Adds a session to the two compared ones, the earlier first, in place of the one clicked longest ago.
fn choose(chosen: &mut Vec<usize>, index: usize) {
    match chosen.iter().position(|known| *known == index) {
        Some(at) => {
            chosen.remove(at);
        }
        None => {
            if chosen.len() == 2 {
                chosen.remove(0);
            }
            chosen.push(index);
            chosen.sort_unstable();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::choose;

    #[test]
    fn two_sessions_are_chosen_the_earlier_first_and_a_third_replaces_one() {
        let mut chosen = Vec::new();
        for (clicked, expected) in [(4, vec![4]), (1, vec![1, 4]), (6, vec![4, 6]), (6, vec![4])] {
            choose(&mut chosen, clicked);
            assert_eq!(chosen, expected, "after {clicked}");
        }
    }
}

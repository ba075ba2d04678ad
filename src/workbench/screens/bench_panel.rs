//! Common parts of the panels of phases 1 and 2: tables to import or type, fits per cable, and the step that applies
//! fitted values to the robot.

use egui::Ui;
use tautline_core::robot::Robot;
use tautline_session::{PhaseData, Session};

use crate::model::command::{Command, ImportCommand, Outbox, ViewCommand};
use crate::model::edit::Edit;
use crate::model::{Model, OpenSession, Selection};
use crate::theme;
use crate::views::plots::small;
use crate::widgets::{Cell, Import, Rows, RowsEdit, UiExt, Verdict, import_row, primary, rows};
use tautline_workflow::plot::figure::{Axis, Band, Figure, Point, Series};
use tautline_workflow::precalibration::{Calibration, PerCable, Proposal, Table};
use tautline_workflow::wording::units::fixed;

#[derive(Debug, Default)]
pub struct TableInput {
    pub path: String,
    /// Text of the rows to add.
    pub rows: String,
}

/// Open session with the calibration from its tables, and the outbox for commands.
pub struct Bench<'a> {
    pub open: &'a OpenSession,
    /// Fits of its tables.
    pub calibration: &'a Calibration,
    pub selection: Selection,
    pub outbox: &'a mut Outbox,
}

/// Residuals per cable, with the band of the limit.
pub struct Residuals<'a> {
    pub name: &'a str,
    /// Horizontal axis.
    pub x: Axis,
    /// Unit of residuals and limit.
    pub unit: &'static str,
    /// Half height of the band.
    pub limit: f64,
    /// Cables with their residuals.
    pub points: Vec<(usize, Vec<Point>)>,
}

impl<'a> Bench<'a> {
    /// Draws title and purpose of the panel; `None` if no session is open.
    pub fn begin(
        ui: &mut Ui,
        title: &str,
        purpose: &str,
        model: &'a Model,
        outbox: &'a mut Outbox,
    ) -> Option<Self> {
        ui.heading(title);
        ui.muted(purpose);
        let open = model.open.as_ref()?;
        Some(Self {
            open,
            calibration: open.calibration(),
            selection: model.selection,
            outbox,
        })
    }

    /// Reports an error of an input.
    pub fn refuse(&mut self, message: String) {
        self.outbox.send(Command::Refuse(message));
    }

    pub fn session(&self) -> &'a Session {
        self.open.session()
    }

    pub fn robot(&self) -> &'a Robot {
        &self.open.session().robot
    }

    /// Draws the row for importing a table.
    pub fn import(&mut self, ui: &mut Ui, table: Table, path: &mut String) {
        match import_row(ui, table.file_name(), path) {
            Some(Import::Browse) => self.outbox.send(ImportCommand::Ask(table)),
            Some(Import::Path(path)) => self.outbox.send(ImportCommand::Read(table, path)),
            None => {}
        }
    }

    /// Applies an edit of the tables, or reports an error of the input.
    pub fn edit_rows(
        &mut self,
        ui: &mut Ui,
        editor: &Rows<'_>,
        draft: &mut String,
        change: impl FnOnce(&mut PhaseData, RowsEdit),
    ) {
        let noun = editor.noun.to_lowercase();
        let Some(edit) = rows(ui, editor, draft) else {
            return;
        };
        let what = match &edit {
            RowsEdit::Wrong(message) => return self.refuse(message.clone()),
            RowsEdit::Set(row, ..) => format!("change {noun} {}", row + 1),
            RowsEdit::Add(rows) if rows.len() == 1 => format!("add {noun}"),
            RowsEdit::Add(rows) => format!("add {} {noun}s", rows.len()),
            RowsEdit::Remove(row) => format!("remove {noun} {}", row + 1),
        };
        let mut phases = self.session().phases.clone();
        change(&mut phases, edit);
        self.outbox.send(Edit::SetPhases(Box::new(phases), what));
    }

    /// Draws the step that applies fitted values to the robot; `what` is its name in the undo menu.
    pub fn propose(&mut self, ui: &mut Ui, proposal: &Proposal, button: &str, what: &str) {
        for sentence in &proposal.left_out {
            ui.doubtful(&format!("{sentence}."));
        }
        match &proposal.robot {
            Err(message) => ui.bad(&format!("{message}.")),
            Ok(_) if proposal.is_used && proposal.left_out.is_empty() => {
                ui.muted("These values are applied.");
            }
            Ok(robot) => {
                if primary(ui, button, !proposal.is_used).clicked() {
                    let robot = Box::new(robot.clone());
                    self.outbox.send(Edit::SetRobot(robot, what.to_owned()));
                }
            }
        }
    }

    /// Draws residuals; a click on a point selects its cable.
    pub fn residuals(&mut self, ui: &mut Ui, plot: Residuals<'_>) {
        let Residuals { limit, unit, .. } = plot;
        let series = plot.points.into_iter();
        let figure = Figure {
            x: plot.x,
            y: Axis::new("Residual", unit),
            bands: vec![Band {
                name: format!("within {limit} {unit}"),
                y: [-limit, limit],
            }],
            series: series
                .map(|(cable, points)| Series::of_cable(cable, self.cable_name(cable), points))
                .collect(),
            has_zero_line: true,
            ..Figure::default()
        };
        let clicked = small::show(ui, plot.name, &figure, 176.0, self.selection);
        if let Some(cable) = clicked.and_then(|selection| selection.cable) {
            self.select_cable(cable);
        }
    }

    /// Selects a cable in all views.
    pub fn select_cable(&mut self, cable: usize) {
        self.outbox
            .send(ViewCommand::Select(self.selection.with_cable(cable)));
    }

    /// Selected cable; otherwise the first whose fit fails, otherwise the first measured one.
    pub fn chosen_cable<T>(&self, fits: &[PerCable<T>], passes: impl Fn(&T) -> bool) -> usize {
        let failed = |one: &&PerCable<T>| !one.fit.as_ref().is_ok_and(&passes);
        let first = fits.iter().find(failed).or(fits.first());
        self.selection
            .cable
            .filter(|cable| *cable < self.robot().cable_count())
            .unwrap_or_else(|| first.map_or(0, |one| one.cable))
    }

    pub fn cable_cell(&self, ui: &Ui, cable: usize) -> Cell {
        Cell::new(self.cable_name(cable)).with_dot(theme::of(ui).cable(cable))
    }

    /// Name of a cable, with its number if the name does not contain it.
    pub fn cable_name(&self, cable: usize) -> String {
        let number = (cable + 1).to_string();
        match self.robot().cables.get(cable) {
            Some(found) if found.name.contains(&number) => found.name.clone(),
            Some(found) => format!("{number} {}", found.name),
            None => number,
        }
    }

    /// Draws a small button for each cable.
    pub fn choose_cable(&mut self, ui: &mut Ui, chosen: usize) {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = theme::GRID;
            for cable in 0..self.robot().cable_count() {
                let text = egui::RichText::new((cable + 1).to_string());
                let response = ui.selectable_label(cable == chosen, text);
                let line = response.rect.with_min_y(response.rect.bottom() - 2.0);
                ui.painter()
                    .rect_filled(line, 1.0, theme::of(ui).cable(cable));
                let name = self.cable_name(cable);
                response.widget_info(|| {
                    egui::WidgetInfo::selected(egui::Role::Tab, true, cable == chosen, &name)
                });
                if response.on_hover_text(&name).clicked() {
                    self.select_cable(cable);
                }
            }
        });
    }
}

pub fn verdict_cell(ui: &Ui, passed: bool) -> Cell {
    match passed {
        true => Cell::verdict(ui, Verdict::Good, "passed"),
        false => Cell::verdict(ui, Verdict::Bad, "failed"),
    }
}

/// Number, or a dash if missing.
pub fn or_dash(value: Option<f64>, decimals: usize) -> Cell {
    Cell::new(value.map_or("–".to_owned(), |value| fixed(value, decimals)))
}

/// Number of decimals that shows two digits of a standard deviation, within limits.
pub fn decimals_for(sd: f64, least: usize, most: usize) -> usize {
    if !(sd > 0.0 && sd.is_finite()) {
        return most;
    }
    let wanted = 1.0 - sd.log10().floor();
    (wanted.max(0.0) as usize).clamp(least, most)
}

#[cfg(test)]
mod tests {
    use super::decimals_for;

    #[test]
    fn decimals_show_two_digits_of_the_standard_deviation() {
        for (sd, decimals) in [(0.012, 3), (0.5, 2), (3.0, 1), (40.0, 1), (1e-9, 6)] {
            assert_eq!(decimals_for(sd, 1, 6), decimals, "{sd}");
        }
        assert_eq!(decimals_for(f64::NAN, 1, 4), 4);
    }
}

//! Comparison of the user's simulator with the machine: differences of the readings and their explanation.

use egui::Ui;
use tautline_core::diagnosis::Quantity;
use tautline_workflow::replay::ReplayedReading;
use tautline_workflow::wording::sentence;

use crate::model::command::{COMPARING, CompareCommand, Outbox, ViewCommand};
use crate::model::comparison::SimulatorComparison;
use crate::model::{Model, OpenSession};
use crate::theme::GRID;
use crate::views::plots::small;
use crate::widgets::{Cell, TableColumn, UiExt, choice, page, table};

#[derive(Debug, Default)]
pub struct PanelState {
    /// Plotted kind of reading; by default the one with the largest error.
    shown: Option<Quantity>,
}

/// Greatest width of the page, and height of its plot (points).
const WIDTH: f32 = 860.0;
const PLOT: f32 = 280.0;

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    page(ui, WIDTH, 4.0 * GRID, |ui| {
        ui.horizontal(|ui| {
            ui.heading("Simulator and machine");
            if ui.button("Choose readings…").clicked() {
                outbox.send(CompareCommand::AskSimulator);
            }
            if ui.button("Back").clicked() {
                outbox.send(ViewCommand::Go(model.previous_screen()));
            }
        });
        ui.muted("Drive your simulator to the poses of this session and save its readings in the columns of poses.csv: pose, x_m to qz, and \
             length_1_m, force_1_n, laser_m or others.");
        ui.add_space(2.0 * GRID);
        let session = model.open.as_ref().map(OpenSession::id);
        let of_session = |one: &&SimulatorComparison| Some(one.session) == session;
        let compared = model.comparison.simulator.as_ref().filter(of_session);
        match compared.map(|one| (&one.file, &one.result)) {
            Some((file, Ok(replay))) => {
                let document = replay.document();
                ui.muted(&format!("{file}: {} poses", document.poses));
                readings(ui, &document.readings);
                let read = document.readings.iter();
                for reading in read.filter(|one| !one.causes.is_empty()) {
                    ui.label(reading.explained());
                }
                for text in document.sentences() {
                    ui.label(text);
                }
                ui.add_space(2.0 * GRID);
                let mut shown = panel.shown.unwrap_or_else(|| replay.worst());
                ui.horizontal(|ui| {
                    for quantity in Quantity::ALL {
                        let is_read = document
                            .readings
                            .iter()
                            .any(|one| one.reading == quantity.name());
                        let name = sentence(quantity.name());
                        if is_read && choice(ui, &mut shown, quantity, &name).clicked() {
                            panel.shown = Some(quantity);
                        }
                    }
                });
                let name = "Plot: errors of the simulator and of the identified model";
                let figure = replay.figure(shown);
                if let Some(selection) = small::show(ui, name, &figure, PLOT, model.selection) {
                    outbox.send(ViewCommand::Select(selection));
                }
            }
            Some((_, Err(error))) => ui.bad(error),
            None if model.tasks.runs(COMPARING) => {
                ui.spinner();
            }
            None => ui.empty("No readings of a simulator are chosen."),
        }
    });
}

fn readings(ui: &mut Ui, readings: &[ReplayedReading]) {
    let columns = ReplayedReading::HEADINGS.map(|title| match title {
        "Reading" | "Unit" => TableColumn::words(title),
        _ => TableColumn::number(title, ""),
    });
    let rows = readings
        .iter()
        .map(|reading| reading.cells().map(Cell::new).into());
    table(ui, &columns, &rows.collect::<Vec<_>>(), None);
    ui.muted("Errors, root mean square.");
}

//! Differences of the pulleys and their significance.

use egui::Ui;
use tautline_core::comparison::{Comparison, PulleyDifference, Test};

use crate::model::command::{Outbox, ViewCommand};
use crate::model::{Model, Selection};
use crate::screens::bench_panel::decimals_for;
use crate::theme;
use crate::widgets::{Cell, TableColumn, UiExt, Verdict, table};
use tautline_workflow::comparison::common_motion;
use tautline_workflow::wording::units::mm;

/// Draws the part; returns the clicked cable.
pub fn show(
    ui: &mut Ui,
    model: &Model,
    compared: &Comparison,
    outbox: &mut Outbox,
) -> Option<usize> {
    ui.section("Pulleys, B minus A");
    let columns = [
        TableColumn::words("Cable"),
        TableColumn::number("x", "mm"),
        TableColumn::number("y", "mm"),
        TableColumn::number("z", "mm"),
        TableColumn::number("Distance ±", "mm"),
        TableColumn::words("Verdict"),
        TableColumn::words("Chance"),
    ];
    let decimals = decimals(compared);
    let pulleys = compared.pulleys.iter().enumerate();
    let rows: Vec<Vec<Cell>> = pulleys
        .map(|(index, pulley)| row(ui, index, pulley, decimals))
        .collect();
    let touched = table(ui, &columns, &rows, model.selection.cable);
    if let Some(cable) = touched.clicked {
        let selection = Selection {
            cable: Some(cable),
            ..model.selection
        };
        outbox.send(ViewCommand::Select(selection));
    }
    let motion = common_motion(compared).unwrap_or_default();
    ui.muted(&format!(
            "{motion} Relative to the pulleys that did not move, ± one standard deviation. Chance: how often noise alone \
             makes such a difference, corrected for the number of tests.",
        ));
    touched.clicked
}

/// Number of decimals for all pulleys, from the most precise one.
fn decimals(compared: &Comparison) -> usize {
    let sds = compared.pulleys.iter().map(|pulley| {
        let shown = pulley.relative.unwrap_or(pulley.raw);
        shown.length_sd_m() * 1e3
    });
    decimals_for(sds.fold(f64::INFINITY, f64::min), 1, 3)
}

/// Probability of such a difference by chance, short enough for a table.
fn chance(test: Test) -> String {
    match test.p_corrected {
        p if p < 1e-6 => "under 1 in a million".to_owned(),
        p if p > 0.5 => "expected".to_owned(),
        p if p > 0.05 => format!("{:.0} in 100", 100.0 * p),
        p => format!("1 in {:.0}", 1.0 / p),
    }
}

/// Cell of whether something differs, in a word.
pub(super) fn verdict_cell(ui: &Ui, differs: Option<bool>, word: &str) -> Cell {
    match differs {
        None => Cell::new("not determined").coloured(theme::of(ui).muted),
        Some(true) => Cell::verdict(ui, Verdict::Doubtful, word),
        Some(false) => Cell::verdict(ui, Verdict::Good, "unchanged"),
    }
}

fn row(ui: &Ui, index: usize, pulley: &PulleyDifference, decimals: usize) -> Vec<Cell> {
    let palette = theme::of(ui);
    let shown = pulley.relative.unwrap_or(pulley.raw);
    let millimetres = |metres: f64| Cell::new(mm(metres, decimals));
    let verdict = verdict_cell(ui, pulley.test.map(|_| pulley.moved), "moved");
    let [x, y, z] = shown.vector_m.into();
    let chance = pulley.test.map_or_else(String::new, chance);
    vec![
        Cell::new(&pulley.cable).with_dot(palette.cable(index)),
        millimetres(x),
        millimetres(y),
        millimetres(z),
        Cell::new(format!(
            "{:.decimals$} ± {:.decimals$}",
            shown.length_m() * 1e3,
            shown.length_sd_m() * 1e3
        )),
        verdict,
        Cell::new(chance).coloured(palette.muted),
    ]
}

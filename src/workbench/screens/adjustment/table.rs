//! Controller values beside identified ones, by pulley and effect.

use egui::Ui;
use tautline_core::robot::Cable;
use tautline_link::adjusting::Difference;

use super::PanelState;
use crate::model::command::Outbox;
use crate::model::command::ViewCommand;
use crate::model::{Model, OpenSession};
use crate::theme::{self, GRID};
use crate::widgets::{Cell, TableColumn, TableResponse, UiExt, checkbox, table};
use tautline_workflow::wording::parameters::{cable_of, title, unit};
use tautline_workflow::wording::units::{display_unit, fixed, signed};

/// Columns. The unit has its own column, because effects have various units.
const COLUMNS: [TableColumn<'static>; 7] = [
    TableColumn::words("Parameter"),
    TableColumn::number("Controller", ""),
    TableColumn::number("Identified", ""),
    TableColumn::number("Difference", ""),
    TableColumn::number("±", ""),
    TableColumn::words("Unit"),
    TableColumn::number("Gain", "mm"),
];

/// Draws the table; unchanged parameters only on request.
pub(super) fn show(
    ui: &mut Ui,
    model: &Model,
    open: &OpenSession,
    panel: &mut PanelState,
    outbox: &mut Outbox,
    differences: &[Difference],
) {
    let all = panel.all;
    let shown: Vec<&Difference> = differences
        .iter()
        .filter(|line| {
            let is_other = line.is_writable_change() || line.is_unknown_effect();
            all || line.sd.is_some() || is_other
        })
        .collect();
    let cables = &open.session().robot.cables;
    let clicked = lines(ui, shown.iter().copied(), cables).clicked;
    if let Some(cable) = clicked.and_then(|k| cable_of(cables, &shown.get(k)?.name)) {
        outbox.send(ViewCommand::Select(model.selection.with_cable(cable)));
    }
    ui.add_space(GRID);
    ui.muted("±: the standard deviation of the identified value. Gain: the part of the platform's position error that returns if this value alone is not written.");
    checkbox(ui, &mut panel.all, "Show unchanged parameters");
    if shown.is_empty() {
        ui.muted("There is nothing to compare.");
    }
}

/// Draws a row for each parameter.
pub(crate) fn lines<'a>(
    ui: &mut Ui,
    lines: impl Iterator<Item = &'a Difference>,
    cables: &[Cable],
) -> TableResponse {
    let lines: Vec<&Difference> = lines.collect();
    let rows: Vec<Vec<Cell>> = lines.iter().map(|line| row(ui, line, cables)).collect();
    let touched = table(ui, &COLUMNS, &rows, None);
    if lines
        .iter()
        .any(|line| !line.in_model && line.is_writable_change())
    {
        let text =
            "none: the model has no such effect, so the controller gets the value without effect.";
        ui.muted(text);
    }
    touched
}

fn row(ui: &Ui, line: &Difference, cables: &[Cable]) -> Vec<Cell> {
    let palette = theme::of(ui);
    let (scale, unit) = unit(&line.name, line.unit).map_or((1.0, None), |unit| {
        let (scale, unit) = display_unit(unit);
        (scale, Some(unit))
    });
    let decimals = decimals(line.sd.map(|sd| sd * scale), unit);
    let number = |value: f64| Cell::new(fixed(value * scale, decimals));
    let none = || Cell::new("–");
    let name = Cell::new(title(&line.name, cables));
    let difference = line
        .difference
        .map_or_else(none, |value| Cell::new(signed(value * scale, decimals)));
    vec![
        match cable_of(cables, &line.name) {
            Some(index) => name.with_dot(palette.cable(index)),
            None => name,
        },
        line.controller.map_or_else(none, number),
        match line.identified {
            Some(value) if line.in_model => number(value),
            Some(value) => Cell::new(format!("none: {}", value * scale)),
            None => Cell::new("none"),
        },
        difference.coloured(if line.is_writable_change() {
            palette.accent
        } else {
            palette.muted
        }),
        line.sd.map_or_else(Cell::default, number),
        Cell::new(match unit {
            Some("degrees") => "°",
            other => other.unwrap_or_default(),
        })
        .coloured(palette.muted),
        line.gain_m
            .map_or_else(Cell::default, |gain_m| Cell::new(fixed(1e3 * gain_m, 2))),
    ]
}

/// Number of decimals at which the standard deviation has two digits.
fn decimals(sd: Option<f64>, unit: Option<&str>) -> usize {
    let usual = match unit {
        None => 0,
        Some("mm") => 2,
        Some(_) => 4,
    };
    let Some(sd) = sd.filter(|sd| *sd > 0.0 && sd.is_finite()) else {
        return usual;
    };
    let digits = 1.0 - sd.log10().floor();
    digits.clamp(0.0, 6.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_follow_the_standard_deviation() {
        assert_eq!(decimals(Some(0.31), Some("mm")), 2);
        assert_eq!(decimals(Some(12.0), Some("mm")), 0);
        assert_eq!(decimals(Some(0.0042), Some("degrees")), 4);
        assert_eq!(decimals(None, Some("mm")), 2);
        assert_eq!(decimals(None, None), 0);
    }
}

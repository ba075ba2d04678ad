//! What the controller holds beside what was identified, by pulley.

use egui::Ui;
use tautline_core::robot::Cable;
use tautline_link::adjusting::Difference;

use crate::app::commands::ViewCommand;
use crate::app::theme::{self, GRID};
use crate::app::{Selection, State};
use crate::widgets::{Cell, Column, muted, table};

/// Columns; angles have their sign in the cells.
const COLUMNS: [Column<'static>; 5] = [
    Column::words("Parameter"),
    Column::number("Controller", "mm"),
    Column::number("Identified", "mm"),
    Column::number("Difference", "mm"),
    Column::number("Standard deviation", "mm"),
];

/// Draws the table; parameters that stay as they are only where they are asked for.
pub(super) fn show(ui: &mut Ui, state: &mut State, differences: &[Difference]) {
    let Some(document) = &state.document else {
        return;
    };
    let all = state.screens.adjustment.all;
    let shown: Vec<&Difference> = differences
        .iter()
        .filter(|line| all || line.sd.is_some() || line.is_writable_change())
        .collect();
    let cables = &document.session().robot.cables;
    let of_line: Vec<Option<usize>> = shown.iter().map(|line| cable_of(cables, line)).collect();
    let lines = shown.iter().zip(&of_line);
    let rows: Vec<Vec<Cell>> = lines
        .map(|(line, cable)| row(ui, line, cable.and_then(|k| Some((k, cables.get(k)?)))))
        .collect();
    let touched = table(ui, &COLUMNS, &rows, None);
    if let Some(cable) = touched.clicked.and_then(|k| of_line.get(k).copied()?) {
        let selection = Selection {
            cable: Some(cable),
            ..state.selection
        };
        state.outbox.send(ViewCommand::Select(selection));
    }
    ui.add_space(GRID);
    ui.checkbox(
        &mut state.screens.adjustment.all,
        "Show parameters that stay as they are",
    );
    if rows.is_empty() {
        muted(ui, "There is nothing to compare.");
    }
}

/// The cable that a parameter belongs to.
fn cable_of(cables: &[Cable], line: &Difference) -> Option<usize> {
    let mut numbered = cables.iter().enumerate();
    let found = numbered.find(|(_, cable)| is_of(&line.name, &cable.name));
    found.map(|(index, _)| index)
}

fn is_of(name: &str, cable: &str) -> bool {
    name.strip_prefix(cable)
        .is_some_and(|rest| rest.starts_with('.'))
}

fn row(ui: &Ui, line: &Difference, cable: Option<(usize, &Cable)>) -> Vec<Cell> {
    let (scale, sign) = match line.unit {
        "m" => (1e3, ""),
        "rad" => (1.0_f64.to_degrees(), "°"),
        _ => (1.0, ""),
    };
    let palette = theme::of(ui);
    let decimals = decimals(line.sd.map(|sd| sd * scale), line.unit);
    let number = |value: Option<f64>| {
        let text = value.map(|value| format!("{:.decimals$}{sign}", value * scale));
        Cell::new(text.unwrap_or_else(|| "–".to_owned()))
    };
    let name = match cable {
        Some((index, cable)) => {
            let part = line.name.get(cable.name.len() + 1..).unwrap_or(&line.name);
            Cell::new(format!("{} {}", index + 1, words(part).to_lowercase()))
                .with_dot(palette.cable(index))
        }
        None => Cell::new(words(&line.name)),
    };
    let difference = line.difference.map_or_else(
        || Cell::new("–"),
        |value| Cell::new(format!("{:+.decimals$}{sign}", value * scale)),
    );
    let difference = if line.is_writable_change() {
        difference.coloured(palette.accent)
    } else {
        difference.coloured(palette.muted)
    };
    vec![
        name,
        number(line.controller),
        number(Some(line.identified)),
        difference,
        line.sd.map_or_else(Cell::default, |sd| number(Some(sd))),
    ]
}

/// Decimals such that the standard deviation has two digits.
fn decimals(sd: Option<f64>, unit: &str) -> usize {
    let usual = if unit == "m" { 2 } else { 4 };
    let Some(sd) = sd.filter(|sd| *sd > 0.0 && sd.is_finite()) else {
        return usual;
    };
    let digits = 1.0 - sd.log10().floor();
    digits.clamp(0.0, 6.0) as usize
}

/// A parameter as one reads it.
fn words(name: &str) -> String {
    let (part, axis) = name.rsplit_once('.').unwrap_or(("", name));
    let axis = axis.trim_end_matches("_m").trim_end_matches("_rad");
    match part {
        "entry_point" => format!("Entry point {axis}"),
        "platform_anchor" => format!("Platform anchor {axis}"),
        "pulley" => "Pulley radius".to_owned(),
        "winch" => "Drum diameter".to_owned(),
        "home" => match axis.strip_prefix('r') {
            Some(axis) => format!("Home turn about {axis}"),
            None => format!("Home {axis}"),
        },
        "laser.target_plane" => "Laser target".to_owned(),
        _ => name.trim_start_matches("effect.").replace(['_', '.'], " "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_follow_the_standard_deviation() {
        assert_eq!(decimals(Some(0.31), "m"), 2);
        assert_eq!(decimals(Some(12.0), "m"), 0);
        assert_eq!(decimals(Some(0.0042), "rad"), 4);
        assert_eq!(decimals(None, "m"), 2);
    }

    #[test]
    fn parameters_have_words() {
        assert_eq!(words("entry_point.x_m"), "Entry point x");
        assert_eq!(words("home.ry_rad"), "Home turn about y");
        assert_eq!(
            words("effect.winch_scale.cable-3.scale"),
            "winch scale cable-3 scale"
        );
        assert!(is_of("cable-1.pulley.radius_m", "cable-1"));
        assert!(!is_of("cable-10.pulley.radius_m", "cable-1"));
    }
}

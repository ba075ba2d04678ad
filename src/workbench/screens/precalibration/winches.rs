//! Winches: cable per motor revolution.

use egui::Ui;
use tautline_core::instrument::{WINCH_RESIDUAL_LIMIT_M, WinchCalibration};
use tautline_session::{PhaseData, WinchPair};

use super::Typed;
use crate::precalibration::{PerCable, Table};
use crate::screens::desk::{Desk, Residuals, decimals_for, or_dash, verdict_cell};
use crate::views::plots::figure::{Axis, Point};
use crate::widgets::{
    Cell, Column, Numbers, RowField, Rows, RowsEdit, Verdict, muted, rows, section, table, verdict,
};

const FIELDS: [RowField; 3] = [
    RowField {
        title: "Revolutions",
        unit: "",
        per_si: 1.0,
        decimals: 4,
        optional: false,
        accepts: f64::is_finite,
        expects: "a number",
    },
    RowField {
        title: "Length",
        unit: "mm",
        per_si: 1e3,
        decimals: 3,
        optional: false,
        accepts: |value| value.abs() <= 1e3,
        expects: "at most 1 km",
    },
    RowField {
        title: "Tension",
        unit: "N",
        per_si: 1.0,
        decimals: 1,
        optional: true,
        accepts: f64::is_finite,
        expects: "a number",
    },
];

type Fit = PerCable<WinchCalibration>;

/// Draws the part.
pub fn show(ui: &mut Ui, desk: &mut Desk<'_>, typed: &mut Typed) {
    desk.import(ui, Table::Winch, &mut typed.path);
    let calibration = desk.calibration;
    let chosen = desk.chosen_cable(&calibration.winches, |fit| fit.passed);
    if calibration.winches.is_empty() {
        muted(
            ui,
            "Residuals and verdicts appear here. Turn a winch by known revolutions, measure how much cable it pays out, and import the pairs or type them below. At least three pairs of a winch are needed.",
        );
    } else {
        judge(ui, desk);
        fits(ui, desk, chosen);
        residuals(ui, desk);
        values(ui, desk);
    }
    pairs(ui, desk, chosen, typed);
}

fn judge(ui: &mut Ui, desk: &Desk<'_>) {
    let fits = &desk.calibration.winches;
    let limit = WINCH_RESIDUAL_LIMIT_M * 1e3;
    let passed = |one: &&Fit| one.fit.as_ref().is_ok_and(|fit| fit.passed);
    let good = fits.iter().filter(passed).count();
    if good == fits.len() {
        let text = format!("All {good} winches that were measured stay within {limit} mm.");
        verdict(ui, Verdict::Good, &text);
    }
    for Fit { cable, fit } in fits {
        match fit {
            Ok(fit) if !fit.passed => {
                let (name, worst) = (desk.cable_name(*cable), fit.largest_residual_m * 1e3);
                let text = format!(
                    "{name} is {worst:.3} mm off at its worst pair, more than {limit} mm. Look for a wrong pair, backlash or a drum that is not round."
                );
                verdict(ui, Verdict::Bad, &text);
            }
            Err(message) => verdict(ui, Verdict::Bad, &format!("{message}.")),
            Ok(_) => {}
        }
    }
}

fn fits(ui: &mut Ui, desk: &mut Desk<'_>, chosen: usize) {
    let columns = [
        Column::words("Winch"),
        Column::number("Pairs", ""),
        Column::number("Spread", "mm"),
        Column::number("Largest residual", "mm"),
        Column::words("Verdict"),
    ];
    let winches = &desk.calibration.winches;
    let rows: Vec<Vec<Cell>> = winches
        .iter()
        .map(|Fit { cable, fit }| {
            let pairs = desk.session().phases.winch.iter();
            let count = pairs.filter(|pair| pair.cable == *cable).count();
            let fit = fit.as_ref().ok();
            vec![
                desk.cable_cell(ui, *cable),
                Cell::new(count.to_string()),
                or_dash(fit.map(|fit| fit.residual_sd_m * 1e3), 3),
                or_dash(fit.map(|fit| fit.largest_residual_m * 1e3), 3),
                verdict_cell(ui, fit.is_some_and(|fit| fit.passed)),
            ]
        })
        .collect();
    let selected = winches.iter().position(|one| one.cable == chosen);
    let touched = table(ui, &columns, &rows, selected);
    if let Some(row) = touched.clicked.and_then(|row| winches.get(row)) {
        desk.select_cable(row.cable);
    }
}

fn residuals(ui: &mut Ui, desk: &mut Desk<'_>) {
    let fits = desk.calibration.winches.iter();
    let of_winch = |one: &Fit| {
        let pairs = desk.session().phases.winch.iter();
        let pairs = pairs.filter(|pair| pair.cable == one.cable);
        let residuals = one.fit.as_ref().ok()?.residuals_m.iter();
        let points = pairs.zip(residuals);
        let points = points.map(|(pair, residual)| Point::new(pair.revolutions, residual * 1e3));
        Some((one.cable, points.collect()))
    };
    let plot = Residuals {
        name: "Residuals of the winches",
        x: Axis::new("Revolutions", ""),
        unit: "mm",
        limit: WINCH_RESIDUAL_LIMIT_M * 1e3,
        points: fits.filter_map(of_winch).collect(),
    };
    desk.residuals(ui, plot);
}

fn values(ui: &mut Ui, desk: &mut Desk<'_>) {
    section(ui, "Cable per motor revolution");
    let columns = [
        Column::words("Winch"),
        Column::number("In the robot", "mm"),
        Column::number("Measured", "mm"),
        Column::number("±", "mm"),
        Column::number("Change", "mm"),
    ];
    let calibration = desk.calibration;
    let rows: Vec<Vec<Cell>> = calibration
        .winches
        .iter()
        .filter_map(|Fit { cable, fit }| {
            let fit = fit.as_ref().ok()?;
            let winch = &desk.robot().cables.get(*cable)?.winch;
            let old = winch.cable_per_revolution_m() * 1e3;
            let new = fit.cable_per_revolution_m * 1e3;
            let sd = fit.cable_per_revolution_sd_m * 1e3;
            let digits = decimals_for(sd, 2, 4);
            Some(vec![
                desk.cable_cell(ui, *cable),
                Cell::new(format!("{old:.digits$}")),
                Cell::new(format!("{new:.digits$}")),
                Cell::new(format!("{sd:.digits$}")),
                Cell::new(format!("{:+.digits$}", new - old)),
            ])
        })
        .collect();
    table(ui, &columns, &rows, None);
    let proposal = &calibration.with_winches;
    desk.propose(ui, proposal, "Use these values", "use measured winches");
}

fn pairs(ui: &mut Ui, desk: &mut Desk<'_>, chosen: usize, typed: &mut Typed) {
    section(ui, &format!("Pairs of {}", desk.cable_name(chosen)));
    desk.choose_cable(ui, chosen);
    let pairs = desk.session().phases.winch.iter();
    let pairs: Vec<Numbers> = pairs
        .filter(|pair| pair.cable == chosen)
        .map(|pair| [Some(pair.revolutions), Some(pair.length_m), pair.tension_n])
        .collect();
    let fit = desk
        .calibration
        .winches
        .iter()
        .find(|one| one.cable == chosen);
    let residuals = fit
        .and_then(|one| one.fit.as_ref().ok())
        .map(|fit| &fit.residuals_m);
    let remarks: Vec<String> = residuals
        .into_iter()
        .flatten()
        .map(|residual| format!("{:+.3}", residual * 1e3))
        .collect();
    let editor = Rows {
        noun: "Pair",
        fields: &FIELDS,
        rows: &pairs,
        remarks: ("Residual", "mm"),
        remark: &remarks,
    };
    if let Some(edit) = rows(ui, &editor, &mut typed.rows) {
        desk.edit_rows("pair", edit, |phases, edit| change(phases, chosen, edit));
    }
}

fn change(phases: &mut PhaseData, cable: usize, edit: RowsEdit) {
    let pairs = &mut phases.winch;
    let mut places = (0..pairs.len()).filter(|k| pairs[*k].cable == cable);
    match edit {
        RowsEdit::Set(row, column, value) => {
            let Some(pair) = places.nth(row).and_then(|k| pairs.get_mut(k)) else {
                return;
            };
            match (column, value) {
                (0, Some(value)) => pair.revolutions = value,
                (1, Some(value)) => pair.length_m = value,
                (2, value) => pair.tension_n = value,
                _ => {}
            }
        }
        RowsEdit::Add(rows) => pairs.extend(rows.into_iter().filter_map(|row| {
            Some(WinchPair {
                cable,
                revolutions: row[0]?,
                length_m: row[1]?,
                tension_n: row[2],
            })
        })),
        RowsEdit::Remove(row) => {
            if let Some(k) = places.nth(row) {
                pairs.remove(k);
            }
        }
        RowsEdit::Wrong(_) => {}
    }
}

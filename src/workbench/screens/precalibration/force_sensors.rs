//! Force sensors: gain and bias.

use egui::Ui;
use tautline_core::instrument::{FORCE_RESIDUAL_LIMIT_N, ForceSensorCalibration};
use tautline_session::{ForcePair, PhaseData};

use super::Typed;
use crate::precalibration::{PerCable, Table};
use crate::screens::desk::{Desk, Residuals, decimals_for, or_dash, verdict_cell};
use crate::views::plots::figure::{Axis, Point};
use crate::widgets::{
    Cell, Column, Numbers, RowField, Rows, RowsEdit, Verdict, muted, rows, section, table, verdict,
};

const FIELDS: [RowField; 2] = [
    RowField {
        title: "Reading",
        unit: "N",
        per_si: 1.0,
        decimals: 3,
        optional: false,
        accepts: f64::is_finite,
        expects: "a number",
    },
    RowField {
        title: "Load",
        unit: "N",
        per_si: 1.0,
        decimals: 3,
        optional: false,
        accepts: |value| value >= 0.0,
        expects: "a load of 0 or more",
    },
];

type Fit = PerCable<ForceSensorCalibration>;

/// Draws the part.
pub fn show(ui: &mut Ui, desk: &mut Desk<'_>, typed: &mut Typed) {
    desk.import(ui, Table::Force, &mut typed.path);
    let calibration = desk.calibration;
    let chosen = desk.chosen_cable(&calibration.force_sensors, |fit| fit.passed);
    if calibration.force_sensors.is_empty() {
        muted(
            ui,
            "Residuals and verdicts appear here. Hang known weights on a cable, note what its force sensor reads, and import the pairs or type them below. At least three pairs of a sensor are needed.",
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
    let fits = &desk.calibration.force_sensors;
    let limit = FORCE_RESIDUAL_LIMIT_N;
    let passed = |one: &&Fit| one.fit.as_ref().is_ok_and(|fit| fit.passed);
    let good = fits.iter().filter(passed).count();
    if good == fits.len() {
        let text = format!("All {good} force sensors that were measured stay within {limit} N.");
        verdict(ui, Verdict::Good, &text);
    }
    for Fit { cable, fit } in fits {
        match fit {
            Ok(fit) if !fit.passed => {
                let (name, worst) = (desk.cable_name(*cable), fit.largest_residual_n);
                let text = format!(
                    "{name} is {worst:.2} N off at its worst pair, more than {limit} N. Look for a wrong pair, a cable that rubs, or a sensor that is overloaded."
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
        Column::words("Sensor"),
        Column::number("Pairs", ""),
        Column::number("Spread", "N"),
        Column::number("Largest residual", "N"),
        Column::words("Verdict"),
    ];
    let sensors = &desk.calibration.force_sensors;
    let rows: Vec<Vec<Cell>> = sensors
        .iter()
        .map(|Fit { cable, fit }| {
            let pairs = desk.session().phases.force.iter();
            let count = pairs.filter(|pair| pair.cable == *cable).count();
            let fit = fit.as_ref().ok();
            vec![
                desk.cable_cell(ui, *cable),
                Cell::new(count.to_string()),
                or_dash(fit.map(|fit| fit.residual_sd_n), 3),
                or_dash(fit.map(|fit| fit.largest_residual_n), 3),
                verdict_cell(ui, fit.is_some_and(|fit| fit.passed)),
            ]
        })
        .collect();
    let selected = sensors.iter().position(|one| one.cable == chosen);
    let touched = table(ui, &columns, &rows, selected);
    if let Some(row) = touched.clicked.and_then(|row| sensors.get(row)) {
        desk.select_cable(row.cable);
    }
}

fn residuals(ui: &mut Ui, desk: &mut Desk<'_>) {
    let fits = desk.calibration.force_sensors.iter();
    let of_sensor = |one: &Fit| {
        let pairs = desk.session().phases.force.iter();
        let pairs = pairs.filter(|pair| pair.cable == one.cable);
        let residuals = one.fit.as_ref().ok()?.residuals_n.iter();
        let points = pairs.zip(residuals);
        let points = points.map(|(pair, residual)| Point::new(pair.load_n, *residual));
        Some((one.cable, points.collect()))
    };
    let plot = Residuals {
        name: "Residuals of the force sensors",
        x: Axis::new("Load", "N"),
        unit: "N",
        limit: FORCE_RESIDUAL_LIMIT_N,
        points: fits.filter_map(of_sensor).collect(),
    };
    desk.residuals(ui, plot);
}

fn values(ui: &mut Ui, desk: &mut Desk<'_>) {
    section(ui, "Reading for each newton, and without load");
    let columns = [
        Column::words("Sensor"),
        Column::number("Gain now", ""),
        Column::number("Measured", ""),
        Column::number("±", ""),
        Column::number("Bias now", "N"),
        Column::number("Measured", "N"),
        Column::number("±", "N"),
    ];
    let calibration = desk.calibration;
    let rows: Vec<Vec<Cell>> = calibration
        .force_sensors
        .iter()
        .filter_map(|Fit { cable, fit }| {
            let fit = fit.as_ref().ok()?;
            let now = desk.robot().cables.get(*cable)?.force_sensor;
            let gain = decimals_for(fit.gain_sd, 2, 3);
            let bias = decimals_for(fit.bias_sd_n, 1, 2);
            Some(vec![
                desk.cable_cell(ui, *cable),
                or_dash(now.map(|sensor| sensor.tension_gain), gain),
                Cell::new(format!("{:.gain$}", fit.gain)),
                Cell::new(format!("{:.gain$}", fit.gain_sd)),
                or_dash(now.map(|sensor| sensor.bias_n), bias),
                Cell::new(format!("{:.bias$}", fit.bias_n)),
                Cell::new(format!("{:.bias$}", fit.bias_sd_n)),
            ])
        })
        .collect();
    table(ui, &columns, &rows, None);
    let proposal = &calibration.with_force_sensors;
    let what = "use measured force sensors";
    desk.propose(ui, proposal, "Use these values", what);
}

fn pairs(ui: &mut Ui, desk: &mut Desk<'_>, chosen: usize, typed: &mut Typed) {
    section(ui, &format!("Pairs of {}", desk.cable_name(chosen)));
    desk.choose_cable(ui, chosen);
    let pairs = desk.session().phases.force.iter();
    let pairs: Vec<Numbers> = pairs
        .filter(|pair| pair.cable == chosen)
        .map(|pair| [Some(pair.reading_n), Some(pair.load_n), None])
        .collect();
    let fit = desk
        .calibration
        .force_sensors
        .iter()
        .find(|one| one.cable == chosen);
    let residuals = fit
        .and_then(|one| one.fit.as_ref().ok())
        .map(|fit| &fit.residuals_n);
    let remarks: Vec<String> = residuals
        .into_iter()
        .flatten()
        .map(|residual| format!("{residual:+.2}"))
        .collect();
    let editor = Rows {
        noun: "Pair",
        fields: &FIELDS,
        rows: &pairs,
        remarks: ("Residual", "N"),
        remark: &remarks,
    };
    if let Some(edit) = rows(ui, &editor, &mut typed.rows) {
        desk.edit_rows("pair", edit, |phases, edit| change(phases, chosen, edit));
    }
}

fn change(phases: &mut PhaseData, cable: usize, edit: RowsEdit) {
    let pairs = &mut phases.force;
    let mut places = (0..pairs.len()).filter(|k| pairs[*k].cable == cable);
    match edit {
        RowsEdit::Set(row, column, value) => {
            let Some(pair) = places.nth(row).and_then(|k| pairs.get_mut(k)) else {
                return;
            };
            match (column, value) {
                (0, Some(value)) => pair.reading_n = value,
                (1, Some(value)) => pair.load_n = value,
                _ => {}
            }
        }
        RowsEdit::Add(rows) => pairs.extend(rows.into_iter().filter_map(|row| {
            Some(ForcePair {
                cable,
                reading_n: row[0]?,
                load_n: row[1]?,
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

//! Differences besides the pulleys: common rigid motion, target plane, home pose, effects, fits.

use egui::Ui;
use tautline_core::comparison::{Comparison, ScalarDifference, Test};
use tautline_core::effect::find;

use super::pulleys::verdict_cell;
use crate::model::comparison::Compared;
use crate::theme;
use crate::widgets::{Cell, TableColumn, UiExt, table};
use tautline_workflow::comparison::{by_chance, differs, effect_name};
use tautline_workflow::identification::FitVerdict;
use tautline_workflow::wording::sentence;
use tautline_workflow::wording::units::{quantity_to, unit_of, with_sd};

pub fn show(ui: &mut Ui, compared: &Compared) {
    let comparison = &compared.comparison;
    effects(ui, comparison);
    plane(ui, comparison);
    motion(ui, comparison);
    home(ui, comparison);
    fits(ui, compared);
}

/// Cell of the significance of a difference.
fn verdict(ui: &Ui, compared: &Comparison, test: Option<Test>) -> Cell {
    let differs = test.map(|_| differs(compared, test));
    verdict_cell(ui, differs, "different")
}

const SIDE_BY_SIDE: [TableColumn<'_>; 5] = [
    TableColumn::words("Quantity"),
    TableColumn::number("A", ""),
    TableColumn::number("B", ""),
    TableColumn::number("Difference ± standard deviation", ""),
    TableColumn::words("Verdict"),
];

/// Quantity in both sessions.
fn side_by_side(
    ui: &Ui,
    compared: &Comparison,
    name: String,
    unit: &str,
    scalar: &ScalarDifference,
) -> Vec<Cell> {
    let value = |value: Option<f64>| match value {
        None => Cell::new("not in its model").coloured(theme::of(ui).muted),
        Some(value) => Cell::new(quantity_to(value, scalar.sd, unit)),
    };
    vec![
        Cell::new(name),
        value(scalar.first),
        value(scalar.second),
        Cell::new(with_sd(scalar.difference, scalar.sd, unit)),
        verdict(ui, compared, scalar.test),
    ]
}

fn effects(ui: &mut Ui, compared: &Comparison) {
    ui.section("Effects");
    if compared.effects.is_empty() {
        ui.muted("Neither session has an effect in its model. Those that the model doctor adds are compared here.");
        return;
    }
    let rows = compared.effects.iter().map(|effect| {
        let parameters = find(&effect.effect).map_or(&[][..], |found| found.parameters());
        let name = match parameters {
            [_] => sentence(&effect_name(effect)),
            _ => format!("{}: {}", sentence(&effect_name(effect)), effect.parameter),
        };
        let unit = unit_of(&effect.parameter, &effect.unit);
        side_by_side(ui, compared, name, unit, &effect.size)
    });
    let rows: Vec<_> = rows.collect();
    table(ui, &SIDE_BY_SIDE, &rows, None);
}

fn plane(ui: &mut Ui, compared: &Comparison) {
    let Some(plane) = &compared.plane else {
        return;
    };
    ui.section("Target plane of the laser");
    let row = side_by_side(ui, compared, "Offset".to_owned(), "m", plane);
    table(ui, &SIDE_BY_SIDE, &[row], None);
}

const CHANGES: [TableColumn<'_>; 2] = [
    TableColumn::words("Coordinate"),
    TableColumn::number("B minus A ± standard deviation", ""),
];

fn motion(ui: &mut Ui, compared: &Comparison) {
    let Some(motion) = &compared.motion else {
        return;
    };
    ui.section("Common motion of all pulleys");
    let told = match motion.test {
        None => String::new(),
        Some(test) if differs(compared, Some(test)) => format!(
            "More than the home poses of both explain (by noise alone: {}). ",
            by_chance(test)
        ),
        Some(test) => format!(
            "No more than noise: as large as this {} by noise alone. ",
            by_chance(test)
        ),
    };
    ui.muted(&format!(
            "{told}Not a change of the robot: each session counts from its own home pose. It is removed above."
        ));
    let sd = |k: usize| motion.covariance[(k, k)].max(0.0).sqrt();
    let shift = (0..3).map(|k| (k, "Shift along", motion.shift_m[k], "m"));
    let turn = (0..3).map(|k| (k + 3, "Rotation about", motion.rotation_rad[k], "rad"));
    let rows = shift.chain(turn).map(|(k, what, value, unit)| {
        let axis = ["x", "y", "z"][k % 3];
        vec![
            Cell::new(format!("{what} {axis}")),
            Cell::new(with_sd(value, sd(k), unit)),
        ]
    });
    let rows: Vec<_> = rows.collect();
    table(ui, &CHANGES, &rows, None);
}

fn home(ui: &mut Ui, compared: &Comparison) {
    let Some(home) = &compared.home else {
        return;
    };
    ui.section("Home pose");
    let told = match home.test {
        Some(test) if differs(compared, Some(test)) => {
            "The platform stood differently at home. This is no change of the robot."
        }
        Some(_) => "Unchanged within the noise.",
        None => "Cannot be determined.",
    };
    ui.muted(told);
    let rows = home.coordinates.iter().map(|(coordinate, value, sd)| {
        let unit = if coordinate.index() < 3 { "m" } else { "rad" };
        vec![
            Cell::new(sentence(coordinate.describe())),
            Cell::new(with_sd(*value, *sd, unit)),
        ]
    });
    let rows: Vec<_> = rows.collect();
    table(ui, &CHANGES, &rows, None);
}

fn fits(ui: &mut Ui, compared: &Compared) {
    ui.section("Fit of each session");
    let columns = [
        TableColumn::words("Session"),
        TableColumn::number("Poses", ""),
        TableColumn::number("Residuals over noise", ""),
        TableColumn::words("Verdict"),
    ];
    let named = compared.runs.iter().zip(["A", "B"]);
    let rows = named.map(|(run, name)| {
        let missed = run.fit.residual_ratio();
        let explains = FitVerdict::of(run.fit.solution.p_value());
        vec![
            Cell::new(name),
            Cell::new(run.fit.solution.poses.len().to_string()),
            Cell::new(missed.map_or("–".to_owned(), |missed| format!("{missed:.2}"))),
            Cell::new(explains.words()),
        ]
    });
    let rows: Vec<_> = rows.collect();
    table(ui, &columns, &rows, None);
}

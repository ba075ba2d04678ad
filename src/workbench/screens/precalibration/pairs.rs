//! Calibration of each cable by pairs of a known and a read value: winches and force sensors.

use egui::Ui;
use tautline_core::robot::Cable;
use tautline_session::PhaseData;

use crate::screens::bench_panel::{
    Bench, Residuals, TableInput, decimals_for, or_dash, verdict_cell,
};
use crate::widgets::{Cell, Numbers, RowField, Rows, RowsEdit, TableColumn, UiExt, table};
use tautline_workflow::plot::figure::{Axis, Point};
use tautline_workflow::precalibration::{Calibration, PerCable, Proposal, Table};
use tautline_workflow::wording::units::{fixed, signed};

/// Pair of a table.
pub trait Pair: Sized {
    fn cable(&self) -> usize;

    /// Numbers in the order of the columns (SI units).
    fn numbers(&self) -> Numbers;

    /// Pair from its numbers; `None` if one is missing.
    fn of(cable: usize, numbers: Numbers) -> Option<Self>;
}

/// Quality of the fit of a cable, in the display unit of the residuals.
#[derive(Debug, Clone, Copy)]
pub struct Quality<'a> {
    /// Whether the residuals are within the limit.
    pub passed: bool,
    pub spread: f64,
    /// Largest absolute residual.
    pub largest: f64,
    /// Residuals (SI units).
    pub residuals: &'a [f64],
}

/// Fitted value of a cable and the present one, in display units.
#[derive(Debug, Clone, Copy)]
pub struct Fitted {
    /// Present value of the robot.
    pub current: Option<f64>,
    /// Fitted value.
    pub value: f64,
    /// Standard deviation of the fitted value.
    pub sd: f64,
    /// Smallest and largest number of decimals.
    pub decimals: [usize; 2],
}

/// Texts and columns for a kind of instrument.
#[derive(Debug, Clone, Copy)]
pub struct InstrumentTexts {
    pub table: Table,
    pub one: &'static str,
    /// Plural, for sentences.
    pub several: &'static str,
    /// Instruction while there are no pairs.
    pub instruction: &'static str,
    /// Advice for a pair outside the limit.
    pub advice: &'static str,
    /// Name and unit of the horizontal axis of the residuals.
    pub along: (&'static str, &'static str),
    /// Columns of the pairs.
    pub fields: &'static [RowField],
    /// Title of the table of fitted values.
    pub values_title: &'static str,
    /// Name and unit of each fitted value.
    pub values: &'static [(&'static str, &'static str)],
    /// Display unit of the residuals, and its number per SI unit.
    pub unit: (&'static str, f64),
    /// Limit of a residual, in that unit.
    pub limit: f64,
    /// Decimals of a residual in text.
    pub decimals: usize,
}

/// Kind of instrument that is calibrated by pairs.
pub trait Calibrated {
    type Pair: Pair;
    type Fit;
    const WORDS: InstrumentTexts;

    /// Fits of all measured cables.
    fn fits(calibration: &Calibration) -> &[PerCable<Self::Fit>];

    /// Quality of a fit.
    fn quality(fit: &Self::Fit) -> Quality<'_>;

    /// Pairs of a session.
    fn pairs(phases: &PhaseData) -> &[Self::Pair];

    fn pairs_mut(phases: &mut PhaseData) -> &mut Vec<Self::Pair>;

    /// Horizontal position of a pair's residual.
    fn place(pair: &Self::Pair) -> f64;

    /// Fitted values of a cable, in the order of [`InstrumentTexts::values`].
    fn values(fit: &Self::Fit, cable: &Cable) -> Vec<Fitted>;

    /// Robot with these values.
    fn proposal(calibration: &Calibration) -> &Proposal;
}

pub fn show<I: Calibrated>(ui: &mut Ui, bench: &mut Bench<'_>, input: &mut TableInput) {
    bench.import(ui, I::WORDS.table, &mut input.path);
    let fits = I::fits(bench.calibration);
    let chosen = bench.chosen_cable(fits, |fit| I::quality(fit).passed);
    if fits.is_empty() {
        ui.muted(I::WORDS.instruction);
    } else {
        judge::<I>(ui, bench);
        table_of_fits::<I>(ui, bench, chosen);
        residuals::<I>(ui, bench);
        values::<I>(ui, bench);
    }
    pairs::<I>(ui, bench, chosen, input);
}

fn judge<I: Calibrated>(ui: &mut Ui, bench: &Bench<'_>) {
    let fits = I::fits(bench.calibration);
    let words = I::WORDS;
    let (limit, unit, decimals) = (words.limit, words.unit.0, words.decimals);
    let passed = |one: &&PerCable<I::Fit>| {
        let fit = one.fit.as_ref();
        fit.is_ok_and(|fit| I::quality(fit).passed)
    };
    let good = fits.iter().filter(passed).count();
    if good == fits.len() {
        let several = words.several;
        ui.good(&format!(
            "All {good} {several} measured are within {limit} {unit}."
        ));
    }
    for PerCable { cable, fit } in fits {
        match fit.as_ref().map(I::quality) {
            Ok(quality) if !quality.passed => {
                let (name, worst) = (bench.cable_name(*cable), quality.largest);
                ui.bad(&format!(
                    "{name}: largest residual {worst:.decimals$} {unit}, more than {limit} {unit}. {}",
                    words.advice
                ));
            }
            Err(message) => ui.bad(&format!("{message}.")),
            Ok(_) => {}
        }
    }
}

fn table_of_fits<I: Calibrated>(ui: &mut Ui, bench: &mut Bench<'_>, chosen: usize) {
    let unit = I::WORDS.unit.0;
    let columns = [
        TableColumn::words(I::WORDS.one),
        TableColumn::number("Pairs", ""),
        TableColumn::number("Std. dev.", unit),
        TableColumn::number("Largest residual", unit),
        TableColumn::words("Result"),
    ];
    let fits = I::fits(bench.calibration);
    let rows: Vec<Vec<Cell>> = fits
        .iter()
        .map(|PerCable { cable, fit }| {
            let pairs = I::pairs(&bench.session().phases).iter();
            let count = pairs.filter(|pair| pair.cable() == *cable).count();
            let quality = fit.as_ref().ok().map(I::quality);
            vec![
                bench.cable_cell(ui, *cable),
                Cell::new(count.to_string()),
                or_dash(quality.map(|quality| quality.spread), 3),
                or_dash(quality.map(|quality| quality.largest), 3),
                verdict_cell(ui, quality.is_some_and(|quality| quality.passed)),
            ]
        })
        .collect();
    let selected = fits.iter().position(|one| one.cable == chosen);
    let touched = table(ui, &columns, &rows, selected);
    if let Some(row) = touched.clicked.and_then(|row| fits.get(row)) {
        bench.select_cable(row.cable);
    }
}

fn residuals<I: Calibrated>(ui: &mut Ui, bench: &mut Bench<'_>) {
    let (unit, per_si) = I::WORDS.unit;
    let of_cable = |one: &PerCable<I::Fit>| {
        let pairs = I::pairs(&bench.session().phases).iter();
        let pairs = pairs.filter(|pair| pair.cable() == one.cable);
        let points = pairs.zip(I::quality(one.fit.as_ref().ok()?).residuals);
        let points = points.map(|(pair, residual)| Point::new(I::place(pair), residual * per_si));
        Some((one.cable, points.collect()))
    };
    let (label, along) = I::WORDS.along;
    let plot = Residuals {
        name: &format!("Residuals of the {}", I::WORDS.several),
        x: Axis::new(label, along),
        unit,
        limit: I::WORDS.limit,
        points: I::fits(bench.calibration)
            .iter()
            .filter_map(of_cable)
            .collect(),
    };
    bench.residuals(ui, plot);
}

/// Fitted values and the present ones, and the step that applies them.
fn values<I: Calibrated>(ui: &mut Ui, bench: &mut Bench<'_>) {
    let words = I::WORDS;
    ui.section(words.values_title);
    let mut columns = vec![TableColumn::words(words.one)];
    for (name, unit) in words.values {
        columns.push(TableColumn::number(name, unit));
        columns.extend(["Measured", "±"].map(|title| TableColumn::number(title, unit)));
    }
    // There is no room for more columns.
    let shows_change = words.values.len() == 1;
    if shows_change {
        columns.push(TableColumn::number("Change", words.values[0].1));
    }
    let row = |PerCable { cable, fit }: &PerCable<I::Fit>| {
        let mut cells = vec![bench.cable_cell(ui, *cable)];
        let of_robot = bench.robot().cables.get(*cable)?;
        for fitted in I::values(fit.as_ref().ok()?, of_robot) {
            let Fitted {
                current, value, sd, ..
            } = fitted;
            let [least, most] = fitted.decimals;
            let digits = decimals_for(sd, least, most);
            cells.push(or_dash(current, digits));
            cells.extend([value, sd].map(|number| Cell::new(fixed(number, digits))));
            if let Some(current) = current.filter(|_| shows_change) {
                cells.push(Cell::new(signed(value - current, digits)));
            }
        }
        Some(cells)
    };
    let rows: Vec<Vec<Cell>> = I::fits(bench.calibration).iter().filter_map(row).collect();
    table(ui, &columns, &rows, None);
    let what = format!("apply measured {}", words.several);
    let proposal = I::proposal(bench.calibration);
    bench.propose(ui, proposal, "Apply values", &what);
}

fn pairs<I: Calibrated>(ui: &mut Ui, bench: &mut Bench<'_>, chosen: usize, input: &mut TableInput) {
    ui.section(&format!("Pairs of {}", bench.cable_name(chosen)));
    bench.choose_cable(ui, chosen);
    let pairs = I::pairs(&bench.session().phases).iter();
    let pairs: Vec<Numbers> = pairs
        .filter(|pair| pair.cable() == chosen)
        .map(Pair::numbers)
        .collect();
    let mut fits = I::fits(bench.calibration).iter();
    let fit = fits.find(|one| one.cable == chosen);
    let residuals = fit.and_then(|one| one.fit.as_ref().ok()).map(I::quality);
    let (unit, per_si) = I::WORDS.unit;
    let decimals = I::WORDS.decimals;
    let remarks: Vec<String> = residuals
        .map_or(&[][..], |quality| quality.residuals)
        .iter()
        .map(|residual| signed(residual * per_si, decimals))
        .collect();
    let editor = Rows {
        noun: "Pair",
        fields: I::WORDS.fields,
        rows: &pairs,
        remarks: ("Residual", unit),
        remark: &remarks,
    };
    bench.edit_rows(ui, &editor, &mut input.rows, |phases, edit| {
        change(I::pairs_mut(phases), chosen, edit);
    });
}

fn change<P: Pair>(pairs: &mut Vec<P>, cable: usize, edit: RowsEdit) {
    let is_shown = |pair: &P| pair.cable() == cable;
    edit.apply(pairs, is_shown, P::numbers, |numbers| P::of(cable, numbers));
}

#[cfg(test)]
mod tests {
    use tautline_session::{ForcePair, WinchPair};

    use super::*;

    #[test]
    fn rows_are_those_of_the_cable() {
        let pair = |cable, load_n| ForcePair {
            cable,
            reading_n: 1.0,
            load_n,
        };
        let mut pairs = vec![pair(0, 1.0), pair(1, 2.0), pair(0, 3.0)];
        change(&mut pairs, 0, RowsEdit::Set(1, 1, Some(9.0)));
        change(&mut pairs, 0, RowsEdit::Set(0, 0, None));
        change(&mut pairs, 1, RowsEdit::Remove(0));
        change(
            &mut pairs,
            1,
            RowsEdit::Add(vec![[Some(5.0), Some(6.0), None]]),
        );
        let loads: Vec<(usize, f64)> = pairs.iter().map(|p| (p.cable, p.load_n)).collect();
        assert_eq!(loads, [(0, 1.0), (0, 9.0), (1, 6.0)]);
        assert_eq!(pairs[0].reading_n, 1.0, "a number that is needed stays");
    }

    #[test]
    fn a_tension_may_be_taken_away() {
        let numbers = [Some(1.0), Some(0.1), Some(30.0)];
        let mut pairs = vec![WinchPair::of(0, numbers).expect("a pair")];
        change(&mut pairs, 0, RowsEdit::Set(0, 2, None));
        assert_eq!(pairs[0].numbers(), [Some(1.0), Some(0.1), None]);
    }
}

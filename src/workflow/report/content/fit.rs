//! Goodness of fit.

use tautline_core::diagnosis::Quantity;
use tautline_core::estimation::{Observation, ObservationKind};

use super::{number, signed};
use crate::diagnosis::Diagnosed;
use crate::identification::{
    Identification, all_readings, group_of, reading_name, unit_of_reading,
};
use crate::report::document::{Block, Section, Table};
use crate::report::plots;
use crate::wording::units::{display_unit, quantity};
use crate::wording::{odds, ratio, sentence};

/// Largest number of suspect readings listed.
const SUSPECTS: usize = 12;

pub fn section(fit: &Identification, diagnosed: Option<&Diagnosed>) -> Section {
    let mut section = Section::new("Goodness of fit");
    section.lead(verdict(fit));
    if let Some(diagnosed) = diagnosed {
        for noise in &diagnosed.diagnosis.noise {
            section.paragraph(diagnosed.noise_line(noise));
        }
    }
    section.table(kinds(fit));
    let plots = cable_plots(fit);
    if !plots.is_empty() {
        section.heading("Length readings, cable by cable");
        section.note("Prediction minus reading over the poses, in standard deviations of this difference. The band covers three of them; with a correct model about 3 of 1000 readings lie outside.");
        section.blocks.push(Block::Plots(plots));
    }
    let all: Vec<f64> = all_readings(&fit.analysis)
        .filter_map(Observation::normalised)
        .collect();
    if !all.is_empty() {
        section.heading("All readings together");
        section
            .note("Distribution of the residuals; the line is what the stated noise would give.");
        let name = format!("{} readings", all.len());
        section
            .blocks
            .push(Block::Plots(vec![plots::histogram(&name, &all)]));
    }
    suspects(fit, &mut section);
    section
}

fn verdict(fit: &Identification) -> String {
    let solution = &fit.solution;
    let by = (solution.chi2 / solution.degrees_of_freedom).sqrt();
    match solution.p_value() {
        None => "There are only just enough readings to identify the parameters, so the model cannot be tested."
            .to_owned(),
        Some(p) if p < 0.01 => format!(
            "The residuals are {} times the expected noise; with a correct model they would be as large {}.",
            ratio(by),
            odds(p)
        ),
        Some(p) if p > 0.9999 => format!(
            "The residuals are only {} times the expected noise: the readings are more precise than the robot's description states.",
            ratio(by)
        ),
        Some(_) => format!(
            "The residuals are {} times the expected noise; about 1 is normal.",
            ratio(by)
        ),
    }
}

fn kinds(fit: &Identification) -> Table {
    let all = &fit.analysis.observations;
    let kinds = Quantity::ALL.into_iter().filter_map(|quantity| {
        let own = |one: &&Observation| group_of(one.kind).is_some_and(|(q, _)| q == quantity);
        let readings: Vec<&Observation> = all.iter().filter(own).collect();
        let normalised: Vec<f64> = readings.iter().filter_map(|r| r.normalised()).collect();
        (!readings.is_empty()).then_some((quantity, readings, normalised))
    });
    let caption = "Residuals by kind of reading: root mean square, and relative to noise alone";
    Table::of(caption, 2, kinds).columns(&[
        ("Reading", &|(quantity, ..)| sentence(quantity.name())),
        ("unit", &|(quantity, ..)| {
            display_unit(unit_of_reading(*quantity)).1.to_owned()
        }),
        ("number", &|(_, readings, _)| readings.len().to_string()),
        ("residual", &|(quantity, readings, _)| {
            let (factor, _) = display_unit(unit_of_reading(*quantity));
            number(factor * rms(readings.iter().map(|r| r.residual())), 3)
        }),
        ("relative to noise", &|(.., normalised)| {
            number(rms(normalised.iter().copied()), 2)
        }),
        ("beyond 3", &|(.., normalised)| {
            let beyond = normalised.iter().filter(|r| r.abs() > 3.0);
            beyond.count().to_string()
        }),
    ])
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(n, s), v| (n + 1.0, s + v * v));
    if count > 0.0 {
        f64::sqrt(sum / count)
    } else {
        f64::NAN
    }
}

fn cable_plots(fit: &Identification) -> Vec<crate::plot::Drawing> {
    let labels = &fit.dataset.measurements.labels;
    let cables = fit.dataset.robot.cables.iter().enumerate();
    cables
        .filter_map(|(cable, description)| {
            let own = |r: &&Observation| r.kind == ObservationKind::Length(cable);
            let readings: Vec<&Observation> =
                fit.analysis.observations.iter().filter(own).collect();
            let points = readings.iter().filter_map(|r| {
                let label = labels.get(r.row)?;
                Some((*label, r.normalised()?))
            });
            let points: Vec<(i64, f64)> = points.collect();
            let residual = rms(readings.iter().map(|r| r.residual()));
            let text = format!("root mean square {}", quantity(residual, "m"));
            (!points.is_empty()).then(|| plots::residuals(&description.name, &points, &text))
        })
        .collect()
}

fn suspects(fit: &Identification, section: &mut Section) {
    let suspects = fit.analysis.suspects();
    if suspects.is_empty() {
        section.note("There are no outliers.");
        return;
    }
    let more = match suspects.len().saturating_sub(SUSPECTS) {
        0 => String::new(),
        more => format!(", the worst {SUSPECTS} of {}", more + SUSPECTS),
    };
    let caption = format!("Outliers{more}: check these poses");
    let labels = &fit.dataset.measurements.labels;
    let table = Table::of(caption, 1, suspects.iter().take(SUSPECTS));
    section.table(table.columns(&[
        ("Reading", &|one| {
            sentence(&reading_name(&fit.dataset.robot, one.kind))
        }),
        ("pose", &|one| {
            labels.get(one.row).map_or_else(String::new, i64::to_string)
        }),
        ("standard deviations", &|one| {
            signed(one.normalised().unwrap_or(f64::NAN), 1)
        }),
    ]));
}

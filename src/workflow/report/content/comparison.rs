//! Content of the report of a comparison of two sessions.

use tautline_core::comparison::{Comparison, PulleyDifference, ScalarDifference};
use tautline_core::estimation::Observation;

use super::{displacements, number, signatures, signed, titled, when};
use crate::comparison::{common_motion, differs, effect_name, unexplained, verdict};
use crate::identification::{Identification, all_readings};
use crate::report::deviations::Deviation;
use crate::report::document::{Block, Document, Section, Table};
use crate::report::input::ComparisonInput;
use crate::report::plots;
use crate::wording::units::{mm, quantity_to, significant, with_sd};
use crate::wording::{PROGRAM, count, ratio, sentence};

/// The whole content.
pub fn document(input: &ComparisonInput<'_>) -> Document {
    let names = input.names;
    let title = format!("Comparison: {} and {}", names[0], names[1]);
    let sections = [
        result(input),
        pulleys(input),
        others(input.comparison),
        residuals(input),
        signatures(input.choice, "Compared by", input.is_simulated),
        about(input),
    ];
    titled(
        input.choice,
        title,
        (input.now, input.is_simulated),
        sections,
    )
}

fn result(input: &ComparisonInput<'_>) -> Section {
    let mut section = Section::new("Result");
    section.lead(verdict(input.comparison));
    for text in unexplained(input.comparison, input.names) {
        section.paragraph(text);
    }
    let facts = input
        .names
        .iter()
        .zip(input.fits)
        .zip(["First session", "Second session"]);
    let facts = facts.map(|((name, fit), what)| (what.to_owned(), of_session(name, fit)));
    section.facts(facts);
    section
}

fn of_session(name: &str, fit: &Identification) -> String {
    let poses = count(fit.dataset.measurements.len(), "pose");
    let fit = fit.residual_ratio().map_or_else(String::new, |by| {
        format!(", residuals {} times the expected noise", ratio(by))
    });
    format!("{name}: {poses}{fit}")
}

fn pulleys(input: &ComparisonInput<'_>) -> Section {
    let mut section = Section::new("Pulleys, second less first");
    if let Some(motion) = common_motion(input.comparison) {
        section.paragraph(motion);
    }
    let cables = &input.fits[0].dataset.robot.cables;
    let drawn = cables.iter().zip(&input.comparison.pulleys);
    let drawn: Vec<Deviation> = drawn
        .map(|(cable, pulley)| {
            let shown = pulley.relative.unwrap_or(pulley.raw);
            Deviation {
                from: cable.pulley.entry_point_m.into(),
                by: shown.vector_m,
                covariance: Some(shown.covariance),
                is_marked: pulley.moved,
            }
        })
        .collect();
    displacements::draw(&drawn, "in the first session", None, &mut section);
    section.table(differences(input.comparison));
    section
}

fn differences(compared: &Comparison) -> Table {
    let caption = format!(
        "Differences; a pulley counts as moved if noise alone would cause one in fewer than {} of 100 comparisons",
        significant(100.0 * compared.level, 2)
    );
    let shown = |pulley: &PulleyDifference| pulley.relative.unwrap_or(pulley.raw);
    let along = |pulley: &PulleyDifference, k: usize| signed(1e3 * shown(pulley).vector_m[k], 2);
    Table::of(caption, 1, &compared.pulleys).columns(&[
        ("Pulley", &|one| one.cable.clone()),
        ("dx mm", &|one| along(one, 0)),
        ("dy mm", &|one| along(one, 1)),
        ("dz mm", &|one| along(one, 2)),
        ("length mm", &|one| mm(shown(one).length_m(), 2)),
        ("standard deviation mm", &|one| {
            mm(shown(one).length_sd_m(), 2)
        }),
        ("by chance", &|one| chance(one)),
        ("verdict", &|one| called(one).to_owned()),
    ])
}

fn chance(pulley: &PulleyDifference) -> String {
    match pulley.test.map(|test| test.p_corrected) {
        None => super::NONE.to_owned(),
        Some(p) if p < 1e-4 => "< 0.0001".to_owned(),
        Some(p) => number(p, 4),
    }
}

fn called(pulley: &PulleyDifference) -> &'static str {
    match (pulley.test, pulley.moved) {
        (None, _) => "undetermined",
        (Some(_), true) => "moved",
        (Some(_), false) => "unchanged",
    }
}

/// Differences of the target plane and effects.
fn others(compared: &Comparison) -> Section {
    let mut section = Section::new("Other differences");
    let plane = compared.plane.iter();
    let plane = plane.map(|plane| ("Target plane".to_owned(), "m", plane));
    let effects = compared.effects.iter();
    let effects = effects.map(|one| (sentence(&effect_name(one)), one.unit.as_str(), &one.size));
    let value = |(_, unit, size): &(String, &str, &ScalarDifference), value: Option<f64>| {
        value.map_or_else(
            || super::NONE.to_owned(),
            |value| quantity_to(value, size.sd, unit),
        )
    };
    let table = Table::of("Target plane and effects", 1, plane.chain(effects));
    section.table(table.columns(&[
        ("Quantity", &|(name, ..)| name.clone()),
        ("first", &|row| value(row, row.2.first)),
        ("second", &|row| value(row, row.2.second)),
        ("difference", &|(_, unit, size)| {
            with_sd(size.difference, size.sd, unit)
        }),
        (
            "verdict",
            &|(.., size)| match differs(compared, size.test) {
                true => "different".to_owned(),
                false => "unchanged".to_owned(),
            },
        ),
    ]));
    section
}

fn residuals(input: &ComparisonInput<'_>) -> Section {
    let mut section = Section::new("Residuals of both");
    section.note("Prediction minus reading of all readings, in standard deviations; the line is what the stated noise would give.");
    let drawn = input.names.iter().zip(input.fits).map(|(name, fit)| {
        let all: Vec<f64> = all_readings(&fit.analysis)
            .filter_map(Observation::normalised)
            .collect();
        plots::histogram(&format!("{name}: {} readings", all.len()), &all)
    });
    section.blocks.push(Block::Plots(drawn.collect()));
    section
}

fn about(input: &ComparisonInput<'_>) -> Section {
    let mut section = Section::new("About this report");
    let facts = [
        ("Program", PROGRAM.to_owned()),
        ("Created", when(input.now)),
        ("Robot", input.fits[0].dataset.robot.label()),
    ];
    let facts = facts.map(|(name, value)| (name.to_owned(), value));
    section.facts(facts);
    section
}

//! Budget of uncertainty.

use super::number;
use crate::identification::{
    BudgetDocument, COVERAGE_PROBABILITY, FitVerdict, Identification, SourceSummary,
    VarianceBudget, entry_point_covariance, source_title,
};
use crate::plot::Drawing;
use crate::report::bars;
use crate::report::document::{Block, Section, Table};
use crate::report::input::MonteCarlo;
use crate::wording::units::{decimals_of_uncertainty, fixed};
use crate::wording::{list, sentence};

/// Smallest share of a source that is shown by itself.
const SHOWN: f64 = 0.01;
/// Degrees of freedom from which on their number changes nothing.
const MANY: f64 = 1000.0;
/// Largest number of sources with a column of their own.
const COLUMNS: usize = 5;

/// `None` where the identification has no budget.
pub fn section(fit: &Identification, monte_carlo: Option<&MonteCarlo>) -> Option<Section> {
    let budget = fit.budget()?;
    let summary = budget.summary(SHOWN);
    let mut section = Section::new("Uncertainty");
    if !FitVerdict::of(fit.solution.p_value()).holds() {
        section
            .lead("The model does not explain the data: the uncertainties are larger than stated.");
    }
    section.paragraph("Share of each source in the variance of the identified values, by the law of propagation of uncertainty (GUM, JCGM 100). The shares of a variance sum to 100 %.");
    section.blocks.push(Block::Plots(vec![bars_of(&summary)]));
    section.table(table(&budget, &summary));
    section.table(coverage_factors(&budget));
    section.note(format!(
        "Expanded uncertainty of a coordinate: U = k u with a coverage probability of {:.1} %; k is from the t distribution of the effective degrees of freedom (Welch and Satterthwaite, JCGM 100, G.4). Type A: evaluated from the scatter of the readings, with their redundancy as degrees of freedom: {}. All other sources are of type B: stated.",
        100.0 * COVERAGE_PROBABILITY,
        evaluated(&budget)
    ));
    if let Some(monte_carlo) = monte_carlo {
        propagation(fit, &budget, monte_carlo, &mut section);
    }
    section.note("Standard uncertainty: root of the summed variances of x, y and z. Position of the platform: root mean square over the measured poses, once the identified values are at the controller; tensions are taken as known. Sources below 1 % everywhere are among the others.");
    Some(section)
}

/// Bars of the sources of all pulleys together, and of the position.
fn bars_of(summary: &[SourceSummary]) -> Drawing {
    let has_position = summary.iter().any(|one| one.position.is_some());
    let titles = ["Pulleys, all together", "Position of the platform"];
    let titles = if has_position {
        &titles[..]
    } else {
        &titles[..1]
    };
    let rows = summary.iter().map(|one| {
        let shares = std::iter::once(one.pulleys).chain(one.position);
        (sentence(&source_title(&one.source)), shares.collect())
    });
    bars::shares(titles, &rows.collect::<Vec<_>>())
}

/// Each pulley and the position with the shares of the most important sources.
fn table(budget: &BudgetDocument, summary: &[SourceSummary]) -> Table {
    let sources: Vec<&str> = summary
        .iter()
        .take(COLUMNS)
        .map(|one| one.source.as_str())
        .collect();
    let mut headings = vec!["Value".to_owned(), "standard uncertainty mm".to_owned()];
    headings.extend(
        sources
            .iter()
            .map(|source| format!("{} %", source_title(source))),
    );
    headings.push("others %".to_owned());
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let mut table = Table::new("Shares of the variance", 1, &headings);
    for (name, of) in variances(budget) {
        let shares = sources.iter().map(|source| 100.0 * of.share(source));
        let shares: Vec<f64> = shares.collect();
        let mut cells = vec![name.to_owned(), number(1e3 * of.sd_m(), 2)];
        cells.extend(shares.iter().map(|share| number(*share, 0)));
        cells.push(number((100.0 - shares.iter().sum::<f64>()).max(0.0), 0));
        table.rows.push(cells);
    }
    table
}

/// The variances of the pulleys, then of the position, with their names.
fn variances(budget: &BudgetDocument) -> impl Iterator<Item = (&str, &VarianceBudget)> {
    let pulleys = budget.pulleys.iter();
    let pulleys = pulleys.map(|one| (one.cable.as_str(), &one.budget));
    let position = budget.position.iter();
    pulleys.chain(position.map(|of| ("Position of the platform", of)))
}

/// The sources of type A with their degrees of freedom.
fn evaluated(budget: &BudgetDocument) -> String {
    let sources = budget.evaluated.iter().map(|one| {
        let title = source_title(&one.source);
        format!("{title} ({:.0})", one.degrees_of_freedom)
    });
    match sources.collect::<Vec<_>>().as_slice() {
        [] => "none".to_owned(),
        all => list(all),
    }
}

/// Coverage factor of the coordinates of each pulley.
fn coverage_factors(budget: &BudgetDocument) -> Table {
    Table::of("Coverage factors", 1, &budget.pulleys).columns(&[
        ("Entry point", &|one| one.cable.clone()),
        ("effective degrees of freedom", &|one| match budget
            .effective_degrees_of_freedom(&one.budget)
        {
            freedom if freedom < MANY => number(freedom.floor(), 0),
            _ => format!("above {MANY:.0}"),
        }),
        ("k", &|one| fixed(budget.coverage_factor(&one.budget), 2)),
    ])
}

/// Coverage intervals by propagation of distributions beside those of the linear budget.
fn propagation(
    fit: &Identification,
    budget: &BudgetDocument,
    monte_carlo: &MonteCarlo,
    section: &mut Section,
) {
    let mut table = Table::new(
        "Coverage intervals of the entry points (mm)",
        2,
        &[
            "Cable",
            "axis",
            "from, linear",
            "to, linear",
            "from, Monte Carlo",
            "to, Monte Carlo",
        ],
    );
    let found = fit.solution.globals.entry_points.iter();
    let cables = fit.dataset.robot.cables.iter().zip(found).enumerate();
    for (index, (cable, found)) in cables {
        let covariance = entry_point_covariance(&fit.solution, index);
        let known = covariance.zip(budget.coverage_factor_of(&cable.name));
        let Some((covariance, factor)) = known else {
            continue;
        };
        for (axis, label) in ["x", "y", "z"].into_iter().enumerate() {
            let u = factor * covariance[(axis, axis)].max(0.0).sqrt();
            if u == 0.0 {
                continue;
            }
            let drawn = monte_carlo.entry_points[index][axis];
            let digits = decimals_of_uncertainty(1e3 * u) + 1;
            let shown = |metres: f64| fixed(1e3 * metres, digits);
            table.push([
                cable.name.clone(),
                label.to_owned(),
                shown(found[axis] - u),
                shown(found[axis] + u),
                shown(drawn.from_m),
                shown(drawn.to_m),
            ]);
        }
    }
    section.table(table);
    section.note(format!(
        "Monte Carlo: propagation of distributions (JCGM 101). Readings, places on the drawing and deviations of the parts were drawn {} times from their distributions and everything was identified anew; {} of the identifications converged.",
        monte_carlo.trials, monte_carlo.converged
    ));
}

//! Budget of uncertainty.

use super::number;
use crate::identification::{
    BudgetDocument, FitVerdict, Identification, SourceSummary, VarianceBudget, source_title,
};
use crate::plot::Drawing;
use crate::report::bars;
use crate::report::document::{Block, Section, Table};
use crate::wording::sentence;

/// Smallest share of a source that is shown by itself.
const SHOWN: f64 = 0.01;
/// Largest number of sources with a column of their own.
const COLUMNS: usize = 5;

/// `None` where the identification has no budget.
pub fn section(fit: &Identification) -> Option<Section> {
    let budget = fit.budget()?;
    let summary = budget.summary(SHOWN);
    let mut section = Section::new("Budget of uncertainty");
    if !FitVerdict::of(fit.solution.p_value()).holds() {
        section
            .lead("The model does not explain the data: the uncertainties are larger than stated.");
    }
    section.paragraph("Share of each source in the variance of the identified values, by the law of propagation of uncertainty (GUM, JCGM 100). The shares of a variance sum to 100 %.");
    section.blocks.push(Block::Plots(vec![bars_of(&summary)]));
    section.table(table(&budget, &summary));
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
    let mut push = |name: &str, of: &VarianceBudget| {
        let shares = sources.iter().map(|source| 100.0 * of.share(source));
        let shares: Vec<f64> = shares.collect();
        let mut cells = vec![name.to_owned(), number(1e3 * of.sd_m(), 2)];
        cells.extend(shares.iter().map(|share| number(*share, 0)));
        cells.push(number((100.0 - shares.iter().sum::<f64>()).max(0.0), 0));
        table.rows.push(cells);
    };
    for pulley in &budget.pulleys {
        push(&pulley.cable, &pulley.budget);
    }
    if let Some(position) = &budget.position {
        push("Position of the platform", position);
    }
    table
}

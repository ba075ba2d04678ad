//! Histogram of standardised residuals without and with the findings of a diagnosis.

use tautline_core::estimation::Observation;

use crate::model::plot_preparation::Prepared;
use crate::views::plots::kind::{Content, PlotKind, no_options};
use tautline_workflow::identification::{Identification, all_readings};
use tautline_workflow::plot::figure::{Axis, Columns, Curve, Figure, Ink};
use tautline_workflow::plot::histogram;

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "before-after",
    title: "Before and after",
    missing: |open| {
        let is_missing = open.diagnosis().is_none();
        is_missing.then_some("Residuals before and after appear here after a diagnosis.")
    },
    options: no_options,
    content: Content::Figure(|source| Ok(figure(source.prepared()?))),
};

/// Half of the displayed width (standard deviations); values beyond count in the outermost columns.
const MOST: f64 = 6.0;
/// Number of columns.
const COUNT: usize = 48;

/// Histograms with the normal curve.
pub(crate) fn figure(prepared: &Prepared) -> Figure {
    let before = all(&prepared.base);
    let mut columns = vec![density("before", Ink::Warning, &before)];
    if let Some(extended) = &prepared.extended {
        let mut after = density("after, with the causes found", Ink::Accent, &all(extended));
        after.outline = true;
        columns.push(after);
    }
    Figure {
        x: Axis::new("Residual (ends: beyond 6)", "standard deviations"),
        y: Axis::new("Density", ""),
        columns,
        curves: vec![Curve {
            name: "expected of a correct model".into(),
            ink: Ink::Text,
            dashed: true,
            points: histogram::normal(MOST, 1.0),
        }],
        ..Figure::default()
    }
}

/// Standardised residuals of all readings of a fit.
fn all(fit: &Identification) -> Vec<f64> {
    all_readings(&fit.analysis)
        .filter_map(Observation::normalised)
        .collect()
}

/// Columns with a total area of 1.
fn density(name: &str, ink: Ink, values: &[f64]) -> Columns {
    let (edges, counts) = histogram::histogram(values, MOST, COUNT);
    let share = COUNT as f64 / (2.0 * MOST * values.len().max(1) as f64);
    Columns {
        name: name.into(),
        ink,
        outline: false,
        edges,
        heights: counts.into_iter().map(|count| share * count).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_has_area_one_and_loses_no_outlier() {
        let columns = density("before", Ink::Text, &[-50.0, 0.1, 0.2, 7.0]);
        let area: f64 = columns.heights.iter().sum::<f64>() * 0.25;
        assert!((area - 1.0).abs() < 1e-12);
        assert!((columns.heights[0] - 1.0).abs() < 1e-12);
        assert!((columns.heights[COUNT - 1] - 1.0).abs() < 1e-12);
        assert!((columns.heights[24] - 2.0).abs() < 1e-12);
    }
}

//! Histogram of standardised residuals without and with what a diagnosis found.

use tautline_core::diagnosis::Quantity;

use crate::model::figure::{Axis, Columns, Curve, Figure, Ink};
use crate::model::plot_preparation::{Prepared, residuals};
use tautline_workflow::identification::Identification;

/// Half of the width that is shown (standard deviations); what is beyond counts in the outermost columns.
const MOST: f64 = 6.0;
/// Columns.
const COUNT: usize = 48;

/// The histograms with the normal curve.
#[must_use]
pub fn figure(prepared: &Prepared) -> Figure {
    let before = all(&prepared.base);
    let mut columns = vec![histogram("before", Ink::Warning, &before)];
    if let Some(extended) = &prepared.extended {
        let mut after = histogram("after, with what was found", Ink::Accent, &all(extended));
        after.outline = true;
        columns.push(after);
    }
    let places = (0..=240).map(|k| {
        let x = MOST * (f64::from(k) / 120.0 - 1.0);
        [x, (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()]
    });
    Figure {
        x: Axis::new(
            "Residual; beyond 6 in the outermost columns",
            "standard deviations",
        ),
        y: Axis::new("Share of readings per standard deviation", ""),
        columns,
        curves: vec![Curve {
            name: "if model and noise are right".into(),
            ink: Ink::Text,
            dashed: true,
            points: places.collect(),
        }],
        ..Figure::default()
    }
}

/// All standardised residuals of a fit.
fn all(fit: &Identification) -> Vec<f64> {
    let mut values: Vec<f64> = fit
        .analysis
        .readings
        .iter()
        .filter_map(|r| r.normalised())
        .collect();
    for cable in 0..fit.dataset.robot.cables.len() {
        let errors = residuals(fit, Quantity::Tension, Some(cable));
        values.extend(errors.into_iter().map(|(_, value)| value));
    }
    values
}

/// Columns whose area is 1.
fn histogram(name: &str, ink: Ink, values: &[f64]) -> Columns {
    let width = 2.0 * MOST / COUNT as f64;
    let mut heights = vec![0.0; COUNT];
    let share = 1.0 / (values.len().max(1) as f64 * width);
    for value in values {
        let index = ((value + MOST) / width).clamp(0.0, COUNT as f64 - 1.0) as usize;
        heights[index] += share;
    }
    Columns {
        name: name.into(),
        ink,
        outline: false,
        edges: (0..=COUNT).map(|k| -MOST + width * k as f64).collect(),
        heights,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_has_area_one_and_loses_no_outlier() {
        let columns = histogram("before", Ink::Text, &[-50.0, 0.1, 0.2, 7.0]);
        let area: f64 = columns.heights.iter().sum::<f64>() * 0.25;
        assert!((area - 1.0).abs() < 1e-12);
        assert!((columns.heights[0] - 1.0).abs() < 1e-12);
        assert!((columns.heights[COUNT - 1] - 1.0).abs() < 1e-12);
        assert!((columns.heights[24] - 2.0).abs() < 1e-12);
    }
}

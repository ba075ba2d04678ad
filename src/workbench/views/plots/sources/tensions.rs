//! Tensions over poses: as measured, and their residuals.

use std::collections::BTreeSet;

use tautline_core::diagnosis::Quantity;

use super::{POSE, over_pose};
use crate::views::plots::choices::{TensionsShown, choose};
use crate::views::plots::kind::{Content, PlotKind};
use tautline_workflow::identification::{Identification, RESIDUAL, readings_of};
use tautline_workflow::plot::figure::{Axis, Band, Figure, Point, Series};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "tensions",
    title: "Tensions",
    missing: |open| {
        let fit = open.fit();
        let has_forces = fit.is_some_and(|fit| !fit.dataset.measurements.force_n.is_empty());
        (!has_forces).then_some("Tensions appear here after an identification with force readings.")
    },
    options: |ui, options, input| {
        let shown = [
            (TensionsShown::Measured, "Measured"),
            (TensionsShown::Residuals, "Residuals"),
        ];
        let (is_narrow, chosen) = (input.is_narrow, &mut options.tensions);
        choose(ui, "Tensions shown", is_narrow, &shown, chosen);
    },
    content: Content::Figure(|source| {
        Ok(figure(
            source.fit()?,
            source.options.tensions,
            source.excluded(),
        ))
    }),
};

/// Tensions of all cables.
pub(crate) fn figure(
    fit: &Identification,
    shown: TensionsShown,
    excluded: &BTreeSet<i64>,
) -> Figure {
    let cables = &fit.dataset.robot.cables;
    let mut points: Vec<Vec<Point>> = vec![Vec::new(); cables.len()];
    let mut put = |row: usize, cable: usize, value: f64| {
        if let Some(points) = points.get_mut(cable) {
            points.push(over_pose(&fit.dataset, excluded, row, value));
        }
    };
    let read = &fit.dataset.measurements.force_n;
    match shown {
        TensionsShown::Measured => {
            for row in 0..read.rows() {
                for (index, cable) in cables.iter().enumerate() {
                    if let Some(sensor) = cable.force_sensor {
                        put(row, index, sensor.tension_n(read.get(row, index)));
                    }
                }
            }
        }
        TensionsShown::Residuals => {
            for index in 0..cables.len() {
                for one in readings_of(&fit.analysis, Quantity::Tension, Some(index)) {
                    put(one.row, index, one.residual());
                }
            }
        }
    }
    let largest_sd = cables
        .iter()
        .filter_map(|cable| Some(cable.force_sensor?.tension_sd_n))
        .fold(0.0, f64::max);
    let range = [-3.0, 3.0].map(|times| times * largest_sd);
    let band = Band::new("3 standard deviations of the sensors", range);
    let is_residual = shown == TensionsShown::Residuals;
    let named = points.into_iter().zip(cables).enumerate();
    Figure {
        x: Axis::whole(POSE),
        y: Axis::new(if is_residual { RESIDUAL } else { "Tension" }, "N"),
        bands: if is_residual { vec![band] } else { Vec::new() },
        series: named
            .map(|(index, (points, cable))| Series::of_cable(index, &cable.name, points))
            .collect(),
        has_zero_line: is_residual,
        ..Figure::default()
    }
}

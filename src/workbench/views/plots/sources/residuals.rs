//! Residuals of cable lengths over poses, and common parts of other residual plots.

use std::collections::BTreeSet;

use egui::Ui;
use tautline_core::estimation::{Observation, ObservationKind};

use super::{POSE, over_pose};
use crate::views::plots::choices::{ResidualUnit, choose};
use crate::views::plots::kind::{
    Content, OptionsInput, PlotKind, PlotOptions, PlotSource, Unavailable,
};
use tautline_workflow::identification::{Identification, RESIDUAL};
use tautline_workflow::plot::figure::{Axis, Band, Figure, Ink, Marker, Point, Series};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "residuals",
    title: "Residuals",
    missing: |open| {
        let is_missing = open.fit().is_none();
        is_missing.then_some("Residuals of all cables appear here after identification.")
    },
    options: choose_unit,
    content: Content::Figure(|source| {
        Ok(lengths(
            source.fit()?,
            source.options.unit,
            source.excluded(),
        ))
    }),
};

impl ResidualUnit {
    fn value(self, reading: &Observation) -> Option<f64> {
        match self {
            Self::Deviations => reading.normalised(),
            Self::Millimetres => Some(1e3 * reading.residual()),
        }
    }

    fn axis(self) -> Axis {
        match self {
            Self::Deviations => Axis::new(RESIDUAL, "standard deviations"),
            Self::Millimetres => Axis::new(RESIDUAL, "mm"),
        }
    }

    /// Band of three standard deviations of residuals; in millimetres, of their median.
    fn band<'a>(self, readings: impl Iterator<Item = &'a Observation>) -> Option<Band> {
        let half = match self {
            Self::Deviations => 3.0,
            Self::Millimetres => 3e3 * median(readings.filter_map(sd))?,
        };
        Some(Band::new("3 standard deviations", [-half, half]))
    }
}

/// Standard deviation of a residual (SI unit of the reading).
fn sd(reading: &Observation) -> Option<f64> {
    let redundancy = reading.redundancy.filter(|share| *share > 0.0)?;
    Some(reading.sd * redundancy.sqrt())
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Residuals of all cable lengths.
fn lengths(fit: &Identification, unit: ResidualUnit, excluded: &BTreeSet<i64>) -> Figure {
    let cables = &fit.dataset.robot.cables;
    let named = cable_points(fit, unit, excluded)
        .into_iter()
        .zip(cables)
        .enumerate();
    let series = named
        .map(|(index, (points, cable))| Series::of_cable(index, &cable.name, points))
        .collect();
    over_poses(unit, unit.band(length_readings(fit)), series)
}

/// Residuals of all cable lengths in two sessions, the second as rings. Their poses are unrelated, so points do not
/// select a pose.
pub(crate) fn of_both(fits: [&Identification; 2]) -> Figure {
    let unit = ResidualUnit::default();
    let nothing = BTreeSet::new();
    let key = |name| Series::new(name, Ink::Text, Marker::Circle, Vec::new());
    let mut series = vec![key("A"), key("B").as_rings()];
    for (fit, name) in fits.into_iter().zip(["A", "B"]) {
        let cables = cable_points(fit, unit, &nothing).into_iter();
        for (index, (mut points, cable)) in cables.zip(&fit.dataset.robot.cables).enumerate() {
            points.iter_mut().for_each(|point| point.pose = None);
            let own = Series::of_cable(index, format!("{name}: {}", cable.name), points);
            series.push(if name == "A" {
                own
            } else {
                // The legend names each cable once.
                let mut own = own.as_rings();
                own.short.clear();
                own
            });
        }
    }
    let readings = fits.into_iter().flat_map(length_readings);
    over_poses(unit, unit.band(readings), series)
}

fn over_poses(unit: ResidualUnit, band: Option<Band>, series: Vec<Series>) -> Figure {
    Figure {
        x: Axis::whole(POSE),
        y: unit.axis(),
        bands: band.into_iter().collect(),
        series,
        has_zero_line: true,
        ..Figure::default()
    }
}

fn length_readings(fit: &Identification) -> impl Iterator<Item = &Observation> {
    let readings = fit.analysis.observations.iter();
    readings.filter(|reading| matches!(reading.kind, ObservationKind::Length(_)))
}

/// Residuals of the length of each cable.
fn cable_points(
    fit: &Identification,
    unit: ResidualUnit,
    excluded: &BTreeSet<i64>,
) -> Vec<Vec<Point>> {
    let mut points: Vec<Vec<Point>> = vec![Vec::new(); fit.dataset.robot.cable_count()];
    for reading in &fit.analysis.observations {
        if let ObservationKind::Length(cable) = reading.kind
            && let Some(value) = unit.value(reading)
            && let Some(points) = points.get_mut(cable)
        {
            points.push(over_pose(&fit.dataset, excluded, reading.row, value));
        }
    }
    points
}

/// Residuals of readings of these kinds, as a series each.
pub(super) fn of_kinds(
    source: &PlotSource<'_>,
    kinds: &[(&str, Ink, Marker, ObservationKind)],
) -> Result<Figure, Unavailable> {
    let (fit, unit, excluded) = (source.fit()?, source.options.unit, source.excluded());
    let all = &fit.analysis.observations;
    let point = |reading: &Observation| {
        let value = unit.value(reading)?;
        Some(over_pose(&fit.dataset, excluded, reading.row, value))
    };
    let series = kinds.iter().map(|(name, ink, marker, kind)| {
        let own = all.iter().filter(|reading| reading.kind == *kind);
        Series::new(*name, *ink, *marker, own.filter_map(point).collect())
    });
    let is_shown = |reading: &&Observation| kinds.iter().any(|(.., kind)| reading.kind == *kind);
    let band = unit.band(all.iter().filter(is_shown));
    Ok(over_poses(unit, band, series.collect()))
}

/// Choice of the unit.
pub(super) fn choose_unit(ui: &mut Ui, options: &mut PlotOptions, input: &OptionsInput<'_>) {
    let units = [
        (ResidualUnit::Deviations, "Standard deviations"),
        (ResidualUnit::Millimetres, "Millimetres"),
    ];
    choose(ui, "Unit", input.is_narrow, &units, &mut options.unit);
}

//! Residuals of cable lengths and of the laser over poses.

use std::collections::BTreeSet;

use tautline_core::estimation::{Reading, ReadingKind};

use super::over_pose;
use crate::app::fit::Fit;
use crate::views::plots::POSE;
use crate::views::plots::figure::{Axis, Band, Figure, Ink, Marker, Point, Series};

/// Unit of residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unit {
    /// Their own standard deviations.
    #[default]
    Deviations,
    /// Millimetres.
    Millimetres,
}

impl Unit {
    fn value(self, reading: &Reading) -> Option<f64> {
        match self {
            Self::Deviations => reading.normalised(),
            Self::Millimetres => Some(1e3 * reading.residual()),
        }
    }

    fn axis(self) -> Axis {
        match self {
            Self::Deviations => Axis::new("Prediction minus reading", "standard deviations"),
            Self::Millimetres => Axis::new("Prediction minus reading", "mm"),
        }
    }

    /// Three standard deviations of residuals; in millimetres those of the middle one (median).
    fn band<'a>(self, readings: impl Iterator<Item = &'a Reading>) -> Option<Band> {
        let half = match self {
            Self::Deviations => 3.0,
            Self::Millimetres => 3e3 * median(readings.filter_map(sd))?,
        };
        Some(Band {
            name: "3 standard deviations".into(),
            y: [-half, half],
        })
    }
}

/// Standard deviation of a residual (SI unit of the reading).
fn sd(reading: &Reading) -> Option<f64> {
    let redundancy = reading.redundancy.filter(|share| *share > 0.0)?;
    Some(reading.sd * redundancy.sqrt())
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Residuals of the lengths of all cables.
#[must_use]
pub fn lengths(fit: &Fit, unit: Unit, excluded: &BTreeSet<i64>) -> Figure {
    let cables = &fit.dataset.robot.cables;
    let mut points: Vec<Vec<Point>> = vec![Vec::new(); cables.len()];
    for reading in &fit.analysis.readings {
        if let ReadingKind::Length(cable) = reading.kind
            && let Some(value) = unit.value(reading)
            && let Some(points) = points.get_mut(cable)
        {
            points.push(over_pose(&fit.dataset, excluded, reading.row, value));
        }
    }
    let is_length = |reading: &&Reading| matches!(reading.kind, ReadingKind::Length(_));
    let named = points.into_iter().zip(cables).enumerate();
    Figure {
        x: Axis::whole(POSE),
        y: unit.axis(),
        bands: unit
            .band(fit.analysis.readings.iter().filter(is_length))
            .into_iter()
            .collect(),
        series: named
            .map(|(index, (points, cable))| Series::of_cable(index, &cable.name, points))
            .collect(),
        has_zero_line: true,
        ..Figure::default()
    }
}

/// Residuals of the laser.
#[must_use]
pub fn laser(fit: &Fit, unit: Unit, excluded: &BTreeSet<i64>) -> Figure {
    let readings = || {
        let all = fit.analysis.readings.iter();
        all.filter(|reading| reading.kind == ReadingKind::Laser)
    };
    let point = |reading: &Reading| {
        let value = unit.value(reading)?;
        Some(over_pose(&fit.dataset, excluded, reading.row, value))
    };
    let points = readings().filter_map(point).collect();
    Figure {
        x: Axis::whole(POSE),
        y: unit.axis(),
        bands: unit.band(readings()).into_iter().collect(),
        series: vec![Series::new("laser", Ink::Accent, Marker::Circle, points)],
        has_zero_line: true,
        ..Figure::default()
    }
}

//! Plots of channels over time, with the poses extracted from them.

use tautline_channels::{Series, Source};
use tautline_import::{PoseReport, outline};

use crate::plot::figure::{Axis, Curve, Figure, Ink, Span};

/// Number of parts of a recording that a plot over the whole width of a screen can resolve.
const COLUMNS: usize = 1200;

/// The outlines of all channels, one list per series. They are computed once, because a recording may be long.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outlines {
    series: Vec<Vec<Vec<(usize, f64)>>>,
}

impl Outlines {
    /// Computes the outlines of all channels of the sources.
    #[must_use]
    pub fn of(sources: &[Source]) -> Self {
        let series = sources.iter().flat_map(|source| &source.series);
        let of_series = |series: &Series| {
            let channels = series.channels.iter();
            channels
                .map(|channel| outline(&channel.values, COLUMNS))
                .collect()
        };
        Self {
            series: series.map(of_series).collect(),
        }
    }

    /// Rows and values of a numeric channel.
    #[must_use]
    pub fn channel(&self, series: usize, channel: usize) -> &[(usize, f64)] {
        let found = self.series.get(series).and_then(|one| one.get(channel));
        found.map_or(&[], Vec::as_slice)
    }
}

/// A channel over time, or over rows if there are no times, with the poses behind it.
#[must_use]
pub fn channel_figure(
    name: &str,
    unit: Option<&str>,
    course: &[(usize, f64)],
    time_s: Option<&[f64]>,
    poses: &[PoseReport],
) -> Figure {
    let place = |row: usize| match time_s {
        Some(time_s) => time_s.get(row).copied().unwrap_or(f64::NAN),
        None => row as f64 + 1.0,
    };
    let label = unit.map_or_else(|| name.to_owned(), |unit| format!("{name} ({unit})"));
    // If every row is a pose, there are no spans to mark.
    let are_cut = poses.iter().any(|pose| pose.rows > 1);
    let spans = poses
        .iter()
        .filter(|_| are_cut)
        .filter_map(|pose| match time_s {
            Some(_) => Some([pose.begin_s?, pose.end_s?]),
            None => {
                let first = pose.first_row as f64 + 1.0;
                Some([first, first + pose.rows.saturating_sub(1) as f64])
            }
        });
    Figure {
        x: match time_s {
            Some(_) => Axis::new("Time", "s"),
            None => Axis::whole("Row"),
        },
        y: Axis::new(label, ""),
        spans: spans.map(|x| Span { x, ink: Ink::Good }).collect(),
        curves: vec![Curve {
            name: String::new(),
            ink: Ink::Accent,
            dashed: false,
            points: course
                .iter()
                .map(|(row, value)| [place(*row), *value])
                .collect(),
        }],
        ..Figure::default()
    }
}

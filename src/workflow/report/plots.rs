//! Plots of residuals.

use super::colours::PLOT;
use crate::identification::RESIDUAL;
use crate::plot::Drawing;
use crate::plot::draw::drawing;
use crate::plot::figure::{Axis, Band, Columns, Curve, Figure, Ink, Marker, Point, Series};
use crate::plot::histogram::{histogram as count, normal};
use crate::wording::first_lower;

/// Size of the plot of one cable (pt), two of which fit side by side.
pub const SIZE: [f64; 2] = [236.0, 104.0];
/// Scale that makes the labels of a plot 7 pt high.
pub const SCALE: f64 = 0.61;
/// Residuals beyond this many standard deviations are improbable.
const LIMIT: f64 = 3.0;

/// Residuals over the poses, in standard deviations, with a band that contains 997 of 1000. Points are the number of the pose
/// and its residual; `summary` is placed beside the name.
pub fn residuals(name: &str, points: &[(i64, f64)], summary: &str) -> Drawing {
    let series = |ink: Ink, is_beyond: bool| {
        let own = points
            .iter()
            .filter(|(_, r)| (r.abs() > LIMIT) == is_beyond);
        let shown = own.map(|(pose, r)| Point::new(*pose as f64, *r));
        Series::new("", ink, Marker::Circle, shown.collect())
    };
    let figure = Figure {
        x: Axis::whole("Pose"),
        y: Axis::new([name, summary].join("  "), ""),
        bands: vec![Band {
            name: String::new(),
            y: [-LIMIT, LIMIT],
        }],
        series: vec![series(Ink::Accent, false), series(Ink::Warning, true)],
        has_zero_line: true,
        ..Figure::default()
    };
    let label = format!("Residuals of {name}, prediction minus reading, over the poses");
    drawing(label, &figure, SIZE, SCALE, &PLOT)
}

/// Residuals against the variable they depend on.
pub fn dependence(name: &str, figure: &Figure) -> Drawing {
    let size = [2.0 * SIZE[0] + 12.0, 132.0];
    let label = format!("{name}, along {}", figure.x.title());
    drawing(label, figure, size, SCALE, &PLOT)
}

/// The residuals in which an effect shows.
pub fn signature_plot(effect: &str, readings: &str, figure: &Figure) -> Drawing {
    let label = format!("{effect}: residuals of {}", first_lower(readings));
    let figure = Figure {
        y: Axis::new(readings, ""),
        ..figure.clone()
    };
    drawing(label, &figure, SIZE, SCALE, &PLOT)
}

/// The course of one part of a robot over its sessions.
pub fn course(figure: &Figure) -> Drawing {
    let label = format!("{} over time", figure.y.title());
    drawing(label, figure, SIZE, SCALE, &PLOT)
}

/// Number of histogram bins per standard deviation.
const BINS: f64 = 2.0;
/// Range of a histogram in standard deviations to either side; the outermost bins include residuals beyond.
const SPAN: f64 = 5.0;

/// Distribution of the residuals, with the one expected of the stated noise.
pub fn histogram(name: &str, residuals: &[f64]) -> Drawing {
    let (edges, counts) = count(residuals, SPAN, (2.0 * SPAN * BINS) as usize);
    let beyond = ((SPAN - LIMIT) * BINS) as usize;
    let end = counts.len() - beyond;
    let columns = |ink: Ink, from: usize, to: usize| Columns {
        name: String::new(),
        ink,
        outline: false,
        edges: edges[from..=to].to_vec(),
        heights: counts[from..to].to_vec(),
    };
    let figure = Figure {
        x: Axis::new(RESIDUAL, "standard deviations"),
        y: Axis::whole(name),
        columns: vec![
            columns(Ink::Warning, 0, beyond),
            columns(Ink::Accent, beyond, end),
            columns(Ink::Warning, end, counts.len()),
        ],
        curves: vec![Curve {
            name: "expected".to_owned(),
            ink: Ink::Text,
            dashed: false,
            points: normal(SPAN, residuals.len() as f64 / BINS),
        }],
        ..Figure::default()
    };
    let size = [2.0 * SIZE[0] + 12.0, 128.0];
    let label = format!("{name}: how often residuals of a size occur");
    drawing(label, &figure, size, SCALE, &PLOT)
}

#[cfg(test)]
mod tests {
    use ecolor::Color32;

    use super::super::colours::{ACCENT, WARNING};
    use super::*;
    use crate::plot::drawing::Shape;

    fn dots(drawing: &Drawing) -> Vec<([f64; 2], Color32)> {
        let shapes = drawing.shapes.iter();
        shapes
            .filter_map(|shape| match shape {
                Shape::Disc { at, colour, .. } => Some((*at, *colour)),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn residuals_stay_in_the_plot_and_those_outside_the_band_are_marked() {
        let points = [(1, 0.5), (2, -2.9), (3, 3.5), (4, -400.0)];
        let drawing = residuals("cable-1", &points, "");
        let dots = dots(&drawing);
        assert_eq!(
            dots.iter().map(|(_, colour)| *colour).collect::<Vec<_>>(),
            [ACCENT, ACCENT, WARNING, WARNING]
        );
        for ([x, y], _) in dots {
            assert!((0.0..SIZE[0]).contains(&x) && (0.0..SIZE[1]).contains(&y));
        }
    }

    #[test]
    fn one_pose_makes_a_plot() {
        let drawing = residuals("cable-1", &[(1, 0.0)], "");
        assert!(!drawing.svg().contains("NaN"));
        assert!(!histogram("Lengths", &[]).svg().contains("NaN"));
    }

    #[test]
    fn names_are_no_markup() {
        let svg = residuals("<script>\"&", &[(1, 0.0)], "").svg();
        assert!(!svg.contains("<script"), "{svg}");
        assert!(svg.contains("&lt;script&gt;&quot;&amp;"), "{svg}");
    }
}

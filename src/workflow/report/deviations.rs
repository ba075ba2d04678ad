//! Drawings of pulley displacements: three views of the frame, and the coordinates with intervals.

use ecolor::Color32;
use emath::{Align2, Pos2, Rect, Vec2, vec2};
use nalgebra::{Matrix3, Vector3};
use tautline_core::conformance::conformance_probability;
use tautline_session::DecisionRule;

use super::colours::{ACCENT, FAINT, MUTED, PLOT, WARNING};
use super::plots::{SCALE, SIZE};
use super::tolerance::{COVERAGE, Conformity, expanded_uncertainty_m};
use crate::plot::Drawing;
use crate::plot::canvas::{Canvas, Stroke};
use crate::plot::draw::drawing;
use crate::plot::figure::{Axis, Band, Figure, Ink, Marker, Point, Series};
use crate::plot::round::round_down;
use crate::wording::units::significant;

/// Size of a view (pt), three of which fit side by side.
const VIEW: [f32; 2] = [153.0, 150.0];
/// Space around the frame in a view (pt).
const MARGIN: f32 = 20.0;
/// Size of the text in a view (pt).
const TEXT: f32 = 7.0;
/// Length of the longest displacement, as a fraction of the view.
const LONGEST: f64 = 0.22;
/// Distance of a label from its pulley (pt).
const LABEL: f32 = 11.0;
/// Distance below which numbers share a label (pt).
const SAME: f32 = 7.0;

/// A pulley with its displacement.
pub struct Deviation {
    /// Expected position (m).
    pub from: Vector3<f64>,
    /// Displacement (m).
    pub by: Vector3<f64>,
    /// Covariance of the displacement (m^2); `None` if unknown.
    pub covariance: Option<Matrix3<f64>>,
    /// Whether it is highlighted.
    pub is_marked: bool,
}

impl Deviation {
    /// Expanded uncertainty of the length of the displacement, for any direction (m).
    pub fn uncertainty_m(&self, coverage_factor: f64) -> Option<f64> {
        let covariance = self.covariance.as_ref()?;
        Some(expanded_uncertainty_m(covariance, coverage_factor))
    }

    /// Conformity of its length with a tolerance (m).
    pub fn conformity(&self, rule: DecisionRule, tolerance_m: f64) -> Conformity {
        Conformity::of(rule, &self.by, self.covariance.as_ref(), tolerance_m)
    }

    /// Conformance probability with a tolerance (m) on the length of the displacement.
    pub fn conformance_probability(&self, tolerance_m: f64) -> Option<f64> {
        let covariance = self.covariance.as_ref()?;
        Some(conformance_probability(&self.by, covariance, tolerance_m))
    }
}

/// Views from above, from the front and from the side, and the magnification of the displacements.
pub fn views(pulleys: &[Deviation]) -> (Vec<Drawing>, f64) {
    let spread = |k: usize| {
        let at = pulleys.iter().map(|pulley| pulley.from[k]);
        let bounds = at.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        });
        (bounds[1] - bounds[0]).max(0.0)
    };
    let extent = (0..3).map(spread).fold(0.0, f64::max);
    let longest = pulleys.iter().map(|one| one.by.norm()).fold(0.0, f64::max);
    let magnification = match longest > 0.0 {
        true => round_down(LONGEST * extent / longest).max(1.0),
        false => 1.0,
    };
    let sides = [
        ("From above", ["x", "y"], [0, 1]),
        ("From the front", ["x", "z"], [0, 2]),
        ("From the side", ["y", "z"], [1, 2]),
    ];
    let drawn = sides.map(|(title, names, axes)| {
        let label = format!(
            "{title}: pulleys and their displacements, magnified {} times",
            significant(magnification, 2)
        );
        let whole = Rect::from_min_size(Pos2::ZERO, vec2(VIEW[0], VIEW[1]));
        Drawing::record(label, whole, 1.0, |canvas| {
            let view = View::new(pulleys, axes, extent, whole);
            view.draw(canvas, pulleys, magnification, (title, names));
        })
    });
    (drawn.into(), magnification)
}

/// Projection of the robot to a view.
struct View {
    axes: [usize; 2],
    /// Centre of the pulleys (m).
    middle: [f64; 2],
    /// Points per metre.
    scale: f64,
    whole: Rect,
}

impl View {
    fn new(pulleys: &[Deviation], axes: [usize; 2], extent: f64, whole: Rect) -> Self {
        let middle = axes.map(|k| {
            let at = pulleys.iter().map(|pulley| pulley.from[k]);
            let [low, high] = at.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            });
            0.5 * (low + high)
        });
        let room = whole.width().min(whole.height()) - 2.0 * MARGIN;
        Self {
            axes,
            middle,
            scale: f64::from(room) / extent.max(1e-6),
            whole,
        }
    }

    fn place(&self, point: &Vector3<f64>) -> Pos2 {
        let [x, y] = [0, 1].map(|k| self.scale * (point[self.axes[k]] - self.middle[k]));
        self.whole.center() + vec2(x as f32, -y as f32)
    }

    fn draw(
        &self,
        canvas: &mut dyn Canvas,
        pulleys: &[Deviation],
        magnification: f64,
        (title, [across, up]): (&str, [&str; 2]),
    ) {
        let frame = pulleys.iter().map(|pulley| self.place(&pulley.from));
        let frame = Rect::from_points(&frame.collect::<Vec<_>>());
        let corners = [
            frame.left_top(),
            frame.right_top(),
            frame.right_bottom(),
            frame.left_bottom(),
            frame.left_top(),
        ];
        canvas.line(&corners, Stroke::new(0.75, FAINT), false);
        let mut labels: Vec<(Pos2, String)> = Vec::new();
        let mut arrows = Vec::new();
        for (index, pulley) in pulleys.iter().enumerate() {
            let from = self.place(&pulley.from);
            let to = self.place(&(pulley.from + magnification * pulley.by));
            let colour = if pulley.is_marked { WARNING } else { ACCENT };
            canvas.ring(from, 2.2, Stroke::new(0.75, MUTED));
            arrow(canvas, from, to, colour);
            arrows.push([from, to]);
            let number = (index + 1).to_string();
            match labels
                .iter_mut()
                .find(|(other, _)| other.distance(from) < SAME)
            {
                Some((_, text)) => *text = format!("{text}, {number}"),
                None => labels.push((from, number)),
            }
        }
        for (pulley, text) in &labels {
            let at = label_place(*pulley, frame.center(), &arrows);
            canvas.text(at, Align2::CENTER_CENTER, text, TEXT, MUTED);
        }
        let corner = self.whole.left_top();
        canvas.text(corner, Align2::LEFT_TOP, title, TEXT, MUTED);
        let axes = format!("{across} to the right, {up} upwards");
        canvas.text(
            self.whole.left_bottom(),
            Align2::LEFT_BOTTOM,
            &axes,
            0.9 * TEXT,
            MUTED,
        );
    }
}

/// Position of a pulley's label: outwards, or where no arrow crosses it.
fn label_place(pulley: Pos2, centre: Pos2, arrows: &[[Pos2; 2]]) -> Pos2 {
    let out = (pulley - centre).normalized();
    let out = if out == Vec2::ZERO { Vec2::DOWN } else { out };
    let sides = [out, out.rot90(), -out.rot90(), -out];
    let places = sides.map(|side| pulley + LABEL * side);
    let is_free = |at: &&Pos2| {
        arrows.iter().all(|[from, to]| {
            (0..=8).all(|k| from.lerp(*to, k as f32 / 8.0).distance(**at) > 0.5 * LABEL)
        })
    };
    places.iter().find(is_free).copied().unwrap_or(places[0])
}

/// A line with an arrow head; only the head if it is too short.
fn arrow(canvas: &mut dyn Canvas, from: Pos2, to: Pos2, colour: Color32) {
    let along = to - from;
    canvas.line(&[from, to], Stroke::new(1.25, colour), false);
    if along.length() < 3.0 {
        canvas.disc(to, 1.2, colour);
        return;
    }
    let (along, across) = (along.normalized(), along.normalized().rot90());
    let back = to - 4.0 * along;
    canvas.polygon(vec![to, back + 1.8 * across, back - 1.8 * across], colour);
}

/// The coordinates of all displacements with 95 % intervals, and the tolerance band (m).
pub fn coordinates(pulleys: &[Deviation], tolerance_m: Option<f64>) -> Drawing {
    let inks = [
        ("dx", Ink::Accent, Marker::Circle),
        ("dy", Ink::Text, Marker::Square),
        ("dz", Ink::Muted, Marker::Triangle),
    ];
    let series = inks
        .into_iter()
        .enumerate()
        .map(|(axis, (name, ink, marker))| {
            let point = |(index, pulley): (usize, &Deviation)| {
                let variance = pulley.covariance.map_or(0.0, |c| c[(axis, axis)]);
                let shift = 0.18 * (axis as f64 - 1.0);
                Point {
                    sd: [0.0, 1e3 * COVERAGE * variance.max(0.0).sqrt()],
                    ..Point::new(index as f64 + 1.0 + shift, 1e3 * pulley.by[axis])
                }
            };
            let points = pulleys.iter().enumerate().map(point).collect();
            let mut series = Series::new(name, ink, marker, points);
            series.short = name.to_owned();
            series
        });
    let numbers = 1..=pulleys.len();
    let figure = Figure {
        x: Axis {
            names: numbers.map(|k| (k as f64, k.to_string())).collect(),
            ..Axis::new("Pulley", "")
        },
        y: Axis::new("Displacement, bars: expanded uncertainty", "mm"),
        bands: tolerance_m
            .map(|tolerance| Band {
                name: "tolerance".to_owned(),
                y: [-1e3 * tolerance, 1e3 * tolerance],
            })
            .into_iter()
            .collect(),
        series: series.collect(),
        has_zero_line: true,
        ..Figure::default()
    };
    let size = [2.0 * SIZE[0] + 12.0, 150.0];
    let label = "Displacements of the pulleys along x, y and z with their uncertainty";
    drawing(label, &figure, size, SCALE, &PLOT)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pulleys() -> Vec<Deviation> {
        let corner = |k: usize| {
            let side = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
            Vector3::new(2.0 * side(1), 1.5 * side(2), side(4))
        };
        (0..8)
            .map(|k| Deviation {
                from: corner(k),
                by: Vector3::new(0.001, 0.0, 0.002 * k as f64),
                covariance: Some(Matrix3::identity() * 1e-8),
                is_marked: k == 3,
            })
            .collect()
    }

    #[test]
    fn every_pulley_is_named_once_in_each_view_and_all_stays_inside() {
        let (views, magnification) = views(&pulleys());
        // The longest of 14 mm takes at most 22 % of 4 m.
        assert_eq!(magnification, 50.0);
        for view in views {
            let svg = view.svg();
            assert!(!svg.contains("NaN"), "{svg}");
            for number in 1..=8 {
                let named = [
                    format!(">{number}<"),
                    format!(">{number}, "),
                    format!(", {number}<"),
                    format!(", {number}, "),
                ];
                let times: usize = named
                    .iter()
                    .map(|text| svg.matches(text.as_str()).count())
                    .sum();
                assert_eq!(times, 1, "pulley {number} in {}", view.label);
            }
        }
        let plot = coordinates(&pulleys(), Some(0.01)).svg();
        assert!(plot.contains("tolerance") && !plot.contains("NaN"));
    }
}

//! Cursors A and B: draggable lines at readings.

use egui::{Rect, Ui};
use tautline_workflow::plot::Figure;
use tautline_workflow::plot::figure::{Axis, Point, Series};
use tautline_workflow::plot::scale::readable;

use super::PlotView;

/// Distance at which a cursor is grabbed (points of the screen).
const GRAB: f32 = 6.0;

impl PlotView {
    /// Shows the cursors at a quarter and three quarters of the width, or hides them.
    pub(crate) fn switch_cursors(&mut self, figure: &Figure) {
        self.cursors = match (self.cursors, self.drawn) {
            (None, Some(drawn)) => {
                let [low, high] = drawn.scale.view[0];
                let at = |share: f64| snapped(figure, low + share * (high - low));
                at(0.25).zip(at(0.75)).map(|(a, b)| [a, b])
            }
            _ => None,
        };
    }

    /// Grabs a cursor under the pointer; returns whether a cursor is being dragged.
    pub(super) fn grab(&mut self, ui: &Ui, outer: Rect) -> bool {
        let (is_down, from) = ui.input(|input| {
            let pointer = &input.pointer;
            (pointer.primary_down(), pointer.press_origin())
        });
        if !is_down {
            self.grabbed = None;
        } else if self.grabbed.is_none()
            && ui.input(|input| input.pointer.primary_pressed())
            && let (Some(from), Some(drawn), Some(cursors)) = (from, self.drawn, self.cursors)
            && ui.rect_contains_pointer(outer)
            && drawn.scale.rect.contains(from)
        {
            self.grabbed = (0..2).find(|k| (drawn.scale.x(cursors[*k]) - from.x).abs() <= GRAB);
        }
        self.grabbed.is_some()
    }

    pub(super) fn move_cursor(&mut self, figure: &Figure, x: f64) {
        if let (Some(k), Some(cursors), Some(x)) =
            (self.grabbed, &mut self.cursors, snapped(figure, x))
        {
            cursors[k] = x;
        }
    }

    /// Values of all series at the cursors: for each column its heading, its unit, the values at A and at B, and B
    /// minus A.
    pub(crate) fn readings(&self, figure: &Figure) -> Option<Vec<CursorColumn>> {
        let scale = &self.drawn.as_ref()?.scale;
        let [a, b] = self.cursors?;
        let column = |title: &str, axis: &Axis, view: [f64; 2], [a, b]: [f64; 2]| {
            let number = |value: f64| match axis.is_whole {
                true => format!("{value:.0}"),
                false => readable(value, view),
            };
            let [a, b] = [axis.number(a), axis.number(b)];
            CursorColumn {
                title: title.to_owned(),
                unit: axis.unit.to_string(),
                values: [a, b, b - a].map(number),
            }
        };
        let mut columns = vec![column(&figure.x.label, &figure.x, scale.view[0], [a, b])];
        let is_short = figure.series.len() > 4;
        let shown = figure.series.iter();
        for series in shown.filter(|one| !self.is_hidden(figure, one)) {
            if let (Some(at_a), Some(at_b)) = (closest(series, a), closest(series, b)) {
                let name = match is_short && !series.short.is_empty() {
                    true => &series.short,
                    false => &series.name,
                };
                let values = [at_a.y, at_b.y];
                columns.push(column(name, &figure.y, scale.view[1], values));
            }
        }
        Some(columns)
    }
}

/// Values along x or of a series at both cursors, and their difference.
#[derive(Debug, PartialEq)]
pub(crate) struct CursorColumn {
    pub(crate) title: String,
    pub(crate) unit: String,
    pub(crate) values: [String; 3],
}

/// Position along x of the reading nearest to `x`.
fn snapped(figure: &Figure, x: f64) -> Option<f64> {
    let nearest = figure.series.iter().filter_map(|one| closest(one, x));
    let nearest = nearest.map(|point| point.x);
    nearest.min_by(|a, b| (a - x).abs().total_cmp(&(b - x).abs()))
}

/// Point of a series nearest to a position along x.
fn closest(series: &Series, x: f64) -> Option<&Point> {
    let points = series.points();
    let after = points.partition_point(|point| point.x < x);
    let around = points.get(after.saturating_sub(1)..(after + 1).min(points.len()))?;
    let away = |point: &&Point| (point.x - x).abs();
    around.iter().min_by(|a, b| away(a).total_cmp(&away(b)))
}

//! Items of a figure, in the order of painting.

use std::collections::BTreeSet;
use std::fmt;
use std::ops::RangeInclusive;

use egui::{Color32, Shape, Stroke, Theme, Ui};
use egui_plot::{
    Axis, Bar, BarChart, FilledArea, HLine, Line, LineStyle, PlotBounds, PlotGeometry, PlotItem,
    PlotItemBase, PlotTransform, PlotUi, VLine,
};
use tautline_workflow::plot::draw::Points;
use tautline_workflow::plot::figure::{Columns, Curve, Ribbon, Series, Span};
use tautline_workflow::plot::heat::cells;
use tautline_workflow::plot::scale::Scale;
use tautline_workflow::plot::{Colours, Figure};

use super::axes::scale_of;
use super::{PlotInput, PlotView};
use crate::model::Selection;
use crate::views::plots::picture::{Picture, PictureTexture};
use crate::views::plots::screen::Screen;
use crate::views::plots::sources::{POSE, TIME};

/// Width of curves (points).
const CURVE: f32 = 1.75;

/// Inputs of the shapes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ShapesKey {
    generation: u64,
    scale: Scale,
    selection: Selection,
    hidden: BTreeSet<String>,
    pixels_per_point: f32,
    theme: Theme,
}

/// Points of a view: a picture of dense points, and shapes.
pub(super) struct DrawnPoints {
    picture: Option<PictureTexture>,
    shapes: Vec<Shape>,
}

impl fmt::Debug for DrawnPoints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DrawnPoints").finish_non_exhaustive()
    }
}

impl PlotView {
    pub(super) fn add_items<'a>(
        &'a self,
        plot: &mut PlotUi<'a>,
        input: &'a PlotInput<'_>,
        colours: &Colours,
    ) {
        let (figure, colours) = (input.figure, *colours);
        let is_shown = |name: &str| !self.hidden.contains(name);
        if let Some(heat) = &figure.heat {
            plot.add(Painted::new(move |ui, transform, shapes| {
                let scale = scale_of(transform);
                let draw = || {
                    let mut canvas = Screen::new(ui.painter().clone());
                    cells(&mut canvas, heat, &scale, &colours);
                    canvas.into_shapes()
                };
                let mut kept = self.heat.borrow_mut();
                shapes.extend_from_slice(kept.get(self.key(ui, input, scale), draw));
            }));
        }
        for Span { x: [from, to], ink } in &figure.spans {
            let fill = ink.colour(&colours).gamma_multiply(0.22);
            plot.span(egui_plot::Span::new("", *from..=*to).fill(fill));
        }
        for band in figure.bands.iter().filter(|band| is_shown(&band.name)) {
            let [low, high] = band.y;
            let span = egui_plot::Span::new("", low..=high).axis(Axis::Y);
            let edge = Stroke::new(1.0, colours.good.gamma_multiply(0.55));
            let span = span.fill(colours.good.gamma_multiply(0.13)).border(edge);
            plot.span(span.border_style(LineStyle::dashed_dense()));
        }
        if figure.has_zero_line {
            let line = HLine::new("", 0.0).color(colours.muted).width(1.0);
            plot.hline(line.allow_hover(false));
        }
        for ribbon in figure.ribbons.iter().filter(|one| is_shown(&one.of)) {
            add_ribbon(plot, ribbon, &colours);
        }
        for columns in figure.columns.iter().filter(|one| is_shown(&one.name)) {
            add_columns(plot, columns, &colours);
        }
        if let Some(x) = pose_along(figure, input.selection) {
            let line = VLine::new("", x).color(colours.muted).width(1.0);
            plot.vline(line.allow_hover(false));
        }
        plot.add(Painted::new(move |ui, transform, shapes| {
            let scale = scale_of(transform);
            let key = self.key(ui, input, scale);
            let draw = || self.points(ui, input, scale, &colours);
            let mut kept = self.points.borrow_mut();
            let points = kept.get(key, draw);
            shapes.extend(points.picture.as_ref().map(PictureTexture::shape));
            shapes.extend_from_slice(&points.shapes);
        }));
        for curve in figure.curves.iter().filter(|curve| is_shown(&curve.name)) {
            add_curve(plot, curve, &colours);
        }
        for x in self.cursors.into_iter().flatten() {
            let line = VLine::new("", x).color(colours.accent).width(1.25);
            plot.vline(line.allow_hover(false));
        }
    }

    fn key(&self, ui: &Ui, input: &PlotInput<'_>, scale: Scale) -> ShapesKey {
        ShapesKey {
            generation: input.generation,
            scale,
            selection: input.selection,
            hidden: self.hidden.clone(),
            pixels_per_point: ui.pixels_per_point(),
            theme: ui.theme(),
        }
    }

    /// Points within the view.
    fn points(
        &self,
        ui: &Ui,
        input: &PlotInput<'_>,
        scale: Scale,
        colours: &Colours,
    ) -> DrawnPoints {
        let (figure, resolution) = (input.figure, ui.pixels_per_point());
        let points = Points::new(figure, scale, input.selection, colours, resolution);
        let is_shown = |series: &Series| !self.is_hidden(figure, series);
        let most = ui.input(|input| input.max_texture_side);
        let picture = points
            .are_dense()
            .then(|| Picture::new(scale.rect, resolution, most))
            .flatten();
        let mut canvas = Screen::new(ui.painter().clone());
        let picture = match picture {
            Some(mut picture) => {
                points.draw_dense(&mut |rect, colour| picture.fill(rect, colour), &is_shown);
                Some(picture.upload(ui.ctx()))
            }
            None => {
                points.draw(&mut canvas, &is_shown);
                None
            }
        };
        points.draw_selected(&mut canvas);
        DrawnPoints {
            picture,
            shapes: canvas.into_shapes(),
        }
    }
}

fn add_columns(plot: &mut PlotUi<'_>, columns: &Columns, colours: &Colours) {
    let colour = columns.ink.colour(colours);
    let bins = columns.edges.windows(2).zip(&columns.heights);
    if columns.outline {
        let steps = bins.flat_map(|(edge, height)| [[edge[0], *height], [edge[1], *height]]);
        let line = Line::new("", steps.collect::<Vec<_>>());
        plot.line(line.color(colour).width(CURVE).allow_hover(false));
        return;
    }
    let bars = bins.map(|(edge, height)| {
        let bar = Bar::new(0.5 * (edge[0] + edge[1]), *height).width(0.94 * (edge[1] - edge[0]));
        bar.fill(colour.gamma_multiply(0.45)).stroke(Stroke::NONE)
    });
    let chart = BarChart::new("", bars.collect()).color(colour);
    plot.bar_chart(chart.allow_hover(false));
}

/// Band of a curve, in pieces where it is interrupted.
fn add_ribbon(plot: &mut PlotUi<'_>, ribbon: &Ribbon, colours: &Colours) {
    let fill = ribbon.ink.colour(colours).gamma_multiply(0.18);
    for piece in ribbon.pieces() {
        let along = |k: usize| piece.iter().map(|edge| edge[k]).collect::<Vec<_>>();
        let area = FilledArea::new("", &along(0), &along(1), &along(2)).fill_color(fill);
        plot.add(area.allow_hover(false));
    }
}

/// Curve, in pieces where it is interrupted.
fn add_curve(plot: &mut PlotUi<'_>, curve: &Curve, colours: &Colours) {
    let style = match curve.dashed {
        true => LineStyle::dashed_dense(),
        false => LineStyle::Solid,
    };
    for piece in curve.pieces() {
        let line = Line::new("", piece.to_vec()).style(style).width(CURVE);
        let line = line.color(curve.ink.colour(colours));
        plot.line(line.allow_hover(false));
    }
}

/// Position of the selected pose, if x is an axis of poses or their times.
fn pose_along(figure: &Figure, selection: Selection) -> Option<f64> {
    let pose = selection.pose?;
    if ![POSE, TIME].contains(&figure.x.label.as_str()) {
        return None;
    }
    let mut points = figure.series.iter().flat_map(Series::points);
    points
        .find(|point| point.pose == Some(pose))
        .map(|point| point.x)
}

type Paint<'a> = Box<dyn Fn(&Ui, &PlotTransform, &mut Vec<Shape>) + 'a>;

/// Plot item painted by a function, for shapes without an item in `egui_plot`.
struct Painted<'a> {
    base: PlotItemBase,
    paint: Paint<'a>,
}

impl<'a> Painted<'a> {
    fn new(paint: impl Fn(&Ui, &PlotTransform, &mut Vec<Shape>) + 'a) -> Self {
        Self {
            base: PlotItemBase::new(String::new()),
            paint: Box::new(paint),
        }
    }
}

impl PlotItem for Painted<'_> {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        (self.paint)(ui, transform, shapes);
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        Color32::TRANSPARENT
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}

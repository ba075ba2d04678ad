//! A small plot of points and lines with a band that points should stay in.

use egui::{Color32, Role, Ui, Vec2b, WidgetInfo};
use egui_plot::{AxisHints, HLine, Line, MarkerShape, Plot, PlotPoints, Points, Span};

use crate::app::theme;

/// One colour of points, or a line.
#[derive(Debug, Clone)]
pub struct Series {
    /// What the legend calls it.
    pub name: String,
    /// Its colour.
    pub colour: Color32,
    /// Its points.
    pub points: Vec<[f64; 2]>,
    /// Whether the points are joined by a line instead of being drawn.
    pub joined: bool,
    /// Whether it is drawn with more weight.
    pub strong: bool,
}

/// A small plot.
#[derive(Debug, Clone, Copy)]
pub struct Scatter<'a> {
    /// Its accessible name.
    pub name: &'a str,
    /// Title and unit of the horizontal axis.
    pub x: &'a str,
    /// Title and unit of the vertical axis.
    pub y: &'a str,
    /// Half the height of the band about zero, drawn if there is one.
    pub band: Option<f64>,
    /// Height of the plot (points).
    pub height: f32,
}

/// Draws the plot.
pub fn scatter(ui: &mut Ui, plot: &Scatter<'_>, series: &[Series]) {
    let palette = theme::of(ui);
    let (x, y) = (plot.x, plot.y);
    let mut drawn = Plot::new(plot.name)
        .height(plot.height)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .show_background(false)
        .show_crosshair(false)
        .grid_spacing(egui::Rangef::new(12.0, 64.0))
        .grid_color(palette.line)
        .set_margin_fraction(egui::vec2(0.04, 0.1))
        .auto_bounds(Vec2b::TRUE)
        .custom_x_axes(vec![
            AxisHints::new_x()
                .label(x)
                .label_spacing(egui::Rangef::new(20.0, 40.0)),
        ])
        .custom_y_axes(vec![AxisHints::new_y().label(y)]);
    if let Some(band) = plot.band {
        drawn = drawn.include_y(1.3 * band).include_y(-1.3 * band);
    }
    let response = drawn.show(ui, |ui| {
        if let Some(band) = plot.band {
            let fill = palette.good.gamma_multiply(0.14);
            let span = Span::new("", -band..=band).axis(egui_plot::Axis::Y);
            ui.span(span.fill(fill).border(egui::Stroke::NONE));
            ui.hline(
                HLine::new("", 0.0)
                    .color(palette.muted)
                    .width(1.0)
                    .allow_hover(false),
            );
        }
        for one in series {
            let points: PlotPoints<'_> = one.points.clone().into();
            if one.joined {
                let width = if one.strong { 2.0 } else { 1.0 };
                ui.line(
                    Line::new(one.name.clone(), points)
                        .color(one.colour)
                        .width(width),
                );
            } else {
                let radius = if one.strong { 3.5 } else { 2.0 };
                let points = Points::new(one.name.clone(), points);
                ui.points(
                    points
                        .shape(MarkerShape::Circle)
                        .color(one.colour)
                        .radius(radius),
                );
            }
        }
    });
    let name = plot.name;
    response
        .response
        .widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
}

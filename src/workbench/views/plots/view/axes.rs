//! Axes of a plot: layout, ticks, and zooming along an axis.

use egui::{FontId, Rangef, Rect, RichText, Vec2, vec2};
use egui_plot::{AxisHints, GridMark, Plot, PlotTransform, PlotUi};
use tautline_workflow::plot::Colours;
use tautline_workflow::plot::draw::{TEXT, legible_ticks};
use tautline_workflow::plot::figure::Axis;
use tautline_workflow::plot::scale::{Scale, Tick};

use super::PlotInput;
use crate::theme::GRID;

/// Scrolling distance (points) for a zoom factor of e.
const WHEEL: f32 = 240.0;

pub(crate) fn scale_of(transform: &PlotTransform) -> Scale {
    let bounds = transform.bounds();
    let ([left, low], [right, high]) = (bounds.min(), bounds.max());
    Scale {
        view: [[left, right], [low, high]],
        rect: *transform.frame(),
    }
}

/// Plot with its axes; `inner` is the rectangle of the data.
pub(super) fn arranged<'a>(input: &'a PlotInput<'_>, inner: Rect, colours: &Colours) -> Plot<'a> {
    let figure = input.figure;
    let [x, y] = input.whole;
    // Space below the data for ticks and title; an axis of names has no title.
    let below = match figure.x.names.is_empty() {
        true => 8.0 * GRID,
        false => 4.0 * GRID,
    };
    let ticks = |axis: &'a Axis, length: f32, is_x: bool| {
        move |view: [f64; 2]| legible_ticks(axis, view, length.max(1.0), is_x)
    };
    let along_x = ticks(&figure.x, inner.width() - 8.0 * GRID, true);
    let along_y = ticks(&figure.y, inner.height() - below, false);
    let mut x_axis = hints(AxisHints::new_x(), colours, along_x);
    // An axis of names needs no title.
    if figure.x.names.is_empty() {
        let title = RichText::new(figure.x.title()).size(TEXT);
        x_axis = x_axis.label(title.color(colours.text));
    }
    let mut plot = Plot::new(input.name)
        .id(input.id)
        .include_x(x[0])
        .include_x(x[1])
        .include_y(y[0])
        .include_y(y[1])
        .set_margin_fraction(Vec2::ZERO)
        .min_size(Vec2::ZERO)
        .width(inner.width())
        .height(inner.height())
        .allow_scroll(false)
        .show_y(false)
        .show_x(figure.heat.is_none())
        .cursor_color(colours.line)
        .grid_color(colours.line.gamma_multiply(0.7))
        .grid_spacing(Rangef::new(0.0, 1.0))
        .show_grid(figure.heat.is_none())
        .x_grid_spacer(move |input| marks(along_x(input.bounds.into()), input.bounds.into()))
        .y_grid_spacer(move |input| marks(along_y(input.bounds.into()), input.bounds.into()))
        .custom_x_axes(vec![x_axis])
        .custom_y_axes(vec![hints(AxisHints::new_y(), colours, along_y)]);
    if let Some(link) = input.link {
        plot = plot
            .link_axis(link, [true, false])
            .link_cursor(link, [true, false]);
    }
    plot
}

/// Axis with its ticks in a view.
fn hints<'a>(
    hints: AxisHints<'a>,
    colours: &Colours,
    ticks: impl Fn([f64; 2]) -> Vec<Tick> + 'a,
) -> AxisHints<'a> {
    hints
        .label_spacing(Rangef::new(0.0, 1.0))
        .tick_label_color(colours.muted)
        .tick_label_font(FontId::proportional(TEXT))
        .formatter(move |mark, range| {
            let mut ticks = ticks([*range.start(), *range.end()]).into_iter();
            let tick = ticks.find(|(at, _)| *at == mark.value);
            tick.map_or_else(String::new, |(_, text)| text)
        })
}

/// Grid marks for `egui_plot`. The ticks were chosen by the available room, so none is omitted because of a small step.
fn marks(ticks: Vec<Tick>, [low, high]: [f64; 2]) -> Vec<GridMark> {
    let step_size = high - low;
    let mark = |(value, _)| GridMark { value, step_size };
    ticks.into_iter().map(mark).collect()
}

/// Zooms by the wheel; over an axis only along that axis.
pub(super) fn zoom_by_wheel(plot: &mut PlotUi<'_>, inner: Rect) {
    let (wheel, at) = plot
        .ctx()
        .input(|input| (input.smooth_scroll_delta().y, input.pointer.hover_pos()));
    let frame = *plot.transform().frame();
    let is_over = plot.response().contains_pointer();
    let Some(at) = at.filter(|at| wheel != 0.0 && inner.contains(*at)) else {
        return;
    };
    if is_over || !frame.contains(at) {
        let factor = (wheel / WHEEL).exp();
        let of = |is_zoomed: bool| if is_zoomed { factor } else { 1.0 };
        let factors = vec2(of(at.x >= frame.min.x), of(at.y <= frame.max.y));
        let centre = plot.plot_from_screen(at);
        plot.zoom_bounds(factors, centre);
    }
}

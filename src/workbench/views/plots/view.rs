//! A figure in the window, drawn by `egui_plot`: axes, grid, panning, zoom, box zoom and linked axes are its own. Added are
//! readings with bars, thinned to what can be seen, a legend beside the title, and cursors A and B.

use std::cell::RefCell;
use std::collections::BTreeSet;

use egui::{
    Align2, FontId, Id, Key, Popup, Pos2, Rangef, Rect, Response, RichText, Role, Sense, Shape,
    Theme, Ui, UiBuilder, Vec2, WidgetInfo, vec2,
};
use egui_plot::{
    Axis as PlotAxis, AxisHints, Bar, BarChart, GridMark, HLine, Line, LineStyle, Plot, PlotBounds,
    PlotGeometry, PlotItem, PlotItemBase, PlotTransform, PlotUi, Span, VLine,
};
use tautline_workflow::plot::draw::{Points, TEXT, apart, legend, right_margin};
use tautline_workflow::plot::figure::{Axis, Columns, Curve, Point, Series};
use tautline_workflow::plot::heat::{cells, colour_scale};
use tautline_workflow::plot::scale::{Scale, Tick, readable, scale_ticks};
use tautline_workflow::plot::table::csv;
use tautline_workflow::plot::{Canvas, Colours, Figure, VisiblePoints};

use super::hit::{Hit, cell_words, nearest, selects, words};
use super::screen::{Screen, colours, text_width};
use super::sources::{POSE, TIME};
use crate::model::command::Format;
use crate::model::{Memo, Selection};
use crate::theme::{self, GRID};

/// Points of the wheel that zoom by a factor of e.
const WHEEL: f32 = 240.0;
/// Distance at which a cursor is grabbed (points of the screen).
const GRAB: f32 = 6.0;
/// Width of curves (points).
const CURVE: f32 = 1.75;

/// State of a plot between frames, beside the zoom, which `egui_plot` keeps by the identity of the plot.
#[derive(Debug, Default)]
pub(crate) struct PlotView {
    /// Names of the series, curves, bands and histograms that the legend has switched off.
    hidden: BTreeSet<String>,
    /// Places of the cursors A and B along x, at readings, while they are shown.
    pub(crate) cursors: Option<[f64; 2]>,
    grabbed: Option<usize>,
    resets: bool,
    /// What was drawn last.
    pub(crate) drawn: Option<Drawn>,
    /// Shapes of the heat map and of the points, which change less often than frames are drawn.
    shapes: [RefCell<Memo<ShapesKey, Vec<Shape>>>; 2],
    menu: Selection,
}

/// Displayed values, the rectangle of the data, and the size of the whole plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drawn {
    pub(crate) scale: Scale,
    pub(crate) size: Vec2,
}

#[derive(Debug, Clone, PartialEq)]
struct ShapesKey {
    generation: u64,
    scale: Scale,
    selection: Selection,
    hidden: BTreeSet<String>,
    pixels_per_point: f32,
    theme: Theme,
}

/// An interaction with a plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PlotEvent {
    Selected(Selection),
    /// Exclude a pose, or include it again.
    Excluded(i64),
    Save(Format),
}

/// A plot of this frame.
pub(crate) struct PlotInput<'a> {
    /// Accessible name.
    pub(crate) name: &'a str,
    /// The zoom belongs to this identity.
    pub(crate) id: Id,
    pub(crate) figure: &'a Figure,
    /// Changes with the figure.
    pub(crate) generation: u64,
    /// Displayed values unless zoomed.
    pub(crate) whole: [[f64; 2]; 2],
    pub(crate) selection: Selection,
    pub(crate) size: Vec2,
    /// Plots with the same link are zoomed and moved together along x.
    pub(crate) link: Option<Id>,
    /// Whether it is docked: the wheel zooms, and its menu offers to save; a plot in a panel scrolls with it.
    pub(crate) is_docked: bool,
}

#[derive(Debug, Default)]
pub(crate) struct PlotOutput {
    pub(crate) events: Vec<PlotEvent>,
    /// What is under the pointer, while it is over the plot.
    pub(crate) hovered: Option<Selection>,
}

impl PlotView {
    /// Shows everything again.
    pub(crate) fn reset(&mut self) {
        self.resets = true;
    }

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

    /// The figure without what the legend has switched off.
    pub(crate) fn visible(&self, figure: &Figure) -> Figure {
        let mut visible = figure.clone();
        visible.series.retain(|one| !self.is_hidden(figure, one));
        visible
            .curves
            .retain(|one| !self.hidden.contains(&one.name));
        visible.bands.retain(|one| !self.hidden.contains(&one.name));
        visible
            .columns
            .retain(|one| !self.hidden.contains(&one.name));
        visible
    }

    /// Whether a series is switched off: by its own entry, or by that of its cable or of its set if it has none.
    fn is_hidden(&self, figure: &Figure, series: &Series) -> bool {
        let of_set = series.name.split_once(": ").map(|(set, _)| set);
        let of_cable = figure.series.iter().find(|one| {
            series.short.is_empty() && one.cable == series.cable && one.cable.is_some()
        });
        self.hidden.contains(&series.name)
            || of_set.is_some_and(|set| self.hidden.contains(set))
            || of_cable.is_some_and(|one| self.hidden.contains(&one.name))
    }

    pub(crate) fn show(&mut self, ui: &mut Ui, input: &PlotInput<'_>) -> PlotOutput {
        let (outer, whole) = ui.allocate_exact_size(input.size, Sense::hover());
        whole.widget_info(|| WidgetInfo::labeled(Role::Image, true, input.name));
        if !ui.is_rect_visible(outer) {
            return PlotOutput::default();
        }
        let palette = theme::of(ui);
        let colours = colours(palette);
        let figure = input.figure;
        let top = self.head(ui, input, outer.shrink2(vec2(GRID, 0.5 * GRID)), &colours);
        let right = right_margin(figure, &text_width(ui.painter()));
        let inner = Rect::from_min_max(
            Pos2::new(outer.min.x + GRID, top + GRID),
            outer.max - vec2(right + GRID, 0.5 * GRID),
        );
        let grabbed = self.grab(ui, outer);
        let mut inside = ui.new_child(UiBuilder::new().max_rect(inner).id_salt(input.id));
        inside.visuals_mut().extreme_bg_color = palette.ground;
        let resets = std::mem::take(&mut self.resets);
        let view = &*self;
        let response =
            arranged(input, inner, &colours)
                .allow_drag(!grabbed)
                .show(&mut inside, |plot| {
                    if resets {
                        plot.set_auto_bounds(true);
                    } else if input.is_docked {
                        zoom_by_wheel(plot, inner);
                    }
                    view.add_items(plot, input, &colours);
                });
        let scale = scale_of(&response.transform);
        self.drawn = Some(Drawn {
            scale,
            size: outer.size(),
        });
        let response = response.response;
        let mut canvas = Screen::new(ui.painter_at(outer));
        if let Some(heat) = &figure.heat {
            colour_scale(&mut canvas, heat, scale.rect, &colours);
        }
        if let Some(cursors) = self.cursors {
            for (x, name) in cursors.into_iter().zip(["A", "B"]) {
                let at = Pos2::new(scale.x(x), scale.rect.min.y) + vec2(0.75 * GRID, 0.5 * GRID);
                if scale.rect.contains(at) {
                    canvas.text(at, Align2::LEFT_TOP, name, TEXT, palette.accent);
                }
            }
        }
        let under = response.hover_pos().filter(|_| !grabbed);
        let hit = under.and_then(|at| {
            let hit = nearest(figure, &scale, at, input.selection)?;
            (!self.is_hidden(figure, &figure.series[hit.series])).then_some(hit)
        });
        if let Some(hit) = hit {
            let point = figure.series[hit.series].points()[hit.point];
            let stroke = tautline_workflow::plot::Stroke::new(1.5, palette.text);
            canvas.ring(scale.place(point.x, point.y), 5.5, stroke);
        }
        drop(canvas);
        if grabbed && let Some(at) = ui.input(|input| input.pointer.latest_pos()) {
            self.move_cursor(figure, scale.values(at)[0]);
        }
        self.respond(ui, &response, input, &scale, hit)
    }

    /// Title of the y axis and the legend, whose entries switch what they stand for off and on; gives the lower edge.
    fn head(&mut self, ui: &Ui, input: &PlotInput<'_>, rect: Rect, colours: &Colours) -> f32 {
        let figure = input.figure;
        let mut canvas = Screen::new(ui.painter_at(rect));
        let title = figure.y.title();
        canvas.text(rect.min, Align2::LEFT_TOP, &title, TEXT, colours.text);
        let mut bottom = rect.min.y + TEXT + GRID;
        let entries = legend(figure, rect, &text_width(ui.painter()));
        for entry in entries {
            let id = input.id.with(("legend", &entry.name, &entry.text));
            let response = ui.interact(entry.rect, id, Sense::click());
            let name = format!("Series {}", entry.name);
            if response.clicked() && !self.hidden.remove(&entry.name) {
                self.hidden.insert(entry.name.clone());
            }
            let is_shown = !self.hidden.contains(&entry.name);
            response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, is_shown, &name));
            entry.draw(&mut canvas, colours, input.selection, is_shown);
            bottom = bottom.max(entry.rect.max.y);
            response.on_hover_text(format!("{}: click to hide or show", entry.name));
        }
        bottom
    }

    /// Whether a cursor is being dragged.
    fn grab(&mut self, ui: &Ui, outer: Rect) -> bool {
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

    fn move_cursor(&mut self, figure: &Figure, x: f64) {
        if let (Some(k), Some(cursors), Some(x)) =
            (self.grabbed, &mut self.cursors, snapped(figure, x))
        {
            cursors[k] = x;
        }
    }

    fn add_items<'a>(&'a self, plot: &mut PlotUi<'a>, input: &'a PlotInput<'_>, colours: &Colours) {
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
                let mut kept = self.shapes[0].borrow_mut();
                shapes.extend_from_slice(kept.get(self.key(ui, input, scale), draw));
            }));
        }
        for [from, to] in &figure.spans {
            let fill = colours.good.gamma_multiply(0.22);
            plot.span(Span::new("", *from..=*to).fill(fill));
        }
        for band in figure.bands.iter().filter(|band| is_shown(&band.name)) {
            let [low, high] = band.y;
            let span = Span::new("", low..=high).axis(PlotAxis::Y);
            let edge = egui::Stroke::new(1.0, colours.good.gamma_multiply(0.55));
            let span = span.fill(colours.good.gamma_multiply(0.13)).border(edge);
            plot.span(span.border_style(LineStyle::dashed_dense()));
        }
        if figure.has_zero_line {
            let line = HLine::new("", 0.0).color(colours.muted).width(1.0);
            plot.hline(line.allow_hover(false));
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
            let draw = || self.points(ui, input, &scale, &colours);
            shapes.extend_from_slice(self.shapes[1].borrow_mut().get(key, draw));
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

    /// Shapes of the points in view.
    fn points(
        &self,
        ui: &Ui,
        input: &PlotInput<'_>,
        scale: &Scale,
        colours: &Colours,
    ) -> Vec<Shape> {
        let (figure, selection) = (input.figure, input.selection);
        let visible = VisiblePoints::new(figure, scale, selection, ui.pixels_per_point());
        let points = Points {
            figure,
            scale,
            visible: &visible,
            selection,
            colours,
        };
        let mut canvas = Screen::new(ui.painter().clone());
        points.draw(&mut canvas, &|series| !self.is_hidden(figure, series));
        points.draw_selected(&mut canvas);
        canvas.into_shapes()
    }

    /// Values of all series at the cursors and their differences, in words.
    pub(crate) fn reading(&self, figure: &Figure) -> Option<String> {
        let scale = &self.drawn.as_ref()?.scale;
        let [a, b] = self.cursors?;
        let numbers = |axis: &Axis, view: [f64; 2], [a, b]: [f64; 2]| {
            let number = |value: f64| match axis.is_whole {
                true => format!("{value:.0}"),
                false => readable(value, view),
            };
            let values = [axis.number(a), axis.number(b)];
            let values = [values[0], values[1], values[1] - values[0]];
            values.map(number).join(", ")
        };
        let along = numbers(&figure.x, scale.view[0], [a, b]);
        let mut text = format!("A, B, B \u{2212} A: {along} {}", figure.x.unit)
            .trim_end()
            .to_owned();
        let is_short = figure.series.len() > 4;
        let shown = figure
            .series
            .iter()
            .filter(|one| !self.is_hidden(figure, one));
        for series in shown {
            if let (Some(at_a), Some(at_b)) = (closest(series, a), closest(series, b)) {
                let name = match is_short && !series.short.is_empty() {
                    true => &series.short,
                    false => &series.name,
                };
                let values = numbers(&figure.y, scale.view[1], [at_a.y, at_b.y]);
                text += &format!("; {name}: {values}");
            }
        }
        if !figure.y.unit.is_empty() {
            text += &format!(" ({})", figure.y.unit);
        }
        Some(text)
    }

    fn respond(
        &mut self,
        ui: &Ui,
        response: &Response,
        input: &PlotInput<'_>,
        scale: &Scale,
        hit: Option<Hit>,
    ) -> PlotOutput {
        let mut output = PlotOutput::default();
        let figure = input.figure;
        let under = response.hover_pos();
        let selected = hit.map(|hit| selects(figure, hit));
        output.hovered = under.map(|_| selected.unwrap_or_default());
        let cell = under.map(|at| scale.values(at));
        if let Some(hit) = hit {
            let text = words(figure, hit, scale);
            response.clone().on_hover_text_at_pointer(text);
        } else if let Some(text) = cell.and_then(|at| cell_words(figure, at)) {
            response.clone().on_hover_text_at_pointer(text);
        }
        if response.clicked() {
            let cable = figure
                .heat
                .as_ref()
                .zip(cell)
                .and_then(|(heat, [x, y])| *heat.cables.get(heat.cell(x, y)?.1)?);
            let selection = selected.or(cable.map(Selection::cable));
            output
                .events
                .push(PlotEvent::Selected(selection.unwrap_or_default()));
        }
        if response.secondary_clicked() {
            self.menu = selected.unwrap_or(input.selection);
            output.events.extend(selected.map(PlotEvent::Selected));
        }
        let has_menu = self.context_menu(response, input, scale, &mut output.events);
        if response.contains_pointer() && !has_menu {
            let pressed = |key| ui.input(|input| input.key_pressed(key));
            if let Some(pose) = input.selection.pose
                && input.is_docked
                && pressed(Key::Delete)
            {
                output.events.push(PlotEvent::Excluded(pose));
            }
            if !input.selection.is_empty() && pressed(Key::Escape) {
                output
                    .events
                    .push(PlotEvent::Selected(Selection::default()));
            }
        }
        output
    }

    fn context_menu(
        &mut self,
        response: &Response,
        input: &PlotInput<'_>,
        scale: &Scale,
        events: &mut Vec<PlotEvent>,
    ) -> bool {
        let menu = Popup::context_menu(response).show(|ui| {
            let pose = self.menu.pose.filter(|pose| *pose != 0 && input.is_docked);
            if let Some(pose) = pose
                && ui
                    .button(format!("Exclude or include pose {pose}"))
                    .clicked()
            {
                events.push(PlotEvent::Excluded(pose));
            }
            if ui.button("Reset view").clicked() {
                self.resets = true;
            }
            if ui.button("Copy values").clicked() {
                ui.ctx()
                    .copy_text(csv(&self.visible(input.figure), scale.view));
            }
            for format in Format::ALL.into_iter().filter(|_| input.is_docked) {
                if ui.button(format!("Save as {}", format.title())).clicked() {
                    events.push(PlotEvent::Save(format));
                }
            }
        });
        menu.is_some()
    }
}

/// The plot with its axes; `inner` is where it is drawn.
fn arranged<'a>(input: &'a PlotInput<'_>, inner: Rect, colours: &Colours) -> Plot<'a> {
    let figure = input.figure;
    let [x, y] = input.whole;
    // Below the data are the ticks and the title, which an axis with names lacks.
    let below = match figure.x.names.is_empty() {
        true => 8.0 * GRID,
        false => 4.0 * GRID,
    };
    let lengths = [inner.width() - 8.0 * GRID, inner.height() - below];
    let [along_x, along_y] = [
        Ticks::new(&figure.x, lengths[0], true),
        Ticks::new(&figure.y, lengths[1], false),
    ];
    let hints = |hints: AxisHints<'a>, ticks: Ticks<'a>| {
        hints
            .label_spacing(Rangef::new(0.0, 1.0))
            .tick_label_color(colours.muted)
            .tick_label_font(FontId::proportional(TEXT))
            .formatter(move |mark, range| ticks.text(mark.value, [*range.start(), *range.end()]))
    };
    let mut x_axis = hints(AxisHints::new_x(), along_x);
    // Axes with names need no title.
    if figure.x.names.is_empty() {
        x_axis = x_axis.label(
            RichText::new(figure.x.title())
                .size(TEXT)
                .color(colours.text),
        );
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
        .x_grid_spacer(move |input| along_x.marks(input.bounds.into()))
        .y_grid_spacer(move |input| along_y.marks(input.bounds.into()))
        .custom_x_axes(vec![x_axis])
        .custom_y_axes(vec![hints(AxisHints::new_y(), along_y)]);
    if let Some(link) = input.link {
        plot = plot
            .link_axis(link, [true, false])
            .link_cursor(link, [true, false]);
    }
    plot
}

/// The ticks of an axis of a length on the screen.
#[derive(Clone, Copy)]
struct Ticks<'a> {
    axis: &'a Axis,
    length: f32,
    is_x: bool,
}

impl<'a> Ticks<'a> {
    fn new(axis: &'a Axis, length: f32, is_x: bool) -> Self {
        Self {
            axis,
            length: length.max(1.0),
            is_x,
        }
    }

    fn ticks(&self, view: [f64; 2]) -> Vec<Tick> {
        let most = match self.is_x {
            true => self.length / 64.0,
            false => (self.length / 28.0).max(4.0),
        };
        let mut ticks = scale_ticks(self.axis, view, most as usize);
        let span = |(value, text): &Tick| {
            let share = (value - view[0]) / (view[1] - view[0]);
            let at = share as f32 * self.length;
            let half = match self.is_x {
                true => 0.3 * TEXT * text.chars().count() as f32 + 0.5 * GRID,
                false => 0.5 * TEXT,
            };
            Rangef::new(at - half, at + half)
        };
        let mut kept = apart(ticks.iter().map(span).collect(), &ticks).into_iter();
        ticks.retain(|_| kept.next().flatten().is_some());
        ticks
    }

    fn marks(&self, view: [f64; 2]) -> Vec<GridMark> {
        // The ticks have been chosen by their room: none is left out for a small step.
        let step_size = view[1] - view[0];
        let mark = |(value, _)| GridMark { value, step_size };
        self.ticks(view).into_iter().map(mark).collect()
    }

    fn text(&self, value: f64, view: [f64; 2]) -> String {
        let found = self.ticks(view).into_iter().find(|(at, _)| *at == value);
        found.map_or_else(String::new, |(_, text)| text)
    }
}

/// Zooms by the wheel; over an axis only along that.
fn zoom_by_wheel(plot: &mut PlotUi<'_>, inner: Rect) {
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
        bar.fill(colour.gamma_multiply(0.45))
            .stroke(egui::Stroke::NONE)
    });
    let chart = BarChart::new("", bars.collect()).color(colour);
    plot.bar_chart(chart.allow_hover(false));
}

/// A curve in pieces where it is interrupted.
fn add_curve(plot: &mut PlotUi<'_>, curve: &Curve, colours: &Colours) {
    let style = match curve.dashed {
        true => LineStyle::dashed_dense(),
        false => LineStyle::Solid,
    };
    let is_gap = |[x, y]: &[f64; 2]| !(x.is_finite() && y.is_finite());
    let pieces = curve.points.split(is_gap);
    for piece in pieces.filter(|piece| piece.len() > 1) {
        let line = Line::new("", piece.to_vec()).style(style).width(CURVE);
        let line = line.color(curve.ink.colour(colours));
        plot.line(line.allow_hover(false));
    }
}

/// Where the selected pose stands, if poses or their times stand along x.
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

/// The reading nearest to a place along x.
fn snapped(figure: &Figure, x: f64) -> Option<f64> {
    let nearest = figure.series.iter().filter_map(|one| closest(one, x));
    let nearest = nearest.map(|point| point.x);
    nearest.min_by(|a, b| (a - x).abs().total_cmp(&(b - x).abs()))
}

/// The point of a series nearest to a place along x.
fn closest(series: &Series, x: f64) -> Option<&Point> {
    let points = series.points();
    let after = points.partition_point(|point| point.x < x);
    let around = points.get(after.saturating_sub(1)..(after + 1).min(points.len()))?;
    let away = |point: &&Point| (point.x - x).abs();
    around.iter().min_by(|a, b| away(a).total_cmp(&away(b)))
}

pub(super) fn scale_of(transform: &PlotTransform) -> Scale {
    let bounds = transform.bounds();
    let ([left, low], [right, high]) = (bounds.min(), bounds.max());
    Scale {
        view: [[left, right], [low, high]],
        rect: *transform.frame(),
    }
}

type Paint<'a> = Box<dyn Fn(&Ui, &PlotTransform, &mut Vec<Shape>) + 'a>;

/// An item painted by a function, for what `egui_plot` has no item for.
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

    fn initialize(&mut self, _: std::ops::RangeInclusive<f64>) {}

    fn color(&self) -> egui::Color32 {
        egui::Color32::TRANSPARENT
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

#[cfg(test)]
mod tests {
    use egui::{Event, Modifiers, PointerButton};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use tautline_workflow::plot::figure::Ink;

    use super::*;

    fn figure() -> Figure {
        let point = |pose: i64, offset: f64| Point {
            pose: Some(pose),
            ..Point::new(pose as f64, (pose % 3) as f64 + offset)
        };
        let series = |cable: usize, offset: f64| {
            let points = (1..=9).map(|pose| point(pose, offset)).collect();
            Series::of_cable(cable, format!("cable-{}", cable + 1), points)
        };
        Figure {
            x: Axis::whole("Pose"),
            y: Axis::new("Residual", "mm"),
            series: vec![series(0, 0.0), series(1, 5.0)],
            curves: vec![Curve {
                name: "fit".into(),
                ink: Ink::Text,
                dashed: true,
                points: vec![[1.0, 0.0], [9.0, 7.0]],
            }],
            ..Figure::default()
        }
    }

    struct Seen {
        view: PlotView,
        events: Vec<PlotEvent>,
        selection: Selection,
    }

    fn harness() -> Harness<'static, Seen> {
        let show = |ui: &mut Ui, seen: &mut Seen| {
            if ui.ctx().cumulative_pass_nr() == 0 {
                // Fonts are there from the next frame on.
                theme::install(ui.ctx());
                return;
            }
            let figure = figure();
            let input = PlotInput {
                name: "Plot",
                id: Id::unique("tested plot"),
                figure: &figure,
                generation: 1,
                whole: figure.whole(),
                selection: seen.selection,
                size: ui.available_size(),
                link: None,
                is_docked: true,
            };
            seen.events.extend(seen.view.show(ui, &input).events);
        };
        let seen = Seen {
            view: PlotView::default(),
            events: Vec::new(),
            selection: Selection::default(),
        };
        let mut harness = Harness::builder()
            .with_size(vec2(640.0, 240.0))
            .with_step_dt(1.0 / 60.0)
            .build_ui_state(show, seen);
        harness.run();
        harness
    }

    fn scale(harness: &Harness<'_, Seen>) -> Scale {
        harness.state().view.drawn.expect("drawn").scale
    }

    fn drag(harness: &mut Harness<'_, Seen>, button: PointerButton, from: Pos2, to: Pos2) {
        harness.hover_at(from);
        harness.run_ok();
        let press = |pos, pressed| Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers: Modifiers::NONE,
        };
        harness.event(press(from, true));
        harness.run_ok();
        for share in [0.04, 0.5, 1.0] {
            harness.hover_at(from.lerp(to, share));
            harness.run_ok();
        }
        harness.event(press(to, false));
        harness.run_ok();
    }

    fn click(harness: &mut Harness<'_, Seen>, at: Pos2) {
        harness.hover_at(at);
        harness.drag_at(at);
        harness.drop_at(at);
        harness.run_ok();
    }

    #[test]
    fn a_click_selects_the_point_and_escape_clears_the_selection() {
        let mut harness = harness();
        assert!(harness.get_by_label("Plot").rect().is_positive());
        let at = scale(&harness).place(4.0, 1.0);
        click(&mut harness, at);
        let expected = Selection {
            cable: Some(0),
            pose: Some(4),
        };
        assert_eq!(harness.state().events, [PlotEvent::Selected(expected)]);
        harness.state_mut().selection = expected;
        harness.hover_at(at);
        harness.run_ok();
        harness.key_press(Key::Escape);
        harness.run_ok();
        let cleared = PlotEvent::Selected(Selection::default());
        assert_eq!(harness.state().events.last(), Some(&cleared));
    }

    #[test]
    fn dragging_moves_a_box_zooms_and_a_double_click_resets() {
        let mut harness = harness();
        let whole = scale(&harness);
        let at = whole.place(4.0, 1.0);
        drag(
            &mut harness,
            PointerButton::Primary,
            at,
            at + vec2(60.0, 0.0),
        );
        let moved = scale(&harness);
        assert!(moved.view[0][0] < whole.view[0][0] - 0.5, "{moved:?}");
        assert!((moved.view[1][0] - whole.view[1][0]).abs() < 1e-6);
        harness.state_mut().view.reset();
        harness.run_ok();
        assert_eq!(scale(&harness).view, whole.view);
        let corners = [whole.place(3.0, 4.0), whole.place(6.0, 1.0)];
        drag(
            &mut harness,
            PointerButton::Secondary,
            corners[0],
            corners[1],
        );
        let [x, y] = scale(&harness).view;
        for (seen, drawn) in [(x, [3.0, 6.0]), (y, [1.0, 4.0])] {
            assert!((seen[0] - drawn[0]).abs() < 0.3 && (seen[1] - drawn[1]).abs() < 0.3);
        }
        let pos = whole.rect.center();
        harness.hover_at(pos);
        harness.run_ok();
        for pressed in [true, false, true, false] {
            harness.event(Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            });
        }
        harness.run_ok();
        assert_eq!(scale(&harness).view, whole.view);
    }

    #[test]
    fn dragging_an_axis_zooms_along_it() {
        let mut harness = harness();
        let whole = scale(&harness);
        let below = Pos2::new(whole.rect.center().x, whole.rect.max.y + 6.0);
        drag(
            &mut harness,
            PointerButton::Primary,
            below,
            below + vec2(30.0, 0.0),
        );
        let [x, y] = scale(&harness).view;
        assert!(
            x[1] - x[0] < 0.9 * (whole.view[0][1] - whole.view[0][0]),
            "{x:?}"
        );
        assert!((y[0] - whole.view[1][0]).abs() < 1e-9);
    }

    #[test]
    fn an_entry_of_the_legend_switches_its_series_off_and_on() {
        let mut harness = harness();
        let at = scale(&harness).place(4.0, 1.0);
        for shown in [false, true] {
            harness.get_by_label("Series cable-1").click();
            harness.run_ok();
            let view = &harness.state().view;
            let names = view.visible(&figure()).series.into_iter().map(|s| s.name);
            assert_eq!(
                names.collect::<Vec<_>>().contains(&"cable-1".to_owned()),
                shown
            );
            click(&mut harness, at);
            let event = harness.state().events.last().copied();
            let is_hit = |event| matches!(event, PlotEvent::Selected(found) if !found.is_empty());
            assert_eq!(event.is_some_and(is_hit), shown);
        }
        harness.get_by_label("Series fit").click();
        harness.run_ok();
        assert!(harness.state().view.visible(&figure()).curves.is_empty());
    }

    #[test]
    fn cursors_snap_to_readings_and_read_all_series() {
        let mut harness = harness();
        harness.state_mut().view.switch_cursors(&figure());
        harness.run_ok();
        let before = scale(&harness);
        let [a, b] = harness.state().view.cursors.expect("cursors");
        assert_eq!([a.fract(), b.fract()], [0.0; 2]);
        let at = Pos2::new(before.x(a), before.rect.center().y);
        let to = Pos2::new(before.x(5.2), at.y);
        drag(&mut harness, PointerButton::Primary, at, to);
        assert_eq!(harness.state().view.cursors, Some([5.0, b]));
        assert_eq!(scale(&harness).view, before.view, "the view stays");
        let text = harness.state().view.reading(&figure()).expect("a text");
        assert!(text.starts_with("A, B, B \u{2212} A: 5, "), "{text}");
        assert!(
            text.contains("cable-1: 2.00, ") && text.contains("cable-2: 7.00, "),
            "{text}"
        );
    }
}

//! Paints a figure: layout, grid, data, axes, legend.

use ecolor::Color32;
use emath::{Align2, Pos2, Rangef, Rect, Vec2, vec2};

use super::canvas::{Canvas, Stroke};
use super::colours::Colours;
use super::figure::{Axis, Columns, Figure, Ink, Marker, Point, Series, Span};
use super::heat::{SCALE_WIDTH, cells, colour_scale, limits};
use super::scale::{Scale, Tick, fixed, scale_ticks};
use super::thin::{Thinned, thin};
use super::{Drawing, Selection};

/// Font size of axes and legend (points).
pub const TEXT: f32 = 11.5;
/// Unit of all spacing (points).
pub const GRID: f32 = 4.0;
/// Largest number of markers with shapes of their own; more are drawn as small squares.
const MOST_SHAPES: usize = 3000;
/// Largest fraction of the height for title and legend; there is always room for two lines.
const LEGEND: f32 = 0.34;
/// Average width of a character, relative to the font size.
const CHARACTER: f32 = 0.55;

/// An entry of the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct LegendEntry {
    /// Rectangle of the entry.
    pub rect: Rect,
    /// Text as shown.
    pub text: String,
    /// Name of the series, curve or columns.
    pub name: String,
    sign: Sign,
    cable: Option<usize>,
}

/// The symbol of a legend entry.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sign {
    Marker(Marker, Ink),
    Ring(Ink),
    Line(Ink, bool),
    Area(Ink, bool),
    Band,
}

/// Layout of the parts of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Rectangle of the whole figure.
    pub whole: Rect,
    /// Displayed values, and the rectangle of the data.
    pub scale: Scale,
    /// The legend, above the data.
    pub legend: Vec<LegendEntry>,
    /// Left edge of the x axis title if it is beside the ticks, else infinite.
    x_title: f32,
    x_ticks: Vec<Tick>,
    y_ticks: Vec<Tick>,
}

impl Layout {
    /// Arranges the parts of a figure in a rectangle; `width` measures texts of the size [`TEXT`].
    #[must_use]
    pub fn new(
        figure: &Figure,
        view: [[f64; 2]; 2],
        whole: Rect,
        width: &dyn Fn(&str) -> f32,
    ) -> Self {
        let line = TEXT + GRID;
        let legend = legend(figure, whole, width);
        let lines = legend.iter().map(|entry| entry.rect.max.y - whole.min.y);
        let top = lines.fold(line, f32::max) + GRID;
        // A short title is placed beside the ticks, a long one below; axes with names need no title.
        let x_title = width(&figure.x.title());
        let is_long = x_title > 0.25 * whole.width();
        let bottom = if is_long { 2.0 * line } else { line } + GRID;
        let height = (whole.height() - top - bottom).max(16.0);
        let y_ticks = legible_ticks(&figure.y, view[1], height, false);
        let widest = y_ticks.iter().map(|(_, text)| width(text));
        let left = widest.fold(16.0, f32::max) + 2.0 * GRID;
        let right = right_margin(figure, width);
        let plot = Rect::from_min_max(
            whole.min + vec2(left, top),
            whole.min + vec2((whole.width() - right).max(left + 16.0), top + height),
        );
        let x_ticks = legible_ticks(&figure.x, view[0], plot.width(), true);
        Self {
            x_title: match is_long || !figure.x.names.is_empty() {
                true => f32::INFINITY,
                false => plot.max.x - x_title,
            },
            whole,
            scale: Scale { view, rect: plot },
            legend,
            x_ticks,
            y_ticks,
        }
    }
}

/// Width beside the data: the colour scale of a heat map.
pub fn right_margin(figure: &Figure, width: &dyn Fn(&str) -> f32) -> f32 {
    figure.heat.as_ref().map_or(2.0 * GRID, |heat| {
        let [low, high] = limits(heat.shades);
        let widest = [low, high].map(|v| width(&fixed(v, (high - low) / 100.0)));
        SCALE_WIDTH + widest[0].max(widest[1]) + 5.0 * GRID
    })
}

/// The legend entries that fit into the upper part of a rectangle, beside the title of the y axis or below it.
#[must_use]
pub fn legend(figure: &Figure, whole: Rect, width: &dyn Fn(&str) -> f32) -> Vec<LegendEntry> {
    let left = width(&figure.y.title()) + 4.0 * GRID;
    // In a low plot the data take precedence: legend entries without room are left out, bands and curves before cables.
    let room = (LEGEND * whole.height()).max(2.0 * (TEXT + GRID));
    let whole = whole.with_max_y(whole.min.y + room);
    // Many cables are identified by their numbers only, which leaves more room for the data.
    let is_short = figure.series.len() > 4;
    let series = figure.series.iter().filter(|one| !one.short.is_empty());
    let series = series.map(|one| {
        let text = if is_short { &one.short } else { &one.name };
        let sign = match one.hollow {
            true => Sign::Ring(one.ink),
            false => Sign::Marker(one.marker, one.ink),
        };
        (sign, text, &one.name, one.cable)
    });
    let columns = figure.columns.iter();
    let columns = columns.map(|one| (Sign::Area(one.ink, one.outline), &one.name, &one.name, None));
    let curves = figure.curves.iter();
    let curves = curves.map(|one| (Sign::Line(one.ink, one.dashed), &one.name, &one.name, None));
    let bands = figure.bands.iter();
    let bands = bands.map(|one| (Sign::Band, &one.name, &one.name, None));
    let signs = series.chain(columns).chain(curves).chain(bands);
    let signs: Vec<_> = signs.filter(|(_, text, ..)| !text.is_empty()).collect();
    let line = TEXT + GRID;
    let widest = signs
        .iter()
        .map(|(_, text, ..)| width(text) + 5.0 * GRID)
        .fold(0.0, f32::max);
    // Beside the title, or below it if there is no room.
    let (left, top) = if left + widest > whole.width() {
        (0.0, line)
    } else {
        (left, 0.0)
    };
    let (mut x, mut y) = (left, top);
    let mut entries = Vec::new();
    for (sign, text, name, cable) in signs {
        let size = vec2(width(text) + 5.0 * GRID, line);
        if x > left && x + size.x > whole.width() {
            (x, y) = (left, y + line);
        }
        if y + line > whole.height() {
            break;
        }
        entries.push(LegendEntry {
            rect: Rect::from_min_size(whole.min + vec2(x, y), size),
            text: text.to_owned(),
            name: name.to_owned(),
            sign,
            cable,
        });
        x += size.x + 2.0 * GRID;
    }
    entries
}

/// The points of a figure that are painted in a view.
#[derive(Debug, Clone)]
pub struct Points<'a> {
    figure: &'a Figure,
    scale: Scale,
    selection: Selection,
    colours: &'a Colours,
    thinned: Vec<Thinned>,
}

/// A drawing of `size` of the whole figure, with texts magnified by `scale`.
#[must_use]
pub fn drawing(
    label: impl Into<String>,
    figure: &Figure,
    size: [f64; 2],
    scale: f64,
    colours: &Colours,
) -> Drawing {
    let [width, height] = size.map(|side| (side / scale) as f32);
    let whole = Rect::from_min_size(Pos2::ZERO, vec2(width, height));
    let measure = |text: &str| CHARACTER * TEXT * text.chars().count() as f32;
    let layout = Layout::new(figure, figure.whole(), whole, &measure);
    Drawing::record(label, whole, scale, |canvas| {
        draw(canvas, figure, &layout, Selection::default(), colours, 1.0);
    })
}

/// Paints a figure; `pixels_per_point` is the resolution of the canvas.
pub fn draw(
    canvas: &mut dyn Canvas,
    figure: &Figure,
    layout: &Layout,
    selection: Selection,
    colours: &Colours,
    pixels_per_point: f32,
) {
    let scale = layout.scale;
    let plot = Plot {
        figure,
        layout,
        colours,
    };
    let points = Points::new(figure, scale, selection, colours, pixels_per_point);
    canvas.clip(Some(scale.rect));
    canvas.fill(scale.rect, colours.ground);
    match &figure.heat {
        Some(heat) => cells(canvas, heat, &scale, colours),
        None => plot.grid(canvas),
    }
    plot.spans(canvas);
    plot.ribbons(canvas);
    for columns in &figure.columns {
        plot.histogram(canvas, columns);
    }
    points.draw(canvas, &|_| true);
    plot.curves(canvas);
    points.draw_selected(canvas);
    canvas.clip(None);
    plot.axes(canvas);
    for entry in &layout.legend {
        entry.draw(canvas, colours, selection, true);
    }
    if let Some(heat) = &figure.heat {
        colour_scale(canvas, heat, scale.rect, colours);
    }
}

/// A figure ready for painting.
struct Plot<'a> {
    figure: &'a Figure,
    layout: &'a Layout,
    colours: &'a Colours,
}

impl Plot<'_> {
    /// Marks ranges of x; a short range is at least a line.
    fn spans(&self, canvas: &mut dyn Canvas) {
        let scale = &self.layout.scale;
        for Span { x: [from, to], ink } in &self.figure.spans {
            let colour = ink.colour(self.colours).gamma_multiply(0.22);
            let [low, high] = scale.view[1];
            let (first, last) = (scale.place(*from, low), scale.place(*to, high));
            let x = Rangef::new(first.x, last.x.max(first.x + 1.0));
            canvas.fill(Rect::from_x_y_ranges(x, scale.rect.y_range()), colour);
        }
    }

    /// Fills the bands of curves, a quadrangle between neighbouring places.
    fn ribbons(&self, canvas: &mut dyn Canvas) {
        let scale = &self.layout.scale;
        for ribbon in &self.figure.ribbons {
            let colour = ribbon.ink.colour(self.colours).gamma_multiply(0.18);
            for pair in ribbon.pieces().flat_map(|piece| piece.windows(2)) {
                let ([x, low, high], [next, next_low, next_high]) = (pair[0], pair[1]);
                let corners = [
                    scale.place(x, low),
                    scale.place(x, high),
                    scale.place(next, next_high),
                    scale.place(next, next_low),
                ];
                canvas.polygon(corners.into(), colour);
            }
        }
    }

    fn grid(&self, canvas: &mut dyn Canvas) {
        let (scale, colours) = (&self.layout.scale, self.colours);
        for band in &self.figure.bands {
            let [low, high] = band.y.map(|y| scale.y(y));
            let rect = Rect::from_x_y_ranges(scale.rect.x_range(), Rangef::new(high, low));
            canvas.fill(rect, colours.good.gamma_multiply(0.13));
            for y in [low, high] {
                let edge = Stroke::new(1.0, colours.good.gamma_multiply(0.55));
                canvas.line(&scale.across(y), edge, true);
            }
        }
        let thin = Stroke::new(1.0, colours.line.gamma_multiply(0.7));
        for (value, _) in &self.layout.x_ticks {
            let x = scale.x(*value).round() + 0.5;
            canvas.line(&scale.upright(x), thin, false);
        }
        for (value, _) in &self.layout.y_ticks {
            let y = scale.y(*value).round() + 0.5;
            canvas.line(&scale.across(y), thin, false);
        }
        if self.figure.has_zero_line {
            let y = scale.y(0.0).round() + 0.5;
            canvas.line(&scale.across(y), Stroke::new(1.0, colours.muted), false);
        }
    }

    fn histogram(&self, canvas: &mut dyn Canvas, columns: &Columns) {
        let (scale, colour) = (&self.layout.scale, columns.ink.colour(self.colours));
        let mut outline = Vec::new();
        for (edge, height) in columns.edges.windows(2).zip(&columns.heights) {
            let (base, top) = (scale.place(edge[0], 0.0), scale.place(edge[1], *height));
            if columns.outline {
                outline.extend([Pos2::new(base.x, top.y), top]);
            } else {
                let rect = Rect::from_two_pos(base, top).shrink2(vec2(0.5, 0.0));
                canvas.fill(rect, colour.gamma_multiply(0.45));
            }
        }
        if columns.outline {
            // The joint of a line at two equal points is drawn as a wedge.
            outline.dedup();
            canvas.line(&outline, Stroke::new(1.75, colour), false);
        }
    }

    fn curves(&self, canvas: &mut dyn Canvas) {
        for curve in &self.figure.curves {
            let stroke = Stroke::new(1.75, curve.ink.colour(self.colours));
            for piece in curve.pieces() {
                let places = piece.iter().map(|[x, y]| self.layout.scale.place(*x, *y));
                canvas.line(&places.collect::<Vec<_>>(), stroke, curve.dashed);
            }
        }
    }

    fn axes(&self, canvas: &mut dyn Canvas) {
        let (layout, colours) = (self.layout, self.colours);
        let plot = layout.scale.rect;
        let edges = [plot.left_top(), plot.left_bottom(), plot.right_bottom()];
        canvas.line(&edges, Stroke::new(1.0, colours.line), false);
        for (value, text) in &layout.x_ticks {
            let at = Pos2::new(layout.scale.x(*value), plot.max.y + GRID);
            if at.x + half_width(text) + 2.0 * GRID <= layout.x_title {
                canvas.text(at, Align2::CENTER_TOP, text, TEXT, colours.muted);
            }
        }
        for (value, text) in &layout.y_ticks {
            let at = Pos2::new(plot.min.x - GRID, layout.scale.y(*value));
            canvas.text(at, Align2::RIGHT_CENTER, text, TEXT, colours.muted);
        }
        if self.figure.x.names.is_empty() {
            let is_beside = layout.x_title.is_finite();
            let down = if is_beside { GRID } else { TEXT + 2.0 * GRID };
            let (at, title) = (plot.right_bottom() + vec2(0.0, down), self.figure.x.title());
            canvas.text(at, Align2::RIGHT_TOP, &title, TEXT, colours.text);
        }
        let (at, title) = (layout.whole.min, self.figure.y.title());
        canvas.text(at, Align2::LEFT_TOP, &title, TEXT, colours.text);
    }
}

impl<'a> Points<'a> {
    /// Chooses the points to paint at a resolution.
    #[must_use]
    pub fn new(
        figure: &'a Figure,
        scale: Scale,
        selection: Selection,
        colours: &'a Colours,
        pixels_per_point: f32,
    ) -> Self {
        let series = figure.series.iter();
        let thinned = series.map(|series| thin(series, &scale, pixels_per_point));
        Self {
            figure,
            scale,
            selection,
            colours,
            thinned: thinned.collect(),
        }
    }

    /// Whether there are so many points that they are painted as small squares.
    #[must_use]
    pub fn are_dense(&self) -> bool {
        let counts = self.thinned.iter().map(|thinned| thinned.points.len());
        counts.sum::<usize>() > MOST_SHAPES
    }

    /// Paints the series that are shown, the selected cable over the others.
    pub fn draw(&self, canvas: &mut dyn Canvas, is_shown: &dyn Fn(&Series) -> bool) {
        if self.are_dense() {
            return self.draw_dense(&mut |rect, colour| canvas.fill(rect, colour), is_shown);
        }
        for (series, thinned, strength) in self.order(is_shown) {
            self.series(canvas, (series, thinned), strength);
        }
    }

    /// Paints the series that are shown as small squares and columns, which `fill` receives with their colours.
    pub fn draw_dense(
        &self,
        fill: &mut dyn FnMut(Rect, Color32),
        is_shown: &dyn Fn(&Series) -> bool,
    ) {
        for (series, thinned, strength) in self.order(is_shown) {
            crowded(
                thinned,
                series.ink.colour(self.colours).gamma_multiply(strength),
                fill,
            );
            for (at, colour, _) in self.places((series, thinned), strength) {
                fill(Rect::from_center_size(at, Vec2::splat(2.0)), colour);
            }
        }
    }

    /// The series that are shown in the order of painting, each with the strength of its colour.
    fn order<'s>(
        &'s self,
        is_shown: &'s dyn Fn(&Series) -> bool,
    ) -> impl Iterator<Item = (&'s Series, &'s Thinned, f32)> {
        let selected = self.selection.cable;
        [false, true].into_iter().flat_map(move |is_top| {
            let all = self.figure.series.iter().zip(&self.thinned);
            all.filter_map(move |(series, thinned)| {
                let is_selected = series.cable.is_some() && series.cable == selected;
                let is_dimmed = selected.is_some() && series.cable.is_some() && !is_top;
                let strength = if is_dimmed { 0.3 } else { 1.0 };
                (is_selected == is_top && is_shown(series)).then_some((series, thinned, strength))
            })
        })
    }

    /// Place and colour of each point of a series.
    fn places<'s>(
        &'s self,
        (series, thinned): (&'s Series, &'s Thinned),
        strength: f32,
    ) -> impl Iterator<Item = (Pos2, Color32, Point)> {
        let used = series.ink.colour(self.colours).gamma_multiply(strength);
        let excluded = self.colours.muted.gamma_multiply(0.6 * strength);
        thinned.points.iter().map(move |index| {
            let point = series.points()[*index];
            let colour = if point.excluded { excluded } else { used };
            (self.scale.place(point.x, point.y), colour, point)
        })
    }

    /// Paints a series with markers and bars.
    fn series(
        &self,
        canvas: &mut dyn Canvas,
        (series, thinned): (&Series, &Thinned),
        strength: f32,
    ) {
        let colour = series.ink.colour(self.colours).gamma_multiply(strength);
        crowded(thinned, colour, &mut |rect, colour| {
            canvas.fill(rect, colour);
        });
        for (at, colour, point) in self.places((series, thinned), strength) {
            let stroke = Stroke::new(1.0, colour.gamma_multiply(0.7));
            let [dx, dy] = point.sd;
            for (dx, dy) in [(dx, 0.0), (0.0, dy)] {
                if dx != 0.0 || dy != 0.0 {
                    let end = |s: f64| self.scale.place(point.x + s * dx, point.y + s * dy);
                    canvas.line(&[end(-1.0), end(1.0)], stroke, false);
                }
            }
            if series.hollow {
                canvas.ring(at, 3.25, Stroke::new(1.25, colour));
            } else {
                canvas.marker(at, series.marker, 3.25, colour);
            }
        }
    }

    /// Rings around the points of the selected pose.
    pub fn draw_selected(&self, canvas: &mut dyn Canvas) {
        let Selection { cable, pose } = self.selection;
        for series in &self.figure.series {
            let colour = match cable.is_none() || cable == series.cable {
                true => self.colours.accent,
                false => self.colours.muted,
            };
            let points = series.points().iter();
            for point in points.filter(|point| pose.is_some() && point.pose == pose) {
                let at = self.scale.place(point.x, point.y);
                canvas.ring(at, 6.5, Stroke::new(1.75, colour));
            }
        }
    }
}

impl LegendEntry {
    /// Paints the entry: symbol and text; pale if its series is hidden.
    pub fn draw(
        &self,
        canvas: &mut dyn Canvas,
        colours: &Colours,
        selection: Selection,
        is_shown: bool,
    ) {
        let strength = if is_shown { 1.0 } else { 0.35 };
        let paint = |ink: Ink| ink.colour(colours).gamma_multiply(strength);
        let at = self.rect.left_center() + vec2(2.0 * GRID, 0.0);
        let half = vec2(1.5 * GRID, 0.0);
        let area = Rect::from_center_size(at, vec2(3.0 * GRID, 2.0 * GRID));
        let line = |ink: Ink| Stroke::new(1.75, paint(ink));
        match self.sign {
            Sign::Marker(marker, ink) => canvas.marker(at, marker, 3.75, paint(ink)),
            Sign::Ring(ink) => canvas.ring(at, 3.75, Stroke::new(1.25, paint(ink))),
            Sign::Line(ink, dashed) => canvas.line(&[at - half, at + half], line(ink), dashed),
            Sign::Area(ink, false) => canvas.fill(area, paint(ink).gamma_multiply(0.45)),
            Sign::Area(ink, true) => {
                let [left, right] = [area.left_top(), area.right_top()];
                let corners = [area.left_bottom(), left, right, area.right_bottom()];
                canvas.line(&corners, line(ink), false);
            }
            Sign::Band => canvas.fill(area, paint(Ink::Good).gamma_multiply(0.3)),
        }
        let is_selected = self.cable.is_some() && self.cable == selection.cable;
        let colour = if is_selected {
            colours.accent
        } else {
            colours.text
        };
        let at = self.rect.left_center() + vec2(5.0 * GRID, 0.0);
        canvas.text(
            at,
            Align2::LEFT_CENTER,
            &self.text,
            TEXT,
            colour.gamma_multiply(strength),
        );
    }
}

/// Half the width of a tick's text.
fn half_width(text: &str) -> f32 {
    0.3 * TEXT * text.chars().count() as f32
}

/// The ticks of an axis of a length whose texts do not overlap. Where names are too close, numbers of cables, which are
/// short, take precedence over long names.
#[must_use]
pub fn legible_ticks(axis: &Axis, view: [f64; 2], length: f32, is_x: bool) -> Vec<Tick> {
    // Even a low plot has a scale.
    let most = match is_x {
        true => length / 64.0,
        false => (length / 28.0).max(4.0),
    };
    let ticks = scale_ticks(axis, view, most as usize);
    let mut order: Vec<usize> = (0..ticks.len()).collect();
    order.sort_by_key(|k| ticks[*k].1.parse::<f64>().is_err());
    let mut taken: Vec<Option<Rangef>> = vec![None; ticks.len()];
    for k in order {
        let (value, text) = &ticks[k];
        let at = ((value - view[0]) / (view[1] - view[0])) as f32 * length;
        let half = match is_x {
            true => half_width(text) + 0.5 * GRID,
            false => 0.5 * TEXT,
        };
        let span = Rangef::new(at - half, at + half);
        let is_free = |other: &Rangef| span.max <= other.min || span.min >= other.max;
        if taken.iter().flatten().all(is_free) {
            taken[k] = Some(span);
        }
    }
    let ticks = ticks.into_iter().zip(taken);
    ticks
        .filter_map(|(tick, taken)| taken.map(|_| tick))
        .collect()
}

/// Fills the pixel columns that contain more points than are painted.
fn crowded(thinned: &Thinned, colour: Color32, fill: &mut dyn FnMut(Rect, Color32)) {
    for (x, range) in &thinned.columns {
        let rect = Rect::from_x_y_ranges(Rangef::new(x - 0.5, x + 0.5), *range);
        fill(rect, colour.gamma_multiply(0.35));
    }
}

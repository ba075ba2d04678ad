//! Paints a figure: layout, grid, data, axes, legend.

use ecolor::Color32;
use emath::{Align2, Pos2, Rangef, Rect, Vec2, vec2};

use super::canvas::{Canvas, Stroke};
use super::colours::Colours;
use super::figure::{Columns, Figure, Ink, Marker, Series};
use super::heat::{SCALE_WIDTH, cells, colour_scale, limits};
use super::scale::{Scale, Tick, fixed, scale_ticks, ticks};
use super::thin::{Thinned, thin};
use super::{Drawing, Selection};

/// Font size of axes and legend (points).
pub const TEXT: f32 = 11.5;
/// Unit of all spacing (points).
pub const GRID: f32 = 4.0;
/// Largest number of markers with shapes of their own; more are drawn as small squares.
const MOST_SHAPES: usize = 3000;
/// Number of ticks of the y axis for which the lowest plot has room.
const FEWEST_TICKS: usize = 4;
/// Largest fraction of the height for title and legend; there is always room for two lines.
const LEGEND: f32 = 0.34;
/// Average width of a character, relative to the font size.
const CHARACTER: f32 = 0.55;

/// An entry of the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its rectangle.
    pub rect: Rect,
    /// Its text.
    pub text: String,
    /// Name of what it stands for.
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
    pub legend: Vec<Entry>,
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
        // Even a low plot has a scale.
        let most = ((height / 28.0) as usize).max(FEWEST_TICKS);
        let y_ticks = scale_ticks(&figure.y, view[1], most);
        let widest = y_ticks.iter().map(|(_, text)| width(text));
        let left = widest.fold(16.0, f32::max) + 2.0 * GRID;
        let right = right_margin(figure, width);
        let plot = Rect::from_min_max(
            whole.min + vec2(left, top),
            whole.min + vec2((whole.width() - right).max(left + 16.0), top + height),
        );
        let longest = width(&fixed(view[0][1], (view[0][1] - view[0][0]) / 10.0)) + 6.0 * GRID;
        let most = (plot.width() / longest.max(40.0)) as usize;
        // Powers of ten alone could leave a short logarithmic axis without ticks.
        let x_ticks = match figure.x.is_logarithmic {
            true => scale_ticks(&figure.x, view[0], most),
            false => ticks(&figure.x, view[0], most),
        };
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
pub fn legend(figure: &Figure, whole: Rect, width: &dyn Fn(&str) -> f32) -> Vec<Entry> {
    let left = width(&figure.y.title()) + 4.0 * GRID;
    // In a low plot the data take precedence: what has no room is left out, bands and curves before cables.
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
        entries.push(Entry {
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

/// The points of a figure that are painted in a view; computed once per view, not per frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VisiblePoints {
    /// Points of each series.
    pub thinned: Vec<Thinned>,
    /// Points of the selected pose: series and index.
    pub selected: Vec<(usize, usize)>,
}

impl VisiblePoints {
    /// Computes the points to paint at a resolution.
    #[must_use]
    pub fn new(
        figure: &Figure,
        scale: &Scale,
        selection: Selection,
        pixels_per_point: f32,
    ) -> Self {
        let series = figure.series.iter();
        let thinned = series.map(|series| thin(series, scale, pixels_per_point));
        let selected = figure.series.iter().enumerate().flat_map(|(s, series)| {
            let points = series.points().iter().enumerate();
            points
                .filter(|(_, point)| point.pose.is_some() && point.pose == selection.pose)
                .map(move |(index, _)| (s, index))
        });
        Self {
            thinned: thinned.collect(),
            selected: selected.collect(),
        }
    }

    /// Whether there are so many points that they are drawn as small squares.
    #[must_use]
    pub fn is_dense(&self) -> bool {
        let counts = self.thinned.iter().map(|thinned| thinned.points.len());
        counts.sum::<usize>() > MOST_SHAPES
    }
}

/// The points of a figure, ready for painting.
#[derive(Debug, Clone, Copy)]
pub struct Points<'a> {
    /// The figure.
    pub figure: &'a Figure,
    /// Displayed values and their rectangle.
    pub scale: &'a Scale,
    /// The points to paint.
    pub visible: &'a VisiblePoints,
    /// The highlighted cable and pose.
    pub selection: Selection,
    /// Colours.
    pub colours: &'a Colours,
}

/// A figure ready for painting.
#[derive(Debug, Clone, Copy)]
struct Plot<'a> {
    layout: &'a Layout,
    points: Points<'a>,
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
    let scale = &layout.scale;
    let visible = VisiblePoints::new(figure, scale, selection, pixels_per_point);
    let points = Points {
        figure,
        scale,
        visible: &visible,
        selection,
        colours,
    };
    Plot { layout, points }.draw(canvas);
}

impl<'a> std::ops::Deref for Plot<'a> {
    type Target = Points<'a>;

    fn deref(&self) -> &Self::Target {
        &self.points
    }
}

impl Plot<'_> {
    fn draw(&self, canvas: &mut dyn Canvas) {
        let scale = &self.layout.scale;
        canvas.clip(Some(scale.rect));
        canvas.fill(scale.rect, self.colours.ground);
        match &self.figure.heat {
            Some(heat) => cells(canvas, heat, scale, self.colours),
            None => self.grid(canvas),
        }
        self.spans(canvas);
        for columns in &self.figure.columns {
            self.histogram(canvas, columns);
        }
        self.points.draw(canvas, &|_| true);
        self.curves(canvas);
        self.points.draw_selected(canvas);
        canvas.clip(None);
        self.axes(canvas);
        for entry in &self.layout.legend {
            entry.draw(canvas, self.colours, self.selection, true);
        }
        if let Some(heat) = &self.figure.heat {
            colour_scale(canvas, heat, scale.rect, self.colours);
        }
    }

    /// Marks ranges of x; a short range is at least a line.
    fn spans(&self, canvas: &mut dyn Canvas) {
        let scale = &self.layout.scale;
        let colour = self.colours.good.gamma_multiply(0.22);
        for [from, to] in &self.figure.spans {
            let [low, high] = scale.view[1];
            let (first, last) = (scale.place(*from, low), scale.place(*to, high));
            let x = Rangef::new(first.x, last.x.max(first.x + 1.0));
            canvas.fill(Rect::from_x_y_ranges(x, scale.rect.y_range()), colour);
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
            canvas.line(&outline, Stroke::new(1.75, colour), false);
        }
    }

    fn curves(&self, canvas: &mut dyn Canvas) {
        for curve in &self.figure.curves {
            let stroke = Stroke::new(1.75, curve.ink.colour(self.colours));
            let pieces = curve
                .points
                .split(|[x, y]| !(x.is_finite() && y.is_finite()));
            for piece in pieces.filter(|piece| piece.len() > 1) {
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
        let spans = layout.x_ticks.iter().map(|(value, text)| {
            let x = layout.scale.x(*value);
            let half = 0.3 * TEXT * text.chars().count() as f32;
            Rangef::new(x - half, x + half + GRID)
        });
        let fits = apart(spans.collect(), &layout.x_ticks);
        for ((value, text), span) in layout.x_ticks.iter().zip(fits) {
            if span.is_none_or(|span| span.max + GRID > layout.x_title) {
                continue;
            }
            let at = Pos2::new(layout.scale.x(*value), plot.max.y + GRID);
            canvas.text(at, Align2::CENTER_TOP, text, TEXT, colours.muted);
        }
        let spans = layout.y_ticks.iter().map(|(value, _)| {
            let y = layout.scale.y(*value);
            Rangef::new(y - 0.5 * TEXT, y + 0.5 * TEXT)
        });
        let fits = apart(spans.collect(), &layout.y_ticks);
        for ((value, text), _) in layout.y_ticks.iter().zip(fits).filter(|(_, s)| s.is_some()) {
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

impl Points<'_> {
    /// Paints the series that are shown.
    pub fn draw(&self, canvas: &mut dyn Canvas, is_shown: &dyn Fn(&Series) -> bool) {
        let is_dense = self.visible.is_dense();
        for (index, is_dimmed) in self.order() {
            if !is_shown(&self.figure.series[index]) {
                continue;
            }
            if is_dense {
                self.dots(canvas, index, is_dimmed);
            } else {
                self.markers(canvas, index, is_dimmed);
            }
        }
    }

    /// Rings around the points of the selected pose.
    pub fn draw_selected(&self, canvas: &mut dyn Canvas) {
        for (s, index) in &self.visible.selected {
            let series = &self.figure.series[*s];
            let point = series.points()[*index];
            let cable = self.selection.cable;
            let colour = match cable.is_none() || cable == series.cable {
                true => self.colours.accent,
                false => self.colours.muted,
            };
            let at = self.scale.place(point.x, point.y);
            canvas.ring(at, 6.5, Stroke::new(1.75, colour));
        }
    }

    /// The series in painting order, with the selected cable last and thus on top; and
    /// whether each is dimmed.
    fn order(&self) -> impl Iterator<Item = (usize, bool)> {
        let selected = self.selection.cable;
        let is_selected = move |series: &Series| series.cable.is_some() && series.cable == selected;
        [false, true].into_iter().flat_map(move |is_top| {
            let series = self.figure.series.iter().enumerate();
            let series = series.filter(move |(_, series)| is_selected(series) == is_top);
            series.map(move |(index, series)| {
                let is_dimmed = selected.is_some() && series.cable.is_some() && !is_top;
                (index, is_dimmed)
            })
        })
    }

    /// Colours of a series and of its unused points.
    fn colours(&self, series: &Series, is_dimmed: bool) -> [Color32; 2] {
        let strength = if is_dimmed { 0.3 } else { 1.0 };
        let colour = series.ink.colour(self.colours).gamma_multiply(strength);
        [colour, self.colours.muted.gamma_multiply(0.6 * strength)]
    }

    /// Paints the points as small squares, for very many points.
    fn dots(&self, canvas: &mut dyn Canvas, index: usize, is_dimmed: bool) {
        let (series, thinned) = (&self.figure.series[index], &self.visible.thinned[index]);
        let [colour, excluded] = self.colours(series, is_dimmed);
        crowded(thinned, colour, canvas);
        for index in &thinned.points {
            let point = series.points()[*index];
            let colour = if point.excluded { excluded } else { colour };
            let at = self.scale.place(point.x, point.y);
            canvas.fill(Rect::from_center_size(at, Vec2::splat(2.0)), colour);
        }
    }

    fn markers(&self, canvas: &mut dyn Canvas, index: usize, is_dimmed: bool) {
        let (series, thinned) = (&self.figure.series[index], &self.visible.thinned[index]);
        let scale = self.scale;
        let [colour, excluded] = self.colours(series, is_dimmed);
        crowded(thinned, colour, canvas);
        for index in &thinned.points {
            let point = series.points()[*index];
            let colour = if point.excluded { excluded } else { colour };
            if point.sd != [0.0, 0.0] {
                let stroke = Stroke::new(1.0, colour.gamma_multiply(0.7));
                let [dx, dy] = point.sd;
                for (dx, dy) in [(dx, 0.0), (0.0, dy)] {
                    let ends = [-1.0, 1.0].map(|s| scale.place(point.x + s * dx, point.y + s * dy));
                    canvas.line(&ends, stroke, false);
                }
            }
            let at = scale.place(point.x, point.y);
            if series.hollow {
                canvas.ring(at, 3.25, Stroke::new(1.25, colour));
            } else {
                canvas.marker(at, series.marker, 3.25, colour);
            }
        }
    }
}

impl Entry {
    /// Paints the entry: symbol and text; pale if what it stands for is hidden.
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

/// Selects the labels to draw so that none overlaps another. Where names are too close, numbers of cables,
/// which are short, take precedence over long names.
pub fn apart(spans: Vec<Rangef>, ticks: &[Tick]) -> Vec<Option<Rangef>> {
    let mut order: Vec<usize> = (0..spans.len()).collect();
    let is_number = |k: &usize| ticks[*k].1.parse::<f64>().is_ok();
    order.sort_by_key(|k| !is_number(k));
    let mut kept: Vec<Option<Rangef>> = vec![None; spans.len()];
    for k in order {
        let span = spans[k];
        let is_free = |other: &Rangef| span.max <= other.min || span.min >= other.max;
        if kept.iter().flatten().all(is_free) {
            kept[k] = Some(span);
        }
    }
    kept
}

/// Fills the pixel columns that contain more points than are painted.
fn crowded(thinned: &Thinned, colour: Color32, canvas: &mut dyn Canvas) {
    for (x, range) in &thinned.columns {
        let rect = Rect::from_x_y_ranges(Rangef::new(x - 0.5, x + 0.5), *range);
        canvas.fill(rect, colour.gamma_multiply(0.35));
    }
}

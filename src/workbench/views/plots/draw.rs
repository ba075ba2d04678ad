//! Draws a figure: layout, grid, data, axes, legend.

use egui::{Align2, Color32, FontId, Pos2, Rangef, Rect, Stroke, Vec2, vec2};

use super::canvas::Canvas;
use super::heat::{SCALE_WIDTH, cells, colour_scale, limits};
use super::scale::{Scale, Tick, fixed, ticks};
use super::thin::{Thinned, thin};
use crate::model::Selection;
use crate::model::figure::{Columns, Figure, Ink, Marker, Series};
use crate::theme::{GRID, Palette};

/// Size of the texts at axes and in the legend.
pub const TEXT: f32 = 11.5;
/// Markers up to which every point has its own shape; beyond they are small squares.
const MOST_SHAPES: usize = 3000;

/// An entry of the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Where it is.
    pub rect: Rect,
    /// Its text.
    pub text: String,
    /// Its sign.
    sign: Sign,
    /// The cable it stands for.
    pub cable: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Sign {
    Marker(Marker, Ink),
    Ring(Ink),
    Line(Ink, bool),
    Area(Ink, bool),
    Band,
}

/// Where the parts of a figure are.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Everything.
    pub whole: Rect,
    /// The data.
    pub plot: Rect,
    /// The legend, above the data.
    pub legend: Vec<Entry>,
    /// Where the title along x begins if it stands beside the ticks, else infinite.
    x_title: f32,
    x_ticks: Vec<Tick>,
    y_ticks: Vec<Tick>,
}

/// Arranges the parts of a figure in a rectangle; `width` measures texts of the size [`TEXT`].
#[must_use]
pub fn arrange(
    figure: &Figure,
    view: [[f64; 2]; 2],
    whole: Rect,
    width: &dyn Fn(&str) -> f32,
) -> Layout {
    let line = TEXT + GRID;
    let title = width(&figure.y.title()) + 4.0 * GRID;
    let legend = legend(figure, whole, title, width);
    let lines = legend.iter().map(|entry| entry.rect.max.y - whole.min.y);
    let top = lines.fold(line, f32::max) + GRID;
    // A short title stands beside the ticks, a long one below; names say what they are themselves.
    let x_title = width(&figure.x.title());
    let is_long = x_title > 0.2 * whole.width();
    let bottom = if is_long { 2.0 * line } else { line } + GRID;
    let height = (whole.height() - top - bottom).max(16.0);
    let y_ticks = ticks(&figure.y, view[1], (height / 28.0) as usize);
    let widest = y_ticks
        .iter()
        .map(|(_, text)| width(text))
        .fold(16.0, f32::max);
    let left = widest + 2.0 * GRID;
    let right = figure.heat.as_ref().map_or(2.0 * GRID, |heat| {
        let [low, high] = limits(heat.shades);
        let widest = [low, high].map(|v| width(&fixed(v, (high - low) / 100.0)));
        SCALE_WIDTH + widest[0].max(widest[1]) + 5.0 * GRID
    });
    let plot = Rect::from_min_max(
        whole.min + vec2(left, top),
        whole.min + vec2((whole.width() - right).max(left + 16.0), top + height),
    );
    let longest = width(&fixed(view[0][1], (view[0][1] - view[0][0]) / 10.0)) + 6.0 * GRID;
    let x_ticks = ticks(
        &figure.x,
        view[0],
        (plot.width() / longest.max(40.0)) as usize,
    );
    Layout {
        x_title: match is_long || !figure.x.names.is_empty() {
            true => f32::INFINITY,
            false => plot.max.x - x_title,
        },
        whole,
        plot,
        legend,
        x_ticks,
        y_ticks,
    }
}

fn legend(figure: &Figure, whole: Rect, left: f32, width: &dyn Fn(&str) -> f32) -> Vec<Entry> {
    let mut signs: Vec<(Sign, &str, Option<usize>)> = Vec::new();
    // Many cables are named by their numbers alone, so that the data keep the space.
    let is_short = figure.series.len() > 4;
    let named = figure
        .series
        .iter()
        .filter(|series| !series.short.is_empty());
    for series in named {
        let text = if is_short {
            &series.short
        } else {
            &series.name
        };
        let sign = if series.hollow {
            Sign::Ring(series.ink)
        } else {
            Sign::Marker(series.marker, series.ink)
        };
        signs.push((sign, text, series.cable));
    }
    for columns in &figure.columns {
        signs.push((
            Sign::Area(columns.ink, columns.outline),
            &columns.name,
            None,
        ));
    }
    for curve in figure.curves.iter().filter(|curve| !curve.name.is_empty()) {
        signs.push((Sign::Line(curve.ink, curve.dashed), &curve.name, None));
    }
    for band in figure.bands.iter().filter(|band| !band.name.is_empty()) {
        signs.push((Sign::Band, &band.name, None));
    }
    let line = TEXT + GRID;
    let widest = signs
        .iter()
        .map(|(_, text, _)| width(text) + 5.0 * GRID)
        .fold(0.0, f32::max);
    // Beside the title, or below it where there is no room.
    let (left, top) = if left + widest > whole.width() {
        (0.0, line)
    } else {
        (left, 0.0)
    };
    let (mut x, mut y) = (left, top);
    let mut entries = Vec::new();
    for (sign, text, cable) in signs {
        let size = vec2(width(text) + 5.0 * GRID, line);
        if x > left && x + size.x > whole.width() {
            (x, y) = (left, y + line);
        }
        entries.push(Entry {
            rect: Rect::from_min_size(whole.min + vec2(x, y), size),
            text: text.to_owned(),
            sign,
            cable,
        });
        x += size.x + 2.0 * GRID;
    }
    entries
}

/// What is drawn of a figure in a view; found once per view, not per frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Seen {
    /// Points of each series.
    pub thinned: Vec<Thinned>,
    /// Points of the selected pose: series and index.
    pub selected: Vec<(usize, usize)>,
}

/// Finds what is drawn.
#[must_use]
pub fn see(figure: &Figure, scale: &Scale, selection: Selection, pixels_per_point: f32) -> Seen {
    let thinned = figure
        .series
        .iter()
        .map(|series| thin(series, scale, pixels_per_point));
    let selected = figure.series.iter().enumerate().flat_map(|(s, series)| {
        let points = series.points().iter().enumerate();
        points
            .filter(|(_, point)| point.pose.is_some() && point.pose == selection.pose)
            .map(move |(index, _)| (s, index))
    });
    Seen {
        thinned: thinned.collect(),
        selected: selected.collect(),
    }
}

/// Whether there are so many points that they have no shapes of their own.
#[must_use]
pub fn is_dense(seen: &Seen) -> bool {
    let counts = seen.thinned.iter().map(|thinned| thinned.points.len());
    counts.sum::<usize>() > MOST_SHAPES
}

/// The series in the order in which they are drawn, the selected cable last, over the others; and whether each is dimmed.
pub fn order(figure: &Figure, selection: Selection) -> impl Iterator<Item = (usize, bool)> + '_ {
    let is_selected =
        move |series: &Series| series.cable.is_some() && series.cable == selection.cable;
    [false, true].into_iter().flat_map(move |is_top| {
        let series = figure.series.iter().enumerate();
        let series = series.filter(move |(_, series)| is_selected(series) == is_top);
        series.map(move |(index, series)| {
            let dimmed = selection.cable.is_some() && series.cable.is_some() && !is_top;
            (index, dimmed)
        })
    })
}

/// Draws a figure.
pub fn draw(
    canvas: &mut dyn Canvas,
    figure: &Figure,
    layout: &Layout,
    scale: &Scale,
    seen: &Seen,
    (selection, palette): (Selection, &Palette),
) {
    behind(canvas, figure, layout, scale, palette);
    let dense = is_dense(seen);
    for (index, dimmed) in order(figure, selection) {
        let series = (&figure.series[index], &seen.thinned[index]);
        if dense {
            dots(series, scale, palette, dimmed, &mut |rect, colour| {
                canvas.fill(rect, colour);
            });
        } else {
            points(canvas, series, scale, palette, dimmed);
        }
    }
    before(canvas, figure, layout, scale, seen, (selection, palette));
}

/// Draws what is behind the points; what follows is limited to the area of the data.
pub fn behind(
    canvas: &mut dyn Canvas,
    figure: &Figure,
    layout: &Layout,
    scale: &Scale,
    palette: &Palette,
) {
    canvas.clip(Some(layout.plot));
    canvas.fill(layout.plot, palette.ground);
    if let Some(heat) = &figure.heat {
        cells(canvas, heat, scale, palette);
    } else {
        grid(canvas, figure, layout, scale, palette);
    }
    for columns in &figure.columns {
        histogram(canvas, columns, scale, palette);
    }
}

/// Draws what is over the points and around them.
pub fn before(
    canvas: &mut dyn Canvas,
    figure: &Figure,
    layout: &Layout,
    scale: &Scale,
    seen: &Seen,
    (selection, palette): (Selection, &Palette),
) {
    curves(canvas, figure, scale, palette);
    for (s, index) in &seen.selected {
        let point = figure.series[*s].points()[*index];
        let strong = selection.cable.is_none() || selection.cable == figure.series[*s].cable;
        let colour = if strong {
            palette.accent
        } else {
            palette.muted
        };
        canvas.ring(
            scale.place(point.x, point.y),
            6.5,
            Stroke::new(1.75, colour),
        );
    }
    canvas.clip(None);
    axes(canvas, figure, layout, scale, palette);
    for entry in &layout.legend {
        sign(canvas, entry, selection, palette);
    }
    if let Some(heat) = &figure.heat {
        colour_scale(canvas, heat, layout.plot, palette);
    }
}

fn grid(
    canvas: &mut dyn Canvas,
    figure: &Figure,
    layout: &Layout,
    scale: &Scale,
    palette: &Palette,
) {
    for band in &figure.bands {
        let [low, high] = band.y.map(|y| scale.y(y));
        let rect = Rect::from_x_y_ranges(layout.plot.x_range(), Rangef::new(high, low));
        canvas.fill(rect, palette.good.gamma_multiply(0.13));
        for y in [low, high] {
            let ends = [
                Pos2::new(layout.plot.min.x, y),
                Pos2::new(layout.plot.max.x, y),
            ];
            canvas.line(
                &ends,
                Stroke::new(1.0, palette.good.gamma_multiply(0.55)),
                true,
            );
        }
    }
    let thin = Stroke::new(1.0, palette.line.gamma_multiply(0.7));
    for (value, _) in &layout.x_ticks {
        let x = scale.x(*value).round() + 0.5;
        canvas.line(
            &[
                Pos2::new(x, layout.plot.min.y),
                Pos2::new(x, layout.plot.max.y),
            ],
            thin,
            false,
        );
    }
    for (value, _) in &layout.y_ticks {
        let y = scale.y(*value).round() + 0.5;
        canvas.line(
            &[
                Pos2::new(layout.plot.min.x, y),
                Pos2::new(layout.plot.max.x, y),
            ],
            thin,
            false,
        );
    }
    if figure.has_zero_line {
        let y = scale.y(0.0).round() + 0.5;
        let ends = [
            Pos2::new(layout.plot.min.x, y),
            Pos2::new(layout.plot.max.x, y),
        ];
        canvas.line(&ends, Stroke::new(1.0, palette.muted), false);
    }
}

fn histogram(canvas: &mut dyn Canvas, columns: &Columns, scale: &Scale, palette: &Palette) {
    let colour = columns.ink.colour(palette);
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

/// Colours of a series and of its points that are not used.
fn colours(series: &Series, palette: &Palette, dimmed: bool) -> [Color32; 2] {
    let strength = if dimmed { 0.3 } else { 1.0 };
    let colour = series.ink.colour(palette).gamma_multiply(strength);
    [colour, palette.muted.gamma_multiply(0.6 * strength)]
}

/// The columns of pixels that have more points than are drawn.
fn columns(thinned: &Thinned, colour: Color32, fill: &mut dyn FnMut(Rect, Color32)) {
    for (x, range) in &thinned.columns {
        let rect = Rect::from_x_y_ranges(Rangef::new(x - 0.5, x + 0.5), *range);
        fill(rect, colour.gamma_multiply(0.35));
    }
}

/// Gives very many points as small squares.
pub fn dots(
    (series, thinned): (&Series, &Thinned),
    scale: &Scale,
    palette: &Palette,
    dimmed: bool,
    fill: &mut dyn FnMut(Rect, Color32),
) {
    let [colour, excluded] = colours(series, palette, dimmed);
    columns(thinned, colour, fill);
    for index in &thinned.points {
        let point = series.points()[*index];
        let colour = if point.excluded { excluded } else { colour };
        let at = scale.place(point.x, point.y);
        fill(Rect::from_center_size(at, Vec2::splat(2.0)), colour);
    }
}

fn points(
    canvas: &mut dyn Canvas,
    (series, thinned): (&Series, &Thinned),
    scale: &Scale,
    palette: &Palette,
    dimmed: bool,
) {
    let [colour, excluded] = colours(series, palette, dimmed);
    columns(thinned, colour, &mut |rect, colour| {
        canvas.fill(rect, colour);
    });
    for index in &thinned.points {
        let point = series.points()[*index];
        let colour = if point.excluded { excluded } else { colour };
        if point.sd != [0.0, 0.0] {
            let [dx, dy] = point.sd;
            let stroke = Stroke::new(1.0, colour.gamma_multiply(0.7));
            let across = [
                scale.place(point.x - dx, point.y),
                scale.place(point.x + dx, point.y),
            ];
            let along = [
                scale.place(point.x, point.y - dy),
                scale.place(point.x, point.y + dy),
            ];
            canvas.line(&across, stroke, false);
            canvas.line(&along, stroke, false);
        }
        let at = scale.place(point.x, point.y);
        if series.hollow {
            canvas.ring(at, 3.25, Stroke::new(1.25, colour));
        } else {
            canvas.marker(at, series.marker, 3.25, colour);
        }
    }
}

fn curves(canvas: &mut dyn Canvas, figure: &Figure, scale: &Scale, palette: &Palette) {
    for curve in &figure.curves {
        let stroke = Stroke::new(1.75, curve.ink.colour(palette));
        for part in curve
            .points
            .split(|[x, y]| !(x.is_finite() && y.is_finite()))
        {
            let places: Vec<Pos2> = part.iter().map(|[x, y]| scale.place(*x, *y)).collect();
            if places.len() > 1 {
                canvas.line(&places, stroke, curve.dashed);
            }
        }
    }
}

fn axes(
    canvas: &mut dyn Canvas,
    figure: &Figure,
    layout: &Layout,
    scale: &Scale,
    palette: &Palette,
) {
    let plot = layout.plot;
    let edge = Stroke::new(1.0, palette.line);
    canvas.line(
        &[plot.left_top(), plot.left_bottom(), plot.right_bottom()],
        edge,
        false,
    );
    let mut free = f32::NEG_INFINITY;
    for (value, text) in &layout.x_ticks {
        // Names can be closer than their width.
        let (x, half) = (scale.x(*value), 0.3 * TEXT * text.chars().count() as f32);
        if x - half < free || x + half + 2.0 * GRID > layout.x_title {
            continue;
        }
        free = x + half + GRID;
        let at = Pos2::new(x, plot.max.y + GRID);
        canvas.text(at, Align2::CENTER_TOP, text, TEXT, palette.muted);
    }
    let mut free = f32::INFINITY;
    for (value, text) in &layout.y_ticks {
        let y = scale.y(*value);
        if y + 0.5 * TEXT > free {
            continue;
        }
        free = y - 0.5 * TEXT;
        let at = Pos2::new(plot.min.x - GRID, y);
        canvas.text(at, Align2::RIGHT_CENTER, text, TEXT, palette.muted);
    }
    if figure.x.names.is_empty() {
        let is_beside = layout.x_title.is_finite();
        let down = if is_beside { GRID } else { TEXT + 2.0 * GRID };
        let at = Pos2::new(plot.max.x, plot.max.y + down);
        let title = figure.x.title();
        canvas.text(at, Align2::RIGHT_TOP, &title, TEXT, palette.text);
    }
    canvas.text(
        layout.whole.min,
        Align2::LEFT_TOP,
        &figure.y.title(),
        TEXT,
        palette.text,
    );
}

fn sign(canvas: &mut dyn Canvas, entry: &Entry, selection: Selection, palette: &Palette) {
    let at = entry.rect.left_center() + vec2(2.0 * GRID, 0.0);
    let half = vec2(1.5 * GRID, 0.0);
    let area = Rect::from_center_size(at, vec2(3.0 * GRID, 2.0 * GRID));
    match entry.sign {
        Sign::Marker(marker, ink) => canvas.marker(at, marker, 3.75, ink.colour(palette)),
        Sign::Ring(ink) => canvas.ring(at, 3.75, Stroke::new(1.25, ink.colour(palette))),
        Sign::Line(ink, dashed) => {
            canvas.line(
                &[at - half, at + half],
                Stroke::new(1.75, ink.colour(palette)),
                dashed,
            );
        }
        Sign::Area(ink, false) => canvas.fill(area, ink.colour(palette).gamma_multiply(0.45)),
        Sign::Area(ink, true) => {
            let corners = [
                area.left_bottom(),
                area.left_top(),
                area.right_top(),
                area.right_bottom(),
            ];
            canvas.line(&corners, Stroke::new(1.75, ink.colour(palette)), false);
        }
        Sign::Band => canvas.fill(area, palette.good.gamma_multiply(0.3)),
    }
    let is_selected = entry.cable.is_some() && entry.cable == selection.cable;
    let colour = if is_selected {
        palette.accent
    } else {
        palette.text
    };
    let at = entry.rect.left_center() + vec2(5.0 * GRID, 0.0);
    canvas.text(at, Align2::LEFT_CENTER, &entry.text, TEXT, colour);
}

/// Width of a text of the size [`TEXT`] on screen.
pub fn text_width(painter: &egui::Painter) -> impl Fn(&str) -> f32 + '_ {
    |text| {
        let font = FontId::proportional(TEXT);
        let galley = painter.layout_no_wrap(text.to_owned(), font, Color32::WHITE);
        galley.size().x
    }
}

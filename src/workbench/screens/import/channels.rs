//! List of channels with sparklines.

use std::sync::Arc;

use egui::{
    Galley, Pos2, Rect, RichText, Role, ScrollArea, Sense, Shape, Stroke, TextStyle, TextWrapMode,
    Ui, Vec2, WidgetInfo, WidgetText,
};
use tautline_channels::Series;
use tautline_import::Quantity;

use super::Bench;
use crate::model::command::RecordingCommand;
use crate::model::importing::ChannelPlace;
use crate::theme::{self, GRID};
use crate::widgets::{UiExt, row_ground};

/// Height of a row and widths of its parts (points).
const ROW: f32 = 6.0 * GRID;
const UNIT: f32 = 12.0 * GRID;
const COURSE: f32 = 32.0 * GRID;
const USE: f32 = 26.0 * GRID;

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let several = bench.open.all_series().count() > 1;
        for (k, series) in bench.open.all_series().enumerate() {
            if several {
                ui.section(&series.name);
            }
            let texts = series.channels.len()..series.channels.len() + series.texts.len();
            for channel in (0..series.channels.len()).chain(texts) {
                let place = ChannelPlace { series: k, channel };
                if row(ui, bench, series, place) {
                    bench.outbox.send(RecordingCommand::ShowChannel(place));
                }
            }
        }
        if bench.open.all_series().next().is_none() {
            ui.muted("These files have no channels.");
        }
    });
}

/// Draws a channel; returns whether it was clicked.
fn row(ui: &mut Ui, bench: &Bench<'_>, series: &Series, place: ChannelPlace) -> bool {
    let size = Vec2::new(ui.available_width(), ROW);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let number = series.channels.get(place.channel);
    let name = match number {
        Some(channel) => &channel.name,
        None => &series.texts[place.channel - series.channels.len()].name,
    };
    let used = bench.open.uses.get(&(place.series, name.clone()));
    let is_shown = bench.open.shown == place;
    response.widget_info(|| {
        let used = used.map_or("not used", String::as_str);
        WidgetInfo::selected(Role::Button, true, is_shown, format!("{name}, {used}"))
    });
    if !ui.is_rect_visible(rect) {
        return response.clicked();
    }
    let palette = theme::of(ui);
    row_ground(ui, &response, 2.0, is_shown);
    let cable = used
        .and_then(|column| Quantity::parse(column))
        .filter(|quantity| quantity.is_per_cable())
        .map(|quantity| quantity.index);
    let colour = match (used, cable) {
        (Some(_), Some(cable)) => palette.cable(cable),
        (Some(_), None) => palette.accent,
        (None, _) => palette.muted,
    };
    let inner = rect.shrink2(Vec2::new(GRID, 0.0));
    let mut right = inner.right();
    let mut column = |width: f32| {
        right -= width;
        Rect::from_min_max(
            Pos2::new(right, inner.top()),
            Pos2::new(right + width, inner.bottom()),
        )
    };
    let words = used.map_or("–", String::as_str);
    let dot = column(USE);
    text(
        ui,
        dot.with_min_x(dot.left() + 4.0 * GRID),
        words,
        used.is_none(),
    );
    if used.is_some() {
        let centre = Pos2::new(dot.left() + 2.0 * GRID, dot.center().y);
        ui.painter().circle_filled(centre, GRID, colour);
    }
    let course = column(COURSE.min(0.3 * rect.width()));
    match number {
        Some(_) => {
            let outline = bench.open.outlines.channel(place.series, place.channel);
            sparkline(ui, course.shrink2(Vec2::new(GRID, 3.0)), outline, colour);
        }
        None => text(ui, course.shrink2(Vec2::new(GRID, 0.0)), "text", true),
    }
    let unit = number.and_then(|channel| channel.unit.as_deref());
    text(ui, column(UNIT), unit.unwrap_or_default(), true);
    let rest = inner.with_max_x(right - GRID);
    text(ui, rest, name, false);
    response.on_hover_text(name).clicked()
}

/// Line of text, truncated with an ellipsis.
fn text(ui: &Ui, rect: Rect, text: &str, is_muted: bool) {
    let palette = theme::of(ui);
    let colour = if is_muted {
        palette.muted
    } else {
        palette.text
    };
    let text = WidgetText::from(RichText::new(text));
    let galley: Arc<Galley> = text.into_galley(
        ui,
        Some(TextWrapMode::Truncate),
        rect.width().max(1.0),
        TextStyle::Body,
    );
    let place = Pos2::new(rect.left(), rect.center().y - 0.5 * galley.size().y);
    ui.painter()
        .galley_with_override_text_color(place, galley, colour);
}

/// Sparkline of a channel in a rectangle.
fn sparkline(ui: &Ui, rect: Rect, course: &[(usize, f64)], colour: egui::Color32) {
    let values = course.iter().map(|(_, value)| *value);
    let values = values.filter(|value| value.is_finite());
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let (Some((first, _)), Some((last, _))) = (course.first(), course.last()) else {
        return;
    };
    if low > high {
        return;
    }
    let span = (high - low).max(f64::MIN_POSITIVE);
    let rows = (last - first).max(1) as f64;
    let place = |(row, value): &(usize, f64)| {
        let x = (row - first) as f64 / rows;
        let y = if high > low {
            (value - low) / span
        } else {
            0.5
        };
        rect.left_bottom() + Vec2::new(x as f32 * rect.width(), -(y as f32) * rect.height())
    };
    // At most a few points per pixel; more could not be distinguished.
    let every = (course.len() / (2 * rect.width().max(1.0) as usize)).max(1);
    let stroke = Stroke::new(1.0, colour);
    for run in course.split(|(_, value)| !value.is_finite()) {
        let points: Vec<Pos2> = run.iter().step_by(every).map(place).collect();
        if points.len() > 1 {
            ui.painter().add(Shape::line(points, stroke));
        } else if let Some(point) = points.first() {
            ui.painter().circle_filled(*point, 1.0, colour);
        }
    }
}

//! Plots of each part over the sessions, with a common time axis.

use std::sync::Arc;

use egui::{Grid, ScrollArea, Ui, vec2};
use tautline_core::history::RobotPart;
use tautline_workflow::history::lane;
use tautline_workflow::plot::Figure;

use super::selection_of;
use crate::model::Model;
use crate::model::command::{Outbox, PlotCommand, ViewCommand};
use crate::model::record::OpenRecord;
use crate::theme::GRID;
use crate::views::plots::small::{SmallPlot, legend_of, show_linked};
use crate::widgets::UiExt;

/// Smallest width of a plot, its height, and the gap between plots (points).
const WIDTH: f32 = 330.0;
const HEIGHT: f32 = 168.0;
const GAP: f32 = 2.0 * GRID;

/// Plots of a record.
#[derive(Debug)]
pub(super) struct Lanes {
    plots: Vec<(RobotPart, Arc<Figure>)>,
    /// Number of the frame in which they were computed.
    generation: u64,
}

impl Lanes {
    pub(super) fn new(open: &OpenRecord, generation: u64) -> Self {
        let parts = open.found.history.parts.iter().enumerate();
        let drawn = parts.map(|(index, part)| {
            let figure = lane(&open.record, &open.found, index);
            (part.clone(), Arc::new(figure))
        });
        Self {
            plots: drawn.collect(),
            generation,
        }
    }
}

pub(super) fn show(ui: &mut Ui, model: &Model, lanes: &Lanes, outbox: &mut Outbox) {
    ui.horizontal_wrapped(|ui| {
        ui.section("Courses");
        ui.muted("less the last session. Line with 95 % band: all sessions together; points: each by itself; shaded dates: when it jumped; dashed: events");
    });
    let first = lanes.plots.first().map(|(_, figure)| figure);
    if let Some(first) = first {
        legend_of(ui, first, model.selection);
    }
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let columns = (ui.available_width() / WIDTH).floor().max(1.0);
        let width = (ui.available_width() - GAP * (columns - 1.0)) / columns;
        Grid::new("courses").spacing(vec2(GAP, GAP)).show(ui, |ui| {
            for (index, (part, figure)) in lanes.plots.iter().enumerate() {
                let plot = SmallPlot {
                    name: &format!("Course: {}", figure.y.title()),
                    figure,
                    generation: lanes.generation,
                    size: vec2(width, HEIGHT),
                    link: Some("courses"),
                    is_explained: first.is_some_and(|first| names(first) == names(figure)),
                };
                one(ui, model, part, &plot, outbox);
                if (index + 1) % columns as usize == 0 {
                    ui.end_row();
                }
            }
        });
    });
}

/// Names in the legend of a plot.
fn names(figure: &Figure) -> Vec<&str> {
    let series = figure.series.iter().map(|one| one.name.as_str());
    let curves = figure.curves.iter().map(|one| one.name.as_str());
    let bands = figure.bands.iter().map(|one| one.name.as_str());
    series.chain(curves).chain(bands).collect()
}

fn one(ui: &mut Ui, model: &Model, part: &RobotPart, plot: &SmallPlot<'_>, outbox: &mut Outbox) {
    let asked = show_linked(ui, plot, model.selection);
    if asked.is_clicked
        && let Some(selection) = selection_of(part)
    {
        outbox.send(ViewCommand::Select(selection));
    }
    if let Some((ending, file)) = asked.saved {
        let name = plot.figure.y.label.to_lowercase();
        let name = name.replace(|letter: char| !letter.is_alphanumeric(), "-");
        outbox.send(PlotCommand::AskSave(format!("{name}.{ending}"), file));
    }
}

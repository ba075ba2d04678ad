//! Import of files of other programs: channels, their meaning, cutting of poses, check.

mod begin;
mod channels;
mod check;
mod clocks;
mod course;
mod cutting;
mod files;
mod mapping;
mod recipe;

use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Ui};
use tautline_core::robot::Robot;
use tautline_import::Recipe;

use crate::model::Model;
use crate::model::command::{Outbox, RecordingCommand};
use crate::model::importing::{ChannelPlace, OpenImport};
use crate::model::part::ScreenPart;
use crate::theme::GRID;
use crate::widgets::{one_part, panel_frame};

#[derive(Debug, Default)]
pub struct PanelState {
    path: String,
    recipe: String,
    /// Part shown in a small window.
    part: ScreenPart,
    /// Pattern of the shown channel.
    pattern: Option<KnownPattern>,
    /// Whether the choice applies to all channels of the pattern.
    for_all: bool,
}

/// Pattern that a channel belongs to.
#[derive(Debug)]
struct KnownPattern {
    of: ChannelPlace,
    /// Number of files when the pattern was determined.
    files: usize,
    /// Pattern and number of the first channel; `None` if the channel is alone.
    found: Option<(String, usize)>,
}

/// Width of the window (points) below which one part is shown at a time.
const COMPACT: f32 = 900.0;
/// Parts, and their titles in a small window.
const PARTS: [(ScreenPart, &str); 3] = [
    (ScreenPart::Robot, "Channels"),
    (ScreenPart::Panel, "Recipe"),
    (ScreenPart::Plots, "Over time"),
];

/// Context of the parts of the screen.
struct Bench<'a> {
    /// Robot that was measured.
    robot: &'a Robot,
    /// Sources, recipe and poses.
    open: &'a OpenImport,
    outbox: &'a mut Outbox,
}

impl Bench<'_> {
    /// Changes the recipe; `what` is the name of the change in the undo menu.
    fn change(&mut self, what: impl Into<String>, change: impl FnOnce(&mut Recipe)) {
        self.change_on(what, false, change);
    }

    /// Changes the recipe; a continued change is merged with the previous undo step.
    fn change_on(
        &mut self,
        what: impl Into<String>,
        goes_on: bool,
        change: impl FnOnce(&mut Recipe),
    ) {
        let mut recipe = self.open.draft.recipe().clone();
        change(&mut recipe);
        let command = RecordingCommand::Change(Box::new(recipe), what.into(), goes_on);
        self.outbox.send(command);
    }
}

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let (Some(import), Some(session)) = (&model.importing.open, &model.open) else {
        return begin::show(ui, model, panel, outbox);
    };
    Panel::top("imported files")
        .frame(panel_frame(ui))
        .show(ui, |ui| files::show(ui, import, panel, outbox));
    let mut bench = Bench {
        robot: &session.session().robot,
        open: import,
        outbox,
    };
    let mut part = panel.part;
    let draw = |ui: &mut Ui, part: ScreenPart| match part {
        ScreenPart::Panel => steps(ui, model, &mut bench, panel),
        ScreenPart::Robot => channels::show(ui, &mut bench),
        ScreenPart::Plots => course::show(ui, &bench),
    };
    if ui.available_width() < COMPACT {
        one_part(ui, &mut part, PARTS, draw);
    } else {
        wide(ui, draw);
    }
    panel.part = part;
}

/// All parts side by side.
fn wide(ui: &mut Ui, mut draw: impl FnMut(&mut Ui, ScreenPart)) {
    let side = panel_frame(ui);
    let width = (0.36 * ui.available_width()).clamp(360.0, 520.0);
    Panel::right("recipe of the import")
        .frame(side)
        .resizable(false)
        .exact_size(width)
        .show(ui, |ui| draw(ui, ScreenPart::Panel));
    let height = (0.42 * ui.available_height()).max(180.0);
    Panel::bottom("course of the channel")
        .frame(side)
        .resizable(false)
        .exact_size(height)
        .show(ui, |ui| draw(ui, ScreenPart::Plots));
    CentralPanel::no_frame()
        .frame(side)
        .show(ui, |ui| draw(ui, ScreenPart::Robot));
}

/// Steps from channels to poses; the last one stays at the bottom.
fn steps(ui: &mut Ui, model: &Model, bench: &mut Bench<'_>, panel: &mut PanelState) {
    Panel::bottom("last step of the import")
        .frame(Frame::new().inner_margin(Margin {
            top: 2 * GRID as i8,
            ..Margin::ZERO
        }))
        .resizable(false)
        .show_separator_line(false)
        .show(ui, |ui| check::last_step(ui, model, bench));
    let area = ScrollArea::vertical().auto_shrink(false);
    area.min_scrolled_height(0.0).show(ui, |ui| {
        mapping::show(ui, bench, panel);
        clocks::show(ui, bench);
        cutting::show(ui, bench);
        check::show(ui, bench);
        recipe::show(ui, bench, panel);
        ui.add_space(2.0 * GRID);
    });
}

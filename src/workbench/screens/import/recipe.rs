//! The recipe: its entries, and its file.

use egui::{Align, Label, Layout, Ui, Vec2};
use egui_material_icons::icons;
use tautline_core::robot::Robot;
use tautline_import::{Assignment, Quantity};

use super::{Bench, PanelState};
use crate::model::command::RecordingCommand;
use crate::theme::GRID;
use crate::widgets::{UiExt, icon_button, icon_only, path_field};

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>, panel: &mut PanelState) {
    ui.section("Recipe");
    ui.muted(bench.open.draft.origin());
    entries(ui, bench);
    ui.muted("The session keeps it for the next file. As a file it serves other sessions and `tautline import --recipe`.");
    let path = &mut panel.recipe;
    let size = Vec2::new(ui.available_width(), 7.0 * GRID);
    ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
        if icon_only(ui, icons::ICON_SAVE_AS, "Save the recipe as…", true).clicked() {
            bench.outbox.send(RecordingCommand::AskSaveRecipe);
        }
        if icon_only(ui, icons::ICON_FOLDER_OPEN, "Browse for a recipe", true).clicked() {
            bench.outbox.send(RecordingCommand::AskRecipe);
        }
        let typed = !path.trim().is_empty();
        if icon_button(ui, icons::ICON_SAVE, "Save recipe", typed).clicked() {
            let path = path.trim().into();
            bench.outbox.send(RecordingCommand::SaveRecipe(path));
        }
        if icon_button(ui, icons::ICON_UPLOAD_FILE, "Use", typed).clicked() {
            let path = path.trim().into();
            bench.outbox.send(RecordingCommand::UseRecipe(path));
        }
        let width = ui.available_width();
        path_field(ui, "Path of the recipe", "Path of a recipe", path, width);
    });
}

/// Entries of the recipe, each with a button to remove it.
fn entries(ui: &mut Ui, bench: &mut Bench<'_>) {
    let recipe = bench.open.draft.recipe();
    if recipe.channels.is_empty() {
        return ui
            .doubtful("No channel is used yet. Choose a channel on the left and say what it is.");
    }
    let mut removed = None;
    for (k, entry) in recipe.channels.iter().enumerate() {
        ui.horizontal(|ui| {
            let name = format!("Do not use {}", entry.channel);
            if icon_only(ui, icons::ICON_CLOSE, &name, true).clicked() {
                removed = Some(k);
            }
            ui.add(Label::new(in_words(entry, bench.robot)).truncate());
        });
    }
    if let Some(k) = removed {
        let what = format!("do not use {}", recipe.channels[k].channel);
        bench.change(what, |recipe| {
            recipe.channels.remove(k);
        });
    }
}

/// Description of an entry, such as "rev_1 … rev_8: winch revolutions".
fn in_words(entry: &Assignment, robot: &Robot) -> String {
    let last = robot.cable_count().saturating_sub(1);
    let channels = match entry.is_pattern() {
        true => format!("{} … {}", entry.channel_of(0), entry.channel_of(last)),
        false => entry.channel.clone(),
    };
    let quantity = Quantity::parse(&entry.of_cable(0).quantity);
    let mut words = quantity.map_or_else(
        || entry.quantity.clone(),
        |quantity| quantity.title().to_lowercase(),
    );
    let cable = quantity.filter(|quantity| quantity.is_per_cable() && !entry.is_pattern());
    if let Some(cable) = cable.and_then(|quantity| robot.cables.get(quantity.index)) {
        words += &format!(" of {}", cable.name);
    }
    if entry.reversed {
        words += ", reversed";
    }
    if let Some(unit) = &entry.unit {
        words += &format!(", in {unit}");
    }
    format!("{channels}: {words}")
}

//! Gallery: signature of each effect in the residuals of the robot, for comparison with measured ones.

use std::sync::Arc;

use egui::{
    Align, Button, CollapsingHeader, Frame, Label, Layout, RichText, Role, ScrollArea, Sense,
    TextEdit, Ui, WidgetInfo, vec2,
};
use egui_material_icons::icons;
use tautline_core::effect::Effect;
use tautline_workflow::plot::Selection;
use tautline_workflow::signature::{Gallery, Signature};
use tautline_workflow::wording::count;

use crate::model::Model;
use crate::model::command::{DRAWING, HypothesisCommand, Outbox, ViewCommand};
use crate::theme::{self, GRID};
use crate::views::plots::small;
use crate::widgets::{UiExt, icon_button};

/// Smallest width and height of a card (points).
const CARD: f32 = 250.0;
const CARD_HEIGHT: f32 = 208.0;
/// Height of the plot of a card, and of the plots of the chosen effect (points).
const PLOT: f32 = 132.0;
const LARGE_PLOT: f32 = 170.0;
/// Width of the column of the chosen effect, and smallest width of the screen for it beside the cards (points).
const CHOSEN: f32 = 400.0;
const WIDE: f32 = 900.0;

#[derive(Debug, Default)]
pub struct PanelState {
    /// Search text for titles and causes.
    filter: String,
    /// Identifier of the chosen effect.
    chosen: Option<&'static str>,
}

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let robot = model.robot_of_effects().map(|(robot, _)| robot);
    let known = model.hypothesis.gallery.as_ref();
    let known = known.filter(|(of, _)| Some(of) == robot.as_ref());
    Frame::new().inner_margin(4.0 * GRID).show(ui, |ui| {
        let gallery = known.and_then(|(_, result)| result.as_ref().ok());
        head(ui, model, panel, gallery, outbox);
        match known.map(|(_, result)| result) {
            Some(Ok(gallery)) => contents(ui, gallery, panel, outbox),
            Some(Err(why)) => ui.bad(why),
            None => waiting(ui, model, outbox),
        }
    });
}

fn head(
    ui: &mut Ui,
    model: &Model,
    panel: &mut PanelState,
    gallery: Option<&Arc<Gallery>>,
    outbox: &mut Outbox,
) {
    ui.horizontal(|ui| {
        // Buttons are placed first; the heading gets the remaining width.
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if icon_button(ui, icons::ICON_ARROW_BACK, "Back", true).clicked() {
                outbox.send(ViewCommand::Go(model.previous_screen()));
            }
            let is_drawn = gallery.is_some();
            if icon_button(ui, icons::ICON_DOWNLOAD, "Save as HTML…", is_drawn).clicked() {
                outbox.send(HypothesisCommand::AskSaveGallery);
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let title = RichText::new("Gallery of effects").heading();
                ui.add(Label::new(title).truncate());
            });
        });
    });
    ui.horizontal_wrapped(|ui| {
        let field = TextEdit::singleline(&mut panel.filter)
            .hint_text("Search")
            .desired_width(160.0);
        ui.add(field)
            .widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Search effects"));
        if let Some(gallery) = gallery {
            let poses = count(gallery.poses, "pose");
            ui.muted(&format!("{} at {poses}.", gallery.robot.name));
        }
        ui.muted("Residuals of a model that does not know the effect: at a typical size, without noise, in standard deviations. Noise hides what is in the band.");
    });
    ui.add_space(2.0 * GRID);
}

fn waiting(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    if !model.tasks.runs(DRAWING) {
        outbox.send(HypothesisCommand::DrawGallery);
    }
    ui.busy("Simulating each effect on this robot…");
}

fn contents(ui: &mut Ui, gallery: &Gallery, panel: &mut PanelState, outbox: &mut Outbox) {
    let wanted = panel.filter.to_lowercase();
    let is_wanted = |one: &&Signature| {
        let texts = [one.effect.title(), &one.cause, one.effect.id()];
        texts
            .iter()
            .any(|text| text.to_lowercase().contains(&wanted))
    };
    let wanted = gallery.signatures.iter().filter(is_wanted);
    let (shown, empty): (Vec<&Signature>, Vec<_>) = wanted.partition(|one| one.images.is_ok());
    let chosen = gallery
        .signatures
        .iter()
        .find(|one| Some(one.effect.id()) == panel.chosen);
    let is_wide = ui.available_width() >= WIDE;
    match chosen {
        Some(signature) if !is_wide => {
            if icon_button(ui, icons::ICON_ARROW_BACK, "All effects", true).clicked() {
                panel.chosen = None;
            }
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                in_full(ui, gallery, signature, outbox);
            });
        }
        Some(signature) => {
            ui.horizontal_top(|ui| {
                let width = ui.available_width() - CHOSEN - 4.0 * GRID;
                ui.vertical(|ui| {
                    ui.set_width(width);
                    without_picture(ui, &empty, panel);
                    cards(ui, &shown, panel);
                });
                ui.add_space(2.0 * GRID);
                ui.vertical(|ui| {
                    ScrollArea::vertical()
                        .id_salt("chosen effect")
                        .auto_shrink(false)
                        .show(ui, |ui| in_full(ui, gallery, signature, outbox));
                });
            });
        }
        None => {
            without_picture(ui, &empty, panel);
            cards(ui, &shown, panel);
        }
    }
}

/// Effects without a visible signature, collapsed.
fn without_picture(ui: &mut Ui, empty: &[&Signature], panel: &mut PanelState) {
    if empty.is_empty() {
        return;
    }
    let title = format!("{} without a picture", count(empty.len(), "effect"));
    CollapsingHeader::new(title)
        .id_salt("effects without a picture")
        .open((!panel.filter.is_empty()).then_some(true))
        .show(ui, |ui| {
            for one in empty {
                ui.horizontal_wrapped(|ui| {
                    name(ui, one.effect, panel);
                    if let Err(why) = &one.images {
                        ui.muted(why);
                    }
                });
            }
        });
}

/// Title of an effect; a click shows its details.
fn name(ui: &mut Ui, effect: &Effect, panel: &mut PanelState) {
    let title = RichText::new(effect.title()).font(theme::strong(13.0));
    let button = ui.add(Button::new(title).frame(false).truncate());
    button.widget_info(|| {
        let name = format!("Effect: {}", effect.title());
        WidgetInfo::labeled(Role::Button, true, name)
    });
    if button.clicked() {
        let is_chosen = panel.chosen == Some(effect.id());
        panel.chosen = (!is_chosen).then_some(effect.id());
    }
}

/// Cards in rows; only visible ones are drawn.
fn cards(ui: &mut Ui, shown: &[&Signature], panel: &mut PanelState) {
    if shown.is_empty() {
        ui.muted("No effect with a picture has this name.");
        return;
    }
    let space = 2.0 * GRID;
    let columns = ((ui.available_width() / (CARD + space)).floor() as usize).max(1);
    let rows = shown.len().div_ceil(columns);
    ui.spacing_mut().item_spacing = vec2(space, space);
    ScrollArea::vertical()
        .id_salt("effects")
        .auto_shrink(false)
        .show_rows(ui, CARD_HEIGHT, rows, |ui, rows| {
            let width = (ui.available_width() - space * (columns - 1) as f32) / columns as f32;
            for row in rows {
                ui.horizontal_top(|ui| {
                    for one in shown.iter().skip(row * columns).take(columns) {
                        card(ui, one, vec2(width, CARD_HEIGHT), panel);
                    }
                });
            }
        });
}

fn card(ui: &mut Ui, signature: &Signature, size: egui::Vec2, panel: &mut PanelState) {
    let effect = signature.effect;
    let is_chosen = panel.chosen == Some(effect.id());
    let palette = theme::of(ui);
    let (place, _) = ui.allocate_exact_size(size, Sense::hover());
    ui.painter().rect_filled(place, 6.0, palette.panel);
    if is_chosen {
        let stroke = egui::Stroke::new(1.5, palette.accent);
        ui.painter()
            .rect_stroke(place, 6.0, stroke, egui::StrokeKind::Inside);
    }
    let inside = place.shrink(2.0 * GRID);
    let mut ui = ui.new_child(
        egui::UiBuilder::new()
            .max_rect(inside)
            .layout(Layout::top_down(Align::Min))
            .id_salt(effect.id()),
    );
    ui.set_clip_rect(ui.clip_rect().intersect(place));
    name(&mut ui, effect, panel);
    let images = signature.images.as_ref().ok();
    if let Some(image) = images.and_then(|images| images.first()) {
        let line = format!("{}, {}", image.name, signature.size);
        let line = RichText::new(line).small().color(palette.muted);
        ui.add(Label::new(line).truncate());
        let name = format!("Residuals of {}: {}", effect.title(), image.name);
        small::show(&mut ui, &name, &image.figure, PLOT, Selection::default());
    }
}

fn in_full(ui: &mut Ui, gallery: &Gallery, signature: &Signature, outbox: &mut Outbox) {
    let effect = signature.effect;
    ui.wrapped(RichText::new(effect.title()).font(theme::strong(15.0)));
    ui.add_space(GRID);
    ui.wrapped(&signature.cause);
    ui.section("Workshop");
    ui.wrapped(&signature.workshop);
    if let Some(check) = effect.check() {
        ui.section("Check");
        ui.wrapped(check);
    }
    ui.section("Residuals");
    match &signature.images {
        Err(why) => {
            ui.muted(why);
        }
        Ok(images) => {
            ui.muted(&format!("Size: {}", signature.size));
            for image in images {
                ui.add_space(GRID);
                ui.muted(&image.name);
                let name = format!("{} of {}", image.name, effect.title());
                small::show(ui, &name, &image.figure, LARGE_PLOT, Selection::default());
            }
        }
    }
    ui.add_space(2.0 * GRID);
    if let Ok(text) = effect.as_text(&gallery.robot) {
        let button = icon_button(ui, icons::ICON_EDIT, "Start a hypothesis from it", true);
        if button.clicked() {
            outbox.send(HypothesisCommand::Begin(text));
        }
    }
}

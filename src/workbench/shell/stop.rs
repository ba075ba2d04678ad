//! Stop: a button above all layers, including dialogs, and a key.

use egui::{Align2, Area, Button, Id, Order, Response, RichText, Role, Ui, Vec2, WidgetInfo};
use egui_material_icons::icons;

use crate::commands;
use crate::model::Model;
use crate::model::command::{RobotCommand, STOP};
use crate::theme::{self, GRID};

/// Size of the button (points); the top bar leaves its right corner free for it.
pub const SIZE: Vec2 = Vec2::new(26.0 * GRID, 6.0 * GRID);

/// Stops the robot when the button or key is pressed. The button has the topmost layer, and the press is handled before
/// the rest of the window, so that no dialog, menu or internal error can block it.
pub fn show(ui: &mut Ui, model: &mut Model) {
    if model.open.is_none() {
        return;
    }
    let is_key = ui.input_mut(|input| input.consume_shortcut(&STOP));
    let shown = Area::new(Id::unique("stop"))
        .order(Order::TOP)
        .anchor(Align2::RIGHT_TOP, Vec2::new(-2.0 * GRID, GRID))
        .show(ui.ctx(), |ui| button(ui, model.link.can_move()).clicked());
    if shown.inner || is_key && model.link.is_connected() {
        commands::perform(model, RobotCommand::Stop.into());
    }
}

fn button(ui: &mut Ui, can_move: bool) -> Response {
    let palette = theme::of(ui);
    let (fill, ink) = match can_move {
        true => (palette.bad, palette.on_accent),
        false => (palette.raised, palette.muted),
    };
    let text = |text: &str| RichText::new(text).font(theme::strong(13.0)).color(ink);
    let icon = icons::ICON_STOP_CIRCLE.rich_text().size(16.0).color(ink);
    let keys = ui.ctx().format_shortcut(&STOP);
    let button = Button::new((icon, text("Stop"), text(&keys)))
        .fill(fill)
        .min_size(SIZE);
    let response = ui.add_enabled(can_move, button);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, can_move, "Stop the robot"));
    response
        .on_hover_text("Stops the robot immediately")
        .on_disabled_hover_text("Nothing can move: the controller is not armed")
}

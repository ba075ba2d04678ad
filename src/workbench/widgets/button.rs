//! Buttons, radio buttons and check boxes.

use egui::{Button, Response, RichText, Role, Ui, WidgetInfo};
use egui_material_icons::MaterialIcon;

use crate::theme;

/// Primary button of a panel, for the next step.
pub fn primary(ui: &mut Ui, text: &str, enabled: bool) -> Response {
    let palette = theme::of(ui);
    let label = RichText::new(text)
        .font(theme::strong(13.0))
        .color(palette.on_accent);
    ui.add_enabled(
        enabled,
        Button::new(label)
            .fill(palette.accent)
            .min_size(egui::vec2(0.0, 28.0)),
    )
}

/// Whether a single-line field was left with Enter, without modifier keys.
pub fn entered(field: &Response) -> bool {
    let is_enter = |i: &egui::InputState| i.modifiers.is_none() && i.key_pressed(egui::Key::Enter);
    field.lost_focus() && field.ctx.input(is_enter)
}

pub fn checkbox(ui: &mut Ui, is_ticked: &mut bool, text: &str) -> Response {
    as_light_as_a_field(ui, |ui| ui.checkbox(is_ticked, text))
}

/// Radio button.
pub fn radio(ui: &mut Ui, is_chosen: bool, text: &str) -> Response {
    as_light_as_a_field(ui, |ui| ui.radio(is_chosen, text))
}

/// Radio button that sets a value.
pub fn choice<V: PartialEq>(ui: &mut Ui, chosen: &mut V, this: V, text: &str) -> Response {
    let response = radio(ui, *chosen == this, text);
    if response.clicked() {
        *chosen = this;
    }
    response
}

/// Draws a check box or radio button with the background of a field; that of a button would look disabled.
fn as_light_as_a_field(ui: &mut Ui, add: impl FnOnce(&mut Ui) -> Response) -> Response {
    let palette = theme::of(ui);
    let before = ui.visuals().widgets.inactive;
    let inactive = &mut ui.visuals_mut().widgets.inactive;
    inactive.bg_fill = palette.ground;
    inactive.bg_stroke.color = palette.muted;
    let response = add(ui);
    ui.visuals_mut().widgets.inactive = before;
    response
}

/// Gives a button an accessible name, if its text is not unique.
pub fn named(button: Response, name: &str) -> Response {
    let enabled = button.enabled();
    button.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    button
}

/// Button with icon and text, which is its accessible name.
pub fn icon_button(ui: &mut Ui, icon: MaterialIcon, text: &str, enabled: bool) -> Response {
    let button = Button::new((icon.rich_text().size(16.0), text));
    named(ui.add_enabled(enabled, button), text)
}

/// Button with an icon only; `name` is its tooltip and accessible name.
pub fn icon_only(ui: &mut Ui, icon: MaterialIcon, name: &str, enabled: bool) -> Response {
    let button = Button::new(icon.rich_text().size(18.0))
        .frame_when_inactive(false)
        .min_size(egui::vec2(28.0, 24.0));
    // Same height as other buttons.
    let response = ui.scope(|ui| {
        ui.spacing_mut().button_padding.y = 0.0;
        ui.add_enabled(enabled, button)
    });
    let response = named(response.inner, name);
    response.on_hover_text(name).on_disabled_hover_text(name)
}

/// Ground of a row that can be selected.
pub fn row_ground(ui: &Ui, row: &Response, radius: f32, is_selected: bool) {
    let palette = theme::of(ui);
    if is_selected {
        ui.painter().rect_filled(row.rect, radius, palette.raised);
    } else if row.hovered() || row.has_focus() {
        let fill = palette.hovered.gamma_multiply(0.5);
        ui.painter().rect_filled(row.rect, radius, fill);
    }
}

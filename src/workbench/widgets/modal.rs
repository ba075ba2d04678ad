//! Modal dialogs; only Stop is drawn above them.

use egui::{Frame, Id, Modal, Order, Ui};

use crate::theme::GRID;

/// Draws a modal dialog; returns the result of `content` and whether the operator left it by Escape or a click outside.
pub(crate) fn modal<T>(
    ui: &Ui,
    name: &str,
    width: f32,
    content: impl FnOnce(&mut Ui) -> T,
) -> (T, bool) {
    let room = ui.ctx().content_rect().width() - 12.0 * GRID;
    let shown = Modal::new(Id::unique(name)).show(ui.ctx(), |ui| {
        ui.set_width(width.min(room));
        content(ui)
    });
    let is_left = shown.should_close();
    (shown.inner, is_left)
}

/// Blocks pointer and keys for the screen while a window of a library is open above it.
pub(crate) fn backdrop(ui: &Ui, name: &str) {
    let area = Modal::default_area(Id::unique(name)).order(Order::Middle);
    let behind = Modal::new(Id::unique(name)).area(area).frame(Frame::NONE);
    behind.show(ui.ctx(), |_| ());
}

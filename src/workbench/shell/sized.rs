//! Panels whose size is set only by the operator, not by their content.

use egui::{Panel, Rangef, Ui, UiBuilder};

#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// Chosen or initial size (points).
    pub wanted: f32,
    /// Smallest and largest size that fits (points).
    pub range: Rangef,
}

impl Size {
    fn now(self) -> f32 {
        self.wanted.clamp(self.range.min, self.range.max)
    }
}

/// Draws a panel of this size; returns a new size when the operator has dragged its edge and released it. `along` is 0
/// for a side panel, 1 for a bottom panel.
pub fn sized(
    ui: &mut Ui,
    panel: Panel,
    size: Size,
    along: usize,
    add: impl FnOnce(&mut Ui),
) -> Option<f32> {
    let now = size.now();
    let pointer = |ui: &Ui| ui.input(|i| (i.pointer.any_down(), i.pointer.any_released()));
    let (is_down, is_released) = pointer(ui);
    // Only a drag changes the size; a limit by a small window is temporary.
    let range = if is_down || is_released {
        size.range
    } else {
        Rangef::point(now)
    };
    let shown = panel.default_size(now).size_range(range).show(ui, |ui| {
        let rect = ui.available_rect_before_wrap();
        let mut inner = ui.new_child(UiBuilder::new().max_rect(rect));
        inner.shrink_clip_rect(rect.expand(2.0));
        add(&mut inner);
        ui.advance_cursor_after_rect(rect);
    });
    let dragged = shown.response.rect.size()[along];
    (is_released && (dragged - now).abs() > 1.0).then_some(dragged)
}

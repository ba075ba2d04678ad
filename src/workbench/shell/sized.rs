//! Panels whose size is chosen by the operator alone, never by what they hold.

use egui::{Panel, Rangef, Ui, UiBuilder};

#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// As it was chosen, or to begin with (points).
    pub wanted: f32,
    /// Least and largest that there is room for (points).
    pub range: Rangef,
}

impl Size {
    fn now(self) -> f32 {
        self.wanted.clamp(self.range.min, self.range.max)
    }
}

/// Draws what belongs into a panel of this size; gives the size that the operator has dragged it to, once it is let go.
/// `along` is 0 for a panel at the side, 1 for one at the bottom.
pub fn sized(
    ui: &mut Ui,
    panel: Panel,
    (size, along): (Size, usize),
    add: impl FnOnce(&mut Ui),
) -> Option<f32> {
    let now = size.now();
    let pointer = |ui: &Ui| ui.input(|i| (i.pointer.any_down(), i.pointer.any_released()));
    let (is_down, is_released) = pointer(ui);
    // Only a drag changes it: what was measured for a smaller window is not kept.
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

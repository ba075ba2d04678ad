//! The frame of a panel beside others.

use egui::{Frame, Margin, Ui};

use crate::theme::{self, GRID};

/// Fill and margin of a panel.
pub fn panel_frame(ui: &Ui) -> Frame {
    Frame::new()
        .fill(theme::of(ui).panel)
        .inner_margin(Margin::same(3 * GRID as i8))
}

//! Export of the 3D view with its annotations, to the clipboard or a file.

use std::sync::Arc;

use egui::mutex::Mutex;
use egui::{ColorImage, Context, Pos2, Rect, vec2};

/// Destination of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    Clipboard,
    File,
}

/// Requested picture, once received.
#[derive(Default)]
pub(super) struct PictureRequest {
    received: Arc<Mutex<Option<(Target, ColorImage)>>>,
}

impl PictureRequest {
    /// Requests the picture in `rect`; it is taken after this frame, when the menu is closed.
    pub(super) fn send(&self, context: &Context, rect: Rect, target: Target) {
        let (received, repainted) = (Arc::clone(&self.received), context.clone());
        context.request_screenshot(move |window| {
            let scale = repainted.pixels_per_point();
            let [width, height] = window.size.map(|side| side as f32 / scale);
            let whole = Rect::from_min_size(Pos2::ZERO, vec2(width, height));
            let picture = window.region(&rect.intersect(whole), Some(scale));
            *received.lock() = Some((target, picture));
            repainted.request_repaint();
        });
        context.request_repaint();
    }

    /// Copies a received picture to the clipboard, or returns it to be saved.
    pub(super) fn receive(&self, context: &Context) -> Option<Arc<ColorImage>> {
        let (target, picture) = self.received.lock().take()?;
        if target == Target::File {
            return Some(Arc::new(picture));
        }
        context.copy_image(picture);
        None
    }
}

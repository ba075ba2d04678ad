//! Canvas of the 3D view: pointer, keys, painting.

use std::sync::Arc;

use eframe::egui_glow::CallbackFn;
use egui::mutex::Mutex;
use egui::{Key, PointerButton, Rect, Response, Ui};
use tautline_core::geometry::Vec3;

use super::camera::{Camera, StandardView};
use super::drawing::Drawing;
use super::framebuffer::PixelBox;
use super::gpu::{Gpu, PictureKey};
use super::overlay::Overlay;
use super::picking::{Pickable, Picture};
use super::toolbar::CameraRequest;
use crate::model::Selection;
use crate::theme;

/// Drag distance equivalent to an arrow key (points).
const ARROW: f64 = 12.0;
/// Logarithm of the magnification per point of scrolling.
const ZOOM_RATE: f64 = 0.003;

/// Canvas with its resources on the graphics card.
#[derive(Default)]
pub struct Canvas {
    gpu: Arc<Mutex<Gpu>>,
}

impl Canvas {
    /// Number of renderings of the picture; copies do not count.
    #[must_use]
    pub fn draws(&self) -> u64 {
        self.gpu.lock().draws()
    }

    /// Whether a software renderer is used; known after the first rendering.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.gpu.lock().is_software()
    }

    /// Frees resources on the graphics card, while its context is current.
    pub fn destroy(&self) {
        self.gpu.lock().destroy();
    }

    /// Paints drawing number `number` into `rect` with its annotations; `moves` tells that the camera moves.
    pub fn paint(
        &self,
        ui: &Ui,
        rect: Rect,
        drawing: &Arc<Drawing>,
        moves: bool,
        picture: &Picture<'_>,
        hovered: Selection,
    ) {
        let palette = theme::of(ui);
        let painter = ui.painter_at(rect);
        if let Some(failure) = self.gpu.lock().failure() {
            let text = format!("The robot cannot be drawn in 3D: {failure}");
            let font = egui::FontId::proportional(13.0);
            let galley = painter.layout(text, font, palette.text, 0.8 * rect.width());
            let at = rect.center() - galley.size() / 2.0;
            painter.galley(at, galley, palette.text);
            return;
        }
        let scale = ui.pixels_per_point();
        painter.add(self.callback(rect, drawing, moves, picture.camera, scale));
        let overlay = Overlay {
            painter: &painter,
            rect,
            picture,
            palette,
        };
        overlay.paint(hovered);
    }

    fn callback(
        &self,
        rect: Rect,
        drawing: &Arc<Drawing>,
        moves: bool,
        camera: &Camera,
        scale: f32,
    ) -> egui::PaintCallback {
        let (gpu, drawing, camera) = (Arc::clone(&self.gpu), Arc::clone(drawing), *camera);
        let paint = CallbackFn::new(move |info, painter| {
            let part = |part: egui::epaint::ViewportInPixels| PixelBox {
                left: part.left_px,
                bottom: part.from_bottom_px,
                width: part.width_px,
                height: part.height_px,
            };
            let (place, clip) = (
                part(info.viewport_in_pixels()),
                part(info.clip_rect_in_pixels()),
            );
            let key = PictureKey {
                drawing: drawing.number,
                camera,
                size: [place.width, place.height].map(|side| side.max(1).unsigned_abs()),
                scale,
                moves,
            };
            gpu.lock().paint(painter.gl(), &drawing, key, [place, clip]);
        });
        egui::PaintCallback {
            rect,
            callback: Arc::new(paint),
        }
    }
}

/// Position in the picture where a drag begins or a zoom applies (points of the screen).
pub fn takes_hold(ui: &Ui, response: &Response) -> Option<[f64; 2]> {
    let begins = response.drag_started();
    let zooms = response.hovered() && zoom_factor(ui) != 1.0;
    let pointer = if begins {
        // The pointer has moved since it was pressed.
        ui.input(|input| input.pointer.press_origin())
    } else {
        response.hover_pos()
    };
    let at = pointer.filter(|_| begins || zooms)? - response.rect.min;
    Some([at.x, at.y].map(f64::from))
}

/// Zoom factor of wheel and pinch gesture in this frame.
fn zoom_factor(ui: &Ui) -> f64 {
    let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
    (f64::from(scroll) * ZOOM_RATE).exp() * f64::from(pinch)
}

/// Orbits about the point where the drag began, pans, and zooms towards the point under the pointer (m).
pub fn steer(
    ui: &Ui,
    response: &Response,
    camera: &mut Camera,
    pivot: Option<Vec3>,
    under: Option<Vec3>,
) {
    let rect = response.rect;
    let aspect = f64::from(rect.aspect_ratio());
    let drag = response.drag_delta();
    let (right, down) = (f64::from(drag.x), f64::from(drag.y));
    let shifts = ui.input(|input| input.modifiers.shift);
    if response.dragged_by(PointerButton::Primary) && !shifts {
        if drag != egui::Vec2::ZERO {
            camera.orbit(right, down, pivot);
        }
    } else if response.dragged() {
        let height = f64::from(rect.height());
        camera.pan(right / height, down / height);
    }
    if let Some(pointer) = response.hover_pos() {
        let factor = zoom_factor(ui);
        if factor != 1.0 {
            let at = (pointer - rect.min) / rect.size();
            camera.zoom(factor, (f64::from(at.x), f64::from(at.y)), aspect, under);
        }
    }
    if response.has_focus() {
        arrows(ui, camera, aspect);
    }
}

/// Orbits and zooms with the keys, while the view has the focus.
fn arrows(ui: &Ui, camera: &mut Camera, aspect: f64) {
    let pressed = |key| ui.input(|input| input.key_pressed(key));
    for (key, right, down) in [
        (Key::ArrowLeft, -ARROW, 0.0),
        (Key::ArrowRight, ARROW, 0.0),
        (Key::ArrowUp, 0.0, -ARROW),
        (Key::ArrowDown, 0.0, ARROW),
    ] {
        if pressed(key) {
            camera.orbit(right, down, None);
        }
    }
    for (key, factor) in [
        (Key::Plus, 1.2),
        (Key::Equals, 1.2),
        (Key::Minus, 1.0 / 1.2),
    ] {
        if pressed(key) {
            camera.zoom(factor, (0.5, 0.5), aspect, None);
        }
    }
}

/// Camera movement requested by a key, while the pointer is over the view or it has the focus.
pub fn keys(ui: &Ui, response: &Response) -> Option<CameraRequest> {
    if response.has_focus() {
        let filter = egui::EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            ..Default::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    }
    let elsewhere = ui.egui_wants_keyboard_input() && !response.has_focus();
    if elsewhere || !(response.hovered() || response.has_focus()) {
        return None;
    }
    let aims = [
        (Key::F, CameraRequest::Selected),
        (Key::Home, CameraRequest::All),
        (Key::Num1, CameraRequest::To(StandardView::Front)),
        (Key::Num2, CameraRequest::To(StandardView::Side)),
        (Key::Num3, CameraRequest::To(StandardView::Top)),
        (Key::Num7, CameraRequest::To(StandardView::Isometric)),
    ];
    ui.input(|input| {
        if input.modifiers.shift_only() && input.key_pressed(Key::F) {
            return Some(CameraRequest::Frame);
        }
        let pressed = |key| input.modifiers.is_none() && input.key_pressed(key);
        aims.into_iter()
            .find(|(key, _)| pressed(*key))
            .map(|(_, aim)| aim)
    })
}

/// Object under the pointer.
pub fn under_pointer(response: &Response, picture: &Picture<'_>) -> Option<Pickable> {
    let pointer = response.hover_pos().filter(|_| !response.dragged())?;
    let at = pointer - response.rect.min;
    picture.pick(f64::from(at.x), f64::from(at.y))
}

/// Pulley at a double-click.
pub fn found_pulley(response: &Response, picture: &Picture<'_>) -> Option<usize> {
    let pointer = response.hover_pos().filter(|_| response.double_clicked())?;
    let at = pointer - response.rect.min;
    picture.pulley_near(f64::from(at.x), f64::from(at.y))
}

/// Cable or pose of an object.
pub fn selection_of(thing: Pickable) -> Selection {
    match thing {
        Pickable::Cable(index) | Pickable::Pulley(index) => Selection::cable(index),
        Pickable::Pose(label) => Selection::pose(label),
        Pickable::Platform | Pickable::LaserSpot => Selection::default(),
    }
}

/// Selection after a click on `picked`: a cable and a pose are combined, empty space clears it.
pub fn clicked(picked: Selection, before: Selection) -> Selection {
    if picked.is_empty() {
        return picked;
    }
    Selection {
        cable: picked.cable.or(before.cable),
        pose: picked.pose.or(before.pose),
    }
}

//! Renders the output of the harness, including the 3D view, on OpenGL without a window.

use std::cell::RefCell;
use std::rc::Rc;

use egui::TexturesDelta;
use egui_kittest::{Harness, TestRenderer};
use image::RgbaImage;
use tautline_workbench::shell::App;
use tautline_workbench::views::offscreen::{OffscreenError, OffscreenPainter};

/// The renderer of a harness, and the pictures it makes.
#[derive(Clone)]
pub struct GlowTestRenderer(Rc<RefCell<OffscreenPainter>>);

impl GlowTestRenderer {
    /// A renderer of its own.
    ///
    /// # Errors
    /// If there is no OpenGL.
    pub fn new() -> Result<Self, OffscreenError> {
        let painter = OffscreenPainter::new()?;
        Ok(Self(Rc::new(RefCell::new(painter))))
    }

    /// Picture of the last frame of the harness.
    ///
    /// # Errors
    /// If the driver refuses.
    pub fn picture(&self, harness: &Harness<'_, App>) -> Result<RgbaImage, OffscreenError> {
        let mut painter = self.0.borrow_mut();
        painter.picture(&harness.ctx, harness.output())
    }
}

impl TestRenderer for GlowTestRenderer {
    fn setup_eframe(&self, creation: &mut eframe::CreationContext<'_>, _frame: &mut eframe::Frame) {
        creation.gl = Some(self.0.borrow().headless().gl().clone());
    }

    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let taken = self.0.borrow_mut().take_textures(delta);
        taken.expect("a driver that keeps pictures");
    }
}

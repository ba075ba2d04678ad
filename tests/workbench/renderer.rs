//! Paints what the harness draws, three dimensions included, on OpenGL without a window.

use std::cell::RefCell;
use std::rc::Rc;

use egui::TexturesDelta;
use egui_kittest::{Harness, TestRenderer};
use image::RgbaImage;
use tautline_workbench::app::App;
use tautline_workbench::offscreen::OffscreenPainter;

/// The renderer of a harness, and the pictures it makes.
#[derive(Clone)]
pub struct GlowTestRenderer(Rc<RefCell<OffscreenPainter>>);

impl GlowTestRenderer {
    /// A renderer of its own.
    pub fn new() -> Self {
        let painter = OffscreenPainter::new().expect("OpenGL without a window");
        Self(Rc::new(RefCell::new(painter)))
    }

    /// The picture of what the harness drew last.
    pub fn picture(&self, harness: &Harness<'_, App>) -> RgbaImage {
        let mut painter = self.0.borrow_mut();
        painter
            .picture(&harness.ctx, harness.output())
            .expect("a picture")
    }
}

impl TestRenderer for GlowTestRenderer {
    fn setup_eframe(&self, creation: &mut eframe::CreationContext<'_>, _frame: &mut eframe::Frame) {
        creation.gl = Some(self.0.borrow().headless().gl().clone());
    }

    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        self.0.borrow_mut().take_textures(delta).expect("textures");
    }
}

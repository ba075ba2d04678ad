//! Harness of the workbench.

use egui_kittest::Harness;
pub use tautline_validation::harness::settle;
use tautline_workbench::app::{App, Options};

/// A workbench without a graphics card, of the size of a small notebook's screen.
pub fn workbench() -> Harness<'static, App> {
    Harness::builder()
        .with_size(egui::vec2(1280.0, 800.0))
        .with_max_steps(60)
        .build_eframe(|creation| App::new(creation, Options::default()))
}

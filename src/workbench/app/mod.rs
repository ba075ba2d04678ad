//! The workbench: what it knows, what it can do, and its window.

mod clock;
pub mod command;
pub mod commands;
pub mod document;
pub mod edit;
pub mod fit;
mod frame;
mod memo;
mod menu;
mod messages;
pub mod screen;
mod selection;
pub mod standing;
pub mod state;
pub mod tasks;
pub mod theme;

use std::path::PathBuf;

pub use document::Document;
pub use memo::Memo;
pub use messages::{Message, Messages, Severity};
pub use selection::Selection;
pub use state::State;

use commands::FileCommand;

/// The workbench as eframe runs it.
pub struct App {
    /// Everything it knows.
    pub state: State,
}

impl App {
    /// The workbench in a window; opens `path` if one is given.
    #[must_use]
    pub fn new(creation: &eframe::CreationContext<'_>, path: Option<PathBuf>) -> Self {
        theme::install(&creation.egui_ctx);
        let mut state = State::new(&creation.egui_ctx);
        if let Some(path) = path {
            state.outbox.send(FileCommand::Open(path));
        }
        Self { state }
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        for outcome in self.state.tasks.outcomes() {
            commands::receive(&mut self.state, outcome);
        }
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        for file in dropped {
            self.state
                .outbox
                .send(commands::dropped(file.path().to_path_buf()));
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        frame::show(ui, &mut self.state);
        for command in self.state.outbox.take() {
            commands::perform(&mut self.state, command);
        }
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        self.state.views.destroy();
    }
}

/// Opens the window and runs the workbench until it is closed.
///
/// # Errors
/// If no window can be opened, as without a display.
pub fn run(path: Option<PathBuf>) -> Result<(), eframe::Error> {
    let viewport = egui::ViewportBuilder::default()
        .with_title("Tautline")
        .with_app_id("tautline")
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([1024.0, 680.0]);
    let options = eframe::NativeOptions {
        viewport,
        ..Default::default()
    };
    eframe::run_native(
        "tautline",
        options,
        Box::new(|creation| Ok(Box::new(App::new(creation, path)))),
    )
}

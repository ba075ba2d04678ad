//! The window: menus, phase rail, panels, views, dialogs and status bar around the model, and the loop that runs them.

mod alert;
mod certificate;
mod dialogs;
mod escape;
mod file_chooser;
mod frame;
mod log;
pub mod menu;
mod no_window;
mod observed;
mod palette;
mod rail;
mod report;
mod requests;
mod save;
mod sized;
mod state;
mod status;
mod stop;
mod top;

pub use no_window::no_window;
pub use state::AppState;

use crate::model::command::{CompareCommand, FileCommand, RecordCommand};
use crate::model::link::LinkRequest;
use crate::model::phase::Screen;
use crate::model::{Options, caught_panic};
use crate::{commands, theme};

pub struct App {
    pub state: AppState,
}

impl App {
    /// Creates the application in a window and opens the path of the options.
    #[must_use]
    pub fn new(creation: &eframe::CreationContext<'_>, options: Options) -> Self {
        caught_panic::listen();
        theme::install(&creation.egui_ctx);
        if let Some(path) = &options.observed {
            observed::observe(&creation.egui_ctx, path.clone());
        }
        let mut state = AppState::new(&creation.egui_ctx, options);
        commands::restore(&state.model);
        commands::find_unsaved(&mut state.model);
        if let Some(path) = state.model.options.path.clone() {
            state.outbox.send(FileCommand::Open(path));
        }
        Self { state }
    }
}

impl App {
    /// Asks about unsaved changes and an armed robot before the window is closed.
    fn ask_before_closing(&mut self, ctx: &egui::Context) {
        let AppState { model, outbox, .. } = &mut self.state;
        let is_asked = model.is_unsaved() || model.would_disarm() || model.hypothesis.is_unsaved();
        let has_panicked = model.caught_panic.is_some();
        if is_asked && !has_panicked && ctx.input(|input| input.viewport().close_requested()) {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            outbox.send(FileCommand::Quit);
        }
    }

    /// Draws a frame with `show`, then carries out its commands. After a panic the session remains unchanged and saved
    /// by the autosave; the next frame reports it.
    fn frame(&mut self, ui: &mut egui::Ui, show: impl FnOnce(&mut egui::Ui, &mut AppState)) {
        let state = &mut self.state;
        // First, whatever happens in the frame: a robot may also move during an internal error.
        stop::show(ui, &mut state.model);
        if state.model.caught_panic.is_some() {
            dialogs::internal_error(ui, &mut state.model);
            return;
        }
        let done = caught_panic::guard(|| {
            show(ui, state);
            for command in state.outbox.take() {
                commands::perform(&mut state.model, command);
            }
            requests::apply(state);
        });
        let model = &mut state.model;
        model.caught_panic = done.err();
        if model.caught_panic.is_some() {
            ui.ctx().request_repaint();
        }
        model.follow_screen();
        model.autosave.follow(model.open.as_ref());
        if let Some(text) = model.session_lock.follow(model.open.as_ref()) {
            model.messages.warning(text);
            if model.session_lock.refusal().is_some() {
                model.link.stop();
                model.link.send(LinkRequest::Disconnect);
            }
        }
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        let AppState { model, outbox, .. } = &mut self.state;
        for outcome in model.tasks.outcomes() {
            let received = caught_panic::guard(|| commands::receive(model, outcome));
            model.caught_panic = received.err().or(model.caught_panic.take());
        }
        for event in model.autosave.events() {
            commands::autosaved(model, event);
        }
        for event in model.link.events() {
            commands::robot::receive(model, event);
        }
        commands::robot::follow(model);
        let is_asked = ctx.memory(|memory| memory.top_modal_layer().is_some());
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        for file in dropped.into_iter().filter(|_| !is_asked) {
            let path = file.path().to_path_buf();
            match model.screen {
                Screen::Compare => outbox.send(CompareCommand::Drop(path)),
                Screen::Simulator => outbox.send(CompareCommand::Simulator(path)),
                Screen::Record => outbox.send(RecordCommand::Open(path)),
                _ => outbox.send(FileCommand::Open(path)),
            }
        }
        requests::apply(&mut self.state);
        self.ask_before_closing(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.frame(ui, frame::show);
    }

    /// Background of all panels: filling each of them takes most of a frame without a graphics card.
    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        self.state.views.destroy();
        self.state.model.autosave.flush();
    }
}

/// Opens the window and runs the workbench until it is closed.
///
/// # Errors
/// If no window can be opened, for example without a display.
pub fn run(start: Options) -> Result<(), eframe::Error> {
    let viewport = egui::ViewportBuilder::default()
        .with_title("Tautline")
        .with_app_id("tautline")
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([640.0, 400.0]);
    let options = eframe::NativeOptions {
        viewport,
        // There are no gradients, and without a graphics card dithering takes a fifth of a frame.
        dithering: false,
        ..Default::default()
    };
    eframe::run_native(
        "tautline",
        options,
        Box::new(|creation| Ok(Box::new(App::new(creation, start)))),
    )
}

#[cfg(test)]
mod tests;

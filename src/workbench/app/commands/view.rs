//! What is shown.

use egui::ThemePreference;

use crate::app::Selection;
use crate::app::screen::Screen;
use crate::app::state::State;

/// Changes what is shown, nothing else.
#[derive(Debug, Clone)]
pub enum ViewCommand {
    /// Goes to a screen.
    Go(Screen),
    /// Selects everywhere.
    Select(Selection),
    /// Dark, light or as the system has it.
    Theme(ThemePreference),
    /// Size of everything; 1 is 100 %.
    Scale(f32),
    /// Shows or hides the command palette.
    Palette(bool),
    /// Shows or hides the log.
    Log(bool),
}

/// Smallest and largest size of everything.
const SCALES: std::ops::RangeInclusive<f32> = 0.75..=2.5;

pub(super) fn perform(state: &mut State, command: ViewCommand) {
    match command {
        ViewCommand::Go(screen) => state.screen = screen,
        ViewCommand::Select(selection) => state.selection = selection,
        ViewCommand::Theme(theme) => state.context.set_theme(theme),
        ViewCommand::Scale(scale) => state
            .context
            .set_zoom_factor(scale.clamp(*SCALES.start(), *SCALES.end())),
        ViewCommand::Palette(open) => state.windows.set_palette(open),
        ViewCommand::Log(open) => state.windows.log = open,
    }
}

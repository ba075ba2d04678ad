//! What is shown.

use egui::ThemePreference;
use tautline_session::Theme;

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
        ViewCommand::Theme(theme) => {
            state.context.set_theme(theme);
            state.change_preferences(|preferences| preferences.theme = stored(theme));
        }
        ViewCommand::Scale(scale) => {
            let scale = scale.clamp(*SCALES.start(), *SCALES.end());
            state.context.set_zoom_factor(scale);
            state.change_preferences(|preferences| preferences.interface_scale = f64::from(scale));
        }
        ViewCommand::Palette(open) => state.windows.set_palette(open),
        ViewCommand::Log(open) => state.windows.log = open,
    }
}

fn stored(theme: ThemePreference) -> Theme {
    match theme {
        ThemePreference::Dark => Theme::Dark,
        ThemePreference::Light => Theme::Light,
        ThemePreference::System => Theme::System,
    }
}

/// Sets what the user has chosen at some earlier time.
pub fn restore(state: &State) {
    let theme = match state.preferences.theme {
        Theme::Dark => ThemePreference::Dark,
        Theme::Light => ThemePreference::Light,
        Theme::System => ThemePreference::System,
    };
    state.context.set_theme(theme);
    state.context.set_zoom_factor(
        (state.preferences.interface_scale as f32).clamp(*SCALES.start(), *SCALES.end()),
    );
}

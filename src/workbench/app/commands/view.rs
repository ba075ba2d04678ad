//! What is shown.

use egui::ThemePreference;
use tautline_session::Theme;

use crate::app::Selection;
use crate::app::screen::Screen;
use crate::app::state::State;
use crate::views::timeline::after;

/// Changes what is shown, nothing else.
#[derive(Debug, Clone)]
pub enum ViewCommand {
    /// Goes to a screen.
    Go(Screen),
    /// Selects everywhere.
    Select(Selection),
    /// Selects another of the measured poses.
    Pose(PoseStep),
    /// Selects a measured pose, and shows it even while the robot is elsewhere.
    Scrub(i64),
    /// Plays the measured poses one after the other, or stops.
    Play(bool),
    /// Draws the robot where it is while something goes on, or at the selected pose.
    Follow(bool),
    /// Dark, light or as the system has it.
    Theme(ThemePreference),
    /// Size of everything; 1 is 100 %.
    Scale(f32),
    /// Shows or hides the command palette.
    Palette(bool),
    /// Shows or hides the log.
    Log(bool),
}

/// From the selected pose to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseStep {
    /// The first that was measured.
    First,
    /// The one before.
    Previous,
    /// The one after.
    Next,
    /// The last that was measured.
    Last,
}

/// Smallest and largest size of everything.
const SCALES: std::ops::RangeInclusive<f32> = 0.75..=2.5;

pub(super) fn perform(state: &mut State, command: ViewCommand) {
    match command {
        ViewCommand::Go(screen) => state.screen = screen,
        ViewCommand::Select(selection) => state.selection = selection,
        ViewCommand::Pose(step) => {
            let labels = state.document.as_ref();
            let labels = labels.map_or(&[][..], |d| &d.session().measurements.labels);
            if let Some(label) = after(labels, state.selection.pose, step) {
                scrub(state, label);
            }
        }
        ViewCommand::Scrub(label) => {
            state.views.timeline.play(false);
            scrub(state, label);
        }
        ViewCommand::Play(plays) => state.views.timeline.play(plays),
        ViewCommand::Follow(follows) => state.views.timeline.follows = follows,
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

/// Shows a measured pose.
fn scrub(state: &mut State, label: i64) {
    state.selection.pose = Some(label);
    state.views.timeline.follows = false;
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

//! What is shown.

use egui::ThemePreference;
use tautline_session::Theme;

use crate::model::command::ViewCommand;
use crate::shell::State;
use crate::views::timeline::after;

/// Smallest and largest size of everything.
const SCALES: std::ops::RangeInclusive<f32> = 0.75..=2.5;

pub(super) fn perform(state: &mut State, command: ViewCommand) {
    match command {
        ViewCommand::Go(screen) => state.model.screen = screen,
        ViewCommand::Select(selection) => state.model.selection = selection,
        ViewCommand::Pose(step) => {
            let labels = state.model.open.as_ref();
            let labels = labels.map_or(&[][..], |d| &d.session().measurements.labels);
            if let Some(label) = after(labels, state.model.selection.pose, step) {
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
            state.model.context.set_theme(theme);
            state
                .model
                .change_preferences(|preferences| preferences.theme = stored(theme));
        }
        ViewCommand::Scale(scale) => {
            let scale = scale.clamp(*SCALES.start(), *SCALES.end());
            state.model.context.set_zoom_factor(scale);
            state
                .model
                .change_preferences(|preferences| preferences.interface_scale = f64::from(scale));
        }
        ViewCommand::Palette(open) => state.model.dialogs.set_palette(open),
        ViewCommand::Log(open) => state.model.dialogs.log = open,
    }
}

/// Shows a measured pose.
fn scrub(state: &mut State, label: i64) {
    state.model.selection.pose = Some(label);
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
    let theme = match state.model.preferences.theme {
        Theme::Dark => ThemePreference::Dark,
        Theme::Light => ThemePreference::Light,
        Theme::System => ThemePreference::System,
    };
    state.model.context.set_theme(theme);
    state.model.context.set_zoom_factor(
        (state.model.preferences.interface_scale as f32).clamp(*SCALES.start(), *SCALES.end()),
    );
}

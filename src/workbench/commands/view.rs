//! View of the window.

use egui::ThemePreference;
use tautline_session::Theme;

use crate::model::command::ViewCommand;
use crate::model::part::ScreenPart;
use crate::model::{Model, Selection, UiRequest};

/// Smallest and largest zoom factor.
const SCALES: std::ops::RangeInclusive<f32> = 0.75..=2.5;

pub(super) fn perform(model: &mut Model, command: ViewCommand) {
    match command {
        ViewCommand::Go(screen) => {
            if model.screen != screen {
                model.inspected = None;
                model.maximised = None;
            }
            model.screen = screen;
        }
        ViewCommand::Select(selection) => {
            // A selected pose is shown even if the robot was stopped elsewhere.
            let is_other = selection.pose.is_some() && selection.pose != model.selection.pose;
            model.playback.follows &= !(is_other && model.link.is_stopped);
            model.selection = selection;
            // The inspector follows the selection.
            if model.inspected.is_some() && selection.cable.is_some() {
                model.inspected = selection.cable;
            }
        }
        ViewCommand::ShowDependence(quantity, cable, variable) => {
            model.selection = cable.map(Selection::cable).unwrap_or_default();
            model.inspected = None;
            show(model, ScreenPart::Plots);
            model.request(UiRequest::ShowDependence(quantity, cable, variable));
        }
        ViewCommand::Inspect(cable) => {
            model.inspected = cable;
            if cable.is_some() {
                show(model, ScreenPart::Robot);
                model.selection.cable = cable;
                model.request(UiRequest::ShowRobot);
            }
        }
        ViewCommand::Pose(step) => {
            let labels = model.open.as_ref();
            let labels = labels.map_or(&[][..], |d| &d.session().measurements.labels);
            if let Some(label) = step.from(labels, model.selection.pose) {
                scrub(model, label);
            }
        }
        ViewCommand::Scrub(label) => {
            model.playback.plays = false;
            scrub(model, label);
        }
        ViewCommand::Play(plays) => model.playback.plays = plays,
        ViewCommand::Follow(follows) => model.playback.follows = follows,
        ViewCommand::Maximise(part) => model.maximised = part,
        ViewCommand::Theme(theme) => {
            model.context.set_theme(theme);
            model.change_preferences(|preferences| preferences.theme = stored(theme));
        }
        ViewCommand::Scale(scale) => {
            let scale = scale.clamp(*SCALES.start(), *SCALES.end());
            model.context.set_zoom_factor(scale);
            model.change_preferences(|preferences| preferences.interface_scale = f64::from(scale));
        }
        ViewCommand::Palette(open) => model.dialogs.set_palette(open),
        ViewCommand::Log(open) => model.dialogs.log = open,
        ViewCommand::Manual(page) => model.dialogs.manual = page,
        ViewCommand::About(open) => model.dialogs.about = open,
        ViewCommand::Dismiss => model.messages.dismiss(),
        ViewCommand::SetPlots(plots) => model.change_preferences(|p| p.plots = plots),
    }
}

/// Ends the maximised view of another part.
fn show(model: &mut Model, part: ScreenPart) {
    model.maximised = model.maximised.filter(|maximised| *maximised == part);
}

/// Selects and shows a measured pose.
fn scrub(model: &mut Model, label: i64) {
    model.selection.pose = Some(label);
    model.playback.follows = false;
}

fn stored(theme: ThemePreference) -> Theme {
    match theme {
        ThemePreference::Dark => Theme::Dark,
        ThemePreference::Light => Theme::Light,
        ThemePreference::System => Theme::System,
    }
}

/// Applies theme and zoom factor of the preferences.
pub fn restore(model: &Model) {
    let theme = match model.preferences.theme {
        Theme::Dark => ThemePreference::Dark,
        Theme::Light => ThemePreference::Light,
        Theme::System => ThemePreference::System,
    };
    model.context.set_theme(theme);
    model.context.set_zoom_factor(
        (model.preferences.interface_scale as f32).clamp(*SCALES.start(), *SCALES.end()),
    );
}

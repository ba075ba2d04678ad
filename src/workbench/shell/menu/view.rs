//! Lines about what is shown.

use egui::{Key, Modifiers, ThemePreference};

use super::super::state::State;
use super::{CONTROL, CONTROL_SHIFT, Item, Menu, item, keys};
use crate::model::command::{PoseStep, ViewCommand};
use crate::model::part::Part;
use crate::model::phase::{Phase, Screen};

pub fn lines(state: &State) -> Vec<Item> {
    let open = state.model.open.is_some();
    let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
    let mut items: Vec<Item> = Phase::ALL
        .iter()
        .zip(digits)
        .map(|(step, digit)| {
            let title = format!("Go to {}. {}", step.number(), step.title());
            item(
                Menu::View,
                title,
                keys(CONTROL, digit),
                open,
                ViewCommand::Go(Screen::Phase(*step)),
            )
        })
        .collect();
    let scale = state.model.context.zoom_factor();
    let is_phase = matches!(state.model.screen, Screen::Phase(_));
    let measured = state
        .model
        .open
        .as_ref()
        .is_some_and(|d| !d.session().measurements.is_empty());
    items.extend([
        item(
            Menu::View,
            "Inspect the pulley of the selected cable",
            None,
            state.model.selection.cable.is_some() && open,
            ViewCommand::Inspect(state.model.selection.cable),
        ),
        item(
            Menu::View,
            "Show the next pose",
            keys(Modifiers::ALT, Key::ArrowRight),
            measured,
            ViewCommand::Pose(PoseStep::Next),
        ),
        item(
            Menu::View,
            "Show the previous pose",
            keys(Modifiers::ALT, Key::ArrowLeft),
            measured,
            ViewCommand::Pose(PoseStep::Previous),
        ),
        item(
            Menu::View,
            "Maximise the 3D view",
            keys(Modifiers::NONE, Key::F7),
            is_phase,
            ViewCommand::Maximise(Some(Part::Robot)),
        ),
        item(
            Menu::View,
            "Maximise the plots",
            keys(Modifiers::NONE, Key::F8),
            is_phase,
            ViewCommand::Maximise(Some(Part::Plots)),
        ),
        item(
            Menu::View,
            "Maximise the panel",
            keys(Modifiers::NONE, Key::F9),
            is_phase,
            ViewCommand::Maximise(Some(Part::Panel)),
        ),
        item(
            Menu::View,
            "Restore panels",
            keys(Modifiers::NONE, Key::F6),
            is_phase && state.model.maximised.is_some(),
            ViewCommand::Maximise(None),
        ),
        item(
            Menu::View,
            "Command palette",
            keys(CONTROL_SHIFT, Key::P),
            true,
            ViewCommand::Palette(true),
        ),
        item(
            Menu::View,
            "Log",
            keys(CONTROL, Key::L),
            true,
            ViewCommand::Log(true),
        ),
        item(
            Menu::View,
            "Zoom in",
            keys(CONTROL, Key::Plus),
            true,
            ViewCommand::Scale(scale + 0.1),
        ),
        item(
            Menu::View,
            "Zoom out",
            keys(CONTROL, Key::Minus),
            true,
            ViewCommand::Scale(scale - 0.1),
        ),
        item(
            Menu::View,
            "Reset zoom",
            keys(CONTROL, Key::Num0),
            true,
            ViewCommand::Scale(1.0),
        ),
        item(
            Menu::View,
            "Dark theme",
            None,
            true,
            ViewCommand::Theme(ThemePreference::Dark),
        ),
        item(
            Menu::View,
            "Light theme",
            None,
            true,
            ViewCommand::Theme(ThemePreference::Light),
        ),
        item(
            Menu::View,
            "System theme",
            None,
            true,
            ViewCommand::Theme(ThemePreference::System),
        ),
    ]);
    items
}

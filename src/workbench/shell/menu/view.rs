//! Lines about what is shown.

use egui::{Key, Modifiers, ThemePreference};

use super::super::state::State;
use super::{CONTROL, CONTROL_SHIFT, Item, Menu, item};
use crate::model::command::{PoseStep, ViewCommand};
use crate::model::part::Part;
use crate::model::phase::{Phase, Screen};

fn view(title: impl Into<String>, command: ViewCommand) -> Item {
    item(Menu::View, title, command)
}

pub fn lines(state: &State) -> Vec<Item> {
    let open = state.model.open.is_some();
    let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
    let mut items: Vec<Item> = Phase::ALL
        .iter()
        .zip(digits)
        .map(|(step, digit)| {
            let title = format!("Go to {}. {}", step.number(), step.title());
            view(title, ViewCommand::Go(Screen::Phase(*step)))
                .keys(CONTROL, digit)
                .when(open)
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
        view(
            "Inspect the pulley of the selected cable",
            ViewCommand::Inspect(state.model.selection.cable),
        )
        .when(state.model.selection.cable.is_some() && open),
        view("Show the next pose", ViewCommand::Pose(PoseStep::Next))
            .keys(Modifiers::ALT, Key::ArrowRight)
            .when(measured),
        view(
            "Show the previous pose",
            ViewCommand::Pose(PoseStep::Previous),
        )
        .keys(Modifiers::ALT, Key::ArrowLeft)
        .when(measured),
        view(
            "Maximise the 3D view",
            ViewCommand::Maximise(Some(Part::Robot)),
        )
        .keys(Modifiers::NONE, Key::F7)
        .when(is_phase),
        view(
            "Maximise the plots",
            ViewCommand::Maximise(Some(Part::Plots)),
        )
        .keys(Modifiers::NONE, Key::F8)
        .when(is_phase),
        view(
            "Maximise the panel",
            ViewCommand::Maximise(Some(Part::Panel)),
        )
        .keys(Modifiers::NONE, Key::F9)
        .when(is_phase),
        view("Restore panels", ViewCommand::Maximise(None))
            .keys(Modifiers::NONE, Key::F6)
            .when(is_phase && state.model.maximised.is_some()),
        view("Command palette", ViewCommand::Palette(true)).keys(CONTROL_SHIFT, Key::P),
        view("Log", ViewCommand::Log(true)).keys(CONTROL, Key::L),
        view("Zoom in", ViewCommand::Scale(scale + 0.1)).keys(CONTROL, Key::Plus),
        view("Zoom out", ViewCommand::Scale(scale - 0.1)).keys(CONTROL, Key::Minus),
        view("Reset zoom", ViewCommand::Scale(1.0)).keys(CONTROL, Key::Num0),
        view("Dark theme", ViewCommand::Theme(ThemePreference::Dark)),
        view("Light theme", ViewCommand::Theme(ThemePreference::Light)),
        view("System theme", ViewCommand::Theme(ThemePreference::System)),
    ]);
    items
}

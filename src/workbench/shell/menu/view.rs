//! Menu items for the view.

use egui::{Key, Modifiers, ThemePreference};

use super::super::state::AppState;
use super::{CONTROL, CONTROL_SHIFT, Menu, MenuItem};
use crate::model::command::{PoseStep, ViewCommand};
use crate::model::part::ScreenPart;
use crate::model::phase::{Phase, Screen};

const DIGITS: [Key; 5] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];

pub fn lines(state: &AppState) -> Vec<MenuItem> {
    let model = &state.model;
    let open = model.open.is_some();
    let view =
        |title: &str, enabled, command: ViewCommand| Menu::View.line(title, enabled, command);
    let phases = Phase::ALL.iter().zip(DIGITS).map(|(step, digit)| {
        let title = format!("Go to {}. {}", step.number(), step.title());
        view(&title, open, ViewCommand::Go(Screen::Phase(*step))).keys(CONTROL, digit)
    });
    let mut items: Vec<MenuItem> = phases.collect();
    let scale = model.context.zoom_factor();
    let is_phase = matches!(model.screen, Screen::Phase(_));
    let is_restorable = is_phase && model.maximised.is_some();
    let measured = model.measured().is_some();
    let cable = model.selection.cable.filter(|_| open);
    let pose = |title, step| view(title, measured, ViewCommand::Pose(step));
    let part = |title, part| view(title, is_phase, ViewCommand::Maximise(Some(part)));
    let zoom = |title, scale| view(title, true, ViewCommand::Scale(scale));
    let theme = |title, theme| view(title, true, ViewCommand::Theme(theme));
    let none = Modifiers::NONE;
    items.extend([
        view(
            "Inspect the pulley of the selected cable",
            cable.is_some(),
            ViewCommand::Inspect(cable),
        )
        .first(),
        pose("Show the next pose", PoseStep::Next).keys(Modifiers::ALT, Key::ArrowRight),
        pose("Show the previous pose", PoseStep::Previous).keys(Modifiers::ALT, Key::ArrowLeft),
        part("Maximise the 3D view", ScreenPart::Robot)
            .keys(none, Key::F7)
            .first(),
        part("Maximise the plots", ScreenPart::Plots).keys(none, Key::F8),
        part("Maximise the panel", ScreenPart::Panel).keys(none, Key::F9),
        view("Restore panels", is_restorable, ViewCommand::Maximise(None)).keys(none, Key::F6),
        view("Command palette", true, ViewCommand::Palette(true))
            .keys(CONTROL_SHIFT, Key::P)
            .first(),
        view("Log", true, ViewCommand::Log(true)).keys(CONTROL, Key::L),
        zoom("Zoom in", scale + 0.1)
            .keys(CONTROL, Key::Plus)
            .first(),
        zoom("Zoom out", scale - 0.1).keys(CONTROL, Key::Minus),
        zoom("Reset zoom", 1.0).keys(CONTROL, Key::Num0),
        theme("Dark theme", ThemePreference::Dark).first(),
        theme("Light theme", ThemePreference::Light),
        theme("System theme", ThemePreference::System),
    ]);
    items
}

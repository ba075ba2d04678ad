//! Table of menu items, shared by menus, shortcuts and the command palette.

mod file;
mod view;

use egui::{Key, KeyboardShortcut, Modifiers};

use super::state::AppState;
use crate::model::command::{
    Command, CompareCommand, DIAGNOSING, FileCommand, HypothesisCommand, IDENTIFYING,
    IdentificationCommand, RecordCommand, RobotCommand, STOP, Setup, ViewCommand,
};
use crate::model::link::LinkRequest;
use crate::model::manual::Page;
use crate::model::next_step;
use crate::model::phase::Screen;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Menu {
    /// Files and the program.
    File,
    /// Undo and redo.
    Edit,
    View,
    /// Computations.
    Model,
    /// The robot and its controller.
    Robot,
    /// The manual.
    Help,
}

impl Menu {
    pub const ALL: [Self; 6] = [
        Self::File,
        Self::Edit,
        Self::View,
        Self::Model,
        Self::Robot,
        Self::Help,
    ];

    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::View => "View",
            Self::Model => "Model",
            Self::Robot => "Robot",
            Self::Help => "Help",
        }
    }
}

#[derive(Debug, Clone)]
pub struct MenuItem {
    pub menu: Menu,
    /// Submenu, if any.
    pub(crate) group: Option<&'static str>,
    pub title: String,
    pub shortcut: Option<KeyboardShortcut>,
    /// Whether the item is available.
    pub enabled: bool,
    /// Whether a separator precedes the item.
    pub(crate) begins: bool,
    pub commands: Vec<Command>,
}

impl MenuItem {
    /// Name that is clear without the menu, for the command palette.
    pub(crate) fn name(&self) -> String {
        match self.group {
            Some(group) => format!("{group}: {}", self.title),
            None => self.title.clone(),
        }
    }

    /// Adds a keyboard shortcut.
    fn keys(self, modifiers: Modifiers, key: Key) -> Self {
        Self {
            shortcut: Some(KeyboardShortcut::new(modifiers, key)),
            ..self
        }
    }

    /// Marks the item as the first of a section.
    fn first(self) -> Self {
        Self {
            begins: true,
            ..self
        }
    }

    fn within(self, group: &'static str) -> Self {
        Self {
            group: Some(group),
            ..self
        }
    }
}

const CONTROL: Modifiers = Modifiers::COMMAND;
const CONTROL_SHIFT: Modifiers = Modifiers {
    shift: true,
    ..Modifiers::COMMAND
};

/// All menu items in the present state of the program.
#[must_use]
pub fn items(state: &AppState) -> Vec<MenuItem> {
    let mut items = file::lines(state);
    items.extend(edit(state));
    items.extend(view::lines(state));
    items.extend(model(state));
    items.extend(robot(state));
    items.extend(help(state));
    items
}

impl Menu {
    /// Item of this menu.
    fn line(
        self,
        title: impl Into<String>,
        enabled: bool,
        command: impl Into<Command>,
    ) -> MenuItem {
        MenuItem {
            menu: self,
            group: None,
            title: title.into(),
            shortcut: None,
            enabled,
            begins: false,
            commands: vec![command.into()],
        }
    }
}

fn help(state: &AppState) -> Vec<MenuItem> {
    let page = Page::of(state.model.screen);
    let manual = |title: &str, page| Menu::Help.line(title, true, ViewCommand::Manual(Some(page)));
    let here = format!("Help on this screen: {}", page.title());
    vec![
        manual("Manual", Page::Start),
        manual(&here, page).keys(Modifiers::NONE, Key::F1),
        manual("What each number means", Page::Numbers),
        Menu::Help
            .line("About Tautline", true, ViewCommand::About(true))
            .first(),
    ]
}

fn edit(state: &AppState) -> Vec<MenuItem> {
    let [undo, redo] = state.model.next_steps();
    let line = |what: &str, name: Option<&str>, command: Command| {
        let title = name.map_or_else(|| what.to_owned(), |name| format!("{what}: {name}"));
        Menu::Edit.line(title, name.is_some(), command)
    };
    vec![
        line("Undo", undo, Command::Undo).keys(CONTROL, Key::Z),
        line("Redo", redo, Command::Redo).keys(CONTROL_SHIFT, Key::Z),
    ]
}

fn model(state: &AppState) -> Vec<MenuItem> {
    let model = &state.model;
    let computing = [IDENTIFYING, DIAGNOSING]
        .iter()
        .any(|title| model.tasks.runs(title));
    let open = model.open.as_ref();
    let measured = model.measured().is_some();
    let has_draft = model.hypothesis.draft.is_some();
    let line = |title: &str, enabled, command: Command| Menu::Model.line(title, enabled, command);
    let compute =
        |title, enabled, command: IdentificationCommand| Menu::Model.line(title, enabled, command);
    let go = |title, screen| Menu::Model.line(title, true, ViewCommand::Go(screen));
    let new = match has_draft {
        false => HypothesisCommand::Show,
        true => HypothesisCommand::New,
    };
    vec![
        next(state),
        compute("Identify", measured, IdentificationCommand::Identify)
            .keys(CONTROL, Key::I)
            .first(),
        compute("Diagnose model", measured, IdentificationCommand::Diagnose).keys(CONTROL, Key::D),
        compute("Cancel computation", computing, IdentificationCommand::Stop),
        line(
            "Compare with a simulator…",
            open.is_some_and(|open| open.fit().is_some()),
            CompareCommand::AskSimulator.into(),
        ),
        line("New hypothesis", true, new.into()).first(),
        line(
            "Show the hypothesis",
            has_draft,
            HypothesisCommand::Show.into(),
        ),
        go("Gallery of effects", Screen::Gallery),
        go("Which sensor?", Screen::WhichSensor),
    ]
}

/// Next step of the phase, as in its footer.
fn next(state: &AppState) -> MenuItem {
    let step = match state.model.screen {
        Screen::Phase(phase) => next_step::of(&state.model, phase, state.panels.measuring.poses),
        _ => None,
    };
    let next = match (step.and_then(|step| step.action), state.model.recoverable()) {
        (Some(action), _) => Some((action.title, action.commands)),
        (None, place) if state.model.screen == Screen::Start => Some(match place {
            Some(place) => (
                "Recover".to_owned(),
                vec![FileCommand::Recover(place).into()],
            ),
            None => (
                "Try the demo robot".to_owned(),
                vec![FileCommand::TryDemo.into()],
            ),
        }),
        (None, _) => None,
    };
    let (title, commands) = match next {
        Some((title, commands)) => (format!("Next: {title}"), commands),
        None => ("Next step".to_owned(), Vec::new()),
    };
    MenuItem {
        menu: Menu::Model,
        group: None,
        title,
        shortcut: Some(next_step::KEYS),
        enabled: !commands.is_empty(),
        begins: false,
        commands,
    }
}

fn robot(state: &AppState) -> Vec<MenuItem> {
    let link = &state.model.link;
    let open = state.model.open.as_ref();
    let (connected, armed) = (link.is_connected(), link.is_armed());
    let leaves = connected && !link.is_busy() || link.lost().is_some();
    let measured = open.is_some_and(|open| open.session().measurements.len() > 1);
    let line = |title, enabled, command: RobotCommand| Menu::Robot.line(title, enabled, command);
    let ask = |title, enabled, request: LinkRequest| Menu::Robot.line(title, enabled, request);
    let stop = MenuItem {
        shortcut: Some(STOP),
        ..line("Stop the robot", connected, RobotCommand::Stop)
    };
    vec![
        line("Connect…", open.is_some(), RobotCommand::Setup(Setup::Open))
            .keys(CONTROL_SHIFT, Key::K),
        ask("Disconnect", leaves, LinkRequest::Disconnect),
        line("Arm the robot", connected && !armed, RobotCommand::Arm).first(),
        ask("Disarm the robot", armed, LinkRequest::Disarm),
        stop,
        Menu::Robot
            .line(
                "Plan a health check",
                measured,
                RecordCommand::PlanCheck(None),
            )
            .first(),
    ]
}

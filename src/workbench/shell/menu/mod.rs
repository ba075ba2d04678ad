//! The table of commands that menus, shortcuts and the command palette share.

mod file;
mod view;

use egui::{Key, KeyboardShortcut, Modifiers};

use super::state::State;
use crate::model::command::{
    Command, DIAGNOSING, HypothesisCommand, IDENTIFYING, IdentificationCommand, RecordCommand,
    RobotCommand, STOP, Setup, ViewCommand,
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
    /// What computes.
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
pub struct Item {
    pub menu: Menu,
    /// The menu below this one in which it is, if any.
    pub(crate) group: Option<&'static str>,
    pub title: String,
    pub shortcut: Option<KeyboardShortcut>,
    /// Whether it can be used now.
    pub enabled: bool,
    pub commands: Vec<Command>,
}

impl Item {
    /// What it does, for those who do not see its menu.
    pub(crate) fn name(&self) -> String {
        match self.group {
            Some(group) => format!("{group}: {}", self.title),
            None => self.title.clone(),
        }
    }

    fn within(self, group: &'static str) -> Self {
        Self {
            group: Some(group),
            ..self
        }
    }

    fn keys(self, modifiers: Modifiers, key: Key) -> Self {
        Self {
            shortcut: Some(KeyboardShortcut::new(modifiers, key)),
            ..self
        }
    }

    /// The same, which can be used where this is so.
    fn when(self, enabled: bool) -> Self {
        Self { enabled, ..self }
    }
}

const CONTROL: Modifiers = Modifiers::COMMAND;
const CONTROL_SHIFT: Modifiers = Modifiers {
    shift: true,
    ..Modifiers::COMMAND
};

/// All lines of all menus, in the state of the program.
#[must_use]
pub fn items(state: &State) -> Vec<Item> {
    let mut items = file::lines(state);
    items.extend(edit(state));
    items.extend(view::lines(state));
    items.extend(model(state));
    items.extend(robot(state));
    items.extend(help(state));
    items
}

/// A line without keys that can be used now.
fn item(menu: Menu, title: impl Into<String>, command: impl Into<Command>) -> Item {
    Item {
        menu,
        group: None,
        title: title.into(),
        shortcut: None,
        enabled: true,
        commands: vec![command.into()],
    }
}

fn help(state: &State) -> Vec<Item> {
    let page = Page::of(state.model.screen);
    vec![
        item(Menu::Help, "Manual", ViewCommand::Manual(Some(Page::Start))),
        item(
            Menu::Help,
            format!("Help on this screen: {}", page.title()),
            ViewCommand::Manual(Some(page)),
        )
        .keys(Modifiers::NONE, Key::F1),
        item(
            Menu::Help,
            "What each number means",
            ViewCommand::Manual(Some(Page::Numbers)),
        ),
        item(Menu::Help, "About Tautline", ViewCommand::About(true)),
    ]
}

fn edit(state: &State) -> Vec<Item> {
    let [undo, redo] = state.model.next_steps();
    let named = |what: &str, name: Option<&str>| {
        name.map_or_else(|| what.to_owned(), |name| format!("{what}: {name}"))
    };
    vec![
        item(Menu::Edit, named("Undo", undo), Command::Undo)
            .keys(CONTROL, Key::Z)
            .when(undo.is_some()),
        item(Menu::Edit, named("Redo", redo), Command::Redo)
            .keys(CONTROL_SHIFT, Key::Z)
            .when(redo.is_some()),
    ]
}

fn model(state: &State) -> Vec<Item> {
    let computing = [IDENTIFYING, DIAGNOSING]
        .iter()
        .any(|title| state.model.tasks.runs(title));
    let measured = state
        .model
        .open
        .as_ref()
        .is_some_and(|d| !d.session().measurements.is_empty());
    let mut items = vec![
        item(Menu::Model, "Identify", IdentificationCommand::Identify)
            .keys(CONTROL, Key::I)
            .when(measured),
        item(
            Menu::Model,
            "Diagnose model",
            IdentificationCommand::Diagnose,
        )
        .keys(CONTROL, Key::D)
        .when(measured),
        item(
            Menu::Model,
            "Cancel computation",
            IdentificationCommand::Stop,
        )
        .when(computing),
        item(
            Menu::Model,
            "New hypothesis",
            match state.model.hypothesis.draft {
                None => HypothesisCommand::Show,
                Some(_) => HypothesisCommand::New,
            },
        ),
        item(
            Menu::Model,
            "Gallery of effects",
            ViewCommand::Go(Screen::Gallery),
        ),
        item(
            Menu::Model,
            "Which sensor?",
            ViewCommand::Go(Screen::WhichSensor),
        ),
    ];
    if state.model.hypothesis.draft.is_some() {
        let show = item(Menu::Model, "Show the hypothesis", HypothesisCommand::Show);
        items.insert(items.len() - 2, show);
    }
    items.splice(0..0, next(state));
    items
}

/// The one thing to do next, as the foot of the phase has it.
fn next(state: &State) -> Option<Item> {
    let Screen::Phase(phase) = state.model.screen else {
        return None;
    };
    let step = next_step::of(&state.model, phase, state.panels.measuring.poses())?;
    let action = step.action?;
    Some(Item {
        menu: Menu::Model,
        group: None,
        title: format!("Next: {}", action.title),
        shortcut: Some(next_step::KEYS),
        enabled: true,
        commands: action.commands,
    })
}

fn robot(state: &State) -> Vec<Item> {
    let open = state.model.open.is_some();
    let connected = state.model.link.is_connected();
    let lost = state.model.link.lost().is_some();
    let armed = state.model.link.is_armed();
    let busy = state.model.link.is_busy();
    let session = state.model.open.as_ref().map(|open| open.session());
    let measured = session.is_some_and(|session| session.measurements.len() > 1);
    let robot =
        |title: &str, enabled, command: Command| item(Menu::Robot, title, command).when(enabled);
    vec![
        robot("Connect…", open, RobotCommand::Setup(Setup::Open).into())
            .keys(CONTROL_SHIFT, Key::K),
        robot(
            "Disconnect",
            (connected && !busy) || lost,
            LinkRequest::Disconnect.into(),
        ),
        robot(
            "Arm the robot",
            connected && !armed,
            RobotCommand::Arm.into(),
        ),
        robot("Disarm the robot", armed, LinkRequest::Disarm.into()),
        robot("Stop the robot", connected, RobotCommand::Stop.into())
            .keys(STOP.modifiers, STOP.logical_key),
        robot(
            "Plan a health check",
            measured,
            RecordCommand::PlanCheck(None).into(),
        ),
    ]
}

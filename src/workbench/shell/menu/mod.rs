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
}

fn keys(modifiers: Modifiers, key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(modifiers, key))
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

fn item(
    menu: Menu,
    title: impl Into<String>,
    shortcut: Option<KeyboardShortcut>,
    enabled: bool,
    command: impl Into<Command>,
) -> Item {
    Item {
        menu,
        group: None,
        title: title.into(),
        shortcut,
        enabled,
        commands: vec![command.into()],
    }
}

fn help(state: &State) -> Vec<Item> {
    let page = Page::of(state.model.screen);
    vec![
        item(
            Menu::Help,
            "Manual",
            None,
            true,
            ViewCommand::Manual(Some(Page::Start)),
        ),
        item(
            Menu::Help,
            format!("Help on this screen: {}", page.title()),
            keys(Modifiers::NONE, Key::F1),
            true,
            ViewCommand::Manual(Some(page)),
        ),
        item(
            Menu::Help,
            "What each number means",
            None,
            true,
            ViewCommand::Manual(Some(Page::Numbers)),
        ),
        item(
            Menu::Help,
            "About Tautline",
            None,
            true,
            ViewCommand::About(true),
        ),
    ]
}

fn edit(state: &State) -> Vec<Item> {
    let [undo, redo] = state.model.next_steps();
    let named = |what: &str, name: Option<&str>| {
        name.map_or_else(|| what.to_owned(), |name| format!("{what}: {name}"))
    };
    vec![
        item(
            Menu::Edit,
            named("Undo", undo),
            keys(CONTROL, Key::Z),
            undo.is_some(),
            Command::Undo,
        ),
        item(
            Menu::Edit,
            named("Redo", redo),
            keys(CONTROL_SHIFT, Key::Z),
            redo.is_some(),
            Command::Redo,
        ),
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
        item(
            Menu::Model,
            "Identify",
            keys(CONTROL, Key::I),
            measured,
            IdentificationCommand::Identify,
        ),
        item(
            Menu::Model,
            "Diagnose model",
            keys(CONTROL, Key::D),
            measured,
            IdentificationCommand::Diagnose,
        ),
        item(
            Menu::Model,
            "Cancel computation",
            None,
            computing,
            IdentificationCommand::Stop,
        ),
        item(
            Menu::Model,
            "New hypothesis",
            None,
            true,
            match state.model.hypothesis.draft {
                None => HypothesisCommand::Show,
                Some(_) => HypothesisCommand::New,
            },
        ),
        item(
            Menu::Model,
            "Gallery of effects",
            None,
            true,
            ViewCommand::Go(Screen::Gallery),
        ),
        item(
            Menu::Model,
            "Which sensor?",
            None,
            true,
            ViewCommand::Go(Screen::WhichSensor),
        ),
    ];
    if state.model.hypothesis.draft.is_some() {
        let show = item(
            Menu::Model,
            "Show the hypothesis",
            None,
            true,
            HypothesisCommand::Show,
        );
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
        |title: &str, enabled, command: Command| item(Menu::Robot, title, None, enabled, command);
    vec![
        item(
            Menu::Robot,
            "Connect…",
            keys(CONTROL_SHIFT, Key::K),
            open,
            RobotCommand::Setup(Setup::Open),
        ),
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
        item(
            Menu::Robot,
            "Stop the robot",
            Some(STOP),
            connected,
            RobotCommand::Stop,
        ),
        item(
            Menu::Robot,
            "Plan a health check",
            None,
            measured,
            RecordCommand::PlanCheck(None),
        ),
    ]
}

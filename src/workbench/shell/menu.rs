//! The table of commands that menus, shortcuts and the command palette share.

use egui::{Key, KeyboardShortcut, Modifiers, ThemePreference};

use super::state::State;
use crate::model::command::{
    Command, CompareCommand, DIAGNOSING, FileCommand, IDENTIFYING, IdentificationCommand, PoseStep,
    RecordingCommand, ReportCommand, RobotCommand, Setup, ViewCommand,
};
use crate::model::manual::Page;
use crate::model::part::Part;
use crate::model::phase::{Phase, Screen};
use tautline_workflow::report::ReportFormat;
use tautline_workflow::templates::Template;

/// A menu.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Menu {
    /// Files and the program.
    File,
    /// Undo and redo.
    Edit,
    /// What is shown.
    View,
    /// What computes.
    Model,
    /// The robot and its controller.
    Robot,
    /// The manual.
    Help,
}

impl Menu {
    /// All, from the left.
    pub const ALL: [Self; 6] = [
        Self::File,
        Self::Edit,
        Self::View,
        Self::Model,
        Self::Robot,
        Self::Help,
    ];

    /// What the operator reads.
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

/// A line of a menu.
#[derive(Debug, Clone)]
pub struct Item {
    /// Where it is.
    pub menu: Menu,
    /// What the operator reads.
    pub title: String,
    /// Its keys.
    pub shortcut: Option<KeyboardShortcut>,
    /// Whether it can be used now.
    pub enabled: bool,
    /// What it does.
    pub command: Command,
}

fn keys(modifiers: Modifiers, key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(modifiers, key))
}

/// Most sessions that the menu offers to open again.
const RECENT: usize = 5;
/// The key that stops the robot. It is no letter and needs no other key, so that it works whatever has the focus.
pub const STOP: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::F12);

const CONTROL: Modifiers = Modifiers::COMMAND;
const CONTROL_SHIFT: Modifiers = Modifiers {
    shift: true,
    ..Modifiers::COMMAND
};

/// All lines of all menus, in the state of the program.
#[must_use]
pub fn items(state: &State) -> Vec<Item> {
    let mut items = file(state);
    items.extend(edit(state));
    items.extend(view(state));
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
        title: title.into(),
        shortcut,
        enabled,
        command: command.into(),
    }
}

/// Sessions that are offered to be opened again.
fn recent(state: &State) -> Vec<Item> {
    let recent = state.model.preferences.recent().iter();
    recent
        .take(RECENT)
        .map(|session| {
            item(
                Menu::File,
                format!("Open recent: {}", session.name),
                None,
                true,
                FileCommand::Open(session.path().to_owned()),
            )
        })
        .collect()
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

fn file(state: &State) -> Vec<Item> {
    let open = state.model.open.is_some();
    let session = state.model.open.as_ref().map(|open| open.session());
    let measured = session.is_some_and(|session| !session.measurements.is_empty());
    let is_compared = matches!(state.model.comparison.result(), Some(Ok(_)));
    let has_report = match state.model.screen {
        Screen::Compare => is_compared,
        _ => open,
    };
    let mut items = vec![
        item(
            Menu::File,
            "Try the demo robot",
            None,
            true,
            FileCommand::TryDemo,
        ),
        item(
            Menu::File,
            "Open…",
            keys(CONTROL, Key::O),
            true,
            FileCommand::AskOpen,
        ),
        item(Menu::File, "Import…", None, true, RecordingCommand::Show),
    ];
    items.extend(recent(state));
    items.extend([
        item(
            Menu::File,
            "Compare two sessions",
            None,
            true,
            CompareCommand::Show,
        ),
        item(
            Menu::File,
            "Save",
            keys(CONTROL, Key::S),
            open,
            FileCommand::Save,
        ),
        item(
            Menu::File,
            "Save as…",
            keys(CONTROL_SHIFT, Key::S),
            open,
            FileCommand::AskSaveAs,
        ),
        item(
            Menu::File,
            "Save report as HTML…",
            None,
            has_report,
            ReportCommand::AskSave(ReportFormat::Html),
        ),
        item(
            Menu::File,
            "Save report as PDF…",
            None,
            has_report,
            ReportCommand::AskSave(ReportFormat::Pdf),
        ),
        item(
            Menu::File,
            "New series of this session",
            None,
            measured,
            FileCommand::NewSeries,
        ),
        item(
            Menu::File,
            "Close session",
            keys(CONTROL, Key::W),
            open,
            FileCommand::Close,
        ),
        item(
            Menu::File,
            "Quit",
            keys(CONTROL, Key::Q),
            true,
            FileCommand::Quit,
        ),
    ]);
    let new = Template::ALL.map(|template| {
        let title = format!("New robot: {}", template.title().to_lowercase());
        item(Menu::File, title, None, true, FileCommand::New(template))
    });
    items.splice(3..3, new);
    items
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

fn view(state: &State) -> Vec<Item> {
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

fn model(state: &State) -> Vec<Item> {
    let computing = [IDENTIFYING, DIAGNOSING]
        .iter()
        .any(|title| state.model.tasks.runs(title));
    let measured = state
        .model
        .open
        .as_ref()
        .is_some_and(|d| !d.session().measurements.is_empty());
    vec![
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
            "Which sensor?",
            None,
            true,
            ViewCommand::Go(Screen::WhichSensor),
        ),
    ]
}

fn robot(state: &State) -> Vec<Item> {
    let open = state.model.open.is_some();
    let connected = state.model.link.is_connected();
    let lost = state.model.link.lost().is_some();
    let armed = state.model.link.is_armed();
    let busy = state.model.link.is_busy();
    let robot = |title: &str, enabled, command: RobotCommand| {
        item(Menu::Robot, title, None, enabled, command)
    };
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
            RobotCommand::Disconnect,
        ),
        robot("Arm the robot", connected && !armed, RobotCommand::Arm),
        robot("Disarm the robot", armed, RobotCommand::Disarm),
        item(
            Menu::Robot,
            "Stop the robot",
            Some(STOP),
            connected,
            RobotCommand::Stop,
        ),
    ]
}

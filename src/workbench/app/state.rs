//! Everything the program knows; screens and views are functions of it.

use std::path::PathBuf;

use tautline_session::{Folders, LeftBehind, Preferences};

use super::breakdown::Breakdown;
use super::command::Outbox;
use super::commands::{Leaving, SavingReport};
use super::document::Document;
use super::frame::Part;
use super::keeping::Keeping;
use super::messages::Messages;
use super::own_file::OwnFile;
use super::robot::Link;
use super::screen::Screen;
use super::selection::Selection;
use super::tasks::Tasks;
use crate::screens::Screens;
use crate::views::Views;
use crate::views::plots::Panes;

/// How the program was started.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// What to open: a session, a robot or a dataset folder.
    pub path: Option<PathBuf>,
    /// Where preferences and what is not saved yet lie; by default where the system has such things.
    pub folders: Option<Folders>,
    /// Seed of the demonstration, to have the same one again; by default the time.
    pub demo_seed: Option<u64>,
    /// How many times faster than real the simulated robot moves; by default 1.
    pub robot_speed: Option<f64>,
    /// Where to describe what the window shows, for programs that drive it from the outside.
    pub observed: Option<PathBuf>,
}

/// Windows above the screen.
#[derive(Debug, Default)]
pub struct Windows {
    /// What waits for an answer about unsaved changes.
    pub leaving: Option<Leaving>,
    /// The path to save at, while it is asked for.
    pub save_as: Option<String>,
    /// What was typed into the command palette, while it is open.
    pub palette: Option<String>,
    /// What a small window shows.
    pub part: Part,
    /// Whether it is asked for leave to write values that did not converge.
    pub unconverged: bool,
    /// The report that is to be saved, while its place is asked for.
    pub report: Option<SavingReport>,
    /// Whether the log is open.
    pub log: bool,
}

impl Windows {
    /// Opens or closes the command palette.
    pub fn set_palette(&mut self, open: bool) {
        self.palette = open.then(|| self.palette.take().unwrap_or_default());
    }
}

/// Everything the program knows.
pub struct State {
    /// How the program was started.
    pub options: Options,
    /// Where fonts, theme and the window are set.
    pub context: egui::Context,
    /// The open session.
    pub document: Option<Document>,
    /// What the window shows.
    pub screen: Screen,
    /// What is selected, everywhere.
    pub selection: Selection,
    /// What is under the pointer, everywhere.
    pub hovered: Selection,
    /// Keeps commands from the file of the open session while it has unsaved changes.
    pub own_file: OwnFile,
    /// Keeps what is not saved yet.
    pub keeping: Keeping,
    /// Where preferences and what is not saved yet lie.
    pub folders: Folders,
    /// Choices of the user.
    pub preferences: Preferences,
    /// What programs that ended without saving have left behind, once it was looked for.
    pub left_behind: Vec<LeftBehind>,
    /// A panic that was caught, until the operator has seen it.
    pub breakdown: Option<Breakdown>,
    /// Running work.
    pub tasks: Tasks,
    /// The way to the controller.
    pub link: Link,
    /// What the program had to say.
    pub messages: Messages,
    /// Commands that were given in this frame.
    pub outbox: Outbox,
    /// Windows above the screen.
    pub windows: Windows,
    /// What the screens remember.
    pub screens: Screens,
    /// What the views remember.
    pub views: Views,
}

impl State {
    /// The state at the start of the program.
    #[must_use]
    pub fn new(context: &egui::Context, options: Options) -> Self {
        let mut messages = Messages::default();
        let folders = options
            .folders
            .clone()
            .unwrap_or_else(|| folders(&mut messages));
        let preferences = Preferences::load(&folders.preferences());
        for notice in preferences.notices {
            messages.warning(notice);
        }
        let recovery = folders.recovery();
        let views = Views {
            plots: Panes::of(&preferences.value.plots),
            ..Views::default()
        };
        Self {
            keeping: Keeping::new(recovery, context.clone()),
            folders,
            preferences: preferences.value,
            left_behind: Vec::new(),
            breakdown: None,
            link: Link::new(context.clone(), options.robot_speed.unwrap_or(1.0)),
            options,
            context: context.clone(),
            document: None,
            own_file: OwnFile::default(),
            screen: Screen::default(),
            selection: Selection::default(),
            hovered: Selection::default(),
            tasks: Tasks::new(context.clone()),
            messages,
            outbox: Outbox::default(),
            windows: Windows::default(),
            screens: Screens::default(),
            views,
        }
    }
}

impl State {
    /// Changes the choices of the user and writes them down.
    pub fn change_preferences(&mut self, change: impl FnOnce(&mut Preferences)) {
        change(&mut self.preferences);
        if let Err(error) = self.preferences.save(&self.folders.preferences()) {
            self.messages.warning(error.to_string());
        }
    }
}

/// Those of the user, or a temporary place where the system has none.
fn folders(messages: &mut Messages) -> Folders {
    Folders::of_user().unwrap_or_else(|error| {
        messages.warning(format!(
            "{error}; what is not saved is kept in a temporary folder."
        ));
        Folders::below(&std::env::temp_dir().join("tautline"))
    })
}

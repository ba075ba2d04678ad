//! Everything the program knows; screens and views are functions of it.

use std::path::PathBuf;

use super::command::Outbox;
use super::document::Document;
use super::messages::Messages;
use super::screen::Screen;
use super::selection::Selection;
use super::tasks::Tasks;
use crate::screens::Screens;
use crate::views::Views;

/// How the program was started.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// What to open: a session, a robot or a dataset folder.
    pub path: Option<PathBuf>,
    /// Seed of the demonstration, to have the same one again; by default the time.
    pub demo_seed: Option<u64>,
    /// How many times faster than real the simulated robot moves; by default 1.
    pub robot_speed: Option<f64>,
}

/// Windows above the screen.
#[derive(Debug, Default)]
pub struct Windows {
    /// What was typed into the command palette, while it is open.
    pub palette: Option<String>,
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
    /// Running work.
    pub tasks: Tasks,
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
        Self {
            options,
            context: context.clone(),
            document: None,
            screen: Screen::default(),
            selection: Selection::default(),
            hovered: Selection::default(),
            tasks: Tasks::new(context.clone()),
            messages: Messages::default(),
            outbox: Outbox::default(),
            windows: Windows::default(),
            screens: Screens::default(),
            views: Views::default(),
        }
    }
}

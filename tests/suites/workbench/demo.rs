//! The demonstration on a simulated robot whose time runs fast, and how tests drive it.

use std::path::Path;
use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_session::{Folders, Session};
use tautline_validation::support::harness::{connect_and_arm, wait, words};
use tautline_validation::support::keyring::MemoryPasswords;
use tautline_workbench::model::Options;
use tautline_workbench::model::command::Command;
use tautline_workbench::model::command::{FileCommand, RobotCommand, ViewCommand};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::{App, AppState};

/// Time factor of the simulated robot.
const SPEED: f64 = 60.0;

/// A workbench with files in a folder that lives as long as this.
pub struct Bench {
    pub harness: Harness<'static, App>,
    pub folder: tempfile::TempDir,
}

impl Bench {
    /// With the demonstration of a seed.
    pub fn demo(seed: u64) -> Self {
        let mut bench = Self::new(Some(seed));
        bench.give(FileCommand::TryDemo);
        bench.wait("the demonstration", |state| state.model.open.is_some());
        bench
    }

    /// With a session file.
    pub fn of_session(session: &Session) -> Self {
        let mut bench = Self::new(None);
        let path = bench.folder.path().join("session.json");
        tautline_session::write_session(&path, session).expect("written");
        bench.give(FileCommand::Open(path));
        bench.wait("the session", |state| state.model.open.is_some());
        bench
    }

    /// At the start screen.
    pub fn new(demo_seed: Option<u64>) -> Self {
        Self::started_in(tempfile::tempdir().expect("a folder"), demo_seed)
    }

    /// At the start screen, of the user of another window.
    pub fn new_in(user: &Path) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self::of_user(Folders::below(&user.join("user")), folder, (None, SPEED))
    }

    /// At the start screen, where an earlier start may have left files in the folder.
    pub fn started_in(folder: tempfile::TempDir, demo_seed: Option<u64>) -> Self {
        Self::of_user(Self::folders(&folder), folder, (demo_seed, SPEED))
    }

    /// At the start screen, with a simulated robot whose time runs faster by a factor.
    pub fn at_speed(demo_seed: u64, robot_speed: f64) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self::of_user(
            Self::folders(&folder),
            folder,
            (Some(demo_seed), robot_speed),
        )
    }

    fn of_user(
        folders: Folders,
        folder: tempfile::TempDir,
        (demo_seed, robot_speed): (Option<u64>, f64),
    ) -> Self {
        let options = Options {
            folders: Some(folders),
            demo_seed,
            robot_speed: Some(robot_speed),
            diagnosis_limit_s: Some(600.0),
            passwords: Some(Arc::new(MemoryPasswords::default())),
            ..Options::default()
        };
        let harness = Harness::builder()
            .with_size(egui::vec2(1280.0, 2400.0))
            .with_max_steps(60)
            .build_eframe(|creation| App::new(creation, options));
        Self { harness, folder }
    }

    /// Folders of preferences and unsaved sessions.
    pub fn folders(folder: &tempfile::TempDir) -> Folders {
        Folders::below(&folder.path().join("user"))
    }

    pub fn state(&self) -> &AppState {
        &self.harness.state().state
    }

    /// The open session.
    pub fn session(&self) -> &Session {
        let document = self.state().model.open.as_ref();
        document.expect("a session").session()
    }

    /// Gives a command.
    pub fn give(&mut self, command: impl Into<Command>) {
        self.harness.state_mut().state.outbox.send(command);
        self.harness.step();
    }

    /// Goes to a phase.
    pub fn go(&mut self, step: Phase) {
        self.give(ViewCommand::Go(Screen::Phase(step)));
        self.harness.step();
    }

    /// Presses the element with this name.
    pub fn press(&mut self, name: &str) {
        self.harness.step();
        let found = self.harness.query_by_label(name);
        let found = found
            .unwrap_or_else(|| panic!("no {name:?}; the screen says {:?}", words(&self.harness)));
        found.click_accesskit();
        self.harness.step();
        self.harness.step();
    }

    /// Lets the workbench run until its state meets a condition.
    pub fn wait(&mut self, what: &str, reached: impl Fn(&AppState) -> bool) {
        wait(&mut self.harness, what, reached);
    }

    /// Lets the workbench run until no task is running.
    pub fn settle(&mut self, what: &str) {
        self.wait(what, |state| state.model.tasks.running().is_empty());
    }

    /// Enters the name of the operator in the question that is open.
    pub fn name_operator(&mut self, name: &str) {
        let draft = self
            .harness
            .state_mut()
            .state
            .model
            .dialogs
            .writing
            .as_mut();
        name.clone_into(&mut draft.expect("a question").operator);
        self.harness.step();
    }

    /// Writes the identified values in the name of an operator.
    pub fn write_values(&mut self) {
        self.press("Write to the controller");
        self.name_operator("Ada");
        self.press("Write");
        self.wait("the values", |state| !state.model.link.writing);
    }

    /// Connects and arms by the buttons.
    pub fn connect_and_arm(&mut self) {
        connect_and_arm(&mut self.harness);
    }

    /// Plans, measures all poses and gives the number measured.
    pub fn measure(&mut self, poses: usize) -> usize {
        self.go(Phase::Measuring);
        self.give(RobotCommand::Plan(poses));
        self.settle("a plan");
        self.connect_and_arm();
        self.press("Start measuring");
        self.wait("all poses", |state| !state.model.link.is_measuring());
        self.session().measurements.len()
    }
}

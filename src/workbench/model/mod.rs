//! Everything the window knows. It knows nothing of the screens and views that show it: they read it and send commands.

pub(crate) mod autosave;
pub(crate) mod caught_panic;
pub mod command;
pub mod comparison;
pub(crate) mod dialogs;
pub mod edit;
pub(crate) mod findings;
pub(crate) mod fit_progress;
pub mod hypothesis;
pub mod importing;
pub mod link;
pub mod manual;
mod memo;
mod memory;
pub mod messages;
pub mod next_step;
pub mod open_session;
mod out_of_date;
pub mod part;
pub mod phase;
pub mod phase_status;
pub mod plot_preparation;
pub mod record;
mod request;
pub(crate) mod save_form;
mod session_lock;
pub(crate) mod tasks;

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use tautline_link::opcua::PasswordStore;
use tautline_session::{Adjustment, Folders, Preferences, Session, UnsavedSession};

pub use memo::Memo;
pub use open_session::OpenSession;
pub(crate) use out_of_date::out_of_date;
pub use request::{ConnectionRequest, UiRequest};
pub use tautline_workflow::plot::Selection;

use autosave::Autosave;
use caught_panic::CaughtPanic;
use command::{FileCorrection, PlanOutlook};
use comparison::ComparisonState;
use dialogs::Dialogs;
use fit_progress::IdentificationState;
use hypothesis::HypothesisState;
use importing::ImportState;
use link::{Link, LivePlatform};
use messages::Messages;
use phase::{Phase, Screen};
use record::RecordState;
use session_lock::SessionLock;
use tasks::Tasks;
use tautline_workflow::adjusting::{self, Review};
use tautline_workflow::controllers::RobotKind;
use tautline_workflow::diagnosis::TIME_LIMIT_S;
use tautline_workflow::identification::Identification;
use tautline_workflow::sequential::planned_poses;
use tautline_workflow::wording::sentence;

#[derive(Debug, Clone, Default)]
pub struct Options {
    /// What to open: a session, a robot or a dataset folder.
    pub path: Option<PathBuf>,
    /// Where preferences and what is not saved yet lie; by default where the system has such things.
    pub folders: Option<Folders>,
    /// Seed of the demonstration, to have the same one again; by default the time.
    pub demo_seed: Option<u64>,
    /// How many times faster than real the simulated robot moves; by default [`link::SIMULATED_SPEED`].
    pub robot_speed: Option<f64>,
    /// Where to describe what the window shows, for programs that drive it from the outside.
    pub observed: Option<PathBuf>,
    /// Whether files are chosen in a window of the program even where the desktop has dialogs for that.
    pub no_desktop_dialogs: bool,
    /// Longest time of a diagnosis (s); by default [`TIME_LIMIT_S`].
    pub diagnosis_limit_s: Option<f64>,
    /// Where passwords are kept; by default in the keyring of the desktop.
    pub passwords: Option<Arc<dyn PasswordStore>>,
}

/// What is shown of the measured poses and of the robot in motion.
#[derive(Debug)]
pub struct Playback {
    /// Whether the measured poses are played one after the other.
    pub plays: bool,
    /// Draws the moving robot at its present pose instead of the selected one.
    pub follows: bool,
}

/// Draws the robot for a report as PNG, with the coordinates of the pulleys of these indices; or one sentence on why not.
pub type ReportPicture =
    fn(&Session, Option<&Identification>, &BTreeSet<usize>) -> Result<Vec<u8>, String>;

/// Identity and revision of the session with the address of its fit, whether the controller is connected and the version of
/// its parameters.
type ReviewKey = ((u64, u64, usize), (bool, u64));

pub struct Model {
    pub options: Options,
    /// Where fonts, theme and the window are set.
    pub context: egui::Context,
    pub open: Option<OpenSession>,
    /// What the window shows.
    pub screen: Screen,
    /// The screens that led to the present one, itself the last.
    trail: Vec<Screen>,
    pub selection: Selection,
    /// The part of a phase's screen that has the whole window, if one has.
    pub maximised: Option<part::Part>,
    /// The pulley that is inspected, by the index of its cable.
    pub inspected: Option<usize>,
    /// What is shown of the measured poses and of the robot in motion.
    pub playback: Playback,
    /// Present pose of the platform while the views follow it.
    pub live_platform: Option<LivePlatform>,
    /// What accompanies the identification.
    pub identification: IdentificationState,
    /// What to expect of the poses that are planned.
    pub outlook: Option<PlanOutlook>,
    /// Id and revision of the session for which that was checked.
    outlook_checked: Option<(u64, u64)>,
    pub comparison: ComparisonState,
    /// The identified values in a file of a firmware or simulator.
    pub(crate) corrected: Option<FileCorrection>,
    pub record: RecordState,
    pub hypothesis: HypothesisState,
    /// Files of other programs on their way into the session.
    pub importing: ImportState,
    /// Keeps commands from the file of the open session while it has unsaved changes.
    pub session_lock: SessionLock,
    /// Writes unsaved changes to the recovery folder.
    pub autosave: Autosave,
    /// Where preferences and what is not saved yet lie.
    pub folders: Folders,
    pub preferences: Preferences,
    /// Unsaved sessions of programs that ended without saving, once they were looked for.
    pub unsaved_sessions: Vec<UnsavedSession>,
    /// A panic that was caught, until the operator has seen it.
    pub caught_panic: Option<CaughtPanic>,
    /// Running work.
    pub tasks: Tasks,
    pub link: Link,
    review: RefCell<Memo<ReviewKey, Arc<Review>>>,
    pub messages: Messages,
    pub dialogs: Dialogs,
    /// Draws the robot for reports.
    pub report_picture: ReportPicture,
    /// What commands want of panels and views, in order.
    pub(crate) requests: Vec<UiRequest>,
}

impl Model {
    /// The file of a firmware or simulator with the values of the present identification.
    #[must_use]
    pub(crate) fn corrected_file(&self) -> Option<&FileCorrection> {
        let inputs = self.open.as_ref()?.inputs();
        self.corrected.as_ref().filter(|one| one.inputs == inputs)
    }

    /// The model at the start of the program.
    #[must_use]
    pub fn new(context: &egui::Context, options: Options, report_picture: ReportPicture) -> Self {
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
        let windows = recovery.with_file_name("windows");
        Self {
            autosave: Autosave::new(recovery, context.clone()),
            folders,
            preferences: preferences.value,
            unsaved_sessions: Vec::new(),
            caught_panic: None,
            link: Link::new(
                context.clone(),
                options.robot_speed.unwrap_or(link::SIMULATED_SPEED),
            ),
            options,
            context: context.clone(),
            open: None,
            session_lock: SessionLock::new(windows),
            screen: Screen::default(),
            trail: Vec::new(),
            selection: Selection::default(),
            maximised: None,
            inspected: None,
            playback: Playback {
                plays: false,
                follows: true,
            },
            live_platform: None,
            identification: IdentificationState::default(),
            outlook: None,
            outlook_checked: None,
            corrected: None,
            comparison: ComparisonState::default(),
            record: RecordState::default(),
            hypothesis: HypothesisState::default(),
            importing: ImportState::default(),
            tasks: Tasks::new(context.clone()),
            review: RefCell::default(),
            messages,
            dialogs: Dialogs::default(),
            report_picture,
            requests: Vec::new(),
        }
    }
}

impl Model {
    /// Longest time of a diagnosis (s).
    pub(crate) fn diagnosis_limit_s(&self) -> f64 {
        self.options.diagnosis_limit_s.unwrap_or(TIME_LIMIT_S)
    }

    /// Asks something of panels and views.
    pub fn request(&mut self, request: UiRequest) {
        self.requests.push(request);
    }

    /// Takes what was asked of panels and views since the last call.
    pub fn take_requests(&mut self) -> Vec<UiRequest> {
        std::mem::take(&mut self.requests)
    }

    /// Forgets what was expected of another plan than the session has now.
    pub fn check_outlook(&mut self) {
        let key = self.open.as_ref().map(|open| (open.id(), open.revision()));
        if key != self.outlook_checked {
            self.outlook_checked = key;
            let open = self.open.as_ref();
            self.outlook
                .take_if(|outlook| open.is_none_or(|open| !outlook.is_of(open)));
        }
    }

    /// Values in the controller, or those that the session recorded while it is not connected, beside the identified ones;
    /// empty without an identification that is up to date. Computed again only after a change.
    pub fn review(&self) -> Arc<Review> {
        let open = self.open.as_ref().filter(|open| open.fit_is_current());
        let Some((open, fit)) = open.and_then(|open| Some((open, open.fit()?))) else {
            return Arc::default();
        };
        let is_connected = self.link.is_connected();
        let key = (
            (open.id(), open.revision(), Arc::as_ptr(fit) as usize),
            (is_connected, self.link.parameters_version),
        );
        let computed = || match is_connected {
            true => Review::of(&self.link.parameters, fit),
            false => Review::recorded(open.session(), fit),
        };
        let mut review = self.review.borrow_mut();
        Arc::clone(review.get(key, || Arc::new(computed())))
    }

    /// Whether the open session has changes that no file has yet.
    pub(crate) fn is_unsaved(&self) -> bool {
        self.open.as_ref().is_some_and(OpenSession::is_unsaved)
    }

    /// Whether the end of the connection would disarm a controller of the open session.
    pub(crate) fn would_disarm(&self) -> bool {
        self.open.is_some() && self.link.can_move()
    }

    /// Why nothing may move and nothing else may be written, if so: one sentence.
    #[must_use]
    pub fn unsettled(&self) -> Option<String> {
        let why = adjusting::unsettled(self.open.as_ref()?.session())?;
        Some(sentence(&format!(
            "{why}: connect and arm the controller, which settles it."
        )))
    }

    /// Why no pose can be decided on, where that is asked for: one sentence.
    #[must_use]
    pub fn undecidable(&self) -> Option<&'static str> {
        let session = self.open.as_ref()?.session();
        let until = &session.settings.until;
        let kind = self
            .link
            .connected
            .as_ref()
            .map(|connected| connected.rig.kind);
        if !until.enabled {
            None
        } else if until.goals.is_empty() {
            Some("Choose at least one goal.")
        } else if until.only_planned && planned_poses(session).is_empty() {
            Some("Plan poses, or let any pose of the workspace be measured.")
        } else if kind == Some(RobotKind::Recording) {
            Some("A recording cannot go to other poses than its own.")
        } else {
            None
        }
    }

    /// The last adjustment, if it can be taken back.
    #[must_use]
    pub fn revertible(&self) -> Option<&Adjustment> {
        adjusting::revertible(self.open.as_ref()?.session())
    }

    /// Whether what is connected, if anything, is the simulated robot of the session.
    #[must_use]
    pub fn is_true_to_session(&self) -> bool {
        let connected = self.link.connected.as_ref();
        connected.is_none_or(|connected| connected.rig.kind == RobotKind::OfSession)
    }

    /// The place of the first session that can be recovered.
    #[must_use]
    pub fn recoverable(&self) -> Option<usize> {
        let mut left = self.unsaved_sessions.iter();
        left.position(|session| session.problem.is_none())
    }

    /// The screen from which the present one was reached.
    pub(crate) fn previous_screen(&self) -> Screen {
        if let [.., previous, _] = *self.trail {
            return previous;
        }
        match &self.open {
            Some(open) if open.session().measurements.is_empty() => Screen::Phase(Phase::Measuring),
            Some(_) => Screen::Phase(Phase::Identification),
            None => Screen::Start,
        }
    }

    /// Keeps how the present screen was reached. What was said on another one is in the log only.
    pub(crate) fn follow_screen(&mut self) {
        let is_phase = matches!(self.screen, Screen::Phase(_));
        let before = self.trail.last();
        if before != Some(&self.screen) {
            if !is_phase || !matches!(before, Some(Screen::Phase(_))) {
                self.messages.leave();
            }
            if is_phase || self.screen == Screen::Start {
                self.trail.clear();
            }
            let known = self.trail.iter().position(|screen| *screen == self.screen);
            self.trail.truncate(known.unwrap_or(self.trail.len()));
            self.trail.push(self.screen);
        }
        self.messages.mark();
    }

    /// Names of what undo would undo and redo would do again: changes of the recipe while files are imported, else edits.
    #[must_use]
    pub fn next_steps(&self) -> [Option<&str>; 2] {
        // Undo and redo are left to the text that is typed there.
        if self.screen == Screen::Hypothesis {
            return [None, None];
        }
        let importing = self.importing.open.as_ref();
        let draft = importing.filter(|_| self.screen == Screen::Import);
        let history = self.open.as_ref().map(OpenSession::history);
        let draft = draft.map(|open| [open.draft.next_undo(), open.draft.next_redo()]);
        let edits = history.map(|history| [history.next_undo(), history.next_redo()]);
        let [draft, edits] = [draft, edits].map(Option::unwrap_or_default);
        [draft[0].or(edits[0]), draft[1].or(edits[1])]
    }

    /// Changes the choices of the user and writes them down.
    pub fn change_preferences(&mut self, change: impl FnOnce(&mut Preferences)) {
        change(&mut self.preferences);
        if let Err(error) = self.preferences.save(&self.folders.preferences()) {
            self.messages.warning(error.to_string());
        }
    }
}

/// The folders of the user, or temporary ones where the system has none.
fn folders(messages: &mut Messages) -> Folders {
    Folders::of_user().unwrap_or_else(|error| {
        messages.warning(format!(
            "{error}; what is not saved is kept in a temporary folder."
        ));
        Folders::below(&std::env::temp_dir().join("tautline"))
    })
}

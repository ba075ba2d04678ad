//! State of the application. It does not depend on screens and views: they read it and send commands.

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
    /// Session, robot or dataset folder to open.
    pub path: Option<PathBuf>,
    /// Folders of preferences and unsaved sessions; by default those of the system.
    pub folders: Option<Folders>,
    /// Seed of the demonstration, to repeat it; by default the time.
    pub demo_seed: Option<u64>,
    /// Time factor of the simulated robot; by default [`link::SIMULATED_SPEED`].
    pub robot_speed: Option<f64>,
    /// File that describes the content of the window, for programs that operate it from outside.
    pub observed: Option<PathBuf>,
    /// Whether the program's own file chooser is used even if the desktop has one.
    pub no_desktop_dialogs: bool,
    /// Longest time of a diagnosis (s); by default [`TIME_LIMIT_S`].
    pub diagnosis_limit_s: Option<f64>,
    /// Store of passwords; by default the keyring of the desktop.
    pub passwords: Option<Arc<dyn PasswordStore>>,
}

/// Playback of the measured poses, and view of the moving robot.
#[derive(Debug)]
pub struct Playback {
    /// Whether the measured poses are being played back.
    pub plays: bool,
    /// Whether the moving robot is drawn at its live pose instead of the selected one.
    pub follows: bool,
}

/// Renders the robot for a report as PNG, with the coordinates of the pulleys of these indices; or an error message.
pub type ReportPicture =
    fn(&Session, Option<&Identification>, &BTreeSet<usize>) -> Result<Vec<u8>, String>;

/// Id and revision of the session and the address of its fit; connection state of the controller and version of its
/// parameters.
type ReviewKey = ((u64, u64, usize), (bool, u64));

pub struct Model {
    pub options: Options,
    /// Context of egui, which holds fonts, theme and window.
    pub context: egui::Context,
    pub open: Option<OpenSession>,
    /// Current screen.
    pub screen: Screen,
    /// Screens that led to the current one, which is the last.
    trail: Vec<Screen>,
    pub selection: Selection,
    /// Maximised part of a phase's screen, if any.
    pub maximised: Option<part::ScreenPart>,
    /// Inspected pulley, by the index of its cable.
    pub inspected: Option<usize>,
    /// Playback of the measured poses, and view of the moving robot.
    pub playback: Playback,
    /// Live platform while the views follow it.
    pub live_platform: Option<LivePlatform>,
    pub identification: IdentificationState,
    /// Predicted accuracy of the planned poses.
    pub outlook: Option<PlanOutlook>,
    /// Id and revision of the session for which the prediction was last checked.
    outlook_checked: Option<(u64, u64)>,
    pub comparison: ComparisonState,
    /// Correction of a firmware or simulator file.
    pub(crate) corrected: Option<FileCorrection>,
    pub record: RecordState,
    pub hypothesis: HypothesisState,
    /// Import of files of other programs.
    pub importing: ImportState,
    /// Keeps command-line programs away from the session file while there are unsaved changes.
    pub session_lock: SessionLock,
    /// Writes unsaved changes to the recovery folder.
    pub autosave: Autosave,
    /// Folders of preferences and unsaved sessions.
    pub folders: Folders,
    pub preferences: Preferences,
    /// Unsaved sessions of programs that ended without saving, once found.
    pub unsaved_sessions: Vec<UnsavedSession>,
    /// Last caught panic, until it is dismissed.
    pub caught_panic: Option<CaughtPanic>,
    /// Running tasks.
    pub tasks: Tasks,
    pub link: Link,
    review: RefCell<Memo<ReviewKey, Arc<Review>>>,
    pub messages: Messages,
    pub dialogs: Dialogs,
    /// Renders the robot for reports.
    pub report_picture: ReportPicture,
    /// Requests to panels and views, in order.
    pub(crate) requests: Vec<UiRequest>,
}

impl Model {
    /// Correction of a firmware or simulator file by the present identification.
    #[must_use]
    pub(crate) fn corrected_file(&self) -> Option<&FileCorrection> {
        let inputs = self.open.as_ref()?.inputs();
        self.corrected.as_ref().filter(|one| one.inputs == inputs)
    }

    /// State at the start of the program.
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

    /// Sends a request to panels and views.
    pub fn request(&mut self, request: UiRequest) {
        self.requests.push(request);
    }

    /// Removes and returns the requests.
    pub fn take_requests(&mut self) -> Vec<UiRequest> {
        std::mem::take(&mut self.requests)
    }

    /// Drops the predicted accuracy if it belongs to another plan.
    pub fn check_outlook(&mut self) {
        let key = self.open.as_ref().map(|open| (open.id(), open.revision()));
        if key != self.outlook_checked {
            self.outlook_checked = key;
            let open = self.open.as_ref();
            self.outlook
                .take_if(|outlook| open.is_none_or(|open| !outlook.is_of(open)));
        }
    }

    /// Controller values, or without a connection those recorded in the session, beside the identified ones; empty
    /// without a current identification. Recomputed only after a change.
    pub fn review(&self) -> Arc<Review> {
        let open = self.open.as_ref();
        let Some((open, fit)) = open.and_then(|open| Some((open, open.current_fit()?))) else {
            return Arc::default();
        };
        let is_connected = self.link.is_connected();
        let key = (
            (open.id(), open.revision(), Arc::as_ptr(fit) as usize),
            (is_connected, self.link.parameters_version),
        );
        let computed = || match is_connected {
            true => Review::of(&self.link.parameters, &fit.model, Some(&fit.solution)),
            false => Review::recorded(open.session(), fit),
        };
        let mut review = self.review.borrow_mut();
        Arc::clone(review.get(key, || Arc::new(computed())))
    }

    /// Whether the open session has unsaved changes.
    pub(crate) fn is_unsaved(&self) -> bool {
        self.open.as_ref().is_some_and(OpenSession::is_unsaved)
    }

    /// Whether disconnecting could interrupt a motion or disarm the controller of the open session.
    pub(crate) fn would_disarm(&self) -> bool {
        self.open.is_some() && self.link.can_move()
    }

    /// Reason why motion and writing are locked after an interrupted write, if so, as a sentence.
    #[must_use]
    pub fn unsettled(&self) -> Option<String> {
        let why = adjusting::unsettled(self.open.as_ref()?.session())?;
        Some(sentence(&format!(
            "{why}: connect and arm the controller, which settles it."
        )))
    }

    /// Reason why poses cannot be chosen one by one, if this is enabled, as a sentence.
    #[must_use]
    pub fn undecidable(&self) -> Option<&'static str> {
        let session = self.open.as_ref()?.session();
        let until = &session.settings.until;
        if !until.enabled {
            None
        } else if until.goals.is_empty() {
            Some("Choose at least one goal.")
        } else if until.only_planned && planned_poses(session).is_empty() {
            Some("Plan poses, or let any pose of the workspace be measured.")
        } else if self.robot_kind() == Some(RobotKind::Recording) {
            Some("A recording cannot go to other poses than its own.")
        } else {
            None
        }
    }

    /// Kind of the connected robot.
    #[must_use]
    pub fn robot_kind(&self) -> Option<RobotKind> {
        self.link.connected.as_ref().map(|one| one.rig.kind)
    }

    /// Open session, if it has measured poses.
    #[must_use]
    pub fn measured(&self) -> Option<&OpenSession> {
        let open = self.open.as_ref();
        open.filter(|open| !open.session().measurements.is_empty())
    }

    /// Last adjustment, if it can be rolled back.
    #[must_use]
    pub fn revertible(&self) -> Option<&Adjustment> {
        adjusting::revertible(self.open.as_ref()?.session())
    }

    /// Whether no robot is connected, or the one that the session simulates.
    #[must_use]
    pub fn is_true_to_session(&self) -> bool {
        self.robot_kind()
            .is_none_or(|kind| kind == RobotKind::OfSession)
    }

    /// Index of the first session that can be recovered.
    #[must_use]
    pub fn recoverable(&self) -> Option<usize> {
        let mut left = self.unsaved_sessions.iter();
        left.position(|session| session.problem.is_none())
    }

    /// Screen before the present one.
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

    /// Records the path to the present screen. Messages of another screen remain only in the log.
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

    /// Names of the next undo and redo step: of the recipe during an import, otherwise of the session.
    #[must_use]
    pub fn next_steps(&self) -> [Option<&str>; 2] {
        // There, undo and redo belong to the text editor.
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

    /// Changes the preferences and saves them.
    pub fn change_preferences(&mut self, change: impl FnOnce(&mut Preferences)) {
        change(&mut self.preferences);
        if let Err(error) = self.preferences.save(&self.folders.preferences()) {
            self.messages.warning(error.to_string());
        }
    }
}

/// Folders of the user, or temporary ones if the system has none.
fn folders(messages: &mut Messages) -> Folders {
    Folders::of_user().unwrap_or_else(|error| {
        messages.warning(format!(
            "{error}; unsaved sessions are kept in a temporary folder."
        ));
        Folders::below(&std::env::temp_dir().join("tautline"))
    })
}

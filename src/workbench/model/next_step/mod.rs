//! What is done in a phase, the one thing to do next, and what comes after it.

mod adjustment;
mod checklist;
mod identification;
mod measuring;

pub use checklist::{Check, CheckState, Item, checklist};

use egui::{Key, KeyboardShortcut, Modifiers};
use tautline_session::Session;
use tautline_workflow::controllers::Kind;

use super::command::{Command, IdentificationCommand, RobotCommand, Setup, ViewCommand};
use super::edit::Edit;
use super::phase::{Phase, PhaseStatus, Progress, Screen};
use super::{Model, OpenSession, phase_status};
use tautline_workflow::wording::{count, sentence};

/// The keys that do it.
pub const KEYS: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Enter);

/// What the foot of a phase shows.
#[derive(Debug, Clone)]
pub struct NextStep {
    /// How far the phase is.
    pub progress: Progress,
    /// State of the phase in a sentence.
    pub done: String,
    /// Completed share of the current operation, from 0 to 1.
    pub share: Option<f32>,
    /// The one thing to do next, if there is one.
    pub action: Option<Action>,
    /// What comes after it, as a sentence; or what to do where no button can do it.
    pub then: String,
}

/// Something to do, with a button that does it.
#[derive(Debug, Clone)]
pub struct Action {
    /// Text of the button.
    pub title: String,
    pub commands: Vec<Command>,
}

impl Action {
    fn new(title: impl Into<String>, command: impl Into<Command>) -> Self {
        Self {
            title: title.into(),
            commands: vec![command.into()],
        }
    }

    /// The same in another phase, to which it goes first.
    fn in_phase(mut self, phase: Phase) -> Self {
        let go = ViewCommand::Go(Screen::Phase(phase));
        self.commands.insert(0, go.into());
        self
    }

    fn go(phase: Phase) -> Self {
        let title = format!("Go to {}", phase.title().to_lowercase());
        let go = ViewCommand::Go(Screen::Phase(phase));
        Self::new(title, go)
    }
}

impl NextStep {
    fn new(status: PhaseStatus, action: Option<Action>, then: impl Into<String>) -> Self {
        Self {
            progress: status.progress,
            done: sentence(&status.line),
            share: None,
            action,
            then: then.into(),
        }
    }

    /// An operation runs; the only action is to stop it.
    fn wait(text: impl Into<String>, share: Option<f32>, then: impl Into<String>) -> Self {
        Self {
            progress: Progress::InProgress,
            done: text.into(),
            share,
            action: None,
            then: then.into(),
        }
    }
}

/// The next step of a phase; `poses` are to be planned if none are. Nothing without a session.
#[must_use]
pub fn of(model: &Model, phase: Phase, poses: usize) -> Option<NextStep> {
    let open = model.open.as_ref()?;
    Some(match phase {
        Phase::Precalibration => precalibration(model, open, poses),
        Phase::Modeling => modeling(model, open, poses),
        Phase::Measuring => measuring::of(model, open, poses),
        Phase::Identification => identification::of(model, open),
        Phase::Adjustment => adjustment::of(model, open),
    })
}

/// Phase 1: measured values are applied, all at once.
fn precalibration(model: &Model, open: &OpenSession, poses: usize) -> NextStep {
    let status = phase_status::of(model, open, Phase::Precalibration);
    let all = open.calibration().with_all();
    let robot = all.robot.ok().filter(|_| !all.is_used);
    if let (Some(robot), Progress::InProgress) = (robot, status.progress) {
        let edit = Edit::SetRobot(Box::new(robot), "apply measured values".to_owned());
        let action = Action::new("Apply measured values", edit);
        return NextStep::new(status, Some(action), "Then: measure poses.");
    }
    if let Some(waits) = waits(model) {
        return waits;
    }
    let (action, then) = towards_measuring(open, poses);
    NextStep::new(status, Some(action), then)
}

/// Phase 2: a measured elongation is applied.
fn modeling(model: &Model, open: &OpenSession, poses: usize) -> NextStep {
    let status = phase_status::of(model, open, Phase::Modeling);
    if let Some(edit) = elongation(open) {
        let action = Action::new("Apply measured elongation", edit);
        return NextStep::new(status, Some(action), "Then: measure poses.");
    }
    if let Some(waits) = waits(model) {
        return waits;
    }
    let (action, then) = towards_measuring(open, poses);
    NextStep::new(status, Some(action), then)
}

/// The edit that applies a measured elongation which the robot does not have yet.
fn elongation(open: &OpenSession) -> Option<Edit> {
    let calibration = open.calibration();
    let is_fitted = matches!(calibration.elongation, Some(Ok(_)));
    let proposal = &calibration.with_elongation;
    let robot = proposal.robot.as_ref().ok();
    let robot = robot.filter(|_| is_fitted && !proposal.is_used)?;
    let name = "apply measured elongation".to_owned();
    Some(Edit::SetRobot(Box::new(robot.clone()), name))
}

/// From phases 1 and 2 to phase 3, with its first step where that moves nothing.
fn towards_measuring(open: &OpenSession, poses: usize) -> (Action, &'static str) {
    let session = open.session();
    let nothing = session.plan.is_empty() && session.measurements.is_empty();
    match nothing {
        true => (
            plan(poses).in_phase(Phase::Measuring),
            "Then: connect the controller and measure.",
        ),
        false => (Action::go(Phase::Measuring), "Poses are planned."),
    }
}

fn plan(poses: usize) -> Action {
    let title = format!("Plan {}", count(poses, "pose"));
    Action::new(title, RobotCommand::Plan(poses))
}

/// The robot moves, or is written to, from another phase than the one that is shown.
fn waits(model: &Model) -> Option<NextStep> {
    let doing = model.link.doing()?;
    let words: Vec<String> = [Some(doing), model.link.time_left()]
        .into_iter()
        .flatten()
        .collect();
    let share = model
        .link
        .done_of()
        .map(|[done, of]| done as f32 / of.max(1) as f32);
    let then = "Stop ends it at once (F12).";
    Some(NextStep::wait(
        format!("{}.", words.join(", ")),
        share,
        then,
    ))
}

/// Connecting and arming what the session's settings name; nothing once that is done.
fn connecting(model: &Model, session: &Session) -> Option<(Option<Action>, &'static str)> {
    let link = &model.link;
    if link.lost().is_some() {
        return Some((
            None,
            "The connection is lost: Tautline reconnects by itself.",
        ));
    }
    if link.connecting {
        return Some((None, "Connecting."));
    }
    if !link.is_connected() {
        return Some(match Kind::offered(session) {
            // A simulated robot can do no harm.
            Kind::OfSession => (
                Some(Action::new(
                    "Connect and arm the simulated robot",
                    RobotCommand::ConnectAndArm,
                )),
                "Nothing moves yet.",
            ),
            Kind::OfDescription => (
                Some(Action::new(
                    "Choose controller…",
                    RobotCommand::Setup(Setup::Open),
                )),
                "Then: arm it.",
            ),
            Kind::Recording => (
                Some(Action::new("Connect the recording", RobotCommand::Connect)),
                "Then: arm it.",
            ),
            Kind::Real => (
                Some(Action::new("Connect the controller", RobotCommand::Connect)),
                "Then: arm it.",
            ),
        });
    }
    (!link.is_armed()).then(|| {
        let arm = Action::new("Arm the controller", RobotCommand::Arm);
        (
            Some(arm),
            "Arming allows motion and writing; nothing moves yet.",
        )
    })
}

/// Identifying, in its phase.
fn identify() -> Action {
    let identify = IdentificationCommand::Identify;
    Action::new("Identify the pulleys", identify).in_phase(Phase::Identification)
}

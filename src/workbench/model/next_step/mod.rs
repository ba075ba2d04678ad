//! Next step of each phase: its state, one action, and what comes after it. If there is a problem, the action is its
//! remedy.

mod adjustment;
mod bench;
mod identification;
mod measuring;
mod problem;

pub use adjustment::of_values;
pub use identification::{checked, of_fit};
pub use measuring::{failed_save, no_home};
pub use problem::Problem;

use egui::{Key, KeyboardShortcut, Modifiers};
use tautline_link::Activity;
use tautline_session::Session;
use tautline_workflow::controllers::RobotKind;

use super::command::{
    Command, DIAGNOSING, FORMULAS, IDENTIFYING, IdentificationCommand, PLANNING, RobotCommand,
    Setup, ViewCommand,
};
use super::link::LinkRequest;
use super::phase::{Phase, PhaseStatus, Progress, Screen};
use super::{Model, OpenSession, phase_status};
use tautline_workflow::wording::{count, sentence};

/// Keyboard shortcut of the next step.
pub const KEYS: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Enter);

/// Footer of a phase.
#[derive(Debug, Clone)]
pub struct NextStep {
    pub progress: Progress,
    /// State of the phase in a sentence.
    pub done: String,
    /// Completed share of the current operation, from 0 to 1.
    pub share: Option<f32>,
    /// Next action, if there is one.
    pub action: Option<Action>,
    /// Sentence about the step after the action; or instructions if no button can do it.
    pub then: String,
}

/// Action with its button.
#[derive(Debug, Clone)]
pub struct Action {
    /// Label of the button.
    pub title: String,
    pub commands: Vec<Command>,
}

impl Action {
    /// Phase in which the action does more than to change the screen.
    fn works_in(&self) -> Option<Phase> {
        match &self.commands[..] {
            [Command::View(ViewCommand::Go(Screen::Phase(phase))), _, ..] => Some(*phase),
            _ => None,
        }
    }
}

/// What can be done, and a sentence on it or on the step after it.
struct Remedy {
    /// `None` if no button can do it.
    action: Option<Action>,
    then: String,
}

impl Remedy {
    fn new(title: impl Into<String>, command: impl Into<Command>, then: impl Into<String>) -> Self {
        let action = Action {
            title: title.into(),
            commands: vec![command.into()],
        };
        Self {
            action: Some(action),
            then: then.into(),
        }
    }

    /// Nothing that a button could do.
    fn by_hand(then: impl Into<String>) -> Self {
        Self {
            action: None,
            then: then.into(),
        }
    }

    fn go(phase: Phase, then: impl Into<String>) -> Self {
        let title = format!("Go to {}", phase.title().to_lowercase());
        Self::new(title, ViewCommand::Go(Screen::Phase(phase)), then)
    }

    /// Goes to a phase first, so that what the command does is seen.
    fn in_phase(mut self, phase: Phase) -> Self {
        let go = ViewCommand::Go(Screen::Phase(phase));
        if let Some(action) = &mut self.action {
            action.commands.insert(0, go.into());
        }
        self
    }
}

impl NextStep {
    fn new(status: PhaseStatus, remedy: Remedy) -> Self {
        Self {
            progress: status.progress,
            done: sentence(&status.line),
            share: None,
            action: remedy.action,
            then: remedy.then,
        }
    }

    /// Running operation; the only action is to stop it.
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

/// Next step of a phase; `poses` is the number to plan if there is no plan. `None` without a session.
///
/// A running operation comes first, then the first problem of this phase, then that of the phase in which the action
/// works.
#[must_use]
pub fn of(model: &Model, phase: Phase, poses: usize) -> Option<NextStep> {
    let open = model.open.as_ref()?;
    if let Some(running) = running(model, phase) {
        return Some(running);
    }
    let mut problems = problems(model, phase);
    if problems.is_empty() {
        let step = match phase {
            Phase::Precalibration | Phase::Modeling => bench::of(model, open, phase, poses),
            Phase::Measuring => measuring::of(model, open, poses),
            Phase::Identification => identification::of(model, open),
            Phase::Adjustment => adjustment::of(model, open),
        };
        let works_in = step.action.as_ref().and_then(Action::works_in);
        problems = works_in.map_or_else(Vec::new, |other| self::problems(model, other));
        if problems.is_empty() {
            return Some(step);
        }
    }
    let status = PhaseStatus {
        progress: Progress::Attention,
        ..status(model, open, phase)
    };
    let Problem { remedy, then, .. } = problems.swap_remove(0);
    let action = remedy;
    Some(NextStep::new(status, Remedy { action, then }))
}

/// Problems of a phase, most urgent first, shown in red. Empty without a session.
#[must_use]
pub fn problems(model: &Model, phase: Phase) -> Vec<Problem> {
    let Some(open) = &model.open else {
        return Vec::new();
    };
    match phase {
        Phase::Precalibration | Phase::Modeling => bench::problems(open, phase),
        Phase::Measuring => measuring::problems(model, open),
        Phase::Identification => identification::problems(model, open),
        Phase::Adjustment => adjustment::problems(model, open),
    }
}

/// State of a phase; for the identification, with the number of poses.
fn status(model: &Model, open: &OpenSession, phase: Phase) -> PhaseStatus {
    let status = phase_status::of(model, open, phase);
    let fit = open.current_fit();
    let (Phase::Identification, Some(fit)) = (phase, fit) else {
        return status;
    };
    let poses = count(fit.dataset.measurements.len(), "pose");
    PhaseStatus {
        line: format!("identified from {poses}: {}", status.line),
        ..status
    }
}

/// Running computation of a phase, or the motion of the robot.
fn running(model: &Model, phase: Phase) -> Option<NextStep> {
    let tasks: &[(&str, &str, &str)] = match phase {
        Phase::Measuring => &[(PLANNING, "Planning poses", "Then: connect the controller.")],
        Phase::Identification => &[
            (IDENTIFYING, "Identifying", ""),
            (DIAGNOSING, "Diagnosing the model", ""),
            (FORMULAS, "Trying patterns", ""),
        ],
        _ => &[],
    };
    for (title, text, then) in tasks {
        let mut running = model.tasks.running().iter();
        if let Some(task) = running.find(|task| task.title == *title) {
            let progress = task.progress();
            let words = match progress.text.is_empty() {
                true => format!("{text}."),
                false => format!("{text}: {}.", progress.text),
            };
            return Some(NextStep::wait(words, progress.fraction, *then));
        }
    }
    match phase {
        Phase::Measuring if model.link.is_measuring() => measuring::running(model),
        Phase::Identification => None,
        _ => moving(model),
    }
}

fn plan(poses: usize, then: &str) -> Remedy {
    let title = format!("Plan {}", count(poses, "pose"));
    Remedy::new(title, RobotCommand::Plan(poses), then)
}

/// Motion or writing that was started in another phase.
fn moving(model: &Model) -> Option<NextStep> {
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

/// Problem of the controller.
fn of_controller(model: &Model) -> Option<Problem> {
    let live = model.link.live();
    if live.lost.is_some() {
        let then = "Tautline reconnects by itself, too.";
        let now = Remedy::new("Reconnect now", LinkRequest::TryNow, then);
        return Some(Problem::new("The connection is lost.", now));
    }
    let Activity::Fault(text) = live.state?.activity else {
        return None;
    };
    let clear = Remedy::by_hand("Clear the fault at the controller: nothing moves before.");
    Some(Problem::new(format!("Fault: {text}"), clear))
}

/// Step that connects and arms the controller of the session; `None` once that is done.
fn connecting(model: &Model, session: &Session) -> Option<Remedy> {
    let link = &model.link;
    if link.connecting {
        return Some(Remedy::by_hand("Connecting."));
    }
    if !link.is_connected() {
        let (title, command) = match RobotKind::offered(session) {
            RobotKind::OfSession => {
                let title = "Connect and arm the simulated robot";
                let command = RobotCommand::ConnectAndArm;
                return Some(Remedy::new(title, command, "Nothing moves yet."));
            }
            RobotKind::OfDescription => ("Choose controller…", RobotCommand::Setup(Setup::Open)),
            RobotKind::Recording => ("Connect the recording", RobotCommand::Connect),
            RobotKind::Real => ("Connect the controller", RobotCommand::Connect),
        };
        return Some(Remedy::new(title, command, "Then: arm it."));
    }
    (!link.is_armed()).then(|| {
        let then = "Arming allows motion and writing; nothing moves yet.";
        Remedy::new("Arm the controller", RobotCommand::Arm, then)
    })
}

/// Identification, in its phase.
fn identify(then: &str) -> Remedy {
    let identify = IdentificationCommand::Identify;
    Remedy::new("Identify the pulleys", identify, then).in_phase(Phase::Identification)
}

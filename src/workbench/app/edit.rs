//! What the operator edits, and how it is undone. Measured data are never undone: poses that were measured stay.

use tautline_core::robot::Robot;
use tautline_session::{Method, PhaseData, Session, Settings};

/// One change of what the operator edits.
#[derive(Debug, Clone)]
pub enum Edit {
    /// Renames the session.
    Rename(String),
    /// Chooses the method of identification.
    SetMethod(Method),
    /// Chooses the probability of a false alarm of the diagnosis.
    SetAlpha(f64),
    /// Replaces the robot's description; the text says why, for the undo menu.
    SetRobot(Box<Robot>, String),
    /// Replaces raw data of the phases around the poses; the text says which, for the undo menu.
    SetPhases(Box<PhaseData>, String),
}

impl Edit {
    /// What the undo menu calls it.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Rename(_) => "rename session".into(),
            Self::SetMethod(_) => "choose method".into(),
            Self::SetAlpha(_) => "choose false alarm probability".into(),
            Self::SetRobot(_, what) | Self::SetPhases(_, what) => what.clone(),
        }
    }

    /// Does it.
    pub fn apply(self, session: &mut Session) {
        match self {
            Self::Rename(name) => session.name = name,
            Self::SetMethod(method) => session.settings.identification.method = method,
            Self::SetAlpha(alpha) => session.settings.diagnosis.alpha = alpha,
            Self::SetRobot(robot, _) => session.robot = *robot,
            Self::SetPhases(phases, _) => session.phases = *phases,
        }
    }
}

/// Everything that edits can change.
#[derive(Debug, Clone, PartialEq)]
pub struct Editable {
    name: String,
    robot: Robot,
    phases: PhaseData,
    settings: Settings,
}

impl Editable {
    /// The present state.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        Self {
            name: session.name.clone(),
            robot: session.robot.clone(),
            phases: session.phases.clone(),
            settings: session.settings.clone(),
        }
    }

    /// Puts it back.
    fn restore(self, session: &mut Session) {
        session.name = self.name;
        session.robot = self.robot;
        session.phases = self.phases;
        session.settings = self.settings;
    }
}

/// A state to go back to, with the name of what left it.
#[derive(Debug, Clone)]
struct Step {
    name: String,
    state: Editable,
}

/// Edits that can be undone and redone.
#[derive(Debug, Clone, Default)]
pub struct History {
    undo: Vec<Step>,
    redo: Vec<Step>,
}

/// Steps that are kept.
const MOST: usize = 200;

impl History {
    /// Does an edit and remembers what was before; says whether anything changed.
    pub fn perform(&mut self, edit: Edit, session: &mut Session) -> bool {
        let step = Step {
            name: edit.name(),
            state: Editable::of(session),
        };
        edit.apply(session);
        if step.state == Editable::of(session) {
            return false;
        }
        self.redo.clear();
        if self.undo.len() == MOST {
            self.undo.remove(0);
        }
        self.undo.push(step);
        true
    }

    /// Undoes the last edit and gives its name.
    pub fn undo(&mut self, session: &mut Session) -> Option<String> {
        step(&mut self.undo, &mut self.redo, session)
    }

    /// Does the last undone edit again and gives its name.
    pub fn redo(&mut self, session: &mut Session) -> Option<String> {
        step(&mut self.redo, &mut self.undo, session)
    }

    /// Name of the edit that undo would undo.
    #[must_use]
    pub fn next_undo(&self) -> Option<&str> {
        self.undo.last().map(|step| step.name.as_str())
    }

    /// Name of the edit that redo would do again.
    #[must_use]
    pub fn next_redo(&self) -> Option<&str> {
        self.redo.last().map(|step| step.name.as_str())
    }
}

fn step(from: &mut Vec<Step>, to: &mut Vec<Step>, session: &mut Session) -> Option<String> {
    let Step { name, state } = from.pop()?;
    to.push(Step {
        name: name.clone(),
        state: Editable::of(session),
    });
    state.restore(session);
    Some(name)
}

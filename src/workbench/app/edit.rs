//! What the operator edits, and how it is undone. Measured data are never undone: poses that were measured stay.

use std::collections::BTreeSet;

use tautline_core::effect::EffectSetting;
use tautline_core::robot::Robot;
use tautline_session::{Method, PhaseData, PlannedPose, Session, Settings};

/// One change of what the operator edits.
#[derive(Debug, Clone)]
pub enum Edit {
    /// Renames the session.
    Rename(String),
    /// Chooses the method of identification.
    SetMethod(Method),
    /// Chooses the probability of a false alarm of the diagnosis.
    SetAlpha(f64),
    /// Adds effects to the model: their parameters are identified, too. The text says which, for the undo menu.
    AddEffects(Vec<EffectSetting>, String),
    /// Takes an effect out of the model, by its place.
    RemoveEffect(usize),
    /// Leaves a pose out.
    Exclude(i64),
    /// Takes a pose back in.
    Include(i64),
    /// Replaces the poses that are to be measured; the text says why, for the undo menu.
    SetPlan(Vec<PlannedPose>, String),
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
            Self::RemoveEffect(_) => "remove effect from the model".into(),
            Self::Exclude(label) => format!("exclude pose {label}"),
            Self::Include(label) => format!("include pose {label}"),
            Self::AddEffects(_, what)
            | Self::SetPlan(_, what)
            | Self::SetRobot(_, what)
            | Self::SetPhases(_, what) => what.clone(),
        }
    }

    /// Does it; what cannot be done, as excluding the home pose, changes nothing.
    fn apply(self, session: &mut Session) {
        let effects = &mut session.settings.identification.effects;
        match self {
            Self::AddEffects(added, _) => effects.extend(added),
            Self::RemoveEffect(place) if place < effects.len() => {
                effects.remove(place);
            }
            Self::RemoveEffect(_) => {}
            Self::Exclude(label) => {
                let _ = session.exclude(label);
            }
            Self::Include(label) => {
                session.include(label);
            }
            Self::SetPlan(plan, _) => session.plan = plan,
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
    plan: Vec<PlannedPose>,
    excluded: BTreeSet<i64>,
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
            plan: session.plan.clone(),
            excluded: session.excluded().clone(),
        }
    }

    /// Puts it back.
    fn restore(self, session: &mut Session) {
        session.name = self.name;
        session.robot = self.robot;
        session.phases = self.phases;
        session.settings = self.settings;
        session.plan = self.plan;
        for label in session.excluded().clone().difference(&self.excluded) {
            session.include(*label);
        }
        for label in &self.excluded {
            // It was excluded before, so it can be.
            let _ = session.exclude(*label);
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::robot::presets;
    use tautline_core::simulation::{SimulationOptions, simulate};
    use tautline_session::Timestamp;

    fn session() -> Session {
        let robot = presets::find("mini").expect("a preset").robot;
        let simulated = simulate(&robot, &SimulationOptions::new(4, 1)).expect("simulated");
        let mut session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
        session.measurements = simulated.dataset.measurements;
        session
    }

    fn effect() -> EffectSetting {
        EffectSetting {
            effect: "winch_scale".into(),
            targets: vec!["cable-3".into()],
            parameters: [("scale".into(), 0.01)].into(),
        }
    }

    #[test]
    fn every_edit_is_undone_and_done_again() {
        let mut session = session();
        let mut robot = session.robot.clone();
        robot.cables[0].pulley.radius_m += 1e-3;
        let planned = PlannedPose {
            label: 9,
            position_m: [0.1, 0.0, 0.0],
            orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        };
        let phases = PhaseData {
            winch: vec![tautline_session::WinchPair {
                cable: 0,
                revolutions: 1.0,
                length_m: 0.1,
                tension_n: None,
            }],
            ..PhaseData::default()
        };
        let edits = [
            Edit::Rename("other".into()),
            Edit::SetMethod(Method::Simple),
            Edit::SetAlpha(0.05),
            Edit::AddEffects(vec![effect()], "add winch scale".into()),
            Edit::RemoveEffect(0),
            Edit::Exclude(2),
            Edit::Include(2),
            Edit::SetPlan(vec![planned], "plan".into()),
            Edit::SetRobot(Box::new(robot), "radius".into()),
            Edit::SetPhases(Box::new(phases), "winch table".into()),
        ];
        let mut history = History::default();
        let mut states = vec![Editable::of(&session)];
        for edit in edits.clone() {
            let name = edit.name();
            assert!(
                history.perform(edit, &mut session),
                "{name} changes something"
            );
            assert_eq!(history.next_undo(), Some(name.as_str()));
            states.push(Editable::of(&session));
        }
        for before in states.iter().rev().skip(1) {
            history.undo(&mut session).expect("a step");
            assert_eq!(Editable::of(&session), *before);
        }
        for after in states.iter().skip(1) {
            history.redo(&mut session).expect("a step");
            assert_eq!(Editable::of(&session), *after);
        }
    }

    #[test]
    fn what_changes_nothing_is_no_step() {
        let mut session = session();
        let mut history = History::default();
        assert!(
            !history.perform(Edit::Exclude(0), &mut session),
            "the home pose stays"
        );
        assert!(!history.perform(Edit::RemoveEffect(3), &mut session));
        assert_eq!(history.next_undo(), None);
    }
}

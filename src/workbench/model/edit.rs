//! Edits of the operator and their undo. Poses measured here are never undone. An import can be undone as long as
//! nothing was measured after it, because it is still in its file.

use std::collections::BTreeSet;
use std::sync::Arc;

use tautline_core::effect::{BoundEffect, EffectSetting, Hypothesis};
use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;
use tautline_session::{
    Connection, LaserSettings, Method, Phase as LogPhase, PhaseData, PlannedPose, Session,
    Settings, UntilSettings,
};
pub use tautline_workflow::identification::same_effect;
use tautline_workflow::signature::replace_hypothesis;

/// A change by the operator.
#[derive(Debug, Clone)]
pub enum Edit {
    Rename(String),
    SetMethod(Method),
    /// Sets the false alarm probability of the diagnosis.
    SetAlpha(f64),
    /// Adds effects to the model, whose parameters are then identified; the text names them in the undo menu.
    AddEffects(Vec<EffectSetting>, String),
    /// Adds a pattern of unexplained errors to the robot and the model.
    AddPattern {
        /// Text of the hypothesis.
        hypothesis: String,
        effect: Box<EffectSetting>,
        name: String,
    },
    /// Adds a hypothesis to the robot, or replaces the one with the same identifier.
    SetHypothesis(Box<Hypothesis>),
    /// Removes a hypothesis, by its identifier, from the robot and the model.
    RemoveHypothesis(String),
    /// Removes effects from the model, whatever their values; the text names them in the undo menu.
    RemoveEffects(Vec<EffectSetting>, String),
    /// Excludes a pose.
    Exclude(i64),
    /// Includes an excluded pose again.
    Include(i64),
    /// Sets the end condition of a measuring run.
    SetUntil(UntilSettings),
    /// Replaces the planned poses; the text describes the edit in the undo menu.
    SetPlan(Vec<PlannedPose>, String),
    /// Replaces the description of the robot; the text describes the edit in the undo menu.
    SetRobot(Box<Robot>, String),
    /// Replaces the connection to the controller and the source of the laser distance.
    SetConnection(Box<(Connection, LaserSettings)>),
    /// Replaces raw data of phases 1, 2 and 5; the text names them in the undo menu.
    SetPhases(Box<PhaseData>, String),
    /// Replaces the poses of the session, which are empty or imported, by those of a foreign file; the text names the
    /// file in the undo menu.
    Import(Arc<Measurements>, String),
}

impl Edit {
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Rename(_) => "rename session".into(),
            Self::SetMethod(_) => "choose method".into(),
            Self::SetConnection(_) => "choose controller".into(),
            Self::SetAlpha(_) => "choose false alarm probability".into(),
            Self::SetUntil(_) => "choose when to stop measuring".into(),
            Self::Exclude(label) => format!("exclude pose {label}"),
            Self::Include(label) => format!("include pose {label}"),
            Self::AddPattern { name, .. } => format!("extend the model by {name}"),
            Self::SetHypothesis(hypothesis) => format!("hypothesis {}", hypothesis.id()),
            Self::RemoveHypothesis(id) => format!("remove hypothesis {id}"),
            Self::AddEffects(_, what)
            | Self::RemoveEffects(_, what)
            | Self::SetPlan(_, what)
            | Self::SetRobot(_, what)
            | Self::SetPhases(_, what)
            | Self::Import(_, what) => what.clone(),
        }
    }

    /// Phase of the session's log that records the edit; `None` if its command does so, or if it changes no result.
    pub(super) fn log_phase(&self) -> Option<LogPhase> {
        match self {
            Self::AddEffects(..)
            | Self::AddPattern { .. }
            | Self::RemoveEffects(..)
            | Self::SetMethod(_)
            | Self::Exclude(_)
            | Self::Include(_) => Some(LogPhase::Identification),
            Self::SetHypothesis(_) | Self::RemoveHypothesis(_) | Self::SetAlpha(_) => {
                Some(LogPhase::Diagnosis)
            }
            Self::SetPhases(..) => Some(LogPhase::Instruments),
            Self::SetRobot(..) => Some(LogPhase::Cables),
            Self::SetConnection(_) => Some(LogPhase::Controller),
            Self::Rename(_) | Self::SetUntil(_) | Self::SetPlan(..) | Self::Import(..) => None,
        }
    }

    /// Applies the edit; an edit that is not possible, such as excluding the home pose, changes nothing.
    fn apply(self, session: &mut Session) {
        let effects = &mut session.settings.identification.effects;
        match self {
            Self::AddEffects(added, _) => {
                effects.retain(|old| !added.iter().any(|new| same_effect(old, new)));
                effects.extend(added);
            }
            Self::AddPattern {
                hypothesis, effect, ..
            } => {
                // A hypothesis that the robot rejects, because it has too many, changes nothing.
                let parsed = Hypothesis::parse(&hypothesis);
                if parsed.is_ok_and(|parsed| session.robot.add_hypothesis(&parsed).is_ok()) {
                    effects.retain(|old| !same_effect(old, &effect));
                    effects.push(*effect);
                }
            }
            Self::SetHypothesis(hypothesis) => {
                // One hypothesis too many changes nothing.
                if replace_hypothesis(&mut session.robot, &hypothesis).is_ok() {
                    // Another text may have other parameters.
                    let robot = &session.robot;
                    effects.retain(|one| BoundEffect::to_estimate(one, robot).is_ok());
                }
            }
            Self::RemoveHypothesis(id) => {
                let is_other = |text: &String| {
                    let known = Hypothesis::parse(text);
                    known.is_ok_and(|known| known.id() != id)
                };
                session.robot.hypotheses.retain(is_other);
                effects.retain(|one| one.effect != id);
            }
            Self::RemoveEffects(removed, _) => {
                effects.retain(|one| !removed.iter().any(|other| same_effect(one, other)));
            }
            Self::Exclude(label) => {
                let _ = session.exclude(label);
            }
            Self::Include(label) => {
                session.include(label);
            }
            Self::SetPlan(plan, _) => session.plan = plan,
            Self::Rename(name) => session.name = name,
            Self::SetMethod(method) => session.settings.identification.method = method,
            Self::SetUntil(until) => session.settings.until = until,
            Self::SetAlpha(alpha) => session.settings.diagnosis.alpha = alpha,
            Self::SetRobot(robot, _) => session.robot = *robot,
            Self::SetPhases(phases, _) => session.phases = *phases,
            Self::Import(poses, _) => {
                session.measurements = Arc::unwrap_or_clone(poses);
                let measured = &session.measurements.labels;
                let excluded = session.excluded().iter().copied();
                let gone: Vec<i64> = excluded.filter(|pose| !measured.contains(pose)).collect();
                for pose in gone {
                    session.include(pose);
                }
            }
            Self::SetConnection(settings) => {
                (session.connection, session.laser_source) = *settings;
            }
        }
    }
}

/// Part of the session that edits can change.
#[derive(Debug, Clone, PartialEq)]
pub struct Editable {
    name: String,
    robot: Robot,
    phases: PhaseData,
    settings: Settings,
    plan: Vec<PlannedPose>,
    connection: Connection,
    laser: LaserSettings,
    excluded: BTreeSet<i64>,
}

impl Editable {
    #[must_use]
    pub fn of(session: &Session) -> Self {
        Self {
            name: session.name.clone(),
            robot: session.robot.clone(),
            phases: session.phases.clone(),
            settings: session.settings.clone(),
            plan: session.plan.clone(),
            connection: session.connection.clone(),
            laser: session.laser_source.clone(),
            excluded: session.excluded().clone(),
        }
    }

    /// Whether the inputs of the identification equal those of `session`.
    fn has_inputs_of(&self, session: &Session) -> bool {
        self.robot == session.robot
            && self.phases.distances == session.phases.distances
            && self.settings.identification == session.settings.identification
            && self.excluded == *session.excluded()
    }

    fn restore(self, session: &mut Session) {
        session.name = self.name;
        session.robot = self.robot;
        session.phases = self.phases;
        session.settings = self.settings;
        session.plan = self.plan;
        session.connection = self.connection;
        session.laser_source = self.laser;
        for label in session.excluded().clone().difference(&self.excluded) {
            session.include(*label);
        }
        for label in &self.excluded {
            // The pose was excluded before, so this cannot fail.
            let _ = session.exclude(*label);
        }
    }
}

/// Earlier state, with the name of the edit that changed it.
#[derive(Debug, Clone)]
struct UndoStep {
    /// Number of the edit, never reused.
    number: u64,
    name: String,
    state: Editable,
    /// Number of its inputs; `None` once something was measured since.
    inputs: Option<u64>,
    /// Its poses, if an import replaced them.
    poses: Option<Measurements>,
}

/// Change of the inputs by an edit or its undoing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum InputRevision {
    Unchanged,
    New,
    /// The inputs of this earlier number are back.
    Restored(u64),
}

/// Edits that can be undone and redone.
#[derive(Debug, Clone, Default)]
pub struct History {
    undo: Vec<UndoStep>,
    redo: Vec<UndoStep>,
    edits: u64,
}

/// Largest number of steps.
const MOST: usize = 200;

impl History {
    /// Applies an edit and stores the state before it, with the number of its inputs; `None` if nothing changed.
    pub fn perform(
        &mut self,
        edit: Edit,
        session: &mut Session,
        inputs: u64,
    ) -> Option<InputRevision> {
        let is_import = matches!(edit, Edit::Import(..));
        let step = UndoStep {
            number: self.edits + 1,
            name: edit.name(),
            state: Editable::of(session),
            inputs: Some(inputs),
            poses: is_import.then(|| std::mem::take(&mut session.measurements)),
        };
        edit.apply(session);
        if step.state == Editable::of(session) && !is_import {
            return None;
        }
        let same = step.state.has_inputs_of(session) && !is_import;
        self.redo.clear();
        if self.undo.len() == MOST {
            self.undo.remove(0);
        }
        self.undo.push(step);
        self.edits += 1;
        Some(if same {
            InputRevision::Unchanged
        } else {
            InputRevision::New
        })
    }

    /// Undoes the last edit and returns its name.
    pub fn undo(&mut self, session: &mut Session, inputs: u64) -> Option<(String, InputRevision)> {
        step(&mut self.undo, &mut self.redo, session, inputs)
    }

    /// Redoes the last undone edit and returns its name.
    pub fn redo(&mut self, session: &mut Session, inputs: u64) -> Option<(String, InputRevision)> {
        step(&mut self.redo, &mut self.undo, session, inputs)
    }

    /// Invalidates the numbers of inputs after a measurement; an import before it can no longer be undone.
    pub fn forget_inputs(&mut self) {
        for steps in [&mut self.undo, &mut self.redo] {
            steps.retain(|step| step.poses.is_none());
            steps.iter_mut().for_each(|step| step.inputs = None);
        }
    }

    /// Keeps poses that a run has added to the plan: drops the redo steps and adds the poses to the undo steps.
    pub fn keep_planned(&mut self, poses: &[PlannedPose]) {
        self.redo.clear();
        for step in &mut self.undo {
            let plan = &mut step.state.plan;
            plan.retain(|known| poses.iter().all(|new| new.label != known.label));
            plan.extend(poses);
            // The home pose is measured first.
            plan.sort_by_key(|planned| planned.label != 0);
        }
    }

    /// Whether the last edit, or the last undone one, is an import.
    #[must_use]
    pub fn is_import(&self, undone: bool) -> bool {
        let steps = if undone { &self.redo } else { &self.undo };
        steps.last().is_some_and(|step| step.poses.is_some())
    }

    /// Number of the edit that undo would undo; 0 before the first.
    #[must_use]
    pub fn place(&self) -> u64 {
        self.undo.last().map_or(0, |step| step.number)
    }

    /// Name of the edit that undo would undo.
    #[must_use]
    pub fn next_undo(&self) -> Option<&str> {
        self.undo.last().map(|step| step.name.as_str())
    }

    /// Name of the edit that redo would redo.
    #[must_use]
    pub fn next_redo(&self) -> Option<&str> {
        self.redo.last().map(|step| step.name.as_str())
    }
}

fn step(
    from: &mut Vec<UndoStep>,
    to: &mut Vec<UndoStep>,
    session: &mut Session,
    inputs: u64,
) -> Option<(String, InputRevision)> {
    let left = from.pop()?;
    let state = Editable::of(session);
    let same = left.state.has_inputs_of(session) && left.poses.is_none();
    let poses = left
        .poses
        .map(|poses| std::mem::replace(&mut session.measurements, poses));
    to.push(UndoStep {
        number: left.number,
        name: left.name.clone(),
        state,
        inputs: Some(inputs),
        poses,
    });
    left.state.restore(session);
    let inputs = match left.inputs {
        _ if same => InputRevision::Unchanged,
        Some(number) => InputRevision::Restored(number),
        None => InputRevision::New,
    };
    Some((left.name, inputs))
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
            Edit::RemoveEffects(vec![effect()], "remove winch scale".into()),
            Edit::Exclude(2),
            Edit::Include(2),
            Edit::SetUntil(UntilSettings {
                enabled: true,
                ..UntilSettings::default()
            }),
            Edit::SetPlan(vec![planned], "plan".into()),
            Edit::SetRobot(Box::new(robot), "radius".into()),
            Edit::SetPhases(Box::new(phases), "winch table".into()),
            Edit::SetConnection(Box::new((Connection::default(), LaserSettings::Manual))),
        ];
        let mut history = History::default();
        let mut states = vec![Editable::of(&session)];
        for edit in edits.clone() {
            let name = edit.name();
            assert!(
                history.perform(edit, &mut session, 0).is_some(),
                "{name} changes something"
            );
            assert_eq!(history.next_undo(), Some(name.as_str()));
            states.push(Editable::of(&session));
        }
        for before in states.iter().rev().skip(1) {
            history.undo(&mut session, 0).expect("a step");
            assert_eq!(Editable::of(&session), *before);
        }
        for after in states.iter().skip(1) {
            history.redo(&mut session, 0).expect("a step");
            assert_eq!(Editable::of(&session), *after);
        }
    }

    #[test]
    fn what_changes_nothing_is_no_step() {
        let mut session = session();
        let mut history = History::default();
        assert!(
            history.perform(Edit::Exclude(0), &mut session, 0).is_none(),
            "the home pose stays"
        );
        let remove = Edit::RemoveEffects(vec![effect()], "remove winch scale".into());
        assert!(history.perform(remove, &mut session, 0).is_none());
        assert_eq!(history.next_undo(), None);
    }

    #[test]
    fn poses_that_a_run_has_planned_stay_when_an_edit_before_is_undone() {
        let mut session = session();
        let mut history = History::default();
        let pose = session.robot.home.expect("a home pose").pose();
        let planned = |label| PlannedPose::new(label, &pose);
        let plan = |labels: &[i64]| {
            let poses = labels.iter().map(|label| planned(*label)).collect();
            Edit::SetPlan(poses, "plan".into())
        };
        history.perform(plan(&[5, 6]), &mut session, 0);
        history.perform(plan(&[]), &mut session, 0);
        history.perform(plan(&[7]), &mut session, 0);
        history.undo(&mut session, 0).expect("a step");
        let added = [planned(0), planned(5)];
        session.plan.extend(added);
        history.keep_planned(&added);
        assert_eq!(history.next_redo(), None);
        history.undo(&mut session, 0).expect("a step");
        let labels: Vec<i64> = session.plan.iter().map(|planned| planned.label).collect();
        assert_eq!(labels, [0, 6, 5]);
    }

    #[test]
    fn an_import_is_undone_until_something_is_measured() {
        let mut session = session();
        let poses = Arc::new(std::mem::take(&mut session.measurements));
        let import = || Edit::Import(Arc::clone(&poses), "import log.csv".into());
        let mut history = History::default();
        assert_eq!(
            history.perform(import(), &mut session, 1),
            Some(InputRevision::New)
        );
        assert_eq!(session.measurements, *poses);
        let fewer = poses.select(&[0, 1]);
        session.exclude(poses.labels[2]).expect("it is measured");
        let again = Edit::Import(Arc::new(fewer.clone()), "import log.csv again".into());
        assert_eq!(
            history.perform(again, &mut session, 2),
            Some(InputRevision::New)
        );
        assert_eq!(session.measurements, fewer);
        assert!(session.excluded().is_empty(), "it is no longer there");
        history.undo(&mut session, 3).expect("a step");
        assert_eq!(session.measurements, *poses);
        assert!(session.excluded().contains(&poses.labels[2]));
        assert!(history.is_import(false));
        let undone = history.undo(&mut session, 2).expect("a step");
        assert_eq!(
            undone,
            ("import log.csv".into(), InputRevision::Restored(1))
        );
        assert!(session.measurements.is_empty() && history.is_import(true));
        history.redo(&mut session, 1).expect("a step");
        assert_eq!(session.measurements, *poses);
        history.forget_inputs();
        assert_eq!(history.next_undo(), None);
    }

    #[test]
    fn undoing_brings_the_inputs_back() {
        let mut session = session();
        let mut history = History::default();
        let rename = history.perform(Edit::Rename("other".into()), &mut session, 7);
        assert_eq!(
            rename,
            Some(InputRevision::Unchanged),
            "a name changes no result"
        );
        let add = Edit::AddEffects(vec![effect()], "add winch scale".into());
        assert_eq!(
            history.perform(add, &mut session, 7),
            Some(InputRevision::New)
        );
        let undone = history.undo(&mut session, 8).map(|(_, inputs)| inputs);
        assert_eq!(undone, Some(InputRevision::Restored(7)));
        let redone = history.redo(&mut session, 7).map(|(_, inputs)| inputs);
        assert_eq!(redone, Some(InputRevision::Restored(8)));
        history.forget_inputs();
        let undone = history.undo(&mut session, 9).map(|(_, inputs)| inputs);
        assert_eq!(
            undone,
            Some(InputRevision::New),
            "something was measured since"
        );
    }
}

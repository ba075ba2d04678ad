//! The health check: few poses that show whether a robot has changed since its calibration.

mod document;
mod words;

use tautline_core::comparison::Identified;
use tautline_core::effect::{EffectSetting, Hypothesis};
use tautline_core::estimation::{Control, Method, ParameterId};
use tautline_core::geometry::Pose;
use tautline_core::history::{CERTAIN, DatedRun, HealthCheck, Jump, RobotPart, check};
use tautline_core::measurement::Dataset;
use tautline_core::planning::{Plan, PlanOptions, plan};
use tautline_core::robot::{PerAxis, Robot};
use tautline_session::{Session, Timestamp};

use crate::history::{DAYS_WITHOUT_DATE, days_between, same_machine};
use crate::identification::{
    FitVerdict, Identification, IdentificationError, IdentificationRequest, TolerancesUsed,
    identify, same_effect,
};
pub use document::{DetectableMove, HealthDocument, HealthVerdict};
pub use words::verdict_sentences;

/// Default number of poses of a check.
pub const POSES: usize = 8;
/// Number of poses that are proposed where a check is undecided.
const MORE_POSES: usize = 2;
/// Prior standard deviations of a coordinate of a pulley in the fits of the check (m): first wider than usual moves, then
/// around the place estimated from baseline and check together. The comparison is linear, so that both must be solved near the
/// same place; it removes the prior again.
const PRESENT_SD_M: [f64; 2] = [10e-3, 2e-3];
/// Largest number of samples that are used of a recording in motion: with many more than the poses of a baseline, the errors of
/// the linear comparison would exceed the noise.
const MOST_SAMPLES: usize = 60;
/// Probability with which a stated detectable move is found.
const FOUND: f64 = 0.95;

/// The calibration that a robot is checked against.
#[derive(Debug, Clone)]
pub struct Baseline {
    /// Result of the identification.
    pub identification: Identification,
    /// Time of the readings, if known.
    pub time: Option<Timestamp>,
    /// Name of the session, for sentences without a date.
    pub name: String,
    /// Whether values were written to the controller in the session.
    pub adjusted: bool,
}

/// A robot that was checked.
#[derive(Debug, Clone)]
pub struct Checked {
    /// The few poses with the fit to them alone.
    pub identification: Identification,
    /// Changes since the baseline.
    pub found: HealthCheck,
    /// Verdict on changes of the robot.
    pub verdict: HealthVerdict,
    /// The smallest move of each pulley that would have been found, in the order of the cables.
    pub detectable: Vec<DetectableMove>,
    /// Further poses to measure, if the check is undecided.
    pub more_poses: Vec<Pose>,
}

/// Errors of the check of a robot.
#[derive(Debug, thiserror::Error)]
pub enum HealthError {
    /// The baseline or the check cannot be identified.
    #[error(transparent)]
    Identification(#[from] IdentificationError),
    /// The check is of another machine, or cannot be compared; one sentence.
    #[error("{0}")]
    Other(String),
}

impl Baseline {
    /// Identifies the calibration of a session whose poses were read at a time, with typical tolerances of the parts if its robot
    /// states none.
    ///
    /// # Errors
    /// If there is no reliable identification.
    pub fn new(session: &Session, time: Option<Timestamp>) -> Result<Self, HealthError> {
        let request =
            IdentificationRequest::of_session(session).map_err(IdentificationError::from)?;
        Ok(Self {
            identification: identified(request)?,
            time,
            name: session.name.clone(),
            adjusted: !session.adjustments().is_empty(),
        })
    }

    /// The expected robot: as the check describes it, with the identified pulleys and target plane. The check estimates the
    /// present places of the pulleys.
    fn expected(&self, described: &Robot) -> Robot {
        let solution = &self.identification.solution;
        let is_estimated = |id: ParameterId| solution.parameters.iter().any(|p| p.id == id);
        let mut robot = described.clone();
        let found = solution.globals.entry_points.iter();
        for (cable, (pulley, found)) in robot
            .cables
            .iter_mut()
            .map(|c| &mut c.pulley)
            .zip(found)
            .enumerate()
        {
            let mut sd = pulley.entry_point_sd_m.each();
            for axis in
                (0..3).filter(|axis| is_estimated(ParameterId::EntryPoint { cable, axis: *axis }))
            {
                pulley.entry_point_m[axis] = found[axis];
                sd[axis] = Some(PRESENT_SD_M[0]);
            }
            pulley.entry_point_sd_m = PerAxis::Each(sd);
        }
        if let Some(laser) = robot
            .laser
            .as_mut()
            .filter(|_| is_estimated(ParameterId::PlaneOffset))
        {
            laser.target_plane.offset_m = solution.globals.plane_offset_m;
        }
        robot
    }

    /// Checks a robot by the readings of few poses, which were taken at a time.
    ///
    /// # Errors
    /// If they are of another machine, or cannot be identified.
    pub fn check(
        &self,
        dataset: &Dataset,
        time: Option<Timestamp>,
    ) -> Result<Checked, HealthError> {
        let robot = &self.identification.dataset.robot;
        same_machine(robot, &dataset.robot).map_err(HealthError::Other)?;
        let mut described = dataset.robot.clone();
        self.add_hypotheses(&mut described)?;
        let samples = dataset
            .measurements
            .independent_samples(&dataset.robot, MOST_SAMPLES);
        let expected = Dataset {
            robot: self.expected(&described),
            measurements: samples.unwrap_or_else(|| dataset.measurements.clone()),
        };
        let effects: Vec<_> = (self.identification.free_effects().iter())
            .map(|bound| bound.setting(robot))
            .collect();
        let mut checked = self.checked(&expected, &effects, time)?;
        // The tolerance of a part prevents the fit from following a change beyond it, and the comparison is linear: a certain
        // change is estimated freely.
        if let Some(effect) = checked.certain_effect() {
            let effects = [effects, vec![effect.clone()]].concat();
            let freed = self.checked(&expected, &effects, time)?;
            if freed
                .certain_effect()
                .is_some_and(|same| same_effect(&same, &effect))
            {
                checked = freed;
            }
        }
        if checked.verdict == HealthVerdict::Undecided || checked.is_unnamed() {
            let method = self.identification.method;
            checked.more_poses = more_poses(&checked.identification, method);
        }
        Ok(checked)
    }

    /// Makes the hypotheses that the calibration has in its model known to a robot, whose description may have been written
    /// before them.
    fn add_hypotheses(&self, robot: &mut Robot) -> Result<(), HealthError> {
        let known = &self.identification.dataset.robot.hypotheses;
        let known = known.iter().filter_map(|text| Hypothesis::parse(text).ok());
        let effects = self.identification.free_effects();
        let is_used = |one: &Hypothesis| effects.iter().any(|bound| bound.effect.id() == one.id());
        for hypothesis in known.filter(is_used) {
            let added = robot.add_hypothesis(&hypothesis);
            added.map_err(|error| HealthError::Other(error.to_string()))?;
        }
        Ok(())
    }

    /// Checks a robot with some effects in its model.
    fn checked(
        &self,
        expected: &Dataset,
        effects: &[EffectSetting],
        time: Option<Timestamp>,
    ) -> Result<Checked, HealthError> {
        let method = self.identification.method;
        let fit = |dataset: Dataset| {
            let request = IdentificationRequest::new(dataset, method, effects);
            identified(request.map_err(IdentificationError::from)?)
        };
        let first = self.compare(&fit(expected.clone())?, time)?;
        let mut together = expected.clone();
        place(&mut together.robot, &first);
        let identification = fit(together)?;
        let found = self.compare(&identification, time)?;
        Ok(Checked {
            verdict: verdict(&found, &identification),
            detectable: detectable(&found, &identification.dataset.robot),
            more_poses: Vec::new(),
            identification,
            found,
        })
    }

    fn compare(
        &self,
        identification: &Identification,
        time: Option<Timestamp>,
    ) -> Result<HealthCheck, HealthError> {
        let failed = |error: &dyn std::fmt::Display| HealthError::Other(error.to_string());
        let before = self.identification.problem().map_err(|e| failed(&e))?;
        let now = identification.problem().map_err(|e| failed(&e))?;
        let days = self.time.zip(time);
        let days = days.map_or(DAYS_WITHOUT_DATE, |(from, to)| days_between(from, to));
        let run = |problem, solution, days, follows_event| DatedRun {
            run: Identified { problem, solution },
            days,
            follows_event,
        };
        let baseline = run(&before, &self.identification.solution, 0.0, false);
        let present = run(&now, &identification.solution, days.max(0.0), self.adjusted);
        check(&baseline, &present).map_err(|e| failed(&e))
    }

    /// Plans the poses of a check; effects and method are those of the baseline.
    ///
    /// # Errors
    /// One sentence, if the robot can hold too few poses.
    pub fn plan(&self, options: &PlanOptions<'_>) -> Result<Plan, String> {
        let robot = self.expected(&self.identification.dataset.robot);
        let options = PlanOptions {
            effects: self.identification.free_effects(),
            method: self.identification.method,
            ..options.clone()
        };
        let planned = plan(&robot, &options, &mut |_| Control::Continue);
        planned.map_err(|error| error.to_string())
    }
}

impl Checked {
    /// Probability that a move of the pulley of a cable by so much (m) is found; `None` if its coordinates are known exactly.
    #[must_use]
    pub fn detection(&self, cable: &str, move_m: f64) -> Option<f64> {
        let robot = &self.identification.dataset.robot;
        let pulley = RobotPart::Pulley(robot.cable_index(cable)?);
        let mut parts = self.found.history.parts.iter();
        let part = parts.position(|part| *part == pulley)?;
        self.found.detection(part, move_m)
    }

    /// The single change that is certain, if there is one.
    #[must_use]
    pub fn certain(&self) -> Option<&Jump> {
        let mut jumps = self.found.history.jumps.iter();
        jumps.find(|jump| jump.probability >= CERTAIN)
    }

    /// The effect that has certainly changed, if the certain change is one, with its present size.
    fn certain_effect(&self) -> Option<EffectSetting> {
        let jump = self.certain()?;
        let RobotPart::Effect {
            effect,
            targets,
            parameter,
            ..
        } = &self.found.history.parts[jump.part]
        else {
            return None;
        };
        Some(EffectSetting {
            effect: effect.clone(),
            targets: targets.clone(),
            parameters: [(parameter.clone(), jump.size[0])].into(),
        })
    }

    /// Whether a change is certain, but these poses cannot tell which part changed.
    fn is_unnamed(&self) -> bool {
        self.verdict == HealthVerdict::Changed && self.certain().is_none()
    }

    /// Whether the check poses fit the calibration or one change of it.
    #[must_use]
    pub fn is_explained(&self) -> bool {
        FitVerdict::of(self.identification.solution.p_value()).holds()
    }
}

/// Places pulleys and target plane as estimated from baseline and check together.
fn place(robot: &mut Robot, found: &HealthCheck) {
    let history = &found.history;
    for (part, of) in history.parts.iter().enumerate() {
        let Some(now) = history.states[part].last() else {
            continue;
        };
        match of {
            RobotPart::Pulley(cable) => {
                let pulley = &mut robot.cables[*cable].pulley;
                let mut sd = pulley.entry_point_sd_m.each();
                for (axis, value) in history.axes[part].iter().zip(now.value.iter()) {
                    pulley.entry_point_m[*axis] = *value;
                    sd[*axis] = Some(PRESENT_SD_M[1]);
                }
                pulley.entry_point_sd_m = PerAxis::Each(sd);
            }
            RobotPart::TargetPlane => {
                if let Some(laser) = &mut robot.laser {
                    laser.target_plane.offset_m = now.value[0];
                }
            }
            RobotPart::Effect { .. } => {}
        }
    }
}

fn identified(mut request: IdentificationRequest) -> Result<Identification, IdentificationError> {
    if request.dataset.robot.tolerances.is_none() {
        request.options.tolerances = TolerancesUsed::Typical;
    }
    let found = identify(&request, &mut |_| Control::Continue)?.refuse_extrapolation()?;
    match found.solution.converged() {
        true => Ok(found),
        false => Err(IdentificationError::NotConverged),
    }
}

fn verdict(found: &HealthCheck, identification: &Identification) -> HealthVerdict {
    let history = &found.history;
    let is_explained = FitVerdict::of(identification.solution.p_value()).holds();
    let is_in_motion = identification.dataset.measurements.rates.is_some();
    match (is_explained, history.jumps.is_empty()) {
        // A defect of the model of motion is not a change of the robot.
        (false, _) if is_in_motion => HealthVerdict::Undecided,
        (false, _) => HealthVerdict::Changed,
        (true, _) if history.unchanged <= 1.0 - CERTAIN => HealthVerdict::Changed,
        (true, true) => HealthVerdict::Unchanged,
        (true, false) => HealthVerdict::Undecided,
    }
}

fn detectable(found: &HealthCheck, robot: &Robot) -> Vec<DetectableMove> {
    let parts = 0..found.history.parts.len();
    let moves = parts.filter_map(|part| {
        let RobotPart::Pulley(cable) = found.history.parts[part] else {
            return None;
        };
        let has_coordinates = !found.history.axes[part].is_empty();
        has_coordinates.then(|| DetectableMove {
            cable: robot.cables[cable].name.clone(),
            move_m: found.detectable_m(part, FOUND),
        })
    });
    moves.collect()
}

/// The poses that most improve the geometry that is uncertain after the check; none if the robot can hold no others.
fn more_poses(identification: &Identification, method: Method) -> Vec<Pose> {
    let dataset = &identification.dataset;
    let options = PlanOptions {
        existing: Some(&dataset.measurements),
        effects: identification.free_effects(),
        method,
        ..PlanOptions::new(MORE_POSES, crate::planning::SEED)
    };
    let planned = plan(&dataset.robot, &options, &mut |_| Control::Continue);
    let poses = planned.map(|planned| planned.poses).unwrap_or_default();
    poses.into_iter().map(|planned| planned.pose).collect()
}

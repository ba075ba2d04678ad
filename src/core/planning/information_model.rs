//! Knowledge of the robot at the time of planning, and the information that further poses would add.

use super::goal::faults;
use super::{PlanError, PlanOptions, tape};
use crate::effect::{BoundEffect, measurements_as_modelled};
use crate::estimation::{
    Control, EstimationError, ExpectedDistances, ExpectedInformation, Options, Problem, Solution,
    solve,
};
use crate::geometry::Pose;
use crate::measurement::{Dataset, DistanceReading, Measurements};
use crate::robot::Robot;
use crate::simulation::{
    AfterHome, PlannedRow, SimulationError, TensionRange, Workspace, planned_readings,
};

/// Knowledge before the poses of a plan are measured, and the model of how further poses would be measured.
pub(super) struct InformationModel<'a> {
    /// The robot as identified from the poses already measured; only with the effects of its model.
    pub robot: Robot,
    /// Workspace of the platform.
    pub workspace: Workspace,
    options: &'a PlanOptions<'a>,
    tension: TensionRange,
    /// Effects of the model and those to be estimated.
    acting: Vec<BoundEffect>,
    free: Vec<BoundEffect>,
    /// The poses already measured, on the channels of the model, and the solution.
    known: Option<(Measurements, Solution)>,
}

impl<'a> InformationModel<'a> {
    pub fn new(
        robot: &Robot,
        options: &'a PlanOptions<'a>,
        tension: TensionRange,
    ) -> Result<Self, PlanError> {
        let mut model = Self {
            robot: robot.clone(),
            workspace: options.workspace.unwrap_or_else(|| Workspace::of(robot)),
            tension,
            acting: Vec::new(),
            free: options.effects.to_vec(),
            known: None,
            options,
        };
        if let Some(existing) = options.existing {
            model.include_existing(existing)?;
        }
        let held: Result<Vec<_>, _> = model
            .robot
            .effects_and_deviations()
            .map(|setting| BoundEffect::from_setting(setting, robot))
            .collect();
        model.acting = held.map_err(EstimationError::Effect)?;
        model.acting.extend(model.free.iter().cloned());
        if let Some(home) = model.robot.home {
            let rest = model.resting_pose(home.pose());
            if rest != home.pose() {
                model.robot.home = Some(home.at(&rest));
            }
        }
        Ok(model)
    }

    /// Identifies the robot from the poses already measured.
    fn include_existing(&mut self, existing: &Measurements) -> Result<(), PlanError> {
        let modelled = measurements_as_modelled(&self.robot, existing);
        let dataset = Dataset {
            measurements: modelled.map_err(EstimationError::Effect)?.into_owned(),
            robot: self.robot.clone(),
        };
        let problem = self.problem(&dataset)?;
        let quiet = &mut |_: &_| Control::Continue;
        let solution = solve(&problem, &Options::default(), quiet)?;
        if !solution.converged() {
            return Err(PlanError::Existing);
        }
        let held = problem.held_effects.len();
        let mut globals = solution.globals.clone();
        self.free = globals.effects.split_off(held);
        self.robot = globals.model(&self.robot);
        self.known = Some((dataset.measurements, solution));
        Ok(())
    }

    fn problem<'d>(&self, dataset: &'d Dataset) -> Result<Problem<'d>, PlanError> {
        let mut problem = Problem::new(dataset)?.with_method(self.options.method);
        problem.free_effects.clone_from(&self.free);
        Ok(problem.with_stated_tolerances())
    }

    /// Effects of the model and those to be estimated.
    pub fn acting(&self) -> &[BoundEffect] {
        &self.acting
    }

    /// Number of effects to be estimated, which come before the faults.
    pub fn free_effects(&self) -> usize {
        self.free.len()
    }

    /// Pose of the platform before the first pose of the plan.
    pub fn start(&self) -> Pose {
        self.robot
            .home
            .map_or(self.workspace.centre, |home| home.pose())
    }

    /// Labels of the poses of the plan, in order.
    pub fn labels(&self) -> impl Iterator<Item = i64> + Clone + use<> {
        let measured = self.known.iter().flat_map(|(data, _)| &data.labels);
        let last = measured.copied().max().unwrap_or(0);
        (last + 1..).take(self.options.poses)
    }

    /// Labels of candidates: as it is not known yet when each would be measured, they take the labels in turn.
    pub fn candidate_labels(&self, count: usize) -> impl Iterator<Item = i64> + use<> {
        self.labels().cycle().take(count)
    }

    /// Tensions that balance the platform, if there are any and all cables have paths.
    pub fn tensions(&self, pose: &Pose) -> Option<Vec<f64>> {
        self.after_home().tensions(pose).ok().flatten()
    }

    /// The pose near it at which the platform rests; the pose itself where its cables determine that it does not move.
    pub fn resting_pose(&self, pose: Pose) -> Pose {
        self.after_home().resting_pose(pose)
    }

    fn after_home(&self) -> AfterHome<'_> {
        AfterHome {
            robot: &self.robot,
            effects: &self.acting,
            range: &self.tension,
        }
    }

    /// Whether tensions balance the platform on the straight path between two poses; true if that cannot be checked.
    pub fn is_held_between(&self, from: &Pose, to: &Pose) -> bool {
        self.robot.unchecked_tensions().is_some()
            || self.tension.hold_between(&self.robot, from, to).is_ok()
    }

    /// Information of each of these poses, and the prior information.
    pub fn information(
        &self,
        planned: impl Iterator<Item = PlannedRow>,
    ) -> Result<ExpectedInformation, PlanError> {
        let (dataset, poses) = self.expected(planned, false)?;
        let problem = self.problem(&dataset)?;
        let mut information = ExpectedInformation::new(&problem, &poses);
        if let Some((_, solution)) = &self.known {
            if information.parameters != solution.parameters {
                return Err(PlanError::Existing);
            }
            information.common.clone_from(&solution.information);
        }
        Ok(information)
    }

    /// As [`Self::information`], on the geometry and the faults of the catalogue together.
    pub fn information_with_faults(
        &self,
        planned: impl Iterator<Item = PlannedRow>,
    ) -> Result<ExpectedInformation, PlanError> {
        let (dataset, poses) = self.expected(planned, true)?;
        // A fault is what lies outside the tolerance of a part, whose deviation is estimated beside it.
        let mut problem = self.problem(&dataset)?;
        problem
            .free_effects
            .extend(faults(&self.robot, &self.acting));
        let mut information = ExpectedInformation::new(&problem, &poses);
        // Poses already measured belong to the prior information.
        let planned = information.poses.split_off(self.measured_poses().count());
        for rows in std::mem::replace(&mut information.poses, planned) {
            information.common.gemm_tr(1.0, &rows, &rows, 1.0);
        }
        Ok(information)
    }

    /// The longest distances between home and these poses, by their places among them, with their lengths (m), and what they would
    /// tell; `None` if there are none.
    pub fn distances(
        &self,
        planned: impl Iterator<Item = PlannedRow>,
    ) -> Result<Option<(Vec<DistanceReading>, ExpectedDistances)>, PlanError> {
        let (mut dataset, poses) = self.expected(planned, false)?;
        let home = self.robot.home.map(|home| home.pose());
        let of_rows: Vec<Pose> = home.into_iter().chain(poses.iter().copied()).collect();
        dataset.measurements.distances = tape::candidates(&of_rows);
        let problem = self.problem(&dataset)?;
        let expected = ExpectedDistances::new(&problem, &poses);
        Ok(expected.map(|expected| (dataset.measurements.distances.clone(), expected)))
    }

    /// Robot and expected readings at all poses, measured and planned.
    pub fn dataset(&self, planned: impl Iterator<Item = PlannedRow>) -> Result<Dataset, PlanError> {
        let (dataset, _) = self.expected(planned, true)?;
        Ok(dataset)
    }

    /// The poses already measured except home, with their labels.
    fn measured_poses(&self) -> impl Iterator<Item = (i64, Pose)> {
        let known = self.known.iter();
        known.flat_map(|(data, solution)| {
            let labelled = solution
                .poses
                .iter()
                .map(|(row, pose)| (data.labels[*row], self.resting_pose(*pose)));
            labelled.filter(|(label, pose)| {
                let is_home = *label == 0 && self.robot.home.is_some();
                !is_home && self.tensions(pose).is_some()
            })
        })
    }

    /// Expected readings, and the poses except home; the poses already measured precede them if they are wanted.
    fn expected(
        &self,
        planned: impl Iterator<Item = PlannedRow>,
        with_measured: bool,
    ) -> Result<(Dataset, Vec<Pose>), PlanError> {
        let mut rows = Vec::new();
        if let Some(home) = &self.robot.home {
            let pose = home.pose();
            rows.push(PlannedRow {
                label: 0,
                tensions_n: (self.tensions(&pose))
                    .ok_or_else(|| SimulationError::infeasible(&self.tension, "the home pose"))?,
                pose,
            });
        }
        let first = rows.len();
        let measured = self.measured_poses().filter(|_| with_measured);
        rows.extend(measured.filter_map(|(label, pose)| {
            let tensions_n = self.tensions(&pose)?;
            Some(PlannedRow {
                label,
                pose,
                tensions_n,
            })
        }));
        rows.extend(planned);
        let mut truth = self.robot.clone();
        truth.deviations.clear();
        truth.effects = (self.acting.iter())
            .map(|bound| bound.setting(&self.robot))
            .collect();
        let mut measurements = planned_readings(&truth, &rows)?;
        if let Some((data, _)) = &self.known {
            measurements.leave_out_unread(data);
        }
        let dataset = Dataset {
            robot: self.robot.clone(),
            measurements,
        };
        let poses = rows[first..].iter().map(|row| row.pose).collect();
        Ok((dataset, poses))
    }
}

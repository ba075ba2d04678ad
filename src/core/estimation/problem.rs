//! What is to be estimated from which measurements: plain data.

use std::sync::Arc;

use super::EstimationError;
use super::solution::Solution;
use crate::effect::{BoundEffect, EffectRequest, PoseContexts};
use crate::measurement::Dataset;

/// How tensions enter the problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Problem R2: tensions are latent variables with their sensors' noise, static equilibrium holds.
    Joint,
    /// Problem R1: tensions are taken from the sensors as exact, no equilibrium.
    Simple,
}

/// Loss function of the standardised residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// Least squares.
    Square,
    /// Huber's: quadratic up to this many standard deviations, linear beyond.
    Huber(f64),
}

/// What is estimated besides the poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Geometry {
    /// Entry points, target plane, home pose and free effects.
    Estimated,
    /// Nothing: only poses are fitted, and the errors of the tension readings at home.
    Held,
}

/// What is done about the poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Poses {
    /// Every pose is estimated.
    Estimated,
    /// Poses are held at the external instrument's positions; rows without one are left out.
    /// Orientations are the instrument's, or the commanded ones where it measured none.
    HeldAtTracker,
}

/// An estimation problem.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// Robot and measurements.
    pub dataset: &'a Dataset,
    /// How tensions enter.
    pub method: Method,
    /// Loss function.
    pub loss: Loss,
    /// Whether geometry and effects are estimated.
    pub geometry: Geometry,
    /// Whether poses are estimated.
    pub poses: Poses,
    /// Effects of the model, their values held.
    pub held_effects: Vec<BoundEffect>,
    /// Effects whose parameters are estimated.
    pub free_effects: Vec<BoundEffect>,
    /// What effects depend on, where it is known better than from the commanded poses.
    pub(crate) contexts: Option<Arc<PoseContexts>>,
    /// A solution of the problem without its free effects, where one is known.
    pub(crate) known: Option<Arc<Solution>>,
}

impl<'a> Problem<'a> {
    /// The default problem for a dataset: joint method, least squares, everything estimated, the
    /// effects of the robot's model held.
    ///
    /// # Errors
    /// If the model names an effect that does not exist.
    pub fn new(dataset: &'a Dataset) -> Result<Self, EstimationError> {
        let held: Result<Vec<_>, _> = dataset
            .robot
            .effects
            .iter()
            .map(|setting| BoundEffect::from_setting(setting, &dataset.robot))
            .collect();
        Ok(Self {
            dataset,
            method: Method::Joint,
            loss: Loss::Square,
            geometry: Geometry::Estimated,
            poses: Poses::Estimated,
            held_effects: held?,
            free_effects: Vec::new(),
            contexts: None,
            known: None,
        })
    }

    /// Frees the requested effects.
    ///
    /// # Errors
    /// If an effect or cable does not exist.
    pub fn free(&mut self, requests: &[EffectRequest]) -> Result<(), EstimationError> {
        for request in requests {
            self.free_effects.extend(request.bind(&self.dataset.robot)?);
        }
        Ok(())
    }

    /// The same problem with what effects depend on taken at the poses of a solution, which are better known
    /// than those commanded; there it starts, too.
    #[must_use]
    pub fn at_poses_of(self, solution: &Solution) -> Self {
        Self {
            known: Some(Arc::new(solution.clone())),
            ..self.with_contexts_of(solution)
        }
    }

    /// The same problem with what effects depend on taken at the poses of a solution and with its entry points.
    #[must_use]
    pub fn with_contexts_of(mut self, solution: &Solution) -> Self {
        let data = &self.dataset.measurements;
        let mut poses = vec![solution.globals.home; data.len()];
        for (row, pose) in &solution.poses {
            poses[*row] = *pose;
        }
        let robot = solution.globals.model(&self.dataset.robot);
        let home = self.home_row();
        self.contexts = Some(Arc::new(PoseContexts::new(
            &robot, data, home, &poses, None,
        )));
        self
    }

    /// The same problem with another method.
    #[must_use]
    pub fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Whether static equilibrium is part of the problem.
    #[must_use]
    pub fn has_equilibrium(&self) -> bool {
        let robot = &self.dataset.robot;
        self.method == Method::Joint
            && robot.platform.mass_kg.is_some()
            && (robot.has_force_sensors() && !self.dataset.measurements.force_n.is_empty()
                || self.assumes_tensions())
    }

    /// Whether tensions are unknowns.
    #[must_use]
    pub fn has_latent_tension(&self) -> bool {
        self.method == Method::Joint
            && (!self.dataset.measurements.force_n.is_empty() || self.assumes_tensions())
    }

    /// Whether tensions, of which none is read, are unknowns with a prior: around those within the stated limits that hold the
    /// platform (`CableContext::tension_n`), with the standard deviation
    /// [`TensionLimits::sd_n`](crate::robot::TensionLimits::sd_n), while static equilibrium holds.
    #[must_use]
    pub fn assumes_tensions(&self) -> bool {
        self.method == Method::Joint
            && self.dataset.measurements.force_n.is_empty()
            && self.dataset.robot.unread_tension().is_some()
    }

    /// Standard deviation of a cable's tension before the equilibrium is asked (N): that of its sensor or of the assumed
    /// tension; `None` where tensions are not modelled.
    pub(super) fn tension_sd_n(&self, cable: usize) -> Option<f64> {
        if self.assumes_tensions() {
            return self.dataset.robot.unread_tension().map(|t| t.sd_n());
        }
        let sensor = self.dataset.robot.cables[cable].force_sensor?;
        Some(sensor.tension_sd_n)
    }

    /// Whether something is held at approximate poses while it is solved: what effects depend on, and the motion of the
    /// platform. It is then to be solved again at the poses found.
    #[must_use]
    pub fn depends_on_poses(&self) -> bool {
        !self.held_effects.is_empty()
            || !self.free_effects.is_empty()
            || self.dataset.measurements.rates.is_some()
            || self.assumes_tensions()
    }

    /// Rows of the measurements that are fitted, the home row excluded.
    #[must_use]
    pub fn pose_rows(&self) -> Vec<usize> {
        let measurements = &self.dataset.measurements;
        let home = self.home_row();
        (0..measurements.len())
            .filter(|row| Some(*row) != home)
            .filter(|row| {
                self.poses == Poses::Estimated || measurements.tracked_position_at(*row).is_some()
            })
            .collect()
    }

    /// Row of the home pose from which revolutions count; absolute lengths count from no pose, their
    /// row 0 is one like the others.
    #[must_use]
    pub fn home_row(&self) -> Option<usize> {
        self.dataset.robot.home?;
        if self.dataset.measurements.revolutions.is_empty() {
            return None;
        }
        self.dataset.measurements.home_row()
    }
}

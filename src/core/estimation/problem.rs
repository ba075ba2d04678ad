//! What is to be estimated from which measurements: plain data.

use std::sync::Arc;

use super::EstimationError;
use super::parameter::{Parameter, parameters_of};
use super::solution::Solution;
use crate::effect::{BoundEffect, EffectRequest, PoseContexts};
use crate::geometry::Pose;
use crate::measurement::Dataset;
use crate::robot::Robot;

/// Chi-square per degree of freedom up to which a solution is a good place to start from: beyond, what it lacks may
/// have led it into a minimum of its own.
const SOUND: f64 = 20.0;

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
    pub fn at_poses_of(mut self, solution: &Solution) -> Self {
        let data = &self.dataset.measurements;
        let mut poses = vec![solution.globals.home; data.len()];
        for (row, pose) in &solution.poses {
            poses[*row] = *pose;
        }
        let robot = &self.dataset.robot;
        let home = self.home_row();
        self.contexts = Some(Arc::new(PoseContexts::new(robot, data, home, &poses, None)));
        self.known = Some(Arc::new(solution.clone()));
        self
    }

    /// The solution at which solving starts instead of at nominal values and given poses.
    pub(super) fn start(&self) -> Option<&Solution> {
        let same = self.geometry == Geometry::Estimated && self.poses == Poses::Estimated;
        let sound = |s: &&Solution| s.converged() && s.chi2 < SOUND * s.degrees_of_freedom;
        self.known.as_deref().filter(|_| same).filter(sound)
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
            && robot.has_force_sensors()
            && !self.dataset.measurements.force_n.is_empty()
    }

    /// Whether tensions have noise of their own.
    #[must_use]
    pub fn has_latent_tension(&self) -> bool {
        self.method == Method::Joint && !self.dataset.measurements.force_n.is_empty()
    }

    /// The parameters that are estimated besides the poses.
    #[must_use]
    pub fn parameters(&self) -> Vec<Parameter> {
        parameters_of(self)
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

/// Values of everything that is common to all poses.
#[derive(Debug, Clone)]
pub struct Globals {
    /// Entry points, base frame (m).
    pub entry_points: Vec<[f64; 3]>,
    /// Offset of the laser's target plane (m).
    pub plane_offset_m: f64,
    /// Home pose.
    pub home: Pose,
    /// Error of the tension readings at home, per cable (N).
    pub home_tension_error_n: Vec<f64>,
    /// Effects, the held ones first.
    pub effects: Vec<BoundEffect>,
}

impl Globals {
    /// The nominal values of a problem.
    #[must_use]
    pub fn nominal(problem: &Problem<'_>) -> Self {
        let robot = &problem.dataset.robot;
        let entry = robot.cables.iter().map(|c| c.pulley.entry_point_m);
        let mut effects = problem.held_effects.clone();
        effects.extend(problem.free_effects.iter().cloned());
        Self {
            entry_points: entry.collect(),
            plane_offset_m: robot.laser.map_or(0.0, |l| l.target_plane.offset_m),
            home: robot.home.map_or_else(Pose::identity, |home| home.pose()),
            home_tension_error_n: vec![0.0; robot.cable_count()],
            effects,
        }
    }

    /// The values at which solving starts: those of the solution that is known, effects as they are bound.
    pub(super) fn start(problem: &Problem<'_>) -> Self {
        let nominal = Self::nominal(problem);
        match problem.start() {
            Some(known) => Self {
                effects: nominal.effects,
                ..known.globals.clone()
            },
            None => nominal,
        }
    }

    /// `robot` with these values: entry points, target plane, home pose and effects.
    #[must_use]
    pub fn model(&self, robot: &Robot) -> Robot {
        let mut model = robot.clone();
        for (cable, entry) in model.cables.iter_mut().zip(&self.entry_points) {
            cable.pulley.entry_point_m = *entry;
        }
        if let Some(laser) = &mut model.laser {
            laser.target_plane.offset_m = self.plane_offset_m;
        }
        if let Some(home) = &mut model.home {
            home.position_m = self.home.position.into();
            home.orientation_wxyz = self.home.orientation_wxyz();
        }
        model.effects = self
            .effects
            .iter()
            .map(|bound| bound.setting(robot))
            .collect();
        model
    }
}

//! The identification problem: what is estimated from which measurements.

use std::sync::Arc;

use super::EstimationError;
use super::parameter::ParameterId;
use super::solution::Solution;
use crate::effect::{
    BetterKnown, BoundEffect, EffectRequest, EffectSetting, PartDeviation, PoseContexts,
    part_deviations,
};
use crate::measurement::Dataset;
use crate::robot::PartTolerances;

/// Treatment of the tensions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Problem R2: tensions are latent variables with the noise of their sensors, and static equilibrium holds.
    Joint,
    /// Problem R1: tensions are taken from the sensors as exact, without equilibrium.
    Simple,
}

/// Loss function of the standardised residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// Least squares.
    Square,
    /// Huber loss: quadratic up to this many standard deviations, linear beyond.
    Huber(f64),
}

/// Treatment of the parameters common to all poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Geometry {
    /// Entry points, target plane, home pose and free effects.
    Estimated,
    /// Only the errors of the tension readings at home are estimated.
    Held,
}

/// Treatment of the poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Poses {
    /// Every pose is estimated.
    Estimated,
    /// Poses are held at the positions measured by the external instrument; rows without one are left out.
    /// Orientations are those of the instrument, or the commanded ones where it measured none.
    HeldAtTracker,
}

/// An estimation problem.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// Robot and measurements.
    pub dataset: &'a Dataset,
    /// Treatment of the tensions.
    pub method: Method,
    /// Loss function.
    pub loss: Loss,
    /// Treatment of geometry and effects: estimated or held.
    pub geometry: Geometry,
    /// Treatment of the poses: estimated or held.
    pub poses: Poses,
    /// Effects of the model, their values held.
    pub held_effects: Vec<BoundEffect>,
    /// Effects whose parameters are estimated.
    pub free_effects: Vec<BoundEffect>,
    /// Deviations of parts that the model states, their values held.
    pub held_deviations: Vec<BoundEffect>,
    /// Deviations of parts that are estimated, with their tolerances as priors.
    pub deviations: Vec<PartDeviation>,
    /// Contexts of the readings, where they are known better than from the commanded poses.
    pub(crate) contexts: Option<Arc<PoseContexts>>,
    /// A solution of the problem with other free effects or none, at which a solve starts.
    pub(crate) known: Option<Arc<Solution>>,
}

impl<'a> Problem<'a> {
    /// The default problem for a dataset: joint method, least squares, everything estimated, the
    /// effects of the robot's model held.
    ///
    /// # Errors
    /// If the model states an effect that does not exist.
    pub fn new(dataset: &'a Dataset) -> Result<Self, EstimationError> {
        let bound = |settings: &[EffectSetting]| -> Result<Vec<_>, _> {
            let bind = |setting| BoundEffect::from_setting(setting, &dataset.robot);
            settings.iter().map(bind).collect()
        };
        Ok(Self {
            dataset,
            method: Method::Joint,
            loss: Loss::Square,
            geometry: Geometry::Estimated,
            poses: Poses::Estimated,
            held_effects: bound(&dataset.robot.effects)?,
            free_effects: Vec::new(),
            held_deviations: bound(&dataset.robot.deviations)?,
            deviations: Vec::new(),
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
        self.remove_covered_deviations();
        Ok(())
    }

    /// The same problem with these effects estimated.
    #[must_use]
    pub fn with_effects(mut self, effects: Vec<BoundEffect>) -> Self {
        self.free_effects = effects;
        self.remove_covered_deviations();
        self
    }

    /// The same problem with the deviations of the parts estimated, with these tolerances as their priors.
    #[must_use]
    pub fn with_tolerances(self, tolerances: &PartTolerances) -> Self {
        let deviations = part_deviations(&self.dataset.robot, tolerances);
        self.with_deviations(deviations)
    }

    /// The same problem with the deviations of the parts estimated if the robot states tolerances; otherwise parts are as
    /// described.
    #[must_use]
    pub fn with_stated_tolerances(self) -> Self {
        match self.dataset.robot.tolerances.clone() {
            Some(tolerances) => self.with_tolerances(&tolerances),
            None => self,
        }
    }

    /// The same problem with these deviations estimated instead of those that the model states.
    #[must_use]
    pub fn with_deviations(mut self, deviations: Vec<PartDeviation>) -> Self {
        self.held_deviations.clear();
        self.deviations = deviations;
        self.remove_covered_deviations();
        self
    }

    /// The same problem, with the deviations held and estimated as in a solution.
    #[must_use]
    pub fn with_deviations_of(self, solution: &Solution) -> Self {
        let held = solution
            .globals
            .deviations
            .len()
            .saturating_sub(solution.deviation_count());
        let estimated = solution.globals.deviations[held..].iter().enumerate();
        let deviations = estimated.map(|(deviation, found)| {
            let mut bound = found.clone();
            let mut prior_sd = vec![0.0; bound.values.len()];
            for p in &solution.parameters {
                if let ParameterId::Deviation {
                    deviation: of,
                    parameter,
                } = p.id
                    && of == deviation
                {
                    bound.values[parameter] = bound.effect.parameters()[parameter].neutral;
                    prior_sd[parameter] = p.prior_sd.unwrap_or(0.0);
                }
            }
            PartDeviation { bound, prior_sd }
        });
        Self {
            held_deviations: solution.globals.deviations[..held].to_vec(),
            deviations: deviations.collect(),
            ..self
        }
    }

    /// Removes the deviations of parts whose whole deviation is the value of a free effect.
    pub(crate) fn remove_covered_deviations(&mut self) {
        let free = &self.free_effects;
        self.deviations
            .retain(|deviation| !free.iter().any(|bound| deviation.is_covered_by(bound)));
    }

    /// Every effect whose parameters have columns: the free ones, then the estimated deviations.
    pub(super) fn estimated(&self) -> impl Iterator<Item = &BoundEffect> {
        let deviations = self.deviations.iter().map(|deviation| &deviation.bound);
        self.free_effects.iter().chain(deviations)
    }

    /// The same problem with the contexts evaluated at the poses and tensions of a solution, which are better known
    /// than the commanded and measured ones, and with that solution as start.
    #[must_use]
    pub fn at_poses_of(self, solution: &Solution) -> Self {
        Self {
            known: Some(Arc::new(solution.clone())),
            ..self.with_contexts_of(solution)
        }
    }

    /// The same problem with the contexts evaluated at the poses, tensions and entry points of a solution.
    #[must_use]
    pub fn with_contexts_of(mut self, solution: &Solution) -> Self {
        let data = &self.dataset.measurements;
        let mut poses = vec![solution.globals.home; data.len()];
        for (row, pose) in &solution.poses {
            poses[*row] = *pose;
        }
        let robot = solution.globals.model(&self.dataset.robot);
        let home = self.home_row();
        let fitted = BetterKnown {
            directions: None,
            tensions_n: Some(&solution.tensions_n),
        };
        let contexts = PoseContexts::new(&robot, data, home, &poses, fitted);
        self.contexts = Some(Arc::new(contexts));
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

    /// Whether distances between poses take part.
    #[must_use]
    pub fn has_distances(&self) -> bool {
        self.poses == Poses::Estimated && !self.dataset.measurements.distances.is_empty()
    }

    /// Whether tensions are unknowns.
    #[must_use]
    pub fn has_latent_tension(&self) -> bool {
        self.method == Method::Joint
            && (!self.dataset.measurements.force_n.is_empty() || self.assumes_tensions())
    }

    /// Whether tensions that nothing measures are unknowns with a prior: centred at tensions within the stated limits that
    /// balance the platform (`CableContext::tension_n`), with the standard deviation
    /// [`TensionLimits::sd_n`](crate::robot::TensionLimits::sd_n), while static equilibrium holds.
    #[must_use]
    pub fn assumes_tensions(&self) -> bool {
        self.method == Method::Joint
            && self.dataset.measurements.force_n.is_empty()
            && self.dataset.robot.unread_tension().is_some()
    }

    /// Standard deviation of a cable's tension before the equilibrium is applied (N): that of its sensor or of the assumed
    /// tension; `None` where tensions are not modelled.
    pub(super) fn tension_sd_n(&self, cable: usize) -> Option<f64> {
        if self.assumes_tensions() {
            return self.dataset.robot.unread_tension().map(|t| t.sd_n());
        }
        let sensor = self.dataset.robot.cables[cable].force_sensor?;
        Some(sensor.tension_sd_n)
    }

    /// Whether quantities such as the contexts of effects and the motion of the platform are held at approximate poses during a
    /// solve. The problem must then be solved again at the estimated poses.
    #[must_use]
    pub fn depends_on_poses(&self) -> bool {
        !self.held_effects.is_empty()
            || !self.held_deviations.is_empty()
            || self.estimated().next().is_some()
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

    /// Row of the home pose from which revolutions are counted; `None` for absolute lengths, where
    /// row 0 is a pose like any other.
    #[must_use]
    pub fn home_row(&self) -> Option<usize> {
        self.dataset.robot.home?;
        if self.dataset.measurements.revolutions.is_empty() {
            return None;
        }
        self.dataset.measurements.home_row()
    }
}

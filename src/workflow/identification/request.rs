//! Identification requests, made from a session or from a dataset and command-line arguments alike.

use std::borrow::Cow;
use std::sync::Arc;

use tautline_core::effect::{BoundEffect, EffectError, EffectSetting, measurements_as_modelled};
use tautline_core::estimation::{EstimationError, Geometry, Loss, Method, Poses, Problem};
use tautline_core::measurement::Dataset;
use tautline_core::robot::{PartTolerances, Robot};
use tautline_session::Session;

/// Largest number of samples of a recording in motion that one fit uses; the diagnosis, which fits many models, uses fewer.
const MOST_IDENTIFIED_SAMPLES: usize = 1500;

/// A request: what to identify from which data.
#[derive(Debug, Clone)]
pub struct IdentificationRequest {
    /// Robot and measurements, without the excluded poses; readings are on the channels that the model states.
    pub dataset: Arc<Dataset>,
    /// Treatment of the tensions.
    pub method: Method,
    /// Effects whose parameters are identified; those of the robot's own model are held.
    pub effects: Vec<BoundEffect>,
    /// Other options.
    pub options: IdentificationOptions,
    /// Whether the result lists every reading. A summary does not, and needs a fraction of the memory.
    pub lists_readings: bool,
}

/// Options besides the method; the defaults are those of a usual identification.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdentificationOptions {
    /// Loss function of the standardised residuals.
    pub loss: Loss,
    /// Treatment of geometry and effects: estimated or held.
    pub geometry: Geometry,
    /// Treatment of the poses: estimated or held.
    pub poses: Poses,
    /// Tolerances of the parts.
    pub tolerances: TolerancesUsed,
}

/// Tolerances of the parts with which a robot is identified.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TolerancesUsed {
    /// Those that the robot states; if it states none, its parts count as exact.
    #[default]
    Stated,
    /// Those of the catalogue.
    Typical,
    /// None: all parts count as exact.
    None,
}

impl TolerancesUsed {
    /// The tolerances for a robot; `None` if its parts count as exact.
    #[must_use]
    pub fn of(self, robot: &Robot) -> Option<PartTolerances> {
        match self {
            Self::Stated => robot.tolerances.clone(),
            Self::Typical => Some(PartTolerances::typical()),
            Self::None => None,
        }
    }
}

impl Default for IdentificationOptions {
    fn default() -> Self {
        Self {
            loss: Loss::Square,
            geometry: Geometry::Estimated,
            poses: Poses::Estimated,
            tolerances: TolerancesUsed::default(),
        }
    }
}

impl IdentificationOptions {
    /// The problem without free effects, which starts at the values of the robot.
    pub fn problem(
        self,
        dataset: &Dataset,
        method: Method,
    ) -> Result<Problem<'_>, EstimationError> {
        let mut problem = Problem::new(dataset)?.with_method(method);
        problem.loss = self.loss;
        problem.geometry = self.geometry;
        problem.poses = self.poses;
        Ok(match self.tolerances.of(&dataset.robot) {
            Some(tolerances) => problem.with_tolerances(&tolerances),
            None => problem,
        })
    }
}

impl IdentificationRequest {
    /// Sentence on the tolerances of the parts for which the standard deviations allow.
    #[must_use]
    pub fn tolerances_sentence(&self) -> &'static str {
        match self.options.tolerances.of(&self.dataset.robot) {
            Some(PartTolerances::Stated(_)) => {
                "Standard deviations allow for the stated tolerances of the parts."
            }
            Some(PartTolerances::Typical(_)) => {
                "Standard deviations allow for typical tolerances of the parts."
            }
            None => {
                "Standard deviations hold for exact parts; --tolerances typical allows for those of real ones."
            }
        }
    }

    /// A request to identify the robot of a dataset with its raw measurements, together with `effects`; recordings in motion are
    /// thinned to independent samples.
    ///
    /// Effects without a parameter to estimate, such as exchanged channels, become part of the robot's model; effects at a pose
    /// that is not in the data do nothing and are left out.
    ///
    /// # Errors
    /// If an effect does not fit the robot.
    pub fn new(
        mut dataset: Dataset,
        method: Method,
        effects: &[EffectSetting],
    ) -> Result<Self, EffectError> {
        let mut free = Vec::new();
        for setting in effects {
            let bound = BoundEffect::to_estimate(setting, &dataset.robot)?;
            if !bound.effect.is_estimable() {
                dataset.robot.effects.push(setting.clone());
            } else if bound.check_poses(&dataset.measurements).is_ok() {
                free.push(bound);
            }
        }
        // Of a recording in motion, only samples with independent noise are used.
        if let Some(samples) = dataset
            .measurements
            .independent_samples(&dataset.robot, MOST_IDENTIFIED_SAMPLES)
        {
            dataset.measurements = samples;
        }
        // Only exchanged channels change the measurements.
        let modelled = measurements_as_modelled(&dataset.robot, &dataset.measurements)?;
        if let Cow::Owned(modelled) = modelled {
            dataset.measurements = modelled;
        }
        Ok(Self {
            dataset: Arc::new(dataset),
            method,
            effects: free,
            options: IdentificationOptions::default(),
            lists_readings: true,
        })
    }

    /// A request to estimate the poses of a dataset only, with the geometry and effects of `model` kept fixed.
    ///
    /// # Errors
    /// One sentence, if the model has other cables than the robot of the dataset, or its effects do not fit.
    pub fn of_poses(measured: Dataset, model: Robot, poses: Poses) -> Result<Self, String> {
        let cables = measured.robot.cable_count();
        if model.cable_count() != cables {
            return Err(format!(
                "found {} cables, expected the {cables} of the dataset",
                model.cable_count()
            ));
        }
        let dataset = Dataset {
            robot: model,
            measurements: measured.measurements,
        };
        let request = Self::new(dataset, Method::Joint, &[]).map_err(|error| error.to_string())?;
        let options = IdentificationOptions {
            geometry: Geometry::Held,
            poses,
            // The deviations of the model are held, too.
            tolerances: TolerancesUsed::None,
            ..request.options
        };
        Ok(Self { options, ..request })
    }

    /// The request that a session's settings state.
    ///
    /// # Errors
    /// If an effect does not fit the robot.
    pub fn of_session(session: &Session) -> Result<Self, EffectError> {
        let settings = &session.settings.identification;
        let method = solved_method(settings.method);
        Self::new(session.dataset(), method, &settings.effects)
    }
}

/// Treatment of the tensions for a method of a session. The published method has no weights and no standard deviations:
/// where they are needed, the joint method replaces it.
#[must_use]
pub fn solved_method(method: tautline_session::Method) -> Method {
    match method {
        tautline_session::Method::Simple => Method::Simple,
        tautline_session::Method::Joint | tautline_session::Method::Published => Method::Joint,
    }
}

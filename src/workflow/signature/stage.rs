//! A run without noise in which every effect is simulated once.

use std::cell::OnceCell;

use tautline_core::effect::{BoundEffect, Effect, EffectSetting, Scope};
use tautline_core::estimation::{Control, Method, Progress};
use tautline_core::geometry::Pose;
use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::Robot;
use tautline_core::simulation::{
    Recording, SimulationError, SimulationOptions, TrueGeometry, record, simulate,
};

use super::gallery::Signature;
use super::image::{Image, LEAST_SEEN, MOST_IMAGES, image_of, order, residuals, strengths};
use super::size_in_words;
use crate::identification::{Identification, IdentificationRequest, identify};

/// Number of poses if the robot has none of its own: enough for a picture, and a large redundancy.
const POSES: usize = 40;
/// Seed of these poses.
const SEED: u64 = 1;
/// The recording for effects that act in motion alone.
const MOTION: Recording = Recording {
    duration_s: 30.0,
    rate_hz: 4.0,
    correlation_s: 0.0,
};

/// A robot exactly as described, at poses that it can hold.
pub(super) struct Stage {
    robot: Robot,
    options: SimulationOptions,
    /// Readings without any effect.
    still: Measurements,
    moving: OnceCell<Result<Measurements, String>>,
}

impl Stage {
    /// Uses the given poses if the robot can hold all of them in the simulation, otherwise poses drawn from its workspace.
    ///
    /// # Errors
    /// If the robot can be held nowhere.
    pub fn new(robot: &Robot, poses: &[Pose]) -> Result<Self, SimulationError> {
        let mut robot = robot.clone();
        // Tolerances would hide part of the effect.
        robot.tolerances = None;
        robot.deviations.clear();
        let drawn = SimulationOptions {
            geometry: TrueGeometry::Nominal,
            noise: false,
            ..SimulationOptions::new(POSES, SEED)
        };
        let commanded = drawn.clone().commanding(poses.to_vec());
        let own = (!poses.is_empty()).then(|| simulate(&robot, &commanded).ok());
        let (run, options) = match own.flatten() {
            Some(run) => (run, commanded),
            None => (simulate(&robot, &drawn)?, drawn),
        };
        Ok(Self {
            still: run.dataset.measurements,
            moving: OnceCell::new(),
            options,
            robot,
        })
    }

    /// Number of poses.
    pub fn poses(&self) -> usize {
        self.still.len()
    }

    /// The image of an effect at typical size.
    pub fn signature(&self, effect: &'static Effect) -> Signature {
        let bound = self.typical(effect);
        let images = bound.as_ref().map_err(String::clone);
        let images = images.and_then(|bound| self.images(bound));
        let said = |say: fn(&BoundEffect, &Robot) -> String| {
            let bound = bound.as_ref().ok();
            bound
                .map(|bound| say(bound, &self.robot))
                .unwrap_or_default()
        };
        Signature {
            effect,
            size: bound.as_ref().map(size_in_words).unwrap_or_default(),
            cause: said(BoundEffect::cause),
            workshop: said(BoundEffect::workshop),
            images,
        }
    }

    /// The effect on the first possible cables, in the middle of the poses.
    fn typical(&self, effect: &'static Effect) -> Result<BoundEffect, String> {
        let cables = self.robot.cables.iter().map(|cable| cable.name.clone());
        let targets: Vec<String> = match effect.scope() {
            Scope::Cable => cables.take(1).collect(),
            Scope::Pair => cables.take(2).collect(),
            Scope::CableOrAll | Scope::Robot => Vec::new(),
        };
        let labels = &self.still.labels;
        let middle = labels.get(labels.len() / 2).copied().unwrap_or_default();
        // The label of a pose, or the row of a distance.
        let given = (effect.parameters().iter()).filter(|p| p.discrete && !p.optional);
        let setting = EffectSetting {
            effect: effect.id().to_owned(),
            targets,
            parameters: given.map(|p| (p.name.to_owned(), middle as f64)).collect(),
        };
        let bound = BoundEffect::to_estimate(&setting, &self.robot);
        Ok(bound.map_err(|error| error.to_string())?.at_typical_size())
    }

    fn images(&self, bound: &BoundEffect) -> Result<Vec<Image>, String> {
        let is_in_motion = bound.effect.is_in_motion();
        let still = if is_in_motion {
            self.moving()?
        } else {
            &self.still
        };
        let options = SimulationOptions {
            effects: vec![bound.setting(&self.robot)],
            ..self.options.clone()
        };
        let run = match is_in_motion {
            true => record(&self.robot, &options, &MOTION),
            false => simulate(&self.robot, &options),
        };
        let run = run.map_err(|error| format!("It cannot be simulated here: {error}."))?;
        if run.dataset.measurements == *still {
            return Err("No reading of this robot depends on it.".to_owned());
        }
        let fit = self.identified(run.dataset.measurements)?;
        let residuals = residuals(&fit);
        let kinds = strengths(&residuals, |one| order(one.quantity));
        let seen = kinds.iter().filter(|(.., largest)| *largest >= LEAST_SEEN);
        let kinds = seen.take(MOST_IMAGES).filter_map(|(place, ..)| {
            let mut all = residuals.iter();
            all.find(|one| order(one.quantity) == *place)
        });
        let kinds = kinds.map(|one| one.quantity);
        let images: Vec<Image> = kinds
            .map(|quantity| image_of(&fit, bound, (quantity, &residuals)))
            .collect();
        match images.is_empty() {
            true => Err(
                "It leaves no trace in the residuals: the identification takes it for geometry."
                    .to_owned(),
            ),
            false => Ok(images),
        }
    }

    /// Readings of a recording in motion without any effect.
    fn moving(&self) -> Result<&Measurements, String> {
        let recorded = self.moving.get_or_init(|| {
            let run = record(&self.robot, &self.options, &MOTION);
            let run = run.map_err(|error| format!("No motion can be simulated here: {error}."));
            Ok(run?.dataset.measurements)
        });
        recorded.as_ref().map_err(String::clone)
    }

    fn identified(&self, measurements: Measurements) -> Result<Identification, String> {
        let dataset = Dataset {
            robot: self.robot.clone(),
            measurements,
        };
        let failed = |error: String| format!("With it nothing can be identified: {error}.");
        let request = IdentificationRequest::new(dataset, Method::Joint, &[]);
        let request = request.map_err(|error| failed(error.to_string()))?;
        let observe = &mut |_: &Progress| Control::Continue;
        identify(&request, observe).map_err(|error| failed(error.to_string()))
    }
}

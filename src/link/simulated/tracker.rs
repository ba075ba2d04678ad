//! An external instrument that observes a simulated robot.

use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use tautline_core::geometry::Twist;
use tautline_session::CheckPose;

use super::Shared;
use crate::controller::Instrument;
use crate::error::LinkError;

/// Measures the true pose with noise.
pub struct SimulatedTracker {
    shared: Arc<Shared>,
    position_sd_m: f64,
    orientation_sd_rad: f64,
    rng: ChaCha8Rng,
}

impl SimulatedTracker {
    pub(super) fn new(shared: Arc<Shared>, sds: (f64, f64), seed: u64) -> Self {
        Self {
            shared,
            position_sd_m: sds.0,
            orientation_sd_rad: sds.1,
            rng: ChaCha8Rng::seed_from_u64(seed),
        }
    }
}

impl Instrument for SimulatedTracker {
    fn identity(&self) -> String {
        "Simulated tracker".to_owned()
    }

    fn measure(&mut self) -> Result<CheckPose, LinkError> {
        let pose = self.shared.motion().at(self.shared.now_s()).pose;
        let noise = Twist::from_fn(|k, _| {
            let sd = if k < 3 {
                self.position_sd_m
            } else {
                self.orientation_sd_rad
            };
            sd * self.rng.sample::<f64, _>(StandardNormal)
        });
        let seen = pose.perturbed(&noise);
        Ok(CheckPose {
            position_m: seen.position.into(),
            orientation_wxyz: Some(seen.orientation_wxyz()),
        })
    }
}

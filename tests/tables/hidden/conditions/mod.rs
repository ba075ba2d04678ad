//! Imperfect measurements: noise that differs from the description, heavy tails, mild model error, empty cells, and
//! several rows per standstill.

mod holes;
mod model_error;
mod noise;
mod standstills;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

pub use noise::{NoiseFactors, add_noise, normal};

pub(super) use holes::empty_cells;
pub(super) use model_error::add_model_error;
pub(super) use standstills::{REPEATS, add_shared_errors, repeated};

use super::template::log_uniform;

/// How the measurements deviate from the description.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Circumstances {
    /// Not at all.
    AsStated,
    /// Noise of each kind of reading is half to twice the described one.
    OtherNoise,
    /// The model is slightly wrong everywhere.
    ModelError,
    /// Noise has heavier tails than a normal distribution.
    HeavyTails,
    /// Cells are empty.
    Holes,
    /// Several rows belong to one standstill and share errors.
    Standstills,
}

impl Circumstances {
    /// Short description for tables; empty if nothing deviates.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::AsStated => "",
            Self::OtherNoise => "noise 0.5 to 2 times as stated",
            Self::ModelError => "model slightly wrong everywhere",
            Self::HeavyTails => "heavy tails",
            Self::Holes => "empty cells",
            Self::Standstills => "standstills that share errors",
        }
    }
}

/// Range of the ratio of actual and described noise.
const OTHER_NOISE: [f64; 2] = [0.5, 2.0];
/// Range of the root mean square of mild model error, in described standard deviations.
const MODEL_ERROR: [f64; 2] = [1.0, 2.0];
/// Degrees of freedom of Student's t distribution for heavy tails.
const TAILS: f64 = 4.0;
/// Error that the rows of a standstill share, in described standard deviations.
const SHARED: f64 = 1.5;

/// Parameters of the imperfections of one dataset.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Conditions {
    /// Ratio of actual and described noise.
    pub noise: NoiseFactors,
    /// Degrees of freedom of Student's t distribution; `None` for normal noise.
    pub tails: Option<f64>,
    /// Root mean square of a smooth error in every channel, in described standard deviations.
    pub model_error: f64,
    /// Error that the rows of a standstill share, in described standard deviations; 0 if there is one row per
    /// standstill.
    pub shared: f64,
    /// Whether cells are empty.
    pub holes: bool,
}

impl Conditions {
    /// Draws the parameters at random.
    pub fn draw(circumstances: Circumstances, rng: &mut ChaCha8Rng) -> Self {
        let plain = Self::default();
        match circumstances {
            Circumstances::AsStated => plain,
            Circumstances::OtherNoise => Self {
                noise: NoiseFactors::each(|| log_uniform(OTHER_NOISE, rng)),
                ..plain
            },
            Circumstances::ModelError => Self {
                model_error: rng.random_range(MODEL_ERROR[0]..=MODEL_ERROR[1]),
                ..plain
            },
            Circumstances::HeavyTails => Self {
                tails: Some(TAILS),
                ..plain
            },
            Circumstances::Holes => Self {
                holes: true,
                ..plain
            },
            Circumstances::Standstills => Self {
                shared: SHARED,
                ..plain
            },
        }
    }

    /// Noise factors that include the other errors as if they were noise. They determine which effects count as
    /// visible.
    pub(super) fn equivalent_noise(&self) -> NoiseFactors {
        let mut variance = 1.0 + self.model_error.powi(2);
        if self.shared > 0.0 {
            // Averaging the rows of a standstill reduces their noise but not the error that they share.
            variance = REPEATS as f64 * self.shared.powi(2) + 1.0;
        }
        self.noise.times(variance.sqrt())
    }
}

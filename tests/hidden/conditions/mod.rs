//! How data are measured: noise that is not as stated, heavy tails, a model that is slightly wrong everywhere, empty
//! cells, several rows in one standstill.

mod holes;
mod model_error;
mod noise;
mod standstills;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

pub use noise::{NoiseFactors, normal};

pub(super) use holes::empty_cells;
pub(super) use model_error::add_model_error;
pub(super) use noise::add_noise;
pub(super) use standstills::{REPEATS, add_shared_errors, repeated};

use super::template::log_uniform;

/// In what respect measuring is not as the description says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Circumstances {
    /// In none.
    AsStated,
    /// Noise of every kind of reading is half to twice what is stated.
    OtherNoise,
    /// The model is slightly wrong everywhere.
    ModelError,
    /// Noise has heavier tails than the normal distribution.
    HeavyTails,
    /// Cells are empty.
    Holes,
    /// Several rows belong to one standstill and share errors.
    Standstills,
}

impl Circumstances {
    /// In a few words; empty where all is as stated.
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

/// Noise over the stated one where it is not as stated.
const OTHER_NOISE: [f64; 2] = [0.5, 2.0];
/// Mild model error, in stated standard deviations.
const MODEL_ERROR: [f64; 2] = [1.0, 2.0];
/// Degrees of freedom of Student's distribution with heavy tails.
const TAILS: f64 = 4.0;
/// Error that the rows of a standstill share, in stated standard deviations.
const SHARED: f64 = 1.5;

/// How one data set is measured.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Conditions {
    /// Actual over stated noise.
    pub noise: NoiseFactors,
    /// Degrees of freedom of Student's distribution; none: normal.
    pub tails: Option<f64>,
    /// Root mean square of a smooth error in every channel, in stated standard deviations.
    pub model_error: f64,
    /// Error that rows of a standstill share, in stated standard deviations; 0: every row is one of its own.
    pub shared: f64,
    /// Whether cells are empty.
    pub holes: bool,
}

impl Conditions {
    /// Draws conditions.
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

    /// Noise that tells as much as these conditions do: what is not noise counts as if it were. By it is decided what
    /// can be seen.
    pub(super) fn worth(&self) -> NoiseFactors {
        let mut variance = 1.0 + self.model_error.powi(2);
        if self.shared > 0.0 {
            // The rows of a standstill are worth one whose noise is averaged and whose shared error is not.
            variance = REPEATS as f64 * self.shared.powi(2) + 1.0;
        }
        self.noise.times(variance.sqrt())
    }
}

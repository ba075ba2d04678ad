//! Recordings in motion.

use anyhow::Result;
use tautline_core::robot::{PerAxis, Robot, Tracker};
use tautline_core::simulation::Recording;

use crate::BadInput;

/// An external instrument typical of camera systems that track markers.
const TRACKER: Tracker = Tracker {
    position_sd_m: PerAxis::Same(1e-3),
    orientation_sd_rad: Some(1e-3),
};
/// Largest number of samples of a recording that is simulated.
const MOST_SIMULATED_SAMPLES: f64 = 1e6;

#[derive(Debug, clap::Args)]
pub struct Motion {
    /// Record the robot in smooth motion for this time (s), instead of poses at rest
    #[arg(long, value_name = "SECONDS", conflicts_with_all = ["poses", "phases"])]
    motion: Option<f64>,
    /// Samples per second of a recording in motion (Hz)
    #[arg(long, value_name = "HZ", default_value_t = 100.0, requires = "motion")]
    rate_hz: f64,
    /// Time in which the correlation of the noise of a recording falls to 1/e (ms); 0: the noise of the samples is independent
    #[arg(long, value_name = "MS", default_value_t = 20.0, requires = "motion")]
    noise_correlation_ms: f64,
    /// Give the robot an external instrument of 1 mm and 1 mrad if it has none
    #[arg(long)]
    tracker: bool,
}

impl Motion {
    /// Adds the external instrument, if requested.
    pub fn equip(&self, robot: &mut Robot) {
        if self.tracker {
            robot.tracker.get_or_insert(TRACKER);
        }
    }

    /// Parameters of the recording; `None` for poses at rest.
    pub fn recording(&self) -> Result<Option<Recording>> {
        let Some(duration_s) = self.motion else {
            return Ok(None);
        };
        let positive = |name: &str, value: f64| match value.is_finite() && value > 0.0 {
            true => Ok(()),
            false => Err(BadInput::new(format!(
                "{name}: found {value}, expected a number above 0"
            ))),
        };
        positive("--motion", duration_s)?;
        positive("--rate-hz", self.rate_hz)?;
        if duration_s * self.rate_hz > MOST_SIMULATED_SAMPLES {
            let message = format!(
                "--motion: found {} samples, expected at most {MOST_SIMULATED_SAMPLES}",
                duration_s * self.rate_hz
            );
            return Err(BadInput::new(message));
        }
        let correlation_s = 1e-3 * self.noise_correlation_ms;
        if !(correlation_s.is_finite() && correlation_s >= 0.0) {
            let message = format!(
                "--noise-correlation-ms: found {}, expected 0 or more",
                self.noise_correlation_ms
            );
            return Err(BadInput::new(message));
        }
        Ok(Some(Recording {
            duration_s,
            rate_hz: self.rate_hz,
            correlation_s,
        }))
    }
}

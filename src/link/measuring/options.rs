//! Options of a measuring run and the prediction of readings.

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_core::simulation::{Epoch, QuasiStaticRobot, TensionRange, ambient_temperature_c};

/// Rate limit at rest, in standard deviations of a single sample per settling time.
const STILL: f64 = 6.5;
/// Largest plausible error of a prediction, in prior standard deviations.
const PLAUSIBLE: f64 = 4.0;

/// Rates of change of the fastest channel of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rates {
    /// Cable lengths (m/s).
    pub length_m_per_s: f64,
    /// Tensions (N/s).
    pub tension_n_per_s: f64,
    /// Laser distance (m/s).
    pub laser_m_per_s: f64,
}

/// Options of a measuring run.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuringOptions {
    /// Number of samples averaged at each pose.
    pub samples: usize,
    /// Rates below which the platform is at rest.
    pub still: Rates,
    /// Time for which it must be at rest (s), on the controller's clock.
    pub settle_time_s: f64,
    /// Timeout from command to rest (s), on the controller's clock; and for new readings, on the caller's.
    pub timeout_s: f64,
    /// Range of tensions without a warning.
    pub tension: TensionRange,
    /// Whether a pose without laser distance is rejected.
    pub laser_required: bool,
    /// Whether a run pauses when the connection is lost, instead of failing.
    pub waits_for_connection: bool,
    /// Largest plausible deviation of a length or laser distance from its prediction (m).
    pub plausible_m: f64,
}

impl MeasuringOptions {
    /// Default options for the noise and the priors of a robot.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        let samples = 10;
        let settle_time_s = 1.0;
        // For one sample, as the described standard deviation is that of the mean.
        let per_second = STILL * f64::from(samples).sqrt() / settle_time_s;
        let cables = robot.cables.iter();
        let length_sd_m = largest(cables.clone().map(|c| c.winch.length_sd_m));
        let sensors = cables.clone().filter_map(|c| c.force_sensor);
        let tension_sd_n = largest(sensors.map(|s| s.tension_sd_n));
        let entry_sds = cables.flat_map(|c| c.pulley.entry_point_sd_m.each());
        let entry_sd_m = largest(entry_sds.flatten());
        let plane_sd_m = robot.laser.and_then(|l| l.target_plane.offset_sd_m);
        Self {
            samples: samples as usize,
            still: Rates {
                length_m_per_s: per_second * length_sd_m,
                tension_n_per_s: per_second * tension_sd_n,
                laser_m_per_s: per_second * robot.laser.map_or(0.0, |laser| laser.sd_m),
            },
            settle_time_s,
            timeout_s: 60.0,
            tension: TensionRange::of(robot),
            laser_required: robot.laser.is_some(),
            waits_for_connection: false,
            plausible_m: PLAUSIBLE * entry_sd_m.max(plane_sd_m.unwrap_or(0.0)).max(1e-3),
        }
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Predicted readings at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Motor revolutions since home.
    pub revolutions: Vec<f64>,
    /// Laser distance (m).
    pub laser_m: Option<f64>,
}

/// Predicts the readings at a commanded pose; `None` if it cannot.
pub type Predictor = Box<dyn Fn(&Pose) -> Option<Prediction> + Send>;

/// Prediction by a robot or model with tensions in a range, elasticity and sag included; effects are as at the start
/// of the run. Returns `None` for a robot without a home pose.
#[must_use]
pub fn predict_by(robot: &Robot, tension: TensionRange) -> Predictor {
    let begin = Epoch {
        label: 0,
        time_s: 0.0,
        temperature_c: ambient_temperature_c(0.0),
    };
    let standing = QuasiStaticRobot::new(robot.clone(), tension, begin).ok();
    Box::new(move |pose| {
        let robot = standing.as_ref()?;
        let at = Epoch { label: 1, ..begin };
        let readings = robot.at(at, pose, pose).ok()?.readings;
        Some(Prediction {
            revolutions: readings.revolutions.row(0).to_vec(),
            laser_m: readings.laser_m.first().copied(),
        })
    })
}

//! Machine-readable form of a precalibration.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::cable::ElongationSurface;
use tautline_core::instrument::{ForceSensorCalibration, HomeMeasurement, WinchCalibration};
use tautline_core::robot::{Cable, Robot};
use tautline_session::{PhaseData, VersionedFile};

use super::{Calibration, ElongationFit, PerCable};

/// Results of phases 1 and 2; empty or null where nothing was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Precalibration {
    /// Winches of winch.csv, in the order of the cables.
    pub winches: Vec<WinchResult>,
    /// Force sensors of force.csv, in the order of the cables.
    pub force_sensors: Vec<ForceResult>,
    /// Home pose of home.csv.
    pub home: Option<HomeResult>,
    /// Elongation surface of elongation.csv.
    pub elongation: Option<ElongationResult>,
}

/// One winch: `length = cable_per_revolution rev + offset + stretch tension`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WinchResult {
    /// Name of the cable.
    pub cable: String,
    /// Number of pairs.
    pub pairs: usize,
    /// Cable per motor revolution (m).
    pub cable_per_revolution_m: f64,
    /// Its standard deviation (m).
    pub cable_per_revolution_sd_m: f64,
    /// Cable per motor revolution according to robot.json (m).
    pub nominal_cable_per_revolution_m: f64,
    /// Length at zero revolutions (m).
    pub offset_m: f64,
    /// Its standard deviation (m).
    pub offset_sd_m: f64,
    /// Stretch per newton (m/N); null if the tensions do not determine it.
    pub stretch_m_per_n: Option<f64>,
    /// Its standard deviation (m/N).
    pub stretch_sd_m_per_n: Option<f64>,
    /// Standard deviation of a length reading (m).
    pub residual_sd_m: f64,
    /// Largest absolute residual (m).
    pub largest_residual_m: f64,
    /// Whether the largest residual is below the limit.
    pub passed: bool,
}

/// One force sensor: `reading = gain tension + bias`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ForceResult {
    /// Name of the cable.
    pub cable: String,
    /// Number of pairs.
    pub pairs: usize,
    /// Gain, reading per tension.
    pub tension_gain: f64,
    /// Its standard deviation.
    pub tension_gain_sd: f64,
    /// Reading at zero tension (N).
    pub bias_n: f64,
    /// Its standard deviation (N).
    pub bias_sd_n: f64,
    /// Standard deviation of a tension (N).
    pub residual_sd_n: f64,
    /// Largest absolute residual as a tension (N).
    pub largest_residual_n: f64,
    /// Whether the largest residual is below the limit.
    pub passed: bool,
}

/// The platform on its home reference platform, in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomeResult {
    /// Position (m).
    pub position_m: [f64; 3],
    /// Orientation, quaternion w first.
    pub orientation_wxyz: [f64; 4],
    /// Standard deviations of the position, from those of the sensors (m).
    pub position_sd_m: [f64; 3],
    /// Standard deviations of the rotation vector, from those of the sensors (rad).
    pub orientation_sd_rad: [f64; 3],
    /// Standard deviation of the position over the repeats (m); null without complete repeats.
    pub position_repeatability_m: Option<[f64; 3]>,
    /// Standard deviation of the rotation vector over the repeats (rad).
    pub orientation_repeatability_rad: Option<[f64; 3]>,
    /// Largest difference between the mean distances and those at the estimated pose (m).
    pub largest_residual_m: f64,
    /// The six sensors.
    pub sensors: Vec<HomeSensorResult>,
}

/// Repeats of one distance sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomeSensorResult {
    /// Number of the sensor, from 1.
    pub sensor: usize,
    /// Number of readings.
    pub readings: usize,
    /// Mean distance (m).
    pub mean_m: f64,
    /// Standard deviation of a reading (m); null for a single one.
    pub sd_m: Option<f64>,
    /// Whether the mean lies in the measuring range of the sensor.
    pub in_range: bool,
}

/// Elongation of the cables over length and tension.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ElongationResult {
    /// Number of measurements.
    pub points: usize,
    /// The surface, as in robot.json.
    pub surface: ElongationSurface,
    /// Largest absolute residual (m).
    pub largest_residual_m: f64,
    /// Cross-validation of each degree.
    pub degrees: Vec<DegreeResult>,
}

/// Cross-validation of one degree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DegreeResult {
    /// Total degree.
    pub degree: usize,
    /// Root mean square error at held-out measurements (m); null if there are too few.
    pub error_m: Option<f64>,
}

impl VersionedFile for Precalibration {
    const FORMAT: &'static str = "tautline-precalibration";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
}

/// Reasons why there is no precalibration.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    /// The dataset has no calibration table.
    NoTables,
    /// A fit failed: file of the dataset; the item, such as a cable, with the problem.
    Fit(&'static str, String),
}

impl Failure {
    /// In a sentence, for the dataset in `folder`.
    #[must_use]
    pub fn sentence(&self, folder: &Path) -> String {
        match self {
            Self::NoTables => format!(
                "{}: found none of winch.csv, force.csv, home.csv and elongation.csv, expected at least one",
                folder.display()
            ),
            Self::Fit(file, message) => format!("{}: {message}", folder.join(file).display()),
        }
    }
}

/// A successful fit to a file of the dataset.
fn fitted<'a, F>(file: &'static str, fit: &'a Result<F, String>) -> Result<&'a F, Failure> {
    fit.as_ref()
        .map_err(|message| Failure::Fit(file, message.clone()))
}

impl Precalibration {
    /// The document of successful fits.
    ///
    /// # Errors
    /// If there is no calibration table, and the first fit that failed.
    pub fn of(robot: &Robot, phases: &PhaseData, fits: &Calibration) -> Result<Self, Failure> {
        let nothing = phases.winch.is_empty()
            && phases.force.is_empty()
            && phases.home.is_empty()
            && phases.elongation.is_empty();
        if nothing {
            return Err(Failure::NoTables);
        }
        let winches = fits.winches.iter().map(|PerCable { cable, fit }| {
            let fit = fitted("winch.csv", fit)?;
            Ok(WinchResult::of(&robot.cables[*cable], fit))
        });
        let force_sensors = fits.force_sensors.iter().map(|PerCable { cable, fit }| {
            let fit = fitted("force.csv", fit)?;
            Ok(ForceResult::of(&robot.cables[*cable], fit))
        });
        let winches = winches.collect::<Result<_, _>>()?;
        let force_sensors = force_sensors.collect::<Result<_, _>>()?;
        let home = fits.home.as_ref().map(|fit| fitted("home.csv", fit));
        let elongation = fits.elongation.as_ref();
        let elongation = elongation.map(|fit| fitted("elongation.csv", fit));
        let points = phases.elongation.len();
        Ok(Self {
            winches,
            force_sensors,
            home: home.transpose()?.map(HomeResult::of),
            elongation: elongation
                .transpose()?
                .map(|fit| ElongationResult::of(points, fit)),
        })
    }
}

impl WinchResult {
    fn of(cable: &Cable, fit: &WinchCalibration) -> Self {
        Self {
            cable: cable.name.clone(),
            pairs: fit.residuals_m.len(),
            cable_per_revolution_m: fit.cable_per_revolution_m,
            cable_per_revolution_sd_m: fit.cable_per_revolution_sd_m,
            nominal_cable_per_revolution_m: cable.winch.cable_per_revolution_m(),
            offset_m: fit.offset_m,
            offset_sd_m: fit.offset_sd_m,
            stretch_m_per_n: fit.stretch_m_per_n.map(|(value, _)| value),
            stretch_sd_m_per_n: fit.stretch_m_per_n.map(|(_, sd)| sd),
            residual_sd_m: fit.residual_sd_m,
            largest_residual_m: fit.largest_residual_m,
            passed: fit.passed,
        }
    }
}

impl ForceResult {
    fn of(cable: &Cable, fit: &ForceSensorCalibration) -> Self {
        Self {
            cable: cable.name.clone(),
            pairs: fit.residuals_n.len(),
            tension_gain: fit.gain,
            tension_gain_sd: fit.gain_sd,
            bias_n: fit.bias_n,
            bias_sd_n: fit.bias_sd_n,
            residual_sd_n: fit.residual_sd_n,
            largest_residual_n: fit.largest_residual_n,
            passed: fit.passed,
        }
    }
}

impl HomeResult {
    fn of(home: &HomeMeasurement) -> Self {
        let fix = &home.fix;
        let repeatability = home.repeatability;
        let sensors = home.sensors.iter().enumerate();
        Self {
            position_m: fix.platform_in_base.position.into(),
            orientation_wxyz: fix.platform_in_base.orientation_wxyz(),
            position_sd_m: fix.position_sd_m,
            orientation_sd_rad: fix.orientation_sd_rad,
            position_repeatability_m: repeatability.map(|r| [r[0], r[1], r[2]]),
            orientation_repeatability_rad: repeatability.map(|r| [r[3], r[4], r[5]]),
            largest_residual_m: fix.largest_misfit_m,
            sensors: sensors
                .map(|(k, repeats)| HomeSensorResult {
                    sensor: k + 1,
                    readings: repeats.count,
                    mean_m: repeats.mean_m,
                    sd_m: Some(repeats.sd_m).filter(|sd| sd.is_finite()),
                    in_range: repeats.in_range,
                })
                .collect(),
        }
    }
}

impl ElongationResult {
    fn of(points: usize, fit: &ElongationFit) -> Self {
        let degrees = fit.choice.scores.iter().map(|score| DegreeResult {
            degree: score.degree,
            error_m: score.error_m,
        });
        Self {
            points,
            largest_residual_m: fit.largest_residual_m,
            degrees: degrees.collect(),
            surface: fit.choice.surface.clone(),
        }
    }
}

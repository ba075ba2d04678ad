//! Machine form of a precalibration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::cable::ElongationSurface;
use tautline_session::VersionedFile;

/// What phases 1 and 2 tell about a robot; empty or null where nothing was measured.
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
    /// Cable per motor revolution that robot.json tells (m).
    pub nominal_cable_per_revolution_m: f64,
    /// Length at zero revolutions (m).
    pub offset_m: f64,
    /// Its standard deviation (m).
    pub offset_sd_m: f64,
    /// Stretch per newton (m/N); null where the tensions do not tell it.
    pub stretch_m_per_n: Option<f64>,
    /// Its standard deviation (m/N).
    pub stretch_sd_m_per_n: Option<f64>,
    /// Standard deviation of a length reading (m).
    pub residual_sd_m: f64,
    /// Largest residual without sign (m).
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
    /// Reading per tension.
    pub tension_gain: f64,
    /// Its standard deviation.
    pub tension_gain_sd: f64,
    /// Reading at zero tension (N).
    pub bias_n: f64,
    /// Its standard deviation (N).
    pub bias_sd_n: f64,
    /// Standard deviation of a tension (N).
    pub residual_sd_n: f64,
    /// Largest residual as a tension, without sign (N).
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
    /// Largest difference between the mean distances and those at the pose found (m).
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
    /// Whether the mean lies where the sensor measures.
    pub in_range: bool,
}

/// Elongation of the cables over length and tension.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ElongationResult {
    /// Number of measurements.
    pub points: usize,
    /// The surface, as in robot.json.
    pub surface: ElongationSurface,
    /// Largest residual without sign (m).
    pub largest_residual_m: f64,
    /// Cross-validation of each degree.
    pub degrees: Vec<DegreeResult>,
}

/// Cross-validation of one degree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DegreeResult {
    /// Total degree.
    pub degree: usize,
    /// Root mean square error at measurements left out of the fit (m); null if there are too few.
    pub error_m: Option<f64>,
}

impl VersionedFile for Precalibration {
    const FORMAT: &'static str = "tautline-precalibration";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
}

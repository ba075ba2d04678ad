//! Machine-readable form of the accuracy figures.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::accuracy::iso9283::PoseFigures;
use tautline_session::VersionedFile;

/// Accuracy figures of ISO 9283.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Accuracy {
    /// Figures of the commanded poses; null if there are none.
    pub poses: Option<PoseAccuracy>,
    /// Figures of each path.
    pub paths: Vec<PathAccuracy>,
}

/// Figures of all commanded poses; angles are null unless measured at every one of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseAccuracy {
    /// Largest pose accuracy AP (m).
    pub largest_accuracy_m: f64,
    /// Mean pose accuracy AP (m).
    pub mean_accuracy_m: f64,
    /// Largest pose repeatability RP (m).
    pub largest_repeatability_m: f64,
    /// Mean pose repeatability RP (m).
    pub mean_repeatability_m: f64,
    /// Largest absolute orientation accuracy about the base axes x, y, z (rad).
    pub largest_angle_accuracy_rad: Option<[f64; 3]>,
    /// Largest orientation repeatability about the base axes (rad).
    pub largest_angle_repeatability_rad: Option<[f64; 3]>,
    /// Each commanded pose.
    pub targets: Vec<TargetAccuracy>,
}

/// One commanded pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TargetAccuracy {
    /// Name of the pose.
    pub target: String,
    /// Number of cycles.
    pub cycles: usize,
    /// Figures of the pose.
    pub figures: Figures,
}

/// One path; angles are null unless measured at every point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PathAccuracy {
    /// Name of the path.
    pub target: String,
    /// Number of cycles.
    pub cycles: usize,
    /// Path accuracy AT (m).
    pub accuracy_m: f64,
    /// Path repeatability RT (m).
    pub repeatability_m: f64,
    /// Largest absolute orientation accuracy along the path, about the base axes x, y, z (rad).
    pub angle_accuracy_rad: Option<[f64; 3]>,
    /// Orientation path repeatability about the base axes (rad).
    pub angle_repeatability_rad: Option<[f64; 3]>,
    /// Each point.
    pub points: Vec<PointAccuracy>,
}

/// One point of a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PointAccuracy {
    /// Number of the point.
    pub sample: i64,
    /// Figures of the point.
    pub figures: Figures,
}

/// Figures of one commanded pose; angles are null unless measured in every cycle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Figures {
    /// Commanded position (m).
    pub commanded_position_m: [f64; 3],
    /// Barycentre of the attained positions (m).
    pub barycentre_m: [f64; 3],
    /// Barycentre minus commanded position (m).
    pub deviation_m: [f64; 3],
    /// Accuracy: distance of the barycentre from the commanded position (m).
    pub accuracy_m: f64,
    /// Repeatability: mean distance from the barycentre plus three of its standard deviations (m).
    pub repeatability_m: f64,
    /// Orientation accuracy about the base axes x, y, z, signed (rad).
    pub angle_accuracy_rad: Option<[f64; 3]>,
    /// Orientation repeatability about the base axes (rad).
    pub angle_repeatability_rad: Option<[f64; 3]>,
}

impl Figures {
    /// Builds the document from the figures of at least two cycles; `oriented` states whether orientations were measured.
    pub fn new(commanded_position_m: [f64; 3], figures: &PoseFigures, oriented: bool) -> Self {
        Self {
            commanded_position_m,
            barycentre_m: figures.barycentre_m.into(),
            deviation_m: figures.deviation_m.into(),
            accuracy_m: figures.accuracy_m,
            repeatability_m: figures.repeatability_m.unwrap_or(f64::NAN),
            angle_accuracy_rad: oriented.then_some(figures.angle_accuracy_rad),
            angle_repeatability_rad: figures.angle_repeatability_rad.filter(|_| oriented),
        }
    }
}

impl VersionedFile for Accuracy {
    const FORMAT: &'static str = "tautline-accuracy";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;
}

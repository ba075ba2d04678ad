//! Machine-readable form of a comparison: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::comparison::{
    Comparison, Displacement, EffectDifference, FitQuality, ScalarDifference, Test,
};
use tautline_session::VersionedFile;

/// Differences between two runs, second less first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparisonDocument {
    /// Whether a pulley, the target plane or an effect differs significantly.
    pub different: bool,
    /// Significance level: the probability of finding a difference between two runs of an unchanged robot.
    pub level: f64,
    /// Every pulley, in the robot's order.
    pub pulleys: Vec<PulleyDocument>,
    /// Common motion of all pulleys, due to different home poses rather than to the robot; null if none is possible.
    pub common_motion: Option<MotionDocument>,
    /// Offset of the laser's target plane (m), common motion removed.
    pub target_plane: Option<ScalarDifference>,
    /// Coordinates of the home pose that are estimated.
    pub home: Option<HomeDifferenceDocument>,
    /// Effects that are estimated.
    pub effects: Vec<EffectDifference>,
    /// All pulleys and the target plane together, common motion removed.
    pub global: Option<Test>,
    /// Quality of the fit to each run: first, second.
    pub fits: Vec<FitQuality>,
}

/// Difference of an entry point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DisplacementDocument {
    /// Along x, y, z (m).
    pub vector_m: [f64; 3],
    /// Standard deviation along x, y, z (m).
    pub sd_m: [f64; 3],
    /// Length of the displacement (m).
    pub length_m: f64,
    /// Standard deviation of the length (m).
    pub length_sd_m: f64,
}

/// Displacement of a pulley.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PulleyDocument {
    /// Name of the cable.
    pub cable: String,
    /// Difference of the estimates, each run relative to its own home pose.
    pub raw: DisplacementDocument,
    /// Difference relative to the pulleys that did not move; null if too few others are left.
    pub relative: Option<DisplacementDocument>,
    /// Test of the relative difference.
    pub test: Option<Test>,
    /// Whether the pulley has moved.
    pub moved: bool,
}

/// Common motion of all pulleys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionDocument {
    /// Translation of the centroid of the pulleys (m).
    pub shift_m: [f64; 3],
    /// Standard deviations of the translation (m).
    pub shift_sd_m: [f64; 3],
    /// Rotation vector about the centroid (rad).
    pub rotation_rad: [f64; 3],
    /// Standard deviations of the rotation (rad).
    pub rotation_sd_rad: [f64; 3],
    /// Test whether it exceeds the uncertainty of both home poses.
    pub test: Option<Test>,
}

/// Difference of the home pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomeDifferenceDocument {
    /// Estimated coordinates.
    pub coordinates: Vec<CoordinateDocument>,
    /// Test of all coordinates together.
    pub test: Option<Test>,
}

/// Difference of a coordinate of the home pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CoordinateDocument {
    /// Name of the coordinate.
    pub coordinate: String,
    /// Difference (m or rad).
    pub difference: f64,
    /// Standard deviation of the difference.
    pub sd: f64,
}

impl VersionedFile for ComparisonDocument {
    const FORMAT: &'static str = "tautline-comparison";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
}

fn displacement(of: &Displacement) -> DisplacementDocument {
    DisplacementDocument {
        vector_m: of.vector_m.into(),
        sd_m: [0, 1, 2].map(|k| of.covariance[(k, k)].max(0.0).sqrt()),
        length_m: of.length_m(),
        length_sd_m: of.length_sd_m(),
    }
}

impl ComparisonDocument {
    /// The document of a comparison.
    #[must_use]
    pub fn of(compared: &Comparison) -> Self {
        let sd = |c: &nalgebra::DMatrix<f64>, from: usize| {
            [0, 1, 2].map(|k| c[(from + k, from + k)].max(0.0).sqrt())
        };
        Self {
            different: compared.is_different(),
            level: compared.level,
            pulleys: (compared.pulleys.iter())
                .map(|pulley| PulleyDocument {
                    cable: pulley.cable.clone(),
                    raw: displacement(&pulley.raw),
                    relative: pulley.relative.as_ref().map(displacement),
                    test: pulley.test,
                    moved: pulley.moved,
                })
                .collect(),
            common_motion: compared.motion.as_ref().map(|motion| MotionDocument {
                shift_m: motion.shift_m.into(),
                shift_sd_m: sd(&motion.covariance, 0),
                rotation_rad: motion.rotation_rad.into(),
                rotation_sd_rad: sd(&motion.covariance, 3),
                test: motion.test,
            }),
            target_plane: compared.plane.clone(),
            home: compared.home.as_ref().map(|home| HomeDifferenceDocument {
                coordinates: (home.coordinates.iter())
                    .map(|(coordinate, difference, sd)| CoordinateDocument {
                        coordinate: coordinate.describe().to_owned(),
                        difference: *difference,
                        sd: *sd,
                    })
                    .collect(),
                test: home.test,
            }),
            effects: compared.effects.clone(),
            global: compared.global,
            fits: compared.fits.to_vec(),
        }
    }
}

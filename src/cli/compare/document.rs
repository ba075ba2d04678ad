//! Machine form of a comparison: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::comparison::{Comparison, Displacement, ScalarDifference, Test};
use tautline_session::VersionedFile;

/// What differs between two runs; differences are second run less first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparisonDocument {
    /// Whether a pulley, the target plane or an effect differs.
    pub different: bool,
    /// Probability with which two runs of the same robot are called different.
    pub level: f64,
    /// Every pulley, in the robot's order.
    pub pulleys: Vec<PulleyDocument>,
    /// Motion that all pulleys have in common: the two home poses differ, not the robot. Null where none is possible.
    pub common_motion: Option<MotionDocument>,
    /// Offset of the laser's target plane (m), the common motion taken out.
    pub target_plane: Option<ScalarDocument>,
    /// Coordinates of the home pose that are estimated.
    pub home: Option<HomeDocument>,
    /// Effects that are estimated.
    pub effects: Vec<EffectDocument>,
    /// All pulleys and the target plane together, the common motion taken out.
    pub global: Option<TestDocument>,
    /// How well each run is explained: first, second.
    pub fits: Vec<FitDocument>,
}

/// A test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TestDocument {
    /// Chi-square.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: usize,
    /// Probability of a chi-square at least as large by noise alone.
    pub p_value: f64,
    /// The same, corrected for the number of questions (Holm).
    pub p_corrected: f64,
}

/// Difference of an entry point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DisplacementDocument {
    /// Along x, y, z (m).
    pub vector_m: [f64; 3],
    /// Standard deviation along x, y, z (m).
    pub sd_m: [f64; 3],
    /// Length (m).
    pub length_m: f64,
    /// Standard deviation of the length (m).
    pub length_sd_m: f64,
}

/// A pulley.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PulleyDocument {
    /// Name of the cable.
    pub cable: String,
    /// As the runs have it, each from its own home pose.
    pub raw: DisplacementDocument,
    /// Relative to the pulleys that did not move; null where too few are left to tell.
    pub relative: Option<DisplacementDocument>,
    /// Test of the relative difference.
    pub test: Option<TestDocument>,
    /// Whether it has moved.
    pub moved: bool,
}

/// The common motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionDocument {
    /// Shift of the middle of the pulleys (m).
    pub shift_m: [f64; 3],
    /// Its standard deviations (m).
    pub shift_sd_m: [f64; 3],
    /// Rotation vector about the middle (rad).
    pub rotation_rad: [f64; 3],
    /// Its standard deviations (rad).
    pub rotation_sd_rad: [f64; 3],
    /// Whether it is more than the uncertainty of both home poses.
    pub test: Option<TestDocument>,
}

/// Difference of a single quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScalarDocument {
    /// In the first run (SI); null where it is not part of it.
    pub first: Option<f64>,
    /// In the second run.
    pub second: Option<f64>,
    /// Difference.
    pub difference: f64,
    /// Its standard deviation.
    pub sd: f64,
    /// Whether it is more than noise.
    pub test: Option<TestDocument>,
}

/// The home pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomeDocument {
    /// Its coordinates.
    pub coordinates: Vec<CoordinateDocument>,
    /// All of them together.
    pub test: Option<TestDocument>,
}

/// A coordinate of the home pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CoordinateDocument {
    /// In words.
    pub coordinate: String,
    /// Difference (m or rad).
    pub difference: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EffectDocument {
    /// Effect of the catalogue.
    pub effect: String,
    /// Cables; empty for all.
    pub targets: Vec<String>,
    /// Name of the parameter.
    pub parameter: String,
    /// SI unit.
    pub unit: String,
    /// Its sizes.
    pub size: ScalarDocument,
}

/// How well a run is explained.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitDocument {
    /// Chi-square.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: f64,
    /// Probability of a chi-square at least as large if model and noise are right.
    pub p_value: Option<f64>,
}

impl VersionedFile for ComparisonDocument {
    const FORMAT: &'static str = "tautline-comparison";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
}

fn test(test: Option<Test>) -> Option<TestDocument> {
    test.map(|test| TestDocument {
        chi2: test.chi2,
        dof: test.degrees_of_freedom,
        p_value: test.p_value,
        p_corrected: test.p_corrected,
    })
}

fn displacement(of: &Displacement) -> DisplacementDocument {
    DisplacementDocument {
        vector_m: of.vector_m.into(),
        sd_m: [0, 1, 2].map(|k| of.covariance[(k, k)].max(0.0).sqrt()),
        length_m: of.length_m(),
        length_sd_m: of.length_sd_m(),
    }
}

fn scalar(of: &ScalarDifference) -> ScalarDocument {
    ScalarDocument {
        first: of.first,
        second: of.second,
        difference: of.difference,
        sd: of.sd,
        test: test(of.test),
    }
}

impl ComparisonDocument {
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
                    test: test(pulley.test),
                    moved: pulley.moved,
                })
                .collect(),
            common_motion: compared.motion.as_ref().map(|motion| MotionDocument {
                shift_m: motion.shift_m.into(),
                shift_sd_m: sd(&motion.covariance, 0),
                rotation_rad: motion.rotation_rad.into(),
                rotation_sd_rad: sd(&motion.covariance, 3),
                test: test(motion.test),
            }),
            target_plane: compared.plane.as_ref().map(scalar),
            home: compared.home.as_ref().map(|home| HomeDocument {
                coordinates: (home.coordinates.iter())
                    .map(|(coordinate, difference, sd)| CoordinateDocument {
                        coordinate: coordinate.describe().to_owned(),
                        difference: *difference,
                        sd: *sd,
                    })
                    .collect(),
                test: test(home.test),
            }),
            effects: (compared.effects.iter())
                .map(|effect| EffectDocument {
                    effect: effect.effect.clone(),
                    targets: effect.targets.clone(),
                    parameter: effect.parameter.clone(),
                    unit: effect.unit.to_owned(),
                    size: scalar(&effect.size),
                })
                .collect(),
            global: test(compared.global),
            fits: (compared.fits.iter())
                .map(|fit| FitDocument {
                    chi2: fit.chi2,
                    dof: fit.degrees_of_freedom,
                    p_value: fit.p_value,
                })
                .collect(),
        }
    }
}

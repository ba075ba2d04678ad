//! Machine form of a diagnosis: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::effect::EffectSetting;
use tautline_session::VersionedFile;

/// Machine form of a diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiagnosisDocument {
    /// Whether the original model explains the data; then there are no findings.
    pub adequate: bool,
    /// Test of the original model, all readings together.
    pub global_test: GlobalTestDocument,
    /// Dependences of the residuals of the original model, the strongest first.
    pub discrepancy: Vec<DiscrepancyDocument>,
    /// What was found, in the order in which it was added.
    pub findings: Vec<FindingDocument>,
    /// Causes that are possible but too improbable for a finding, the likeliest first.
    pub possible: Vec<AlternativeDocument>,
    /// The extended model.
    pub model: ModelDocument,
    /// Probability of a false alarm that was allowed.
    pub alpha: f64,
    /// Time of the diagnosis alone (s).
    pub seconds: f64,
    /// Whether it ran to its end.
    pub complete: bool,
    /// Tests of the original model, per kind of reading, then per cable.
    pub groups: Vec<GroupTestDocument>,
    /// Tests of the extended model, which is the original one where there are no findings.
    pub extended: ExtendedDocument,
    /// Dependences that are left with the extended model.
    pub remaining_discrepancy: Vec<DiscrepancyDocument>,
    /// Noise that is not as robot.json says.
    pub noise: Vec<NoiseDocument>,
    /// Effects that these data cannot show at their typical size.
    pub not_visible: Vec<InvisibleDocument>,
}

/// Chi-square test of a whole solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GlobalTestDocument {
    /// Chi-square, priors included.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: f64,
    /// Probability of a chi-square at least as large if model and noise are right; null where nothing is redundant.
    pub p_value: Option<f64>,
}

/// Test of one kind of reading, or of one cable of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GroupTestDocument {
    /// Kind of reading.
    pub reading: String,
    /// Cable; null for all of them.
    pub target: Option<String>,
    /// Number of readings.
    pub readings: usize,
    /// Root mean square of the residuals over what noise alone gives; null where nothing is redundant.
    pub rms_over_sd: Option<f64>,
    /// Two-sided probability, not corrected for the number of tests.
    pub p_value: Option<f64>,
}

/// Tests of the extended model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExtendedDocument {
    /// Whether it explains the data.
    pub adequate: bool,
    /// All readings together.
    pub global_test: GlobalTestDocument,
    /// Per kind of reading, then per cable.
    pub groups: Vec<GroupTestDocument>,
}

/// A residual that depends on a variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiscrepancyDocument {
    /// Kind of reading.
    pub reading: String,
    /// Cable; null where the reading is none of a cable.
    pub target: Option<String>,
    /// Root mean square of these residuals over what noise alone gives.
    pub rms_over_sd: Option<f64>,
    /// On what the residual depends.
    pub depends_on: String,
    /// Probability if there is no dependence, corrected for the number of tests.
    pub p_value: Option<f64>,
    /// What a plot shows.
    pub points: Vec<PointDocument>,
}

/// One residual over the variable on which it depends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PointDocument {
    /// Label of the row.
    pub pose: i64,
    /// Value of the variable (SI units); null where it is not known.
    pub variable: Option<f64>,
    /// Residual in its own standard deviations.
    pub residual: Option<f64>,
}

/// One thing that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FindingDocument {
    /// How sure the name is.
    pub verdict: VerdictDocument,
    /// Effect of the catalogue.
    pub effect: String,
    /// Cables; empty for an effect of the robot, an instrument or all cables together.
    pub targets: Vec<String>,
    /// The sentence that a technician reads.
    pub cause: String,
    /// What to do in the workshop.
    pub advice: String,
    /// Posterior probability of the cause; it and its alternatives exclude each other.
    pub probability: f64,
    /// Causes that the data cannot separate from it, the likeliest first.
    pub alternatives: Vec<AlternativeDocument>,
    /// Its parameters.
    pub parameters: Vec<ParameterDocument>,
    /// The numbers behind the verdict.
    pub evidence: EvidenceDocument,
    /// Improvement on poses held out, on top of the findings before it.
    pub gain: GainDocument,
    /// Further poses that would separate it from its alternatives, the most informative first.
    pub separating_poses: Vec<PoseDocument>,
    /// Chi-square by which the two best causes are expected to differ once these poses are measured.
    pub separating_delta_chi2: Option<f64>,
    /// What would separate it from its alternatives, in words.
    pub separating_advice: Option<String>,
}

/// How sure a finding is of its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum VerdictDocument {
    /// One cause stands out.
    Named,
    /// The data cannot separate it from its alternatives.
    Ambiguous,
    /// No effect of the catalogue explains it.
    Unknown,
}

/// An effect with its targets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CauseDocument {
    /// Effect of the catalogue.
    pub effect: String,
    /// Cables; empty for an effect of the robot, an instrument or all cables together.
    pub targets: Vec<String>,
}

/// An effect with its targets and its posterior probability.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AlternativeDocument {
    /// Effect of the catalogue.
    pub effect: String,
    /// Cables; empty for an effect of the robot, an instrument or all cables together.
    pub targets: Vec<String>,
    /// Posterior probability.
    pub probability: f64,
}

/// A parameter of a finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParameterDocument {
    /// Name of the parameter.
    pub name: String,
    /// Cable whose parameter it is, where each has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// Value (SI).
    pub value: f64,
    /// Unit; "1" for a ratio or a label.
    pub unit: String,
    /// Standard deviation; null for what was searched rather than fitted, as the label of a pose.
    pub sd: Option<f64>,
}

/// The numbers behind a verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EvidenceDocument {
    /// By how much the cause lowers chi-square, all other findings present.
    pub delta_chi2: f64,
    /// Number of its parameters.
    pub parameters: usize,
    /// Probability of such a gain without the cause, corrected for the number of tests.
    pub p_value: Option<f64>,
    /// Number of tests.
    pub questions: usize,
    /// The best of the others.
    pub runner_up: Option<RunnerUpDocument>,
    /// All that were fitted in its place, the best first.
    pub ranking: Vec<RivalDocument>,
}

/// The best of the causes that were not chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunnerUpDocument {
    /// Effect and targets.
    #[serde(flatten)]
    pub cause: CauseDocument,
    /// By how much it lowers chi-square.
    pub delta_chi2: f64,
}

/// A cause in comparison with others that were fitted in its place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RivalDocument {
    /// Effect and targets.
    #[serde(flatten)]
    pub cause: CauseDocument,
    /// By how much it lowers chi-square.
    pub delta_chi2: f64,
    /// Number of its parameters.
    pub parameters: usize,
    /// Twice the logarithm of its evidence.
    pub score: f64,
    /// Angle between its signature and that of the first (rad).
    pub angle_rad: Option<f64>,
    /// Held-out root mean square over sd with this cause.
    pub holdout: Option<f64>,
}

/// What a finding gains on poses that took no part in fitting; null where nothing could be held out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GainDocument {
    /// Root mean square over sd without the cause.
    pub holdout_before: Option<f64>,
    /// The same with it.
    pub holdout_after: Option<f64>,
    /// Unit of the two.
    pub unit: String,
    /// Number of poses that were held out.
    pub poses_held_out: usize,
    /// 95 % interval of the difference.
    pub interval: Option<[f64; 2]>,
    /// Per kind of reading.
    pub per_reading: Vec<ReadingGainDocument>,
    /// How far the platform is from where the model without the cause has it.
    pub position_change_m: PositionChangeDocument,
}

/// Gain on one kind of reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReadingGainDocument {
    /// Kind of reading.
    pub reading: String,
    /// Root mean square over sd without the cause.
    pub holdout_before: Option<f64>,
    /// The same with it.
    pub holdout_after: Option<f64>,
}

/// How far the platform is from where another model has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PositionChangeDocument {
    /// Root mean square over the measured poses (m).
    pub rms: Option<f64>,
    /// 95 % interval of it (m).
    pub interval: Option<[f64; 2]>,
    /// The largest (m).
    pub largest: Option<f64>,
}

/// A pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseDocument {
    /// Platform origin in the base frame (m).
    pub position_m: [f64; 3],
    /// Orientation, quaternion w first.
    pub orientation_wxyz: [f64; 4],
}

/// A kind of reading whose noise is not what robot.json says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NoiseDocument {
    /// Kind of reading.
    pub reading: String,
    /// Cable; null for all of them.
    pub target: Option<String>,
    /// Standard deviation over the one given.
    pub ratio: f64,
    /// 95 % interval of the ratio.
    pub interval: [f64; 2],
    /// Probability of such a ratio if the noise is as given, corrected for the number of tests.
    pub p_value: Option<f64>,
}

/// An effect that the data cannot show at its typical size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InvisibleDocument {
    /// Effect and targets.
    #[serde(flatten)]
    pub cause: CauseDocument,
    /// Name of the parameter.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Smallest size that would be found with probability 0.9; null if no size would.
    pub smallest_visible: Option<f64>,
}

/// The extended model, besides its geometry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelDocument {
    /// All its effects, in the form of a model file.
    pub effects: Vec<EffectSetting>,
}

impl VersionedFile for DiagnosisDocument {
    const FORMAT: &'static str = "tautline-diagnosis";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;
}

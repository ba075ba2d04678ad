//! Machine-readable form of a diagnosis: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{ToleranceFactor, Verdict};
use tautline_core::effect::EffectSetting;
use tautline_import::Suggestion;
use tautline_session::VersionedFile;

/// Machine-readable form of a diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiagnosisDocument {
    /// Whether the original model explains the data; then there are no findings.
    pub adequate: bool,
    /// Mistakes in the readings, each with the change of a recipe that corrects it; all other results are for the corrected
    /// readings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mistakes: Vec<Suggestion>,
    /// A cable that was slack at some poses, or may have been.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slack: Option<SlackDocument>,
    /// Displacement of the pulleys from robot.json, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drawing: Option<DrawingDocument>,
    /// Test of the original model, all readings together.
    pub global_test: GlobalTestDocument,
    /// Dependences of the residuals of the original model, the strongest first.
    pub discrepancy: Vec<DiscrepancyDocument>,
    /// Findings, in the order in which they were added.
    pub findings: Vec<FindingDocument>,
    /// Causes that are possible but too improbable for a finding, the likeliest first.
    pub possible: Vec<AlternativeDocument>,
    /// The extended model.
    pub model: ModelDocument,
    /// False-alarm probability of the tests.
    pub alpha: f64,
    /// Time of the diagnosis alone (s).
    pub seconds: f64,
    /// Whether the diagnosis was completed.
    pub complete: bool,
    /// Tests of the original model, per kind of reading, then per cable.
    pub groups: Vec<GroupTestDocument>,
    /// Tests of the extended model; it equals the original one if there are no findings.
    pub extended: ExtendedDocument,
    /// Unexplained part of the residuals; absent in old files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remainder: Option<RemainderDocument>,
    /// Dependences that remain with the extended model.
    pub remaining_discrepancy: Vec<DiscrepancyDocument>,
    /// Scatter of the parts; absent in old files, in which all parts counted as exact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerances: Option<ToleranceFactor>,
    /// Noise that differs from robot.json.
    pub noise: Vec<NoiseDocument>,
    /// Effects that these data cannot reveal at their typical size.
    pub not_visible: Vec<InvisibleDocument>,
}

/// A cable that was slack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SlackDocument {
    /// The cable.
    pub target: String,
    /// Labels of the poses.
    pub poses: Vec<i64>,
    /// Smallest and largest excess of the readings at these poses (m); null if a force sensor tells the poses.
    pub excess_m: Option<[f64; 2]>,
    /// Log odds over other causes; below 0 its readings are not left out.
    pub log_odds: f64,
}

/// A drawing that is wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DrawingDocument {
    /// `extent` along an axis, `turn` about an axis, or `pulley`.
    pub pattern: String,
    /// Axis; null for a pulley.
    pub axis: Option<String>,
    /// Cable of the pulley; null otherwise.
    pub target: Option<String>,
    /// Size (m or rad).
    pub size: f64,
    /// Its standard deviation.
    pub sd: Option<f64>,
    /// Its standard deviation according to robot.json.
    pub stated_sd: f64,
    /// Displacement of each pulley (m).
    pub displacements_m: Vec<[f64; 3]>,
    /// Root mean square error of the platform with the places of robot.json (m); null where it is not determined.
    pub worth_m: Option<f64>,
    /// Log odds over a right drawing and other causes; it is wrong from 19 to 1 on, else it may be.
    #[serde(default)]
    pub log_odds: f64,
}

/// Chi-square test of a whole solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GlobalTestDocument {
    /// Chi-square, priors included.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: f64,
    /// Probability of a chi-square at least as large if model and noise are right; null without redundancy.
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
    /// Root mean square of the residuals over what noise alone gives; null without redundancy.
    pub rms_over_sd: Option<f64>,
    /// Two-sided probability, not corrected for the number of tests.
    pub p_value: Option<f64>,
}

/// Tests of the extended model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExtendedDocument {
    /// Whether the extended model explains the data.
    pub adequate: bool,
    /// Test of all readings together.
    pub global_test: GlobalTestDocument,
    /// Tests per kind of reading, then per cable.
    pub groups: Vec<GroupTestDocument>,
}

/// Part of the residuals that the causes do not explain, but which is not a finding of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RemainderDocument {
    /// Root mean square of all residuals of the extended model over what noise alone gives; null without redundancy.
    pub rms_over_sd: Option<f64>,
    /// Readings concerned, the strongest dependence first.
    pub readings: Vec<RemainingReadingDocument>,
}

/// Readings whose residuals still depend on a variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RemainingReadingDocument {
    /// Kind of reading.
    pub reading: String,
    /// Cable; null if the reading does not belong to a cable.
    pub target: Option<String>,
    /// Root mean square of these residuals over what noise alone gives.
    pub rms_over_sd: Option<f64>,
    /// Variable on which they depend.
    pub depends_on: String,
}

/// A residual that depends on a variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiscrepancyDocument {
    /// Kind of reading.
    pub reading: String,
    /// Cable; null if the reading does not belong to a cable.
    pub target: Option<String>,
    /// Root mean square of these residuals over what noise alone gives.
    pub rms_over_sd: Option<f64>,
    /// Variable on which the residual depends.
    pub depends_on: String,
    /// Probability if there is no dependence, corrected for the number of tests.
    pub p_value: Option<f64>,
    /// Points of the plot.
    pub points: Vec<PointDocument>,
}

/// One residual over its variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PointDocument {
    /// Label of the row.
    pub pose: i64,
    /// Value of the variable (SI units); null where it is not known.
    pub variable: Option<f64>,
    /// Residual in its own standard deviations.
    pub residual: Option<f64>,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FindingDocument {
    /// Certainty of the cause.
    pub verdict: Verdict,
    /// Subject of the finding.
    #[serde(flatten)]
    pub subject: SubjectDocument,
    /// The cause as a sentence for a technician.
    pub cause: String,
    /// Advice for the workshop.
    pub advice: String,
    /// Posterior probability of the cause; it and its alternatives are mutually exclusive.
    pub probability: f64,
    /// Causes that the data cannot separate from this one, most probable first.
    pub alternatives: Vec<AlternativeDocument>,
    /// Parameters of the cause.
    pub parameters: Vec<ParameterDocument>,
    /// Statistics behind the verdict.
    pub evidence: EvidenceDocument,
    /// Improvement at held-out poses, in addition to the findings before it.
    pub gain: GainDocument,
    /// Further poses that would separate the cause from its alternatives, the most informative first.
    pub separating_poses: Vec<PoseDocument>,
    /// Difference in chi-square expected between the two best causes once these poses are measured.
    pub separating_delta_chi2: Option<f64>,
    /// Advice on how to separate the cause from its alternatives.
    pub separating_advice: Option<String>,
}

/// An effect with its targets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CauseDocument {
    /// Effect of the catalogue.
    pub effect: String,
    /// Cables; empty for an effect of the robot, an instrument or all cables together.
    pub targets: Vec<String>,
}

/// A cause, or an error that no effect explains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SubjectDocument {
    /// Effect of the catalogue; "unknown" for an error that none explains, "drawing" for pulleys elsewhere than stated,
    /// "slack" for a slack cable.
    pub effect: String,
    /// Cables; empty for an effect of the robot, an instrument or all cables together.
    pub targets: Vec<String>,
    /// The error, if no effect explains it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorDocument>,
}

/// An effect with its targets and its posterior probability.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AlternativeDocument {
    /// The cause or error.
    #[serde(flatten)]
    pub subject: SubjectDocument,
    /// Posterior probability.
    pub probability: f64,
}

/// An error of readings that no effect explains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ErrorDocument {
    /// Kind of reading.
    pub reading: String,
    /// Index of the axis or angle, for readings with several.
    pub component: Option<usize>,
    /// Form of its dependence.
    pub form: ErrorFormDocument,
    /// Variable on which it depends; null without a form.
    pub depends_on: Option<String>,
    /// Cable whose tension it depends on, with the form "crosstalk".
    pub of_cable: Option<String>,
    /// Period in the unit of the variable, with the form "wave".
    pub period: Option<f64>,
    /// Root mean square over the readings about its mean (SI); null if it was not estimated.
    pub rms: Option<f64>,
}

/// Form of the dependence of an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ErrorFormDocument {
    /// A smooth function of the variable.
    Smooth,
    /// A periodic function of the variable.
    Wave,
    /// A smooth function of the tension of another cable.
    Crosstalk,
    /// A smooth function of all coordinates of the position or of the orientation.
    Field,
    /// More scatter than that of the noise.
    Scatter,
}

/// A parameter of a finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParameterDocument {
    /// Name of the parameter.
    pub name: String,
    /// Cable of the parameter, if each cable has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// Value (SI).
    pub value: f64,
    /// Unit; "1" for a ratio or a label.
    pub unit: String,
    /// Standard deviation; null for parameters that are searched rather than fitted, such as the label of a pose.
    pub sd: Option<f64>,
}

/// Statistics behind a verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EvidenceDocument {
    /// Reduction of chi-square by the cause, with all other findings included.
    pub delta_chi2: f64,
    /// Number of parameters of the cause.
    pub parameters: usize,
    /// Probability of such a reduction without the cause, corrected for the number of tests.
    pub p_value: Option<f64>,
    /// Number of tests.
    pub questions: usize,
    /// The best of the other causes.
    pub runner_up: Option<RunnerUpDocument>,
    /// All causes fitted in its place, the best first.
    pub ranking: Vec<RivalDocument>,
}

/// The best of the causes that were not chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunnerUpDocument {
    /// Effect and targets.
    #[serde(flatten)]
    pub cause: CauseDocument,
    /// Reduction of chi-square.
    pub delta_chi2: f64,
}

/// A cause in comparison with the others fitted in its place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RivalDocument {
    /// Effect and targets.
    #[serde(flatten)]
    pub cause: CauseDocument,
    /// Reduction of chi-square.
    pub delta_chi2: f64,
    /// Number of parameters of the cause.
    pub parameters: usize,
    /// Held-out root mean square over sd with this cause.
    pub holdout: Option<f64>,
}

/// Improvement by a finding at poses excluded from the fit; null if no poses could be held out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GainDocument {
    /// Root mean square over sd without the cause.
    pub holdout_before: Option<f64>,
    /// Root mean square over sd with the cause.
    pub holdout_after: Option<f64>,
    /// Unit of the two.
    pub unit: String,
    /// Number of held-out poses.
    pub poses_held_out: usize,
    /// 95 % interval of the difference.
    pub interval: Option<[f64; 2]>,
    /// Improvement per kind of reading.
    pub per_reading: Vec<ReadingGainDocument>,
    /// Change of the platform position by the cause.
    pub position_change_m: PositionChangeDocument,
}

/// Improvement for one kind of reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReadingGainDocument {
    /// Kind of reading.
    pub reading: String,
    /// Root mean square over sd without the cause.
    pub holdout_before: Option<f64>,
    /// Root mean square over sd with the cause.
    pub holdout_after: Option<f64>,
}

/// Change of the platform position between two models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PositionChangeDocument {
    /// Root mean square over the measured poses (m).
    pub rms: Option<f64>,
    /// 95 % interval of the root mean square (m).
    pub interval: Option<[f64; 2]>,
    /// Largest change (m).
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

/// A kind of reading whose noise differs from robot.json.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NoiseDocument {
    /// Kind of reading.
    pub reading: String,
    /// Cable; null for all of them.
    pub target: Option<String>,
    /// Estimated standard deviation over the stated one.
    pub ratio: f64,
    /// 95 % interval of the ratio.
    pub interval: [f64; 2],
    /// Probability of such a ratio if the noise is as stated, corrected for the number of tests.
    pub p_value: Option<f64>,
}

/// An effect that the data cannot reveal at its typical size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InvisibleDocument {
    /// Effect and targets.
    #[serde(flatten)]
    pub cause: CauseDocument,
    /// Name of the parameter.
    pub parameter: String,
    /// Unit of the parameter.
    pub unit: String,
    /// Smallest size that would be found with probability 0.9; null if no size would.
    pub smallest_visible: Option<f64>,
}

/// The extended model, except its geometry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelDocument {
    /// All effects of the model, in the form of a model file.
    pub effects: Vec<EffectSetting>,
}

impl VersionedFile for DiagnosisDocument {
    const FORMAT: &'static str = "tautline-diagnosis";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;
}

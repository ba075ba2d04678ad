//! The result of a diagnosis as plain data.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::calibration::NAMING_PROBABILITY;
use super::drawing::{DrawingPattern, WrongDrawing};
use super::reading_id::ReadingId;
use super::size_posterior::SizePosterior;
use crate::effect::{BoundEffect, Effect, OnEachCable};
use crate::estimation::{ObservationKind, Solution};
use crate::geometry::Pose;
use crate::measurement::Variable;
use crate::robot::Robot;

/// Kind of reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// Length of a cable.
    Length,
    /// Tension of a cable.
    Tension,
    /// Laser distance.
    Laser,
    /// Swivel angle of a pulley.
    Swivel,
    /// Roll, pitch and yaw.
    Inclination,
    /// Position by the external instrument.
    TrackerPosition,
    /// Orientation by the external instrument.
    TrackerOrientation,
    /// Distance between two poses.
    Distance,
}

impl Quantity {
    /// All kinds of readings.
    pub const ALL: [Self; 8] = [
        Self::Length,
        Self::Tension,
        Self::Laser,
        Self::Swivel,
        Self::Inclination,
        Self::TrackerPosition,
        Self::TrackerOrientation,
        Self::Distance,
    ];

    /// The kind of an observation; `None` for the equilibrium, which no sensor reads.
    #[must_use]
    pub fn of(kind: ObservationKind) -> Option<Self> {
        Some(match kind {
            ObservationKind::Length(_) => Self::Length,
            ObservationKind::Tension(_) => Self::Tension,
            ObservationKind::Laser => Self::Laser,
            ObservationKind::Swivel(_) => Self::Swivel,
            ObservationKind::Inclination(_) => Self::Inclination,
            ObservationKind::TrackerPosition(_) => Self::TrackerPosition,
            ObservationKind::TrackerOrientation(_) => Self::TrackerOrientation,
            ObservationKind::Distance(_) => Self::Distance,
            ObservationKind::Equilibrium(_) => return None,
        })
    }

    /// Name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Length => "length",
            Self::Tension => "tension",
            Self::Laser => "laser",
            Self::Swivel => "swivel",
            Self::Inclination => "inclination",
            Self::TrackerPosition => "tracker position",
            Self::TrackerOrientation => "tracker orientation",
            Self::Distance => "distance",
        }
    }
}

/// Chi-square test of all residuals of a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GlobalTest {
    /// Sum of squares.
    pub chi2: f64,
    /// Degrees of freedom.
    pub degrees_of_freedom: f64,
    /// Probability of a larger sum of squares if model and noise are correct.
    pub p_value: f64,
}

/// Test of the readings of one kind, or of one kind and cable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroupTest {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable; `None` for all cables together.
    pub cable: Option<usize>,
    /// Number of readings.
    pub readings: usize,
    /// Root mean square of the residuals over its expectation; 1 if model and noise are correct.
    pub rms_over_sd: f64,
    /// Two-sided p-value, not corrected for the number of tests.
    pub p_value: f64,
}

/// A kind of reading whose noise differs from the description.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseStatement {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable; `None` for all cables together.
    pub cable: Option<usize>,
    /// Actual standard deviation over the described one.
    pub ratio: f64,
    /// 95 % interval of the ratio.
    pub interval: [f64; 2],
    /// P-value of the ratio, corrected for the number of tests.
    pub p_value: f64,
}

/// Goodness of fit of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Adequacy {
    /// Whether the global test accepts the model.
    pub adequate: bool,
    /// Test of all readings together.
    pub global: GlobalTest,
    /// Tests of each kind of reading, then of each cable.
    pub groups: Vec<GroupTest>,
}

/// Readings whose residuals depend on a variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Discrepancy {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable, for readings of a cable.
    pub cable: Option<usize>,
    /// The variable that the residuals depend on.
    pub variable: Variable,
    /// Root mean square of these residuals over its expectation.
    pub rms_over_sd: f64,
    /// P-value, corrected for the number of tests.
    pub p_value: f64,
    /// Row, variable and residual in its own standard deviations, for plots.
    pub points: Vec<(usize, f64, f64)>,
}

/// An effect with its targets: one instance, or one for each cable that has its own parameters.
#[derive(Debug, Clone)]
pub struct Cause {
    /// The instances, all of the same effect.
    pub instances: Vec<BoundEffect>,
}

impl Cause {
    /// The effect.
    ///
    /// # Panics
    /// Never for a cause of a diagnosis, which has at least one instance.
    #[must_use]
    pub fn effect(&self) -> &'static Effect {
        self.instances[0].effect
    }

    /// Indices of the targeted cables; empty for an effect of the robot, an instrument or all cables together.
    #[must_use]
    pub fn cables(&self) -> Vec<usize> {
        let targeted = self.instances.iter().filter(|bound| bound.targeted);
        targeted.flat_map(|bound| bound.cables.clone()).collect()
    }

    /// The texts for an effect that all cables of the robot have at once, where those are other ones.
    #[must_use]
    pub fn on_each_cable(&self, robot: &Robot) -> Option<OnEachCable> {
        let is_each = self.instances.len() > 1 && self.instances.len() == robot.cable_count();
        self.effect().on_each_cable().filter(|_| is_each)
    }

    /// Sentence on the cause, and advice for the workshop.
    pub(super) fn in_words(&self, robot: &Robot) -> [String; 2] {
        if let Some(texts) = self.on_each_cable(robot) {
            return [texts.cause, texts.workshop].map(|text| self.instances[0].say(robot, text));
        }
        [BoundEffect::cause, BoundEffect::workshop].map(|text| {
            let mut sentences: Vec<String> = Vec::new();
            for bound in &self.instances {
                let sentence = text(bound, robot);
                if !sentences.contains(&sentence) {
                    sentences.push(sentence);
                }
            }
            sentences.join(" ")
        })
    }
}

/// Functional form of an unmodelled error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ErrorForm {
    /// Smooth function of one variable.
    Smooth(Variable),
    /// Periodic function of one variable, with the period in its unit.
    Wave(Variable, f64),
    /// Smooth function of the tension of another cable.
    Crosstalk(usize),
    /// Gaussian field over the position, with its correlation length, where positions range from -1 to 1.
    Position(f64),
    /// Gaussian field over the orientation, with its correlation length, where rotations range from -1 to 1.
    Orientation(f64),
    /// More scatter than that of the noise, without a form.
    Scatter,
}

impl ErrorForm {
    /// The variable of the function; `None` if there are several or none.
    #[must_use]
    pub fn variable(self) -> Option<Variable> {
        match self {
            Self::Smooth(variable) | Self::Wave(variable, _) => Some(variable),
            Self::Crosstalk(_) | Self::Position(_) | Self::Orientation(_) | Self::Scatter => None,
        }
    }
}

/// An error of some readings that no effect of the catalogue explains.
#[derive(Debug, Clone, PartialEq)]
pub struct UnmodelledError {
    /// The readings; no cable if they belong to none, or if the readings of all cables have the same error.
    pub readings: ReadingId,
    /// Form of the error, with the variable that it depends on.
    pub form: ErrorForm,
    /// Root mean square of the error over the readings, about its mean (m, N or rad); `None` if it was tested for but not estimated.
    pub rms: Option<f64>,
}

/// Subject of a finding or of one of its alternatives.
#[derive(Debug, Clone)]
pub enum Subject {
    /// An effect of the catalogue on its targets.
    Cause(Cause),
    /// An error of readings without a known cause.
    UnmodelledError(UnmodelledError),
    /// Pulleys that are not where the description states them; an alternative of a cause only.
    WrongDrawing(DrawingPattern),
    /// A cable that is slack at some poses, by index; an alternative of a cause only.
    Slack(usize),
}

impl Subject {
    /// The cause; `None` for an unmodelled error.
    #[must_use]
    pub fn cause(&self) -> Option<&Cause> {
        match self {
            Self::Cause(cause) => Some(cause),
            Self::UnmodelledError(_) | Self::WrongDrawing(_) | Self::Slack(_) => None,
        }
    }

    /// Indices of the cables concerned; empty if it is not about single cables.
    #[must_use]
    pub fn cables(&self) -> Vec<usize> {
        match self {
            Self::Cause(cause) => cause.cables(),
            Self::UnmodelledError(error) => error.readings.cable.into_iter().collect(),
            Self::WrongDrawing(DrawingPattern::Pulley(cable)) | Self::Slack(cable) => vec![*cable],
            Self::WrongDrawing(_) => Vec::new(),
        }
    }
}

/// Alternative to the subject of a finding.
#[derive(Debug, Clone)]
pub struct Alternative {
    /// Subject of the alternative.
    pub subject: Subject,
    /// Posterior probability of the subject.
    pub probability: f64,
}

/// A cause with its posterior probability.
#[derive(Debug, Clone)]
pub struct PossibleCause {
    /// The cause.
    pub cause: Cause,
    /// Its posterior probability.
    pub probability: f64,
}

/// Causes that are present together, and no others, with their joint posterior probability.
#[derive(Debug, Clone)]
pub struct CauseSet {
    /// The causes; empty if nothing is wrong.
    pub causes: Vec<Cause>,
    /// Posterior probability, as computed.
    pub probability: f64,
}

/// Certainty about the cause of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// One cause stands out.
    Named,
    /// The data cannot tell the cause from its alternatives.
    Ambiguous,
    /// No effect of the catalogue explains the error.
    Unknown,
}

/// A parameter of a finding.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundParameter {
    /// Name of the parameter.
    pub name: &'static str,
    /// Cable, if each cable has its own parameter.
    pub cable: Option<usize>,
    /// Value (SI units).
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
    /// Standard deviation; `None` for parameters that are searched rather than fitted, such as the label of a pose.
    pub sd: Option<f64>,
}

/// A cause and its competitors, each fitted in its place.
#[derive(Debug, Clone)]
pub struct Rival {
    /// The cause, with the values fitted.
    pub cause: Cause,
    /// Reduction of chi-square.
    pub delta_chi2: f64,
    /// Number of its parameters.
    pub parameters: usize,
    /// Held-out root mean square over standard deviation with this cause.
    pub holdout: f64,
}

/// The statistics behind a verdict.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// Reduction of chi-square by the cause, with all other findings present.
    pub delta_chi2: f64,
    /// Number of its parameters.
    pub parameters: usize,
    /// P-value of the reduction, corrected for the number of tests.
    pub p_value: f64,
    /// Number of tests.
    pub questions: usize,
    /// Competitors fitted in its place, best first; the cause itself is the first entry.
    pub ranking: Vec<Rival>,
}

/// Gain on one kind of reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KindGain {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Held-out root mean square over standard deviation without the cause.
    pub before: f64,
    /// The same with the cause.
    pub after: f64,
}

/// Distance between the platform positions of the models with and without the cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionChange {
    /// Root mean square over the measured poses (m).
    pub rms_m: f64,
    /// 95 % interval (m).
    pub interval_m: [f64; 2],
    /// Maximum (m).
    pub largest_m: f64,
}

/// Gain of a finding on held-out poses.
#[derive(Debug, Clone, PartialEq)]
pub struct Gain {
    /// Held-out root mean square over standard deviation without the cause.
    pub before: f64,
    /// The same with the cause.
    pub after: f64,
    /// 95 % interval of `before - after`.
    pub interval: [f64; 2],
    /// Number of poses that were held out.
    pub poses_held_out: usize,
    /// Per kind of reading.
    pub kinds: Vec<KindGain>,
    /// Effect on the position of the platform.
    pub position: PositionChange,
}

/// Measurements and checks that would tell apart causes that the present data cannot.
#[derive(Debug, Clone, PartialEq)]
pub struct Separation {
    /// Proposed poses, the most informative first.
    pub poses: Vec<Pose>,
    /// Expected difference of chi-square between the two best causes once these poses are measured.
    pub expected_delta_chi2: f64,
    /// Advice for the user.
    pub advice: String,
}

/// A finding of the diagnosis.
#[derive(Debug, Clone)]
pub struct Finding {
    /// The cause with its values in the final model, or an error without a known cause.
    pub subject: Subject,
    /// Posterior probability of the subject. It and its alternatives exclude each other.
    pub probability: f64,
    /// Description for the user.
    pub sentence: String,
    /// Advice for the workshop.
    pub advice: String,
    /// Alternatives that the data cannot exclude, most probable first.
    pub alternatives: Vec<Alternative>,
    /// Parameters of the cause.
    pub parameters: Vec<FoundParameter>,
    /// The statistics behind the verdict.
    pub evidence: Evidence,
    /// Gain on held-out poses over the findings before it.
    pub gain: Gain,
    /// Measurements and checks that would tell the subject from its alternatives.
    pub separation: Option<Separation>,
}

impl Finding {
    /// Certainty about the cause.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match &self.subject {
            Subject::UnmodelledError(_) | Subject::WrongDrawing(_) | Subject::Slack(_) => {
                Verdict::Unknown
            }
            Subject::Cause(_) if self.probability >= NAMING_PROBABILITY => Verdict::Named,
            Subject::Cause(_) => Verdict::Ambiguous,
        }
    }

    /// The cause; `None` if an unmodelled error was found.
    #[must_use]
    pub fn cause(&self) -> Option<&Cause> {
        self.subject.cause()
    }

    /// All causes of which one may be present: its own, then those among its alternatives.
    pub fn causes(&self) -> impl Iterator<Item = &Cause> {
        let others = self.alternatives.iter().map(|other| &other.subject);
        let subjects = std::iter::once(&self.subject).chain(others);
        subjects.filter_map(Subject::cause)
    }

    /// Whether the cause is one of several that exclude each other. An ambiguous cause without alternatives is merely probable.
    #[must_use]
    pub fn is_list(&self) -> bool {
        self.verdict() == Verdict::Ambiguous && !self.alternatives.is_empty()
    }
}

/// A cable that was slack.
#[derive(Debug, Clone, PartialEq)]
pub struct SlackCable {
    /// Index of the cable.
    pub cable: usize,
    /// Labels of the poses.
    pub poses: Vec<i64>,
    /// Smallest and largest excess of the cable's length over the spanned distance at these poses (m); `None` if its force
    /// sensor tells the poses.
    pub excess_m: Option<[f64; 2]>,
    /// Log odds over the causes that explain the readings otherwise.
    pub log_odds: f64,
    /// Whether its readings are left out; otherwise it is listed beside these causes.
    pub is_left_out: bool,
}

/// An effect that the data cannot reveal at its typical size.
#[derive(Debug, Clone)]
pub struct Invisible {
    /// Effect and target.
    pub cause: Cause,
    /// Name and unit of the size parameter.
    pub parameter: (&'static str, &'static str),
    /// Smallest size that would be found with probability 0.9; `None` if no size would be.
    pub smallest_visible: Option<f64>,
}

/// Scatter of the parts of a robot, in units of their tolerances.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ToleranceFactor {
    /// Posterior mean of the factor; 0 for exact parts.
    pub factor: f64,
    /// Whether the factor refers to tolerances stated for the robot; otherwise to those of the catalogue.
    #[serde(rename = "stated")]
    pub are_stated: bool,
}

/// A fault that may be present without having been found.
#[derive(Debug, Clone)]
pub struct UnseenFault {
    /// Effect and target, at typical size.
    pub cause: Cause,
    pub(super) sizes: Vec<SizePosterior>,
}

impl UnseenFault {
    /// Posterior odds that the fault is present with at least `factor` times its typical size, against the findings alone.
    #[must_use]
    pub fn odds_beyond(&self, factor: f64) -> f64 {
        self.sizes.iter().map(|size| size.odds_beyond(factor)).sum()
    }

    /// Posterior probability that it is of at least this size if it is present.
    #[must_use]
    pub fn share_beyond(&self, factor: f64) -> f64 {
        (self.odds_beyond(factor) / self.odds_beyond(0.0).max(f64::MIN_POSITIVE)).min(1.0)
    }

    /// The same before the readings.
    #[must_use]
    pub fn prior_odds_beyond(&self, factor: f64) -> f64 {
        let sizes = self.sizes.iter();
        sizes.map(|size| size.prior_odds_beyond(factor)).sum()
    }
}

/// Result of a diagnosis.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// Goodness of fit of the model as supplied.
    pub base: Adequacy,
    /// Goodness of fit of the extended model; equal to `base` without findings.
    pub extended: Adequacy,
    /// Dependences of the residuals of the model as supplied, strongest first.
    pub discrepancies: Vec<Discrepancy>,
    /// Dependences that remain with the extended model.
    pub remaining: Vec<Discrepancy>,
    /// Displacement of the pulleys from the drawing, if there is one.
    pub drawing: Option<WrongDrawing>,
    /// A cable that was slack at some poses, or may have been; if that is likelier than not, its readings are left out there.
    pub slack: Option<SlackCable>,
    /// Findings in the order in which they extend the model.
    pub findings: Vec<Finding>,
    /// Causes that are possible but too improbable for a finding, most probable first.
    pub possible: Vec<PossibleCause>,
    /// The sets of causes that the search compared, most probable first; exchanged channels are undone before.
    pub sets: Vec<CauseSet>,
    /// Faults that are not among the findings, with their posterior probabilities.
    pub unseen: Vec<UnseenFault>,
    /// Scatter of the parts, in units of their tolerances.
    pub tolerances: ToleranceFactor,
    /// Noise that differs from the description.
    pub noise: Vec<NoiseStatement>,
    /// Effects that these data cannot reveal.
    pub invisible: Vec<Invisible>,
    /// Number of effects that the instruments could reveal, the invisible ones included.
    pub readable: usize,
    /// Number of effects of the model whose values are held, because no reading depends on them or there is nothing to
    /// estimate. They come first in `base_solution`.
    pub held: usize,
    /// Solution of the model as supplied, its effects estimated.
    pub base_solution: Solution,
    /// Solution of the extended model, with all of its effects.
    pub extended_solution: Solution,
    /// Whether the observer cancelled the diagnosis; the findings until then are reported.
    pub cancelled: bool,
}

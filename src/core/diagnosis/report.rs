//! What a diagnosis says: plain data.

use crate::effect::{BoundEffect, Effect};
use crate::estimation::Solution;
use crate::geometry::Pose;
use crate::measurement::Variable;

/// A kind of reading.
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
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Length,
        Self::Tension,
        Self::Laser,
        Self::Swivel,
        Self::Inclination,
        Self::TrackerPosition,
        Self::TrackerOrientation,
    ];

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
        }
    }
}

/// Chi-square test of a whole solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GlobalTest {
    /// Sum of squares.
    pub chi2: f64,
    /// Degrees of freedom.
    pub degrees_of_freedom: f64,
    /// Probability of a larger sum if model and noise are right.
    pub p_value: f64,
}

/// Test of one kind of reading, or of one cable of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroupTest {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable, or all of them.
    pub cable: Option<usize>,
    /// Number of readings.
    pub readings: usize,
    /// Root mean square of the residuals over what noise alone gives: 1 if all is right.
    pub rms_over_sd: f64,
    /// Two-sided probability, not corrected.
    pub p_value: f64,
}

/// A kind of reading whose noise is not what the description says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseStatement {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable, or all of them.
    pub cable: Option<usize>,
    /// Standard deviation over the one given.
    pub ratio: f64,
    /// 95 % interval of the ratio.
    pub interval: [f64; 2],
    /// Probability of such a ratio if the noise is as given, corrected for the number of questions.
    pub p_value: f64,
}

/// Whether a model explains the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Adequacy {
    /// Whether no test rejects.
    pub adequate: bool,
    /// Test of everything together.
    pub global: GlobalTest,
    /// Tests per kind of reading, then per cable.
    pub groups: Vec<GroupTest>,
}

/// A residual that depends on a variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Discrepancy {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable, if the reading is a cable's.
    pub cable: Option<usize>,
    /// On what the residual depends.
    pub variable: Variable,
    /// Root mean square of these residuals over what noise alone gives.
    pub rms_over_sd: f64,
    /// Probability if there is no dependence, corrected for the number of questions.
    pub p_value: f64,
    /// Row, variable and residual in its own standard deviations: what a plot shows.
    pub points: Vec<(usize, f64, f64)>,
}

/// An effect with its targets: one instance, or one for each cable that has its own values.
#[derive(Debug, Clone)]
pub struct Cause {
    /// The instances, all of the same effect.
    pub instances: Vec<BoundEffect>,
}

impl Cause {
    /// The effect.
    ///
    /// # Panics
    /// Never for a cause that a diagnosis made: it has an instance.
    #[must_use]
    pub fn effect(&self) -> &'static Effect {
        self.instances[0].effect
    }

    /// Cables concerned, by index; none for an effect of the robot, an instrument or all cables together.
    #[must_use]
    pub fn cables(&self) -> Vec<usize> {
        let targeted = self.instances.iter().filter(|bound| bound.targeted);
        targeted.flat_map(|bound| bound.cables.clone()).collect()
    }
}

/// A cause with its posterior probability.
#[derive(Debug, Clone)]
pub struct Alternative {
    /// The cause.
    pub cause: Cause,
    /// Its posterior probability.
    pub probability: f64,
}

/// How sure a finding is of its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// One cause stands out.
    Named,
    /// The data cannot separate it from its alternatives.
    Ambiguous,
    /// No effect of the catalogue explains it.
    Unknown,
}

/// A parameter of a finding.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundParameter {
    /// Name of the parameter.
    pub name: &'static str,
    /// Cable whose parameter it is, where each has its own.
    pub cable: Option<usize>,
    /// Value (SI units).
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
    /// Standard deviation; `None` for what was searched rather than fitted, as the label of a pose.
    pub sd: Option<f64>,
}

/// A cause in comparison with others that were fitted in its place.
#[derive(Debug, Clone)]
pub struct Rival {
    /// The cause, with the values fitted.
    pub cause: Cause,
    /// By how much it lowers chi-square.
    pub delta_chi2: f64,
    /// Number of its parameters.
    pub parameters: usize,
    /// Twice the logarithm of its evidence: the gain of chi-square less what its freedom is worth.
    pub score: f64,
    /// Angle between its signature and that of the first of the ranking, everything else estimated (rad).
    pub angle_rad: f64,
    /// Held-out root mean square over sd with this cause.
    pub holdout: f64,
}

/// The numbers behind a verdict.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// By how much the cause lowers chi-square, all other findings present.
    pub delta_chi2: f64,
    /// Number of its parameters.
    pub parameters: usize,
    /// Probability of such a gain without the cause, corrected for the number of questions.
    pub p_value: f64,
    /// How many questions were asked.
    pub questions: usize,
    /// All that were fitted in its place, the best first; the cause itself is the first.
    pub ranking: Vec<Rival>,
}

/// Gain on one kind of reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KindGain {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Held-out root mean square over sd without the cause.
    pub before: f64,
    /// The same with it.
    pub after: f64,
}

/// How far the platform is from where the model without the cause has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionChange {
    /// Root mean square over the measured poses (m).
    pub rms_m: f64,
    /// 95 % interval (m).
    pub interval_m: [f64; 2],
    /// The largest (m).
    pub largest_m: f64,
}

/// What a finding gains on poses that took no part in fitting.
#[derive(Debug, Clone, PartialEq)]
pub struct Gain {
    /// Held-out root mean square over sd without the cause.
    pub before: f64,
    /// The same with it.
    pub after: f64,
    /// 95 % interval of `before - after`.
    pub interval: [f64; 2],
    /// Number of poses that were held out.
    pub poses_held_out: usize,
    /// Per kind of reading.
    pub kinds: Vec<KindGain>,
    /// What it does to the robot.
    pub position: PositionChange,
}

/// What would separate causes that these data cannot.
#[derive(Debug, Clone, PartialEq)]
pub struct Separation {
    /// Further poses, the most telling first.
    pub poses: Vec<Pose>,
    /// Chi-square by which the two best causes are expected to differ once these poses are measured.
    pub expected_delta_chi2: f64,
    /// What a technician reads.
    pub advice: String,
}

/// One thing that was found.
#[derive(Debug, Clone)]
pub struct Finding {
    /// How sure the name is.
    pub verdict: Verdict,
    /// The cause with the values of the final model.
    pub cause: Cause,
    /// Posterior probability of the cause. It and its alternatives exclude each other.
    pub probability: f64,
    /// The sentence that a technician reads.
    pub sentence: String,
    /// What to do in the workshop.
    pub advice: String,
    /// Causes that the data cannot separate from it, the likeliest first.
    pub alternatives: Vec<Alternative>,
    /// Its parameters.
    pub parameters: Vec<FoundParameter>,
    /// The numbers behind the verdict.
    pub evidence: Evidence,
    /// What it gains on poses held out, on top of the findings before it.
    pub gain: Gain,
    /// What would separate it from its alternatives.
    pub separation: Option<Separation>,
}

/// An effect that the data cannot show at its typical size.
#[derive(Debug, Clone)]
pub struct Invisible {
    /// Effect and target.
    pub cause: Cause,
    /// Name and unit of the parameter.
    pub parameter: (&'static str, &'static str),
    /// Smallest size that would be found with probability 0.9; `None` if no size would.
    pub smallest_visible: Option<f64>,
}

/// Everything that a diagnosis found.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// Whether the model as it came explains the data.
    pub base: Adequacy,
    /// Whether the extended model does; the same as `base` without findings.
    pub extended: Adequacy,
    /// Dependences of the residuals of the model as it came, the strongest first.
    pub discrepancies: Vec<Discrepancy>,
    /// Those that are left with the extended model.
    pub remaining: Vec<Discrepancy>,
    /// What was found, in the order in which it was added.
    pub findings: Vec<Finding>,
    /// Causes that are possible but too improbable for a finding, the likeliest first.
    pub possible: Vec<Alternative>,
    /// Noise that is not as the description says.
    pub noise: Vec<NoiseStatement>,
    /// Effects that these data cannot show.
    pub invisible: Vec<Invisible>,
    /// The solution of the model as it came.
    pub base_solution: Solution,
    /// The solution of the extended model; its effects are all of the model's.
    pub extended_solution: Solution,
    /// Whether the observer cancelled; what was found until then is reported.
    pub cancelled: bool,
}

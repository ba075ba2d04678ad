//! Priors of a diagnosis: probabilities of causes and errors, distributions of their sizes, and of the noise.

/// A number for each kind of target of an effect on cables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TargetShares {
    /// One cable, any of them.
    pub one: f64,
    /// All cables with a common value.
    pub all_alike: f64,
    /// Each cable with a value of its own.
    pub each_own: f64,
    /// Several cables with values of their own, split evenly over their number, then over the choices of that many.
    pub several_own: f64,
    /// Several cables with a common value, split in the same way.
    pub several_alike: f64,
}

// Causes.
/// Prior expectation of the number of causes, shared equally among the effects that the readings could show.
pub const EXPECTED_CAUSES: f64 = 0.8;
/// Largest prior expectation of the number of causes that hypotheses of the user describe, all together: an eighth of that
/// of the catalogue, so that a crowd of them cannot outweigh it.
pub(super) const EXPECTED_HYPOTHESES: f64 = 0.1;
/// Prior weights of the targets of an effect on cables. Its probability is shared in their proportion by the targets that
/// it can have. If something is wrong with one winch, it is often wrong with others.
pub(super) const TARGET_WEIGHTS: TargetShares = TargetShares {
    one: 0.5,
    all_alike: 0.3,
    each_own: 0.1,
    several_own: 0.1,
    several_alike: 0.05,
};
/// The weight of a step of each cable at one pose, as after zeroing all winches again: rarer than a slip of one.
pub(super) const STEP_OF_EACH: f64 = 0.02;
/// Prior correlation between the values of different cables.
pub(super) const FAMILY_CORRELATION: f64 = 0.3;

// Sizes.
/// Prior probability that a size exceeds the typical ones.
pub(super) const ATYPICAL_SHARE: f64 = 0.04;
/// Ratio of adjacent scales of the prior of a size.
pub(super) const SCALE_RATIO: f64 = 4.0;
/// Prior standard deviation of a size over the largest typical size, at scale 1.
pub(super) const RELATIVE_SD: f64 = 0.5;
/// Sizes from this multiple of the largest typical size on are taken as impossible.
pub(super) const IMPOSSIBLE_FACTOR: f64 = 10.0;

// Tolerances.
/// Factors of the tolerances that are compared. Parts that deviate by less than the smallest are exact; tolerances that
/// are wrong by more than the largest are a matter for the background.
pub(super) const FACTORS: [f64; 5] = [0.0, 0.3, 0.6, 1.0, 2.0];
/// Index of the factor at which the estimation starts: between exact parts and parts as stated.
pub(super) const FIRST_FACTOR: usize = 2;
/// Index of the factor of parts that scatter as stated.
pub(super) const AS_STATED: usize = 3;
/// Deviation from which a part is outside its tolerance: a normal variable exceeds so many standard deviations once in 16,000 times.
pub(super) const LARGEST_DEVIATION: f64 = 4.0;

// Slack cables.
/// Prior probability that a cable is slack at some pose.
pub(super) const SLACK_CABLE: f64 = 0.05;
/// Largest length by which a slack cable is longer than the distance that it spans, as a share of the frame's size.
pub(super) const LARGEST_SLACK: f64 = 0.015;
/// Force that a slack cable's sensor reads at most, in its standard deviations.
pub(super) const SLACK_FORCE: f64 = 4.0;

// The drawing.
/// Prior probability that the places of the pulleys are not those that the description states.
pub(super) const WRONG_DRAWING: f64 = 0.05;
/// Factors of the stated standard deviation of a pattern if the drawing is wrong, equally probable: from a hole beside the right one to
/// typing and measuring errors of decimetres where millimetres are stated.
pub(super) const PLACES_WIDER: [f64; 3] = [3.0, 10.0, 30.0];
/// The last of them, also that of places that are wrong anywhere: less would let them explain any small error.
pub(super) const MOST_WIDER: f64 = PLACES_WIDER[2];

// Noise.
/// Weight of the prior of a kind's variance around the described one, in numbers of readings.
pub(super) const KIND_VARIANCE_WEIGHT: f64 = 1.0;
/// Weight of the prior of a cable's variance around that of its kind, in numbers of readings.
pub(super) const CABLE_VARIANCE_WEIGHT: f64 = 60.0;
/// Bounds of the variance factors.
pub(super) const VARIANCES: [f64; 2] = [1e-3, 1e5];
/// Prior probability that the noise of a kind of reading has heavy tails.
pub(super) const HEAVY_TAILS: f64 = 0.01;
/// Degrees of freedom of Student's t that are tried: the fewer, the heavier the tails.
pub(super) const TAIL_FREEDOMS: [f64; 3] = [3.0, 4.0, 6.0];
/// Scales of Student's t that are tried, in standard deviations of the other readings.
pub(super) const TAIL_SCALES: [f64; 5] = [0.6, 0.7, 0.8, 0.9, 1.0];

// Background.
/// Grid of the amplitudes of the background, in standard deviations of the readings as described.
pub(super) const AMPLITUDES: [f64; 8] = [0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
/// Prior probability that a kind of reading has no background.
pub(super) const NO_BACKGROUND: f64 = 0.7;
/// Prior probability that a class of readings has the amplitude of its kind.
pub(super) const SAME_AS_KIND: f64 = 0.85;
/// Highest degree of the background's polynomials of the position.
pub(super) const BACKGROUND_DEGREE: usize = 5;
/// Half waves over the duration of the measurement. The first one is left out because it looks like a drift.
pub(super) const BACKGROUND_HALF_WAVES: std::ops::RangeInclusive<usize> = 2..=8;
/// Readings needed for each function of the background.
pub(super) const READINGS_PER_BACKGROUND_FUNCTION: usize = 3;

// Unmodelled errors.
/// Prior expectation of the number of unmodelled errors; real machines have more of them than faults.
pub(super) const EXPECTED_ERRORS: f64 = 2.0;
/// Prior sizes of the functions of an unmodelled error, in standard deviations of a reading.
pub(super) const ERROR_SIZES: [f64; 8] = [0.5, 1.0, 2.0, 4.0, 16.0, 64.0, 256.0, 1024.0];
/// Maximum number of smooth functions of one variable, of an error and of a dependence that is tested.
pub(super) const MAX_SMOOTH_FUNCTIONS: usize = 5;
/// Readings needed for each smooth function.
pub(super) const READINGS_PER_SMOOTH_FUNCTION: usize = 4;
/// Minimum number of waves over the range; anything slower is covered by the smooth functions.
pub(super) const MIN_WAVES: f64 = 1.5;
/// Correlation lengths of Gaussian fields, whose variables are scaled to the interval from -1 to 1.
pub(super) const CORRELATION_LENGTHS: [f64; 2] = [0.5, 1.2];
/// Minimum number of readings for fitting an error.
pub(super) const MIN_READINGS_OF_ERROR: usize = 8;

//! Limits of the work of a diagnosis and of its arithmetic. Wider limits would cost time and hardly change a result.

use crate::measurement::MostRows;

// Search over sets.
/// Log posterior below the best down to which a set is extended.
pub(super) const EXTEND_WITHIN: f64 = 6.0;
/// Log posterior below the best down to which an extension is recorded.
pub(super) const RECORD_WITHIN: f64 = 9.0;
/// Maximum number of extensions recorded for one set.
pub(super) const MAX_RECORDED: usize = 40;
/// Maximum number of sets whose families are reduced at a time.
pub(super) const MAX_REDUCED: usize = 8;
/// Number of causes tried in place of a family, each extended by another cause.
pub(super) const MAX_REPLACEMENTS: usize = 4;
/// Maximum number of points of hyperparameters at each fit.
pub(super) const MAX_POINTS: usize = 5;
/// Chi-square per degree of freedom above which the described noise is no sensible point.
pub(super) const UNEXPLAINED_CHI2: f64 = 100.0;
/// Maximum number of sets that each search extends.
pub(super) const MAX_EXTENDED: usize = 20;
/// Log posterior below the best down to which sets are kept.
pub(super) const KEPT_WITHIN: f64 = 12.0;
/// Log posterior below the best down to which the scales of a set are optimised again.
pub(super) const SETTLED_WITHIN: f64 = 8.0;
/// Information relative to that of the prior below which the data do not determine a parameter.
pub(super) const MIN_INFORMATION: f64 = 1e-2;
/// The other scales are not tried if the middle one is lower than required by more than `MAX_DEFICIT`, unless the gain
/// there exceeds `STRONG_GAIN`, where the scale may matter more.
pub(super) const MAX_DEFICIT: f64 = 12.0;
/// See [`MAX_DEFICIT`].
pub(super) const STRONG_GAIN: f64 = 20.0;

// Full fits.
/// Maximum number of linearisations.
pub(super) const MAX_LINEARISATIONS: usize = 5;
/// Change of chi-square from which the effects are evaluated at the poses of the new fit.
pub(super) const MOVED_CHI2: f64 = 0.5;
/// Maximum number of full fits at a time.
pub(super) const MAX_FITS: usize = 8;
/// Log posterior below the best down to which a set gets a full fit.
pub(super) const FIT_WITHIN: f64 = 5.0;
/// Log posterior below the best down to which the most probable set without one of its causes is still fitted.
pub(super) const RIVAL_WITHIN: f64 = 18.0;
/// Number of steps after which a fit that is still worse than required is abandoned; successful fits need half as many.
pub(super) const PATIENCE: usize = 15;
/// Maximum number of steps of a fit with causes; one that converges more slowly explains nothing.
pub(super) const MAX_STEPS_WITH_CAUSES: usize = 40;
/// Chi-square per degree of freedom above which sets are compared by full fits rather than in the linearised problem.
pub(super) const FAR_FROM_NOISE: f64 = 5.0;
/// Chi-square per degree of freedom above which a fit of exact parts is compared with one of parts within their tolerances.
pub(super) const MORE_THAN_NOISE: f64 = 1.2;
/// Largest share of the excess over noise that the fit with deviations may leave if it is to be used.
pub(super) const MOST_LEFT: f64 = 0.5;
/// Number of steps after which a fit is abandoned if it is still worse than the best one found. Readings far from the
/// model need more steps than others.
pub(super) const PATIENCE_FAR_FROM_NOISE: usize = 25;
/// Number of the best sets that are fitted in each step far from the noise.
pub(super) const MAX_BEST_SETS: usize = 5;
/// Number of kinds for which the best set with one more cause is fitted, too.
pub(super) const MAX_KINDS: usize = 8;
/// Number of steps after which a fit is abandoned if chi-square is still too large; the right exchange converges in
/// half as many.
pub(super) const PATIENCE_WITH_EXCHANGE: usize = 6;
/// Maximum number of rows that a diagnosis takes: a diagnosis fits many models, and each takes time and memory in proportion. The
/// information of a thousand poses shows anything that matters to the robot.
pub const MOST_DIAGNOSED_ROWS: MostRows = MostRows {
    samples: 300,
    poses: 1000,
};

/// Largest share of the poses at which a cable is slack: with more, nothing says which poses are the others.
pub(super) const LARGEST_SHARE_OF_SLACK: f64 = 0.4;
/// Maximum number of cables without force sensors that are tried as slack.
pub(super) const MAX_SLACK_CABLES: usize = 2;
/// Maximum number of poses at which a cable without a force sensor can be found slack.
pub(super) const MAX_SLACK_POSES: usize = 40;
/// Redundancy below which the residual of a length does not determine the noise.
pub(super) const MIN_REDUNDANCY_OF_NOISE: f64 = 0.05;
/// Redundancy below which a length does not show whether its cable is slack.
pub(super) const MIN_REDUNDANCY_OF_SLACK: f64 = 0.01;
/// Smallest decrease of chi-square for which a pose counts as one at which a cable may be slack.
pub(super) const MIN_RELIEF: f64 = 6.0;

// Columns and functions.
/// Maximum number of columns in one linearisation.
pub(super) const COLUMNS_AT_ONCE: usize = 64;
/// Number of frequencies tried per wave over the range of the variable.
pub(super) const FREQUENCIES_PER_WAVE: f64 = 2.5;
/// Maximum number of periods of an effect that are tried.
pub(super) const MAX_PERIODS: f64 = 300.0;
/// Maximum number of waves of an unmodelled error over the range of a variable.
pub(super) const MAX_WAVES: f64 = 64.0;
/// Maximum number of inducing points of a Gaussian field.
pub(super) const MAX_INDUCING_POINTS: usize = 40;
/// Number of columns up to which their products with others are computed alone instead of with whole rows.
pub(super) const FEW_COLUMNS: usize = 24;
/// Number of the best unmodelled errors that are compared exactly.
pub(super) const MAX_COMPARED: usize = 5;
/// Log odds of all unmodelled errors together from which they are compared exactly.
pub(super) const COMPARE_ABOVE: f64 = -2.0;

// Estimation of the noise.
/// Maximum number of steps of the estimation of hyperparameters.
pub(super) const MAX_HYPER_STEPS: usize = 12;
/// Largest change of a log variance at convergence of that estimation.
pub(super) const HYPER_CONVERGED: f64 = 0.05;
/// Decrease of the log posterior density that a step may cause.
pub(super) const TOLERATED_DECREASE: f64 = 0.05;
/// Maximum number of steps of the estimation of the variances that are reported.
pub(super) const MAX_VARIANCE_STEPS: usize = 8;
/// Largest relative change of a variance at convergence of that estimation.
pub(super) const VARIANCE_CONVERGED: f64 = 1e-2;
/// Smallest factor of a variance in one step; anything smaller would overshoot.
pub(super) const MIN_VARIANCE_STEP: f64 = 0.1;
/// A variance with fewer degrees of freedom than this is not estimated.
pub(super) const MIN_FREEDOM: f64 = 2.0;
/// Minimum number of cables for deciding that one of them differs from the others.
pub(super) const MIN_CABLES: usize = 3;
/// Redundancy below which the residual of a reading does not show its error.
pub(super) const MIN_REDUNDANCY_OF_TAILS: f64 = 0.1;
/// Share of its prior standard deviation from which on a component of a wrong reading is not determined.
pub(super) const UNDETERMINED: f64 = 0.5;

// What is reported.
/// Maximum number of alternatives listed with a cause.
pub(super) const MAX_ALTERNATIVES: usize = 2;
/// Smallest probability of an alternative that is listed.
pub(super) const MIN_LISTED_PROBABILITY: f64 = 0.005;
/// Smallest probability of a possible cause.
pub(super) const MIN_POSSIBLE_PROBABILITY: f64 = 0.05;
/// Maximum number of unmodelled errors that are reported.
pub(super) const MAX_REPORTED_ERRORS: usize = 3;
/// Maximum number of variables that are reported for the same readings.
pub(super) const MAX_REPORTED_VARIABLES: usize = 3;
/// Readings with a smaller redundancy than this are left out of plots, because their residuals carry no information.
pub(super) const MIN_PLOTTED_REDUNDANCY: f64 = 1e-3;
/// Number of bootstrap samples for the interval of a gain.
pub(super) const RESAMPLES: usize = 1000;
/// Seed of their random numbers.
pub(super) const BOOTSTRAP_SEED: u64 = 2018;
/// Minimum number of poses tried for telling two causes apart.
pub(super) const MIN_SEPARATING_POSES: usize = 80;
/// Maximum number of poses tried.
pub(super) const MAX_SEPARATING_POSES: usize = 500;
/// Number of poses proposed.
pub(super) const PROPOSED_POSES: usize = 5;
/// Seed of the poses tried.
pub(super) const SEPARATING_SEED: u64 = 41;
/// Maximum number of measurements at one pose.
pub(super) const MAX_REPEATS: usize = 40;
/// Number of points of the sequence over which isolability is averaged, for a single fault and for a pair.
pub(super) const ISOLABILITY_POINTS: [usize; 2] = [4096, 1024];
/// Number of points over which the size of an unseen fault with several coordinates is averaged.
pub(super) const UNSEEN_POINTS: usize = 256;
/// Odds below which an unseen fault is left out at a scale: thousands of them add up to less than one in a hundred.
pub(super) const NEGLIGIBLE_ODDS: f64 = 1e-6;
/// Noncentrality that a candidate leaves unexplained above which it is ruled out without sampling: the log odds are
/// then above 100, with a standard deviation of 14.
pub(super) const RULED_OUT: f64 = 200.0;

// Numerical limits.
/// Regularises directions of the fixed parameters that the data do not determine.
pub(super) const RIDGE: f64 = 1e-11;
/// Eigenvalues of the scaled information below this share of the largest one count as zero: their directions are
/// undetermined.
pub(super) const SINGULAR: f64 = 1e-12;
/// Smallest square of a pivot of the scaled information, the share of a column that no others explain, at which the
/// Cholesky factor has at least half of the digits.
pub(super) const WELL_DETERMINED: f64 = 1e-8;
/// Eigenvalues of a projector are 0 or 1; this threshold tells them apart.
pub(super) const PROJECTOR_THRESHOLD: f64 = 0.5;
/// Eigenvalue (variance of a reading in units of its noise, at factor 1) below which a combination cannot be seen.
pub(super) const MIN_VISIBLE_VARIANCE: f64 = 3e-3;
/// Smallest share of a function's norm that must remain after projection for it to count as new.
pub(super) const MIN_INDEPENDENT_PART: f64 = 0.05;
/// Directions of the functions whose share in the residuals is smaller than this are left out.
pub(super) const MIN_VISIBLE_SHARE: f64 = 1e-6;
/// Added to the diagonal to keep the covariance of a field positive definite.
pub(super) const NUGGET: f64 = 1e-6;
/// Minimum number of different values for a dependence to be visible.
pub(super) const MIN_VALUES: usize = 6;
/// Values that differ by less than this share of their spread count as equal.
pub(super) const SAME_VALUE: f64 = 1e-9;
/// A spread below this share of the largest value is rounding error.
pub(super) const MIN_RELATIVE_SPREAD: f64 = 1e-12;

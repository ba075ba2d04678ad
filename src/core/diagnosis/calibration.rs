//! Decisions on computed probabilities: from where on something is said, and how a computed probability becomes a stated one.

// What is named and listed.
/// Posterior probability from which a cause is named, or several together are listed.
pub(super) const NAMING_PROBABILITY: f64 = 0.95;
/// Probability of detection at the smallest visible size.
pub(super) const POWER: f64 = 0.9;
/// Difference of chi-square by which a further pose counts as decisive between two causes.
pub(super) const DECISIVE_CHI2: f64 = 9.0;
/// Significance level at which readings count as scattering more than described.
pub(super) const EXCESS_LEVEL: f64 = 0.01;

// Exchanged channels.
/// Chi-square per degree of freedom above which an exchange is looked for, because wrong channels make huge residuals.
pub(super) const HUGE_CHI2: f64 = 4.0;
/// Share of the excess chi-square that may remain after an exchange of channels, for example that of a second one.
pub(super) const MAX_REMAINING_EXCESS: f64 = 0.25;
/// Difference of chi-square that separates one exchange from another.
pub(super) const DISTINGUISHING_CHI2: f64 = 9.0;

// Identity of causes.
/// Ratio of their periods from which two waves are different causes. Closer ones may be the same wave, estimated twice.
pub(super) const DISTINCT_PERIODS: f64 = 1.1;
/// Members that have less than this share of their information left, given the others, count as collinear.
pub(super) const COLLINEAR: f64 = 0.05;
/// Relative error of the linear comparison when another cause replaces one, as a share of what the cause explains.
pub(super) const LINEARISATION_ERROR: f64 = 0.05;

// Causes that the evidence makes possible but the fit does not confirm.
/// Probability from which an unconfirmed cause counts as likely.
pub(super) const LIKELY: f64 = 0.5;
/// Odds against a cause that the evidence makes possible but that did not become a finding, where the findings explain the
/// readings. Of 103 such causes in simulated data, half of them with effects outside the catalogue or a slightly wrong
/// model, 4 were present.
pub(super) const ODDS_AGAINST_UNCONFIRMED: f64 = 4.0;
/// The same where an unmodelled error remains, which explains what such a cause would explain; of 93, none was present.
pub(super) const ODDS_AGAINST_SUPERSEDED: f64 = 20.0;

// Errors outside the catalogue that look like a cause.
/// Log odds for a cause against an error outside the catalogue that looks exactly like it.
pub(super) const LOOKS_THE_SAME: f64 = 4.5;
/// Probability that an error outside the catalogue imitates a cause that explains a chi-square of 1; it falls with the square
/// root of the chi-square explained. This and the two rates below were counted on simulated development data, some with a
/// slightly wrong model or an effect outside the catalogue.
pub(super) const IMITATION_RATE: f64 = 0.5;
/// Largest probability of an imitation.
pub(super) const MAX_IMITATION_RATE: f64 = 0.02;
/// Probability that none of the causes of a list is present.
pub(super) const NONE_PRESENT_RATE: f64 = 0.2;
/// A name becomes ambiguous if readings of its cables have excess scatter of more than this share of what the cause
/// explains.
pub(super) const EXCESS_SHARE: f64 = 0.25;
/// A remaining unmodelled error makes a name ambiguous if it explains more than `ERROR_SHARE` of what the cause
/// explains and either is on the same cable or is in readings that have more than `READINGS_SHARE` of the effect of the
/// cause.
pub(super) const ERROR_SHARE: f64 = 0.05;
/// See [`ERROR_SHARE`].
pub(super) const READINGS_SHARE: f64 = 0.2;
/// Log posterior odds from which an unmodelled error is reported.
pub(super) const REPORTED_LOG_ODDS: f64 = 5.0;
/// Log odds of an unmodelled error in place of a cause below which it is ignored.
pub(super) const NEGLIGIBLE_LOG_ODDS: f64 = -6.0;
/// Log odds that an unmodelled error exists beside a cause below which the cause is more probable.
pub(super) const CAUSE_LIKELIER: f64 = 3.0;
/// A cause with no more parameters than an unmodelled error is preferred if it explains at least `NEARLY_ALL` of what
/// the error explains. From the share `EVERYTHING` on, the error has no advantage at all.
pub(super) const NEARLY_ALL: f64 = 0.9;
/// See [`NEARLY_ALL`].
pub(super) const EVERYTHING: f64 = 0.98;
/// If the log odds of the error exceed this all the same, the question remains open with the log odds
/// [`UNDECIDED_LOG_ODDS`].
pub(super) const UNDECIDED_ABOVE: f64 = 6.0;
/// See [`UNDECIDED_ABOVE`].
pub(super) const UNDECIDED_LOG_ODDS: f64 = 2.2;
/// Lower bound of the share of squared residuals that an error leaves, used when targets are compared.
pub(super) const MIN_SHARE_LEFT: f64 = 0.25;

//! Which causes the data ask for: added one by one, exchanged where another fits better, taken back where not
//! needed.

use super::family::{reduced, united};
use super::fit::Fit;
use super::gain::Prediction;
use super::progress::Reporter;
use super::report::Cause;
use super::scores::{Scan, Scored, scan};
use super::unknown::{is_unknown, unknowns};
use super::{DiagnosisOptions, Stage};
use crate::effect::{BoundEffect, Search};
use crate::estimation::{EstimationError, Problem};
use crate::statistics::chi_square_survival;

/// Most causes that are fitted completely in each round.
const REFITS: usize = 32;
/// Most functions without a name that are fitted completely in each round.
const UNKNOWNS: usize = 3;
/// Most rounds of exchanges.
const MOST_ROUNDS: usize = 4;
/// Difference of the evidence up to which a name is preferred to structure without one.
pub(super) const PREFERRED: f64 = 4.5;
/// Difference of the evidence from which a cause takes another's place.
const BETTER: f64 = 0.5;
/// Difference of the evidence (twice its logarithm) at which one cause stands out from another.
pub(super) const CLEAR: f64 = 9.0;

/// A cause fitted completely in a given place.
#[derive(Debug, Clone)]
pub(super) struct Contender<'a> {
    pub fit: Fit<'a>,
    pub scored: Scored,
    /// Gain of chi-square over the model without it.
    pub gain: f64,
    /// What its freedom is worth.
    pub freedom: f64,
}

impl Contender<'_> {
    pub fn score(&self) -> f64 {
        self.gain - self.freedom
    }

    /// Probability of such a gain without the cause, not corrected for the number of questions.
    pub fn p_value(&self) -> f64 {
        chi_square_survival(self.gain, self.scored.visible as f64).unwrap_or(1.0)
    }

    /// Whether it is structure without a name.
    pub fn is_unknown(&self) -> bool {
        is_unknown(&self.scored.cause)
    }

    /// The cause with the values fitted; it is the last of the fit.
    pub fn cause(&self) -> &Cause {
        self.fit.causes.last().unwrap_or(&self.scored.cause)
    }
}

/// Fits the most promising causes of a scan on top of `fit`; the best first.
pub(super) fn contenders<'a>(
    base: &Problem<'a>,
    fit: &Fit<'a>,
    scan: &Scan,
    mut unknown: Vec<Scored>,
) -> Result<Vec<Contender<'a>>, EstimationError> {
    let is_new = |scored: &&Scored| {
        let known = |cause: &Cause| is_contained(&scored.cause, cause);
        scored.visible > 0 && !fit.causes.iter().any(known)
    };
    let mut promising: Vec<&Scored> = scan.scored.iter().filter(is_new).collect();
    promising.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let mut found = Vec::new();
    unknown.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let unknown = unknown.iter().take(UNKNOWNS);
    for scored in promising.into_iter().take(REFITS).chain(unknown) {
        let mut causes = fit.causes.clone();
        causes.push(scored.cause.clone());
        let refit = Fit::below(fit.solution.chi2, base, &causes)?;
        found.push(Contender {
            gain: fit.solution.chi2 - refit.solution.chi2,
            freedom: scored.freedom,
            scored: scored.clone(),
            fit: refit,
        });
    }
    found.sort_by(|a, b| b.score().total_cmp(&a.score()));
    Ok(found)
}

/// Whether a cause has an instance that the other has already, or has for all cables together: what is common to
/// all is not asked of one again.
fn is_contained(cause: &Cause, other: &Cause) -> bool {
    let pair = |one: &BoundEffect, other: &BoundEffect| {
        let event = match one.effect.search() {
            Search::FromPose(pose) | Search::AtPose(pose) => Some(pose),
            _ => None,
        };
        let covered = !other.targeted || one.targeted && one.cables == other.cables;
        one.effect.id() == other.effect.id()
            && covered
            && event.is_none_or(|pose| one.values[pose] == other.values[pose])
    };
    let instances = || cause.instances.iter();
    instances().any(|one| other.instances.iter().any(|other| pair(one, other)))
}

/// A model with causes, and what else could stand in the place of each.
pub(super) struct Selection<'a> {
    pub base: Fit<'a>,
    /// Scan of the model without any cause.
    pub first: Scan,
    pub fit: Fit<'a>,
    /// For each cause of the fit: what was fitted in its place.
    pub rounds: Vec<Round<'a>>,
}

/// Everything that was asked and fitted on top of one model, the best first.
#[derive(Debug, Clone)]
pub(super) struct Round<'a> {
    /// Catalogue and structure without a name.
    pub contenders: Vec<Contender<'a>>,
    /// Number of questions: of the catalogue, of structure without a name.
    pub questions: [usize; 2],
    pub scan: Scan,
}

impl<'a> Round<'a> {
    fn new(base: &Problem<'a>, fit: &Fit<'a>) -> Result<Self, EstimationError> {
        let scan = scan(fit);
        let unknown = unknowns(fit, &scan);
        Ok(Self {
            questions: [scan.questions, unknown.questions],
            contenders: contenders(base, fit, &scan, unknown.scored)?,
            scan,
        })
    }

    /// Makes sure that a cause is among the contenders: one on several cables is no question of its own.
    fn include(
        &mut self,
        base: &Problem<'a>,
        without: &Fit<'a>,
        cause: &Cause,
    ) -> Result<(), EstimationError> {
        if self.of(cause).is_some() {
            return Ok(());
        }
        let mut causes = without.causes.clone();
        causes.push(cause.clone());
        let fit = Fit::new(base, &causes)?;
        let parameters = fit.parameters_of(causes.len() - 1).len();
        let gain = without.solution.chi2 - fit.solution.chi2;
        self.contenders.push(Contender {
            scored: Scored {
                cause: cause.clone(),
                gain,
                freedom: parameters as f64 * self.scan.price(),
                places: 0.0,
                visible: parameters,
                sd: None,
            },
            freedom: parameters as f64 * self.scan.price(),
            gain,
            fit,
        });
        self.contenders
            .sort_by(|a, b| b.score().total_cmp(&a.score()));
        Ok(())
    }

    /// Probability of such a gain without the cause, corrected for the number of questions: names and structure
    /// without one each have half of the level.
    pub fn corrected(&self, contender: &Contender<'_>) -> f64 {
        let asked = self.questions[usize::from(contender.is_unknown())];
        (2.0 * asked as f64 * contender.p_value()).min(1.0)
    }

    /// Whether a contender would be found in data without it with a probability below `alpha`.
    pub fn is_significant(&self, contender: &Contender<'_>, alpha: f64) -> bool {
        self.corrected(contender) < alpha && contender.score() > 0.0
    }

    /// The best that is significant and predicts poses held out better; a name comes before structure without one
    /// unless it is clearly worse.
    fn best(&self, without: &Fit<'_>, alpha: f64) -> Option<&Contender<'a>> {
        let before = Prediction::new(without);
        let accepted = |contender: &&Contender<'a>| {
            self.is_significant(contender, alpha)
                && Prediction::new(&contender.fit).is_better_than(&before)
        };
        let best = self.contenders.iter().find(accepted)?;
        if !best.is_unknown() {
            return Some(best);
        }
        let near = |c: &&Contender<'a>| best.score() - c.score() < PREFERRED;
        let mut names = self.contenders.iter().filter(|c| !c.is_unknown());
        let named = names.by_ref().take_while(near).find(accepted);
        Some(named.unwrap_or(best))
    }

    /// The contender with the effect and target of a cause, wherever it acts.
    pub fn of(&self, cause: &Cause) -> Option<&Contender<'a>> {
        self.contenders.iter().find(|c| is_alike(c.cause(), cause))
    }
}

/// Same effect, same targets; events may be at different poses.
pub(super) fn is_alike(one: &Cause, other: &Cause) -> bool {
    one.effect().id() == other.effect().id()
        && one.cables() == other.cables()
        && one.instances.len() == other.instances.len()
}

/// The same effect with values for more cables: it fits better whatever is true.
pub(super) fn is_extension(cause: &Cause, of: &Cause) -> bool {
    cause.effect().id() == of.effect().id() && cause.instances.len() > of.instances.len()
}

/// Adds causes until what is left is noise, then exchanges and takes back.
pub(super) fn select<'a>(
    base: &Problem<'a>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Selection<'a>, EstimationError> {
    let start = Fit::new(base, &[])?;
    let mut fit = start.clone();
    let mut first: Option<Round<'a>> = None;
    while fit.causes.len() < options.most_findings && report.stage(Stage::Scores, fit.causes.len())
    {
        let round = Round::new(base, &fit)?;
        let best = round.best(&fit, options.alpha).map(|best| best.fit.clone());
        first.get_or_insert(round);
        match best {
            Some(best) => fit = best,
            None => break,
        }
    }
    let mut selection = Selection {
        first: first
            .as_ref()
            .map_or_else(|| scan(&start), |round| round.scan.clone()),
        base: start,
        rounds: Vec::new(),
        fit,
    };
    let price = selection.first.price();
    selection.fit = reduced(base, selection.fit, price)?;
    match (first, selection.fit.causes.as_slice()) {
        (Some(mut round), [only]) => {
            // Nothing else is in the model: what was asked first is the answer.
            round.include(base, &selection.base, only)?;
            selection.rounds.push(round);
        }
        _ => selection.settle(base, options, report, price)?,
    }
    Ok(selection)
}

impl<'a> Selection<'a> {
    /// The causes with what their freedom is worth, those that gain most first.
    pub fn by_strength(&self) -> Vec<(Cause, f64)> {
        let pairs = self.fit.causes.iter().zip(&self.rounds);
        let mut found: Vec<(&Contender<'a>, &Cause)> = pairs
            .filter_map(|(cause, round)| Some((round.of(cause)?, cause)))
            .collect();
        found.sort_by(|a, b| b.0.gain.total_cmp(&a.0.gain));
        let pair =
            |(contender, cause): (&Contender<'a>, &Cause)| (cause.clone(), contender.freedom);
        found.into_iter().map(pair).collect()
    }

    /// Exchanges, unites, and compares what has changed. A cause that was not compared, since the diagnosis was
    /// cancelled, is left out.
    fn settle(
        &mut self,
        base: &Problem<'a>,
        options: &DiagnosisOptions,
        report: &mut Reporter<'_, '_>,
        price: f64,
    ) -> Result<(), EstimationError> {
        self.exchange(base, options, report)?;
        let causes = self.fit.causes.len();
        self.fit = united(base, self.fit.clone(), price)?;
        if self.fit.causes.len() < causes {
            self.exchange_each(base, options, report, false)?;
        }
        if self.rounds.len() < self.fit.causes.len() {
            self.fit = Fit::new(base, &self.fit.causes[..self.rounds.len()])?;
        }
        Ok(())
    }

    /// Puts in the place of each cause whatever fits best there, and takes back what is not needed, until
    /// nothing changes.
    fn exchange(
        &mut self,
        base: &Problem<'a>,
        options: &DiagnosisOptions,
        report: &mut Reporter<'_, '_>,
    ) -> Result<(), EstimationError> {
        for round in 0..MOST_ROUNDS {
            let changes = round + 1 < MOST_ROUNDS;
            let changed = self.exchange_each(base, options, report, changes)?;
            if !changed {
                break;
            }
        }
        Ok(())
    }

    fn exchange_each(
        &mut self,
        base: &Problem<'a>,
        options: &DiagnosisOptions,
        report: &mut Reporter<'_, '_>,
        changes: bool,
    ) -> Result<bool, EstimationError> {
        self.rounds.clear();
        let mut changed = false;
        while self.rounds.len() < self.fit.causes.len() {
            if !report.stage(Stage::Refits, self.fit.causes.len()) {
                break;
            }
            let index = self.rounds.len();
            let mut others = self.fit.causes.clone();
            let present = others.remove(index);
            let without = Fit::new(base, &others)?;
            let mut round = Round::new(base, &without)?;
            round.include(base, &without, &present)?;
            let best = round.best(&without, options.alpha).filter(|_| changes);
            let Some(best) = best else {
                if changes {
                    self.fit = without;
                    changed = true;
                    continue;
                }
                self.rounds.push(round);
                continue;
            };
            let own = round
                .of(&present)
                .map_or(f64::NEG_INFINITY, Contender::score);
            if !is_alike(best.cause(), &present) && best.score() > own + BETTER {
                others.insert(index, best.cause().clone());
                self.fit = Fit::new(base, &others)?;
                changed = true;
            }
            self.rounds.push(round);
        }
        Ok(changed)
    }
}

//! The candidates at a fit, with the columns that they need.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{DMatrix, DVector};

use super::budget::{COLUMNS_AT_ONCE, FREQUENCIES_PER_WAVE, MAX_PERIODS};
use super::candidates::{
    Candidate, CandidateColumn, PoseWeights, prior_sd, probe_offset, scales, size_parameter,
};
use super::conditions::Conditions;
use super::fit::Fit;
use super::priors::{
    EXPECTED_CAUSES, EXPECTED_HYPOTHESES, FAMILY_CORRELATION, STEP_OF_EACH, TARGET_WEIGHTS,
    TargetShares,
};
use super::relations::{is_same_effect_and_targets, is_same_place, place_of};
use super::report::Cause;
use crate::effect::{
    BoundEffect, CATALOGUE, Effect, IN_MOTION, OF_DISTANCES, OF_EXTERNAL_POSES, Scope, Search,
    amplitude_of,
};
use crate::estimation::{Linearisation, ParameterId};
use crate::statistics::logit;

/// On a platform that cannot turn, a wrong attachment point is a wrong place of the pulley, the other way: the drawing's.
const ATTACHMENT: &str = "platform_anchor";

/// All candidates at a fit, with the generators of their columns.
pub(super) struct Catalogue {
    pub candidates: Vec<Candidate>,
    /// Generators by row of the linearisation (rows x generators), with poses and tensions eliminated.
    pub generators: DMatrix<f64>,
    /// Laser reading at each fitted pose (m); NaN where there is none.
    pub distances: Vec<f64>,
}

impl Catalogue {
    /// Builds all candidates at a fit whose linearisation is `linear`, or without `include_all` only those that are
    /// causes of the fit.
    pub fn new(fit: &Fit<'_>, linear: &Linearisation, include_all: bool) -> Self {
        let data = &fit.problem.dataset.measurements;
        let labels: Vec<i64> = linear.poses.iter().map(|p| data.labels[p.row]).collect();
        let distances: Vec<f64> = linear.poses.iter().map(|p| data.laser_at(p.row)).collect();
        let mut builder = Builder {
            fit,
            linear,
            labels,
            distances,
            include_all,
            bounds: Vec::new(),
            generators: Vec::new(),
            candidates: Vec::new(),
        };
        let shown_by_motion = if data.rates.is_some() { IN_MOTION } else { &[] };
        let is_tracked = fit.problem.dataset.robot.tracker.is_some();
        let shown_by_poses = if is_tracked { OF_EXTERNAL_POSES } else { &[] };
        let has_distances = fit.problem.has_distances();
        let shown_by_distances = if has_distances { OF_DISTANCES } else { &[] };
        let effects = || {
            CATALOGUE
                .iter()
                .chain(shown_by_poses)
                .chain(shown_by_distances)
                .chain(shown_by_motion)
        };
        let turns = fit.problem.dataset.robot.platform.turns();
        let tested = || {
            let tested = effects().filter(|e| e.search() != Search::Exchange);
            tested.filter(|e| turns || e.id() != ATTACHMENT)
        };
        let each = EXPECTED_CAUSES / tested().count() as f64;
        let hypotheses = hypotheses(fit, each);
        let of_catalogue = tested().map(|effect| (*effect, each));
        for (effect, expected) in of_catalogue.chain(hypotheses.iter().copied()) {
            builder.add(effect, expected);
        }
        builder.add_shared(|effect| {
            let hypothesis = hypotheses
                .iter()
                .find(|(one, _)| std::ptr::eq(*one, effect));
            hypothesis.map_or(each, |(_, expected)| *expected)
        });
        builder.build()
    }
}

impl Catalogue {
    /// A column as conditions, given the generators as conditions.
    pub fn column(
        &self,
        column: CandidateColumn,
        generators: &DMatrix<f64>,
        conditions: &Conditions,
    ) -> DVector<f64> {
        let mut values = generators.column(column.generator).into_owned();
        if column.pose_weights == PoseWeights::Everywhere {
            return values;
        }
        for (pose, block) in conditions.blocks.iter().enumerate() {
            let weight = if pose < conditions.poses {
                self.weight(column.pose_weights, pose)
            } else {
                0.0
            };
            let range = block.conditions.clone();
            values.rows_mut(range.start, range.len()).scale_mut(weight);
        }
        values
    }

    /// Weight of a generator at a pose.
    pub fn weight(&self, pose_weights: PoseWeights, pose: usize) -> f64 {
        match pose_weights {
            PoseWeights::Everywhere => 1.0,
            PoseWeights::At(at) => f64::from(u8::from(pose == at)),
            PoseWeights::From(from) => f64::from(u8::from(pose >= from)),
            PoseWeights::Wave { period, cosine } => wave(period, cosine, self.distances[pose]),
        }
    }
}

/// The hypotheses of the user that the readings could show, each with the prior expectation of the number of its causes:
/// what its text asks for, else that of an effect of the catalogue, but at most an equal part of [`EXPECTED_HYPOTHESES`], so
/// that none takes the part of another. The catalogue keeps its own, however many there are.
fn hypotheses(fit: &Fit<'_>, of_catalogue: f64) -> Vec<(&'static Effect, f64)> {
    let dataset = fit.problem.dataset;
    let is_moving = dataset.measurements.rates.is_some();
    let is_shown = |effect: &&Effect| is_moving || !effect.is_in_motion();
    let shown: Vec<&'static Effect> = dataset
        .robot
        .hypothesis_effects()
        .filter(is_shown)
        .collect();
    let part = EXPECTED_HYPOTHESES / shown.len() as f64;
    let granted = |effect: &Effect| {
        let asked = effect.text_physics.and_then(|physics| physics.prior());
        asked.unwrap_or(of_catalogue).min(part)
    };
    shown
        .into_iter()
        .map(|effect| (effect, granted(effect)))
        .collect()
}

struct Builder<'b> {
    fit: &'b Fit<'b>,
    linear: &'b Linearisation,
    labels: Vec<i64>,
    distances: Vec<f64>,
    /// Whether to include candidates that are not causes of the fit.
    include_all: bool,
    /// Distinct effects to be differentiated.
    bounds: Vec<BoundEffect>,
    /// For each generator the index in `bounds` and the parameter.
    generators: Vec<(usize, usize)>,
    candidates: Vec<Candidate>,
}

impl Builder<'_> {
    fn generator(&mut self, bound: &BoundEffect, parameter: usize) -> usize {
        let bits = |b: &BoundEffect| b.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let same = |other: &BoundEffect| other.has_target_of(bound) && bits(other) == bits(bound);
        let existing = self.bounds.iter().position(same);
        let index = existing.unwrap_or_else(|| {
            self.bounds.push(bound.clone());
            self.bounds.len() - 1
        });
        let existing = self
            .generators
            .iter()
            .position(|g| *g == (index, parameter));
        existing.unwrap_or_else(|| {
            self.generators.push((index, parameter));
            self.generators.len() - 1
        })
    }

    /// Adds all candidates of an effect; `expected` is the prior expectation of their number.
    fn add(&mut self, effect: &'static Effect, expected: f64) {
        let cables = self.fit.problem.dataset.robot.cable_count();
        let indices: Vec<usize> = (0..cables).collect();
        let bound = |cables: Vec<usize>, targeted: bool| BoundEffect {
            effect,
            cables,
            targeted,
            values: effect.parameters().iter().map(|p| p.start).collect(),
        };
        let whole = || vec![bound(indices.clone(), false)];
        let each = || indices.iter().map(|c| bound(vec![*c], true));
        let mut targets: Vec<(Vec<BoundEffect>, f64)> = Vec::new();
        match effect.scope() {
            Scope::Robot => targets.push((whole(), 1.0)),
            Scope::Pair => {
                let pairs = indices
                    .iter()
                    .flat_map(|a| indices[a + 1..].iter().map(|b| vec![*a, *b]));
                let pairs: Vec<Vec<usize>> = pairs.collect();
                let share = 1.0 / pairs.len() as f64;
                targets.extend(pairs.into_iter().map(|p| (vec![bound(p, true)], share)));
            }
            Scope::Cable | Scope::CableOrAll => {
                let shares = target_shares(effect, cables);
                targets.extend(each().map(|b| (vec![b], shares.one / cables as f64)));
                if shares.all_alike > 0.0 {
                    targets.push((whole(), shares.all_alike));
                }
                if shares.each_own > 0.0 {
                    targets.push((each().collect(), shares.each_own));
                }
            }
        }
        for (instances, share) in targets {
            self.add_cause(&Cause { instances }, expected * share);
        }
    }

    /// Adds causes of the fit with a common value on several cables, which are not candidates by default. `expected` gives the
    /// prior expectation of the number of causes of an effect.
    fn add_shared(&mut self, expected: impl Fn(&Effect) -> f64) {
        let cables = self.fit.problem.dataset.robot.cable_count();
        for cause in &self.fit.causes {
            let is_known = self.candidates.iter().any(|c| c.represents(cause));
            if !is_known && cause.effect().search() != Search::Exchange {
                let mut start = cause.clone();
                for bound in &mut start.instances {
                    bound.values = bound.effect.parameters().iter().map(|p| p.start).collect();
                }
                let share = target_shares(cause.effect(), cables).several_alike;
                let choices = choices_of_several(cause.cables().len(), cables);
                self.add_cause(&start, expected(cause.effect()) * share / choices);
            }
        }
    }

    fn add_cause(&mut self, cause: &Cause, expected: f64) {
        let effect = cause.effect();
        let present = self
            .fit
            .causes
            .iter()
            .any(|c| is_same_effect_and_targets(c, cause));
        if !self.include_all && !present {
            return;
        }
        match effect.search() {
            Search::Direct | Search::Exchange => {
                let columns = self.columns(cause, |_| PoseWeights::Everywhere);
                self.push(cause, columns, (f64::NAN, 1), expected);
            }
            Search::Wave {
                phase,
                period: None,
            } => {
                let columns = self.wave(cause, phase);
                self.push(cause, columns, (f64::NAN, 1), expected);
            }
            Search::Wave {
                phase,
                period: Some(period),
            } => self.add_periods(cause, (phase, period), expected),
            Search::FromPose(pose) => self.add_event(cause, pose, PoseWeights::From, expected),
            Search::AtPose(pose) => self.add_event(cause, pose, PoseWeights::At, expected),
            Search::AtDistance(index) => self.add_distances(cause, index, expected),
        }
    }

    fn columns(
        &mut self,
        cause: &Cause,
        pose_weights: impl Fn(usize) -> PoseWeights,
    ) -> Vec<CandidateColumn> {
        let mut columns = Vec::new();
        for bound in &cause.instances {
            let mut probe = bound.clone();
            for k in probe.effect.estimable() {
                let parameter = &probe.effect.parameters()[k];
                probe.values[k] = parameter.neutral + probe_offset(parameter);
            }
            for k in probe.effect.estimable() {
                let generator = self.generator(&probe, k);
                columns.push(CandidateColumn {
                    generator,
                    pose_weights: pose_weights(columns.len()),
                });
            }
        }
        columns
    }

    /// Sine and cosine columns of a wave with a known period.
    fn wave(&mut self, cause: &Cause, phase: usize) -> Vec<CandidateColumn> {
        let mut columns = Vec::new();
        for bound in &cause.instances {
            for angle in [0.0, FRAC_PI_2] {
                let mut probe = bound.clone();
                probe.values.fill(0.0);
                probe.values[phase] = angle;
                columns.push(CandidateColumn {
                    generator: self.generator(&probe, amplitude_of(phase, None)),
                    pose_weights: PoseWeights::Everywhere,
                });
            }
        }
        columns
    }

    /// Adds waves over the laser distance, from the shortest to the longest period that the readings can resolve.
    fn add_periods(&mut self, cause: &Cause, (phase, period): (usize, usize), expected: f64) {
        // The derivative of a wave of infinite period at its crest is a constant, to which the weights of each pose
        // apply.
        let mut probe = cause.instances[0].clone();
        probe.values.fill(0.0);
        probe.values[period] = f64::INFINITY;
        probe.values[phase] = FRAC_PI_2;
        let generator = self.generator(&probe, amplitude_of(phase, Some(period)));
        let typical = cause.effect().parameters()[period].typical;
        let mut periods = periods(typical, &self.distances);
        let present = self.fit.causes.iter().flat_map(|c| &c.instances);
        for bound in present.filter(|b| b.effect.id() == cause.effect().id()) {
            let fitted = bound.values[period];
            let nearest = (0..periods.len()).min_by(|a, b| {
                let off = |k: usize| (periods[k] - fitted).abs();
                off(*a).total_cmp(&off(*b))
            });
            if let Some(k) = nearest {
                periods[k] = fitted;
            }
        }
        let count = periods.len();
        for period in periods {
            let column = |cosine| CandidateColumn {
                generator,
                pose_weights: PoseWeights::Wave { period, cosine },
            };
            let columns = vec![column(false), column(true)];
            self.push(cause, columns, (period, count), expected);
        }
    }

    fn add_event(
        &mut self,
        cause: &Cause,
        pose: usize,
        pose_weights: impl Fn(usize) -> PoseWeights,
        expected: f64,
    ) {
        let mut event = cause.clone();
        for bound in &mut event.instances {
            // NaN makes the event act at every pose; the column weights then select the poses.
            bound.values[pose] = f64::NAN;
        }
        let mut generators = Vec::new();
        for bound in &event.instances {
            for k in bound.effect.estimable() {
                generators.push(self.generator(bound, k));
            }
        }
        let mut places: Vec<usize> = (0..self.labels.len()).collect();
        if matches!(pose_weights(0), PoseWeights::From(_)) && !places.is_empty() {
            // From the first pose on it would be a constant offset.
            places.remove(0);
        }
        let count = places.len();
        for place in places {
            let columns = generators.iter().map(|generator| CandidateColumn {
                generator: *generator,
                pose_weights: pose_weights(place),
            });
            let label = self.labels[place] as f64;
            self.push(cause, columns.collect(), (label, count), expected);
        }
    }

    /// Adds a candidate for each distance. Poses that two distances share couple them, so that each has a column of its own.
    fn add_distances(&mut self, cause: &Cause, index: usize, expected: f64) {
        let distances = &self.fit.problem.dataset.measurements.distances;
        for distance in distances {
            let row = distance.number as f64;
            let mut of_one = cause.clone();
            for bound in &mut of_one.instances {
                bound.values[index] = row;
            }
            let columns = self.columns(&of_one, |_| PoseWeights::Everywhere);
            self.push(cause, columns, (row, distances.len()), expected);
        }
    }

    /// Adds the candidate at one of the `places` of a cause, of which `expected` are expected at all of them together.
    fn push(
        &mut self,
        cause: &Cause,
        columns: Vec<CandidateColumn>,
        (place, places): (f64, usize),
        expected: f64,
    ) {
        let effect = cause.effect();
        let Some(size) = size_parameter(effect) else {
            return;
        };
        let is_cause = |c: &Cause| {
            let values = c.instances[0].values.iter();
            is_same_effect_and_targets(c, cause)
                && (place.is_nan() || values.into_iter().any(|v| *v == place))
        };
        if !self.include_all && !self.fit.causes.iter().any(is_cause)
            || self.is_in_model(cause, place)
        {
            return;
        }
        let present = |bound: &BoundEffect, k: usize| {
            let instances = self.fit.causes.iter().flat_map(|c| &c.instances);
            let mut same =
                instances.filter(|b| b.effect.id() == effect.id() && b.cables == bound.cables);
            same.next()
                .map_or(0.0, |b| b.values[k] - effect.parameters()[k].neutral)
        };
        let robot = &self.fit.problem.dataset.robot;
        let wave = matches!(effect.search(), Search::Wave { .. });
        let mut sds: Vec<f64> = Vec::new();
        for bound in &cause.instances {
            if wave {
                sds.extend([prior_sd(size, robot, 0.0); 2]);
            } else {
                let parameters = effect.parameters();
                sds.extend(
                    effect
                        .estimable()
                        .map(|k| prior_sd(&parameters[k], robot, present(bound, k))),
                );
            }
        }
        let count = cause.instances.len();
        let per = sds.len() / count;
        let alike = if count > 1 { FAMILY_CORRELATION } else { 0.0 };
        let covariance = DMatrix::from_fn(sds.len(), sds.len(), |i, k| {
            let correlation = match (i == k, i % per == k % per) {
                (true, _) => 1.0,
                (false, true) => alike,
                (false, false) => 0.0,
            };
            correlation * sds[i] * sds[k]
        });
        let Some(prior) = covariance.cholesky() else {
            return;
        };
        let share = expected / places as f64;
        let targeted = cause
            .instances
            .iter()
            .filter(|b| effect.scope() != Scope::Robot || b.targeted);
        let cables = targeted
            .flat_map(|b| &b.cables)
            .fold(0, |mask, c| mask | 1_u64 << c);
        self.candidates.push(Candidate {
            cause: cause.clone(),
            cables,
            place,
            columns,
            prior: prior.unpack(),
            scales: scales(size),
            is_positive: size.bounds[0] == 0.0 && sds.len() == 1,
            log_odds: logit(share),
            log_places: (places as f64).ln(),
        });
    }

    /// Whether the model already has the effect on all cables of a cause, at the same pose or with the same period.
    fn is_in_model(&self, cause: &Cause, place: f64) -> bool {
        let model = &self.fit.problem.free_effects[..self.fit.model_effects()];
        let is_at_place =
            |bound: &BoundEffect| is_same_place(bound.effect, place_of(bound), place, 0.0);
        let alike = |bound: &&BoundEffect| bound.effect.id() == cause.effect().id();
        let present: Vec<_> = model
            .iter()
            .filter(alike)
            .filter(|b| is_at_place(b))
            .collect();
        let has = |cables: &[usize]| present.iter().any(|bound| bound.cables == cables);
        let is_known = |bound: &BoundEffect| {
            has(&bound.cables) || bound.cables.iter().all(|cable| has(&[*cable]))
        };
        !present.is_empty() && cause.instances.iter().all(is_known)
    }

    fn build(self) -> Catalogue {
        let rows = self.linear.rows.len();
        let mut generators = DMatrix::zeros(rows, self.generators.len());
        let mut first = 0;
        while first < self.bounds.len() {
            let mut until = first;
            let mut columns = 0;
            while until < self.bounds.len() && columns < COLUMNS_AT_ONCE {
                columns += self.bounds[until].values.len();
                until += 1;
            }
            let linear = linearise_with(self.fit, &self.bounds[first..until]);
            let present = self.fit.problem.free_effects.len();
            for (column, parameter) in linear.parameters.iter().enumerate() {
                let ParameterId::Effect { effect, parameter } = parameter.id else {
                    continue;
                };
                let is_same = |g: &(usize, usize)| *g == (first + effect - present, parameter);
                if effect >= present
                    && let Some(k) = self.generators.iter().position(is_same)
                {
                    let from = linear.design.view((0, column), (rows, 1));
                    generators.column_mut(k).copy_from(&from);
                }
            }
            first = until;
        }
        // Candidates that affect no reading cannot be tested.
        let is_read: Vec<bool> = generators
            .column_iter()
            .map(|column| column.norm_squared() > 0.0)
            .collect();
        let mut candidates = self.candidates;
        candidates.retain(|candidate| candidate.columns.iter().any(|c| is_read[c.generator]));
        Catalogue {
            candidates,
            generators,
            distances: self.distances,
        }
    }
}

/// Linearises the problem of a fit at its solution with further effects added.
fn linearise_with(fit: &Fit<'_>, bounds: &[BoundEffect]) -> Linearisation {
    let mut problem = fit.problem.clone();
    problem.free_effects.extend(bounds.iter().cloned());
    let mut solution = fit.solution.clone();
    solution.globals.effects.extend(bounds.iter().cloned());
    solution.parameters = problem.parameters();
    Linearisation::new(&problem, &solution)
}

/// Periods at which a wave is tried: from the shortest typical one to the longest, but at most the range of the values.
/// Frequencies are spaced closely enough that no wave falls between two of them.
fn periods(typical: [f64; 2], values: &[f64]) -> Vec<f64> {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let range = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
    if range.is_nan() || range <= 0.0 {
        return Vec::new();
    }
    let (shortest, longest) = (
        typical[0].min(range),
        typical[1].min(range).max(typical[0].min(range)),
    );
    let (low, high) = (longest.recip(), shortest.recip());
    let count = ((high - low) * FREQUENCIES_PER_WAVE * range)
        .ceil()
        .clamp(1.0, MAX_PERIODS);
    (0..=count as usize)
        .map(|k| (low + (high - low) * k as f64 / count).recip())
        .collect()
}

/// Shares of the prior probability of an effect by target. They sum to 1 over the targets that it can have on so many
/// cables.
fn target_shares(effect: &Effect, cables: usize) -> TargetShares {
    let is_direct = effect.search() == Search::Direct;
    let if_possible = |is_possible: bool, weight: f64| if is_possible { weight } else { 0.0 };
    let TargetShares {
        one,
        all_alike,
        each_own,
        several_own,
        several_alike,
    } = TARGET_WEIGHTS;
    let all_alike = if_possible(effect.scope() == Scope::CableOrAll, all_alike);
    // What happens to all winches at once, such as zeroing them again, leaves each with a step of its own.
    let is_step = matches!(effect.search(), Search::FromPose(_)) && effect.estimable().count() == 1;
    let each_own = match is_step {
        true => STEP_OF_EACH,
        false => if_possible(is_direct, each_own),
    };
    let each_own = if_possible(cables > 1, each_own);
    let several_own = if_possible(cables > 2, several_own);
    let several_alike = if_possible(is_direct && cables > 2, several_alike);
    let total = one + all_alike + each_own + several_own + several_alike;
    TargetShares {
        one: one / total,
        all_alike: all_alike / total,
        each_own: each_own / total,
        several_own: several_own / total,
        several_alike: several_alike / total,
    }
}

/// Log ratio of the prior odds of an effect on `count` single cables and of the product of their separate odds, for an
/// effect on each like `candidate`: `log(1 + q / p^count)`, where `p` is the probability of each cable and `q` that of the
/// effect on just these cables. What is wrong with one winch is often wrong with others, so the causes are not
/// independent.
pub(super) fn log_joint_odds_ratio(candidate: &Candidate, count: usize, cables: usize) -> f64 {
    if count < 2 || count >= cables {
        return 0.0;
    }
    let shares = target_shares(candidate.effect(), cables);
    let of_each = shares.one / cables as f64;
    let of_all = shares.several_own / choices_of_several(count, cables);
    // The places of an event on one cable say nothing about those on another.
    let log_odds = candidate.log_odds + candidate.log_places;
    ((of_all / of_each).ln() - (count - 1) as f64 * log_odds)
        .exp()
        .ln_1p()
}

/// Number of ways in which `count` of the cables can be affected, times the numbers of several cables, from 2 on, that
/// are not all.
fn choices_of_several(count: usize, cables: usize) -> f64 {
    (cables - 2).max(1) as f64 * binomial(cables, count)
}

/// Binomial coefficient: number of ways to choose `k` of `n`.
fn binomial(n: usize, k: usize) -> f64 {
    (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product()
}

/// Weight of a wave at a value of its variable.
fn wave(period: f64, cosine: bool, value: f64) -> f64 {
    if value.is_nan() {
        return 0.0;
    }
    let angle = TAU * value / period;
    if cosine { angle.cos() } else { angle.sin() }
}

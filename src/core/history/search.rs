//! The set of changes that explains the sessions best, and how probable each change is.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::state::State;
use super::timeline::{Change, Course, Timeline};
use super::{CERTAIN, Drift, History, Jump, LISTED, SmoothedState};
use crate::evidence::Evidence;
use crate::statistics::{log_sum, logit};

/// Jumps of parts of a robot that are expected per year.
pub(super) const JUMPS_PER_YEAR: f64 = 1.0;
/// Jumps that are expected between two sessions however close they are, and after an event.
const JUMPS_AT_ONCE: [f64; 2] = [0.02, 0.5];
/// Prior probability that a part drifts.
const DRIFTING: f64 = 0.1;
/// Drift that is typical, in typical changes per day.
const DRIFT_PER_DAY: f64 = 0.0025;
/// Prior standard deviations of a size, over the typical one.
pub(super) const SCALES: [f64; 6] = [0.06, 0.125, 0.25, 0.5, 1.0, 2.0];
/// Gain of the log odds over the prior that a change needs to be listed: a change for which the sessions give no evidence is
/// not one.
const LISTED_GAIN: f64 = 1.0;
/// Smallest probability of a jump in the adjacent interval at which the range of the jump is widened by that interval.
const WIDENED: f64 = 0.01;
/// Gain of the log evidence below which the search ends.
const SMALL_GAIN: f64 = 1e-6;
/// Most steps of the search.
const MOST_STEPS: usize = 200;
pub(super) const DAYS_PER_YEAR: f64 = 365.25;

/// Prior probability that one of several parts jumps between two sessions with some days between them.
pub(super) fn jump_probability(days: f64, is_event_between: bool, parts: usize) -> f64 {
    let at_once = JUMPS_AT_ONCE[usize::from(is_event_between)];
    let expected = at_once.max(JUMPS_PER_YEAR * days / DAYS_PER_YEAR);
    (expected / parts as f64).min(0.5)
}

/// Log evidence for a change with a score and its information, summed over the scales of its prior, and the standard deviation
/// of the best scale.
pub(super) fn evidence(
    score: &DVector<f64>,
    information: &DMatrix<f64>,
    typical: f64,
) -> (f64, f64) {
    let evidence = SCALES.map(|scale| {
        let sd = scale * typical;
        let own = Evidence::new(score * sd, information * (sd * sd));
        (own.map_or(f64::NEG_INFINITY, |own| own.log()), sd)
    });
    let total = log_sum(evidence.iter().map(|(value, _)| *value));
    let best = evidence.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let count = (SCALES.len() as f64).ln();
    (total - count, best.map_or(0.0, |(_, sd)| sd))
}

/// A change in a set, with its numbers and its scale.
#[derive(Debug, Clone)]
struct Member {
    change: Change,
    numbers: Vec<usize>,
    /// Prior standard deviation.
    sd: f64,
}

/// A set of changes with its normal equations, in units of the priors.
struct Set {
    members: Vec<Member>,
    factor: Cholesky<f64, Dyn>,
    solution: DVector<f64>,
}

/// Search over sets of changes.
pub(super) struct Search<'a> {
    state: &'a State,
    timeline: &'a Timeline,
    candidates: Vec<(Change, f64)>,
    set: Set,
}

impl<'a> Search<'a> {
    /// `None` if the sessions do not determine the state.
    pub fn new(state: &'a State, timeline: &'a Timeline, events: &[bool]) -> Option<Self> {
        let parts = state.parts.len();
        let mut candidates = Vec::new();
        for part in (0..parts).filter(|part| !state.numbers_of(*part).is_empty()) {
            let mut push = |course: Course, probability: f64| {
                let log_odds = logit(probability);
                candidates.push((Change { part, course }, log_odds));
            };
            for after in 0..timeline.times.len() - 1 {
                let days = timeline.times[after + 1] - timeline.times[after];
                let probability = jump_probability(days, events[after + 1], parts);
                push(Course::JumpAfter(after), probability);
            }
            // Two sessions cannot tell a drift from a jump.
            let sessions = timeline.times.len();
            if sessions > 2 && timeline.times[sessions - 1] > timeline.times[0] {
                push(Course::Drift, DRIFTING);
            }
        }
        let set = Set::new(timeline, Vec::new())?;
        Some(Self {
            state,
            timeline,
            candidates,
            set,
        })
    }

    /// Adds, replaces and drops changes until nothing raises the posterior.
    pub fn run(&mut self) {
        for _ in 0..MOST_STEPS {
            let added = self.best_addition(&self.set, None);
            let mut best = added.map(|(gain, member)| (gain, None, Some(member)));
            for place in 0..self.set.members.len() {
                let Some(fewer) = self.set.without(self.timeline, place) else {
                    continue;
                };
                let (lost, _) = self.gain(&fewer, &self.set.members[place].change);
                let replaced = self.best_addition(&fewer, Some(self.set.members[place].change));
                let dropped = Some((-lost, Some(place), None));
                let replaced = replaced.map(|(gain, m)| (gain - lost, Some(place), Some(m)));
                for found in [dropped, replaced].into_iter().flatten() {
                    if best.as_ref().is_none_or(|b| found.0 > b.0) {
                        best = Some(found);
                    }
                }
            }
            let Some((gain, dropped, added)) = best else {
                return;
            };
            let mut members = self.set.members.clone();
            if let Some(place) = dropped {
                members.remove(place);
            }
            members.extend(added);
            match Set::new(self.timeline, members).filter(|_| gain > SMALL_GAIN) {
                Some(set) => self.set = set,
                None => return,
            }
        }
    }

    fn best_addition(&self, set: &Set, except: Option<Change>) -> Option<(f64, Member)> {
        let open = self.candidates.iter().map(|(change, _)| change);
        let open = open.filter(|change| !set.has(change) && Some(**change) != except);
        let gains = open.map(|change| (self.gain(set, change), *change));
        let best = gains.max_by(|a, b| a.0.0.total_cmp(&b.0.0));
        let ((gain, sd), change) = best?;
        Some((gain, self.member(change, sd)))
    }

    fn member(&self, change: Change, sd: f64) -> Member {
        Member {
            change,
            numbers: self.state.numbers_of(change.part),
            sd,
        }
    }

    /// Gain of the log posterior by a further change, summed over its scales, and the standard deviation of the best scale.
    fn gain(&self, set: &Set, change: &Change) -> (f64, f64) {
        let numbers = self.state.numbers_of(change.part);
        let (score, information) = set.conditional(self.timeline, change.course, &numbers);
        let typical = self.state.typical[change.part]
            * match change.course {
                Course::JumpAfter(_) => 1.0,
                Course::Drift => DRIFT_PER_DAY,
            };
        let log_odds = self.candidates.iter().find(|(known, _)| known == change);
        let log_odds = log_odds.map_or(f64::NEG_INFINITY, |(_, log_odds)| *log_odds);
        let (evidence, sd) = evidence(&score, &information, typical);
        (log_odds + evidence, sd)
    }

    /// Probability of each candidate, by the sets near the best one, and of no change at all.
    fn probabilities(&self) -> (Vec<f64>, f64) {
        let gains = |set: &Set| -> Vec<f64> {
            let of = |(change, _): &(Change, f64)| match set.has(change) {
                true => f64::NEG_INFINITY,
                false => self.gain(set, change).0,
            };
            self.candidates.iter().map(of).collect()
        };
        let index = |change: &Change| self.candidates.iter().position(|(c, _)| c == change);
        let members: Vec<usize> = self
            .set
            .members
            .iter()
            .filter_map(|m| index(&m.change))
            .collect();
        // Log weights of the sets, each with its changes relative to the best set: added and removed ones.
        let mut sets: Vec<(f64, Option<usize>, Option<usize>)> = vec![(0.0, None, None)];
        for (more, gain) in gains(&self.set).into_iter().enumerate() {
            sets.push((gain, Some(more), None));
        }
        for (place, member) in members.iter().enumerate() {
            let Some(fewer) = self.set.without(self.timeline, place) else {
                continue;
            };
            let all = gains(&fewer);
            let lost = all[*member];
            sets.push((-lost, None, Some(*member)));
            for (other, gain) in all.into_iter().enumerate().filter(|(k, _)| k != member) {
                sets.push((gain - lost, Some(other), Some(*member)));
            }
        }
        let total = log_sum(sets.iter().map(|(weight, ..)| *weight));
        let mut probability = vec![0.0; self.candidates.len()];
        let mut unchanged = 0.0;
        for (weight, more, less) in sets {
            let share = (weight - total).exp();
            if more.is_none() && members.len() == usize::from(less.is_some()) {
                unchanged += share;
            }
            for present in members.iter().filter(|k| Some(**k) != less) {
                probability[*present] += share;
            }
            if let Some(more) = more {
                probability[more] += share;
            }
        }
        (probability, unchanged)
    }

    /// The history of the robot by the best set.
    pub fn history(&self) -> History {
        let covariance = self.set.covariance();
        let estimate = self.set.estimate();
        let state = self.state;
        let sessions = self.timeline.times.len();
        let mut states = Vec::with_capacity(state.parts.len());
        for part in 0..state.parts.len() {
            let numbers = state.numbers_of(part);
            let reference =
                DVector::from_iterator(numbers.len(), numbers.iter().map(|k| state.reference(*k)));
            let at = |session: usize| {
                let map = self.set.map_of(self.timeline, part, &numbers, session);
                SmoothedState {
                    value: &reference + &map * &estimate,
                    covariance: &map * &covariance * map.transpose(),
                }
            };
            states.push((0..sessions).map(at).collect());
        }
        let information = (0..state.parts.len()).map(|part| {
            let after = 0..sessions - 1;
            after
                .map(|after| self.jump_information(part, after))
                .collect()
        });
        let first = self.timeline.times[0];
        let days = self.timeline.times.iter().map(|time| time - first);
        let (probabilities, unchanged) = self.probabilities();
        let (jumps, drifts) = self.changes(probabilities);
        History {
            days: days.collect(),
            parts: state.parts.clone(),
            axes: (0..state.parts.len())
                .map(|part| state.axes_of(part))
                .collect(),
            states,
            information: information.collect(),
            jumps,
            drifts,
            unchanged,
        }
    }

    /// Information on a jump, given the state and the other changes of the best set.
    fn jump_information(&self, part: usize, after: usize) -> DMatrix<f64> {
        let course = Course::JumpAfter(after);
        let own = Change { part, course };
        let numbers = self.state.numbers_of(part);
        let mut members = self.set.members.iter();
        let place = members.position(|member| member.change == own);
        let fewer = place.and_then(|place| self.set.without(self.timeline, place));
        let set = fewer.as_ref().unwrap_or(&self.set);
        set.conditional(self.timeline, course, &numbers).1
    }

    /// Jumps and drifts that are listed. A jump of the best set whose interval is uncertain is stated for the range of sessions
    /// in which it happened with near certainty.
    fn changes(&self, mut left: Vec<f64>) -> (Vec<Jump>, Vec<Drift>) {
        let mut jumps = Vec::new();
        let mut drifts = Vec::new();
        let mut order: Vec<usize> = (0..self.candidates.len()).collect();
        let is_member = |k: &usize| self.set.has(&self.candidates[*k].0);
        order.sort_by(|a, b| {
            let by_set = is_member(b).cmp(&is_member(a));
            by_set.then(left[*b].total_cmp(&left[*a]))
        });
        for own in order {
            let change = self.candidates[own].0;
            let log_odds = (left[own] / (1.0 - left[own]).max(f64::MIN_POSITIVE)).ln();
            let is_evident =
                left[own] >= LISTED && log_odds >= self.candidates[own].1 + LISTED_GAIN;
            if !is_evident && change.course != Course::Drift {
                continue;
            }
            let (size, covariance) = self.size_of(change);
            match change.course {
                Course::Drift => drifts.push(Drift {
                    part: change.part,
                    probability: left[own].min(1.0),
                    rate: size,
                    covariance,
                    is_evident,
                }),
                Course::JumpAfter(after) => {
                    let (between, probability) = self.range_of(change.part, after, &mut left);
                    jumps.push(Jump {
                        part: change.part,
                        between,
                        probability,
                        size,
                        covariance,
                    });
                }
            }
            left[own] = 0.0;
        }
        jumps.sort_by_key(|jump| (jump.between, jump.part));
        (jumps, drifts)
    }

    /// The shortest range of sessions around a jump within which the jump is nearly certain, with its probability. The
    /// probability that it takes from neighbouring intervals does not count as another jump.
    fn range_of(&self, part: usize, after: usize, left: &mut [f64]) -> ([usize; 2], f64) {
        let change = |after: usize| Change {
            part,
            course: Course::JumpAfter(after),
        };
        let place = |after: usize| {
            let mut candidates = self.candidates.iter();
            candidates.position(|(known, _)| *known == change(after))
        };
        let [mut low, mut high] = [after; 2];
        let mut sum = place(after).map_or(0.0, |k| left[k]);
        let last = self.timeline.times.len() - 2;
        while sum < CERTAIN {
            let of = |after: Option<usize>| {
                let after = after.filter(|after| !self.set.has(&change(*after)))?;
                Some((left[place(after)?], after))
            };
            let before = of(low.checked_sub(1));
            let behind = of(Some(high + 1).filter(|next| *next <= last));
            let widest = match (before, behind) {
                (Some(a), Some(b)) => Some(if a.0 >= b.0 { a } else { b }),
                (a, b) => a.or(b),
            };
            let Some((probability, next)) = widest.filter(|(p, _)| *p >= WIDENED) else {
                break;
            };
            sum += probability;
            if let Some(k) = place(next) {
                left[k] = 0.0;
            }
            low = low.min(next);
            high = high.max(next);
        }
        ([low, high + 1], sum.min(1.0))
    }

    /// Size of a change: for a member of the best set as estimated there, otherwise as estimated with the change added.
    fn size_of(&self, change: Change) -> (DVector<f64>, DMatrix<f64>) {
        let mut with = None;
        if !self.set.has(&change) {
            let (_, sd) = self.gain(&self.set, &change);
            let mut members = self.set.members.clone();
            members.push(self.member(change, sd));
            with = Set::new(self.timeline, members);
        }
        let set = with.as_ref().unwrap_or(&self.set);
        let range = set.range_of(&change, self.timeline);
        let covariance = set.covariance();
        let size = set.estimate().rows_range(range.clone()).into_owned();
        let own = covariance.view((range.start, range.start), (range.len(), range.len()));
        (size, own.into_owned())
    }
}

impl Set {
    /// `None` if the sessions do not determine the state.
    fn new(timeline: &Timeline, members: Vec<Member>) -> Option<Self> {
        let base = timeline.whole.moment.len();
        let count = base + members.iter().map(|m| m.numbers.len()).sum::<usize>();
        let mut normal = DMatrix::identity(count, count);
        let mut right = DVector::zeros(count);
        normal
            .view_mut((0, 0), (base, base))
            .copy_from(&timeline.whole.information);
        right.rows_mut(0, base).copy_from(&timeline.whole.moment);
        let mut at = base;
        for (place, member) in members.iter().enumerate() {
            let course = member.change.course;
            let own = member.numbers.len();
            let with_state = timeline.with_state(course, &member.numbers) * member.sd;
            normal.view_mut((0, at), (base, own)).copy_from(&with_state);
            normal
                .view_mut((at, 0), (own, base))
                .copy_from(&with_state.transpose());
            let moment = timeline.moment(course, &member.numbers) * member.sd;
            right.rows_mut(at, own).copy_from(&moment);
            let mut other_at = base;
            for other in &members[..=place] {
                let pair = [
                    (course, &*member.numbers),
                    (other.change.course, &*other.numbers),
                ];
                let between = timeline.between(pair[0], pair[1]) * (member.sd * other.sd);
                let width = other.numbers.len();
                if other.change == member.change {
                    let mut to = normal.view_mut((at, at), (own, own));
                    to += between;
                } else {
                    normal
                        .view_mut((at, other_at), (own, width))
                        .copy_from(&between);
                    let transposed = between.transpose();
                    normal
                        .view_mut((other_at, at), (width, own))
                        .copy_from(&transposed);
                }
                other_at += width;
            }
            at += own;
        }
        let factor = normal.cholesky()?;
        Some(Self {
            solution: factor.solve(&right),
            factor,
            members,
        })
    }

    fn has(&self, change: &Change) -> bool {
        self.members.iter().any(|member| member.change == *change)
    }

    fn without(&self, timeline: &Timeline, place: usize) -> Option<Self> {
        let mut members = self.members.clone();
        members.remove(place);
        Self::new(timeline, members)
    }

    /// Score and information of a further change, given the state and the changes of the set.
    fn conditional(
        &self,
        timeline: &Timeline,
        course: Course,
        numbers: &[usize],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let with_state = timeline.with_state(course, numbers);
        let base = with_state.nrows();
        let mut cross = with_state.resize_vertically(self.solution.len(), 0.0);
        let mut at = base;
        for member in &self.members {
            let pair = [(member.change.course, &*member.numbers), (course, numbers)];
            let between = timeline.between(pair[0], pair[1]) * member.sd;
            cross.rows_mut(at, member.numbers.len()).copy_from(&between);
            at += member.numbers.len();
        }
        let own = timeline.between((course, numbers), (course, numbers));
        let score = timeline.moment(course, numbers) - cross.tr_mul(&self.solution);
        let information = own - cross.tr_mul(&self.factor.solve(&cross));
        (score, information)
    }

    /// Standard deviations of the priors of the members' numbers; 1 for the state.
    fn scales(&self) -> DVector<f64> {
        let base =
            self.solution.len() - self.members.iter().map(|m| m.numbers.len()).sum::<usize>();
        let of_members = self
            .members
            .iter()
            .flat_map(|m| vec![m.sd; m.numbers.len()]);
        let all = std::iter::repeat_n(1.0, base).chain(of_members);
        DVector::from_iterator(self.solution.len(), all)
    }

    /// Estimates of the state, then of the members.
    fn estimate(&self) -> DVector<f64> {
        self.solution.component_mul(&self.scales())
    }

    /// Covariance of [`Self::estimate`].
    fn covariance(&self) -> DMatrix<f64> {
        let scales = self.scales();
        let mut covariance = self.factor.inverse();
        for (i, one) in scales.iter().enumerate() {
            covariance.row_mut(i).scale_mut(*one);
            covariance.column_mut(i).scale_mut(*one);
        }
        covariance
    }

    /// Range of the numbers of a member.
    fn range_of(&self, change: &Change, timeline: &Timeline) -> std::ops::Range<usize> {
        let mut at = timeline.whole.moment.len();
        for member in &self.members {
            if member.change == *change {
                return at..at + member.numbers.len();
            }
            at += member.numbers.len();
        }
        at..at
    }

    /// Matrix that maps the estimates to the numbers of a part in a session.
    fn map_of(
        &self,
        timeline: &Timeline,
        part: usize,
        numbers: &[usize],
        session: usize,
    ) -> DMatrix<f64> {
        let mut map = DMatrix::zeros(numbers.len(), self.solution.len());
        for (row, number) in numbers.iter().enumerate() {
            map[(row, *number)] = 1.0;
        }
        let mut at = timeline.whole.moment.len();
        for member in &self.members {
            if member.change.part == part {
                let factor = timeline.factor(member.change.course, session);
                for row in 0..numbers.len() {
                    map[(row, at + row)] = factor;
                }
            }
            at += member.numbers.len();
        }
        map
    }
}

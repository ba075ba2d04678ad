//! Selects the sets of one linearisation that deserve a full nonlinear fit, and corrects the evidence of the others by the
//! results of those fits.
//!
//! The linear comparison of sets is exact near the fit at which it is made. The larger a cause, the more a full fit
//! changes the evidence of a set in which another cause replaces it. The change found for one set is applied to the
//! sets most similar to it.

use super::budget::{FIT_WITHIN, MAX_FITS, RIVAL_WITHIN};
use super::cause_sets::RankedSet;
use super::evidence::Member;
use super::linear_fit::LinearFit;
use super::relations::is_same_set;
use super::report::Cause;

/// A set with its evidence from the linear comparison and from its own fit.
struct ComparedSet {
    members: Vec<Member>,
    causes: Vec<Cause>,
    /// Log evidence and prior from the linear comparison.
    linear: f64,
    /// Correction of `linear` by the full fit; minus infinity if the fit is impossible, `None` without a full fit.
    change: Option<f64>,
}

/// The sets of one linearisation that are compared.
pub(super) struct SetComparison {
    sets: Vec<ComparedSet>,
    fits: usize,
}

impl SetComparison {
    /// Compares the ranking found at a fit. `fitted` has sets whose evidence at their own fits is known, the present one
    /// last.
    pub fn new(
        linear_fit: &LinearFit<'_, '_>,
        ranking: Vec<(Vec<Member>, f64)>,
        fitted: &[(Vec<Cause>, f64)],
    ) -> Self {
        let candidates = &linear_fit.catalogue.candidates;
        let own_evidence = |causes: &[Cause]| {
            let mut same = fitted.iter().rev().filter(|(k, _)| is_same_set(k, causes));
            same.next().map(|(_, value)| *value)
        };
        let is_present = |members: &[Member]| {
            members.len() == linear_fit.present.len()
                && members
                    .iter()
                    .all(|m| linear_fit.present.iter().any(|p| p.0 == m.0))
        };
        let linear = ranking
            .iter()
            .find(|(members, _)| is_present(members))
            .map(|(_, value)| *value);
        let offset = linear
            .zip(fitted.last())
            .map_or(0.0, |(linear, (_, own_evidence))| own_evidence - linear);
        let sets = ranking.into_iter().map(|(members, linear)| {
            let causes: Vec<Cause> = members.iter().map(|m| candidates[m.0].placed()).collect();
            let linear = linear + offset;
            ComparedSet {
                change: own_evidence(&causes).map(|value| value - linear),
                members,
                causes,
                linear,
            }
        });
        Self {
            sets: sets.collect(),
            fits: 0,
        }
    }

    pub fn members(&self, index: usize) -> &[Member] {
        &self.sets[index].members
    }

    pub fn causes(&self, index: usize) -> &[Cause] {
        &self.sets[index].causes
    }

    pub fn is_best(&self, index: usize) -> bool {
        let values = self.values();
        values.iter().all(|value| *value <= values[index])
    }

    /// Selects the next set to fit: the most probable one, then for each cause of the best set the most probable set
    /// without it, and the most probable one with another cause in its place.
    pub fn next(&self) -> Option<usize> {
        if self.fits == MAX_FITS {
            return None;
        }
        let values = self.values();
        let best = (0..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b]))?;
        let unfitted = |k: &usize| self.sets[*k].change.is_none();
        let likeliest = |condition: &dyn Fn(&usize) -> bool| {
            let places = (0..values.len()).filter(|k| condition(k));
            places.max_by(|a, b| values[*a].total_cmp(&values[*b]))
        };
        let near = likeliest(&unfitted).filter(|k| values[*k] >= values[best] - FIT_WITHIN);
        if near.is_some() {
            return near;
        }
        let members = &self.sets[best].members;
        let has = |k: usize, member: &Member| self.sets[k].members.iter().any(|m| m.0 == member.0);
        members.iter().find_map(|member| {
            let lacks = |k: &usize| !has(*k, member);
            let exchanged = |k: &usize| {
                let mut others = members.iter().filter(|m| m.0 != member.0);
                lacks(k) && others.all(|m| has(*k, m))
            };
            let without = likeliest(&lacks).filter(|k| values[*k] >= values[best] - RIVAL_WITHIN);
            without
                .into_iter()
                .chain(likeliest(&exchanged))
                .find(unfitted)
        })
    }

    /// Records the evidence of a set at its own fit, minus infinity if it is impossible, and the causes as fitted there.
    pub fn record_fit(&mut self, index: usize, log_evidence: f64, causes: &[Cause]) {
        let set = &mut self.sets[index];
        set.change = Some(log_evidence - set.linear);
        set.causes = causes.to_vec();
        self.fits += 1;
    }

    /// Rules out all sets that contain these causes, which a fit has shown to be impossible together.
    pub fn exclude(&mut self, causes: &[usize]) {
        let has = |set: &ComparedSet, cause: &usize| set.members.iter().any(|m| m.0 == *cause);
        for set in &mut self.sets {
            if causes.iter().all(|cause| has(set, cause)) {
                set.change = Some(f64::NEG_INFINITY);
            }
        }
        self.fits -= 1;
    }

    /// The sets in order of decreasing probability. Of sets that became the same when they were fitted, such as waves
    /// of different periods, the most probable one remains.
    pub fn ranking(self) -> Vec<RankedSet> {
        let values = self.values();
        let mut sets: Vec<(ComparedSet, f64)> = self.sets.into_iter().zip(values).collect();
        sets.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut fitted: Vec<Vec<Cause>> = Vec::new();
        sets.retain(|(set, _)| {
            let is_known = fitted.iter().any(|f| is_same_set(f, &set.causes));
            if set.change.is_some() && !is_known {
                fitted.push(set.causes.clone());
            }
            set.change.is_none() || !is_known
        });
        let ranked = |(set, log_posterior): (ComparedSet, f64)| RankedSet {
            causes: set.causes,
            log_posterior,
        };
        sets.into_iter().map(ranked).collect()
    }

    fn values(&self) -> Vec<f64> {
        let value = |set: &ComparedSet| set.linear + set.change.unwrap_or_else(|| self.change(set));
        self.sets.iter().map(value).collect()
    }

    /// Mean change by full fits of the most similar sets.
    fn change(&self, set: &ComparedSet) -> f64 {
        let lacks = |one: &ComparedSet, other: &ComparedSet| {
            let is_absent = |m: &&Member| other.members.iter().all(|o| o.0 != m.0);
            one.members.iter().filter(is_absent).count()
        };
        let fitted = self.sets.iter().filter_map(|other| {
            let change = other.change.filter(|change| change.is_finite())?;
            Some((lacks(set, other) + lacks(other, set), change))
        });
        let fitted: Vec<(usize, f64)> = fitted.collect();
        let nearest = fitted.iter().map(|(distance, _)| *distance).min();
        let alike = fitted
            .iter()
            .filter(|(distance, _)| Some(*distance) == nearest);
        let changes: Vec<f64> = alike.map(|(_, change)| *change).collect();
        changes.iter().sum::<f64>() / changes.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(members: &[usize], linear: f64) -> ComparedSet {
        ComparedSet {
            members: members.iter().map(|index| (*index, 0)).collect(),
            causes: Vec::new(),
            linear,
            change: None,
        }
    }

    /// A fit shows that 3 in place of both 1 and 2 is worse by 10 than its linear value. The set that also contains 4
    /// is lowered by as much, and the set similar to the present one is fitted instead.
    #[test]
    fn a_fit_also_corrects_similar_sets() {
        let mut compared = SetComparison {
            sets: vec![
                set(&[1, 2], 0.0),
                set(&[3], 2.0),
                set(&[3, 4], 1.0),
                set(&[1, 2, 5], -1.0),
            ],
            fits: 0,
        };
        compared.sets[0].change = Some(0.0);
        assert_eq!(compared.next(), Some(1));
        compared.record_fit(1, -8.0, &[]);
        assert!(!compared.is_best(1) && compared.is_best(0));
        // The third set was above all others and is now too low for a fit.
        assert_eq!(compared.values(), [0.0, -8.0, -9.0, -1.0]);
        assert_eq!(compared.next(), Some(3));
        compared.record_fit(3, -2.0, &[]);
        // The most probable set without cause 1 has been fitted already.
        assert_eq!(compared.next(), None);
    }

    /// Replacing 1 by 3 looks much worse in the linear comparison, which may be wrong. The set is fitted after the most
    /// probable one without 1 and turns out to be nearly as good.
    #[test]
    fn a_set_with_a_strong_cause_replaced_is_fitted() {
        let mut compared = SetComparison {
            sets: vec![set(&[1, 2], 0.0), set(&[4], -9.0), set(&[3, 2], -200.0)],
            fits: 0,
        };
        compared.sets[0].change = Some(0.0);
        assert_eq!(compared.next(), Some(1));
        compared.record_fit(1, -9.0, &[]);
        assert_eq!(compared.next(), Some(2));
        compared.record_fit(2, -1.0, &[]);
        assert_eq!(compared.values(), [0.0, -9.0, -1.0]);
    }

    /// 1 and 2 are impossible together, and so they are with 3 added. The fit that showed it does not count against the
    /// maximum, and another set is fitted instead.
    #[test]
    fn sets_with_jointly_impossible_causes_are_ruled_out() {
        let mut compared = SetComparison {
            sets: vec![
                set(&[1, 2], 0.0),
                set(&[1, 2, 3], -1.0),
                set(&[1, 4], -300.0),
            ],
            fits: 0,
        };
        assert_eq!(compared.next(), Some(0));
        compared.record_fit(0, f64::NEG_INFINITY, &[]);
        compared.exclude(&[1, 2]);
        assert_eq!(compared.fits, 0);
        assert_eq!(compared.next(), Some(2));
    }

    /// A set far below the best is fitted if it is the most probable one without one of the causes.
    #[test]
    fn the_likeliest_set_without_each_cause_is_fitted() {
        let mut compared = SetComparison {
            sets: vec![set(&[1, 2], 0.0), set(&[3, 2], -8.0), set(&[4], -24.0)],
            fits: 0,
        };
        compared.sets[0].change = Some(0.0);
        assert_eq!(compared.next(), Some(1));
        compared.record_fit(1, -1.0, &[]);
        assert_eq!(compared.next(), None, "{:?}", compared.values());
        assert_eq!(compared.values()[1].to_bits(), (-1.0_f64).to_bits());
    }

    /// The fit of the second set ends at the period of the first one, so they are the same set.
    #[test]
    fn sets_that_are_the_same_when_fitted_count_once() {
        let wave = |period: f64| {
            let effect = crate::effect::find("laser_cyclic").unwrap();
            let bound = crate::effect::BoundEffect {
                effect,
                cables: Vec::new(),
                targeted: false,
                values: vec![1e-3, period, 0.0],
            };
            Cause {
                instances: vec![bound],
            }
        };
        let mut compared = SetComparison {
            sets: vec![set(&[1], 0.0), set(&[2], -1.0), set(&[3], -2.0)],
            fits: 0,
        };
        compared.record_fit(0, 0.0, &[wave(0.2)]);
        compared.record_fit(1, 0.5, &[wave(0.201)]);
        compared.sets[2].causes = vec![wave(0.2)];
        let ranking = compared.ranking();
        let values: Vec<f64> = ranking.iter().map(|r| r.log_posterior).collect();
        assert_eq!(values.len(), 2, "{values:?}");
        assert_eq!(values[0].to_bits(), 0.5_f64.to_bits());
    }
}

//! Budget of uncertainty of an identification, as a document and in words.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::effect::find;
use tautline_core::estimation::{CovarianceBySource, UncertaintyBudget, UncertaintySource};
use tautline_core::statistics::student_t_quantile;

use super::{Identification, all_readings};
use crate::wording::first_lower;

/// Coverage probability of expanded uncertainties: that of two standard deviations of a normal distribution.
pub const COVERAGE_PROBABILITY: f64 = 0.9545;

/// Budget of the uncertainty of the identified values (GUM, JCGM 100:2008): the share of each source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BudgetDocument {
    /// Pulleys whose entry point was estimated, in the order of the cables.
    pub pulleys: Vec<PulleyBudget>,
    /// Mean square error of the platform's position at the measured poses once the identified values are at the controller; null if
    /// no pose has all lengths.
    pub position: Option<VarianceBudget>,
    /// Sources that are evaluated from the scatter of readings (type A of JCGM 100); the others are stated (type B).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub evaluated: Vec<EvaluatedSource>,
}

/// A source of uncertainty that is evaluated from the scatter of its readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EvaluatedSource {
    /// Name of the source.
    pub source: String,
    /// Its degrees of freedom: the redundancy of its readings.
    pub degrees_of_freedom: f64,
}

/// Budget of a pulley.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PulleyBudget {
    /// Name of its cable.
    pub cable: String,
    /// Sum of the variances of the coordinates of its entry point.
    #[serde(flatten)]
    pub budget: VarianceBudget,
}

/// A variance with the share of each source; the shares sum to 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VarianceBudget {
    /// Variance (m^2).
    pub variance_m2: f64,
    /// All sources, also those without influence.
    pub shares: Vec<SourceShare>,
}

/// Share of one source in a variance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SourceShare {
    /// Name of the source: laser, `tolerance:winch_scale`.
    pub source: String,
    /// Share of the variance, 0 to 1.
    pub share: f64,
}

impl From<UncertaintyBudget> for VarianceBudget {
    fn from(budget: UncertaintyBudget) -> Self {
        let shares = budget.shares().map(|(source, share)| SourceShare {
            source: source.id(),
            share,
        });
        Self {
            variance_m2: budget.variance(),
            shares: shares.collect(),
        }
    }
}

impl Identification {
    /// Budget of the uncertainty; `None` if the data do not determine all values, or for a robust loss.
    #[must_use]
    pub fn budget(&self) -> Option<BudgetDocument> {
        let problem = self.problem().ok()?;
        let divided = CovarianceBySource::new(&problem, &self.solution)?;
        let cables = self.dataset.robot.cables.iter().enumerate();
        let pulleys = cables.filter_map(|(index, cable)| {
            Some(PulleyBudget {
                cable: cable.name.clone(),
                budget: divided.entry_point(index)?.into(),
            })
        });
        Some(BudgetDocument {
            pulleys: pulleys.collect(),
            position: divided.position().map(VarianceBudget::from),
            evaluated: self.evaluated_sources(),
        })
    }

    fn evaluated_sources(&self) -> Vec<EvaluatedSource> {
        let mut sums = BTreeMap::new();
        for reading in all_readings(&self.analysis) {
            let source = UncertaintySource::of_reading(reading.kind);
            *sums.entry(source).or_insert(0.0) += reading.redundancy.unwrap_or(0.0);
        }
        // Readings without redundancy do not show their scatter.
        let controlled = sums
            .into_iter()
            .filter(|(_, redundancy)| *redundancy >= 1.0);
        let found = controlled.map(|(source, degrees_of_freedom)| EvaluatedSource {
            source: source.id(),
            degrees_of_freedom,
        });
        found.collect()
    }
}

impl BudgetDocument {
    /// Effective degrees of freedom of a variance (Welch and Satterthwaite, JCGM 100, G.4.1): `1 / sum(share^2 / dof)` over the
    /// sources of type A; infinite without any.
    #[must_use]
    pub fn effective_degrees_of_freedom(&self, of: &VarianceBudget) -> f64 {
        let terms = self.evaluated.iter().map(|one| {
            let share = of.share(&one.source);
            share * share / one.degrees_of_freedom
        });
        terms.filter(|term| *term > 0.0).sum::<f64>().recip()
    }

    /// Coverage factor of a variance for [`COVERAGE_PROBABILITY`], by the t distribution of its effective degrees of freedom.
    #[must_use]
    pub fn coverage_factor(&self, of: &VarianceBudget) -> f64 {
        let degrees_of_freedom = self.effective_degrees_of_freedom(of);
        let two_sided = 0.5 * (1.0 + COVERAGE_PROBABILITY);
        student_t_quantile(two_sided, degrees_of_freedom).unwrap_or(f64::NAN)
    }

    /// Coverage factor of the pulley of a cable; `None` where its place was not estimated.
    #[must_use]
    pub fn coverage_factor_of(&self, cable: &str) -> Option<f64> {
        let pulley = self.pulleys.iter().find(|one| one.cable == cable)?;
        Some(self.coverage_factor(&pulley.budget))
    }
}

impl VarianceBudget {
    /// Standard deviation (m).
    #[must_use]
    pub fn sd_m(&self) -> f64 {
        self.variance_m2.sqrt()
    }

    /// Share of a source, 0 if it is none of this budget.
    #[must_use]
    pub fn share(&self, source: &str) -> f64 {
        let own = self.shares.iter().find(|one| one.source == source);
        own.map_or(0.0, |one| one.share)
    }
}

/// Shares of a source in a budget.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceSummary {
    /// Name of the source in files.
    pub source: String,
    /// Its share in the sum of the variances of all pulleys.
    pub pulleys: f64,
    /// Its share in the variance of the position, if that is known.
    pub position: Option<f64>,
}

impl BudgetDocument {
    /// The share of each source in all pulleys together and in the position, the largest first; without those whose shares are
    /// below `least`.
    #[must_use]
    pub fn summary(&self, least: f64) -> Vec<SourceSummary> {
        let variances = self.pulleys.iter().map(|one| one.budget.variance_m2);
        let whole: f64 = variances.sum();
        let Some(first) = self.pulleys.first() else {
            return Vec::new();
        };
        let of = |one: &SourceShare| {
            let own = self.pulleys.iter().map(|pulley| {
                let budget = &pulley.budget;
                budget.variance_m2 * budget.share(&one.source)
            });
            SourceSummary {
                pulleys: own.sum::<f64>() / whole,
                position: self.position.as_ref().map(|p| p.share(&one.source)),
                source: one.source.clone(),
            }
        };
        let largest = |one: &SourceSummary| one.pulleys.max(one.position.unwrap_or(0.0));
        let mut all: Vec<_> = first.budget.shares.iter().map(of).collect();
        all.retain(|one| largest(one) >= least);
        all.sort_by(|a, b| largest(b).total_cmp(&largest(a)));
        all
    }
}

/// Name of a source of uncertainty for a reader: `tolerance: winch scale`.
#[must_use]
pub fn source_title(source: &str) -> String {
    let effect = |id: &str| find(id).map_or(id.to_owned(), |effect| first_lower(effect.title()));
    match source.split_once(':') {
        Some(("tolerance", id)) => format!("tolerance: {}", effect(id)),
        Some((_, id)) => format!("assumed size: {}", effect(id)),
        None => match source {
            "encoders" => "winch encoders".to_owned(),
            "drawing" => "drawing of the pulleys".to_owned(),
            other => other.replace('_', " "),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::samples::identified;

    #[test]
    fn a_budget_has_every_pulley_and_its_shares_sum_to_one() {
        let fit = identified();
        let budget = fit.budget().expect("determined");
        let cables = fit.dataset.robot.cables.iter().map(|cable| &cable.name);
        assert!(budget.pulleys.iter().map(|one| &one.cable).eq(cables));
        let document = fit.document();
        for (pulley, sds) in budget.pulleys.iter().zip(&document.entry_points_sd_m) {
            let shares: f64 = pulley.budget.shares.iter().map(|one| one.share).sum();
            assert!((shares - 1.0).abs() < 1e-12);
            let stated: f64 = sds.iter().flatten().map(|sd| sd * sd).sum();
            let off = pulley.budget.variance_m2 / stated - 1.0;
            assert!(off.abs() < 1e-3, "{off}");
        }
        let summary = budget.summary(0.0);
        let sum = |of: fn(&SourceSummary) -> f64| summary.iter().map(of).sum::<f64>();
        assert!((sum(|one| one.pulleys) - 1.0).abs() < 1e-12);
        assert!((sum(|one| one.position.unwrap_or(0.0)) - 1.0).abs() < 1e-12);
        assert!(budget.summary(0.1).len() < summary.len());
    }

    #[test]
    fn coverage_factors_are_those_of_table_g_2_of_the_gum() {
        let of_laser = VarianceBudget {
            variance_m2: 1.0,
            shares: vec![SourceShare {
                source: "laser".to_owned(),
                share: 1.0,
            }],
        };
        // The second half of the variance is stated: Welch and Satterthwaite give four times the degrees of freedom.
        let mut half = of_laser.clone();
        half.shares[0].share = 0.5;
        for (degrees_of_freedom, k) in [
            (1.0, 13.97),
            (5.0, 2.65),
            (10.0, 2.28),
            (20.0, 2.13),
            (50.0, 2.05),
        ] {
            let budget = |degrees_of_freedom: f64| BudgetDocument {
                pulleys: Vec::new(),
                position: None,
                evaluated: vec![EvaluatedSource {
                    source: "laser".to_owned(),
                    degrees_of_freedom,
                }],
            };
            for found in [
                budget(degrees_of_freedom).coverage_factor(&of_laser),
                budget(0.25 * degrees_of_freedom).coverage_factor(&half),
            ] {
                assert!((found - k).abs() < 6e-3, "{degrees_of_freedom}: {found}");
            }
        }
        let stated = BudgetDocument {
            pulleys: Vec::new(),
            position: None,
            evaluated: Vec::new(),
        };
        assert!((stated.coverage_factor(&of_laser) - 2.0).abs() < 1e-4);
    }

    #[test]
    fn sources_have_names_for_readers() {
        for (source, expected) in [
            ("encoders", "winch encoders"),
            ("home_pose", "home pose"),
            ("tolerance:winch_scale", "tolerance: winch scale"),
            ("prior:winch_scale", "assumed size: winch scale"),
        ] {
            assert_eq!(source_title(source), expected);
        }
    }
}

//! The readings that show a cause best, over the variable on which it depends: their residuals with all other causes in the
//! model, and what the cause explains of them.

use tautline_core::diagnosis::{Finding, Quantity, Variables};
use tautline_core::effect::{BoundEffect, Search};
use tautline_core::estimation::{
    Analysis, Control, Linearisation, Options, Problem, Solution, solve,
};
use tautline_core::measurement::{Dataset, Variable};

use super::dependences::{Dependent, by_row, dataset_as_modelled, figure_of};
use crate::documents::diagnosis::Diagnosed;
use crate::identification::{all_readings, group_of};
use crate::plot::figure::Figure;

/// The evidence of one finding.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// Kind of the readings that show it best.
    pub quantity: Quantity,
    /// Their cable, for readings of a cable.
    pub cable: Option<usize>,
    /// Their residuals over the variable.
    pub figure: Figure,
}

/// The evidence of each finding; `None` for an unknown cause and where channels are exchanged.
#[must_use]
pub fn evidence(diagnosed: &Diagnosed) -> Vec<Option<Evidence>> {
    let findings = &diagnosed.diagnosis.findings;
    let Some(dataset) = dataset_as_modelled(diagnosed) else {
        return findings.iter().map(|_| None).collect();
    };
    let of = |finding| Some(Explained::of(diagnosed, &dataset, finding)?.evidence());
    findings
        .iter()
        .map(|finding| of(finding).flatten())
        .collect()
}

/// Residuals without and with a cause.
struct Explained<'a> {
    diagnosed: &'a Diagnosed,
    finding: &'a Finding,
    problem: Problem<'a>,
    without: Analysis,
    with: Analysis,
}

impl<'a> Explained<'a> {
    fn of(diagnosed: &'a Diagnosed, dataset: &'a Dataset, finding: &'a Finding) -> Option<Self> {
        let solution = &diagnosed.diagnosis.extended_solution;
        let problem = problem_of(diagnosed, dataset, solution)?;
        let own = &finding.cause.instances;
        let is_own = |bound: &BoundEffect| own.iter().any(|one| is_same(one, bound));
        let mut others = problem.clone();
        others.free_effects.retain(|bound| !is_own(bound));
        if others.free_effects.len() == problem.free_effects.len() {
            return None;
        }
        let without = solve(&others, &Options::default(), &mut |_| Control::Continue).ok()?;
        Some(Self {
            diagnosed,
            finding,
            without: Analysis::new(&others, &without),
            with: Analysis::new(&problem, solution),
            problem,
        })
    }

    fn evidence(&self) -> Option<Evidence> {
        let (quantity, cable) = self.readings()?;
        let solution = &self.diagnosed.diagnosis.extended_solution;
        let linear = Linearisation::new(&self.problem, solution);
        let variables = Variables::new(&self.problem, solution, &linear);
        let own = self.finding.cause.effect().variable();
        let choices = [
            Variable::Time,
            Variable::CableLength,
            Variable::Distance,
            Variable::Position(2),
        ];
        let (variable, values) = own
            .into_iter()
            .chain(choices)
            .find_map(|variable| Some((variable, variables.values(quantity, cable, variable)?)))?;
        let without = by_row(&self.without, (quantity, cable));
        let with = by_row(&self.with, (quantity, cable));
        let mut dependents: Vec<Dependent> = Vec::new();
        for (row, residuals) in without {
            let after = with.get(&row);
            for (number, residual) in residuals.into_iter().enumerate() {
                let left = after.and_then(|after| after.get(number));
                dependents.push(Dependent {
                    row,
                    variable: values[row],
                    residual,
                    explained: left.map(|left| residual - left),
                });
            }
        }
        dependents.retain(|one| one.variable.is_finite());
        dependents.sort_by_key(|one| one.row);
        let event = self.event();
        let figure = figure_of(
            self.diagnosed,
            (quantity, cable, variable),
            &dependents,
            event,
        );
        Some(Evidence {
            quantity,
            cable,
            figure,
        })
    }

    /// The readings of which the cause explains most: of its own cables, if it has some.
    fn readings(&self) -> Option<(Quantity, Option<usize>)> {
        let own = self.finding.cause.cables();
        let mut gains: Vec<((Quantity, Option<usize>), f64)> = Vec::new();
        let all = [(&self.without, 1.0), (&self.with, -1.0)];
        for (analysis, sign) in all {
            for reading in all_readings(analysis) {
                let (Some(group), Some(size)) = (group_of(reading.kind), reading.normalised())
                else {
                    continue;
                };
                let gain = sign * size * size;
                match gains.iter_mut().find(|(known, _)| *known == group) {
                    Some((_, sum)) => *sum += gain,
                    None => gains.push((group, gain)),
                }
            }
        }
        let is_own = |(_, cable): (Quantity, Option<usize>)| {
            own.is_empty() || cable.is_some_and(|cable| own.contains(&cable))
        };
        let own = gains.iter().filter(|(group, _)| is_own(*group));
        own.max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(group, _)| *group)
    }

    /// Row at which, or from which on, the cause acts.
    fn event(&self) -> Option<(usize, bool)> {
        let bound = self.finding.cause.instances.first()?;
        let index = bound.effect.pose_parameter()?;
        let labels = &self.diagnosed.dataset.measurements.labels;
        let row = labels
            .iter()
            .position(|label| *label as f64 == bound.values[index])?;
        Some((row, matches!(bound.effect.search(), Search::FromPose(_))))
    }
}

/// The problem that has a solution of a diagnosis; `None` where channels are exchanged, so that the readings differ.
pub(super) fn problem_of<'a>(
    diagnosed: &Diagnosed,
    dataset: &'a Dataset,
    solution: &Solution,
) -> Option<Problem<'a>> {
    let effects = &solution.globals.effects;
    let (held, free) = effects.split_at_checked(diagnosed.diagnosis.held)?;
    if free.iter().any(|bound| !bound.effect.is_estimable()) {
        return None;
    }
    let mut problem = Problem::new(dataset).ok()?;
    problem.held_effects = held.to_vec();
    problem.free_effects = free.to_vec();
    let problem = problem.with_deviations_of(solution);
    Some(problem.at_poses_of(&diagnosed.diagnosis.base_solution))
}

/// Whether two effects are one and the same of a solution.
fn is_same(one: &BoundEffect, other: &BoundEffect) -> bool {
    one.effect.id() == other.effect.id() && one.cables == other.cables && one.values == other.values
}

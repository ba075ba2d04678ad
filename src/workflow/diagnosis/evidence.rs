//! The readings that show a cause best, over the variable on which it depends: their partial residuals, and the contribution of
//! the cause.
//!
//! A partial residual is that of the model with the cause, plus the contribution of the cause to the prediction, with its sign
//! reversed (Larsen and McCleary 1972). Geometry, poses and all other causes stay as they were estimated with the cause: a fit
//! without it would move them and hide part of it. Only tensions, which belong to a single pose, are estimated again. Where the
//! contribution depends on more than the variable, as creep on the length, its average over the other variables is put back, so
//! that the points scatter about the line of the cause as the residuals do about zero.

use tautline_core::diagnosis::{Cause, Finding, Quantity, Subject, UnmodelledError, Variables};
use tautline_core::effect::{BoundEffect, OF_DISTANCES, Search};
use tautline_core::estimation::{
    Analysis, Linearisation, Observation, Parameter, ParameterId, Problem, Solution,
};
use tautline_core::measurement::{Dataset, Variable};

use super::dependences::{Dependent, averaged, dataset_as_modelled, figure_of};
use crate::diagnosis::Diagnosed;
use crate::identification::group_of;
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

/// The evidence of each finding; for an unknown cause the residuals with the error. `None` if channels are exchanged.
#[must_use]
pub fn evidence(diagnosed: &Diagnosed) -> Vec<Option<Evidence>> {
    let findings = &diagnosed.diagnosis.findings;
    let Some(dataset) = dataset_as_modelled(diagnosed) else {
        return findings.iter().map(|_| None).collect();
    };
    let of = |finding: &Finding| match &finding.subject {
        Subject::Cause(_) => Explained::of(diagnosed, &dataset, finding)?.evidence(),
        Subject::UnmodelledError(error) => of_error(diagnosed, &dataset, error),
        Subject::WrongDrawing(_) | Subject::Slack(_) => None,
    };
    findings.iter().map(of).collect()
}

/// The residuals of readings with an error that no cause explains, with all causes in the model.
fn of_error(diagnosed: &Diagnosed, dataset: &Dataset, error: &UnmodelledError) -> Option<Evidence> {
    let solution = &diagnosed.diagnosis.extended_solution;
    let problem = problem_of(diagnosed, dataset, solution)?;
    let residual = |one: &Observation| Some((group_of(one.kind)?, one.row, one.normalised()?));
    let readings = error.readings;
    let is_its = |(quantity, cable): (Quantity, Option<usize>)| {
        quantity == readings.quantity && (readings.cable.is_none() || cable == readings.cable)
    };
    let mut residuals: Vec<_> = (Analysis::new(&problem, solution).observations.iter())
        .filter_map(residual)
        .filter(|(group, ..)| is_its(*group))
        .collect();
    // An error of all cables is shown on the cable with the largest residuals.
    let sizes = residuals.iter().map(|(group, _, size)| (*group, *size));
    let group = largest(sizes)?;
    residuals.retain(|(of, ..)| *of == group);
    let (variable, values) = variable_of(&problem, solution, group, error.form.variable())?;
    let dependent = |(_, row, residual): &(_, usize, f64)| Dependent {
        row: *row,
        variable: values[*row],
        residual: *residual,
        explained: None,
    };
    let mut dependents: Vec<Dependent> = residuals.iter().map(dependent).collect();
    dependents.retain(|one| one.variable.is_finite());
    let (quantity, cable) = group;
    Some(Evidence {
        quantity,
        cable,
        figure: figure_of(diagnosed, (quantity, cable, variable), &dependents, None),
    })
}

/// The readings with the largest sum of squares.
fn largest(
    values: impl Iterator<Item = ((Quantity, Option<usize>), f64)>,
) -> Option<(Quantity, Option<usize>)> {
    let mut groups: Vec<((Quantity, Option<usize>), f64)> = Vec::new();
    for (group, value) in values {
        match groups.iter_mut().find(|(known, _)| *known == group) {
            Some((_, sum)) => *sum += value * value,
            None => groups.push((group, value * value)),
        }
    }
    let largest = groups.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    largest.map(|(group, _)| group)
}

/// The variable over which readings are shown, `own` if it applies to them, with its values by row.
fn variable_of(
    problem: &Problem<'_>,
    solution: &Solution,
    (quantity, cable): (Quantity, Option<usize>),
    own: Option<Variable>,
) -> Option<(Variable, Vec<f64>)> {
    let linear = Linearisation::new(problem, solution);
    let variables = Variables::new(problem, solution, &linear);
    let choices = [
        Variable::Time,
        Variable::CableLength,
        Variable::Distance,
        Variable::Position(2),
    ];
    let mut all = own.into_iter().chain(choices);
    all.find_map(|variable| Some((variable, variables.values(quantity, cable, variable)?)))
}

/// A reading with a cause, and the contribution of the cause to it (standard deviations).
struct ExplainedReading {
    quantity: Quantity,
    cable: Option<usize>,
    row: usize,
    residual: f64,
    explained: f64,
}

/// The readings with a cause.
struct Explained<'a> {
    diagnosed: &'a Diagnosed,
    cause: &'a Cause,
    problem: Problem<'a>,
    readings: Vec<ExplainedReading>,
}

impl<'a> Explained<'a> {
    fn of(diagnosed: &'a Diagnosed, dataset: &'a Dataset, finding: &'a Finding) -> Option<Self> {
        let solution = &diagnosed.diagnosis.extended_solution;
        let problem = problem_of(diagnosed, dataset, solution)?;
        let is_of_distances = |id| OF_DISTANCES.iter().any(|effect| effect.id() == id);
        // The poses are held, and with them the distances, so that only other readings would be left to show.
        let cause = (finding.cause()).filter(|cause| !is_of_distances(cause.effect().id()))?;
        let own = &cause.instances;
        let is_other = |bound: &BoundEffect| !own.iter().any(|one| is_same(one, bound));
        let others: Vec<usize> = (0..problem.free_effects.len())
            .filter(|effect| is_other(&problem.free_effects[*effect]))
            .collect();
        if others.len() == problem.free_effects.len() {
            return None;
        }
        let (rest, at) = without_effects(&problem, solution, &others);
        let with = Analysis::new(&problem, solution).observations;
        let without = Analysis::new(&rest, &at).observations;
        let explained = |(with, without): (Observation, Observation)| {
            let (quantity, cable) = group_of(with.kind)?;
            Some(ExplainedReading {
                quantity,
                cable,
                row: with.row,
                // A reading that others control only without the cause leaves no residual with it, as a wrong reading.
                residual: with.normalised().or(without.normalised().and(Some(0.0)))?,
                explained: without.standardised - with.standardised,
            })
        };
        let readings = with.into_iter().zip(without).filter_map(explained);
        Some(Self {
            diagnosed,
            cause,
            readings: readings.collect(),
            problem,
        })
    }

    fn evidence(&self) -> Option<Evidence> {
        let (quantity, cable) = self.shown()?;
        let solution = &self.diagnosed.diagnosis.extended_solution;
        let own = self.cause.effect().variable();
        let (variable, values) = variable_of(&self.problem, solution, (quantity, cable), own)?;
        let own = self.readings.iter();
        let own = own.filter(|one| (one.quantity, one.cable) == (quantity, cable));
        let dependent = |one: &ExplainedReading| Dependent {
            row: one.row,
            variable: values[one.row],
            residual: one.residual,
            explained: Some(one.explained),
        };
        let mut dependents: Vec<Dependent> = own.map(dependent).collect();
        dependents.retain(|one| one.variable.is_finite());
        dependents.sort_by_key(|one| one.row);
        let event = self.event();
        let averaged = averaged(&dependents, event);
        for (one, contribution) in dependents.iter_mut().zip(averaged) {
            one.residual += contribution;
        }
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
    fn shown(&self) -> Option<(Quantity, Option<usize>)> {
        let own = self.cause.cables();
        let is_own = |one: &&ExplainedReading| {
            own.is_empty() || one.cable.is_some_and(|cable| own.contains(&cable))
        };
        let readings = self.readings.iter().filter(is_own);
        largest(readings.map(|one| ((one.quantity, one.cable), one.explained)))
    }

    /// Row at which, or from which on, the cause acts.
    fn event(&self) -> Option<(usize, bool)> {
        let bound = self.cause.instances.first()?;
        let index = bound.effect.pose_parameter()?;
        let labels = &self.diagnosed.dataset.measurements.labels;
        let row = labels
            .iter()
            .position(|label| *label as f64 == bound.values[index])?;
        Some((row, matches!(bound.effect.search(), Search::FromPose(_))))
    }
}

/// The problem of a diagnosis whose solution is given; `None` if channels are exchanged, because the readings then differ.
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

/// The problem and the solution with only some of the free effects, given by their indices.
fn without_effects<'a>(
    problem: &Problem<'a>,
    solution: &Solution,
    kept: &[usize],
) -> (Problem<'a>, Solution) {
    let mut rest = problem.clone();
    rest.free_effects = kept
        .iter()
        .map(|k| problem.free_effects[*k].clone())
        .collect();
    let parameter = |one: &Parameter| match one.id {
        ParameterId::Effect { effect, parameter } => {
            let effect = kept.iter().position(|k| *k == effect)?;
            let id = ParameterId::Effect { effect, parameter };
            Some(Parameter { id, ..one.clone() })
        }
        _ => Some(one.clone()),
    };
    let mut at = Solution {
        parameters: solution.parameters.iter().filter_map(parameter).collect(),
        ..solution.clone()
    };
    at.globals.effects = [&rest.held_effects[..], &rest.free_effects].concat();
    (rest, at)
}

/// Whether two effects of a solution have the same identifier, cables and values.
fn is_same(one: &BoundEffect, other: &BoundEffect) -> bool {
    one.effect.id() == other.effect.id() && one.cables == other.cables && one.values == other.values
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use tautline_core::effect::EffectSetting;
    use tautline_core::estimation::Control;
    use tautline_core::robot::presets;
    use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};

    use super::*;
    use crate::diagnosis::{TIME_LIMIT_S, diagnose_dataset};

    fn diagnosed(effect: &str, cable: Option<&str>, parameters: &[(&str, f64)]) -> Diagnosed {
        let preset = presets::find("mini").expect("a preset");
        let geometry = preset.measured_entry_points_m.clone();
        let options = SimulationOptions {
            geometry: geometry.map_or(TrueGeometry::Drawn, TrueGeometry::EntryPoints),
            effects: vec![EffectSetting {
                effect: effect.to_owned(),
                targets: cable.into_iter().map(str::to_owned).collect(),
                parameters: (parameters.iter())
                    .map(|(name, value)| ((*name).to_owned(), *value))
                    .collect(),
            }],
            workspace: Some(preset.workspace),
            tension: Some(preset.tension),
            ..SimulationOptions::new(40, 1)
        };
        let dataset = simulate(&preset.robot, &options)
            .expect("simulated")
            .dataset;
        diagnose_dataset(Arc::new(dataset), (0.01, TIME_LIMIT_S), &mut |_| {
            Control::Continue
        })
        .expect("diagnosed")
    }

    #[test]
    fn readings_scatter_about_the_line_of_a_cause_with_their_noise() {
        for (effect, cable, parameter, of_effect) in [
            ("cable_creep", None, ("c", 0.005), Quantity::Length),
            (
                "winch_scale",
                Some("cable-3"),
                ("scale", 0.02),
                Quantity::Length,
            ),
            (
                "force_bias",
                Some("cable-3"),
                ("bias", 25.0),
                Quantity::Tension,
            ),
            ("laser_scale", None, ("scale", 0.05), Quantity::Laser),
        ] {
            let diagnosed = diagnosed(effect, cable, &[parameter]);
            let findings = &diagnosed.diagnosis.findings;
            let is_it =
                |finding: &Finding| finding.cause().is_some_and(|c| c.effect().id() == effect);
            let number = findings.iter().position(is_it).expect(effect);
            let shown = evidence(&diagnosed).swap_remove(number).expect(effect);
            assert_eq!(shown.quantity, of_effect, "{effect}");
            let line: Vec<[f64; 2]> = shown
                .figure
                .curves
                .iter()
                .flat_map(|c| c.points.clone())
                .collect();
            let on_line = |x: f64| {
                let near = line
                    .iter()
                    .min_by(|a, b| (a[0] - x).abs().total_cmp(&(b[0] - x).abs()));
                near.expect("a line")[1]
            };
            let points = shown.figure.series[0].points();
            let off = points
                .iter()
                .map(|point| (point.y - on_line(point.x)).powi(2));
            let scatter = (off.sum::<f64>() / points.len() as f64).sqrt();
            let heights = line.iter().map(|[_, y]| y.abs());
            let height = heights.fold(0.0, f64::max);
            assert!(points.len() >= 40, "{effect}");
            assert!((0.6..1.5).contains(&scatter), "{effect}: {scatter}");
            assert!(height > 4.0 * scatter, "{effect}: {height} and {scatter}");
            if effect == "cable_creep" {
                // Logarithmic creep goes one way, and no wave of poses or geometry is left.
                let mut reached = f64::MIN;
                for [_, y] in &line {
                    reached = reached.max(y.abs());
                    assert!(y.abs() > reached - 0.01 * height, "{line:?}");
                }
            }
        }
    }

    /// With its cause in the model nothing else controls such a reading.
    #[test]
    fn a_wrong_reading_is_shown_among_those_of_its_kind() {
        let diagnosed = diagnosed("laser_outliers", None, &[("pose", 12.0), ("error", 0.05)]);
        let shown = evidence(&diagnosed).remove(0).expect("evidence");
        assert_eq!(shown.quantity, Quantity::Laser);
        let points = shown.figure.series[0].points();
        assert_eq!(points.len(), 41);
        let far = points.iter().filter(|point| point.y.abs() > 20.0);
        assert_eq!(far.count(), 1);
    }
}

//! Differences of the home pose and of effects between two runs.

use nalgebra::{DMatrix, DVector};

use super::estimate::{Estimate, Estimates};
use super::{EffectDifference, HomeDifference, ScalarDifference, Test};
use crate::estimation::ParameterId;
use crate::geometry::{Coordinate, Pose};

/// Home pose of the second run less that of the first.
pub(super) fn home(estimates: &Estimates<'_>) -> Option<HomeDifference> {
    let runs = &estimates.runs;
    let estimated: Vec<Coordinate> = (Coordinate::ALL.into_iter())
        .filter(|c| {
            let id = ParameterId::Home(*c);
            runs.iter().any(|run| run.index_of(&id).is_some())
        })
        .collect();
    if estimated.is_empty() {
        return None;
    }
    let [first, second] = runs.each_ref().map(home_pose);
    let twist = second.difference(&first);
    let value = DVector::from_iterator(estimated.len(), estimated.iter().map(|c| twist[c.index()]));
    let covariance = DMatrix::from_fn(estimated.len(), estimated.len(), |i, k| {
        let [one, other] = [i, k].map(|index| ParameterId::Home(estimated[index]));
        estimates.covariance_of(&one, &other)
    });
    Some(HomeDifference {
        coordinates: (estimated.iter().enumerate())
            .map(|(k, c)| (*c, value[k], covariance[(k, k)].sqrt()))
            .collect(),
        test: Test::of(&value, &covariance),
    })
}

/// Home pose of a run by its estimates.
fn home_pose(run: &Estimate<'_>) -> Pose {
    let solved = run.run.solution.globals.home;
    let Some(stated) = run.robot().home.map(|home| home.pose()) else {
        return solved;
    };
    let mut twist = solved.difference(&stated);
    for coordinate in Coordinate::ALL {
        let index = coordinate.index();
        twist[index] = run.value_or(&ParameterId::Home(coordinate), twist[index]);
    }
    stated.perturbed(&twist)
}

/// A parameter of an effect in a run: its identity across runs, its index among the parameters, unit and neutral value.
struct KeyedParameter {
    key: (String, Vec<String>, String),
    unit: &'static str,
    neutral: f64,
    index: usize,
}

fn effect_parameters(run: &Estimate<'_>) -> Vec<KeyedParameter> {
    let problem = run.run.problem;
    let parameters = run.run.solution.parameters.iter().enumerate();
    parameters
        .filter_map(|(index, parameter)| match parameter.id {
            ParameterId::Effect { effect, parameter } => {
                let bound = &problem.free_effects[effect];
                let description = bound.effect.parameters()[parameter];
                let setting = bound.setting(run.robot());
                Some(KeyedParameter {
                    key: (setting.effect, setting.targets, description.name.to_owned()),
                    unit: description.unit,
                    neutral: description.neutral,
                    index,
                })
            }
            _ => None,
        })
        .collect()
}

/// Differences of the effect parameters that either run estimates.
pub(super) fn effects(estimates: &Estimates<'_>) -> Vec<EffectDifference> {
    let runs = &estimates.runs;
    let [first, second] = runs.each_ref().map(effect_parameters);
    let only_second = (second.iter()).filter(|e| !first.iter().any(|other| other.key == e.key));
    let all = first.iter().chain(only_second);
    all.map(|parameter| {
        let index = |parameters: &[KeyedParameter]| {
            let mut parameters = parameters.iter();
            Some(parameters.find(|other| other.key == parameter.key)?.index)
        };
        let indices = [index(&first), index(&second)];
        let at = |run: usize| indices[run].map(|index| runs[run].values[index]);
        let difference = at(1).unwrap_or(parameter.neutral) - at(0).unwrap_or(parameter.neutral);
        let variance = estimates.covariance_at(indices, indices);
        EffectDifference {
            effect: parameter.key.0.clone(),
            targets: parameter.key.1.clone(),
            parameter: parameter.key.2.clone(),
            unit: parameter.unit.to_owned(),
            size: ScalarDifference {
                first: at(0),
                second: at(1),
                difference,
                sd: variance.sqrt(),
                test: Test::of(
                    &DVector::from_element(1, difference),
                    &DMatrix::from_element(1, 1, variance),
                ),
            },
        }
    })
    .collect()
}

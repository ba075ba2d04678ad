//! Measures the accuracy of a diagnosis: parameter errors, held-out error, and the fit of listed causes.

use anyhow::Result;
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{Finding, Subject};
use tautline_core::effect::{BoundEffect, EffectSetting, Search};
use tautline_core::estimation::{Geometry, Problem};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_core::simulation::{Simulated, SimulationOptions, TrueGeometry, simulate};

use super::Setup;
use super::judge::matched;
use super::names::{self, Name};
use crate::tables::simulated::{preset_options, solved};

/// Difference of chi-square from which a cause fits clearly worse if the number of parameters is the same, and
/// allowance for each additional parameter (Akaike 1974).
const CLEARLY_WORSE: f64 = 9.0;
const PER_PARAMETER: f64 = 2.0;
/// Offset of the seed for held-out data.
const OTHER_SEED: u64 = 1 << 40;

/// Error of one parameter of a named effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ParameterError {
    /// Identifier of the effect.
    #[serde(with = "names")]
    pub effect: Name,
    /// Name of the parameter.
    #[serde(with = "names")]
    pub parameter: Name,
    /// Estimate minus truth, in standard deviations.
    pub standardised: f64,
}

/// Parameter errors of a finding whose cause is a hidden effect.
#[must_use]
pub fn parameter_errors(
    finding: &Finding,
    truths: &[EffectSetting],
    robot: &Robot,
) -> Vec<ParameterError> {
    let Some(cause) = finding.cause() else {
        return Vec::new();
    };
    let of = matched(truths, cause, robot);
    let effect = cause.effect();
    // Parameters of several outliers in one finding cannot be told apart by name.
    let single_readings = matches!(effect.search(), Search::AtPose(_));
    if single_readings && cause.instances.len() > 1 {
        return Vec::new();
    }
    let value = |name: &str, cable: Option<usize>| {
        let found = finding.parameters.iter();
        let mut same = found.filter(|p| p.name == name && p.cable == cable);
        same.next().map(|p| p.value)
    };
    let mut errors = Vec::new();
    for parameter in &finding.parameters {
        let concerned = of.iter().map(|k| &truths[*k]).find(|truth| {
            let name = parameter.cable.map(|c| &robot.cables[c].name);
            name.is_none_or(|name| truth.targets.is_empty() || truth.targets.contains(name))
        });
        let truth = concerned.and_then(|t| t.parameters.get(parameter.name));
        let (Some(truth), Some(sd)) = (truth, parameter.sd) else {
            continue;
        };
        let mut difference = parameter.value - truth;
        if matches!(effect.search(), Search::Wave { .. }) {
            let found = value("amplitude", parameter.cable).unwrap_or(1.0);
            let hidden = concerned.and_then(|t| t.parameters.get("amplitude"));
            let turned = found.signum() * hidden.map_or(1.0, |a| a.signum());
            difference = wave_difference(parameter.name, parameter.value, *truth, turned);
        }
        errors.push(ParameterError {
            effect: effect.id(),
            parameter: parameter.name,
            standardised: difference / sd,
        });
    }
    errors
}

/// Difference of a wave parameter. A wave of negative amplitude is the same as one of positive amplitude and opposite
/// phase; `turned` is negative if exactly one of the amplitudes is.
fn wave_difference(name: &str, found: f64, truth: f64, turned: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    match name {
        "amplitude" => found.abs() - truth.abs(),
        "phase" => {
            let opposite = if turned < 0.0 { PI } else { 0.0 };
            (found + opposite - truth + PI).rem_euclid(TAU) - PI
        }
        _ => found - truth,
    }
}

/// Held-out error of a model relative to that of the true model fitted to the same data: the square root of the ratio
/// of their chi-squares for another run of the true robot, with the parameters of both models fixed. Parts deviate in
/// the true model if the description states tolerances. `None` if an effect changes readings in a way that no model contains.
///
/// # Errors
/// If the true robot cannot be simulated again or a fit fails.
pub fn held_out_ratio(setup: &Setup, run: &Simulated, extended: Robot) -> Result<Option<f64>> {
    let description = &run.dataset.robot;
    let Some(problem) = with_effects(&run.dataset, &run.truth.effects)? else {
        return Ok(None);
    };
    let true_model = solved(&problem)?.globals.model(description);
    let again = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        ..preset_options(
            &setup.robot.preset,
            setup.robot.poses,
            setup.seed + OTHER_SEED,
        )
    };
    let fresh = simulate(&run.truth, &again)?.dataset.measurements;
    let left = |model: Robot| -> Result<f64> {
        let dataset = Dataset {
            robot: model,
            measurements: fresh.clone(),
        };
        let mut problem = Problem::new(&dataset)?;
        problem.geometry = Geometry::Held;
        Ok(solved(&problem)?.chi2)
    };
    let ratio = left(extended)? / left(true_model)?;
    Ok(Some(ratio.sqrt()))
}

/// The problem with some effects free, starting from their true values. `None` if one cannot be estimated.
fn with_effects<'a>(
    dataset: &'a Dataset,
    effects: &[EffectSetting],
) -> Result<Option<Problem<'a>>> {
    let mut problem = Problem::new(dataset)?.with_stated_tolerances();
    for effect in effects {
        let bound = BoundEffect::from_setting(effect, &dataset.robot)?;
        if !bound.effect.is_estimable() {
            return Ok(None);
        }
        problem.free_effects.push(bound);
    }
    Ok(Some(problem))
}

/// Whether each of the listed causes fits about as well as the hidden effect that it replaces.
///
/// # Errors
/// If a fit fails.
pub fn rivals_fit(
    dataset: &Dataset,
    listed: &[Subject],
    truths: &[EffectSetting],
    of: usize,
) -> Result<bool> {
    let Some(full) = with_effects(dataset, truths)? else {
        return Ok(false);
    };
    let best = solved(&full)?.chi2;
    let mut others = full;
    let truth = others.free_effects.remove(of);
    let estimable = |bound: &BoundEffect| {
        let parameters = bound.effect.parameters().iter();
        parameters.filter(|p| !p.discrete).count() as f64
    };
    // An unmodelled error has no parameters to fit; it is listed because of its evidence.
    for cause in listed.iter().filter_map(Subject::cause) {
        if !cause.effect().is_estimable() {
            return Ok(false);
        }
        let mut problem = others.clone();
        problem.free_effects.extend(cause.instances.iter().cloned());
        let own: f64 = cause.instances.iter().map(estimable).sum();
        let allowed = CLEARLY_WORSE + PER_PARAMETER * (estimable(&truth) - own);
        if solved(&problem)?.chi2 > best + allowed {
            return Ok(false);
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use tautline_core::diagnosis::Cause;

    use super::*;
    use crate::tables::hidden::robots::robot;
    use crate::tables::hidden::{Conditions, Hidden};
    use crate::tables::simulated::setting;

    fn mini() -> Setup {
        Setup {
            robot: robot("mini").unwrap(),
            seed: 4,
            conditions: Conditions::default(),
        }
    }

    fn measured(effect: &EffectSetting) -> Simulated {
        let hidden = Hidden::Effects(vec![effect.clone()]);
        mini().measured(&hidden).unwrap()
    }

    fn scale(cable: &str, value: f64) -> EffectSetting {
        setting("winch_scale", &[cable], "scale", value)
    }

    #[test]
    fn phases_count_modulo_a_turn_and_the_sign_of_the_amplitude() {
        let pi = std::f64::consts::PI;
        assert!(wave_difference("phase", 3.1, -3.1, 1.0).abs() < 0.1);
        assert!(wave_difference("phase", 0.5 - pi, 0.5, -1.0).abs() < 1e-12);
        assert!(wave_difference("amplitude", -2.0, 2.0, -2.0).abs() < 1e-12);
    }

    #[test]
    fn the_true_model_is_as_good_as_itself_and_the_base_model_is_worse() {
        let run = measured(&scale("cable-2", 0.01));
        let ratio = |problem: &Problem<'_>| {
            let globals = solved(problem).unwrap().globals;
            let model = globals.model(&run.dataset.robot);
            held_out_ratio(&mini(), &run, model).unwrap().unwrap()
        };
        let full = with_effects(&run.dataset, &run.truth.effects).unwrap();
        assert!((ratio(&full.unwrap()) - 1.0).abs() < 1e-12);
        let base = Problem::new(&run.dataset).unwrap();
        assert!(ratio(&base) > 1.05, "{}", ratio(&base));
    }

    #[test]
    fn a_cause_on_another_cable_fits_clearly_worse() {
        let truth = scale("cable-2", 0.02);
        let run = measured(&truth);
        let fits = |setting: &EffectSetting| {
            let bound = BoundEffect::from_setting(setting, &run.dataset.robot).unwrap();
            let listed = [Subject::Cause(Cause {
                instances: vec![bound],
            })];
            rivals_fit(&run.dataset, &listed, std::slice::from_ref(&truth), 0).unwrap()
        };
        assert!(fits(&truth));
        assert!(!fits(&scale("cable-7", 0.0)));
    }
}

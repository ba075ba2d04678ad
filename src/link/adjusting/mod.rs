//! Writing identified values to a controller so that it holds either all old or all new values.
//!
//! Controllers have no transactions. So the old values are read first, twice, because a single reading can be wrong; the new
//! ones are written and read back, and if any does not read back as written, the old ones are restored and read back. If the connection breaks, it is
//! re-established and the values are read again: they are all new, all old, or mixed. A mixture requires that the
//! operator arms the controller again, after which [`settle_adjustment`] restores the old values.
//!
//! Once another program has armed, the controller takes no more values from this one: those it holds are read and reported.
//!
//! A controller may hold NaN or infinity. Such a value is overwritten like any other, but cannot be
//! restored, because only finite numbers are written.

use std::thread;
use std::time::Duration;

use tautline_core::estimation::{ParameterId, Solution};
use tautline_core::robot::Robot;

use crate::controller::Controller;
use crate::error::LinkError;
use crate::parameters::{EffectName, ParameterInfo, home_lengths, parameters_of};
use crate::reconnecting::ReconnectPolicy;

/// Largest difference (m, rad, 1) at which the controller counts as holding a value; it allows for rounding to single
/// precision.
const TOLERANCE: f64 = 1e-9;
/// The same, relative to the value.
const RELATIVE_TOLERANCE: f64 = 2e-7;
/// Largest number of attempts to read the values after the connection broke.
const MAX_ATTEMPTS: usize = 8;
/// Largest number of readings among which two in succession must agree.
const MAX_READINGS: usize = 4;
/// Pause between two readings that must agree: longer than most cycles of controllers.
const READING_PAUSE: Duration = Duration::from_millis(20);

/// One parameter with its values in the controller and as identified.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Name; see [`crate::parameters`].
    pub name: String,
    /// SI unit; "1" for a ratio.
    pub unit: &'static str,
    /// Value in the controller, which may be NaN or infinite; `None` if it has no such parameter, so that the value cannot be
    /// written.
    pub controller: Option<f64>,
    /// Identified value. For an effect that the model lacks: the neutral value, or `None` if that is unknown.
    pub identified: Option<f64>,
    /// Whether the model has the parameter.
    pub in_model: bool,
    /// Identified less controller.
    pub difference: Option<f64>,
    /// Standard deviation of the identified value, if the parameter was estimated and the data determine it.
    pub sd: Option<f64>,
    /// Part of the platform's position error that returns if this value alone stays as the controller holds it (m); `None` unless
    /// the value is written, and where it was not computed.
    pub gain_m: Option<f64>,
}

impl Difference {
    /// Whether the controller holds another value than the identified one.
    #[must_use]
    pub fn is_writable_change(&self) -> bool {
        let both = self.controller.zip(self.identified);
        both.is_some_and(|(held, identified)| !is_held(held, identified))
    }

    /// Whether the controller corrects an effect that neither the model nor this program knows, so that its neutral value is
    /// unknown.
    #[must_use]
    pub fn is_unknown_effect(&self) -> bool {
        let is_effect = EffectName::read(&self.name).is_some();
        is_effect && self.identified.is_none() && self.controller != Some(0.0)
    }
}

/// Compares every parameter of the identified model and of the controller. An effect that the model lacks gets its neutral
/// value, because the controller would otherwise go on correcting it.
#[must_use]
pub fn plan_adjustment(
    controller: &[ParameterInfo],
    identified: &Robot,
    solution: Option<&Solution>,
) -> Vec<Difference> {
    let is_offered = |length: &ParameterInfo| controller.iter().any(|p| p.name == length.name);
    let of_model = parameters_of(identified).into_iter();
    let of_model = of_model.chain(home_lengths(identified).into_iter().filter(is_offered));
    let mut lines: Vec<Difference> = of_model
        .map(|parameter| {
            let held = controller.iter().find(|p| p.name == parameter.name);
            let held = held.map(|p| p.value);
            Difference {
                controller: held,
                identified: Some(parameter.value),
                in_model: true,
                difference: held.map(|held| parameter.value - held),
                sd: solution.and_then(|s| deviation(s, identified, &parameter.name)),
                gain_m: None,
                unit: parameter.unit,
                name: parameter.name,
            }
        })
        .collect();
    let is_lacking = |held: &&ParameterInfo| lines.iter().all(|line| line.name != held.name);
    let lacking: Vec<&ParameterInfo> = controller.iter().filter(is_lacking).collect();
    lines.extend(lacking.into_iter().map(|held| {
        let known = EffectName::read(&held.name).and_then(|name| name.parameter_of(identified));
        let neutral = known.map(|parameter| parameter.neutral);
        Difference {
            name: held.name.clone(),
            unit: known.map_or(held.unit, |parameter| parameter.unit),
            controller: Some(held.value),
            identified: neutral,
            in_model: false,
            difference: neutral.map(|neutral| neutral - held.value),
            sd: None,
            gain_m: None,
        }
    }));
    lines
}

/// Standard deviation of an estimated parameter, by its name in the controller.
///
/// For a component of the home rotation it is that of the estimated small rotation, which is equal
/// for the small angles of a home pose.
fn deviation(solution: &Solution, robot: &Robot, name: &str) -> Option<f64> {
    let axes = ["x", "y", "z"];
    let named = |id: &ParameterId| match id {
        ParameterId::EntryPoint { cable, axis } => {
            let cable = &robot.cables.get(*cable)?.name;
            Some(format!("{cable}.entry_point.{}_m", axes.get(*axis)?))
        }
        ParameterId::PlaneOffset => Some("laser.target_plane.offset_m".to_owned()),
        ParameterId::Home(coordinate) => {
            let k = coordinate.index();
            Some(match k {
                0..3 => format!("home.{}_m", axes[k]),
                _ => format!("home.r{}_rad", axes.get(k - 3)?),
            })
        }
        ParameterId::HomeTension { .. }
        | ParameterId::Effect { .. }
        | ParameterId::Deviation { .. } => None,
    };
    let index = solution.parameters.iter().position(|parameter| {
        named(&parameter.id).is_some_and(|known| known == name)
            || effect_named(solution, robot, &parameter.id).is_some_and(|known| known == name)
    })?;
    solution.standard_deviation(index)
}

/// Name of an effect's parameter in the controller; free effects come after the held ones.
fn effect_named(solution: &Solution, robot: &Robot, id: &ParameterId) -> Option<String> {
    let ParameterId::Effect { effect, parameter } = id else {
        return None;
    };
    let freed = solution.parameters.iter().filter_map(|p| match p.id {
        ParameterId::Effect { effect, .. } => Some(effect + 1),
        _ => None,
    });
    let effects = &solution.globals.effects;
    let held = effects.len().checked_sub(freed.max()?)?;
    let bound = effects.get(held + effect)?;
    let setting = bound.setting(robot);
    let known = bound.effect.parameters().get(*parameter)?;
    Some(crate::parameters::effect_name(&setting, known.name))
}

/// State of the controller's values after an attempt to write.
#[derive(Debug, Clone, PartialEq)]
pub enum ControllerValues {
    /// All new values.
    New,
    /// All old values, as if nothing had been written.
    Old,
    /// Some of both; lists the parameters that do not have their old value.
    Mixed(Vec<String>),
    /// Unknown, as the controller no longer answers.
    Unknown,
}

const OLD_VALUES: &str = "The controller holds its old values: find the cause, then write again.";
const UNKNOWN_VALUES: &str = "Do not move the robot: connect and arm it again, which brings the old values back; they are saved here.";

/// Outcome of an attempt to write.
#[derive(Debug, Clone, PartialEq)]
pub struct Adjustment {
    /// State of the values.
    pub holds: ControllerValues,
    /// The previous values, to be restored by hand or with [`write_adjustment`].
    pub old: Vec<(String, f64)>,
    /// Problem, if there was one.
    pub problem: Option<String>,
    /// Next step for the operator, in one sentence.
    pub advice: String,
}

/// All parameters with their values, on which two successive readings agree.
///
/// # Errors
/// If the connection is lost, or the readings keep differing; the values are named.
pub fn read_parameters(controller: &mut dyn Controller) -> Result<Vec<ParameterInfo>, LinkError> {
    let mut parameters = controller.parameters()?;
    let names: Vec<String> = parameters.iter().map(|p| p.name.clone()).collect();
    let values = parameters.iter().map(|p| p.value).collect();
    let values = confirmed(controller, &names, values)?;
    for (parameter, value) in parameters.iter_mut().zip(values) {
        parameter.value = value;
    }
    Ok(parameters)
}

/// The values on which two successive readings agree, the first of which is given; values that are not numbers agree.
fn confirmed(
    controller: &mut dyn Controller,
    names: &[String],
    mut values: Vec<f64>,
) -> Result<Vec<f64>, LinkError> {
    if names.is_empty() {
        return Ok(values);
    }
    let mut differing = Vec::new();
    for _ in 1..MAX_READINGS {
        thread::sleep(READING_PAUSE);
        let again = controller.read(names)?;
        if again.len() != names.len() || values.len() != names.len() {
            let text = "it returned fewer values than requested";
            return Err(LinkError::Refused(text.to_owned()));
        }
        let agree = |a: f64, b: f64| a == b || !a.is_finite() && !b.is_finite();
        let pairs = names.iter().zip(values.iter().zip(&again));
        let others = pairs.filter(|(_, (before, now))| !agree(**before, **now));
        differing = others
            .map(|(name, (before, now))| format!("{name} = {before}, then {now}"))
            .collect();
        values = again;
        if differing.is_empty() {
            return Ok(values);
        }
    }
    Err(LinkError::Refused(format!(
        "these values differ from one reading to the next, so that they could not be restored: {}",
        differing.join("; ")
    )))
}

/// Checks that the controller still holds the values that were recorded as the old ones.
///
/// # Errors
/// If it holds others, which are named, or cannot be read.
pub fn check_unchanged(
    controller: &mut dyn Controller,
    old: &[(String, f64)],
) -> Result<(), LinkError> {
    let others = differing(controller, old)?;
    if others.is_empty() {
        return Ok(());
    }
    Err(LinkError::Refused(format!(
        "its values are not those that were read before ({}): read them back first",
        former(old, &others)
    )))
}

/// Writes new values and reads them back, or restores the old ones.
///
/// # Errors
/// If nothing was written: the controller is not armed, or the old values cannot be read.
pub fn write_adjustment(
    controller: &mut dyn Controller,
    new: &[(String, f64)],
) -> Result<Adjustment, LinkError> {
    if !controller.state().armed {
        return Err(LinkError::NotArmed);
    }
    let names: Vec<String> = new.iter().map(|(name, _)| name.clone()).collect();
    let held = controller.read(&names)?;
    let held = confirmed(controller, &names, held)?;
    let old: Vec<(String, f64)> = names.into_iter().zip(held).collect();
    let problem = match write_and_compare(controller, new) {
        Ok(wrong) if wrong.is_empty() => {
            let others = not_numbers(&old);
            let advice = "Verify the new values with a verification run.";
            let advice = match others.is_empty() {
                true => advice.to_owned(),
                false => format!(
                    "{advice} A roll-back cannot restore those that were not numbers before: {}.",
                    others.join(", ")
                ),
            };
            return Ok(Adjustment {
                holds: ControllerValues::New,
                old,
                problem: None,
                advice,
            });
        }
        Ok(wrong) => format!(
            "These values do not read back as written: {}.",
            wrong.join(", ")
        ),
        Err(error) => format!("Writing stopped: {error}."),
    };
    Ok(roll_back(controller, old, problem))
}

/// As [`write_adjustment`]; if the connection breaks, it is re-established without arming, and the values are read until two
/// results agree, because writes sent before may still arrive late. A mixture of old and new values is left
/// for [`settle_adjustment`].
///
/// # Errors
/// As [`write_adjustment`]: nothing was written.
pub fn write_adjustment_reconnecting(
    controller: &mut dyn Controller,
    new: &[(String, f64)],
    policy: &mut dyn ReconnectPolicy,
) -> Result<Adjustment, LinkError> {
    let written = write_adjustment(controller, new)?;
    if written.holds != ControllerValues::Unknown {
        return Ok(written);
    }
    let mut last = None;
    for _ in 0..MAX_ATTEMPTS {
        if let Err(error) = policy.restore(controller) {
            let problem = written.problem.unwrap_or_default();
            let problem = format!("{problem} Reconnecting failed: {error}.");
            return Ok(Adjustment {
                problem: Some(problem.trim().to_owned()),
                ..written
            });
        }
        // If the connection is lost again before anything could be read, another attempt is made.
        let found = check_values(controller, &written.old, new).ok();
        if let Some(holds) = found.clone().filter(|_| found == last) {
            return Ok(Adjustment {
                advice: found_advice(&holds),
                holds,
                ..written
            });
        }
        last = found;
        policy.pause();
    }
    Ok(written)
}

/// Determines the state of the values after `new` values may have replaced `old` ones.
///
/// # Errors
/// If the values cannot be read.
pub fn check_values(
    controller: &mut dyn Controller,
    old: &[(String, f64)],
    new: &[(String, f64)],
) -> Result<ControllerValues, LinkError> {
    if differing(controller, new)?.is_empty() {
        return Ok(ControllerValues::New);
    }
    let others = differing(controller, old)?;
    Ok(match others.is_empty() {
        true => ControllerValues::Old,
        false => ControllerValues::Mixed(others),
    })
}

/// Advice on the values found after the connection was lost.
fn found_advice(holds: &ControllerValues) -> String {
    match holds {
        ControllerValues::New => "All new values arrived before the connection was lost: verify them with a verification run.".to_owned(),
        ControllerValues::Old => OLD_VALUES.to_owned(),
        ControllerValues::Mixed(names) => format!(
            "Do not move the robot: {} of its values are not the old ones. Arm the controller again to bring the old values back.",
            names.len()
        ),
        ControllerValues::Unknown => UNKNOWN_VALUES.to_owned(),
    }
}

/// Settles an interrupted attempt to replace `old` values by `new` ones. If all are new or
/// all are old, nothing changes; in a mixture the old ones are restored, for which the controller must be armed.
///
/// # Errors
/// If the values cannot be read.
pub fn settle_adjustment(
    controller: &mut dyn Controller,
    old: &[(String, f64)],
    new: &[(String, f64)],
) -> Result<Adjustment, LinkError> {
    let problem = "Writing was interrupted before.".to_owned();
    let found = check_values(controller, old, new)?;
    if matches!(found, ControllerValues::Mixed(_)) && controller.state().armed {
        return Ok(roll_back(controller, old.to_vec(), problem));
    }
    Ok(Adjustment {
        advice: found_advice(&found),
        holds: found,
        old: old.to_vec(),
        problem: Some(problem),
    })
}

/// Restores the old values.
fn roll_back(
    controller: &mut dyn Controller,
    old: Vec<(String, f64)>,
    problem: String,
) -> Adjustment {
    let others = not_numbers(&old);
    let numbers = old.iter().filter(|(_, value)| value.is_finite());
    let numbers: Vec<(String, f64)> = numbers.cloned().collect();
    let (holds, advice) = match write_and_compare(controller, &numbers) {
        Ok(wrong) if wrong.is_empty() && others.is_empty() => {
            (ControllerValues::Old, OLD_VALUES.to_owned())
        }
        Ok(wrong) if wrong.is_empty() => {
            let list = others.join(", ");
            let advice = format!(
                "The controller holds its old values, except for those that were not numbers and cannot be written: {list}."
            );
            (ControllerValues::Old, advice)
        }
        Ok(wrong) => {
            let list = former(&numbers, &wrong);
            let advice = format!(
                "Do not move the robot: set these values at the controller by hand: {list}."
            );
            (ControllerValues::Mixed(wrong), advice)
        }
        Err(error) => after_failed_rollback(controller, &numbers, &error),
    };
    Adjustment {
        holds,
        old,
        problem: Some(problem),
        advice,
    }
}

/// Names of the values that are not numbers, which cannot be written.
fn not_numbers(values: &[(String, f64)]) -> Vec<String> {
    let odd = values.iter().filter(|(_, value)| !value.is_finite());
    odd.map(|(name, _)| name.clone()).collect()
}

/// Values for setting by hand, with all digits, so that the controller holds the same numbers again.
fn former(old: &[(String, f64)], names: &[String]) -> String {
    let wanted = old.iter().filter(|(name, _)| names.contains(name));
    let list: Vec<String> = wanted
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    list.join(", ")
}

/// State of the values when the old ones could not be written; reading may still work.
fn after_failed_rollback(
    controller: &mut dyn Controller,
    old: &[(String, f64)],
    error: &LinkError,
) -> (ControllerValues, String) {
    match differing(controller, old) {
        Ok(wrong) if wrong.is_empty() => (ControllerValues::Old, OLD_VALUES.to_owned()),
        Ok(wrong) => {
            let list = former(old, &wrong);
            let advice = format!(
                "Do not move the robot: the old values could not be written ({error}). Write them again, or set them at the controller by hand: {list}."
            );
            (ControllerValues::Mixed(wrong), advice)
        }
        Err(_) => (ControllerValues::Unknown, UNKNOWN_VALUES.to_owned()),
    }
}

fn write_and_compare(
    controller: &mut dyn Controller,
    values: &[(String, f64)],
) -> Result<Vec<String>, LinkError> {
    controller.write(values)?;
    let differing = differing(controller, values)?;
    controller.confirm_alone()?;
    Ok(differing)
}

/// Names of the values that the controller does not hold.
fn differing(
    controller: &mut dyn Controller,
    values: &[(String, f64)],
) -> Result<Vec<String>, LinkError> {
    let names: Vec<String> = values.iter().map(|(name, _)| name.clone()).collect();
    let held = controller.read(&names)?;
    let held = held.into_iter().map(Some).chain(std::iter::repeat(None));
    let pairs = values.iter().zip(held);
    let wrong = pairs.filter(|((_, value), held)| !held.is_some_and(|held| is_held(held, *value)));
    Ok(wrong.map(|((name, _), _)| name.clone()).collect())
}

fn is_held(held: f64, value: f64) -> bool {
    if !value.is_finite() {
        return !held.is_finite();
    }
    (held - value).abs() <= TOLERANCE + RELATIVE_TOLERANCE * value.abs()
}

#[cfg(test)]
mod tests;

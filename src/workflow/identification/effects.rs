//! The effects of a model in words.

use tautline_core::effect::{BoundEffect, EffectSetting, find};
use tautline_core::estimation::ParameterId;
use tautline_core::robot::Robot;

use super::Identification;
use crate::wording::list;
use crate::wording::units::{significant, unit_of, with_sd};

/// Whether two settings are of the same effect on the same cables at the same pose, whatever its size.
#[must_use]
pub fn same_effect(one: &EffectSetting, other: &EffectSetting) -> bool {
    let pose = |setting: &EffectSetting| {
        let effect = find(&setting.effect)?;
        let name = effect.parameters()[effect.pose_parameter()?].name;
        setting.parameters.get(name).copied()
    };
    one.effect == other.effect && one.targets == other.targets && pose(one) == pose(other)
}

/// Title of settings of one effect, of the catalogue or a hypothesis of the robot, with their cables:
/// `Winch scale (cable-1 and cable-3)`.
#[must_use]
pub fn effects_title(robot: &Robot, settings: &[EffectSetting]) -> String {
    let id = settings
        .first()
        .map_or("", |setting| setting.effect.as_str());
    let name = robot.effect(id).map_or(id, |effect| effect.title());
    let targets: Vec<String> = settings.iter().flat_map(|s| s.targets.clone()).collect();
    if targets.is_empty() {
        name.to_owned()
    } else {
        format!("{name} ({})", list(&targets))
    }
}

/// The model without each of its effects, and without the deviations of its parts; each with the name of the omitted part.
#[must_use]
pub fn without_each_effect(model: &Robot) -> Vec<(String, Robot)> {
    let effects = model.effects.iter().enumerate().map(|(index, setting)| {
        let mut without = model.clone();
        without.effects.remove(index);
        (effects_title(model, std::slice::from_ref(setting)), without)
    });
    let mut without = model.clone();
    without.deviations.clear();
    let deviations = "deviations of parts within their tolerances".to_owned();
    let deviations = (!model.deviations.is_empty()).then_some((deviations, without));
    effects.chain(deviations).collect()
}

/// The identified sizes of settings of one effect, `0.31 ± 0.04 %`, each with its cable if there are several.
#[must_use]
pub fn effect_sizes(fit: &Identification, settings: &[EffectSetting]) -> Vec<String> {
    let sized = settings.iter().map(|setting| match &setting.targets[..] {
        targets if targets.is_empty() || settings.len() == 1 => size(fit, setting),
        targets => format!("{}: {}", list(targets), size(fit, setting)),
    });
    sized.collect()
}

fn size(fit: &Identification, setting: &EffectSetting) -> String {
    let robot = &fit.dataset.robot;
    let effects = fit.solution.globals.effects.iter().enumerate();
    let mut same = effects.filter(|(_, bound)| same_effect(&bound.setting(robot), setting));
    let Some((index, bound)) = same.next_back() else {
        return "acts at no pose of these data".to_owned();
    };
    if bound.values.is_empty() {
        return "as found; there is nothing to estimate".to_owned();
    }
    let values: Vec<_> = (0..bound.values.len())
        .map(|k| value(fit, index, bound, k))
        .collect();
    values.join(", ")
}

fn value(fit: &Identification, index: usize, bound: &BoundEffect, which: usize) -> String {
    let parameter = &bound.effect.parameters()[which];
    let number = bound.values[which];
    let is_it = |id: &ParameterId| match *id {
        ParameterId::Effect { effect, parameter } => {
            fit.held + effect == index && parameter == which
        }
        _ => false,
    };
    let place = fit.solution.parameters.iter().position(|p| is_it(&p.id));
    let unit = unit_of(parameter.name, parameter.unit);
    let size = match place.map(|place| fit.solution.standard_deviation(place)) {
        Some(sd) => with_sd(number, sd.unwrap_or(f64::NAN), unit),
        None => significant(number, 6),
    };
    match bound.values.len() {
        1 => size,
        _ => format!("{} {size}", parameter.name.replace('_', " ")),
    }
}

//! Effects of a model that a controller cannot hold, and the resulting position error.

use tautline_core::effect::EffectSetting;
use tautline_core::robot::Robot;
use tautline_core::simulation::{
    Epoch, QuasiStaticRobot, TensionRange, Workspace, ambient_temperature_c,
};
use tautline_link::adjusting::Difference;
use tautline_link::parameters::EffectName;
use tautline_link::verifying::cube_poses;

use super::{Doubt, DoubtKind};
use crate::wording::list;
use crate::wording::units::{quantity, significant, unit_of};

/// Mean error below which a controller needs no parameter (m): the effect acts on readings alone, to rounding.
const EXACT_M: f64 = 1e-6;

/// The effects of a model for which a controller has no parameters, except for damage, which is repaired.
#[must_use]
pub fn unsupported_effects<'a>(
    model: &'a Robot,
    differences: &[Difference],
) -> Vec<&'a EffectSetting> {
    let lacking = differences.iter().filter(|line| line.controller.is_none());
    let lacking: Vec<EffectName<'_>> = lacking
        .filter_map(|line| EffectName::read(&line.name))
        .collect();
    let lasts = |setting: &EffectSetting| {
        let effect = model.effect(&setting.effect);
        effect.is_none_or(|effect| !effect.is_damage())
    };
    let effects = model.effects.iter();
    let effects = effects.filter(|setting| lacking.iter().any(|name| name.is_of(setting)));
    effects.filter(|setting| lasts(setting)).collect()
}

/// The doubt about values that were identified together with effects for which the controller has no parameters; `None` if the
/// platform moves equally well without these effects.
#[must_use]
pub fn unsupported(model: &Robot, differences: &[Difference]) -> Option<Doubt> {
    let effects = unsupported_effects(model, differences);
    if effects.is_empty() {
        return None;
    }
    let mut without = model.clone();
    without
        .effects
        .retain(|setting| !effects.contains(&setting));
    let error_m = error_without(model, &without);
    if error_m.is_some_and(|error_m| error_m < EXACT_M) {
        return None;
    }
    let names: Vec<String> = effects
        .iter()
        .map(|setting| sized(model, setting))
        .collect();
    let them = if names.len() == 1 { "it" } else { "them" };
    let errs = match error_m {
        Some(error_m) => format!("errs by {} mm on average", significant(error_m * 1e3, 2)),
        None => "errs by what cannot be computed here".to_owned(),
    };
    let text = format!(
        "The pulleys were identified together with {}, which this controller cannot hold; without {them} the platform {errs}",
        list(&names)
    );
    Some(Doubt::new(DoubtKind::Unsupported, text))
}

/// `Winch scale (cable-3) of 2.01 %`.
fn sized(model: &Robot, setting: &EffectSetting) -> String {
    let effect = model.effect(&setting.effect);
    let title = effect.map_or(setting.effect.as_str(), |effect| effect.title());
    let title = match setting.targets.as_slice() {
        [] => title.to_owned(),
        targets => format!("{title} ({})", list(targets)),
    };
    let size = effect.and_then(|effect| {
        let mut parameters = effect.parameters().iter().enumerate();
        let (_, size) = parameters.find(|(k, _)| effect.is_size(*k))?;
        let value = setting.parameters.get(size.name)?;
        Some(quantity(*value, unit_of(size.name, size.unit)))
    });
    size.map_or(title.clone(), |size| format!("{title} of {size}"))
}

/// Mean error of the platform at the test poses of a verification if the controller computes the revolutions with another model
/// (m); `None` if it reaches none of the poses.
fn error_without(model: &Robot, controller: &Robot) -> Option<f64> {
    let home = model.home?.pose();
    let range = TensionRange::of(model);
    let epoch = |label| Epoch {
        label,
        time_s: 0.0,
        temperature_c: ambient_temperature_c(0.0),
    };
    let standing = |robot: &Robot| QuasiStaticRobot::new(robot.clone(), range, epoch(0)).ok();
    let (real, believed) = (standing(model)?, standing(controller)?);
    let error_m = |pose| {
        let wanted = believed.at(epoch(1), &home, pose).ok()?;
        let revolutions = wanted.readings.revolutions.row(0);
        let rest = real
            .at_revolutions(epoch(1), &home, (revolutions, pose))
            .ok()?;
        Some((rest.pose.position - pose.position).norm())
    };
    let targets = cube_poses(model, &Workspace::of(model));
    let errors: Vec<f64> = targets
        .iter()
        .filter_map(|target| error_m(&target.pose))
        .collect();
    (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;
    use tautline_link::adjusting::plan_adjustment;
    use tautline_link::parameters::parameters_of;

    use super::*;

    #[test]
    fn an_effect_that_moves_the_platform_is_missed_by_so_much() {
        let nominal = presets::find("mini").expect("a preset").robot;
        let held = parameters_of(&nominal);
        let doubt = |effect: &str, target: &[&str], value: f64| {
            let mut model = nominal.clone();
            model.effects = vec![EffectSetting {
                effect: effect.to_owned(),
                targets: target.iter().map(|name| (*name).to_owned()).collect(),
                parameters: [("scale".to_owned(), value)].into(),
            }];
            unsupported(&model, &plan_adjustment(&held, &model, None))
        };
        let found = doubt("winch_scale", &["cable-3"], 0.0201).expect("a doubt");
        assert_eq!(found.kind, DoubtKind::Unsupported);
        let text = found.sentence;
        assert!(
            text.contains("together with Winch scale (cable-3) of 2.01 %"),
            "{text}"
        );
        let errs = text
            .split("errs by ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next());
        let mm: f64 = errs.expect("a number").parse().expect("a number");
        // One of eight cables is 2 % of some 0.2 m too long, and the others limit the error.
        assert!((0.3..4.0).contains(&mm), "{text}");
        // The controller does not use the laser.
        assert_eq!(doubt("laser_scale", &[], 0.01), None);
    }
}

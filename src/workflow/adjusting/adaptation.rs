//! Adaptation of identified values to a controller that cannot hold all effects of the model.

use tautline_core::effect::EffectSetting;
use tautline_core::projection::ExpectedLengths;
use tautline_core::robot::Robot;
use tautline_core::simulation::Workspace;
use tautline_link::adjusting::Difference;
use tautline_link::parameters::{EffectName, parameters_and_home_lengths, set_parameter};

use super::{Doubt, DoubtKind};
use crate::wording::list;
use crate::wording::parameters::cable_of;
use crate::wording::units::{quantity, significant, unit_of};

/// Error below which a controller needs no parameter (m): the effect acts on readings alone, to rounding.
const EXACT_M: f64 = 1e-6;
/// Share of the error up to which values make up for all of it: the size of an effect is seldom known to a hundredth.
const MADE_UP_FOR: f64 = 0.01;
/// Number of poses of the workspace at which the error is computed.
const POSES: usize = 40;
/// Distance by which an entry point may be moved (m): more than the effects of the catalogue displace it.
const POINT_RANGE_M: f64 = 0.1;
/// Relative change of a drum: an effect is an error of a few percent.
const DRUM_RANGE: f64 = 0.1;

/// Values that make up for the effects that a controller cannot hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Adaptation {
    /// The effects, the error without them, and what the values leave of it: one sentence without full stop.
    pub sentence: String,
    /// Position error without the effects and with these values (m), root mean square over the workspace; `None` if they cannot be
    /// computed.
    pub errors_m: Option<[f64; 2]>,
}

impl Adaptation {
    /// The doubt about a pose accuracy that the values do not restore.
    #[must_use]
    pub fn doubt(&self) -> Option<Doubt> {
        let is_exact =
            (self.errors_m).is_some_and(|[before_m, after_m]| is_exact(before_m, after_m));
        (!is_exact).then(|| Doubt::new(DoubtKind::Unsupported, self.sentence.as_str()))
    }
}

fn is_exact(before_m: f64, after_m: f64) -> bool {
    after_m < EXACT_M.max(MADE_UP_FOR * before_m)
}

/// The effects of a model for which a controller has no parameters, except for damage, which is repaired.
pub(super) fn unsupported_effects<'a>(
    model: &'a Robot,
    lines: &[Difference],
) -> Vec<&'a EffectSetting> {
    let lacking = lines.iter().filter(|line| line.controller.is_none());
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

/// Gives the entry points and drums that a controller holds the values with which the platform errs least without the effects
/// that it cannot hold; `None`, and nothing is changed, if the platform moves equally well without these effects.
pub(super) fn adapt(
    model: &Robot,
    effects: &[&EffectSetting],
    lines: &mut [Difference],
) -> Option<Adaptation> {
    if effects.is_empty() {
        return None;
    }
    let names: Vec<String> = effects
        .iter()
        .map(|setting| sized(model, setting))
        .collect();
    let what = format!("This controller cannot hold {}", list(&names));
    let them = if names.len() == 1 { "it" } else { "them" };
    let Some((before_m, adapted, after_m)) = best(model, effects, lines) else {
        return Some(Adaptation {
            sentence: format!(
                "{what}; how far the platform errs without {them} cannot be computed"
            ),
            errors_m: None,
        });
    };
    if before_m < EXACT_M {
        return None;
    }
    let values = parameters_and_home_lengths(&adapted);
    for line in lines {
        let value = values.iter().find(|value| value.name == line.name);
        if let Some((value, held)) = value.map(|value| value.value).zip(line.controller) {
            line.identified = Some(value);
            line.difference = Some(value - held);
        }
    }
    let mm = |metres: f64| format!("{} mm", significant(metres * 1e3, 2));
    let rest = match after_m {
        rest_m if is_exact(before_m, rest_m) => String::new(),
        rest_m => format!(" but for {}", mm(rest_m)),
    };
    Some(Adaptation {
        sentence: format!(
            "{what}; without {them} the platform would err by {}, for which the entry points and drums here make up{rest}",
            mm(before_m)
        ),
        errors_m: Some([before_m, after_m]),
    })
}

/// Sets what each value that is written gains, for a controller that cannot hold these effects of the model.
pub(super) fn set_gains(model: &Robot, effects: &[&EffectSetting], lines: &mut [Difference]) {
    let Ok(expected) = ExpectedLengths::of(model, Workspace::of(model), POSES) else {
        return;
    };
    let mut written = model.clone();
    written.effects.retain(|one| !effects.contains(&one));
    for line in lines.iter() {
        if let Some(value) = line.identified.filter(|_| line.is_writable_change()) {
            // A parameter that the model lacks has its neutral value there.
            let _ = set_parameter(&mut written, &line.name, value);
        }
    }
    let Ok(after_m) = expected.position_error_m(&written) else {
        return;
    };
    for line in lines.iter_mut().filter(|line| line.is_writable_change()) {
        let mut without = written.clone();
        let held = line.controller.unwrap_or(f64::NAN);
        let is_held = set_parameter(&mut without, &line.name, held).is_ok();
        let error_m = is_held.then(|| expected.position_error_m(&without).ok());
        line.gain_m = error_m.flatten().map(|error_m| error_m - after_m);
    }
}

/// The error of a controller that holds the model without some effects (m), the robot that errs least among those that it could
/// hold, and the error of that one; `None` if the model cannot be evaluated.
fn best(
    model: &Robot,
    effects: &[&EffectSetting],
    lines: &[Difference],
) -> Option<(f64, Robot, f64)> {
    let mut without = model.clone();
    without.effects.retain(|one| !effects.contains(&one));
    let expected = ExpectedLengths::of(model, Workspace::of(model), POSES).ok()?;
    // The length of a cable depends on its own pulley and drum alone.
    let is_concerned = |line: &Difference| {
        let cable = cable_of(&model.cables, &line.name);
        let cable = cable.map(|index| &model.cables[index].name);
        let mut targets = effects.iter().map(|one| &one.targets);
        cable.is_some_and(|cable| targets.any(|of| of.is_empty() || of.contains(cable)))
    };
    let free = lines.iter().filter_map(|line| {
        let start = line.identified.filter(|_| line.controller.is_some())?;
        let is_point = line.name.contains(".entry_point.");
        let is_drum = line.name.ends_with(".winch.drum_diameter_m");
        let range = match is_point {
            true => POINT_RANGE_M,
            false => DRUM_RANGE * start,
        };
        let is_free = (is_point || is_drum) && is_concerned(line);
        is_free.then_some((line.name.as_str(), start, range))
    });
    let free: Vec<(&str, f64, f64)> = free.collect();
    let robot = |values: &[f64]| {
        let mut robot = without.clone();
        for ((name, ..), value) in free.iter().zip(values) {
            set_parameter(&mut robot, name, *value).ok()?;
        }
        Some(robot)
    };
    let (start, ranges): (Vec<f64>, Vec<f64>) =
        free.iter().map(|(_, start, range)| (start, range)).unzip();
    let adapted = robot(&expected.project(&robot, &start, &ranges))?;
    let [before_m, after_m] =
        [&without, &adapted].map(|robot| expected.position_error_m(robot).ok());
    Some((before_m?, adapted, after_m?))
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

#[cfg(test)]
mod tests {
    use tautline_core::geometry::Pose;
    use tautline_core::robot::presets;
    use tautline_core::simulation::{Epoch, QuasiStaticRobot, TensionRange};
    use tautline_link::adjusting::plan_adjustment;
    use tautline_link::parameters::parameters_of;
    use tautline_link::verifying::cube_poses;

    use super::*;

    fn adapted(
        effect: &str,
        target: &[&str],
        parameters: &[(&str, f64)],
        has: &dyn Fn(&str) -> bool,
    ) -> (Option<Adaptation>, Vec<Difference>) {
        let nominal = presets::find("mini").expect("a preset").robot;
        let mut held = parameters_of(&nominal);
        held.retain(|parameter| has(&parameter.name));
        let mut model = nominal;
        model.effects = vec![EffectSetting {
            effect: effect.to_owned(),
            targets: target.iter().map(|name| (*name).to_owned()).collect(),
            parameters: (parameters.iter())
                .map(|(name, value)| ((*name).to_owned(), *value))
                .collect(),
        }];
        let mut lines = plan_adjustment(&held, &model, None);
        let effects: Vec<&EffectSetting> = unsupported_effects(&model, &lines);
        (adapt(&model, &effects, &mut lines), lines)
    }

    /// Distances from the test poses at which a platform comes to rest in equilibrium (m), root mean square, if the controller
    /// computes the revolutions with another model.
    fn simulated_error_m(machine: &Robot, controller: &Robot) -> f64 {
        let home = machine.home.expect("a home pose").pose();
        let range = TensionRange::of(machine);
        let epoch = |label| Epoch {
            label,
            time_s: 0.0,
            temperature_c: 20.0,
        };
        let [real, believed] = [machine, controller]
            .map(|robot| QuasiStaticRobot::new(robot.clone(), range, epoch(0)).expect("a robot"));
        let targets = cube_poses(controller, &Workspace::of(controller));
        let square = |pose: &Pose| {
            let commanded = believed.at(epoch(1), &home, pose).expect("a pose");
            let revolutions = commanded.readings.revolutions.row(0);
            let rest = real.at_revolutions(epoch(1), &home, (revolutions, pose));
            let rest = rest.expect("an equilibrium").pose;
            (rest.position - pose.position).norm_squared()
        };
        let square_sum: f64 = targets.iter().map(|target| square(&target.pose)).sum();
        (square_sum / targets.len() as f64).sqrt()
    }

    fn change(lines: &[Difference], name: &str) -> f64 {
        let line = lines.iter().find(|line| line.name == name);
        line.and_then(|line| line.difference).expect("a difference")
    }

    #[test]
    fn a_drum_makes_up_for_the_scale_of_its_winch() {
        let scale = [("scale", 0.0201)];
        let (found, lines) = adapted("winch_scale", &["cable-3"], &scale, &|_| true);
        let found = found.expect("an adaptation");
        assert_eq!(found.doubt(), None);
        assert!(
            (found.sentence).contains(
                "cannot hold Winch scale (cable-3) of 2.01 %; without it the platform would err by"
            ),
            "{}",
            found.sentence
        );
        let drum = "cable-3.winch.drum_diameter_m";
        let held = lines.iter().find(|line| line.name == drum);
        let held = held.and_then(|line| line.controller).expect("a drum");
        let relative = change(&lines, drum) / held;
        assert!((relative.abs() - 0.0201).abs() < 5e-4, "{relative}");
        let others = lines.iter().filter(|line| line.is_writable_change());
        assert!(
            others.clone().all(|line| line.name.starts_with("cable-3.")),
            "{others:?}"
        );
    }

    #[test]
    fn the_error_is_that_of_a_simulated_machine() {
        let nominal = presets::find("mini").expect("a preset").robot;
        let mut model = nominal.clone();
        model.effects = vec![EffectSetting {
            effect: "drum_eccentricity".to_owned(),
            targets: vec!["cable-2".to_owned()],
            parameters: [("amplitude".to_owned(), 5e-4), ("phase".to_owned(), 0.5)].into(),
        }];
        let lines = plan_adjustment(&parameters_of(&nominal), &model, None);
        let (before_m, adapted, after_m) =
            best(&model, &[&model.effects[0]], &lines).expect("errors");
        for (robot, error_m) in [(&nominal, before_m), (&adapted, after_m)] {
            let simulated_m = simulated_error_m(&model, robot);
            assert!(
                (0.5..2.0).contains(&(simulated_m / error_m)),
                "{simulated_m} {error_m}"
            );
        }
        assert!(after_m < before_m);
    }

    #[test]
    fn the_gain_of_a_value_is_the_error_of_a_simulated_machine_without_it() {
        let nominal = presets::find("mini").expect("a preset").robot;
        let mut model = nominal.clone();
        model.cables[0].pulley.entry_point_m[0] += 5e-3;
        model.cables[4].pulley.entry_point_m[2] += 2e-4;
        let mut lines = plan_adjustment(&parameters_of(&nominal), &model, None);
        set_gains(&model, &[], &mut lines);
        let gains: Vec<(&Difference, f64)> = lines
            .iter()
            .filter_map(|line| Some((line, line.gain_m?)))
            .collect();
        let names = gains.iter().map(|(line, _)| line.name.as_str());
        let expected = ["cable-1.entry_point.x_m", "cable-5.entry_point.z_m"];
        assert_eq!(names.collect::<Vec<_>>(), expected);
        for (line, gain_m) in gains {
            let mut without = model.clone();
            let held = line.controller.expect("a value");
            set_parameter(&mut without, &line.name, held).expect("set");
            let simulated_m = simulated_error_m(&model, &without);
            assert!(
                (0.5..2.0).contains(&(simulated_m / gain_m)),
                "{}: {simulated_m} {gain_m}",
                line.name
            );
        }
    }

    #[test]
    fn what_no_value_makes_up_for_is_a_doubt() {
        let scale = [("scale", 0.0201)];
        let has = |name: &str| !name.contains(".winch.");
        let (found, _) = adapted("winch_scale", &["cable-3"], &scale, &has);
        let found = found.expect("an adaptation");
        let [_, rest_m] = found.errors_m.expect("errors");
        assert!((EXACT_M..1e-3).contains(&rest_m), "{rest_m}");
        let doubt = found.doubt().expect("a doubt");
        assert!(
            doubt.sentence.contains("make up but for 0."),
            "{}",
            doubt.sentence
        );
        // Without any of its values, the error is the whole one: 2 % of some 0.2 m of one of eight cables.
        let (found, lines) = adapted("winch_scale", &["cable-3"], &scale, &|name| {
            name.starts_with("home")
        });
        let [_, whole_m] = found.expect("an adaptation").errors_m.expect("errors");
        assert!(
            whole_m > rest_m && (3e-4..4e-3).contains(&whole_m),
            "{whole_m}"
        );
        assert!(lines.iter().all(|line| !line.is_writable_change()));
    }

    #[test]
    fn a_controller_needs_no_parameter_of_the_laser() {
        let (found, lines) = adapted("laser_scale", &[], &[("scale", 0.01)], &|_| true);
        assert_eq!(found, None);
        assert!(lines.iter().all(|line| !line.is_writable_change()));
    }
}

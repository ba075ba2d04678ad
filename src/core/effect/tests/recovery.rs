//! Recovery of hidden effects with known geometry and instruments so precise that priors do not matter.

use crate::effect::{CATALOGUE, EffectRequest, EffectSetting, Scope, find};
use crate::estimation::{Control, Method, Options, Problem, solve};
use crate::robot::{Inclinometer, PerAxis, Robot, presets};
use crate::simulation::{Simulated, SimulationOptions, TrueGeometry, simulate};

/// Instruments are better than those of the preset by this factor.
const BETTER: f64 = 1e-4;

/// A preset with swivel encoders and an inclinometer, its geometry exactly known.
pub(crate) fn equipped(name: &str) -> Robot {
    let mut robot = presets::find(name).unwrap().robot;
    for cable in &mut robot.cables {
        cable.pulley.entry_point_sd_m = PerAxis::known(0.0);
        cable.pulley.swivel_zero = Some([1.0, 0.0, 0.0]);
        cable.pulley.swivel_sd_rad = Some(2e-3 * BETTER);
        cable.winch.length_sd_m *= BETTER;
        if let Some(sensor) = &mut cable.force_sensor {
            sensor.tension_sd_n *= BETTER;
        }
    }
    robot.inclinometer = Some(Inclinometer {
        sd_rad: 1e-3 * BETTER,
    });
    if let Some(laser) = &mut robot.laser {
        laser.sd_m *= BETTER;
        laser.target_plane.offset_sd_m = Some(0.0);
    }
    if let Some(home) = &mut robot.home {
        home.position_sd_m = 0.0;
        home.orientation_sd_rad = 0.0;
    }
    robot
}

/// A run of a robot whose geometry is as drawn.
pub(super) fn hide(robot: &Robot, settings: &[EffectSetting]) -> Simulated {
    hide_in(robot, settings, TrueGeometry::Nominal)
}

fn hide_in(robot: &Robot, settings: &[EffectSetting], geometry: TrueGeometry) -> Simulated {
    let preset = presets::find(&robot.name).unwrap();
    let options = SimulationOptions {
        geometry,
        noise: false,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        effects: settings.to_vec(),
        ..SimulationOptions::new(40, 11)
    };
    simulate(robot, &options).unwrap()
}

/// A request for the hidden effect; given parameters keep their values, and a period starts 2 % off its value.
pub(super) fn request(setting: &EffectSetting) -> EffectRequest {
    let effect = find(&setting.effect).unwrap();
    let given = effect.parameters().iter().filter_map(|p| {
        let value = setting.parameters[p.name];
        match p.name {
            // 2 % off: within a fraction of a period over the range of distances.
            "period" => Some((p.name.to_owned(), value * 1.02)),
            _ if p.discrete => Some((p.name.to_owned(), value)),
            _ => None,
        }
    });
    EffectRequest {
        effect: setting.effect.clone(),
        cables: setting.targets.clone(),
        values: given.collect(),
    }
}

/// Frees the hidden effect and compares its values, with this relative tolerance.
pub(super) fn check_run(
    run: &Simulated,
    settings: &[EffectSetting],
    method: Method,
    tolerance: f64,
) {
    let requests: Vec<_> = settings.iter().map(request).collect();
    let mut problem = Problem::new(&run.dataset).unwrap().with_method(method);
    problem.free(&requests).unwrap();
    let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue).unwrap();
    let ended = solution.termination;
    assert!(
        solution.converged(),
        "{settings:?}: {ended:?}, chi2 {:e}",
        solution.chi2
    );
    for (setting, found) in settings.iter().zip(&solution.globals.effects) {
        for (parameter, value) in found.effect.parameters().iter().zip(&found.values) {
            let truth = setting.parameters[parameter.name];
            assert!(
                (value - truth).abs() <= tolerance * truth.abs(),
                "{} {}: {value} instead of {truth}",
                setting.effect,
                parameter.name
            );
        }
    }
}

fn check(robot: &Robot, setting: &EffectSetting, method: Method) {
    let settings = [setting.clone()];
    let run = hide(robot, &settings);
    check_run(&run, &settings, method, 1e-6);
}

/// A value in the middle of the typical range; for a vector, components that differ.
pub(crate) fn typical(id: &str) -> EffectSetting {
    let effect = find(id).unwrap();
    let parameters = effect.parameters().iter().enumerate().map(|(k, p)| {
        let [low, high] = p.typical;
        let share = 0.32 + 0.1 * k as f64;
        let value = match p.name {
            "pose" => 17.0,
            "period" => 0.1,
            // No cable moves by less than the play from one pose to the next of these.
            "play" => low,
            _ => low + share * (high - low),
        };
        (p.name.to_owned(), value)
    });
    let targeted = effect.scope() == Scope::Cable;
    EffectSetting {
        effect: id.to_owned(),
        targets: targeted.then(|| "cable-3".to_owned()).into_iter().collect(),
        parameters: parameters.collect(),
    }
}

/// No exceptions: with all else known even the laser's bias and the target plane can be told apart.
#[test]
fn every_effect_comes_back() {
    let robot = equipped("mini");
    for effect in CATALOGUE.iter().filter(|e| e.is_estimable()) {
        check(&robot, &typical(effect.id()), Method::Joint);
    }
}

#[test]
fn effects_that_need_no_equilibrium_come_back_by_the_simple_method() {
    let robot = equipped("mini");
    for effect in CATALOGUE.iter().filter(|e| e.is_estimable()) {
        let id = effect.id();
        let seen_by_balance = ["payload_mass", "payload_com"].contains(&id);
        if !seen_by_balance {
            check(&robot, &typical(id), Method::Simple);
        }
    }
}

#[test]
fn effects_come_back_in_other_robots() {
    for (name, ids) in [
        (
            "suspended",
            &["cable_sag", "payload_mass", "frame_thermal", "force_gain"][..],
        ),
        (
            "planar",
            &[
                "payload_mass",
                "pulley_friction",
                "encoder_drift",
                "frame_compliance",
            ],
        ),
        (
            "hall",
            &[
                "cable_stiffening",
                "force_bias",
                "laser_beam_tilt",
                "inclinometer_tilt",
            ],
        ),
    ] {
        let robot = equipped(name);
        for id in ids {
            check(&robot, &typical(id), Method::Joint);
        }
    }
}

#[test]
fn effects_come_back_from_absolute_lengths() {
    let mut robot = equipped("mini");
    robot.home = None;
    for id in [
        "winch_scale",
        "winch_offset",
        "cable_slip",
        "cable_thermal",
        "frame_shift",
        "laser_drift",
        "platform_anchor",
    ] {
        check(&robot, &typical(id), Method::Joint);
    }
}

/// Effects that act on the same quantities, in another order than they were hidden in.
#[test]
fn several_effects_at_once_come_back() {
    let robot = equipped("mini");
    let hidden: Vec<EffectSetting> = [
        "winch_offset",
        "winch_scale_common",
        "force_bias",
        "force_gain",
        "payload_mass",
        "laser_bias",
        "laser_scale",
        "cable_slip",
    ]
    .map(typical)
    .to_vec();
    let run = hide(&robot, &hidden);
    let reversed: Vec<_> = hidden.into_iter().rev().collect();
    check_run(&run, &reversed, Method::Joint, 1e-6);
}

/// Wrap angles and directions of force are those of the drawing at the commanded poses. With pulleys some
/// 8 mm, and poses as much, beside it the approximation costs less than a percent of these effects.
#[test]
fn the_nominal_geometry_is_good_enough_for_friction_and_frame() {
    let mut robot = equipped("mini");
    for cable in &mut robot.cables {
        cable.pulley.entry_point_sd_m = PerAxis::known(8e-3);
    }
    for id in ["pulley_friction", "frame_compliance"] {
        let settings = [typical(id)];
        let run = hide_in(&robot, &settings, TrueGeometry::Drawn);
        check_run(&run, &settings, Method::Joint, 0.01);
    }
}

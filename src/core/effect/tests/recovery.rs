//! Hidden effects come back: the geometry known, instruments so good that priors do not count.

use crate::effect::{BoundEffect, CATALOGUE, EffectRequest, EffectSetting};
use crate::estimation::{Control, Method, Options, Problem, solve};
use crate::robot::{Inclinometer, PerAxis, Robot, presets};
use crate::simulation::{Simulated, SimulationOptions, TrueGeometry, simulate};

/// Instruments are better than those of the preset by this factor.
const BETTER: f64 = 1e-4;

/// MINI with swivel encoders and an inclinometer, its geometry exactly known.
fn equipped() -> Robot {
    let mut robot = presets::find("mini").unwrap().robot;
    for cable in &mut robot.cables {
        cable.pulley.entry_point_sd_m = Some(PerAxis::Same(0.0));
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

fn hide(robot: &Robot, setting: &EffectSetting, poses: usize, seed: u64) -> Simulated {
    let preset = presets::find("mini").unwrap();
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        noise: false,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        effects: vec![setting.clone()],
        ..SimulationOptions::new(poses, seed)
    };
    simulate(robot, &options).unwrap()
}

/// Frees the effect that was hidden; what is given is given, as is the start of a period.
fn freed(run: &Simulated, setting: &EffectSetting, method: Method) -> BoundEffect {
    let effect = crate::effect::find(&setting.effect).unwrap();
    let given = effect.parameters().iter().filter_map(|p| {
        let value = setting.parameters[p.name];
        match p.name {
            // 2 % off: within a fraction of a period over the range of distances.
            "period" => Some((p.name.to_owned(), value * 1.02)),
            _ if p.discrete => Some((p.name.to_owned(), value)),
            _ => None,
        }
    });
    let request = EffectRequest {
        effect: setting.effect.clone(),
        cable: setting.targets.first().cloned(),
        values: given.collect(),
    };
    let mut problem = Problem::new(&run.dataset).unwrap().with_method(method);
    problem.free(&[request]).unwrap();
    let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue).unwrap();
    assert!(
        solution.converged(),
        "{}: {:?}, chi2 {:e}",
        setting.effect,
        solution.termination,
        solution.chi2
    );
    solution.globals.effects[0].clone()
}

fn check(setting: &EffectSetting) {
    let robot = equipped();
    let run = hide(&robot, setting, 40, 11);
    let found = freed(&run, setting, Method::Joint);
    for (parameter, value) in found.effect.parameters().iter().zip(&found.values) {
        let truth = setting.parameters[parameter.name];
        assert!(
            (value - truth).abs() <= 1e-6 * truth.abs(),
            "{} {}: {value} instead of {truth}",
            setting.effect,
            parameter.name
        );
    }
}

/// A value in the middle of the typical range; for a vector, components that differ.
fn typical(id: &str) -> EffectSetting {
    let effect = crate::effect::find(id).unwrap();
    let parameters = effect.parameters().iter().enumerate().map(|(k, p)| {
        let [low, high] = p.typical;
        let share = 0.32 + 0.1 * k as f64;
        let value = match p.name {
            "pose" => 17.0,
            "period" => 0.1,
            _ => low + share * (high - low),
        };
        (p.name.to_owned(), value)
    });
    let targeted = effect.scope() == crate::effect::Scope::Cable;
    EffectSetting {
        effect: id.to_owned(),
        targets: targeted.then(|| "cable-3".to_owned()).into_iter().collect(),
        parameters: parameters.collect(),
    }
}

#[test]
fn every_effect_comes_back() {
    for effect in CATALOGUE.iter().filter(|e| e.is_estimable()) {
        let mut setting = typical(effect.id());
        if effect.id() == "winch_backlash" {
            // No cable moves by less than the play from one pose to the next of these.
            setting.parameters.insert("play".to_owned(), 2e-4);
        }
        println!("{setting:?}");
        check(&setting);
    }
}

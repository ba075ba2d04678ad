//! The slopes of all ports against central differences.

use crate::effect::{
    CableContext, CablePort, CablePorts, DistancePorts, Dual, Effect, PlatformContext,
    PlatformPort, PlatformPorts, every_effect,
};
use crate::robot::presets;

pub(super) fn at_cable() -> CableContext {
    CableContext {
        is_home: false,
        label: 41,
        time_s: 1200.0,
        temperature_change_k: 3.0,
        revolutions: 2.3,
        drum_per_motor: 0.25,
        direction: -1.0,
        paid_rates: [0.2, -0.3],
        tension_rates: [14.0, 30.0],
        tension_n: 120.0,
        mean_tension_n: 80.0,
        tension_gain: 2.0,
        wrap_rad: 1.3,
        pull_horizontal: [0.6, -0.3, 0.1],
        entry_point_m: [1.0, -2.0, 3.0],
        swivel_axis: [0.0, 0.0, -1.0],
        paid_m: 0.4,
        length_m: 2.1,
        swivel_rad: 0.2,
        radius_m: 0.03,
    }
}

pub(super) fn at_platform() -> PlatformContext {
    PlatformContext {
        is_home: false,
        row: 4,
        label: 41,
        time_s: 1200.0,
        temperature_change_k: 3.0,
        laser_m: 0.47,
        laser_rates: [-0.1, 0.4],
        twists: Default::default(),
        inertia: crate::geometry::Twist::zeros(),
        inclination_rad: [0.1, -0.2, 2.9],
        tracked_m: [0.2, -0.1, 0.4],
        tracked_rotation: [[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]],
        laser_direction: [0.0, 0.0, -1.0],
        target_normal: [0.0, 0.0, 1.0],
        position_m: [0.2, -0.1, 0.4],
        rotation_rad: [0.1, -0.2, 0.3],
    }
}

/// All ports of a cable and of the platform after one effect.
pub(super) fn ports_after(effect: &Effect, values: &[Dual]) -> (CablePorts, PlatformPorts) {
    let robot = presets::find("mini").unwrap().robot;
    let mut cable = CablePorts::nominal(&robot.cables[2], 0.4, 120.0);
    cable.weight = Dual::constant(0.3);
    let mut platform = PlatformPorts::nominal(&robot);
    (effect.change_cable)(values, &at_cable(), &mut cable);
    (effect.change_platform)(values, &at_platform(), &mut platform);
    (cable, platform)
}

/// A row of the distances.
const FIFTH: usize = 5;

fn scalars(effect: &Effect, values: &[Dual]) -> Vec<Dual> {
    let (cable, platform) = ports_after(effect, values);
    let of_cable = CablePort::ALL.iter().map(|port| cable.get(*port));
    let of_platform = PlatformPort::ALL.iter().map(|port| platform.get(*port));
    let mut distance = DistancePorts::NOMINAL;
    (effect.change_distance)(values, FIFTH, &mut distance);
    let of_distances = [distance.gain, distance.shift];
    of_cable.chain(of_platform).chain(of_distances).collect()
}

#[test]
fn slopes_match_differences() {
    for effect in every_effect() {
        let parameters = effect.parameters();
        let values: Vec<f64> = parameters
            .iter()
            .map(|p| match p.name {
                "pose" => at_cable().label as f64,
                "row" => FIFTH as f64,
                _ => 0.6 * p.typical[0] + 0.4 * p.typical[1],
            })
            .collect();
        for (chosen, parameter) in parameters.iter().enumerate() {
            let with = |step: f64, variable: bool| -> Vec<Dual> {
                let dual = |(k, value): (usize, &f64)| match (k == chosen, variable) {
                    (true, true) => Dual::variable(*value),
                    (true, false) => Dual::constant(value + step),
                    _ => Dual::constant(*value),
                };
                let values: Vec<Dual> = values.iter().enumerate().map(dual).collect();
                scalars(effect, &values)
            };
            let step = 1e-5 * parameter.typical[1].abs();
            let exact = with(0.0, true);
            let acts = exact.iter().any(|dual| dual.slope != 0.0);
            let name = parameter.name;
            assert_eq!(acts, !parameter.discrete, "{} {name}", effect.id());
            // At the label of a pose, what is given jumps.
            if parameter.discrete {
                continue;
            }
            for ((slope, plus), minus) in
                exact.iter().zip(with(step, false)).zip(with(-step, false))
            {
                let numeric = (plus.value - minus.value) / (2.0 * step);
                // Truncation is of order 1e-9 of the slope, rounding 1e-15 of the port over the step.
                let allowed = 1e-7 * numeric.abs() + 1e-14 * slope.value.abs() / step + 1e-12;
                let off = (slope.slope - numeric).abs();
                assert!(off <= allowed, "{} {name}: {off}", effect.id());
            }
        }
    }
}

#[test]
fn neutral_values_change_nothing() {
    for effect in every_effect().filter(|e| e.is_estimable()) {
        let neutral: Vec<Dual> = effect
            .neutral_values()
            .into_iter()
            .map(Dual::constant)
            .collect();
        let before = scalars(&crate::effect::cable_swap::EFFECT, &[]);
        for (one, other) in scalars(effect, &neutral).iter().zip(before) {
            assert!((one.value - other.value).abs() < 1e-15, "{}", effect.id());
        }
    }
}

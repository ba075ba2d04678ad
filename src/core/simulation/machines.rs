//! Machines whose parts deviate from their description, for tests: the description itself is changed, without using the
//! effects.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::readings::normal;
use super::{Simulated, SimulationOptions, simulate};
use crate::robot::{PartTolerances, StatedTolerances, Tolerance, presets};

/// Standard deviations of the changes below, by the effect that has the same consequences.
const TOLERANCES: [(&str, f64); 8] = [
    ("winch_scale", 2e-4),
    ("platform_anchor", 2e-4),
    ("pulley_radius", 5e-3),
    ("cable_stiffness", 0.05),
    ("force_gain", 5e-3),
    ("force_bias", 0.3),
    ("payload_mass", 5e-3),
    ("payload_com", 1e-3),
];

/// A run of a preset whose every part is a little off. The description that comes with the measurements is the nominal one
/// and states the tolerances from which the deviations were drawn.
pub(crate) fn run_of_machine(name: &str, poses: usize, seed: u64) -> Simulated {
    let preset = presets::find(name).unwrap();
    let mut machine = preset.robot.clone();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = |effect: &str| {
        let (_, sd) = TOLERANCES.iter().find(|(id, _)| *id == effect).unwrap();
        normal(&mut rng, *sd)
    };
    for cable in &mut machine.cables {
        cable.winch.drum_diameter_m *= 1.0 + draw("winch_scale");
        cable.pulley.radius_m *= 1.0 + draw("pulley_radius");
        for coordinate in &mut cable.platform_anchor_m {
            *coordinate += draw("platform_anchor");
        }
        if let Some(stiffness) = &mut cable.cable.axial_stiffness_n {
            *stiffness *= 1.0 + draw("cable_stiffness");
        }
        if let Some(sensor) = &mut cable.force_sensor {
            sensor.tension_gain *= 1.0 + draw("force_gain");
            sensor.bias_n += draw("force_bias");
        }
    }
    if let Some(mass) = &mut machine.platform.mass_kg {
        *mass *= 1.0 + draw("payload_mass");
    }
    for coordinate in &mut machine.platform.center_of_mass_m {
        *coordinate += draw("payload_com");
    }
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, seed)
    };
    let mut run = simulate(&machine, &options).unwrap();
    run.dataset.robot = preset.robot;
    let stated = TOLERANCES.map(|(id, sd)| (id.to_owned(), Tolerance::Same(sd)));
    run.dataset.robot.tolerances = Some(PartTolerances::Stated(StatedTolerances {
        factor: 1.0,
        effects: stated.into(),
    }));
    run
}

//! Displaced centre of mass: `c += (x, y, z)`, platform frame, metres. Observable through static equilibrium only; the
//! component along gravity only where the platform tilts. Typical 5 to 50 mm.

use super::{AsText, Dual, Effect, EffectParameter, PlatformContext, PlatformPorts, Scope};

/// Standard deviations of sound parts, for small and large machines.
const TOLERANCE: [f64; 2] = [0.001, 0.003];
const SOURCE_OF_TOLERANCE: &str =
    "Centre of mass from the drawing; cables and connectors are not in it";

pub(super) static EFFECT: Effect = Effect {
    id: "payload_com",
    title: "Centre of mass",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("x", "m", 0.05, [0.005, 0.05])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
        EffectParameter::new("y", "m", 0.05, [0.005, 0.05])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
        EffectParameter::new("z", "m", 0.05, [0.005, 0.05])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
    ],
    cause: |found| {
        found.say("The centre of mass of the platform is off by {displacement} (platform axes).")
    },
    workshop: |found| {
        found.say("Check what was mounted on the platform or moved there since it was described. Hang the platform from one point after another to find its centre of mass.")
    },
    check: Some("Balance the platform on an edge to find its centre of mass."),
    source: "Static equilibrium",
    change_platform,
    as_text: AsText::Formulas(&[
        ("center_of_mass_x", "center_of_mass_x + x"),
        ("center_of_mass_y", "center_of_mass_y + y"),
        ("center_of_mass_z", "center_of_mass_z + z"),
    ]),
    ..Effect::NEUTRAL
};

fn change_platform(parameters: &[Dual], _at: &PlatformContext, ports: &mut PlatformPorts) {
    for k in 0..3 {
        ports.center_of_mass[k] += parameters[k];
    }
}

//! Centre of mass elsewhere: `c += (x, y, z)`, platform frame, metres. Seen through static equilibrium only; the
//! component along gravity only where the platform tilts. Typical 5 to 50 mm.

use super::words::displacement;
use super::{Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "payload_com",
    title: "Centre of mass",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("x", "m", 0.05, [0.005, 0.05]),
        EffectParameter::new("y", "m", 0.05, [0.005, 0.05]),
        EffectParameter::new("z", "m", 0.05, [0.005, 0.05]),
    ],
    cause,
    workshop,
    check: Some("Balance the platform on an edge to find its centre of mass."),
    source: "Static equilibrium",
    change_platform,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let offset_m = [0, 1, 2].map(|k| found.value(k));
    format!(
        "The centre of mass of the platform is off by {} (platform axes).",
        displacement(&offset_m),
    )
}

fn workshop(_found: &FoundEffect<'_>) -> String {
    "Check what was mounted on the platform or moved there since it was described. Hang the platform from one point after another to find its centre of mass.".to_owned()
}

fn change_platform(parameters: &[Dual], _at: &PlatformContext, ports: &mut PlatformPorts) {
    for k in 0..3 {
        ports.center_of_mass[k] += parameters[k];
    }
}

//! Cyclic error of a phase-shift laser: `A sin(2 pi d / P + phase)` is added to the reading, with amplitude `A` and
//! period `P` in metres and phase in radians.
//!
//! Approximation: `d` is the reading itself, which contains the error; second order in `2 pi A / P`, which must
//! stay below 1. A fit finds the period only if it starts within about a tenth of `P^2 / range` of it.
//! Typical amplitude 0.3 to 3 mm. The period is half the wavelength of the modulation: 0.6 m at 250 MHz.

use super::{AsText, Dual, Effect, EffectParameter, PlatformContext, PlatformPorts, Scope, Search};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "laser_cyclic",
    title: "Cyclic error of the laser",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("amplitude", "m", 0.003, [0.0003, 0.003]),
        EffectParameter::new("period", "m", 1.0, [0.02, 1.0]).around(0.1),
        EffectParameter::new(
            "phase",
            "rad",
            3.0,
            [-std::f64::consts::PI, std::f64::consts::PI],
        ),
    ],
    cause: |found| {
        found.say("The laser reading varies by {0:mm} to either side as the distance changes, once every {1:mm}.")
    },
    workshop: |found| {
        found.say("Clean the optics of the laser and use a matt target without reflections. If the error stays, have the laser checked or replace it.")
    },
    check: Some("Move the target of the laser along a steel ruler in steps of a few millimetres."),
    source: "Cyclic error of phase-shift distance meters",
    search: Search::Wave {
        phase: 2,
        period: Some(1),
    },
    change_platform,
    variable: Some(Variable::Distance),
    as_text: AsText::Formulas(&[(
        "laser_bias",
        "laser_bias + amplitude * sin(2 * pi * laser / period + phase)",
    )]),
    ..Effect::NEUTRAL
};

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    let [amplitude, period, phase] = [parameters[0], parameters[1], parameters[2]];
    let turns = period.recip() * (std::f64::consts::TAU * at.laser_m);
    ports.laser_bias += amplitude * (turns + phase).sin();
}

//! A frame that expands: every entry point `a` moves by `alpha dT a` with the change of temperature since home
//! `dT` (K), about the origin of the base frame. Approximation: `a` is the nominal entry point. Typical 12e-6
//! (steel) to 24e-6 (aluminium) per kelvin.

use super::words;
use super::{AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "frame_thermal",
    title: "Thermal expansion of the frame",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("alpha", "1/K", 0.00002, [0.000012, 0.000024])
            .within(0.0, f64::INFINITY),
    ],
    cause: |found| {
        found.say("The frame gets {0:mm} {0:longer|shorter} per metre and per kelvin of warming.")
    },
    workshop: |found| {
        found.say("Measure at a steady temperature, or record the temperature of the frame with every pose so that it can be corrected for.")
    },
    check: Some(words::REPEAT_WARMER),
    source: "Linear thermal expansion; steel 12e-6, aluminium 24e-6 per kelvin",
    change_cable,
    variable: Some(Variable::Temperature),
    as_text: AsText::Formulas(&[
        (
            "entry_shift_x",
            "entry_shift_x + alpha * temperature * entry_x",
        ),
        (
            "entry_shift_y",
            "entry_shift_y + alpha * temperature * entry_y",
        ),
        (
            "entry_shift_z",
            "entry_shift_z + alpha * temperature * entry_z",
        ),
    ]),
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    for k in 0..3 {
        let shift = at.temperature_change_k * at.entry_point_m[k];
        ports.entry_shift[k] += parameters[0] * shift;
    }
}

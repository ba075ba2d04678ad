//! Strain that is not proportional to tension: `strain = T/EA (1 + c (T/Tref - 1))` with the tension `T` (N) and
//! its mean over the data set `Tref`, both as fitted to the force sensor of the cable.
//!
//! Nothing changes without force sensor, without stated stiffness, or where a measured elongation surface
//! replaces it. Typical 0.1 to 0.5 in magnitude; fibre ropes stiffen under load, so that `c` is negative. First-order term.

use super::{AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, Scope, Stage};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "cable_stiffening",
    title: "Cable stiffness that depends on tension",
    scope: Scope::CableOrAll,
    parameters: &[
        EffectParameter::new("c", "1", 0.5, [0.1, 0.5]).with_tolerance(
            [0.02, 0.02],
            "Curvature of the load curve of a run-in rope at working load",
        ),
    ],
    cause: |found| {
        found.say("{cable} {0:soften|stiffen}{s|} with load: at twice the mean tension {it stretches|they stretch} {0:%} {0:more|less} than in proportion.")
    },
    workshop: |found| {
        found.say("Measure the elongation of a piece of the same cable over the whole range of tensions, and use the measured curve instead of one stiffness.")
    },
    check: Some(
        "Pull a piece of the cable with several known forces and measure how much it stretches.",
    ),
    source: "First-order term of a stiffness that depends on tension, as measured on fibre ropes",
    stage: Stage::Ratio,
    change_cable,
    variable: Some(Variable::Tension),
    as_text: AsText::Formulas(&[(
        "compliance",
        "compliance * (1 + c * (tension / mean_tension - 1))",
    )]),
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if at.mean_tension_n > 0.0 {
        let excess = at.tension_n / at.mean_tension_n - 1.0;
        ports.compliance *= parameters[0] * excess + 1.0;
    }
}

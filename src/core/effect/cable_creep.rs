//! Strain that grows with the logarithm of time: `strain += c ln(1 + t / 600 s)`, `t` since home. Assumes that
//! the load is about constant. Typical 1e-4 to 1e-2: logarithmic creep of fibre ropes.

use super::words::{self, millimetres};
use super::{AsText, Effect, EffectParameter, FoundEffect, Scope};
use crate::measurement::Variable;

/// Unit of the strain per logarithm of time.
const LOGARITHMIC_STRAIN: &str = "1/ln(1+t/600s)";

pub(super) static EFFECT: Effect = Effect {
    id: "cable_creep",
    title: "Cable creep",
    scope: Scope::CableOrAll,
    parameters: &[
        EffectParameter::new("c", LOGARITHMIC_STRAIN, 0.01, [0.0001, 0.01])
            .within(0.0, f64::INFINITY)
            .with_tolerance(
                [1e-05, 1e-05],
                "Settling of a run-in steel rope within the first hour",
            ),
    ],
    cause,
    workshop: |found| {
        found.say("Leave {cable} under working tension for some hours before measuring{revolutions:, and zero the encoders at home afterwards|}.")
    },
    check: Some(words::GO_BACK),
    source: "Logarithmic creep of fibre ropes",
    change_cable: |parameters, at, ports| {
        ports.strain += parameters[0] * (at.time_s.max(0.0) / 600.0).ln_1p();
    },
    variable: Some(Variable::Time),
    as_text: AsText::Formulas(&[("strain", "strain + c * ln(1 + max(time, 0) / 600 [s])")]),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    // The logarithm of 1 + 3600 s / 600 s.
    let first_hour = found.value(0) * 7_f64.ln();
    found.say_with(
        "{cable} {0:creep|shrink}{s|} under load: in the first hour each metre gets {} {0:longer|shorter}.",
        &millimetres(first_hour),
    )
}

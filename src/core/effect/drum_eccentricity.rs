//! Eccentric or oval drum: `A sin(2 pi rev / gear_ratio + phase) - A sin(phase)` is added to the cable paid
//! out. Typical amplitude 0.1 to 1 mm.

use super::{AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, Scope, Search};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "drum_eccentricity",
    title: "Drum out of round",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("amplitude", "m", 0.001, [0.0001, 0.001]).with_tolerance(
            [2.5e-5, 5e-5],
            "Circular run-out by ISO 2768-2: 0.1 mm in class H, 0.2 mm in class K, which \
             is twice the amplitude",
        ),
        EffectParameter::new(
            "phase",
            "rad",
            3.0,
            [-std::f64::consts::PI, std::f64::consts::PI],
        ),
    ],
    cause: |found| {
        found.say("The {drum|drums} of {winch} {is|are} out of round: once per turn the length paid out varies by {0:mm} to either side.")
    },
    workshop: |found| {
        found.say("Measure the runout of the {drum|drums} of {winch} with a dial gauge; centre or replace what runs out.")
    },
    check: Some("Turn the drum once under a dial gauge."),
    source: "Geometry of an eccentric drum; sizes from ovalisation reported for winches of cable robots",
    search: Search::Wave {
        phase: 1,
        period: None,
    },
    change_cable,
    variable: Some(Variable::DrumFraction),
    as_text: AsText::Formulas(&[(
        "paid",
        "paid + amplitude * (sin(2 * pi * drum_revolutions + phase) - sin(phase))",
    )]),
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    let [amplitude, phase] = [parameters[0], parameters[1]];
    let angle = std::f64::consts::TAU * at.revolutions * at.drum_per_motor;
    ports.paid += amplitude * ((phase + angle).sin() - phase.sin());
}

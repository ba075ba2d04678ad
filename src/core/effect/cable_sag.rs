//! Weight per metre that differs from the stated one: `w += weight` (N/m) in the extra length by sag `w^2 h^2 l / (24 T^2)` with
//! the horizontal span `h`, free length `l` and tension `T`. Parabola, first order; needs force sensors.
//! An estimate starts at 0.1 N/m: without weight nothing depends on it to first order. Typical 0.01 to
//! 5 N/m. Source: Irvine, Cable Structures, 1981.

use super::{AsText, Effect, EffectParameter, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "cable_sag",
    title: "Cable weight",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("weight", "N/m", 5.0, [0.01, 5.0]).starting_at(0.1)],
    cause: |found| {
        found.say(
            "{cable} {weighs|weigh} {0:unit} {0:more|less} than stated and {sags|sag} accordingly.",
        )
    },
    workshop: |found| {
        found.say("Weigh a piece of the cable of known length and enter its weight per metre. Higher tensions make the sag smaller.")
    },
    check: Some("Weigh a few metres of the cable."),
    source: "Irvine, Cable Structures, 1981: parabola, first order",
    needs_sag: true,
    change_cable: |parameters, _, ports| ports.weight += parameters[0],
    variable: Some(Variable::CableLength),
    as_text: AsText::Formulas(&[("weight", "weight + weight_change")]),
    ..Effect::NEUTRAL
};

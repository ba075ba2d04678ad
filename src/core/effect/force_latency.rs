//! Delayed force readings: `reading(t) = truth(t - delay)`, with the delay in seconds, as by the filter of an amplifier. The
//! tension now is that of the reading plus `delay T' + delay^2 T''/2`. Noise in these derivatives makes the estimated delay too
//! small by the ratio of its variance to theirs (attenuation); docs/VALIDATION.md states it for simulated recordings.

use super::motion::change_within;
use super::words::CHECK_CLOCKS;
use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "force_latency",
    title: "Force sensor latency",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("delay", "s", 0.1, [0.002, 0.1]).within(0.0, f64::INFINITY)],
    cause: |found| {
        found.say("The forces of all cables are recorded {0:ms} {0:late|early}: each reading is a past tension, not the present one.")
    },
    workshop: |found| found.say("Shorten the filter of the force amplifiers, or enter its delay."),
    check: Some(CHECK_CLOCKS),
    source: "Transport delay; second order in the delay",
    change_cable: |parameters, at, ports| {
        ports.tension += change_within(parameters[0], at.tension_rates);
    },
    delays: |values, _, delays| delays.force += values[0],
    as_text: AsText::Impossible("delays all readings of a device, also in simulated recordings"),
    ..Effect::NEUTRAL
};

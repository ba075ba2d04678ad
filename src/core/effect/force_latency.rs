//! Forces that are read late: `reading(t) = truth(t - delay)`, with the delay in seconds, as by the filter of an amplifier. The tension
//! now is that of the reading plus `delay T' + delay^2 T''/2` with its own rates. Noise in these rates makes the delay too small by the
//! ratio of its variance to that of the rates (attenuation), which docs/VALIDATION.md states for simulated recordings.

use super::motion::change_within;
use super::words::CHECK_CLOCKS;
use super::{Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "force_latency",
    title: "Force sensor latency",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("delay", "s", 0.1, [0.002, 0.1]).within(0.0, f64::INFINITY)],
    cause: |found| {
        found.say("The forces of all cables are recorded {0:ms} {0:late|early}: each reading is the tension that was, not the one that is.")
    },
    workshop: |found| found.say("Shorten the filter of the force amplifiers, or enter its delay."),
    check: Some(CHECK_CLOCKS),
    source: "Transport delay; second order in the delay",
    change_cable: |parameters, at, ports| {
        ports.tension += change_within(parameters[0], at.tension_rates);
    },
    delays: |values, _, delays| delays.force += values[0],
    ..Effect::NEUTRAL
};

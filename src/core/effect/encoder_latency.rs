//! Delayed length readings: `reading(t) = truth(t - delay)`, with the delay in seconds. The length paid out now is the reading
//! plus `delay l' + delay^2 l''/2` with time derivatives from smoothed readings; valid for delays short compared with the motion.

use super::motion::change_within;
use super::words::CHECK_CLOCKS;
use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "encoder_latency",
    title: "Encoder latency",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("delay", "s", 0.05, [0.001, 0.05]).within(0.0, f64::INFINITY)
    ],
    cause: |found| {
        found.say("The lengths of all cables are recorded {0:ms} {0:late|early}: each reading is where the cable was, not where it is.")
    },
    workshop: |found| {
        found.say("Take the time stamps of the winches where they are read, in the drive, and not where they are recorded.")
    },
    check: Some(CHECK_CLOCKS),
    source: "Transport delay; second order in the delay",
    change_cable: |parameters, at, ports| ports.paid += change_within(parameters[0], at.paid_rates),
    delays: |values, _, delays| delays.length += values[0],
    as_text: AsText::Impossible("delays all readings of a device, also in simulated recordings"),
    ..Effect::NEUTRAL
};

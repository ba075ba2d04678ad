//! Delayed external instrument: `reading(t) = pose(t - delay)`, with the delay in seconds. Camera systems lag
//! by 5 to 50 ms: at 0.3 m/s that is up to 15 mm. Second order in the delay, with the velocity and the
//! acceleration of the platform from the lengths of its cables.

use super::words::CHECK_CLOCKS;
use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "tracker_latency",
    title: "External pose latency",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("delay", "s", 0.05, [0.001, 0.05]).within(0.0, f64::INFINITY)
    ],
    cause: |found| {
        found.say("The external instrument is recorded {0:ms} {0:late|early} relative to the winches: each pose is where the platform was, not where it is.")
    },
    workshop: |found| {
        found.say("Subtract the delay from the time stamps of the external instrument, or trigger both recorders by one signal.")
    },
    check: Some(CHECK_CLOCKS),
    source: "Transport delay; second order in the delay",
    change_platform: |parameters, _, ports| ports.tracker_delay += parameters[0],
    delays: |values, _, delays| delays.tracker += values[0],
    as_text: AsText::Impossible("delays all readings of a device, also in simulated recordings"),
    ..Effect::NEUTRAL
};

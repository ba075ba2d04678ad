//! Delayed laser reading: `reading(t) = truth(t - delay)`, with the delay in seconds: the predicted reading is the distance
//! less `delay d' + delay^2 d''/2`, with the time derivatives of the reading.

use super::motion::change_within;
use super::words::CHECK_CLOCKS;
use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "laser_latency",
    title: "Laser latency",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("delay", "s", 0.05, [0.001, 0.05]).within(0.0, f64::INFINITY)
    ],
    cause: |found| {
        found.say("The laser is recorded {0:ms} {0:late|early}: each reading is a past distance, not the present one.")
    },
    workshop: |found| found.say("Set the laser to its fastest output, or enter its delay."),
    check: Some(CHECK_CLOCKS),
    source: "Transport delay; second order in the delay",
    change_platform: |parameters, at, ports| {
        ports.laser_bias += -change_within(parameters[0], at.laser_rates);
    },
    delays: |values, _, delays| delays.laser += values[0],
    as_text: AsText::Impossible("delays all readings of a device, also in simulated recordings"),
    ..Effect::NEUTRAL
};

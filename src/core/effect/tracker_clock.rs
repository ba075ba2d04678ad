//! Clock drift of the external instrument relative to the controller: it lags by `drift t` after the
//! time `t` since the start (s), so that `reading(t) = pose(t - drift t)`. Quartz clocks differ by up to 100 ppm.

use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "tracker_clock",
    title: "Clock of the external instrument",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("drift", "1", 2e-4, [1e-5, 2e-4])],
    cause: |found| {
        found.say("The clock of the external instrument runs {0:%} {0:slow|fast} relative to that of the winches: its poses {0:lag|lead} more and more.")
    },
    workshop: |found| {
        found.say(
            "Synchronise both clocks, or align them with the option --align-clocks of the import.",
        )
    },
    check: Some(
        "Record one sharp motion at the beginning and one at the end, and compare the time between them on both clocks.",
    ),
    source: "Constant drift of a quartz clock",
    change_platform: |parameters, at, ports| ports.tracker_delay += parameters[0] * at.time_s,
    delays: |values, time_s, delays| delays.tracker += values[0] * time_s,
    as_text: AsText::Impossible("delays all readings of a device, also in simulated recordings"),
    ..Effect::NEUTRAL
};

//! Two channels are connected the wrong way round at all poses: the length readings of two cables are exchanged
//! (`channels` 1), their force readings (2), or both (3). Swivel readings are not. There is nothing to fit: a model
//! that names the exchange is compared with readings in which it was undone.

use super::{Effect, EffectParameter, FoundEffect, Scope, Search};
use crate::measurement::{Grid, Measurements};

pub(super) static EFFECT: Effect = Effect {
    id: "cable_swap",
    title: "Exchanged channels",
    scope: Scope::Pair,
    parameters: &[EffectParameter::choice("channels", [1.0, 3.0], 1.0)],
    cause,
    workshop,
    check: Some("Turn one winch by hand and look which channels count and pull."),
    source: "Wiring: two channels exchanged",
    search: Search::Exchange,
    exchange_channels,
    ..Effect::NEUTRAL
};

/// Whether length readings and force readings are exchanged.
fn exchanged(channels: f64) -> [bool; 2] {
    [channels != 2.0, channels >= 2.0]
}

fn cause(found: &FoundEffect<'_>) -> String {
    found.say(
        match (exchanged(found.value(0)), found.counts_revolutions()) {
            ([true, false], true) => {
                "The encoders of {winch} are connected the wrong way round."
            }
            ([true, false], false) => {
                "The length readings of {cable} are connected the wrong way round."
            }
            ([true, true], true) => {
                "The encoders of {winch} are connected the wrong way round, and so are their force sensors."
            }
            ([true, true], false) => {
                "The length and force readings of {cable} are connected the wrong way round."
            }
            ([false, _], _) => "{force sensor} are connected the wrong way round.",
        },
    )
}

fn workshop(found: &FoundEffect<'_>) -> String {
    found.say(
        match (exchanged(found.value(0)), found.counts_revolutions()) {
            ([true, false], true) => {
                "Exchange the encoder plugs of {winch}, or their channels in the controller."
            }
            ([true, false], false) => {
                "Exchange the plugs of the length sensors of {cable}, or their channels in the controller."
            }
            ([true, true], true) => {
                "Exchange the encoder plugs of {winch} and the plugs of their force sensors, or the channels in the controller."
            }
            ([true, true], false) => {
                "Exchange the plugs of the length and force sensors of {cable}, or their channels in the controller."
            }
            ([false, _], _) => {
                "Exchange the plugs of {force sensor}, or their channels in the controller."
            }
        },
    )
}

fn exchange_channels(cables: &[usize], values: &[f64], data: &mut Measurements) {
    let ([one, other], Some(channels)) = (cables, values.first()) else {
        return;
    };
    let exchange = |grid: &mut Grid| {
        for row in 0..grid.rows() {
            let (a, b) = (grid.get(row, *one), grid.get(row, *other));
            grid.set(row, *one, b);
            grid.set(row, *other, a);
        }
    };
    let [lengths, forces] = exchanged(*channels);
    if lengths {
        exchange(&mut data.revolutions);
        exchange(&mut data.length_m);
    }
    if forces {
        exchange(&mut data.force_n);
    }
}

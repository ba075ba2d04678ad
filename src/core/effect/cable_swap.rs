//! Two channels are swapped at all poses: the length readings of two cables are exchanged
//! (`channels` 1), their force readings (2), or both (3). Swivel readings are not. Nothing is estimated: the search
//! compares a model that states the exchange with the readings restored to their own channels.

use super::{AsText, Effect, EffectParameter, FoundEffect, Scope, Search};
use crate::measurement::{Grid, Measurements};

pub(super) static EFFECT: Effect = Effect {
    id: "cable_swap",
    title: "Exchanged channels",
    scope: Scope::Pair,
    parameters: &[EffectParameter::choice("channels", [1.0, 3.0], 1.0)],
    cause,
    workshop,
    check: Some("Turn one winch by hand and see which channels respond."),
    source: "Wiring: two channels exchanged",
    search: Search::Exchange,
    exchange_channels,
    is_damage: true,
    as_text: AsText::Impossible(
        "exchanges the readings of two cables, while formulas change one quantity each",
    ),
    ..Effect::NEUTRAL
};

/// Whether the length readings and whether the force readings are exchanged, by the parameter `channels`.
fn exchanged(channels: f64) -> [bool; 2] {
    [channels != 2.0, channels >= 2.0]
}

fn cause(found: &FoundEffect<'_>) -> String {
    found.say(
        match (exchanged(found.value(0)), found.counts_revolutions()) {
            ([true, false], true) => "The encoders of {winch} are swapped.",
            ([true, false], false) => "The length readings of {cable} are swapped.",
            ([true, true], true) => {
                "The encoders of {winch} are swapped, and so are their force sensors."
            }
            ([true, true], false) => "The length and force readings of {cable} are swapped.",
            ([false, _], _) => "{force sensor} are swapped.",
        },
    )
}

fn workshop(found: &FoundEffect<'_>) -> String {
    found.say(
        match (exchanged(found.value(0)), found.counts_revolutions()) {
            ([true, false], true) => {
                "Swap the encoder plugs of {winch}, or their channels in the controller."
            }
            ([true, false], false) => {
                "Swap the plugs of the length sensors of {cable}, or their channels in the controller."
            }
            ([true, true], true) => {
                "Swap the encoder plugs of {winch} and the plugs of their force sensors, or the channels in the controller."
            }
            ([true, true], false) => {
                "Swap the plugs of the length and force sensors of {cable}, or their channels in the controller."
            }
            ([false, _], _) => {
                "Swap the plugs of {force sensor}, or their channels in the controller."
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

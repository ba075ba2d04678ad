//! Two encoder channels are connected the wrong way round: the length readings of two cables are exchanged, at all
//! poses. Force and swivel readings are not. There is nothing to fit: a model that names the exchange is
//! compared with readings in which it was undone.

use super::{Effect, FoundEffect, Scope, Search};
use crate::measurement::Measurements;

pub(super) static EFFECT: Effect = Effect {
    id: "cable_swap",
    title: "Exchanged channels",
    scope: Scope::Pair,
    cause,
    workshop,
    check: Some("Turn one winch by hand and look which channel counts."),
    source: "Wiring: two channels exchanged",
    search: Search::Exchange,
    exchange_channels,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    found.say(if found.counts_revolutions() {
        "The encoders of {winch} are connected the wrong way round."
    } else {
        "The length readings of {cable} are connected the wrong way round."
    })
}

fn workshop(found: &FoundEffect<'_>) -> String {
    found.say(if found.counts_revolutions() {
        "Exchange the encoder plugs of {winch}, or their channels in the controller."
    } else {
        "Exchange the plugs of the length sensors of {cable}, or their channels in the controller."
    })
}

fn exchange_channels(cables: &[usize], data: &mut Measurements) {
    let [one, other] = *cables else {
        return;
    };
    for grid in [&mut data.revolutions, &mut data.length_m] {
        for row in 0..grid.rows() {
            let (a, b) = (grid.get(row, one), grid.get(row, other));
            grid.set(row, one, b);
            grid.set(row, other, a);
        }
    }
}

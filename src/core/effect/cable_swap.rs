//! Two encoder channels are connected the wrong way round: the length readings of two cables are exchanged, at all
//! poses. Force and swivel readings are not. There is nothing to fit: a model that names the exchange is
//! compared with readings in which it was undone.

use super::{Effect, FoundEffect, Part, Scope, Search};
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
    if found.counts_revolutions() {
        format!(
            "The encoders of {} are connected the wrong way round.",
            found.name(Part::Winch)
        )
    } else {
        format!(
            "The length readings of {} are connected the wrong way round.",
            found.name(Part::Cable)
        )
    }
}

fn workshop(found: &FoundEffect<'_>) -> String {
    if found.counts_revolutions() {
        format!(
            "Exchange the encoder plugs of {}, or their channels in the controller.",
            found.name(Part::Winch),
        )
    } else {
        format!(
            "Exchange the plugs of the length sensors of {}, or their channels in the controller.",
            found.name(Part::Cable),
        )
    }
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

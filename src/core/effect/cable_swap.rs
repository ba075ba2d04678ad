//! Two encoder channels are connected the wrong way round: the length readings of two cables are exchanged, at all
//! poses. Force and swivel readings are not. There is nothing to fit: a model that names the exchange is
//! compared with readings in which it was undone.

use super::{Effect, EffectParameter, Found, Part, Scope, Search};
use crate::measurement::Measurements;

/// See the module documentation.
#[derive(Debug)]
pub struct CableSwap;

impl Effect for CableSwap {
    fn id(&self) -> &'static str {
        "cable_swap"
    }
    fn title(&self) -> &'static str {
        "Exchanged channels"
    }
    fn scope(&self) -> Scope {
        Scope::Pair
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
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
    fn workshop(&self, found: &Found<'_>) -> String {
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
    fn check(&self) -> Option<&'static str> {
        Some("Turn one winch by hand and look which channel counts.")
    }
    fn source(&self) -> &'static str {
        "Wiring: two channels exchanged"
    }
    fn search(&self) -> Search {
        Search::Exchange
    }
    fn exchange_channels(&self, cables: &[usize], data: &mut Measurements) {
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
}

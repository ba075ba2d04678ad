//! Two encoder channels are connected the wrong way round: the length readings of two cables are exchanged, at all
//! poses. Force and swivel readings are not. There is nothing to fit: a model that names the exchange is
//! compared with readings in which it was undone.

use super::{Effect, EffectParameter, Scope, Search};
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

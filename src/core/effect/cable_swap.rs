//! Two encoder channels are connected the wrong way round: the length readings of two cables are exchanged, at all
//! poses. Force and swivel readings are not. Changes simulated readings only; an estimation has nothing to
//! fit.

use super::{Effect, EffectParameter, Scope, Search};
use crate::measurement::Measurements;
use crate::robot::Robot;

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
    fn corrupt(
        &self,
        _parameters: &[f64],
        cables: &[usize],
        _robot: &Robot,
        data: &mut Measurements,
    ) {
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

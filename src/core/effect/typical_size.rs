//! Effects at typical size: between the smallest and the largest size in practice.

use std::f64::consts::FRAC_PI_4;

use super::{BoundEffect, Effect, EffectParameter, Search};

impl EffectParameter {
    /// Geometric mean of the smallest and the largest typical size.
    #[must_use]
    pub fn typical_size(&self) -> f64 {
        let [least, largest] = self.typical_sizes();
        if least > 0.0 {
            (least * largest).sqrt()
        } else {
            0.5 * largest
        }
    }
}

impl Effect {
    /// Indices of the parameters that can be estimated.
    pub(crate) fn estimable(&self) -> impl Iterator<Item = usize> + use<> {
        let parameters = self.parameters.iter().enumerate();
        parameters.filter(|(_, p)| !p.discrete).map(|(k, _)| k)
    }
}

/// Index of the amplitude of a wave: the parameter that is neither phase nor period.
pub(crate) fn amplitude_of(phase: usize, period: Option<usize>) -> usize {
    (0..3)
        .find(|k| *k != phase && Some(*k) != period)
        .unwrap_or_default()
}

impl BoundEffect {
    /// The same effect on the same cables at typical size, at its pose or with its period. Each parameter is the geometric mean of its
    /// smallest and largest typical size, divided by the square root of the number of parameters.
    #[must_use]
    pub fn at_typical_size(&self) -> Self {
        let mut bound = self.clone();
        let parameters = bound.effect.parameters;
        if let Search::Wave { phase, period } = bound.effect.search {
            let amplitude = amplitude_of(phase, period);
            bound.values[amplitude] = parameters[amplitude].typical_size();
            bound.values[phase] = FRAC_PI_4;
            return bound;
        }
        let count = bound.effect.estimable().count() as f64;
        for k in bound.effect.estimable() {
            bound.values[k] = parameters[k].neutral + parameters[k].typical_size() / count.sqrt();
        }
        bound
    }
}

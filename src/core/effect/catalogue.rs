//! The list of effects that models, simulations and commands know.

use super::Effect;
use super::cable_stiffness::CableStiffness;
use super::drum_eccentricity::DrumEccentricity;
use super::drum_growth::DrumGrowth;
use super::laser_bias::LaserBias;
use super::laser_scale::LaserScale;
use super::pulley_radius::PulleyRadius;
use super::winch_offset::WinchOffset;
use super::winch_scale::WinchScale;
use super::winch_scale_common::WinchScaleCommon;

/// Every effect, in the order in which reports list them.
pub static CATALOGUE: &[&dyn Effect] = &[
    &WinchScale,
    &WinchScaleCommon,
    &WinchOffset,
    &DrumEccentricity,
    &DrumGrowth,
    &CableStiffness,
    &PulleyRadius,
    &LaserScale,
    &LaserBias,
];

/// The effect with this identifier.
#[must_use]
pub fn find(id: &str) -> Option<&'static dyn Effect> {
    CATALOGUE.iter().copied().find(|effect| effect.id() == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_unique_and_priors_positive() {
        for effect in CATALOGUE {
            assert_eq!(
                CATALOGUE.iter().filter(|e| e.id() == effect.id()).count(),
                1
            );
            assert!(effect.parameters().iter().all(|p| p.prior_sd > 0.0));
        }
    }
}

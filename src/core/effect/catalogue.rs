//! The list of effects that models, simulations and commands know.

use super::Effect;
use super::cable_creep::CableCreep;
use super::cable_sag::CableSag;
use super::cable_slip::CableSlip;
use super::cable_stiffening::CableStiffening;
use super::cable_stiffness::CableStiffness;
use super::cable_swap::CableSwap;
use super::cable_thermal::CableThermal;
use super::drum_eccentricity::DrumEccentricity;
use super::drum_growth::DrumGrowth;
use super::encoder_drift::EncoderDrift;
use super::encoder_outlier::EncoderOutlier;
use super::force_bias::ForceBias;
use super::force_gain::ForceGain;
use super::frame_compliance::FrameCompliance;
use super::frame_shift::FrameShift;
use super::frame_thermal::FrameThermal;
use super::heading_offset::HeadingOffset;
use super::inclinometer_tilt::InclinometerTilt;
use super::laser_beam_tilt::LaserBeamTilt;
use super::laser_bias::LaserBias;
use super::laser_cyclic::LaserCyclic;
use super::laser_drift::LaserDrift;
use super::laser_outliers::LaserOutliers;
use super::laser_scale::LaserScale;
use super::payload_com::PayloadCom;
use super::payload_mass::PayloadMass;
use super::platform_anchor::PlatformAnchor;
use super::pulley_axis_tilt::PulleyAxisTilt;
use super::pulley_friction::PulleyFriction;
use super::pulley_radius::PulleyRadius;
use super::swivel_offset::SwivelOffset;
use super::target_tilt::TargetTilt;
use super::unknown::Unknown;
use super::winch_backlash::WinchBacklash;
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
    &WinchBacklash,
    &EncoderDrift,
    &CableSlip,
    &CableStiffness,
    &CableStiffening,
    &CableCreep,
    &CableThermal,
    &CableSag,
    &CableSwap,
    &PulleyRadius,
    &PulleyAxisTilt,
    &PulleyFriction,
    &PlatformAnchor,
    &PayloadMass,
    &PayloadCom,
    &FrameCompliance,
    &FrameThermal,
    &FrameShift,
    &LaserScale,
    &LaserBias,
    &LaserBeamTilt,
    &TargetTilt,
    &LaserDrift,
    &LaserCyclic,
    &LaserOutliers,
    &EncoderOutlier,
    &ForceGain,
    &ForceBias,
    &SwivelOffset,
    &HeadingOffset,
    &InclinometerTilt,
];

/// The effect with this identifier; `unknown`, which names no cause, is not on the list but found, too.
#[must_use]
pub fn find(id: &str) -> Option<&'static dyn Effect> {
    let unknown: &dyn Effect = &Unknown;
    let known = CATALOGUE.iter().copied();
    known.chain([unknown]).find(|effect| effect.id() == id)
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

//! The list of effects that models, simulations and commands know.

use super::{
    Effect, cable_creep, cable_sag, cable_slip, cable_stiffening, cable_stiffness, cable_swap,
    cable_thermal, drum_eccentricity, drum_growth, encoder_drift, encoder_outlier, force_bias,
    force_gain, frame_compliance, frame_shift, frame_thermal, heading_offset, inclinometer_tilt,
    laser_beam_tilt, laser_bias, laser_cyclic, laser_drift, laser_outliers, laser_scale,
    payload_com, payload_mass, platform_anchor, pulley_axis_tilt, pulley_friction, pulley_radius,
    swivel_offset, target_tilt, unknown, winch_backlash, winch_offset, winch_scale,
    winch_scale_common,
};

/// Every effect, in the order in which reports list them.
pub static CATALOGUE: &[&Effect] = &[
    &winch_scale::EFFECT,
    &winch_scale_common::EFFECT,
    &winch_offset::EFFECT,
    &drum_eccentricity::EFFECT,
    &drum_growth::EFFECT,
    &winch_backlash::EFFECT,
    &encoder_drift::EFFECT,
    &cable_slip::EFFECT,
    &cable_stiffness::EFFECT,
    &cable_stiffening::EFFECT,
    &cable_creep::EFFECT,
    &cable_thermal::EFFECT,
    &cable_sag::EFFECT,
    &cable_swap::EFFECT,
    &pulley_radius::EFFECT,
    &pulley_axis_tilt::EFFECT,
    &pulley_friction::EFFECT,
    &platform_anchor::EFFECT,
    &payload_mass::EFFECT,
    &payload_com::EFFECT,
    &frame_compliance::EFFECT,
    &frame_thermal::EFFECT,
    &frame_shift::EFFECT,
    &laser_scale::EFFECT,
    &laser_bias::EFFECT,
    &laser_beam_tilt::EFFECT,
    &target_tilt::EFFECT,
    &laser_drift::EFFECT,
    &laser_cyclic::EFFECT,
    &laser_outliers::EFFECT,
    &encoder_outlier::EFFECT,
    &force_gain::EFFECT,
    &force_bias::EFFECT,
    &swivel_offset::EFFECT,
    &heading_offset::EFFECT,
    &inclinometer_tilt::EFFECT,
];

/// The effect with this identifier; `unknown`, which names no cause, is not on the list but found, too.
#[must_use]
pub fn find(id: &str) -> Option<&'static Effect> {
    let known = CATALOGUE.iter().copied();
    known
        .chain([&unknown::EFFECT])
        .find(|effect| effect.id() == id)
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

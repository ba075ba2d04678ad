//! The catalogue of effects that models, simulations and commands know.

use super::{
    Effect, cable_creep, cable_sag, cable_slip, cable_stiffening, cable_stiffness, cable_swap,
    cable_thermal, drum_eccentricity, drum_growth, encoder_drift, encoder_latency, encoder_outlier,
    force_bias, force_gain, force_latency, frame_compliance, frame_shift, frame_thermal,
    heading_offset, inclinometer_tilt, laser_beam_tilt, laser_bias, laser_cyclic, laser_drift,
    laser_latency, laser_outliers, laser_scale, payload_com, payload_mass, platform_anchor,
    pulley_axis_tilt, pulley_drag, pulley_friction, pulley_radius, slack_cable, swivel_offset,
    tape_outlier, tape_scale, target_tilt, tracker_axes, tracker_clock, tracker_frame,
    tracker_latency, tracker_moved, tracker_outlier, tracker_scale, tracker_target, tracker_tilt,
    winch_backlash, winch_offset, winch_scale, winch_scale_common,
};

/// All effects that poses at rest can reveal, in the order in which reports list them.
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

/// All effects that only recordings in motion reveal. They are a separate list so that poses at rest are not
/// tested for them: each further hypothesis costs power.
pub static IN_MOTION: &[&Effect] = &[
    &tracker_latency::EFFECT,
    &tracker_clock::EFFECT,
    &encoder_latency::EFFECT,
    &force_latency::EFFECT,
    &laser_latency::EFFECT,
    &pulley_drag::EFFECT,
];

/// All effects that only the poses of an external instrument reveal; a separate list for the same reason.
pub static OF_EXTERNAL_POSES: &[&Effect] = &[
    &tracker_frame::EFFECT,
    &tracker_target::EFFECT,
    &tracker_tilt::EFFECT,
    &tracker_scale::EFFECT,
    &tracker_axes::EFFECT,
    &tracker_moved::EFFECT,
    &tracker_outlier::EFFECT,
];

/// All effects that only distances between poses reveal; a separate list for the same reason.
pub static OF_DISTANCES: &[&Effect] = &[&tape_scale::EFFECT, &tape_outlier::EFFECT];

/// All effects at whose poses readings do not obey the model. A diagnosis compares the poses with and without these readings, so
/// that no search has them as candidates.
static SET_ASIDE: &[&Effect] = &[&slack_cable::EFFECT];

/// All named effects.
pub fn every_effect() -> impl Iterator<Item = &'static Effect> {
    let shown_at_rest = CATALOGUE.iter().chain(SET_ASIDE).chain(OF_EXTERNAL_POSES);
    shown_at_rest.chain(OF_DISTANCES).chain(IN_MOTION).copied()
}

/// The effect with this identifier.
#[must_use]
pub fn find(id: &str) -> Option<&'static Effect> {
    every_effect().find(|effect| effect.id() == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_unique_and_priors_positive() {
        for effect in every_effect() {
            let same = every_effect().filter(|e| e.id() == effect.id());
            assert_eq!(same.count(), 1);
            assert!(effect.parameters().iter().all(|p| p.prior_sd > 0.0));
        }
    }
}

//! Effects: the catalogue against its table, slopes, formulas, and the recovery of hidden effects.

mod binding;
mod exchange;
mod external_poses;
mod formulas;
mod holes;
pub(crate) mod recovery;
mod slopes;
mod texts;

use super::CATALOGUE;

/// The identifiers of the project's table of effects except `unknown`, which stands for errors that no effect explains.
const TABLE: [&str; 36] = [
    "winch_scale",
    "winch_scale_common",
    "winch_offset",
    "drum_eccentricity",
    "drum_growth",
    "winch_backlash",
    "encoder_drift",
    "cable_slip",
    "cable_stiffness",
    "cable_stiffening",
    "cable_creep",
    "cable_thermal",
    "cable_sag",
    "cable_swap",
    "pulley_radius",
    "pulley_axis_tilt",
    "pulley_friction",
    "platform_anchor",
    "payload_mass",
    "payload_com",
    "frame_compliance",
    "frame_thermal",
    "frame_shift",
    "laser_scale",
    "laser_bias",
    "laser_beam_tilt",
    "target_tilt",
    "laser_drift",
    "laser_cyclic",
    "laser_outliers",
    "encoder_outlier",
    "force_gain",
    "force_bias",
    "swivel_offset",
    "heading_offset",
    "inclinometer_tilt",
];

#[test]
fn every_effect_of_the_table_is_there_once() {
    let ids: Vec<_> = CATALOGUE.iter().map(|effect| effect.id()).collect();
    for id in TABLE {
        assert_eq!(ids.iter().filter(|i| **i == id).count(), 1, "{id}");
    }
    assert_eq!(ids.len(), TABLE.len());
}

#[test]
fn every_effect_describes_itself() {
    for effect in CATALOGUE {
        assert!(!effect.title().is_empty());
        for parameter in effect.parameters() {
            let [low, high] = parameter.typical;
            assert!(low < high, "{} {}", effect.id(), parameter.name);
            assert!(parameter.prior_sd > 0.0 && !parameter.unit.is_empty());
        }
    }
}

//! Body tracked by the external instrument that is mounted at an angle: the instrument reads the
//! orientation `R R_b` for the platform's `R`, where half the tilt (rad) is Rodrigues' parameters of the rotation `R_b`.
//! Combined with a rotated frame it is exact but for half the cross product of both. Typical 0.05 to 1 degree after an alignment by hand.

use super::direction::rotation_row;
use super::words::turn;
use super::{AsText, Dual, Effect, EffectParameter, PlatformContext, PlatformPorts, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "tracker_tilt",
    title: "Tilted body of the external instrument",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("tilt_x", "rad", 0.05, [0.001, 0.017]),
        EffectParameter::new("tilt_y", "rad", 0.05, [0.001, 0.017]),
        EffectParameter::new("tilt_z", "rad", 0.05, [0.001, 0.017]),
    ],
    cause: |found| {
        let tilts: Vec<f64> = (0..3).map(|k| found.value(k)).collect();
        format!(
            "The body that the external instrument follows is turned against the platform by {} (platform axes).",
            turn(&tilts)
        )
    },
    workshop: |found| {
        found.say("Level the platform, and zero the orientation of the external instrument there.")
    },
    check: Some(
        "Level the platform with a spirit level: the external instrument shows how its body is turned.",
    ),
    source: "Geometry",
    change_platform,
    as_text: AsText::Impossible("composes rotations, which formulas of single quantities do not"),
    ..Effect::NEUTRAL
};

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    let row = rotation_row([parameters[0], parameters[1], parameters[2]]);
    for (k, axis) in at.tracked_rotation.iter().enumerate() {
        ports.tracker_turn[k] += row[0] * axis[0] + row[1] * axis[1] + row[2] * axis[2];
    }
}

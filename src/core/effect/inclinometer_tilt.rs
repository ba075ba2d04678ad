//! Inclinometer mounted at a tilt: it reads the angles of `R S` instead of those of the platform's rotation `R`, with
//! `S = Rx(tilt_1) Ry(tilt_2)`, both in radians. As `R = Rx(roll) Ry(pitch) Rz(yaw)` of the reading times `S^T`, the
//! reading is corrected exactly; the correction is added to the prediction instead, so that only
//! the weights ignore it. An angle that was not read counts as 0. Typical 0.1 to 3 degrees.

use super::direction::{angles, product, rotation};
use super::words::turn;
use super::{
    AsText, Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope,
};

/// Standard deviations of sound parts, for small and large machines.
const TOLERANCE: [f64; 2] = [0.0005, 0.0005];
const SOURCE_OF_TOLERANCE: &str = "Mounting face of an inclinometer";

pub(super) static EFFECT: Effect = Effect {
    id: "inclinometer_tilt",
    title: "Tilted inclinometer",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("tilt_1", "rad", 0.05, [0.0017, 0.052])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
        EffectParameter::new("tilt_2", "rad", 0.05, [0.0017, 0.052])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
    ],
    cause,
    workshop: |found| {
        found.say("Check how the inclinometer is fastened, and zero it on the levelled platform.")
    },
    check: Some(
        "Read the inclinometer, turn it by half a turn about the vertical, and read it again.",
    ),
    source: "Geometry",
    change_platform,
    as_text: AsText::Impossible("composes rotations, which formulas of single quantities do not"),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The inclinometer sits tilted on the platform: {}.",
        turn(&[found.value(0), found.value(1)])
    )
}

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    let [roll, pitch, yaw] = at.inclination_rad;
    let read = rotation([roll, pitch, yaw].map(Dual::constant));
    // S^T = Ry(-tilt_2) Rx(-tilt_1).
    let none = Dual::constant(0.0);
    let back = product(
        &rotation([none, -parameters[1], none]),
        &rotation([-parameters[0], none, none]),
    );
    let platform = product(&read, &back);
    for (k, angle) in angles(&platform).into_iter().enumerate() {
        // Angles that differ by a full turn are equal.
        let turns = ((at.inclination_rad[k] - angle.value) / std::f64::consts::TAU).round();
        let change = -angle + (at.inclination_rad[k] - turns * std::f64::consts::TAU);
        ports.inclination_offset[k] += change;
    }
}

//! Axes of the external instrument that have scales of their own and are not at right angles: it reads `A x` for the point `x` of the
//! base frame, with `A = [1 + scale_x, skew_xy, skew_xz; 0, 1 + scale_y, skew_yz; 0, 0, 1 + scale_z]`, as a camera that looks at
//! its printed grid at an angle, or a grid pasted together. Typical 0.05 to 0.5 %; more than 1 % would be seen at once.

use super::Dual;
use super::words::{degrees, list, percent};
use super::{
    AsText, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope,
    tracker_scale,
};

pub(super) static EFFECT: Effect = Effect {
    id: "tracker_axes",
    title: "Axes of the external instrument",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("scale_x", "1", 0.02, [0.0005, 0.005]).within(-0.01, 0.01),
        EffectParameter::new("scale_y", "1", 0.02, [0.0005, 0.005]).within(-0.01, 0.01),
        EffectParameter::new("scale_z", "1", 0.02, [0.0005, 0.005]).within(-0.01, 0.01),
        EffectParameter::new("skew_xy", "1", 0.02, [0.0005, 0.005]).within(-0.01, 0.01),
        EffectParameter::new("skew_xz", "1", 0.02, [0.0005, 0.005]).within(-0.01, 0.01),
        EffectParameter::new("skew_yz", "1", 0.02, [0.0005, 0.005]).within(-0.01, 0.01),
    ],
    cause,
    workshop: |found| {
        found.say("Measure known distances along each axis and both diagonals with the external instrument, and correct its scales and angles.")
    },
    check: Some(tracker_scale::CHECK),
    source: "Affine transformation between two frames",
    change_platform,
    as_text: AsText::Impossible(
        "solves for three coordinates together, which formulas of single quantities do not",
    ),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let axes = ["x", "y", "z", "x and y", "x and z", "y and z"];
    let values = axes.iter().enumerate();
    let values = values.map(|(k, axis)| (k, found.value(k), axis));
    let largest = values
        .clone()
        .fold(0.0_f64, |most, (_, v, _)| most.max(v.abs()));
    let named = values.filter(|(_, v, _)| 10.0 * v.abs() >= largest);
    let words = named.map(|(k, v, axis)| match (k < 3, v < 0.0) {
        (true, false) => format!("{} too long along {axis}", percent(v)),
        (true, true) => format!("{} too short along {axis}", percent(v)),
        (false, false) => format!("{} too narrow between {axis}", degrees(v)),
        (false, true) => format!("{} too wide between {axis}", degrees(v)),
    });
    format!(
        "The external instrument has other scales along its axes or other angles between them: its readings are {}.",
        list(&words.collect::<Vec<_>>())
    )
}

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    let [sx, sy, sz, xy, xz, yz] = [0, 1, 2, 3, 4, 5].map(|k| parameters[k]);
    let [x, y, z] = at.tracked_m;
    let inner_z = Dual::constant(z) / (sz + 1.0);
    let inner_y = (-(yz * inner_z) + y) / (sy + 1.0);
    let inner_x = (-(xy * inner_y + xz * inner_z) + x) / (sx + 1.0);
    for (shift, (read, inner)) in
        ports
            .tracker_shift
            .iter_mut()
            .zip([(x, inner_x), (y, inner_y), (z, inner_z)])
    {
        *shift += -inner + read;
    }
}

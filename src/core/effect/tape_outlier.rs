//! A single distance that was misread: `offset` (m) is added to the reading in row `row` of the distances.

use super::{AsText, Effect, EffectParameter, Scope, Search};

pub(super) static EFFECT: Effect = Effect {
    id: "tape_outlier",
    title: "Misread distance",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::given("row", "1", [1.0, 100.0]),
        EffectParameter::new("offset", "m", 0.1, [0.002, 0.1]),
    ],
    cause: |found| {
        found.say("The distance between poses in {0:row} was read {1:mm} too {1:long|short}.")
    },
    workshop: |found| found.say("Measure the distance in {0:row} again, or delete the row."),
    check: Some("Measure the distance between these two poses again."),
    source: "A single wrong reading",
    search: Search::AtDistance(0),
    change_distance: |parameters, row, ports| {
        if parameters[0].value == row as f64 {
            ports.shift += parameters[1];
        }
    },
    is_damage: true,
    as_text: AsText::Impossible(
        "changes a distance between poses, while formulas change readings of one pose",
    ),
    ..Effect::NEUTRAL
};

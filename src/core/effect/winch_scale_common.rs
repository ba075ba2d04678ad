//! Effective diameter error common to all drums, as by a wrong cable diameter: cable per
//! revolution times `1 + scale`. Typical 0.1 to 1 %.

use super::{AsText, Effect, EffectParameter, FoundEffect, Scope, Stage, winch_scale};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "winch_scale_common",
    title: "Winch scale common to all",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("scale", "1", 0.01, [0.001, 0.01])],
    cause: winch_scale::cause,
    workshop,
    check: Some("Measure one distance between two poses of the platform with a steel tape."),
    source: "Geometry of a drum; sizes from winch ratio errors reported for cable robots",
    stage: Stage::Ratio,
    change_cable: winch_scale::change_cable,
    variable: Some(Variable::CableLength),
    as_text: AsText::Formulas(&[("paid", "paid * (1 + scale)")]),
    ..Effect::NEUTRAL
};

fn workshop(found: &FoundEffect<'_>) -> String {
    if !found.counts_revolutions() {
        return winch_scale::workshop(found);
    }
    "Measure the drum and the cable of one winch with calipers and correct the drum diameter of all in the controller: it is measured to the centre of the cable. Check the gear ratio there, too.".to_owned()
}

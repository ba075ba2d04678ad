//! Effective drum diameter that differs from the stated one: cable per revolution times `1 + scale`; for absolute lengths
//! the length times `1 + scale`. Typical 0.1 to 3 % (winch ratio errors of cable robots).

use super::{
    AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Scope, Stage,
};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "winch_scale",
    title: "Winch scale",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("scale", "1", 0.03, [0.001, 0.03]).with_tolerance(
            [0.0002, 0.0003],
            "Drum turned to IT7 of ISO 286-1 (0.035 mm on 100 mm), and the spread of the \
             cable diameter that lies on it",
        ),
    ],
    cause,
    workshop,
    check: Some(
        "Pay out a few metres of cable and compare what the controller counts with a steel tape.",
    ),
    source: "Geometry of a drum; sizes from winch ratio errors reported for cable robots",
    stage: Stage::Ratio,
    change_cable,
    variable: Some(Variable::CableLength),
    as_text: AsText::Formulas(&[("paid", "paid * (1 + scale)")]),
    ..Effect::NEUTRAL
};

pub(super) fn cause(found: &FoundEffect<'_>) -> String {
    found.say(if found.counts_revolutions() {
        "{winch} {pays|pay} out {0:%} {0:more|less} cable per revolution than {its drum diameter implies|their drum diameters imply}."
    } else {
        "{cable} {is|are} {0:%} {0:longer|shorter} than {its length reading says|their length readings say}."
    })
}

pub(super) fn workshop(found: &FoundEffect<'_>) -> String {
    found.say(if found.counts_revolutions() {
        "Measure the {drum|drums} of {winch} with calipers, cable layer included, and correct the drum {diameter|diameters} in the controller. Check the gear ratio there, too."
    } else {
        "Compare the length {reading|readings} of {cable} with a tape measure at two lengths far apart, and correct the scale in the controller."
    })
}

pub(super) fn change_cable(parameters: &[Dual], _at: &CableContext, ports: &mut CablePorts) {
    ports.paid *= parameters[0] + 1.0;
}

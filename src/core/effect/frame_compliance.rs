//! Compliant frame: every entry point moves by `C f_h` with the compliance `C` (m/N) and the horizontal part
//! `f_h` of the force of the cable on its pulley, that is tension times the horizontal part of the unit
//! vector from pulley to platform. Without gravity the whole force counts.
//!
//! Approximations: the direction is that of the nominal geometry at the commanded pose (or the tracker's, else the
//! home pose), the tension is that fitted to the sensor. Pulleys do not couple. Typical 1e-7 to 1e-4 m/N.

use super::words::millimetres;
use super::{AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "frame_compliance",
    title: "Compliance of the frame",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("compliance", "m/N", 0.0001, [0.0000001, 0.0001])
            .within(0.0, f64::INFINITY)
            .with_tolerance(
                [3e-08, 3e-08],
                "Bolted steel posts braced for a few tens of newtons per micrometre",
            ),
    ],
    cause,
    workshop: |found| {
        found.say("Check the bolts of the posts that carry the pulleys, and brace the posts. Lower tensions make the movement smaller.")
    },
    check: Some("Put a dial gauge at a pulley and pull its cable with a known force."),
    source: "Linear elasticity, one compliance for all pulleys",
    change_cable,
    variable: Some(Variable::Tension),
    as_text: AsText::Formulas(&[
        (
            "entry_shift_x",
            "entry_shift_x + compliance * tension * pull_x",
        ),
        (
            "entry_shift_y",
            "entry_shift_y + compliance * tension * pull_y",
        ),
        (
            "entry_shift_z",
            "entry_shift_z + compliance * tension * pull_z",
        ),
    ]),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    found.say_with(
        "The frame yields: every 1 kN of horizontal cable force moves a pulley by {} {0:towards|away from} the platform.",
        &millimetres(1000.0 * found.value(0)),
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    for k in 0..3 {
        let force_n = at.tension_n * at.pull_horizontal[k];
        ports.entry_shift[k] += parameters[0] * force_n;
    }
}

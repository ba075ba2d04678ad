//! Play between motor and drum: `paid += dir play / 2`, with `dir` = +1 where the cable was paid out on the
//! way to the pose and -1 where it was reeled in; metres.
//!
//! The direction is the sign of the change of the reading since the row before, 0 at the first row. So
//! it is wrong where a cable moved by less than the play; a simulation knows the true direction.
//! Typical 0.2 to 2 mm. Source: dead band of half the play to either side, as in any drive with play.

use super::words::{self, sentence};
use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct WinchBacklash;

impl Effect for WinchBacklash {
    fn id(&self) -> &'static str {
        "winch_backlash"
    }
    fn title(&self) -> &'static str {
        "Winch backlash"
    }
    fn scope(&self) -> Scope {
        Scope::CableOrAll
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("play", "m", 0.002, [0.0002, 0.002])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        sentence(&format!(
            "{} {} {} of play: at the same reading {} {} after paying out than after reeling in.",
            found.name(Part::Winch),
            found.either("has", "have"),
            found.millimetres(0),
            found.either("its cable is", "their cables are"),
            found.way(0, "longer", "shorter"),
        ))
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Check the coupling, the set screws and the gearbox of {} for play. Until it is mended, approach poses always from the same side.",
            found.name(Part::Winch),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some(words::GO_FROM_EITHER_SIDE)
    }
    fn source(&self) -> &'static str {
        "Dead band of half the play to either side, as in any drive with play"
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        ports.paid += parameters[0] * (0.5 * at.direction);
    }
}

//! A length reading that is wrong: `error` (m) is contained in the cable paid out, or in the length, that was read
//! at the pose labelled `pose`.

use super::words;
use super::{
    CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope, Search,
};

/// See the module documentation.
#[derive(Debug)]
pub struct EncoderOutlier;

impl Effect for EncoderOutlier {
    fn id(&self) -> &'static str {
        "encoder_outlier"
    }
    fn title(&self) -> &'static str {
        "Outlier of an encoder"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[
                EffectParameter::given("pose", "1", [1.0, 100.0]),
                EffectParameter::new("error", "m", 0.1, [0.005, 0.1]),
            ]
        }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        format!(
            "The length {} of {} at {} {} {} too {}.",
            found.either("reading", "readings"),
            found.name(Part::Cable),
            found.pose(0),
            found.either("is", "are"),
            found.millimetres(1),
            found.way(1, "long", "short"),
        )
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Measure {} again, or leave the length {} of {} out there. If it happens again, check encoder, plug and wiring of {}.",
            found.pose(0),
            found.either("reading", "readings"),
            found.name(Part::Cable),
            found.name(Part::Winch),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some(words::GO_THERE_AGAIN)
    }
    fn source(&self) -> &'static str {
        "A single wrong reading"
    }
    fn search(&self) -> Search {
        Search::AtPose(0)
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        if at.is_at(parameters[0].value) {
            ports.paid += -parameters[1];
        }
    }
}

//! Origin of an effect in a session's model.

use serde_json::Value;
use tautline_core::effect::EffectSetting;
use tautline_session::{Session, Timestamp, VersionedFile as _};

use super::DiagnosisDocument;

/// The diagnosis that proposed an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proposal {
    /// Time of the diagnosis.
    pub time: Timestamp,
    /// Probability of the effect according to the diagnosis.
    pub probability: f64,
}

/// The last diagnosis of a session that proposed this effect, as a finding or as an alternative of one.
#[must_use]
pub fn proposal(session: &Session, effect: &EffectSetting) -> Option<Proposal> {
    let results = session.results().iter().rev();
    let mut diagnoses = results.filter(|one| one.format() == Some(DiagnosisDocument::FORMAT));
    diagnoses.find_map(|diagnosis| {
        let document = diagnosis.document.value();
        let findings = document["findings"].as_array()?;
        let causes = findings.iter().flat_map(|finding| {
            let others = finding["alternatives"].as_array();
            [finding].into_iter().chain(others.into_iter().flatten())
        });
        let mut named = causes.filter(|cause| is_of(cause, effect));
        Some(Proposal {
            time: diagnosis.time,
            probability: named.next()?["probability"].as_f64()?,
        })
    })
}

/// Whether a cause of a document contains this effect; a cause on several cables is an effect on each of them.
fn is_of(cause: &Value, effect: &EffectSetting) -> bool {
    let targets = cause["targets"].as_array().map_or(&[][..], Vec::as_slice);
    let has = |name: &String| targets.iter().any(|target| target == name.as_str());
    cause["effect"] == effect.effect.as_str()
        && targets.is_empty() == effect.targets.is_empty()
        && effect.targets.iter().all(has)
}

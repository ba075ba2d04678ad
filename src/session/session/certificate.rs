//! What a calibration certificate states beside the results.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Timestamp;
use crate::json::VersionedFile;

/// What a calibration certificate states beside the results (ISO/IEC 17025:2017, 7.8.2, 7.8.4 and 7.8.6). An empty text is not
/// stated; dates are written `2026-11-28`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct CertificateDetails {
    /// Number of the certificate.
    pub number: String,
    /// Name and address of the laboratory that issues it.
    pub laboratory: String,
    /// Its country: two letters of ISO 3166-1.
    pub country: String,
    /// Place where the robot was measured.
    pub place: String,
    /// Maker of the robot.
    pub manufacturer: String,
    /// First day of measuring.
    pub measured_from: String,
    /// Last day of measuring.
    pub measured_to: String,
    /// Temperature of frame and cables (degrees Celsius).
    pub temperature_c: Option<f64>,
    /// Standard uncertainty of this temperature (K).
    pub temperature_sd_k: Option<f64>,
    /// Thermal expansion of the frame (1/K), by which lengths are stated for 20 degrees Celsius.
    pub expansion_per_k: Option<f64>,
    /// Load, speed and time of warming up of the robot.
    pub operation: String,
    /// By which rule conformity is stated.
    pub decision_rule: DecisionRule,
    /// Instruments that were used.
    pub instruments: Vec<CalibratedInstrument>,
}

impl CertificateDetails {
    /// Whether the country has the form of ISO 3166-1: two capital letters.
    #[must_use]
    pub fn has_country(&self) -> bool {
        let letters = self.country.trim().as_bytes();
        letters.len() == 2 && letters.iter().all(u8::is_ascii_uppercase)
    }
}

/// Decision rule of statements of conformity (ILAC-G8:09/2019).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DecisionRule {
    /// The expanded uncertainty (k = 2) counts against whichever verdict is claimed.
    #[default]
    ExpandedUncertainty,
    /// A verdict needs a probability of 95 % (ISO 14253-1:2017).
    Probability95,
    /// The estimate alone decides.
    SimpleAcceptance,
}

impl DecisionRule {
    /// All rules.
    pub const ALL: [Self; 3] = [
        Self::ExpandedUncertainty,
        Self::Probability95,
        Self::SimpleAcceptance,
    ];
}

/// An instrument of the workshop with its own calibration.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct CalibratedInstrument {
    /// What it is, with maker and type.
    pub name: String,
    /// Serial number.
    pub serial_number: String,
    /// Number of its certificate of calibration.
    pub certificate: String,
    /// Date of its calibration.
    pub calibrated_on: String,
    /// Date on which the next one is due.
    pub due_on: String,
    /// Laboratory or national institute to whose standards it is traceable.
    pub traceable_to: String,
}

impl CalibratedInstrument {
    /// Whether its calibration was due before a time.
    #[must_use]
    pub fn is_overdue(&self, now: Timestamp) -> bool {
        day(&self.due_on).is_some_and(|due| due.unix_seconds() + 86_400 <= now.unix_seconds())
    }
}

/// Begin of a day written `2026-11-28` (UTC); `None` for any other text.
#[must_use]
pub fn day(date: &str) -> Option<Timestamp> {
    format!("{}T00:00:00Z", date.trim()).parse().ok()
}

impl VersionedFile for CertificateDetails {
    const FORMAT: &'static str = "tautline-certificate-details";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 20;
    const KEYS_ARE_CHECKED: bool = true;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_calibration_is_overdue_on_the_day_after() {
        let due = CalibratedInstrument {
            due_on: "2026-11-28".to_owned(),
            ..CalibratedInstrument::default()
        };
        let at = |text: &str| text.parse().expect("a time");
        assert!(!due.is_overdue(at("2026-11-28T23:59:59Z")));
        assert!(due.is_overdue(at("2026-11-29T00:00:00Z")));
        assert!(!CalibratedInstrument::default().is_overdue(at("2026-11-29T00:00:00Z")));
        assert_eq!(day("2026-02-30"), None);
    }
}

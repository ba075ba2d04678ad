//! The catalogue of distance sensors: manufacturers' specifications converted to standard deviations.

mod catalogue;
mod noise;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::error::fail;
use crate::json::VersionedFile;
pub(crate) use catalogue::resolve_in_robot;
pub use catalogue::{Catalogue, CatalogueEntry};

/// A distance sensor. All standard deviations refer to a single reading, 1 sd.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sensor {
    /// Name to display.
    pub name: String,
    /// Manufacturer; absent for a generic class.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maker: Option<String>,
    /// Random part: scatter of the readings at one place (m).
    pub random_sd_m: f64,
    /// Growth of the random part with the distance, piecewise from near to far; empty: constant.
    #[serde(default)]
    pub growth: Vec<Growth>,
    /// Prior standard deviation of an offset common to all readings (m).
    #[serde(default)]
    pub bias_sd_m: f64,
    /// Prior standard deviation of the nonlinearity, a smooth function of the distance (m).
    #[serde(default)]
    pub linearity_sd_m: f64,
    /// Correlation length of the nonlinearity (m).
    #[serde(default = "one_metre")]
    pub linearity_length_m: f64,
    /// Resolution of the readings (m).
    #[serde(default)]
    pub quantisation_m: f64,
    /// Readings per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Smallest and largest distance (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_m: Option<[f64; 2]>,
    /// Prior standard deviation of the temperature coefficient of a reading (m/K).
    #[serde(default)]
    pub temperature_sd_m_per_k: f64,
    /// Price for comparison in a study, in any currency.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
    /// Values that are assumptions rather than the manufacturer's, with the reasons.
    #[serde(default)]
    pub assumed: String,
    /// Sources of the values.
    #[serde(default)]
    pub sources: Vec<SensorSource>,
}

/// Growth of the random part beyond a distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Growth {
    /// Distance beyond which it applies (m).
    pub from_m: f64,
    /// Growth per metre (1).
    pub sd_per_m: f64,
}

/// A statement of the manufacturer, or of somebody who quotes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SensorSource {
    /// Literal quotation.
    pub quote: String,
    /// Document or page.
    pub title: String,
    /// Address of the document.
    #[serde(default)]
    pub address: String,
    /// Date of access or issue: `2026-11-22`, `2018-10-04`.
    pub date: String,
}

fn one_metre() -> f64 {
    1.0
}

impl VersionedFile for Sensor {
    const FORMAT: &'static str = "tautline-sensor";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 20;

    fn check(&self) -> Result<(), FieldError> {
        let expect = |key: &str, value: f64, is_good: bool, what: &str| match is_good {
            true => Ok(()),
            false => fail(format!("/{key}"), format!("found {value}, expected {what}")),
        };
        let not_negative = |value: f64| value.is_finite() && value >= 0.0;
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let at_least_0 = "0 or a greater number";
        let above_0 = "a number greater than 0";
        for (key, value) in [
            ("bias_sd_m", self.bias_sd_m),
            ("linearity_sd_m", self.linearity_sd_m),
            ("quantisation_m", self.quantisation_m),
            ("temperature_sd_m_per_k", self.temperature_sd_m_per_k),
            ("cost", self.cost.unwrap_or(0.0)),
        ] {
            expect(key, value, not_negative(value), at_least_0)?;
        }
        for (key, value) in [
            ("random_sd_m", self.random_sd_m),
            ("linearity_length_m", self.linearity_length_m),
            ("rate_hz", self.rate_hz.unwrap_or(1.0)),
        ] {
            expect(key, value, positive(value), above_0)?;
        }
        for (index, growth) in self.growth.iter().enumerate() {
            let key = |name: &str| format!("growth/{index}/{name}");
            let [from, by] = [growth.from_m, growth.sd_per_m];
            expect(&key("from_m"), from, not_negative(from), at_least_0)?;
            expect(&key("sd_per_m"), by, not_negative(by), at_least_0)?;
        }
        match self.range_m {
            Some([low, high]) if !(low >= 0.0 && high > low && high.is_finite()) => {
                let message = format!("found {low} to {high}, expected a rising range");
                fail("/range_m", message)
            }
            _ => Ok(()),
        }
    }
}

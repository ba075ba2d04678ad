//! The catalogue of distance sensors: what makers state, translated to standard deviations.

mod catalogue;
mod noise;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::error::fail;
use crate::json::VersionedFile;
pub(crate) use catalogue::resolve_in_robot;
pub use catalogue::{Catalogue, CatalogueEntry};

/// A distance sensor. All standard deviations are of one reading, 1 sd.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sensor {
    /// Name for a reader.
    pub name: String,
    /// Maker; absent for a class without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maker: Option<String>,
    /// Random part: what differs from reading to reading at one place (m).
    pub random_sd_m: f64,
    /// Growth of the random part with the distance, in pieces from near to far; none: it stays.
    #[serde(default)]
    pub growth: Vec<Growth>,
    /// Prior of an offset common to all readings (m).
    #[serde(default)]
    pub bias_sd_m: f64,
    /// Prior of the deviation from a straight line, a smooth function of the distance (m).
    #[serde(default)]
    pub linearity_sd_m: f64,
    /// Distance over which that deviation changes (m).
    #[serde(default = "one_metre")]
    pub linearity_length_m: f64,
    /// Step of the readings (m).
    #[serde(default)]
    pub quantisation_m: f64,
    /// Readings per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Least and largest distance (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_m: Option<[f64; 2]>,
    /// Prior of the change of a reading with the temperature (m/K).
    #[serde(default)]
    pub temperature_sd_m_per_k: f64,
    /// Price that a study may compare, in any currency.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
    /// Which values are ours and not the maker's, and why they were chosen.
    #[serde(default)]
    pub assumed: String,
    /// Where the values come from.
    #[serde(default)]
    pub sources: Vec<SensorSource>,
}

/// Growth of a random part from a distance on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Growth {
    /// From this distance (m).
    pub from_m: f64,
    /// By so much per metre (1).
    pub sd_per_m: f64,
}

/// What a maker, or somebody who quotes it, says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SensorSource {
    /// The wording.
    pub quote: String,
    /// Document or page.
    pub title: String,
    /// Its address.
    #[serde(default)]
    pub address: String,
    /// When it was read or issued: `2026-11-22`, `2018-10-04`.
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

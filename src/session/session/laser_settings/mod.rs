//! Source of the laser distance.

mod text;

use std::ops::RangeInclusive;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::error::fail;

/// Valid baud rates.
const BAUD: RangeInclusive<u32> = 50..=4_000_000;
/// Valid maximum ages of a reading (s).
const FRESH_S: RangeInclusive<f64> = 0.05..=60.0;
/// Length limit of text settings (bytes).
const LONGEST: usize = 250;
/// Memory limit of a pattern (bytes).
const PATTERN_BYTES: usize = 1 << 20;

/// Source of the laser distance.
///
/// As text: `controller`, `manual`, `tcp:HOST:PORT` or `serial:PORT` or `serial:PORT:BAUD`; the last three with
/// settings `?key=value&key=value`, in which `%XX` is the byte of this hexadecimal number. Keys: `pattern`, `unit`,
/// `scale`, `offset_m`, `no_return` (once or several times), `command`, `fresh_s`, and `parity` and `stop_bits` of
/// serial ports.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum LaserSettings {
    /// The controller, together with its other readings.
    #[default]
    Controller,
    /// Typed by the operator.
    Manual,
    /// A device that sends lines of text.
    Line(LineLaserSettings),
}

/// A device that sends lines of text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LineLaserSettings {
    /// Port of the device.
    pub port: LaserPort,
    /// Regular expression for a line with a distance; its group `distance` is the number, and its group
    /// `unit`, if there is one, must match the unit. Default: the first standalone number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pattern: Option<String>,
    /// Unit of the number.
    #[serde(default)]
    pub unit: LaserUnit,
    /// Factor from the number to the distance in that unit.
    #[serde(default = "one")]
    pub scale: f64,
    /// Offset added to the distance (m).
    #[serde(default)]
    pub offset_m: f64,
    /// Texts that mark a line without a return.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub no_return: Vec<String>,
    /// Command that requests a reading, including its line end; absent: the device sends on its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// Maximum age of a usable reading (s).
    #[serde(default = "one")]
    pub fresh_s: f64,
}

/// Port of a device that sends lines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum LaserPort {
    /// A network port.
    Tcp {
        /// Name or address.
        host: String,
        /// Port.
        port: u16,
    },
    /// A serial port, with 8 data bits.
    Serial {
        /// Device name, such as `/dev/ttyUSB0` or `COM3`.
        device: String,
        /// Baud rate.
        #[serde(default = "usual_baud")]
        baud: u32,
        /// Parity.
        #[serde(default)]
        parity: LaserParity,
        /// Stop bits, 1 or 2.
        #[serde(default = "one_bit")]
        stop_bits: u8,
    },
}

/// Unit of a distance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LaserUnit {
    /// Metre.
    M,
    /// Millimetre.
    #[default]
    Mm,
    /// Micrometre.
    Um,
}

/// Parity of a serial port.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LaserParity {
    /// No parity bit.
    #[default]
    None,
    /// Odd.
    Odd,
    /// Even.
    Even,
}

fn one() -> f64 {
    1.0
}
fn usual_baud() -> u32 {
    9600
}
fn one_bit() -> u8 {
    1
}

impl LaserUnit {
    /// Metres per unit.
    #[must_use]
    pub fn metres(self) -> f64 {
        match self {
            Self::M => 1.0,
            Self::Mm => 1e-3,
            Self::Um => 1e-6,
        }
    }

    /// Symbol of the unit.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::M => "m",
            Self::Mm => "mm",
            Self::Um => "um",
        }
    }
}

impl LaserPort {
    /// A serial port with the usual settings.
    #[must_use]
    pub fn serial(device: impl Into<String>) -> Self {
        Self::Serial {
            device: device.into(),
            baud: usual_baud(),
            parity: LaserParity::None,
            stop_bits: one_bit(),
        }
    }
}

impl LineLaserSettings {
    /// A device that sends distances in millimetres on its own.
    #[must_use]
    pub fn new(port: LaserPort) -> Self {
        Self {
            port,
            pattern: None,
            unit: LaserUnit::Mm,
            scale: one(),
            offset_m: 0.0,
            no_return: Vec::new(),
            command: None,
            fresh_s: one(),
        }
    }

    /// The regular expression for a line with a distance, with its group `distance`.
    ///
    /// # Errors
    /// If the pattern is invalid.
    pub fn expression(&self) -> Result<regex::Regex, String> {
        // Only plain numbers are distances: not "E255", one half of "12,5" or "1.2.3". Before a number there may only be a
        // word that denotes a distance, so the numbers of "ERR 12" and "T: 23.5" are not distances.
        const PLAIN: &str = r"^(?i:(?:d|dist|distance|l|length|range)(?:\s*[:=]\s*|\s+))?(?<distance>[+-]?[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)(?:\s*(?<unit>m|mm|um))?(?:[\s;]|$)";
        let pattern = self.pattern.as_deref().unwrap_or(PLAIN);
        let built = regex::RegexBuilder::new(pattern)
            .size_limit(PATTERN_BYTES)
            .build();
        let expression =
            built.map_err(|_| format!("found {pattern:?}, expected a valid regular expression"))?;
        let mut names = expression.capture_names().flatten();
        match names.any(|name| name == "distance") {
            true => Ok(expression),
            false => Err(format!(
                "found {pattern:?}, expected a regular expression with a group (?<distance>...)"
            )),
        }
    }

    fn check(&self) -> Result<(), FieldError> {
        check_port(&self.port)?;
        if let Some(pattern) = &self.pattern {
            short("/pattern", pattern)?;
        }
        if let Err(message) = self.expression() {
            return fail("/pattern", message);
        }
        if !(self.scale.is_finite() && self.scale > 0.0) {
            let message = format!("found {}, expected a positive factor", self.scale);
            return fail("/scale", message);
        }
        if !self.offset_m.is_finite() {
            let message = format!("found {}, expected a finite number", self.offset_m);
            return fail("/offset_m", message);
        }
        for (k, text) in self.no_return.iter().enumerate() {
            short(&format!("/no_return/{k}"), text)?;
        }
        if let Some(command) = &self.command {
            short("/command", command)?;
        }
        if !FRESH_S.contains(&self.fresh_s) {
            let [low, high] = [FRESH_S.start(), FRESH_S.end()];
            let message = format!("found {}, expected {low} s to {high} s", self.fresh_s);
            return fail("/fresh_s", message);
        }
        Ok(())
    }
}

fn check_port(port: &LaserPort) -> Result<(), FieldError> {
    match port {
        LaserPort::Tcp { host, port } => {
            short("/port/tcp/host", host)?;
            if *port == 0 {
                return fail("/port/tcp/port", "found 0, expected a port from 1 to 65535");
            }
        }
        LaserPort::Serial {
            device,
            baud,
            stop_bits,
            ..
        } => {
            short("/port/serial/device", device)?;
            if !BAUD.contains(baud) {
                let [low, high] = [BAUD.start(), BAUD.end()];
                let message = format!("found {baud}, expected {low} to {high} bits per second");
                return fail("/port/serial/baud", message);
            }
            if !(1..=2).contains(stop_bits) {
                let message = format!("found {stop_bits}, expected 1 or 2");
                return fail("/port/serial/stop_bits", message);
            }
        }
    }
    Ok(())
}

fn short(at: &str, text: &str) -> Result<(), FieldError> {
    if !text.trim_matches(' ').is_empty() && text.len() <= LONGEST {
        return Ok(());
    }
    let length = text.len();
    let message =
        format!("found a text of {length} bytes, expected 1 to {LONGEST} that are not all blank");
    fail(at, message)
}

impl LaserSettings {
    /// Checks the settings.
    ///
    /// # Errors
    /// The first invalid field.
    pub fn check(&self) -> Result<(), FieldError> {
        match self {
            Self::Controller | Self::Manual => Ok(()),
            Self::Line(line) => line.check(),
        }
    }

    /// Whether the laser is read by the controller.
    #[must_use]
    pub fn is_controller(&self) -> bool {
        *self == Self::Controller
    }
}

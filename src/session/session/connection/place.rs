//! Which controller is connected, and its address.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::error::fail;

/// Valid timeouts (s).
pub(super) const TIMEOUT_S: std::ops::RangeInclusive<f64> = 0.05..=60.0;
/// Valid playback speeds, relative to that of the recording.
const SPEED: std::ops::RangeInclusive<f64> = 0.1..=100.0;

/// Which controller is connected.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ControllerKind {
    /// A simulated robot.
    #[default]
    Simulated,
    /// A recorded dataset that is played back.
    Recording,
    /// A Beckhoff controller, by ADS.
    Ads,
    /// A controller that speaks OPC UA.
    OpcUa,
}

impl ControllerKind {
    /// Whether it is the simulated robot.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        *self == Self::Simulated
    }
}

/// A recorded dataset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RecordingPlace {
    /// Its folder.
    pub folder: String,
    /// Playback speed relative to the recording, 0.1 to 100.
    #[serde(default = "super::one")]
    pub speed: f64,
}

impl RecordingPlace {
    /// Checks it; pointers count from it.
    ///
    /// # Errors
    /// The first field that is wrong.
    pub fn check(&self) -> Result<(), FieldError> {
        if self.folder.trim().is_empty() {
            return fail("/folder", "found nothing, expected the folder of a dataset");
        }
        if !SPEED.contains(&self.speed) {
            let [low, high] = [SPEED.start(), SPEED.end()];
            let message = format!("found {}, expected {low} to {high}", self.speed);
            return fail("/speed", message);
        }
        Ok(())
    }
}

/// Address of an ADS controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdsPlace {
    /// Name or address of its computer.
    pub host: String,
    /// Its TCP port.
    #[serde(default = "router_port")]
    pub port: u16,
    /// The six numbers of its AMS Net ID.
    pub net_id: [u8; 6],
    /// The AMS port of its program.
    #[serde(default = "program_port")]
    pub ams_port: u16,
    /// Timeout of a connection or an answer (s), 0.05 to 60.
    #[serde(default = "super::one")]
    pub timeout_s: f64,
}

impl AdsPlace {
    /// TCP port on which routers listen.
    pub const ROUTER_PORT: u16 = 48898;
    /// AMS port of the first program in TwinCAT 3.
    pub const PROGRAM_PORT: u16 = 851;

    /// Checks it; pointers count from it.
    ///
    /// # Errors
    /// The first field that is wrong.
    pub fn check(&self) -> Result<(), FieldError> {
        host(&self.host)?;
        for (at, port) in [("/port", self.port), ("/ams_port", self.ams_port)] {
            if port == 0 {
                return fail(at, "found 0, expected a port from 1 to 65535");
            }
        }
        timeout(self.timeout_s)
    }
}

/// Address of a controller that speaks OPC UA.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OpcUaPlace {
    /// Name or address of its computer.
    pub host: String,
    /// Its TCP port.
    #[serde(default = "opcua_port")]
    pub port: u16,
    /// What follows in its address, with the slash; most controllers have nothing there.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub path: String,
    /// Timeout of a connection or an answer (s), 0.05 to 60.
    #[serde(default = "super::one")]
    pub timeout_s: f64,
}

impl OpcUaPlace {
    /// TCP port that the standard reserves.
    pub const PORT: u16 = 4840;

    /// Checks it; pointers count from it.
    ///
    /// # Errors
    /// The first field that is wrong.
    pub fn check(&self) -> Result<(), FieldError> {
        host(&self.host)?;
        if self.port == 0 {
            return fail("/port", "found 0, expected a port from 1 to 65535");
        }
        let path = &self.path;
        if !path.is_empty() && (!path.starts_with('/') || path.contains(char::is_whitespace)) {
            let message = format!("found {path:?}, expected nothing or a path such as /UA/Server");
            return fail("/path", message);
        }
        timeout(self.timeout_s)
    }
}

fn host(host: &str) -> Result<(), FieldError> {
    match host.is_empty() || host.contains(char::is_whitespace) {
        true => fail(
            "/host",
            format!("found {host:?}, expected a name or an address"),
        ),
        false => Ok(()),
    }
}

fn timeout(timeout_s: f64) -> Result<(), FieldError> {
    if TIMEOUT_S.contains(&timeout_s) {
        return Ok(());
    }
    let [low, high] = [TIMEOUT_S.start(), TIMEOUT_S.end()];
    fail(
        "/timeout_s",
        format!("found {timeout_s}, expected {low} s to {high} s"),
    )
}

fn opcua_port() -> u16 {
    OpcUaPlace::PORT
}

fn router_port() -> u16 {
    AdsPlace::ROUTER_PORT
}

fn program_port() -> u16 {
    AdsPlace::PROGRAM_PORT
}

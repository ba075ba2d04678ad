//! Kind of controller and its address.

use std::borrow::Cow;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::error::fail;

/// Valid timeouts (s).
pub(super) const TIMEOUT_S: std::ops::RangeInclusive<f64> = 0.05..=60.0;
/// Valid playback speeds, relative to that of the recording.
const SPEED: std::ops::RangeInclusive<f64> = 0.1..=100.0;

/// Kind of controller.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ControllerKind {
    /// A simulated robot.
    #[default]
    Simulated,
    /// A played-back dataset.
    Recording,
    /// A Beckhoff controller over ADS.
    Ads,
    /// A controller over OPC UA.
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
    /// Folder of the dataset.
    pub folder: String,
    /// Playback speed relative to the recording, 0.1 to 100.
    #[serde(default = "super::one")]
    pub speed: f64,
}

impl RecordingPlace {
    /// Checks the settings; pointers are relative to them.
    ///
    /// # Errors
    /// The first invalid field.
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
    /// Host name or address of the controller.
    pub host: String,
    /// Its TCP port.
    #[serde(default = "router_port")]
    pub port: u16,
    /// AMS Net ID, six numbers.
    pub net_id: [u8; 6],
    /// AMS port of the program.
    #[serde(default = "program_port")]
    pub ams_port: u16,
    /// Timeout for connecting and for responses (s), 0.05 to 60.
    #[serde(default = "super::one")]
    pub timeout_s: f64,
}

impl AdsPlace {
    /// Default TCP port of AMS routers.
    pub const ROUTER_PORT: u16 = 48898;
    /// AMS port of the first program in TwinCAT 3.
    pub const PROGRAM_PORT: u16 = 851;

    /// Checks the address; pointers are relative to it.
    ///
    /// # Errors
    /// The first invalid field.
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

/// Address of an OPC UA controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OpcUaPlace {
    /// Host name or address of the controller.
    pub host: String,
    /// Its TCP port.
    #[serde(default = "opcua_port")]
    pub port: u16,
    /// Path of the address with its leading slash; empty for most controllers.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub path: String,
    /// Timeout for connecting and for responses (s), 0.05 to 60.
    #[serde(default = "super::one")]
    pub timeout_s: f64,
}

impl OpcUaPlace {
    /// Default TCP port of the standard.
    pub const PORT: u16 = 4840;

    /// Checks the address; pointers are relative to it.
    ///
    /// # Errors
    /// The first invalid field.
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
    let shown = without_user(host);
    let is_strange = |c: char| c.is_whitespace() || c == '@';
    match host.is_empty() || host.contains(is_strange) {
        true => fail(
            "/host",
            format!("found {shown:?}, expected a name or an address, without a user"),
        ),
        false => Ok(()),
    }
}

/// An address for messages: without the user and the password that may stand before `@`.
#[must_use]
pub fn without_user(address: &str) -> Cow<'_, str> {
    let Some((user, rest)) = address.rsplit_once('@') else {
        return address.into();
    };
    let scheme = user.find("//").map_or("", |at| &user[..at + 2]);
    format!("{scheme}...@{rest}").into()
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

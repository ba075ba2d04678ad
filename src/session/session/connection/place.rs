//! Kind of controller and its address.

use std::borrow::Cow;
use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::error::{below, fail};

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
    /// Whether the controller is simulated.
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

/// Protection of the messages of OPC UA.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
pub enum OpcUaSecurity {
    /// Everybody on the network can read and change them.
    None,
    /// They can be read, but not changed unnoticed.
    Sign,
    /// They can be neither read nor changed.
    SignAndEncrypt,
}

impl OpcUaSecurity {
    /// All of them, the best last.
    pub const ALL: [Self; 3] = [Self::None, Self::Sign, Self::SignAndEncrypt];
}

impl fmt::Display for OpcUaSecurity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "None",
            Self::Sign => "Sign",
            Self::SignAndEncrypt => "SignAndEncrypt",
        })
    }
}

/// Algorithms for the protection of the messages of OPC UA, under the names of the standard.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
pub enum OpcUaPolicy {
    /// AES with 128 bits.
    #[serde(rename = "Aes128_Sha256_RsaOaep")]
    Aes128Sha256RsaOaep,
    /// AES with 256 bits; the most common one.
    Basic256Sha256,
    /// AES with 256 bits and the newer signatures of RSA.
    #[serde(rename = "Aes256_Sha256_RsaPss")]
    Aes256Sha256RsaPss,
}

impl OpcUaPolicy {
    /// All of them, the best last.
    pub const ALL: [Self; 3] = [
        Self::Aes128Sha256RsaOaep,
        Self::Basic256Sha256,
        Self::Aes256Sha256RsaPss,
    ];
}

impl fmt::Display for OpcUaPolicy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Aes128Sha256RsaOaep => "Aes128_Sha256_RsaOaep",
            Self::Basic256Sha256 => "Basic256Sha256",
            Self::Aes256Sha256RsaPss => "Aes256_Sha256_RsaPss",
        })
    }
}

/// Files of a user whom a server knows by a certificate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UserCertificateFiles {
    /// Path of the certificate (DER or PEM).
    pub certificate: String,
    /// Path of its private key (PKCS #8 or PKCS #1, DER or PEM, not encrypted). The key itself is never stored.
    pub key: String,
}

impl UserCertificateFiles {
    /// Checks the paths; pointers are relative to them.
    ///
    /// # Errors
    /// The first path that is empty or has control characters.
    pub fn check(&self) -> Result<(), FieldError> {
        let paths = [
            (
                "/certificate",
                &self.certificate,
                "the certificate of the user",
            ),
            ("/key", &self.key, "the private key of the certificate"),
        ];
        for (at, path, what) in paths {
            if path.trim().is_empty() || path.contains(char::is_control) {
                return fail(at, format!("found {path:?}, expected the file with {what}"));
            }
        }
        Ok(())
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
    /// Protection of messages; absent for the best that the server offers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub security: Option<OpcUaSecurity>,
    /// Algorithms of the protection; absent for the best that the server offers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub policy: Option<OpcUaPolicy>,
    /// Name of the user at the server; absent for an anonymous one. The password is never stored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub user: Option<String>,
    /// Certificate of the user at the server, instead of a name and a password.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub user_certificate: Option<UserCertificateFiles>,
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
        if self.security == Some(OpcUaSecurity::None)
            && let Some(policy) = self.policy
        {
            let message = format!("found {policy} without security, expected no policy");
            return fail("/policy", message);
        }
        if let Some(user) = &self.user
            && (user.is_empty() || user.contains(char::is_control))
        {
            return fail(
                "/user",
                format!("found {user:?}, expected the name of a user"),
            );
        }
        if let Some(files) = &self.user_certificate {
            if let Some(user) = &self.user {
                let message = format!(
                    "found the name {user:?} and a certificate, expected one of them: a certificate names its user"
                );
                return fail("/user", message);
            }
            let below_it = |error| below("/user_certificate", error);
            files.check().map_err(below_it)?;
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

/// An address for messages: without the user and the password that may stand before `@`, and without options.
#[must_use]
pub fn without_user(address: &str) -> Cow<'_, str> {
    let address = address.split_once('?').map_or(address, |(place, _)| place);
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

//! Certificates of OPC UA servers that the user trusts, by their fingerprints.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use tautline_files::ReadError;

use crate::error::WriteError;
use crate::json::{VersionedFile, read_versioned, write_versioned};

/// SHA-256 of a certificate in its binary form, shown as pairs of hexadecimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub struct CertificateFingerprint([u8; 32]);

/// A text that is no fingerprint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "found {0:?}, expected a SHA-256 fingerprint of 64 hexadecimal digits, with or without colons"
)]
pub struct NotAFingerprint(String);

impl CertificateFingerprint {
    /// The fingerprint of a certificate (DER).
    #[must_use]
    pub fn of(certificate: &[u8]) -> Self {
        Self(Sha256::digest(certificate).into())
    }
}

impl fmt::Display for CertificateFingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, byte) in self.0.iter().enumerate() {
            let colon = if k == 0 { "" } else { ":" };
            write!(f, "{colon}{byte:02X}")?;
        }
        Ok(())
    }
}

impl FromStr for CertificateFingerprint {
    type Err = NotAFingerprint;

    fn from_str(text: &str) -> Result<Self, NotAFingerprint> {
        let is_between = |c: &char| *c == ':' || c.is_whitespace();
        let digits: String = text.chars().filter(|c| !is_between(c)).collect();
        let mut bytes = [0; 32];
        hex::decode_to_slice(digits, &mut bytes).map_err(|_| NotAFingerprint(text.to_owned()))?;
        Ok(Self(bytes))
    }
}

impl TryFrom<String> for CertificateFingerprint {
    type Error = NotAFingerprint;

    fn try_from(text: String) -> Result<Self, NotAFingerprint> {
        text.parse()
    }
}

impl From<CertificateFingerprint> for String {
    fn from(fingerprint: CertificateFingerprint) -> Self {
        fingerprint.to_string()
    }
}

/// The fingerprints of the servers that the user trusts, by address.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TrustedServers {
    /// Fingerprint of each server, by its address without path and options.
    #[serde(default)]
    servers: BTreeMap<String, CertificateFingerprint>,
}

impl VersionedFile for TrustedServers {
    const FORMAT: &'static str = "tautline-trusted-servers";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 20;
}

impl TrustedServers {
    /// Reads the file; without one, no server is trusted.
    ///
    /// # Errors
    /// If it cannot be read, so that a damaged file is not taken for one in which a server is unknown.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        match path.exists() {
            true => Ok(read_versioned::<Self>(path)?.value),
            false => Ok(Self::default()),
        }
    }

    /// Writes the file; the folder is created if necessary.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| WriteError::io(folder, error))?;
        }
        write_versioned(path, self)
    }

    /// The trusted fingerprint of a server.
    #[must_use]
    pub fn find(&self, server: &str) -> Option<CertificateFingerprint> {
        self.servers.get(server).copied()
    }

    /// Trusts a certificate of a server, in place of another one.
    pub fn trust(&mut self, server: &str, fingerprint: CertificateFingerprint) {
        self.servers.insert(server.to_owned(), fingerprint);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fingerprints_are_those_of_sha_256_and_read_again() {
        // The published value for the text "abc" (FIPS 180-2).
        let fingerprint = CertificateFingerprint::of(b"abc");
        let shown = fingerprint.to_string();
        assert!(
            shown.starts_with("BA:78:16:BF:8F:01:CF:EA:41:41"),
            "{shown}"
        );
        assert_eq!(shown.parse(), Ok(fingerprint));
        let plain = shown.replace(':', "").to_lowercase();
        assert_eq!(plain.parse(), Ok(fingerprint));
        for text in ["", "BA:78", "x", &format!("{plain}00")] {
            let told = text.parse::<CertificateFingerprint>();
            assert!(told.is_err(), "{text}");
        }
    }

    #[test]
    fn trusted_servers_are_kept_and_damage_is_not_trust() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("own").join("trusted-servers.json");
        let mut servers = TrustedServers::read(&path).expect("none");
        assert_eq!(servers.find("opc.tcp://plc:4840"), None);
        let fingerprint = CertificateFingerprint::of(b"one");
        servers.trust("opc.tcp://plc:4840", fingerprint);
        servers.write(&path).expect("written");
        let read = TrustedServers::read(&path).expect("read");
        assert_eq!(read.find("opc.tcp://plc:4840"), Some(fingerprint));
        std::fs::write(&path, "{}").expect("written");
        assert!(TrustedServers::read(&path).is_err());
    }
}

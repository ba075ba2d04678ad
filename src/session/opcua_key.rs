//! Our certificate for OPC UA with its private key, in a file in PEM that only its owner can read.

use std::path::Path;

use tautline_files::{Location, ReadError};

use crate::atomic::create_private;
use crate::error::WriteError;
use crate::json::read_limited;
use crate::pem::{CERTIFICATE, PRIVATE_KEY, decoded, encoded, section};

/// Largest size of a file.
const MAX_BYTES: u64 = 1 << 16;

/// A certificate with its private key.
pub struct OpcUaKey {
    /// The certificate (DER).
    pub certificate: Vec<u8>,
    /// The private key (PKCS #8 or PKCS #1, PEM).
    pub private_key: String,
}

impl OpcUaKey {
    /// Reads the file; `None` if there is none.
    ///
    /// # Errors
    /// If it cannot be read or lacks one of the two. Neither is shown.
    pub fn read(path: &Path) -> Result<Option<Self>, ReadError> {
        if !path.exists() {
            return Ok(None);
        }
        let file = path.display().to_string();
        let bytes = read_limited(path, &file, MAX_BYTES)?;
        let text = String::from_utf8_lossy(&bytes);
        let certificate = section(&text, CERTIFICATE).and_then(decoded);
        let key = certificate.zip(section(&text, PRIVATE_KEY));
        let Some((certificate, private_key)) = key else {
            let message = format!(
                "found {} bytes, expected a certificate and a private key in PEM",
                bytes.len()
            );
            return Err(ReadError::new(&file, Location::File, message));
        };
        Ok(Some(Self {
            certificate,
            private_key: private_key.to_owned(),
        }))
    }

    /// Writes a certificate (DER) and its private key (PKCS #8, DER) to a file that does not exist yet.
    ///
    /// # Errors
    /// If there is such a file or it cannot be written.
    pub fn create(path: &Path, certificate: &[u8], private_key: &[u8]) -> Result<(), WriteError> {
        let text = encoded(PRIVATE_KEY, private_key) + &encoded(CERTIFICATE, certificate);
        create_private(path, text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_never_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("own").join("opcua.pem");
        assert!(OpcUaKey::read(&path).expect("none").is_none());
        let (certificate, key): (Vec<u8>, Vec<u8>) = ((0..200).collect(), (50..255).collect());
        OpcUaKey::create(&path, &certificate, &key).expect("written");
        let read = OpcUaKey::read(&path).expect("read").expect("a key");
        assert_eq!(read.certificate, certificate);
        assert!(
            read.private_key
                .starts_with("-----BEGIN PRIVATE KEY-----\n")
        );
        assert!(read.private_key.ends_with("\n-----END PRIVATE KEY-----"));
        assert!(OpcUaKey::create(&path, &certificate, &key).is_err());
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = path.metadata().expect("a file").permissions().mode();
            assert_eq!(mode & 0o777, 0o600, "only its owner reads it");
        }
        for damaged in ["secret", &read.private_key] {
            std::fs::write(&path, damaged).expect("written");
            let error = OpcUaKey::read(&path)
                .map(drop)
                .expect_err("no key")
                .to_string();
            assert!(
                error.contains("expected a certificate and a private key"),
                "{error}"
            );
            assert!(!error.contains("secret"), "{error}");
        }
    }
}

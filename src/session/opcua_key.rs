//! Our certificate for OPC UA with its private key, in a file in PEM that only its owner can read.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::atomic::create_private;
use crate::error::{Place, ReadError, WriteError};
use crate::json::read_limited;

/// Largest size of a file.
const MAX_BYTES: u64 = 1 << 16;
/// Number of characters of a line.
const LINE: usize = 64;
const CERTIFICATE: &str = "CERTIFICATE";
const PRIVATE_KEY: &str = "PRIVATE KEY";

/// A certificate with its private key.
pub struct OpcUaKey {
    /// The certificate (DER).
    pub certificate: Vec<u8>,
    /// The private key (PKCS #8, PEM).
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
        let certificate = section(&text, CERTIFICATE).and_then(|section| {
            let lines = section.lines().filter(|line| !line.starts_with("-----"));
            STANDARD.decode(lines.collect::<String>()).ok()
        });
        let key = certificate.zip(section(&text, PRIVATE_KEY));
        let Some((certificate, private_key)) = key else {
            let message = format!(
                "found {} bytes, expected a certificate and a private key in PEM",
                bytes.len()
            );
            return Err(ReadError::new(&file, Place::File, message));
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
        let text = pem(PRIVATE_KEY, private_key) + &pem(CERTIFICATE, certificate);
        create_private(path, text.as_bytes())
    }
}

fn marks(label: &str) -> [String; 2] {
    ["BEGIN", "END"].map(|word| format!("-----{word} {label}-----"))
}

/// A part of a file with its marks.
fn section<'t>(text: &'t str, label: &str) -> Option<&'t str> {
    let [begin, end] = marks(label);
    let at = text.find(&begin)?;
    let length = text[at..].find(&end)? + end.len();
    text.get(at..at + length)
}

fn pem(label: &str, bytes: &[u8]) -> String {
    let [begin, end] = marks(label);
    let text = STANDARD.encode(bytes);
    let mut lines = vec![begin.as_str()];
    let mut rest = text.as_str();
    while !rest.is_empty() {
        let (line, left) = rest.split_at(LINE.min(rest.len()));
        lines.push(line);
        rest = left;
    }
    lines.push(&end);
    lines.join("\n") + "\n"
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

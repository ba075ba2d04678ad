//! The key with which a user signs audit trails: Ed25519, in a file that only its owner can read.

use std::io::{Error, Read};
use std::path::Path;

use ed25519_dalek::{Signature, Signer, SigningKey, VerifyingKey};

use crate::atomic::create_private;
use crate::error::{Place, ReadError, WriteError};
use crate::input_file::open_input;

/// Largest size of a key file.
const MAX_BYTES: u64 = 1024;

/// A private key.
#[derive(Debug, Clone)]
pub struct AuditKey(SigningKey);

impl AuditKey {
    /// Reads the key file: 64 hexadecimal digits. `None` if there is none.
    ///
    /// # Errors
    /// If it cannot be read or is no key.
    pub fn read(path: &Path) -> Result<Option<Self>, ReadError> {
        if !path.exists() {
            return Ok(None);
        }
        let file = path.display().to_string();
        let mut text = Vec::new();
        let read = open_input(path, &file)?
            .take(MAX_BYTES)
            .read_to_end(&mut text);
        read.map_err(|error| ReadError::io(&file, Place::File, &error))?;
        let digits = std::str::from_utf8(&text).unwrap_or_default().trim();
        let Some(secret) = of_digits(digits) else {
            // The content is a secret, so the message does not show it.
            let message = format!(
                "found {} bytes, expected a key of 64 hexadecimal digits",
                text.len()
            );
            return Err(ReadError::new(&file, Place::File, message));
        };
        Ok(Some(Self(SigningKey::from_bytes(&secret))))
    }

    /// Makes a new key and writes it to a file that does not exist yet.
    ///
    /// # Errors
    /// If there is such a file, it cannot be written, or the system has no random numbers.
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        let fail = |error| WriteError::io(path, error);
        let mut secret = [0; 32];
        getrandom::fill(&mut secret).map_err(|error| fail(Error::other(error.to_string())))?;
        create_private(path, format!("{}\n", hex::encode(secret)).as_bytes())?;
        Ok(Self(SigningKey::from_bytes(&secret)))
    }

    /// The public key: 64 hexadecimal digits.
    #[must_use]
    pub fn public(&self) -> String {
        hex::encode(self.0.verifying_key().as_bytes())
    }

    /// The signature of a hash: 128 hexadecimal digits.
    pub(crate) fn sign(&self, hash: &str) -> String {
        hex::encode(self.0.sign(hash.as_bytes()).to_bytes())
    }
}

/// The bytes of exactly so many pairs of hexadecimal digits.
fn of_digits<const N: usize>(text: &str) -> Option<[u8; N]> {
    let mut bytes = [0; N];
    hex::decode_to_slice(text, &mut bytes).ok()?;
    Some(bytes)
}

/// Whether a signature is that of a hash by a public key.
pub(crate) fn is_signed(hash: &str, key: &str, signature: &str) -> bool {
    let key = of_digits(key).and_then(|key| VerifyingKey::from_bytes(&key).ok());
    let signature = of_digits(signature).map(|bytes| Signature::from_bytes(&bytes));
    let pair = key.zip(signature);
    pair.is_some_and(|(key, signature)| key.verify_strict(hash.as_bytes(), &signature).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_made_once_and_signs() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("own").join("audit.key");
        assert!(AuditKey::read(&path).expect("none").is_none());
        let made = AuditKey::create(&path).expect("a key");
        let read = AuditKey::read(&path).expect("read").expect("a key");
        assert_eq!(read.public(), made.public());
        assert!(AuditKey::create(&path).is_err(), "it is never replaced");
        let signature = read.sign("hash");
        let key = read.public();
        assert!(is_signed("hash", &key, &signature));
        assert!(!is_signed("hasH", &key, &signature));
        let other = AuditKey::create(&folder.path().join("other")).expect("a key");
        assert!(!is_signed("hash", &other.public(), &signature));
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = path.metadata().expect("a file").permissions().mode();
            assert_eq!(mode & 0o777, 0o600, "only its owner reads it");
        }
    }

    #[test]
    fn the_first_test_vector_of_rfc_8032_is_signed_as_published() {
        let secret = of_digits("9d61b19deffd5a60ba844af492ec2cc44449c5697b326919703bac031cae7f60");
        let key = AuditKey(SigningKey::from_bytes(&secret.expect("hexadecimal")));
        assert_eq!(
            key.public(),
            "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a"
        );
        assert_eq!(
            key.sign(""),
            "e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e065224901555fb8821590a33bacc61e39701cf9b46bd25bf5f0595bbe24655141438e7a100b"
        );
    }

    #[test]
    fn what_is_no_key_is_refused_without_being_shown() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("audit.key");
        std::fs::write(&path, "secret").expect("written");
        let error = AuditKey::read(&path).expect_err("no key").to_string();
        assert!(error.contains("found 6 bytes, expected a key"), "{error}");
        assert!(!error.contains("secret"), "{error}");
    }
}

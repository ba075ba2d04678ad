//! The certificate of a user at an OPC UA server with its private key, in files in DER or PEM.

use std::path::Path;

use tautline_files::{Location, ReadError};

use crate::json::{check_size, read_limited};
use crate::opcua_key::OpcUaKey;
use crate::pem::{CERTIFICATE, PRIVATE_KEY, decoded, encoded, section};
use crate::session::UserCertificateFiles;

/// Largest size of a file.
const MAX_BYTES: u64 = 1 << 20;
/// Label of a private key of RSA (PKCS #1).
const RSA_PRIVATE_KEY: &str = "RSA PRIVATE KEY";
/// Labels of private keys that are encrypted or of another kind than RSA.
const ENCRYPTED_PRIVATE_KEY: &str = "ENCRYPTED PRIVATE KEY";
const EC_PRIVATE_KEY: &str = "EC PRIVATE KEY";
/// Mark of the older form of encryption, inside of the section of a key.
const ENCRYPTED: &str = "Proc-Type: 4,ENCRYPTED";
/// Kinds of values in DER.
const SEQUENCE: u8 = 0x30;
const INTEGER: u8 = 0x02;

impl UserCertificateFiles {
    /// Reads the certificate and the key; whether they belong together is not checked.
    ///
    /// # Errors
    /// If a file cannot be read, is in another form, or the key is encrypted. The key is not shown.
    pub fn read(&self) -> Result<OpcUaKey, ReadError> {
        Ok(OpcUaKey {
            certificate: read_certificate(&self.certificate)?,
            private_key: read_key(&self.key)?,
        })
    }

    /// The same files by absolute paths, where these exist as Unicode.
    #[must_use]
    pub fn absolute(&self) -> Self {
        let absolute = |path: &String| {
            let found = std::path::absolute(path);
            let found = found.ok().and_then(|path| path.to_str().map(str::to_owned));
            found.unwrap_or_else(|| path.clone())
        };
        Self {
            certificate: absolute(&self.certificate),
            key: absolute(&self.key),
        }
    }

    /// A warning if other users of the computer can read the private key.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        exposed_key(Path::new(&self.key))
    }
}

/// A warning if other users of the computer can read a file with a private key.
#[must_use]
pub fn exposed_key(path: &Path) -> Option<String> {
    let key = path.display();
    is_exposed(path).then(|| {
        format!(
            "the private key {key} can be read by other users of this computer: `chmod 600` keeps it to you"
        )
    })
}

#[cfg(unix)]
fn is_exposed(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    let found = path.metadata();
    found.is_ok_and(|found| found.permissions().mode() & 0o044 != 0)
}

/// Permissions of other systems are lists that the standard library does not read.
#[cfg(not(unix))]
fn is_exposed(_path: &Path) -> bool {
    false
}

fn read(file: &str) -> Result<Vec<u8>, ReadError> {
    let bytes = read_limited(Path::new(file), file, MAX_BYTES)?;
    check_size(&bytes, file, MAX_BYTES)?;
    Ok(bytes)
}

fn read_certificate(file: &str) -> Result<Vec<u8>, ReadError> {
    let bytes = read(file)?;
    if bytes.first() == Some(&SEQUENCE) {
        return Ok(bytes);
    }
    let text = String::from_utf8_lossy(&bytes);
    let found = section(&text, CERTIFICATE).and_then(decoded);
    found.ok_or_else(|| {
        let message = format!(
            "found {} bytes that are no certificate, expected one in DER or PEM",
            bytes.len()
        );
        ReadError::new(file, Location::File, message)
    })
}

/// A private key in PEM, whatever form its file has.
fn read_key(file: &str) -> Result<String, ReadError> {
    let wrong = |message: String| ReadError::new(file, Location::File, message);
    let encrypted = || {
        wrong(format!(
            "found an encrypted private key, expected one without a password: write a copy by `openssl pkey -in {file:?} -out DECRYPTED.pem`, which only you can read, and give that"
        ))
    };
    let bytes = read(file)?;
    let unknown = || {
        wrong(format!(
            "found {} bytes that are no private key, expected one in PKCS #8 or PKCS #1, DER or PEM",
            bytes.len()
        ))
    };
    if bytes.first() == Some(&SEQUENCE) {
        return match form(&bytes) {
            Some(Form::Pkcs8) => Ok(encoded(PRIVATE_KEY, &bytes)),
            Some(Form::Pkcs1) => Ok(encoded(RSA_PRIVATE_KEY, &bytes)),
            Some(Form::Encrypted) => Err(encrypted()),
            None => Err(unknown()),
        };
    }
    let text = String::from_utf8_lossy(&bytes);
    let has = |label| section(&text, label).is_some();
    if has(ENCRYPTED_PRIVATE_KEY) || text.contains(ENCRYPTED) {
        return Err(encrypted());
    }
    for label in [PRIVATE_KEY, RSA_PRIVATE_KEY] {
        if let Some(content) = section(&text, label).and_then(decoded) {
            return Ok(encoded(label, &content));
        }
    }
    match has(EC_PRIVATE_KEY) {
        true => Err(wrong(
            "found a key of elliptic curves, expected one of RSA".into(),
        )),
        false => Err(unknown()),
    }
}

/// Form of a private key in DER.
enum Form {
    Pkcs8,
    Pkcs1,
    Encrypted,
}

/// The form of a private key: after its version, PKCS #8 has the kind of the key and PKCS #1 its modulus; an encrypted key has
/// no version but begins with the kind of its encryption.
fn form(der: &[u8]) -> Option<Form> {
    match content(der)? {
        [SEQUENCE, ..] => Some(Form::Encrypted),
        [INTEGER, 1, _, SEQUENCE, ..] => Some(Form::Pkcs8),
        [INTEGER, 1, _, INTEGER, ..] => Some(Form::Pkcs1),
        _ => None,
    }
}

/// Content of a value in DER, after its kind and length.
fn content(der: &[u8]) -> Option<&[u8]> {
    let [_, length, rest @ ..] = der else {
        return None;
    };
    match *length {
        short if short < 0x80 => Some(rest),
        long => rest.get(usize::from(long & 0x7F)..),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sequence of less than 128 bytes.
    fn sequence(content: &[u8]) -> Vec<u8> {
        let length = u8::try_from(content.len()).expect("a short content");
        [&[SEQUENCE, length], content].concat()
    }

    #[test]
    fn certificates_and_keys_are_read_in_every_form() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, content: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, content).expect("written");
            path.display().to_string()
        };
        let certificate = sequence(&[7; 100]);
        let pkcs8 = sequence(&[&[INTEGER, 1, 0][..], &sequence(&[5; 4])].concat());
        let pkcs1 = sequence(&[INTEGER, 1, 0, INTEGER, 1, 9]);
        let both = "some words\n".to_owned()
            + &encoded(PRIVATE_KEY, &pkcs8)
            + &encoded(CERTIFICATE, &certificate).replace('\n', "\r\n");
        let both = write("both.pem", both.as_bytes());
        let der = write("certificate.der", &certificate);
        for (key, expected) in [
            (both.clone(), encoded(PRIVATE_KEY, &pkcs8)),
            (write("8.der", &pkcs8), encoded(PRIVATE_KEY, &pkcs8)),
            (write("1.der", &pkcs1), encoded(RSA_PRIVATE_KEY, &pkcs1)),
            (
                write("1.pem", encoded(RSA_PRIVATE_KEY, &pkcs1).as_bytes()),
                encoded(RSA_PRIVATE_KEY, &pkcs1),
            ),
        ] {
            for certificate_file in [&both, &der] {
                let files = UserCertificateFiles {
                    certificate: certificate_file.clone(),
                    key: key.clone(),
                };
                let read = files.read().expect("read");
                assert_eq!(read.certificate, certificate);
                assert_eq!(read.private_key, expected);
            }
        }
    }

    #[test]
    fn what_is_no_usable_key_is_told_without_showing_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("key");
        let told = |content: &[u8]| {
            std::fs::write(&path, content).expect("written");
            let told = read_key(&path.display().to_string());
            let told = told.expect_err("no key").to_string();
            assert!(!told.contains("secret"), "{told}");
            told
        };
        let secret = b"secret secret";
        let old = encoded(RSA_PRIVATE_KEY, secret).replacen(
            '\n',
            "\nProc-Type: 4,ENCRYPTED\nDEK-Info: AES-128-CBC,00\n\n",
            1,
        );
        for encrypted in [
            encoded(ENCRYPTED_PRIVATE_KEY, secret).into_bytes(),
            old.into_bytes(),
            sequence(&sequence(secret)),
        ] {
            let told = told(&encrypted);
            assert!(told.contains("openssl pkey -in"), "{told}");
        }
        let of_curves = told(encoded(EC_PRIVATE_KEY, secret).as_bytes());
        assert!(of_curves.contains("expected one of RSA"), "{of_curves}");
        for no_key in [&secret[..], &sequence(secret), &[SEQUENCE], &[]] {
            let told = told(no_key);
            assert!(told.contains("no private key"), "{told}");
        }
        std::fs::remove_file(&path).expect("removed");
        let missing = read_key(&path.display().to_string()).expect_err("no file");
        assert!(missing.to_string().contains("not found"), "{missing}");
        let no_certificate = read_certificate(&folder.path().display().to_string());
        let told = no_certificate.expect_err("a folder").to_string();
        assert!(told.contains("is a folder"), "{told}");
    }

    #[test]
    fn files_are_found_from_any_folder() {
        let files = UserCertificateFiles {
            certificate: "anna.der".into(),
            key: String::new(),
        };
        let absolute = files.absolute();
        assert!(Path::new(&absolute.certificate).is_absolute());
        assert!(absolute.certificate.ends_with("anna.der"));
        assert_eq!(absolute.key, "", "no path stays none");
        assert_eq!(absolute.absolute(), absolute);
    }

    #[cfg(unix)]
    #[test]
    fn a_key_that_others_can_read_is_noticed() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("key.pem");
        std::fs::write(&path, "key").expect("written");
        let files = UserCertificateFiles {
            certificate: String::new(),
            key: path.display().to_string(),
        };
        for (mode, is_exposed) in [(0o600, false), (0o640, true), (0o604, true)] {
            let permissions = std::fs::Permissions::from_mode(mode);
            std::fs::set_permissions(&path, permissions).expect("set");
            assert_eq!(files.warning().is_some(), is_exposed, "{mode:o}");
        }
    }
}

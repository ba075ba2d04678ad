//! Our own certificate and its private key.

use opcua_crypto::{KeySize, PrivateKey, Thumbprint, X509, X509Data};
use tautline_session::CertificateFingerprint;

use super::certificate::Fields;
use crate::error::LinkError;

/// Size of our key: the smallest that the policies allow, which every server takes (bits).
const KEY_BITS: u32 = 2048;
/// Time for which our certificate is valid (days). A plant that trusts it should not come to a stop after a year.
const DAYS: u32 = 3653;

/// Reason why a certificate and a private key are not a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum KeyPairError {
    /// The certificate cannot be read.
    Certificate,
    /// The private key cannot be read as one of RSA.
    Key,
    /// The certificate has a key of another kind than RSA.
    Kind,
    /// The two do not belong together.
    Mismatch,
}

/// A certificate and the private key that belongs to it.
pub(super) struct KeyPair {
    pub der: Vec<u8>,
    pub certificate: X509,
    pub key: PrivateKey,
}

impl KeyPair {
    /// A pair from its certificate (DER) and its private key (PKCS #8 or PKCS #1 in PEM).
    pub fn read(certificate: &[u8], key: &str) -> Result<Self, KeyPairError> {
        let der = certificate.to_vec();
        let certificate = X509::from_der(&der).map_err(|_| KeyPairError::Certificate)?;
        let public = certificate.public_key().map_err(|_| KeyPairError::Kind)?;
        let key = PrivateKey::from_pem(key.as_bytes()).map_err(|_| KeyPairError::Key)?;
        // The lengths of messages depend on the sizes of both keys; a signature verifies that they belong together.
        let mut signature = vec![0; key.size()];
        let is_pair = public.size() == key.size()
            && key.sign_sha256(&der, &mut signature).is_ok()
            && public.verify_sha256(&der, &signature).unwrap_or(false);
        match is_pair {
            true => Ok(Self {
                der,
                certificate,
                key,
            }),
            false => Err(KeyPairError::Mismatch),
        }
    }
}

/// Our certificate with its private key.
#[derive(Debug)]
pub struct ClientIdentity {
    der: Vec<u8>,
    certificate: X509,
    key: PrivateKey,
    uri: String,
}

impl ClientIdentity {
    /// Makes a key and a certificate for this computer.
    ///
    /// # Errors
    /// If the computer cannot make a key.
    pub fn create() -> Result<Self, LinkError> {
        let failed =
            |error: String| LinkError::Setup(format!("our certificate cannot be made: {error}"));
        let host = opcua_crypto::hostname().unwrap_or_else(|_| "localhost".to_owned());
        let uri = format!("urn:{host}:tautline");
        let data = X509Data {
            key_size: KEY_BITS,
            common_name: format!("Tautline@{host}"),
            organization: "Tautline".to_owned(),
            organizational_unit: String::new(),
            country: String::new(),
            state: String::new(),
            // Addresses of the computer change; servers do not check those of clients.
            alt_host_names: X509Data::alt_host_names(&uri, Some(vec![host]), false, false, false),
            certificate_duration_days: DAYS,
        };
        let (certificate, key) = X509::cert_and_pkey(&data).map_err(failed)?;
        let der = certificate
            .to_der()
            .map_err(|error| failed(error.to_string()))?;
        Ok(Self {
            der,
            certificate,
            key,
            uri,
        })
    }

    /// An identity from its certificate (DER) and its private key (PKCS #8 or PKCS #1 in PEM).
    ///
    /// # Errors
    /// If one of them cannot be read or they do not belong together. The key is not shown.
    pub fn read(certificate: &[u8], key: &str) -> Result<Self, LinkError> {
        let wrong = |what: &str| LinkError::Setup(format!("our certificate {what}"));
        let KeyPair {
            der,
            certificate,
            key,
        } = KeyPair::read(certificate, key).map_err(|problem| {
            wrong(match problem {
                KeyPairError::Certificate => "cannot be read",
                KeyPairError::Key => "has a private key that cannot be read",
                KeyPairError::Kind => "has a key of an unknown kind",
                KeyPairError::Mismatch => "does not belong to its private key",
            })
        })?;
        let uri = Fields::of(&der).and_then(|fields| fields.uri());
        let uri = uri.ok_or_else(|| wrong("has no name of the application"))?;
        Ok(Self {
            der,
            certificate,
            key,
            uri,
        })
    }

    /// The certificate (DER).
    #[must_use]
    pub fn certificate(&self) -> &[u8] {
        &self.der
    }

    /// The private key (PKCS #8, DER).
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn private_key(&self) -> Result<impl AsRef<[u8]> + use<>, LinkError> {
        let failed =
            |error| LinkError::Setup(format!("our private key cannot be written ({error})"));
        let document = self.key.to_der().map_err(failed)?;
        Ok(document.to_bytes())
    }

    /// Name of the application in the certificate, which servers compare.
    #[must_use]
    pub fn uri(&self) -> &str {
        &self.uri
    }

    /// The SHA-256 fingerprint.
    #[must_use]
    pub fn fingerprint(&self) -> CertificateFingerprint {
        CertificateFingerprint::of(&self.der)
    }

    /// The SHA-1 thumbprint, as servers show it in their trust lists.
    #[must_use]
    pub fn thumbprint_in_words(&self) -> String {
        self.certificate.thumbprint().as_hex_string().to_uppercase()
    }

    /// The day after which the certificate is no longer valid.
    #[must_use]
    pub fn last_day(&self) -> String {
        Fields::of(&self.der).map_or_else(String::new, |fields| fields.last_day())
    }

    pub(super) fn thumbprint(&self) -> Thumbprint {
        self.certificate.thumbprint()
    }

    pub(super) fn key(&self) -> &PrivateKey {
        &self.key
    }
}

//! A user whom a server knows by a certificate.

use std::time::SystemTime;

use opcua_crypto::{PrivateKey, SecurityPolicy};
use opcua_types::{ByteString, SignatureData};
use tautline_session::UserCertificateFiles;

use super::certificate::{Fields, ServerCertificate, size_problem};
use super::identity::{KeyPair, KeyPairError};
use crate::error::LinkError;

/// The certificate of a user with its private key.
pub(super) struct UserIdentity {
    der: Vec<u8>,
    key: PrivateKey,
}

impl UserIdentity {
    /// Reads the files of a user, which must fit together and be valid at this time.
    pub fn read(files: &UserCertificateFiles, now: SystemTime) -> Result<Self, LinkError> {
        let wrong = |file: &str, what: &str| LinkError::Setup(format!("{file}: {what}"));
        let of_certificate = |what: &str| {
            wrong(
                &files.certificate,
                &format!("the certificate of the user {what}"),
            )
        };
        let read = files.read();
        let read = read.map_err(|error| LinkError::Setup(error.to_string()))?;
        let pair = KeyPair::read(&read.certificate, &read.private_key);
        let pair = pair.map_err(|problem| match problem {
            KeyPairError::Certificate => of_certificate("cannot be read"),
            KeyPairError::Kind => of_certificate("has a key of another kind than RSA"),
            KeyPairError::Key => wrong(
                &files.key,
                "the private key of the user cannot be read, expected one of RSA",
            ),
            KeyPairError::Mismatch => wrong(
                &files.key,
                &format!(
                    "the private key does not belong to the certificate {}",
                    files.certificate
                ),
            ),
        })?;
        let public = pair.certificate.public_key();
        let size = public.map_or(None, |public| size_problem(&public));
        let fields = Fields::of(&pair.der);
        let advice = "have a new one made and let the server know it";
        let time = fields.and_then(|fields| fields.time_problem(now, advice));
        match size.or(time) {
            Some(problem) => Err(of_certificate(&problem)),
            None => Ok(Self {
                der: pair.der,
                key: pair.key,
            }),
        }
    }

    /// The certificate (DER).
    pub fn certificate(&self) -> ByteString {
        ByteString::from(&self.der)
    }

    /// Proof of the private key: a signature over the certificate of the server and its random number.
    pub fn sign(
        &self,
        policy: SecurityPolicy,
        (server, nonce): (&ServerCertificate, &ByteString),
    ) -> Result<SignatureData, LinkError> {
        let certificate = ByteString::from(server.der());
        let signed = opcua_crypto::create_signature_data(&self.key, policy, &certificate, nonce);
        signed.map_err(|error| LinkError::Refused(format!("it sent no random number ({error})")))
    }
}

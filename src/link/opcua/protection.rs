//! Protection of the messages of a channel: signatures, encryption and padding (OPC UA part 6, 6.7).
//!
//! The algorithms are those of `async-opcua-crypto`; this module determines where their input begins and ends. No part of a
//! message is used before its signature is verified, not even its padding. Lengths are checked first, because the
//! functions of the crate panic where they do not fit.

use std::sync::Arc;

use opcua_crypto::{AesDerivedKeys, KeySize, SecurityPolicy};
use opcua_types::{ByteString, MessageSecurityMode, SignatureData};
use tautline_session::{OpcUaPolicy, OpcUaSecurity};

use super::certificate::ServerCertificate;
use super::identity::ClientIdentity;
use super::wire::HEADER;
use crate::error::LinkError;
use crate::timed_socket::SocketError;

/// Block of the symmetric encryption (bytes).
const BLOCK: usize = 16;
/// Most bytes that protection adds to a chunk: padding with its length, and the signature.
pub(super) const OVERHEAD: usize = BLOCK + opcua_crypto::SHA256_SIZE;
/// Key size from which the length of the padding takes two bytes (bytes).
const LONG_KEY: usize = 256;

/// The policy as a type of `async-opcua-crypto`.
pub(super) fn policy_of(policy: OpcUaPolicy) -> SecurityPolicy {
    match policy {
        OpcUaPolicy::Aes128Sha256RsaOaep => SecurityPolicy::Aes128Sha256RsaOaep,
        OpcUaPolicy::Basic256Sha256 => SecurityPolicy::Basic256Sha256,
        OpcUaPolicy::Aes256Sha256RsaPss => SecurityPolicy::Aes256Sha256RsaPss,
    }
}

/// Symmetric keys of one token.
struct Keys {
    /// Keys for messages to the server.
    ours: AesDerivedKeys,
    /// Keys for messages from the server.
    server: AesDerivedKeys,
}

/// The protection of one channel between two certificates.
pub(super) struct Protection {
    policy: SecurityPolicy,
    name: OpcUaPolicy,
    is_encrypted: bool,
    identity: Arc<ClientIdentity>,
    server: ServerCertificate,
    nonce: ByteString,
    keys: Option<Keys>,
    /// Keys of the token before.
    former: Option<Keys>,
}

fn unreadable(what: &str) -> SocketError {
    SocketError::Invalid(format!("its message {what}"))
}

/// A failure of the crate on our own data.
fn failed(error: opcua_types::Error) -> SocketError {
    SocketError::Invalid(format!("a message to it cannot be protected ({error})"))
}

impl Protection {
    /// Protects a channel to a server whose certificate is trusted; `security` is not [`OpcUaSecurity::None`].
    pub fn new(
        security: OpcUaSecurity,
        policy: OpcUaPolicy,
        identity: Arc<ClientIdentity>,
        server: ServerCertificate,
    ) -> Self {
        Self {
            policy: policy_of(policy),
            name: policy,
            is_encrypted: security == OpcUaSecurity::SignAndEncrypt,
            identity,
            server,
            nonce: ByteString::null(),
            keys: None,
            former: None,
        }
    }

    pub fn mode(&self) -> MessageSecurityMode {
        match self.is_encrypted {
            true => MessageSecurityMode::SignAndEncrypt,
            false => MessageSecurityMode::Sign,
        }
    }

    /// The protection for the operator.
    pub fn in_words(&self) -> String {
        let what = match self.is_encrypted {
            true => "Signed and encrypted",
            false => "Signed, not encrypted",
        };
        format!("{what} with {}", self.name)
    }

    pub fn policy(&self) -> SecurityPolicy {
        self.policy
    }

    pub fn server(&self) -> &ServerCertificate {
        &self.server
    }

    pub fn identity(&self) -> &ClientIdentity {
        &self.identity
    }

    /// Our half of the keys of the next token.
    pub fn new_nonce(&mut self) -> ByteString {
        self.nonce = self.policy.random_nonce();
        self.nonce.clone()
    }

    /// Derives the keys of the next token.
    pub fn derive(&mut self, server_nonce: &ByteString) -> Result<(), SocketError> {
        let (ours, theirs) = (self.nonce.as_ref(), server_nonce.as_ref());
        if theirs.len() != self.policy.secure_channel_nonce_length() || ours == theirs {
            return Err(unreadable("has no random number for the keys"));
        }
        self.former = self.keys.take();
        self.keys = Some(Keys {
            ours: self.policy.make_secure_channel_keys(theirs, ours),
            server: self.policy.make_secure_channel_keys(ours, theirs),
        });
        Ok(())
    }

    /// Policy, certificate and thumbprint that a message for opening the channel carries from us.
    pub fn opening_head(&self) -> [ByteString; 3] {
        [
            ByteString::from(self.policy.to_uri().as_bytes()),
            ByteString::from(self.identity.certificate()),
            self.server.thumbprint().as_byte_string(),
        ]
    }

    /// Checks policy, certificate and thumbprint of the answer: it must come from the trusted server to us, under the same
    /// policy. Without this, anybody could answer, unencrypted or with a certificate of his own.
    pub fn check_opening_head(&self, head: [&[u8]; 3]) -> Result<(), SocketError> {
        let [policy, certificate, receiver] = head;
        if policy != self.policy.to_uri().as_bytes() {
            return Err(unreadable(
                "is not protected by the policy that was asked for",
            ));
        }
        if !self.server.is(certificate) {
            return Err(unreadable("has another certificate than the trusted one"));
        }
        match receiver == self.identity.thumbprint().value() {
            true => Ok(()),
            false => Err(unreadable("is encrypted for another certificate")),
        }
    }

    /// A signed and encrypted message for opening the channel. `head` is its part before the encryption; `kind` its kind.
    pub fn seal_opening(
        &self,
        kind: [u8; 4],
        head: &[u8],
        content: &[u8],
    ) -> Result<Vec<u8>, SocketError> {
        let (own, key) = (self.identity.key(), self.server.key());
        let block = self.policy.asymmetric_padding_info(key).block_size;
        let length_bytes = if key.size() > LONG_KEY { 2 } else { 1 };
        let plain = content.len() + length_bytes + own.size();
        let padding = plain.next_multiple_of(block) - plain;
        let size = (plain + padding) / block * key.size();
        let mut message = begun(kind, head, size);
        let at = message.len();
        message.extend_from_slice(content);
        let [low, high, ..] = padding.to_le_bytes();
        message.resize(message.len() + 1 + padding, low);
        if length_bytes == 2 {
            message.push(high);
        }
        let mut signature = vec![0; own.size()];
        let signed = self.policy.asymmetric_sign(own, &message, &mut signature);
        signed.map_err(failed)?;
        message.extend(signature);
        let mut sealed = vec![0; size];
        let encrypted = self
            .policy
            .asymmetric_encrypt(key, &message[at..], &mut sealed);
        encrypted.map_err(failed)?;
        message.truncate(at);
        message.extend(sealed);
        Ok(message)
    }

    /// The content of a message that opens the channel, whose encrypted part begins at `at`.
    pub fn open_opening(&self, message: &[u8], at: usize) -> Result<Vec<u8>, SocketError> {
        let (own, key) = (self.identity.key(), self.server.key());
        let wrong = || unreadable("cannot be decrypted");
        let (head, sealed) = message.split_at_checked(at).ok_or_else(wrong)?;
        if sealed.is_empty() || !sealed.len().is_multiple_of(own.size()) {
            return Err(wrong());
        }
        let mut plain = vec![0; sealed.len()];
        let decrypted = self.policy.asymmetric_decrypt(own, sealed, &mut plain);
        plain.truncate(decrypted.map_err(|_| wrong())?);
        let signed = plain.len().checked_sub(key.size()).ok_or_else(wrong)?;
        let (content, signature) = plain.split_at(signed);
        self.policy
            .asymmetric_verify_signature(key, &[head, content].concat(), signature)
            .map_err(|_| unreadable("has a wrong signature"))?;
        without_padding(content, own.size() > LONG_KEY)
    }

    /// A protected message of the open channel. `head` is its part before the encryption.
    pub fn seal(&self, kind: [u8; 4], head: &[u8], content: &[u8]) -> Result<Vec<u8>, SocketError> {
        let keys = self.keys()?;
        let signature_size = self.policy.symmetric_signature_size();
        let padding = self.is_encrypted.then(|| {
            let plain = content.len() + 1 + signature_size;
            plain.next_multiple_of(BLOCK) - plain
        });
        let size = content.len() + padding.map_or(0, |padding| padding + 1) + signature_size;
        let mut message = begun(kind, head, size);
        let at = message.len();
        message.extend_from_slice(content);
        if let Some(padding) = padding {
            let [length, ..] = padding.to_le_bytes();
            message.resize(message.len() + 1 + padding, length);
        }
        let mut signature = vec![0; signature_size];
        let signed = self
            .policy
            .symmetric_sign(&keys.ours, &message, &mut signature);
        signed.map_err(failed)?;
        message.extend(signature);
        if self.is_encrypted {
            let plain = message.split_off(at);
            // The crate asks for a block more than it writes.
            message.resize(at + plain.len() + BLOCK, 0);
            let encrypted = self
                .policy
                .symmetric_encrypt(&keys.ours, &plain, &mut message[at..]);
            message.truncate(at + encrypted.map_err(failed)?);
        }
        Ok(message)
    }

    /// The content of a protected message of the open channel, whose encrypted part begins at `at`.
    pub fn open(&self, message: &[u8], at: usize) -> Result<Vec<u8>, SocketError> {
        self.open_with(self.keys()?, message, at)
    }

    /// The same for a message under the token before.
    pub fn open_former(&self, message: &[u8], at: usize) -> Result<Vec<u8>, SocketError> {
        let keys = self.former.as_ref();
        let keys = keys.ok_or_else(|| unreadable("came under keys that are forgotten"))?;
        self.open_with(keys, message, at)
    }

    fn open_with(&self, keys: &Keys, message: &[u8], at: usize) -> Result<Vec<u8>, SocketError> {
        let wrong = || unreadable("cannot be decrypted");
        let (head, sealed) = message.split_at_checked(at).ok_or_else(wrong)?;
        let mut plain = sealed.to_vec();
        if self.is_encrypted {
            plain.resize(sealed.len() + BLOCK, 0);
            let decrypted = self
                .policy
                .symmetric_decrypt(&keys.server, sealed, &mut plain);
            plain.truncate(decrypted.map_err(|_| wrong())?);
        }
        let signature_size = self.policy.symmetric_signature_size();
        let signed = plain.len().checked_sub(signature_size);
        let (content, signature) = plain.split_at(signed.ok_or_else(wrong)?);
        self.policy
            .symmetric_verify_signature(&keys.server, &[head, content].concat(), signature)
            .map_err(|_| unreadable("has a wrong signature"))?;
        match self.is_encrypted {
            true => without_padding(content, false),
            false => Ok(content.to_vec()),
        }
    }

    fn keys(&self) -> Result<&Keys, SocketError> {
        let keys = self.keys.as_ref();
        keys.ok_or_else(|| unreadable("came before the channel was open"))
    }

    /// Our signature of the server's certificate and its random number.
    pub fn sign(&self, server_nonce: &ByteString) -> Result<SignatureData, LinkError> {
        let certificate = ByteString::from(self.server.der());
        opcua_crypto::create_signature_data(
            self.identity.key(),
            self.policy,
            &certificate,
            server_nonce,
        )
        .map_err(|error| LinkError::Refused(format!("it sent no random number ({error})")))
    }

    /// Whether a signature is that of the server over our certificate and our random number.
    pub fn is_signed_by_server(&self, signature: &SignatureData, nonce: &ByteString) -> bool {
        let data = [self.identity.certificate(), nonce.as_ref()].concat();
        self.policy
            .asymmetric_verify_signature(self.server.key(), &data, signature.signature.as_ref())
            .is_ok()
    }
}

/// The first bytes of a message with `size` bytes after its head.
fn begun(kind: [u8; 4], head: &[u8], size: usize) -> Vec<u8> {
    let length = u32::try_from(HEADER + head.len() + size).unwrap_or(u32::MAX);
    [&kind[..], &length.to_le_bytes(), head].concat()
}

/// Content without padding, whose last byte or two are its length and whose others repeat the low byte of it.
fn without_padding(content: &[u8], is_long: bool) -> Result<Vec<u8>, SocketError> {
    let wrong = || unreadable("has a wrong padding");
    let (rest, high) = match content.split_last() {
        Some((high, rest)) if is_long => (rest, usize::from(*high)),
        _ => (content, 0),
    };
    let low = rest.last().copied().ok_or_else(wrong)?;
    let padding = (high << 8) + usize::from(low) + 1;
    let length = rest.len().checked_sub(padding).ok_or_else(wrong)?;
    let (content, padding) = rest.split_at(length);
    match padding.iter().all(|byte| *byte == low) {
        true => Ok(content.to_vec()),
        false => Err(wrong()),
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::opcua::testing::{certificate_of, client, server};

    /// Both ends of a channel.
    fn ends(security: OpcUaSecurity, policy: OpcUaPolicy) -> [Protection; 2] {
        let (ours, theirs) = (client(), server());
        let [for_us, for_them] = [&theirs, &ours].map(|other| certificate_of(other));
        let mut ends = [(ours, for_us), (theirs, for_them)]
            .map(|(own, other)| Protection::new(security, policy, own, other));
        let [a, b] = &mut ends;
        let (nonce_a, nonce_b) = (a.new_nonce(), b.new_nonce());
        a.derive(&nonce_b).expect("keys");
        b.derive(&nonce_a).expect("keys");
        ends
    }

    fn all() -> impl Iterator<Item = (OpcUaSecurity, OpcUaPolicy)> {
        let protected = [OpcUaSecurity::Sign, OpcUaSecurity::SignAndEncrypt];
        let policies = OpcUaPolicy::ALL.into_iter();
        policies.flat_map(move |policy| protected.map(|security| (security, policy)))
    }

    #[test]
    fn what_is_sealed_is_opened_by_the_other_end_alone() {
        for (security, policy) in all() {
            let [a, b] = ends(security, policy);
            for length in [0, 1, 14, 15, 16, 17, 190, 500, 4000] {
                let content: Vec<u8> = (0..length).map(|k| k as u8).collect();
                let sealed = a.seal(*b"MSGF", &[7; 8], &content).expect("sealed");
                assert_eq!(b.open(&sealed, HEADER + 8).expect("opened"), content);
                assert!(a.open(&sealed, HEADER + 8).is_err(), "not by its sender");
                let is_readable = sealed.windows(14).any(|part| content.starts_with(part));
                assert_eq!(is_readable, security == OpcUaSecurity::Sign && length >= 14);
                let sealed = a
                    .seal_opening(*b"OPNF", &[7; 30], &content)
                    .expect("sealed");
                assert_eq!(
                    b.open_opening(&sealed, HEADER + 30).expect("opened"),
                    content
                );
                assert!(a.open_opening(&sealed, HEADER + 30).is_err());
            }
        }
    }

    #[test]
    fn any_change_and_any_length_is_an_error() {
        let mut rng = ChaCha8Rng::seed_from_u64(39);
        for (security, policy) in all() {
            let [a, b] = ends(security, policy);
            let sealed = a.seal(*b"MSGF", &[7; 8], &[5; 100]).expect("sealed");
            for at in 0..sealed.len() {
                let mut changed = sealed.clone();
                changed[at] ^= 1 << rng.random_range(0..8);
                assert!(b.open(&changed, HEADER + 8).is_err(), "byte {at}");
                assert!(b.open(&sealed[..at], HEADER + 8).is_err(), "{at} bytes");
            }
            let sealed = a
                .seal_opening(*b"OPNF", &[7; 30], &[5; 100])
                .expect("sealed");
            for _ in 0..6 {
                let at = rng.random_range(0..sealed.len());
                let mut changed = sealed.clone();
                changed[at] ^= 1 << rng.random_range(0..8);
                assert!(b.open_opening(&changed, HEADER + 30).is_err(), "byte {at}");
                assert!(b.open_opening(&sealed[..at], HEADER + 30).is_err());
            }
        }
    }

    #[test]
    fn keys_of_another_token_open_nothing() {
        let [mut a, b] = ends(OpcUaSecurity::SignAndEncrypt, OpcUaPolicy::Basic256Sha256);
        a.new_nonce();
        a.derive(&server_nonce()).expect("keys");
        let sealed = a.seal(*b"MSGF", &[7; 8], &[5; 100]).expect("sealed");
        assert!(b.open(&sealed, HEADER + 8).is_err());
        // Messages that the other end sent before it received the new token are still readable.
        let sealed = b.seal(*b"MSGF", &[7; 8], &[5; 100]).expect("sealed");
        assert!(a.open(&sealed, HEADER + 8).is_err());
        assert_eq!(
            a.open_former(&sealed, HEADER + 8).expect("opened"),
            [5; 100]
        );
        assert!(b.open_former(&sealed, HEADER + 8).is_err());
        let own = a.new_nonce();
        assert!(a.derive(&own).is_err(), "our own number came back");
        assert!(a.derive(&ByteString::null()).is_err(), "no number");
    }

    fn server_nonce() -> ByteString {
        SecurityPolicy::Basic256Sha256.random_nonce()
    }

    #[test]
    fn answers_to_opening_come_from_the_trusted_server_to_us_under_our_policy() {
        let [a, b] = ends(OpcUaSecurity::Sign, OpcUaPolicy::Aes256Sha256RsaPss);
        let head = b.opening_head();
        let [policy, certificate, receiver] = &head;
        let check = |head: [&ByteString; 3]| a.check_opening_head(head.map(AsRef::as_ref));
        assert!(check([policy, certificate, receiver]).is_ok());
        let none = ByteString::from(SecurityPolicy::None.to_uri().as_bytes());
        let foreign = ByteString::from(client().certificate());
        let followed = ByteString::from([certificate.as_ref(), foreign.as_ref()].concat());
        assert!(
            check([policy, &followed, receiver]).is_ok(),
            "with its issuer"
        );
        for (head, why) in [
            ([&none, certificate, receiver], "by the policy"),
            ([policy, &foreign, receiver], "another certificate"),
            (
                [policy, &ByteString::null(), receiver],
                "another certificate",
            ),
            (
                [policy, certificate, &ByteString::null()],
                "encrypted for another",
            ),
        ] {
            let Err(SocketError::Invalid(told)) = check(head) else {
                panic!("{why}");
            };
            assert!(told.contains(why), "{told}");
        }
    }
}

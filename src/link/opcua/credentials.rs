//! Credentials of a client: its certificate, the servers it trusts, and a password.

use std::fmt;
use std::sync::Arc;

use tautline_session::CertificateFingerprint;

use super::identity::ClientIdentity;
use super::passwords::Account;
use crate::error::LinkError;

/// A password, which is shown nowhere.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Password(String);

impl Password {
    /// A password as it was typed.
    #[must_use]
    pub fn new(text: String) -> Self {
        Self(text)
    }

    /// Whether the password is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The text while it is typed.
    pub fn text_mut(&mut self) -> &mut String {
        &mut self.0
    }

    #[cfg(feature = "keyring")]
    pub(super) fn text(&self) -> &str {
        &self.0
    }

    pub(super) fn as_bytes(&self) -> &[u8] {
        self.0.as_bytes()
    }
}

impl fmt::Debug for Password {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Password")
    }
}

/// Keys and trusted servers of the user. It is consulted for each connection, so that servers trusted meanwhile count.
pub trait KeyStore: fmt::Debug + Send + Sync {
    /// Our certificate, made at first use.
    ///
    /// # Errors
    /// If there is none and it cannot be made, or it cannot be read.
    fn identity(&self) -> Result<Arc<ClientIdentity>, LinkError>;

    /// The certificate that is trusted for a server, by its address without path and options.
    ///
    /// # Errors
    /// If the list of trusted servers cannot be read.
    fn trusted(&self, server: &str) -> Result<Option<CertificateFingerprint>, LinkError>;

    /// The stored password of a user, if there is one.
    ///
    /// # Errors
    /// If it cannot be known whether there is one.
    fn password(&self, account: &Account) -> Result<Option<Password>, LinkError>;
}

/// No keys: no server is trusted, so that only connections without security are possible.
#[derive(Debug)]
struct NoKeys;

impl KeyStore for NoKeys {
    fn identity(&self) -> Result<Arc<ClientIdentity>, LinkError> {
        Err(LinkError::Setup(
            "there is no certificate of ours".to_owned(),
        ))
    }

    fn trusted(&self, _server: &str) -> Result<Option<CertificateFingerprint>, LinkError> {
        Ok(None)
    }

    fn password(&self, _account: &Account) -> Result<Option<Password>, LinkError> {
        Ok(None)
    }
}

/// Credentials of a client; by default none.
#[derive(Debug, Clone)]
pub struct Credentials {
    /// Keys and trust.
    pub keys: Arc<dyn KeyStore>,
    /// Password of the user in the address; without it the stored one is used.
    pub password: Option<Password>,
}

impl Default for Credentials {
    fn default() -> Self {
        Self {
            keys: Arc::new(NoKeys),
            password: None,
        }
    }
}

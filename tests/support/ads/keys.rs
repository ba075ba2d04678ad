//! Keys of a client and the servers that it trusts, in memory.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use tautline_link::LinkError;
use tautline_link::opcua::{Account, ClientIdentity, Credentials, KeyStore, Password};
use tautline_session::CertificateFingerprint;

/// Making a key takes a while: all clients of a process have the same.
static IDENTITY: LazyLock<Arc<ClientIdentity>> =
    LazyLock::new(|| Arc::new(ClientIdentity::create().expect("a key")));

/// Keys and trust of a client.
#[derive(Debug, Default)]
pub struct TestKeys(Mutex<HashMap<String, CertificateFingerprint>>);

impl TestKeys {
    /// Keys of a client that trusts a server.
    #[must_use]
    pub fn trusting(server: &str, fingerprint: CertificateFingerprint) -> Self {
        let keys = Self::default();
        let mut trusted = keys.0.lock().unwrap_or_else(PoisonError::into_inner);
        trusted.insert(server.to_owned(), fingerprint);
        drop(trusted);
        keys
    }

    /// Credentials of the client with a password.
    #[must_use]
    pub fn with_password(self, password: &str) -> Credentials {
        Credentials {
            keys: Arc::new(self),
            password: Some(Password::new(password.to_owned())),
        }
    }
}

impl KeyStore for TestKeys {
    fn identity(&self) -> Result<Arc<ClientIdentity>, LinkError> {
        Ok(Arc::clone(&IDENTITY))
    }

    fn trusted(&self, server: &str) -> Result<Option<CertificateFingerprint>, LinkError> {
        let trusted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(trusted.get(server).copied())
    }

    fn password(&self, _account: &Account) -> Result<Option<Password>, LinkError> {
        Ok(None)
    }
}

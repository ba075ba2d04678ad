//! Keys and trusted servers in the folders of the user, and passwords in the keyring of the desktop.

use std::sync::Arc;

use tautline_link::LinkError;
use tautline_link::opcua::{
    Account, ClientIdentity, DesktopKeyring, KeyStore, Password, PasswordStore, PasswordStoreError,
};
use tautline_session::{CertificateFingerprint, Folders, OpcUaKey, TrustedServers};

/// Name of the environment variable with the password of the user at the controller.
pub const PASSWORD: &str = "TAUTLINE_PASSWORD";

/// Keys and trust of the user who runs the program.
#[derive(Debug, Clone)]
pub struct UserKeys {
    folders: Folders,
    passwords: Arc<dyn PasswordStore>,
}

fn to_error(error: impl std::error::Error) -> LinkError {
    LinkError::Setup(error.to_string())
}

impl UserKeys {
    /// Keys and trust in the folders of a user; passwords are in the keyring of the desktop.
    #[must_use]
    pub fn of(folders: Folders) -> Self {
        Self {
            folders,
            passwords: Arc::new(DesktopKeyring),
        }
    }

    /// The same with another store of passwords.
    #[must_use]
    pub fn with_passwords(mut self, passwords: Arc<dyn PasswordStore>) -> Self {
        self.passwords = passwords;
        self
    }

    /// Store of the passwords.
    #[must_use]
    pub fn passwords(&self) -> &Arc<dyn PasswordStore> {
        &self.passwords
    }

    /// Trusts a certificate of a server from now on, in place of its previous one.
    ///
    /// # Errors
    /// If the list of trusted servers cannot be read or written.
    pub fn trust(
        &self,
        server: &str,
        fingerprint: CertificateFingerprint,
    ) -> Result<(), LinkError> {
        let path = self.folders.trusted_servers();
        let mut servers = TrustedServers::read(&path).map_err(to_error)?;
        servers.trust(server, fingerprint);
        servers.write(&path).map_err(to_error)
    }

    fn stored(&self) -> Result<Option<ClientIdentity>, LinkError> {
        let path = self.folders.opcua_key();
        let Some(key) = OpcUaKey::read(&path).map_err(to_error)? else {
            return Ok(None);
        };
        let identity = ClientIdentity::read(&key.certificate, &key.private_key);
        let named = |error| LinkError::Setup(format!("{}: {error}", path.display()));
        identity.map(Some).map_err(named)
    }
}

impl KeyStore for UserKeys {
    fn identity(&self) -> Result<Arc<ClientIdentity>, LinkError> {
        if let Some(identity) = self.stored()? {
            return Ok(Arc::new(identity));
        }
        let made = ClientIdentity::create()?;
        let key = made.private_key()?;
        let path = self.folders.opcua_key();
        let written = OpcUaKey::create(&path, made.certificate(), key.as_ref());
        match (written, self.stored()?) {
            // If another program has created an identity meanwhile, that one is used.
            (_, Some(identity)) => Ok(Arc::new(identity)),
            (Err(error), None) => Err(to_error(error)),
            (Ok(()), None) => Ok(Arc::new(made)),
        }
    }

    fn trusted(&self, server: &str) -> Result<Option<CertificateFingerprint>, LinkError> {
        let servers = TrustedServers::read(&self.folders.trusted_servers()).map_err(to_error)?;
        Ok(servers.find(server))
    }

    fn password(&self, account: &Account) -> Result<Option<Password>, LinkError> {
        match self.passwords.find(account) {
            Ok(found) => Ok(found),
            Err(PasswordStoreError::NotBuilt) => Ok(None),
            Err(error) => Err(LinkError::Setup(format!(
                "the user {:?} needs a password, and {error}",
                account.user
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_certificate_is_made_once_and_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let keys = UserKeys::of(Folders::below(folder.path()));
        let made = keys.identity().expect("made");
        let read = keys.identity().expect("read");
        assert_eq!(read.certificate(), made.certificate());
        assert!(read.uri().ends_with(":tautline"), "{}", read.uri());
        let path = folder.path().join("opcua.pem");
        std::fs::write(&path, "damaged").expect("written");
        let told = keys.identity().expect_err("damaged").to_string();
        assert!(told.contains("opcua.pem"), "{told}");
    }

    #[test]
    fn a_server_is_trusted_until_another_certificate_is() {
        let folder = tempfile::tempdir().expect("a folder");
        let keys = UserKeys::of(Folders::below(folder.path()));
        let server = "opc.tcp://plc:4840";
        assert_eq!(keys.trusted(server), Ok(None));
        for text in ["one", "two"] {
            let fingerprint = CertificateFingerprint::of(text.as_bytes());
            keys.trust(server, fingerprint).expect("written");
            assert_eq!(keys.trusted(server), Ok(Some(fingerprint)));
        }
        assert_eq!(keys.trusted("opc.tcp://other:4840"), Ok(None));
    }
}

//! Passwords of users, kept in the keyring of the desktop.

use std::fmt::Debug;

use super::credentials::Password;

/// A user name at a server.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Account {
    /// Address of the server, without path and options.
    pub server: String,
    /// Name of the user.
    pub user: String,
}

/// Why a store of passwords cannot be used, as one sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PasswordStoreError {
    /// The feature `keyring` is missing.
    #[error(
        "this build cannot store passwords: take a release, or build it with `cargo build --release --features keyring`"
    )]
    NotBuilt,
    /// No answer in time; somebody may have to unlock it.
    #[error("the keyring of the desktop has not answered within {seconds} s: unlock it first")]
    NoAnswer {
        /// Time limit (s).
        seconds: u64,
    },
    /// No store is available, or it refuses.
    #[error("the keyring of the desktop cannot be used ({0})")]
    Unusable(String),
}

/// Keeps passwords of users.
pub trait PasswordStore: Debug + Send + Sync {
    /// The password of a user; `None` if none is kept.
    ///
    /// # Errors
    /// If that cannot be known.
    fn find(&self, account: &Account) -> Result<Option<Password>, PasswordStoreError>;

    /// Keeps a password, in place of another one.
    ///
    /// # Errors
    /// If it cannot be kept.
    fn save(&self, account: &Account, password: &Password) -> Result<(), PasswordStoreError>;

    /// Removes the password of a user; returns whether there was one.
    ///
    /// # Errors
    /// If it cannot be removed.
    fn forget(&self, account: &Account) -> Result<bool, PasswordStoreError>;
}

/// Whether the program was built with the feature `keyring`.
pub const HAS_KEYRING: bool = cfg!(feature = "keyring");

/// The keyring of the desktop: Secret Service on Linux, Keychain on macOS, Credential Manager on Windows.
#[derive(Debug, Clone, Copy, Default)]
pub struct DesktopKeyring;

#[cfg(not(feature = "keyring"))]
impl PasswordStore for DesktopKeyring {
    fn find(&self, _account: &Account) -> Result<Option<Password>, PasswordStoreError> {
        Err(PasswordStoreError::NotBuilt)
    }

    fn save(&self, _account: &Account, _password: &Password) -> Result<(), PasswordStoreError> {
        Err(PasswordStoreError::NotBuilt)
    }

    fn forget(&self, _account: &Account) -> Result<bool, PasswordStoreError> {
        Err(PasswordStoreError::NotBuilt)
    }
}

#[cfg(feature = "keyring")]
mod desktop {
    use std::sync::mpsc::channel;
    use std::thread;
    use std::time::Duration;

    use keyring::{Entry, Error};

    use super::{Account, DesktopKeyring, Password, PasswordStore, PasswordStoreError};

    /// Time for an answer (s). A keyring that is locked asks its user, who needs time to type a password.
    const PATIENCE_S: u64 = 30;

    /// Answer of the keyring about an account; `None` if it has no entry for it.
    fn ask<T: Send + 'static>(
        account: &Account,
        question: impl FnOnce(&Entry) -> keyring::Result<T> + Send + 'static,
    ) -> Result<Option<T>, PasswordStoreError> {
        let (sender, receiver) = channel();
        let Account { server, user } = account.clone();
        // Calls of the keyring have no time limit: a thread that gets no answer is left behind.
        thread::spawn(move || {
            let _ = sender.send(answer(&server, &user, question));
        });
        let answer = receiver.recv_timeout(Duration::from_secs(PATIENCE_S));
        answer.unwrap_or(Err(PasswordStoreError::NoAnswer {
            seconds: PATIENCE_S,
        }))
    }

    /// The same without a time limit.
    fn answer<T>(
        server: &str,
        user: &str,
        question: impl FnOnce(&Entry) -> keyring::Result<T>,
    ) -> Result<Option<T>, PasswordStoreError> {
        let unusable = |error: &Error| PasswordStoreError::Unusable(in_words(error));
        // If the store could not be opened, an entry reports only that there is no store.
        Entry::store_status().as_ref().map_err(unusable)?;
        let entry = Entry::new(&format!("Tautline {server}"), user);
        match entry.and_then(|entry| question(&entry)) {
            Ok(answer) => Ok(Some(answer)),
            Err(Error::NoEntry) => Ok(None),
            Err(error) => Err(unusable(&error)),
        }
    }

    /// The cause in one line, without the content of an entry.
    fn in_words(error: &Error) -> String {
        let text = match error {
            Error::PlatformFailure(cause) | Error::NoStorageAccess(cause) => cause.to_string(),
            Error::BadEncoding(_) | Error::BadDataFormat(..) => "its entry is no text".to_owned(),
            error => error.to_string(),
        };
        text.chars().filter(|c| !c.is_control()).take(200).collect()
    }

    impl PasswordStore for DesktopKeyring {
        fn find(&self, account: &Account) -> Result<Option<Password>, PasswordStoreError> {
            let found = ask(account, Entry::get_password)?;
            Ok(found.map(Password::new))
        }

        fn save(&self, account: &Account, password: &Password) -> Result<(), PasswordStoreError> {
            let text = password.text().to_owned();
            let saved = ask(account, move |entry| entry.set_password(&text))?;
            let vanished = || PasswordStoreError::Unusable("it keeps no entry".to_owned());
            saved.ok_or_else(vanished)
        }

        fn forget(&self, account: &Account) -> Result<bool, PasswordStoreError> {
            let removed = ask(account, Entry::delete_credential)?;
            Ok(removed.is_some())
        }
    }
}

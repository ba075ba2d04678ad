//! Passwords in memory.

use std::sync::{Mutex, PoisonError};

use tautline_link::opcua::{Account, Password, PasswordStore, PasswordStoreError};

/// Passwords in memory, as those of the keyring of a desktop.
#[derive(Debug, Default)]
pub struct MemoryPasswords(Mutex<Vec<(Account, Password)>>);

impl MemoryPasswords {
    /// Accounts with a password.
    #[must_use]
    pub fn accounts(&self) -> Vec<Account> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.iter().map(|(account, _)| account.clone()).collect()
    }
}

impl PasswordStore for MemoryPasswords {
    fn find(&self, account: &Account) -> Result<Option<Password>, PasswordStoreError> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = kept.iter().find(|(known, _)| known == account);
        Ok(found.map(|(_, password)| password.clone()))
    }

    fn save(&self, account: &Account, password: &Password) -> Result<(), PasswordStoreError> {
        self.forget(account)?;
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push((account.clone(), password.clone()));
        Ok(())
    }

    fn forget(&self, account: &Account) -> Result<bool, PasswordStoreError> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = kept.len();
        kept.retain(|(known, _)| known != account);
        Ok(kept.len() < before)
    }
}

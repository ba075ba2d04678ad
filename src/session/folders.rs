//! Folders of the user for preferences and recovery files.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use etcetera::BaseStrategy;
use tautline_files::{Location, ReadError};

/// Environment variable with one folder for everything, in place of those of the operating system.
const OVERRIDE: &str = "TAUTLINE_HOME";
const NAME: &str = "tautline";

/// The folders of one user; they need not exist yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folders {
    config: PathBuf,
    state: PathBuf,
}

impl Folders {
    /// The folders of the user who runs the program: that in the environment variable
    /// `TAUTLINE_HOME`, else those of the operating system (under Linux `XDG_CONFIG_HOME` and
    /// `XDG_STATE_HOME`, else in `HOME`).
    ///
    /// # Errors
    /// If the operating system has no home folder for the user.
    pub fn of_user() -> Result<Self, ReadError> {
        Self::chosen(env::var_os(OVERRIDE)).unwrap_or_else(Self::of_system)
    }

    /// Uses one folder for everything.
    #[must_use]
    pub fn below(folder: &Path) -> Self {
        Self {
            config: folder.into(),
            state: folder.into(),
        }
    }

    /// The preferences file.
    #[must_use]
    pub fn preferences(&self) -> PathBuf {
        self.config.join("preferences.json")
    }

    /// The folder with the user's own sensors, see [`Catalogue`](crate::Catalogue).
    #[must_use]
    pub fn sensors(&self) -> PathBuf {
        self.config.join("sensors")
    }

    /// The folder with the user's own hypotheses, see [`HypothesisFolder`](crate::HypothesisFolder).
    #[must_use]
    pub fn effects(&self) -> PathBuf {
        self.config.join("effects")
    }

    /// The certificate for OPC UA with its private key.
    #[must_use]
    pub fn opcua_key(&self) -> PathBuf {
        self.config.join("opcua.pem")
    }

    /// The list of trusted OPC UA servers.
    #[must_use]
    pub fn trusted_servers(&self) -> PathBuf {
        self.config.join("trusted-servers.json")
    }

    /// The recovery folder; see [`RecoveryWriter`](crate::RecoveryWriter).
    #[must_use]
    pub fn recovery(&self) -> PathBuf {
        self.state.join("recovery")
    }

    fn chosen(value: Option<OsString>) -> Option<Result<Self, ReadError>> {
        let folder = value.filter(|value| !value.is_empty())?;
        let absolute = std::path::absolute(folder)
            .map_err(|error| ReadError::io(OVERRIDE, Location::File, &error));
        Some(absolute.map(|folder| Self::below(&folder)))
    }

    fn of_system() -> Result<Self, ReadError> {
        let base = etcetera::choose_base_strategy().map_err(|_| {
            let message = format!("not found, expected it in the environment or {OVERRIDE}");
            ReadError::new("home folder", Location::File, message)
        })?;
        let state = base.state_dir().unwrap_or_else(|| base.data_dir());
        Ok(Self {
            config: base.config_dir().join(NAME),
            state: state.join(NAME),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_folder_for_everything_or_those_of_the_system() {
        let here = Folders::chosen(Some("x".into())).expect("chosen");
        let here = here.expect("a folder");
        assert!(here.preferences().is_absolute());
        assert!(here.preferences().ends_with("x/preferences.json"));
        assert!(here.recovery().ends_with("x/recovery"));
        assert!(Folders::chosen(None).is_none());
        assert!(Folders::chosen(Some("".into())).is_none());
        // A user without a home folder gets a sentence.
        match Folders::of_system() {
            Ok(system) => assert!(system.recovery().ends_with("tautline/recovery")),
            Err(error) => assert!(error.to_string().contains("TAUTLINE_HOME"), "{error}"),
        }
    }
}

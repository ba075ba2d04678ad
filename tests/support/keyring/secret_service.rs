//! A session bus with a keyring in a process of its own, which shares no code with ours.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use serde::{Deserialize, Serialize};

use crate::support::program::Folder;
use crate::support::python::python;

/// An item of a keyring.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StoredItem {
    /// Attributes for the search.
    pub attributes: BTreeMap<String, String>,
    /// The stored content.
    pub secret: String,
}

/// A keyring; its process ends when it is dropped.
pub struct SecretService {
    process: Child,
    folder: Folder,
}

impl SecretService {
    /// Starts one with these items; a `silent` one never answers.
    ///
    /// # Panics
    /// If its Python environment is missing.
    #[must_use]
    pub fn start(items: &[StoredItem], silent: bool) -> Self {
        let folder = Folder::new();
        let text = serde_json::to_string(items).expect("JSON");
        folder.write("items.json", &text);
        let mut process = python("tests/support/keyring/secret_service.py")
            .arg(folder.path())
            .args(silent.then_some("silent"))
            .stdout(Stdio::piped())
            .spawn()
            .expect("a process");
        let output = process.stdout.take().expect("a pipe");
        let mut line = String::new();
        BufReader::new(output).read_line(&mut line).expect("a line");
        assert_eq!(line.trim(), "listens");
        Self { process, folder }
    }

    /// Ends the process, so that programs find no service at its address.
    #[must_use]
    pub fn gone(mut self) -> Self {
        let _ = self.process.kill();
        let _ = self.process.wait();
        self
    }

    /// Sets the address of the service for a program.
    pub fn serve(&self, command: &mut Command) {
        let address = format!("unix:path={}", self.folder.join("bus"));
        command.env("DBUS_SESSION_BUS_ADDRESS", address);
    }

    /// The stored content.
    ///
    /// # Panics
    /// If its file is damaged.
    #[must_use]
    pub fn items(&self) -> Vec<StoredItem> {
        let items: Vec<Option<StoredItem>> =
            serde_json::from_value(self.folder.json("items.json")).expect("items");
        items.into_iter().flatten().collect()
    }
}

impl Drop for SecretService {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

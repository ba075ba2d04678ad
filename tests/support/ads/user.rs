//! User who runs the program at a controller.

use std::process::{Child, Command, Stdio};

use tautline_session::{Folders, TrustedServers};

use super::plant::Plant;
use super::server::PASSWORD;
use crate::support::program::{self, Answer, Folder};

/// A user with files and a password of his own, who trusts the server of a plant.
pub struct User(Folder);

impl User {
    /// The user of a plant.
    ///
    /// # Panics
    /// If its files cannot be written.
    #[must_use]
    pub fn of(plant: &Plant) -> Self {
        let user = Self(Folder::new());
        if let Some(fingerprint) = plant.server.fingerprint {
            let mut servers = TrustedServers::default();
            servers.trust(&plant.server.url().origin(), fingerprint);
            let path = Folders::below(user.0.path()).trusted_servers();
            servers.write(&path).expect("written");
        }
        user
    }

    /// The program with arguments, as this user runs it.
    #[must_use]
    pub fn command(&self, words: &[&str]) -> Command {
        let mut command = program::command(words);
        command.env("TAUTLINE_HOME", self.0.path());
        command.env("TAUTLINE_PASSWORD", PASSWORD);
        command
    }

    /// Runs the program to its end.
    #[must_use]
    pub fn run(&self, words: &[&str]) -> Answer {
        program::run(&mut self.command(words))
    }

    /// Starts the program, to type there.
    #[must_use]
    pub fn start(&self, words: &[&str]) -> Child {
        program::spawn(&mut self.command(words), Stdio::piped())
    }
}

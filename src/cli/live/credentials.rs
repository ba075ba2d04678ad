//! Certificate, trusted servers and password of the user, for controllers that ask who connects.

use std::env;
use std::io::IsTerminal;
use std::sync::Arc;

use anyhow::Result;
use tautline_link::opcua::{Credentials, Password};
use tautline_session::Folders;
use tautline_workflow::controllers::{ConnectionSetup, PASSWORD, UserKeys};

use crate::BadInput;

/// The setup with what the user brings along.
pub fn with_credentials(setup: &ConnectionSetup) -> Result<ConnectionSetup> {
    if !setup.asks_who_connects() {
        return Ok(setup.clone());
    }
    let credentials = Credentials {
        keys: Arc::new(UserKeys::of(Folders::of_user()?)),
        password: setup.user().map(password).transpose()?,
    };
    Ok(setup.clone().with_credentials(credentials))
}

/// The password: that of the environment, else as typed, which no terminal shows.
fn password(user: &str) -> Result<Password> {
    if let Ok(password) = env::var(PASSWORD) {
        return Ok(Password::new(password));
    }
    // It is asked for on the terminal itself, whatever standard input and output are; without anybody there is no answer.
    let has_somebody = std::io::stdin().is_terminal() || std::io::stderr().is_terminal();
    let typed = has_somebody
        .then(|| rpassword::prompt_password(format!("Password of {user:?} at the controller: ")));
    match typed {
        Some(Ok(password)) => Ok(Password::new(password)),
        _ => Err(BadInput::new(format!(
            "the user {user:?} needs a password: set {PASSWORD}, or start this on a terminal"
        ))),
    }
}

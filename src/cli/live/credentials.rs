//! Certificate, trusted servers and password of the user, for controllers with authentication.

use std::env;
use std::io::IsTerminal;
use std::sync::Arc;

use anyhow::Result;
use tautline_link::LinkError;
use tautline_link::opcua::{Account, Credentials, Password, PasswordStore, PasswordStoreError};
use tautline_session::Folders;
use tautline_workflow::controllers::{ConnectionSetup, ControllerChoice, PASSWORD, UserKeys};

use super::connection::link_error;
use crate::BadInput;
use crate::output::{message, note};

/// Arguments for the password of the user at a controller.
#[derive(Debug, clap::Args)]
pub struct PasswordArguments {
    /// Keep the password of the user of an opc.tcp: controller in the keyring of the desktop once it was accepted, for later commands and the window
    #[arg(long)]
    save_password: bool,
    /// Remove the password of the user of an opc.tcp: controller from the keyring of the desktop, and ask for it anew
    #[arg(long)]
    forget_password: bool,
}

impl PasswordArguments {
    /// Checks that there is a user for whom a password can be kept or forgotten.
    pub fn check(&self, choice: &ControllerChoice) -> Result<()> {
        let account = match choice {
            ControllerChoice::OpcUa(address) => address.account(),
            _ => None,
        };
        for (wanted, option) in [
            (self.save_password, "--save-password"),
            (self.forget_password, "--forget-password"),
        ] {
            if wanted && account.is_none() {
                return Err(BadInput::new(format!(
                    "{option}: found no user with a password, expected opc.tcp://HOST?user=NAME"
                )));
            }
        }
        Ok(())
    }
}

/// Source of a password.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    Environment,
    Keyring,
    Terminal,
}

/// A password for a user.
struct Given {
    account: Account,
    password: Password,
    source: Source,
}

/// Credentials of the user for a controller.
pub struct SignIn {
    /// The setup of the connection with the credentials.
    pub setup: ConnectionSetup,
    given: Option<Given>,
    passwords: Option<Arc<dyn PasswordStore>>,
    saves: bool,
}

impl SignIn {
    /// Collects the credentials for a controller; the password is taken from the environment, else from the keyring, else typed.
    pub fn of(setup: &ConnectionSetup, arguments: &PasswordArguments) -> Result<Self> {
        if !setup.asks_who_connects() {
            return Ok(Self {
                setup: setup.clone(),
                given: None,
                passwords: None,
                saves: false,
            });
        }
        let keys = UserKeys::of(Folders::of_user()?);
        let passwords = Arc::clone(keys.passwords());
        let account = setup.account();
        let given = account.map(|account| give(account, arguments, &*passwords));
        let given = given.transpose()?;
        let credentials = Credentials {
            keys: Arc::new(keys),
            password: given.as_ref().map(|given| given.password.clone()),
        };
        Ok(Self {
            setup: setup.clone().with_credentials(credentials),
            given,
            passwords: Some(passwords),
            saves: arguments.save_password,
        })
    }

    /// Keeps the password that the controller has accepted, if requested.
    pub fn accepted(&self) {
        let (Some(given), Some(passwords)) = (&self.given, &self.passwords) else {
            return;
        };
        if !self.saves || given.source == Source::Keyring {
            return;
        }
        let user = &given.account.user;
        match passwords.save(&given.account, &given.password) {
            Ok(()) => note!("the password of {user:?} is in the keyring of the desktop"),
            // The controller is connected: the command continues.
            Err(error) => message(format!("The password of {user:?} was not kept: {error}")),
        }
    }

    /// The refusal of a connection, with advice for a password of the keyring.
    pub fn refused(&self, error: LinkError) -> anyhow::Error {
        let is_stored = self
            .given
            .as_ref()
            .is_some_and(|given| given.source == Source::Keyring);
        match error {
            LinkError::UnknownUser(text) if is_stored => {
                let advice = "the password is that of the keyring, --forget-password removes it";
                link_error(LinkError::UnknownUser(format!("{text}; {advice}")))
            }
            error => link_error(error),
        }
    }
}

/// The password of a user from the first source that has one.
fn give(
    account: Account,
    arguments: &PasswordArguments,
    passwords: &dyn PasswordStore,
) -> Result<Given> {
    let option = |option: &str, error| BadInput::new(format!("{option}: {error}"));
    if arguments.forget_password {
        let user = &account.user;
        match passwords.forget(&account) {
            Ok(true) => note!("the password of {user:?} is no longer in the keyring"),
            Ok(false) => note!("there was no password of {user:?} in the keyring"),
            Err(error) => return Err(option("--forget-password", error)),
        }
    }
    let given = env::var(PASSWORD).ok();
    // If the password cannot be kept as requested, this is reported before anything is asked or sent.
    let stored = match given.is_none() || arguments.save_password {
        true => passwords.find(&account),
        false => Ok(None),
    };
    let (password, source) = match (given, stored) {
        (_, Err(error)) if arguments.save_password => {
            return Err(option("--save-password", error));
        }
        (Some(given), _) => (Password::new(given), Source::Environment),
        (None, Ok(Some(stored))) => (stored, Source::Keyring),
        (None, Ok(None) | Err(PasswordStoreError::NotBuilt)) => {
            (typed(&account.user, None)?, Source::Terminal)
        }
        (None, Err(error)) => (typed(&account.user, Some(&error))?, Source::Terminal),
    };
    Ok(Given {
        account,
        password,
        source,
    })
}

/// The password typed by the user without echo; `error` is the reason why the keyring could not be used.
fn typed(user: &str, error: Option<&PasswordStoreError>) -> Result<Password> {
    // The question is on the terminal itself, independent of standard input and output; without a terminal nobody can answer.
    let has_somebody = std::io::stdin().is_terminal() || std::io::stderr().is_terminal();
    if has_somebody {
        if let Some(error) = error {
            note!("{error}");
        }
        let question = format!("Password of {user:?} at the controller: ");
        if let Ok(password) = rpassword::prompt_password(question) {
            return Ok(Password::new(password));
        }
    }
    let why = error.map_or_else(String::new, |error| format!("; {error}"));
    Err(BadInput::new(format!(
        "the user {user:?} needs a password: set {PASSWORD}, or start this on a terminal{why}"
    )))
}

//! Connection dialog: settings, files and check of symbols.

use std::sync::Arc;

use tautline_link::opcua::{Account, Credentials, Password};
use tautline_link::{LinkError, UntrustedServer};
use tautline_session::{
    Connection, LaserSettings, LastConnection, SymbolMapping, UserCertificateFiles, read_versioned,
    write_versioned,
};
use tautline_workflow::controllers::{PASSWORD, UserKeys, check_symbols};

use super::file_dialog::pick;
use super::file_tasks::{ask_save, write};
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{CHECKING, RobotCommand, Setup, SetupOutcome, UserFile};
use crate::model::dialogs::SaveContent;
use crate::model::edit::Edit;
use crate::model::messages::{Severity, full_sentence};
use crate::model::{ConnectionRequest, Model, UiRequest};

fn start(model: &mut Model, title: &str, work: impl FnOnce() -> SetupOutcome + Send + 'static) {
    model.tasks.start(title, move |_| work().into());
}

fn ask(model: &mut Model, request: ConnectionRequest) {
    model.request(UiRequest::Connection(request));
}

pub(super) fn perform(model: &mut Model, setup: Setup) {
    match setup {
        Setup::Open => ask(model, ConnectionRequest::Open),
        Setup::Close => ask(model, ConnectionRequest::Close),
        Setup::UsePassword { password, keeps } => {
            model.link.password = password;
            model.link.keeps_password = keeps;
        }
        Setup::ForgetPassword(account) => forget(model, account),
        Setup::Trust(server) => trust(model, &server),
        Setup::Save(settings) => save(model, settings),
        Setup::PickRecording => pick(model, FileRequest::folder("Recording"), |folder| {
            RobotCommand::Setup(Setup::Recording(folder))
        }),
        Setup::Recording(folder) => ask(model, ConnectionRequest::SetFolder(folder)),
        Setup::PickUserFile(which) => {
            let request = match which {
                UserFile::Certificate => {
                    FileRequest::file("Certificate of the user", &["der", "pem", "crt", "cer"])
                }
                UserFile::Key => FileRequest::file("Private key", &["pem", "key", "der"]),
            };
            pick(model, request, move |path| {
                RobotCommand::Setup(Setup::TakeUserFile(which, path))
            });
        }
        Setup::TakeUserFile(which, path) => {
            ask(model, ConnectionRequest::SetUserFile(which, path));
        }
        Setup::Check(what) => check(model, *what),
        Setup::AskImport => {
            let request = FileRequest::file("Names of symbols", &["json"]);
            pick(model, request, |path| {
                RobotCommand::Setup(Setup::Import(path))
            });
        }
        Setup::Import(path) => start(model, "Reading symbol names", move || {
            let read = read_versioned::<SymbolMapping>(&path);
            let read = read.map(|read| Box::new(read.value));
            SetupOutcome::Imported(read.map_err(|error| error.to_string()))
        }),
        Setup::AskExport(mapping) => {
            ask_save(model, SaveContent::Symbols(mapping), "symbols.json");
        }
        Setup::Export(path, mapping) => write(model, "Writing symbol names", path, move |path| {
            write_versioned(path, &*mapping)
        }),
    }
}

fn save(model: &mut Model, settings: Box<(Connection, LaserSettings)>) {
    let Some(open) = &model.open else {
        return;
    };
    let (connection, laser) = &*settings;
    let is_new = {
        let session = open.session();
        session.connection != *connection || session.laser_source != *laser
    };
    let reached = LastConnection {
        place: connection.place.clone(),
        opcua: connection.opcua.clone(),
        laser: laser.clone(),
    };
    if !connection.is_empty() && model.preferences.last_connection != reached {
        model.change_preferences(|preferences| preferences.last_connection = reached);
    }
    let files = connection.opcua.as_ref();
    let files = files.and_then(|place| place.user_certificate.as_ref());
    if let Some(warning) = files.and_then(UserCertificateFiles::warning) {
        model.messages.warning(full_sentence(&warning));
    }
    if is_new && let Some(open) = &mut model.open {
        open.edit(Edit::SetConnection(settings));
    }
}

/// Keys, trusted certificates and passwords of the user.
fn keys(model: &Model) -> UserKeys {
    let keys = UserKeys::of(model.folders.clone());
    match &model.options.passwords {
        Some(passwords) => keys.with_passwords(Arc::clone(passwords)),
        None => keys,
    }
}

/// Stores the password accepted by the controller, if wanted.
pub(super) fn accepted(model: &mut Model, account: Option<Account>) {
    let is_wanted = std::mem::take(&mut model.link.keeps_password);
    let Some((account, password)) = account.zip(model.link.password.clone()) else {
        return;
    };
    if !is_wanted {
        return;
    }
    let passwords = Arc::clone(keys(model).passwords());
    start(model, "Keeping the password", move || {
        let user = &account.user;
        let kept = passwords.save(&account, &password);
        let kept = kept.map(|()| format!("The password of {user} is kept on this computer."));
        SetupOutcome::Password(
            kept.map_err(|error| format!("The password of {user} was not kept: {error}.")),
        )
    });
}

fn forget(model: &mut Model, account: Account) {
    let passwords = Arc::clone(keys(model).passwords());
    model.link.password = None;
    start(model, "Forgetting the password", move || {
        let user = &account.user;
        SetupOutcome::Password(match passwords.forget(&account) {
            Ok(true) => Ok(format!(
                "The password of {user} is no longer on this computer."
            )),
            Ok(false) => Ok(format!("No password of {user} is kept on this computer.")),
            Err(error) => Err(full_sentence(&error.to_string())),
        })
    });
}

/// Credentials for a server. A typed password takes precedence over that of the environment, and that over the stored
/// one.
pub(super) fn credentials(model: &Model) -> Credentials {
    let typed = model.link.password.clone();
    let given = || std::env::var(PASSWORD).ok().map(Password::new);
    Credentials {
        keys: Arc::new(keys(model)),
        password: typed.or_else(given),
    }
}

/// Trusts the certificate that the operator has compared.
fn trust(model: &mut Model, server: &UntrustedServer) {
    let keys = keys(model);
    match keys.trust(&server.server, server.fingerprint) {
        Ok(()) => {
            let text = format!("Trusted the certificate of {}.", server.server);
            model.messages.info(text);
        }
        Err(error) => refuse(model, full_sentence(&error.to_string())),
    }
}

fn check(model: &mut Model, connection: Connection) {
    let Some(open) = &model.open else {
        return;
    };
    // A controller accepts only one connection of this program.
    if model.link.is_connected() || model.link.connecting || model.tasks.runs(CHECKING) {
        return;
    }
    let robot = open.session().robot.clone();
    let credentials = credentials(model);
    start(model, CHECKING, move || {
        let checked = check_symbols(&connection, &robot, credentials);
        match checked {
            Err(LinkError::Untrusted(server)) => SetupOutcome::Untrusted(server),
            checked => SetupOutcome::Checked(checked.map_err(|error| error.to_string())),
        }
    });
}

/// Shows an error message in the dialog.
fn refuse(model: &mut Model, text: String) {
    ask(model, ConnectionRequest::Refuse(text.clone()));
    model.messages.log(Severity::Error, text);
}

pub(super) fn receive(model: &mut Model, outcome: SetupOutcome) {
    match outcome {
        SetupOutcome::Checked(checked) => ask(model, ConnectionRequest::ShowChecked(checked)),
        SetupOutcome::Untrusted(server) => ask(model, ConnectionRequest::AskTrust(server)),
        SetupOutcome::Password(Ok(text)) => model.messages.info(text),
        SetupOutcome::Password(Err(text)) => refuse(model, text),
        SetupOutcome::Imported(Ok(mapping)) => {
            let Some(open) = &model.open else {
                return;
            };
            match mapping.check(&open.session().robot) {
                Ok(()) => ask(model, ConnectionRequest::UseSymbols(mapping)),
                Err(error) => {
                    let (place, what) = (error.pointer, error.message);
                    let text = format!("The names do not fit this robot: {place}: {what}.");
                    refuse(model, text);
                }
            }
        }
        SetupOutcome::Imported(Err(error)) => refuse(model, error),
    }
}

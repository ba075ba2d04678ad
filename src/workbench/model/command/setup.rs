//! The connection dialog.

use std::path::PathBuf;

use tautline_link::UntrustedServer;
use tautline_link::opcua::{Account, Password};
use tautline_link::symbols::SymbolCheck;
use tautline_session::{Connection, LaserSettings, SymbolMapping};

/// Title of the task that checks symbols.
pub const CHECKING: &str = "Checking symbols";

/// File of a user who authenticates by certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UserFile {
    Certificate,
    Key,
}

/// Request of the connection dialog.
#[derive(Debug, Clone)]
pub enum Setup {
    Open,
    Close,
    /// Sets the password of the user at the controller.
    UsePassword {
        password: Option<Password>,
        /// Whether the password is stored once the controller has accepted it.
        keeps: bool,
    },
    /// Removes the stored password of a user.
    ForgetPassword(Account),
    /// Trusts the certificate of a server.
    Trust(Box<UntrustedServer>),
    /// Stores the settings in the session, and in the preferences for the next one.
    Save(Box<(Connection, LaserSettings)>),
    /// Asks for the folder of a recording.
    PickRecording,
    Recording(PathBuf),
    /// Asks for a file of the user at the controller.
    PickUserFile(UserFile),
    TakeUserFile(UserFile, PathBuf),
    /// Checks the symbols of a mapping at a controller.
    Check(Box<Connection>),
    /// Asks for a file with names of symbols.
    AskImport,
    /// Reads names of symbols from a file.
    Import(PathBuf),
    /// Asks for a path to export names of symbols to.
    AskExport(Box<SymbolMapping>),
    /// Writes names of symbols to a file.
    Export(PathBuf, Box<SymbolMapping>),
}

#[derive(Debug)]
pub enum SetupOutcome {
    /// Symbols as the controller describes them, or an error message.
    Checked(Result<Vec<SymbolCheck>, String>),
    /// The symbols could not be checked because the certificate of the server is not trusted.
    Untrusted(Box<UntrustedServer>),
    /// Confirmation that a stored password was changed, or an error message.
    Password(Result<String, String>),
    /// Names of symbols from a file, or an error message.
    Imported(Result<Box<SymbolMapping>, String>),
}

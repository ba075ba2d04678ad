//! The connection dialog.

use std::path::PathBuf;

use tautline_link::UntrustedServer;
use tautline_link::opcua::{Account, Password};
use tautline_link::symbols::SymbolCheck;
use tautline_session::{Connection, LaserSettings, SymbolMapping};

/// Title of looking symbols up.
pub const CHECKING: &str = "Checking symbols";

/// A file of a user whom the controller knows by a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UserFile {
    Certificate,
    Key,
}

/// What the connection dialog asks for.
#[derive(Debug, Clone)]
pub enum Setup {
    Open,
    Close,
    /// Takes the password of the user at the controller.
    UsePassword {
        password: Option<Password>,
        /// Whether it is kept once the controller has accepted it.
        keeps: bool,
    },
    /// Removes the stored password of a user.
    ForgetPassword(Account),
    /// Trusts the certificate of a server.
    Trust(Box<UntrustedServer>),
    /// Stores the settings in the session, and for the next one in the preferences.
    Save(Box<(Connection, LaserSettings)>),
    /// Asks for the folder of a recording.
    PickRecording,
    Recording(PathBuf),
    /// Asks for a file of the user at the controller.
    PickUserFile(UserFile),
    TakeUserFile(UserFile, PathBuf),
    /// Looks the symbols of a mapping up at a controller.
    Check(Box<Connection>),
    /// Asks for a file with names of symbols.
    AskImport,
    /// Reads names of symbols from a file.
    Import(PathBuf),
    /// Asks where to write names of symbols.
    AskExport(Box<SymbolMapping>),
    /// Writes names of symbols to a file.
    Export(PathBuf, Box<SymbolMapping>),
}

#[derive(Debug)]
pub enum SetupOutcome {
    /// The symbols as the controller describes them, or one sentence.
    Checked(Result<Vec<SymbolCheck>, String>),
    /// The symbols could not be looked up because the certificate of the server is not trusted.
    Untrusted(Box<UntrustedServer>),
    /// What has become of a stored password, or why nothing was possible.
    Password(Result<String, String>),
    /// Names of symbols were read, or one sentence.
    Imported(Result<Box<SymbolMapping>, String>),
}

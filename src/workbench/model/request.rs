//! Requests of commands to panels and views.

use std::path::PathBuf;

use tautline_core::diagnosis::Quantity;
use tautline_core::measurement::Variable;
use tautline_link::UntrustedServer;
use tautline_link::symbols::SymbolCheck;
use tautline_session::SymbolMapping;

use super::command::UserFile;
use super::plot_preparation::Preparation;
use tautline_workflow::precalibration::Table;

/// Change of panels and views by a command. They belong to the shell, which carries it out after the commands of a
/// frame.
#[derive(Debug)]
pub enum UiRequest {
    /// Shows the part of a panel that has this table.
    ShowTable(Table),
    /// Plots residuals of a kind of reading along a variable and colours cables by their residuals.
    ShowDependence(Quantity, Option<usize>, Variable),
    /// Shows the robot in a window that has room for one part only.
    ShowRobot,
    /// Shows the description of the robot in the panel of the phase Modeling.
    ShowDescription,
    /// Shows the live scope among the plots.
    ShowScope,
    /// Shows the geometry in the panel of the identification.
    ShowGeometry,
    /// Shows the model doctor in the panel of the identification.
    ShowDoctor,
    /// Passes prepared data to the plots.
    TakePreparation(Box<Preparation>),
    /// Change of the connection dialog.
    Connection(ConnectionRequest),
}

/// Change of the connection dialog by a command.
#[derive(Debug)]
pub enum ConnectionRequest {
    Open,
    Close,
    /// Closes the dialog if it waits for the connection.
    Connected,
    /// Shows an error message.
    Refuse(String),
    /// Asks whether the certificate of a server is trusted.
    AskTrust(Box<UntrustedServer>),
    /// Fills in the folder of a recording.
    SetFolder(PathBuf),
    /// Fills in a file of the user at the controller.
    SetUserFile(UserFile, PathBuf),
    /// Shows the symbols as the controller describes them.
    ShowChecked(Result<Vec<SymbolCheck>, String>),
    /// Fills in names of symbols.
    UseSymbols(Box<SymbolMapping>),
}

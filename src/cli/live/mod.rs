//! Common parts of the commands that work with a robot: session file, connection, interrupt.

mod connection;
pub mod interrupt;
pub mod typed;

pub use connection::{Connection, link_error};
pub use tautline_workflow::session_file::SessionFile;

use crate::output::note;
use std::path::PathBuf;

use anyhow::Result;
use tautline_session::{Session, read_symbols};

use crate::BadInput;
use tautline_workflow::controllers::ControllerChoice;

/// Arguments that choose a controller and allow it to act.
#[derive(Debug, clap::Args)]
pub struct RobotArguments {
    /// sim (the session's simulated robot), replay:DIR (a recorded dataset), ads:HOST[:PORT]/NETID or opc.tcp://HOST[:PORT]
    #[arg(long, value_name = "CONTROLLER")]
    pub controller: String,
    /// Allow moving the robot and changing its parameters
    #[arg(long)]
    pub arm: bool,
    /// Run a simulated or recorded robot X times faster than real time; by default as fast as it can be computed
    #[arg(long, value_name = "X")]
    pub speed: Option<f64>,
    #[command(flatten)]
    pub symbols: SymbolsArgument,
}

/// Argument for the symbol names of the controller.
#[derive(Debug, clap::Args)]
pub struct SymbolsArgument {
    /// Symbol names of an ads: or opc.tcp: controller, in the format written by `tautline symbols`; stored in the session
    #[arg(long = "symbols", value_name = "FILE.json")]
    file: Option<PathBuf>,
}

impl SymbolsArgument {
    /// Sets the session's symbols from the file, if one was given; returns whether they have changed.
    pub fn take(&self, session: &mut Session, choice: &ControllerChoice) -> Result<bool> {
        let Some(path) = &self.file else {
            return Ok(false);
        };
        let symbols = match choice {
            ControllerChoice::Ads(_) => &mut session.connection.ads,
            ControllerChoice::OpcUa(_) => &mut session.connection.nodes,
            ControllerChoice::Simulated | ControllerChoice::Replay(_) => {
                let message = format!(
                    "--symbols: found the controller {choice}, expected ads:HOST[:PORT]/NETID or opc.tcp://HOST[:PORT]"
                );
                return Err(BadInput::new(message));
            }
        };
        let read = read_symbols(path, &session.robot)?;
        for notice in &read.notices {
            note!("{notice}");
        }
        let new = Some(read.value);
        let differs = *symbols != new;
        *symbols = new;
        Ok(differs)
    }
}

impl RobotArguments {
    /// The requested controller.
    pub fn choice(&self) -> Result<ControllerChoice> {
        if let Some(speed) = self.speed
            && !(speed.is_finite() && speed > 0.0)
        {
            let message = format!("--speed: found {speed}, expected a positive number");
            return Err(BadInput::new(message));
        }
        let choice = self.controller.parse();
        choice.map_err(|error| BadInput::new(format!("--controller: {error}")))
    }

    /// Refuses to act on a robot without `--arm`.
    pub fn require_arm(&self, what: &str) -> Result<()> {
        if self.arm {
            return Ok(());
        }
        let message = format!("{what}: add --arm once nobody is near the robot");
        Err(BadInput::new(message))
    }
}

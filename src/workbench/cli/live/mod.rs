//! What the commands that work with a robot have in common: the session's file, the connection, the interrupt.

mod connection;
mod file;
pub mod interrupt;
pub mod typed;

pub use connection::{Connection, link_error};
pub use file::SessionFile;

use anyhow::Result;

use super::BadInput;
use crate::controllers::ControllerChoice;

/// Which robot, and whether it may move.
#[derive(Debug, clap::Args)]
pub struct RobotArguments {
    /// sim (the session's simulated robot), replay:DIR (a recorded dataset) or ads:HOST[:PORT]/NETID
    #[arg(long, value_name = "CONTROLLER")]
    pub controller: String,
    /// Allow the robot to move and its values to be changed
    #[arg(long)]
    pub arm: bool,
    /// Let the time of a simulated or recorded robot run X times faster than real; by default as fast as it computes
    #[arg(long, value_name = "X")]
    pub speed: Option<f64>,
}

impl RobotArguments {
    /// The controller that is asked for.
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

    /// Refuses to do anything to a robot without leave.
    pub fn require_arm(&self, what: &str) -> Result<()> {
        if self.arm {
            return Ok(());
        }
        let message = format!("{what}: add --arm once nobody is near the robot");
        Err(BadInput::new(message))
    }
}

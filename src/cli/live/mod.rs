//! Common parts of the commands that work with a robot: session file, connection, interrupt.

mod connection;
mod credentials;
pub mod interrupt;
pub mod typed;

pub use connection::{Connection, link_error};
use credentials::PasswordArguments;
pub use tautline_workflow::session_file::SessionFile;

use crate::output::note;
use std::path::{Path, PathBuf};

use anyhow::Result;
use tautline_session::{
    AdsPlace, CertificateFingerprint, Connection as ConnectionSettings, Folders, Session,
};

use crate::{BadInput, standard_input};
use tautline_workflow::controllers::{ControllerChoice, UserKeys};

/// Arguments that choose a controller and allow it to act.
#[derive(Debug, clap::Args)]
pub struct RobotArguments {
    /// sim (the session's simulated robot), replay:DIR (a recorded dataset), ads:HOST[:PORT]/NETID or opc.tcp://HOST[:PORT][?security=..&policy=..&user=NAME], with user-certificate=FILE&user-key=FILE for a user with a certificate
    #[arg(long, value_name = "CONTROLLER", required = true)]
    pub controller: Option<String>,
    /// Allow moving the robot and changing its parameters
    #[arg(long)]
    pub arm: bool,
    /// Run a simulated or recorded robot this many times faster than real time; by default as fast as it can be computed
    #[arg(long, value_name = "TIMES")]
    pub speed: Option<f64>,
    #[command(flatten)]
    pub link: LinkArguments,
}

/// Settings of the link to a real controller.
#[derive(Debug, clap::Args)]
pub struct LinkArguments {
    /// Symbol names of an ads: or opc.tcp: controller, in the format written by `tautline symbols`; - is standard input; stored in the session
    #[arg(long, value_name = "FILE.json")]
    symbols: Option<PathBuf>,
    /// Longest time for an answer of an ads: or opc.tcp: controller (s); stored in the session, at first 1
    #[arg(long, value_name = "SECONDS")]
    timeout: Option<f64>,
    /// Trust the certificate with this SHA-256 fingerprint for the opc.tcp: controller from now on; compare it at the server
    #[arg(long, value_name = "FINGERPRINT")]
    trust_server: Option<String>,
    #[command(flatten)]
    pub passwords: PasswordArguments,
}

impl LinkArguments {
    /// Sets the given values in the session's settings; returns whether they have changed.
    pub fn take(&self, session: &mut Session, choice: &ControllerChoice) -> Result<bool> {
        let before = session.connection.clone();
        if let Some(timeout_s) = self.timeout {
            take_timeout(&mut session.connection, choice, timeout_s)?;
        }
        if let Some(path) = &self.symbols {
            take_symbols(session, choice, path)?;
        }
        if let Some(fingerprint) = &self.trust_server {
            trust(choice, fingerprint)?;
        }
        self.passwords.check(choice)?;
        Ok(session.connection != before)
    }
}

fn no_link(option: &str, choice: &ControllerChoice) -> anyhow::Error {
    BadInput::new(format!(
        "{option}: found the controller {choice}, expected ads:HOST[:PORT]/NETID or opc.tcp://HOST[:PORT]"
    ))
}

fn take_timeout(
    settings: &mut ConnectionSettings,
    choice: &ControllerChoice,
    timeout_s: f64,
) -> Result<()> {
    let checked = match choice {
        ControllerChoice::Ads(address) => {
            let place = settings.place.get_or_insert_with(|| AdsPlace {
                host: address.host.clone(),
                port: address.port,
                net_id: address.net_id,
                ams_port: address.ams_port,
                timeout_s,
            });
            place.timeout_s = timeout_s;
            place.check()
        }
        ControllerChoice::OpcUa(address) => {
            let place = settings
                .opcua
                .get_or_insert_with(|| address.place(timeout_s));
            place.timeout_s = timeout_s;
            place.check()
        }
        ControllerChoice::Simulated | ControllerChoice::Replay(_) => {
            return Err(no_link("--timeout", choice));
        }
    };
    checked.map_err(|error| BadInput::new(format!("--timeout: {}", error.message)))
}

/// Trusts the certificate of the controller's server.
fn trust(choice: &ControllerChoice, fingerprint: &str) -> Result<()> {
    let ControllerChoice::OpcUa(address) = choice else {
        return Err(BadInput::new(format!(
            "--trust-server: found the controller {choice}, expected opc.tcp://HOST[:PORT]"
        )));
    };
    let fingerprint = fingerprint.parse::<CertificateFingerprint>();
    let fingerprint =
        fingerprint.map_err(|error| BadInput::new(format!("--trust-server: {error}")))?;
    let keys = UserKeys::of(Folders::of_user()?);
    keys.trust(&address.origin(), fingerprint)
        .map_err(link_error)
}

fn take_symbols(session: &mut Session, choice: &ControllerChoice, path: &Path) -> Result<()> {
    let symbols = match choice {
        ControllerChoice::Ads(_) => &mut session.connection.ads,
        ControllerChoice::OpcUa(_) => &mut session.connection.nodes,
        ControllerChoice::Simulated | ControllerChoice::Replay(_) => {
            return Err(no_link("--symbols", choice));
        }
    };
    let read = standard_input::symbols(path, &session.robot)?;
    for notice in &read.notices {
        note!("{notice}");
    }
    *symbols = Some(read.value);
    Ok(())
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
        let given = self.controller.as_deref().unwrap_or_default();
        let choice = given.parse();
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

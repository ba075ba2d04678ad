//! The interface of every controller and instrument.

use tautline_core::geometry::Pose;
use tautline_session::CheckPose;

use crate::error::LinkError;
use crate::parameters::ParameterInfo;

/// Activity of a controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Activity {
    /// No connection.
    Disconnected,
    /// Connected, without a report whether it moves.
    Connected,
    /// The platform moves.
    Moving,
    /// The drives have reached the commanded pose. The platform may still swing.
    Still,
    /// It stopped on its own; the text states the reason.
    Fault(String),
}

/// State of a controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControllerState {
    /// Present activity.
    pub activity: Activity,
    /// Whether motion and writing are permitted; ends with the connection.
    pub armed: bool,
}

/// Protection of the messages between this computer and a controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LinkProtection {
    /// Everybody on the network can read and change them.
    Open,
    /// The messages are protected; the text states how.
    Protected(String),
}

/// All readings of one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Time on the controller's clock (s).
    pub time_s: f64,
    /// Motor revolutions since home, per cable, positive pays out.
    pub revolutions: Vec<f64>,
    /// Raw readings of the force sensors (N), per cable; empty without sensors.
    pub force_n: Vec<f64>,
    /// Laser distance (m); `None` without a laser or without a return.
    pub laser_m: Option<f64>,
    /// Temperature (degrees Celsius).
    pub temperature_c: Option<f64>,
    /// Swivel angles of the pulleys (rad), per cable.
    pub swivel_rad: Option<Vec<f64>>,
    /// Roll, pitch and yaw (rad).
    pub inclination_rad: Option<[f64; 3]>,
    /// The last commanded pose; the nominal home pose after homing.
    pub commanded: Option<Pose>,
    /// Value that changes with every start of the controller: a start counter or the time of the last start.
    pub started: Option<f64>,
}

/// A robot's controller. No call waits for the end of a motion.
///
/// Nothing moves and nothing is written unless the controller is armed. Arming lasts for the present connection only.
pub trait Controller: Send {
    /// Name shown to the operator.
    fn identity(&self) -> String;

    /// Protection of the present connection; `None` without one over a network.
    fn protection(&self) -> Option<LinkProtection> {
        None
    }

    /// Connects if not connected. The controller is then disarmed.
    ///
    /// # Errors
    /// If the connection fails.
    fn connect(&mut self) -> Result<(), LinkError>;

    /// Disarms and ends the connection.
    fn disconnect(&mut self);

    /// State as last known.
    fn state(&self) -> ControllerState;

    /// Permits motion and writing.
    ///
    /// # Errors
    /// If there is no connection or a fault; [`LinkError::Occupied`] if another program is armed, or one that was killed still
    /// appears to be.
    fn arm(&mut self) -> Result<(), LinkError>;

    /// Checks that no other program is armed since [`Controller::arm`]. By default nothing, for controllers that have only
    /// one client.
    ///
    /// # Errors
    /// [`LinkError::Occupied`] if there is one, or the connection is lost.
    fn confirm_alone(&mut self) -> Result<(), LinkError> {
        Ok(())
    }

    /// Forbids motion and writing; a motion in progress is stopped.
    fn disarm(&mut self);

    /// The latest readings.
    ///
    /// # Errors
    /// If the connection is lost or the controller does not answer.
    fn sample(&mut self) -> Result<Sample, LinkError>;

    /// Asks the controller to send its readings every `every_s` seconds until the connection ends. They are for display only:
    /// readings on which decisions depend come from [`Controller::sample`].
    ///
    /// # Errors
    /// If it cannot send readings, or the connection is lost.
    fn subscribe(&mut self, _every_s: f64) -> Result<(), LinkError> {
        let text = "it does not send readings on its own";
        Err(LinkError::Refused(text.to_owned()))
    }

    /// The readings sent since the last call, the oldest first. Does not wait.
    ///
    /// # Errors
    /// If the connection is lost.
    fn sent(&mut self) -> Result<Vec<Sample>, LinkError> {
        Ok(Vec::new())
    }

    /// Starts a motion to the home reference platform, where the encoders are zeroed.
    ///
    /// # Errors
    /// If not armed, the connection is lost, or the controller refuses.
    fn home(&mut self) -> Result<(), LinkError>;

    /// Starts a motion to a pose.
    ///
    /// # Errors
    /// If not armed, the connection is lost, or the controller refuses the pose.
    fn command(&mut self, pose: &Pose) -> Result<(), LinkError>;

    /// Stops the platform where it is. Always allowed.
    ///
    /// # Errors
    /// If the connection is lost.
    fn stop(&mut self) -> Result<(), LinkError>;

    /// All readable and writable parameters with their values. Their names are those of
    /// [`crate::parameters`].
    ///
    /// # Errors
    /// If the connection is lost.
    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError>;

    /// Values of the named parameters.
    ///
    /// # Errors
    /// If the connection is lost or there is no such parameter.
    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError>;

    /// Sets parameters in the given order; after an error, those before it may have been set.
    ///
    /// # Errors
    /// If not armed, moving, the connection is lost, there is no such parameter, or the value is not possible.
    fn write(&mut self, values: &[(String, f64)]) -> Result<(), LinkError>;

    /// Accepts an overloaded cable by decision of the operator; the overload must not increase. By default nothing, for
    /// controllers without limits of Tautline.
    fn accept_overload(&mut self) {}

    /// Reason why there is no laser distance at present, if known.
    fn laser_problem(&self) -> Option<String> {
        None
    }
}

/// An external instrument that measures the pose of the platform, in the base frame.
pub trait Instrument: Send {
    /// Name shown to the operator.
    fn identity(&self) -> String;

    /// Pose of the platform, with its orientation if the instrument measures it.
    ///
    /// # Errors
    /// If it does not see the platform or does not answer.
    fn measure(&mut self) -> Result<CheckPose, LinkError>;
}

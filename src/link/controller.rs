//! The interface of every controller and instrument.

use tautline_core::geometry::Pose;
use tautline_session::CheckPose;

use crate::error::LinkError;
use crate::parameters::ParameterInfo;

/// What a controller is doing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Activity {
    /// No connection.
    Disconnected,
    /// Connected; it does not report whether it moves.
    Connected,
    /// The platform moves.
    Moving,
    /// The drives have reached the commanded pose. The platform may still swing.
    Still,
    /// It stopped on its own; the text says why.
    Fault(String),
}

/// State of a controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControllerState {
    /// What it is doing.
    pub activity: Activity,
    /// Whether it may move and change values, until the connection ends.
    pub armed: bool,
}

/// All readings of one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Time by the controller's clock (s).
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
    /// The pose that was commanded last; the nominal home pose after homing.
    pub commanded: Option<Pose>,
    /// What changes with every start of the controller: a number of starts or the time of the last one.
    pub started: Option<f64>,
}

/// A robot's controller. No call waits for a motion to end.
///
/// Nothing moves and nothing is written unless the controller is armed. Arming holds for the present connection only.
pub trait Controller: Send {
    /// Name shown to the operator.
    fn identity(&self) -> String;

    /// Connects, unless it is connected. The controller is disarmed after that.
    ///
    /// # Errors
    /// If the controller cannot be connected.
    fn connect(&mut self) -> Result<(), LinkError>;

    /// Disarms and ends the connection.
    fn disconnect(&mut self);

    /// State as last known.
    fn state(&self) -> ControllerState;

    /// Allows motion and writing.
    ///
    /// # Errors
    /// If there is no connection or a fault.
    fn arm(&mut self) -> Result<(), LinkError>;

    /// Forbids motion and writing; a motion under way is stopped.
    fn disarm(&mut self);

    /// The latest readings.
    ///
    /// # Errors
    /// If the connection is lost or the controller does not answer.
    fn sample(&mut self) -> Result<Sample, LinkError>;

    /// Asks the controller to send its readings every so many seconds, until the connection ends. They are for display:
    /// whatever decides is read by [`Controller::sample`].
    ///
    /// # Errors
    /// If it cannot do that or the connection is lost.
    fn subscribe(&mut self, _every_s: f64) -> Result<(), LinkError> {
        let text = "it sends nothing of its own accord";
        Err(LinkError::Refused(text.to_owned()))
    }

    /// The readings that it has sent since this was last asked, the oldest first. Does not wait.
    ///
    /// # Errors
    /// If the connection is lost.
    fn sent(&mut self) -> Result<Vec<Sample>, LinkError> {
        Ok(Vec::new())
    }

    /// Starts to move to the home reference platform, where the encoders are zeroed.
    ///
    /// # Errors
    /// If not armed, the connection is lost or the controller refuses.
    fn home(&mut self) -> Result<(), LinkError>;

    /// Starts to move to a pose.
    ///
    /// # Errors
    /// If not armed, the connection is lost or the controller refuses the pose.
    fn command(&mut self, pose: &Pose) -> Result<(), LinkError>;

    /// Stops the platform where it is. Always allowed.
    ///
    /// # Errors
    /// If the connection is lost.
    fn stop(&mut self) -> Result<(), LinkError>;

    /// All parameters that can be read and written, with their values. Their names are those of
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

    /// Sets parameters, in the given order; after an error those before it may have been set.
    ///
    /// # Errors
    /// If not armed, moving, the connection is lost, there is no such parameter or it cannot have the value.
    fn write(&mut self, values: &[(String, f64)]) -> Result<(), LinkError>;

    /// The operator has decided to go on although a cable is overloaded; it may not get worse. By default nothing, for
    /// controllers without limits of our own.
    fn accept_overload(&mut self) {}

    /// Why there is no laser distance at present, where the reason is known.
    fn laser_problem(&self) -> Option<String> {
        None
    }
}

/// An external instrument that measures where the platform is, in the base frame.
pub trait Instrument: Send {
    /// Name shown to the operator.
    fn identity(&self) -> String;

    /// Pose of the platform, its orientation where the instrument measures it.
    ///
    /// # Errors
    /// If it does not see the platform or does not answer.
    fn measure(&mut self) -> Result<CheckPose, LinkError>;
}

//! What every controller can do, whatever it is connected by.

use tautline_core::geometry::Pose;
use tautline_session::CheckPose;

use crate::parameters::ParameterInfo;

/// Why a controller did not do or tell what was asked: one sentence for the operator.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// There is no connection, or it broke.
    #[error("the connection to the controller is lost: {0}")]
    Disconnected(String),
    /// No answer in time.
    #[error("the controller did not answer within {0:.1} s")]
    Timeout(f64),
    /// Arming is missing.
    #[error("the controller is not armed: arm it before it may move or change values")]
    NotArmed,
    /// The controller is not able to at present.
    #[error("the controller refused: {0}")]
    Refused(String),
    /// The controller reports a fault.
    #[error("the controller reports a fault: {0}")]
    Fault(String),
    /// A pose or tension outside the limits.
    #[error("outside the limits: {0}")]
    Limit(String),
    /// No parameter of this name.
    #[error("the controller has no parameter \"{0}\"")]
    UnknownParameter(String),
    /// A value that no parameter can have.
    #[error("parameter \"{name}\" cannot be {value}: {reason}")]
    InvalidValue {
        /// Name of the parameter.
        name: String,
        /// The value.
        value: f64,
        /// Why not.
        reason: String,
    },
    /// A laser distance sensor of its own cannot be used.
    #[error("the laser distance sensor: {0}")]
    Laser(String),
    /// A controller or run cannot be set up.
    #[error("{0}")]
    Setup(String),
}

impl LinkError {
    /// Whether the connection has to be made anew.
    #[must_use]
    pub fn is_disconnection(&self) -> bool {
        matches!(self, Self::Disconnected(_))
    }
}

/// What a controller is doing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Activity {
    /// No connection.
    Disconnected,
    /// Connected; it does not tell whether it moves.
    Connected,
    /// The platform is on its way.
    Moving,
    /// The drives have reached what was commanded. The platform may still swing.
    Still,
    /// It stopped by itself; the text says why.
    Fault(String),
}

/// State of a controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControllerState {
    /// What it is doing.
    pub activity: Activity,
    /// Whether it may move and change values; ends with the connection.
    pub armed: bool,
}

/// Everything a controller reads at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Time by the controller's clock (s).
    pub time_s: f64,
    /// Motor revolutions since home, per cable, positive pays out.
    pub revolutions: Vec<f64>,
    /// Raw readings of the force sensors (N), per cable; empty without sensors.
    pub force_n: Vec<f64>,
    /// Laser distance (m); `None` without a laser or where it has no return.
    pub laser_m: Option<f64>,
    /// Temperature (degrees Celsius).
    pub temperature_c: Option<f64>,
    /// Swivel angles of the pulleys (rad), per cable.
    pub swivel_rad: Option<Vec<f64>>,
    /// Roll, pitch and yaw (rad).
    pub inclination_rad: Option<[f64; 3]>,
    /// The pose that was commanded last; the nominal home pose after homing.
    pub commanded: Option<Pose>,
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
    /// If there is no connection to be had.
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

    /// Starts the way to the home reference platform, where the encoders are zeroed.
    ///
    /// # Errors
    /// If not armed, the connection is lost or the controller refuses.
    fn home(&mut self) -> Result<(), LinkError>;

    /// Starts the way to a pose.
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

    /// Why there is no laser distance at present, where more is known than that there is none.
    fn laser_trouble(&self) -> Option<String> {
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

impl<C: Controller + ?Sized> Controller for Box<C> {
    fn identity(&self) -> String {
        (**self).identity()
    }
    fn connect(&mut self) -> Result<(), LinkError> {
        (**self).connect()
    }
    fn disconnect(&mut self) {
        (**self).disconnect();
    }
    fn state(&self) -> ControllerState {
        (**self).state()
    }
    fn arm(&mut self) -> Result<(), LinkError> {
        (**self).arm()
    }
    fn disarm(&mut self) {
        (**self).disarm();
    }
    fn sample(&mut self) -> Result<Sample, LinkError> {
        (**self).sample()
    }
    fn home(&mut self) -> Result<(), LinkError> {
        (**self).home()
    }
    fn command(&mut self, pose: &Pose) -> Result<(), LinkError> {
        (**self).command(pose)
    }
    fn stop(&mut self) -> Result<(), LinkError> {
        (**self).stop()
    }
    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError> {
        (**self).parameters()
    }
    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError> {
        (**self).read(names)
    }
    fn write(&mut self, values: &[(String, f64)]) -> Result<(), LinkError> {
        (**self).write(values)
    }
    fn laser_trouble(&self) -> Option<String> {
        (**self).laser_trouble()
    }
}

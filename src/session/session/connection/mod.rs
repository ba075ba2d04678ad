//! Settings of the connection to the robot's controller: its kind, its address, and the symbols that are read and written.

mod check;
mod defaults;
mod place;
#[cfg(test)]
mod tests;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(super) use check::check;
pub use place::{
    AdsPlace, ControllerKind, OpcUaPlace, OpcUaPolicy, OpcUaSecurity, RecordingPlace,
    UserCertificateFiles, without_user,
};

/// Settings of the connection to the robot's controller.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Connection {
    /// Kind of controller.
    #[serde(skip_serializing_if = "ControllerKind::is_simulated")]
    pub controller: ControllerKind,
    /// The recording to play back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recording: Option<RecordingPlace>,
    /// Address of the ADS controller.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<AdsPlace>,
    /// Symbols of the ADS controller; absent: the default names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ads: Option<SymbolMapping>,
    /// Address of the OPC UA controller.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opcua: Option<OpcUaPlace>,
    /// Nodes of the OPC UA controller; absent: the default names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<SymbolMapping>,
}

impl Connection {
    /// Whether all settings are the defaults.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Symbols of a controller: names for ADS, node identifiers for OPC UA.
///
/// A reading is `raw * scale + offset`, in SI units; written values are converted by the inverse. Names of
/// one symbol per cable may contain `{cable}`, the cable's name, and `{n}`, its number from 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SymbolMapping {
    /// Symbols read at every sample.
    pub readings: SymbolReadings,
    /// Symbols of the controller's state.
    #[serde(default)]
    pub state: SymbolStatus,
    /// Symbols of commands; absent: the controller is only read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<SymbolCommand>,
    /// BOOL that is TRUE while the operator permits motion and writing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub release: Option<String>,
    /// Integer that counts the samples while armed, so that the controller can stop if they end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub watchdog: Option<String>,
    /// Parameters of the controller's kinematics that can be read and written.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<SymbolParameter>,
}

/// Symbols that are read at every sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SymbolReadings {
    /// Motor revolutions since home, positive pays out, per cable.
    pub revolutions: SymbolList,
    /// Raw readings of the force sensors (N), per cable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<SymbolList>,
    /// Swivel angles of the pulleys (rad), per cable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub swivel: Option<SymbolList>,
    /// Laser distance (m); NaN without a return.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laser: Option<SymbolValue>,
    /// BOOL that is TRUE while the laser has a return.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laser_valid: Option<String>,
    /// Temperature (degrees Celsius).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<SymbolValue>,
    /// Time on the controller's clock (s); absent: time of arrival of the response.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<SymbolValue>,
    /// Roll, pitch and yaw of the platform (rad): three values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inclination: Option<SymbolList>,
    /// The last commanded pose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose: Option<SymbolPose>,
}

/// Name of an array symbol, or one name per value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a name or a list of names")]
pub enum SymbolNames {
    /// An array; with `{cable}` or `{n}` one symbol per cable.
    One(String),
    /// One symbol per value.
    Each(Vec<String>),
}

/// Symbols of several values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SymbolList {
    /// Their names.
    pub symbol: SymbolNames,
    /// SI units per unit of the symbol.
    #[serde(default = "one")]
    pub scale: f64,
    /// Offset added after scaling (SI).
    #[serde(default)]
    pub offset: f64,
}

/// Symbol of one value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SymbolValue {
    /// Its name.
    pub symbol: String,
    /// SI units per unit of the symbol.
    #[serde(default = "one")]
    pub scale: f64,
    /// Offset added after scaling (SI).
    #[serde(default)]
    pub offset: f64,
}

/// Representation of an orientation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SymbolRotation {
    /// Four numbers w, x, y, z without unit.
    #[default]
    Quaternion,
    /// Axis times angle.
    RotationVector,
    /// `R = Rx(roll) Ry(pitch) Rz(yaw)`.
    RollPitchYaw,
}

impl SymbolRotation {
    /// Number of values of a pose: three for the position, the rest for the orientation.
    #[must_use]
    pub fn pose_values(self) -> usize {
        match self {
            Self::Quaternion => 7,
            Self::RotationVector | Self::RollPitchYaw => 6,
        }
    }
}

/// Symbols of a pose: position x, y, z, then its orientation, of the platform in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SymbolPose {
    /// An array, or one name per value.
    pub symbol: SymbolNames,
    /// Representation of the orientation.
    #[serde(default)]
    pub rotation: SymbolRotation,
    /// Metres per unit of the position.
    #[serde(default = "one")]
    pub length_scale: f64,
    /// Radians per unit of the angles.
    #[serde(default = "one")]
    pub angle_scale: f64,
}

/// Symbols of the state of the controller.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct SymbolStatus {
    /// BOOL that is TRUE from the acknowledgement of a command until the drives have completed it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moving: Option<String>,
    /// Integer or BOOL; 0 or FALSE: no fault.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
    /// STRING that describes the fault.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault_text: Option<String>,
    /// Number that changes with every start of the controller: its start time or a start counter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub started: Option<String>,
}

/// Symbols of a command to the controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SymbolCommand {
    /// Target pose.
    pub target: SymbolPose,
    /// Integer; 1: home, 2: move to the target, 3: stop.
    pub kind: String,
    /// UDINT; written last, a new number is a new command.
    pub number: String,
    /// UDINT; the controller copies the number to it to acknowledge the command.
    pub acknowledged: String,
}

/// Symbol of a parameter, or of the same parameter of every cable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SymbolParameter {
    /// Name of the parameter; with `{cable}` one name per cable.
    pub name: String,
    /// Name of the symbol. Without `{cable}` and `{n}` it is an array with the values of all cables.
    pub symbol: String,
    /// Index of the array element, from 0; that of the first cable in an array with the values of all cables.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub element: u32,
    /// Index difference between consecutive cables.
    #[serde(default = "one_element", skip_serializing_if = "is_one")]
    pub stride: u32,
    /// SI units per unit of the symbol.
    #[serde(default = "one")]
    pub scale: f64,
}

fn one() -> f64 {
    1.0
}

fn one_element() -> u32 {
    1
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference"
)]
fn is_zero(number: &u32) -> bool {
    *number == 0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference"
)]
fn is_one(number: &u32) -> bool {
    *number == 1
}

/// Whether a name is a pattern for one symbol or parameter per cable.
#[must_use]
pub fn is_per_cable(name: &str) -> bool {
    name.contains(CABLE) || name.contains(NUMBER)
}

/// The name for one cable, by its index from 0.
#[must_use]
pub fn name_of_cable(pattern: &str, cable: &str, index: usize) -> String {
    // The number is replaced first, because a cable's name may contain anything.
    let numbered = pattern.replace(NUMBER, &(index + 1).to_string());
    numbered.replace(CABLE, cable)
}

const CABLE: &str = "{cable}";
const NUMBER: &str = "{n}";

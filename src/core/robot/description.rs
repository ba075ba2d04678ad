//! Plain data of a robot; field names and units are those of `robot.json` (a public format).

use nalgebra::{Matrix3, Matrix6};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Limits, PartTolerances};
use crate::cable::ElongationSurface;
use crate::effect::EffectSetting;
use crate::geometry::{Coordinate, Freedom, Pose, Vec3};

/// One standard deviation for all three axes, or one for each. With `PerAxis<Option<f64>>`, `None` (written to
/// files as `null`) means unknown.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a number or three numbers")]
pub enum PerAxis<T = f64> {
    /// The same on all axes.
    Same(T),
    /// One per axis x, y, z.
    Each([T; 3]),
}

impl<T: Copy> PerAxis<T> {
    /// The values of the axes x, y, z.
    #[must_use]
    pub fn each(self) -> [T; 3] {
        match self {
            Self::Same(value) => [value; 3],
            Self::Each(values) => values,
        }
    }
}

impl PerAxis<Option<f64>> {
    /// The same standard deviation on all axes.
    #[must_use]
    pub fn known(sd: f64) -> Self {
        Self::Same(Some(sd))
    }
}

impl Default for PerAxis<Option<f64>> {
    /// Unknown on all axes.
    fn default() -> Self {
        Self::Same(None)
    }
}

/// A cable robot: platform, cables with pulleys and winches, and its instruments.
///
/// With a non-empty list of effects it is a *model*: the description plus the effects by which the real robot was found to
/// deviate from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Robot {
    /// Name of the robot.
    pub name: String,
    /// Serial number of the machine: robots of one type share a name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub serial_number: Option<String>,
    /// Home pose, at which the encoders read zero; `None` if length readings are absolute.
    #[serde(default)]
    pub home: Option<Home>,
    /// Gravity in the base frame (m/s^2).
    #[serde(default = "standard_gravity")]
    pub gravity_m_s2: [f64; 3],
    /// The moving platform.
    pub platform: Platform,
    /// Workspace and tension limits; defaults follow from the rest of the description.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<Limits>,
    /// Laser distance sensor on the platform.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laser: Option<Laser>,
    /// Inclinometer or attitude sensor on the platform.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inclinometer: Option<Inclinometer>,
    /// External instrument that measures the platform pose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tracker: Option<Tracker>,
    /// The cables, in the order of the numbered columns of the measurements.
    #[schemars(length(min = 1, max = 64))]
    pub cables: Vec<Cable>,
    /// Home reference platform of phase 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub home_platform: Option<HomePlatform>,
    /// Texts of hypothesis files of the user: effects that this robot knows besides those of the catalogue.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hypotheses: Vec<String>,
    /// Physical effects that extend the nominal model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<EffectSetting>,
    /// Tolerances of the parts; absent: not stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerances: Option<PartTolerances>,
    /// Deviations of parts within their tolerances, in the form of effects: of a virtual robot the true ones, of a model
    /// the estimated ones.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub deviations: Vec<EffectSetting>,
}

/// Standard gravity (m/s^2).
pub const STANDARD_GRAVITY_M_S2: f64 = 9.80665;

/// Standard gravity along -z of the base frame.
fn standard_gravity() -> [f64; 3] {
    [0.0, 0.0, -STANDARD_GRAVITY_M_S2]
}

/// Home pose and its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Home {
    /// Platform origin in the base frame (m).
    pub position_m: [f64; 3],
    /// Platform orientation in the base frame, quaternion w first.
    pub orientation_wxyz: [f64; 4],
    /// Standard deviation of each position coordinate (m); 0: known exactly.
    pub position_sd_m: f64,
    /// Standard deviation of each component of the rotation vector (rad); 0: known exactly.
    pub orientation_sd_rad: f64,
    /// Covariance of the pose `[x y z, phi_x phi_y phi_z]` in the base frame (m, rad), if it was measured; the standard
    /// deviations above are then those of its worst coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub covariance: Option<[[f64; 6]; 6]>,
}

impl Home {
    /// Another pose that is known as well.
    #[must_use]
    pub fn at(self, pose: &Pose) -> Self {
        Self {
            position_m: pose.position.into(),
            orientation_wxyz: pose.orientation_wxyz(),
            ..self
        }
    }

    /// Covariance of the pose as a [`Twist`](crate::geometry::Twist) in the base frame (m, rad): the measured one, else
    /// that of the standard deviations.
    #[must_use]
    pub fn covariance(&self) -> Matrix6<f64> {
        let sd = [self.position_sd_m, self.orientation_sd_rad];
        match self.covariance {
            Some(rows) => Matrix6::from_fn(|i, k| rows[i][k]),
            None => Matrix6::from_fn(|i, k| if i == k { sd[i / 3].powi(2) } else { 0.0 }),
        }
    }

    /// The home pose as a rigid pose.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose::from_parts(self.position_m, self.orientation_wxyz)
    }
}

/// The moving platform.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Platform {
    /// Coordinates in which the platform can move.
    pub free: Vec<Coordinate>,
    /// Mass (kg); absent: static equilibrium is not modelled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
    /// Centre of mass in the platform frame (m).
    #[serde(default)]
    pub center_of_mass_m: [f64; 3],
    /// Inertia about the centre of mass in the platform frame, `[xx yy zz xy xz yz]` (kg m^2); absent: zero, as of a point mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_kg_m2: Option<[f64; 6]>,
    /// Standard deviation of the static equilibrium; absent: 1e-4 of the weight, and that times 0.1 m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrench_sd: Option<WrenchSd>,
}

/// The inertia `[xx yy zz xy xz yz]` as a matrix (kg m^2).
pub(super) fn inertia_matrix([xx, yy, zz, xy, xz, yz]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, *zz)
}

impl Platform {
    /// A platform that moves freely in space, with its centre of mass at its origin and the inertia of a point.
    #[must_use]
    pub fn spatial(mass_kg: Option<f64>) -> Self {
        Self {
            free: Coordinate::ALL.to_vec(),
            mass_kg,
            center_of_mass_m: [0.0; 3],
            inertia_kg_m2: None,
            wrench_sd: None,
        }
    }

    /// Whether any rotation of the platform is free.
    #[must_use]
    pub fn turns(&self) -> bool {
        self.free.iter().any(|coordinate| coordinate.index() >= 3)
    }

    /// Inertia about the centre of mass in the platform frame (kg m^2); zero if it is not given.
    #[must_use]
    pub fn inertia(&self) -> Matrix3<f64> {
        self.inertia_kg_m2
            .as_ref()
            .map_or_else(Matrix3::zeros, inertia_matrix)
    }

    /// The free coordinates as a set.
    #[must_use]
    pub fn freedom(&self) -> Freedom {
        Freedom::new(&self.free)
    }
}

/// Standard deviation of the static equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WrenchSd {
    /// Standard deviation of each force component (N).
    pub force_n: f64,
    /// Standard deviation of each torque component (N m).
    pub torque_nm: f64,
}

/// Laser distance sensor on the platform, looking at a plane fixed in the base frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Laser {
    /// Origin of the beam in the platform frame (m).
    pub origin_m: [f64; 3],
    /// Direction of the beam in the platform frame (unit vector).
    pub direction: [f64; 3],
    /// Standard deviation of a reading (m).
    pub sd_m: f64,
    /// The reflector plane.
    pub target_plane: TargetPlane,
}

/// Plane `normal . x = offset` in the base frame whose offset is known only roughly.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TargetPlane {
    /// Unit normal in the base frame.
    pub normal: [f64; 3],
    /// Offset along the normal (m).
    pub offset_m: f64,
    /// Standard deviation of the offset (m); 0: known exactly, absent or null: unknown.
    #[serde(default)]
    pub offset_sd_m: Option<f64>,
}

/// Inclinometer or attitude sensor: `R = Rx(roll) Ry(pitch) Rz(yaw)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Inclinometer {
    /// Standard deviation of each angle (rad).
    pub sd_rad: f64,
}

/// External instrument that measures the platform pose in the base frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Tracker {
    /// Standard deviation of the position (m).
    pub position_sd_m: PerAxis,
    /// Standard deviation of each component of the rotation vector (rad), where orientation is
    /// measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orientation_sd_rad: Option<f64>,
}

/// One cable from winch to platform.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cable {
    /// Name used in reports.
    pub name: String,
    /// The pulley that guides it into the workspace.
    pub pulley: Pulley,
    /// Attachment point in the platform frame (m).
    pub platform_anchor_m: [f64; 3],
    /// The winch that drives it.
    pub winch: Winch,
    /// The cable itself.
    #[serde(default)]
    pub cable: CableMaterial,
    /// Sensor of the cable tension.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_sensor: Option<ForceSensor>,
}

/// A pulley that swivels about the incoming cable to face the platform.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Pulley {
    /// Point on the swivel axis where the cable reaches the pulley, in the base frame (m).
    pub entry_point_m: [f64; 3],
    /// Standard deviation of the entry point (m): one or three numbers; 0: known exactly, absent or null: unknown
    /// (also for one of three coordinates).
    #[serde(default)]
    pub entry_point_sd_m: PerAxis<Option<f64>>,
    /// Direction in which the cable travels when it reaches the pulley (unit vector, base frame).
    pub swivel_axis: [f64; 3],
    /// Direction of swivel angle zero (base frame), needed only for swivel readings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub swivel_zero: Option<[f64; 3]>,
    /// Standard deviation of a swivel reading (rad).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub swivel_sd_rad: Option<f64>,
    /// Radius at the cable's centre line (m); 0: an eyelet.
    pub radius_m: f64,
}

impl Pulley {
    /// A pulley that swivels about an axis, without a sensor of the swivel angle. Its entry point has no stated standard
    /// deviation.
    #[must_use]
    pub fn new(entry_point_m: [f64; 3], swivel_axis: [f64; 3], radius_m: f64) -> Self {
        Self {
            entry_point_m,
            entry_point_sd_m: PerAxis::default(),
            swivel_axis,
            swivel_zero: None,
            swivel_sd_rad: None,
            radius_m,
        }
    }

    /// Typical standard deviation of a coordinate of an entry point that is known from the drawing of a frame of this size (m).
    #[must_use]
    pub fn typical_sd_m(frame_m: f64) -> f64 {
        5e-3 + 7e-4 * frame_m
    }
}

/// Motor, gear and drum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Winch {
    /// Drum diameter at the cable's centre line (m).
    pub drum_diameter_m: f64,
    /// Axial travel of the cable per drum revolution (m).
    #[serde(default)]
    pub drum_pitch_m: f64,
    /// Motor revolutions per drum revolution (reeving included).
    #[serde(default = "one")]
    pub gear_ratio: f64,
    /// Cable between drum and pulley entry point (m).
    #[serde(default)]
    pub length_to_pulley_m: f64,
    /// Standard deviation of a length reading (m).
    pub length_sd_m: f64,
}

fn one() -> f64 {
    1.0
}

/// Elasticity and weight of a cable.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CableMaterial {
    /// Axial stiffness EA (N); absent: inelastic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axial_stiffness_n: Option<f64>,
    /// Weight per metre (N/m), for sag.
    #[serde(default)]
    pub weight_n_per_m: f64,
    /// Measured elongation, used instead of the axial stiffness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elongation_surface: Option<ElongationSurface>,
}

/// Tension sensor: reading = gain * tension + bias.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ForceSensor {
    /// Gain, reading per tension; 2 with the deflection pulley of Jin et al., section 3.2.
    pub tension_gain: f64,
    /// Reading at zero tension (N).
    #[serde(default)]
    pub bias_n: f64,
    /// Standard deviation of the tension (not of the reading) (N).
    pub tension_sd_n: f64,
}

impl ForceSensor {
    /// A sensor that reads tensions.
    pub(crate) const OF_TENSION: Self = Self {
        tension_gain: 1.0,
        bias_n: 0.0,
        tension_sd_n: 1.0,
    };

    /// Tension (N) from a raw reading (N).
    #[must_use]
    pub fn tension_n(&self, reading_n: f64) -> f64 {
        (reading_n - self.bias_n) / self.tension_gain
    }

    /// Raw reading (N) at a tension (N).
    #[must_use]
    pub fn reading_n(&self, tension_n: f64) -> f64 {
        self.tension_gain * tension_n + self.bias_n
    }
}

/// Home reference platform: six infrared distance sensors look at three planes of the platform.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomePlatform {
    /// Pose of the reference frame in the base frame.
    pub base_from_reference: FrameTransform,
    /// The six sensors, fixed in the reference frame.
    pub sensors: Vec<HomeSensor>,
    /// The three planes, fixed in the platform frame.
    pub planes: Vec<Plane>,
}

/// A rigid transform as plain numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrameTransform {
    /// Translation (m).
    pub position_m: [f64; 3],
    /// Rotation, quaternion w first.
    pub orientation_wxyz: [f64; 4],
}

impl FrameTransform {
    /// As a rigid pose.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose::from_parts(self.position_m, self.orientation_wxyz)
    }
}

/// One infrared distance sensor of the home reference platform.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomeSensor {
    /// Origin in the reference frame (m).
    pub origin_m: [f64; 3],
    /// Viewing direction in the reference frame (unit vector).
    pub direction: [f64; 3],
    /// Index of the plane that it measures: 0, 1 or 2.
    pub plane: usize,
    /// Standard deviation of a distance (m).
    pub sd_m: f64,
    /// Voltage curve; absent: readings are metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<DistanceCurve>,
}

/// Distance from voltage: `d = 1 / (a v + b) + c` (m, V).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DistanceCurve {
    /// Slope (1/(m V)).
    pub a: f64,
    /// Intercept (1/m).
    pub b: f64,
    /// Offset (m).
    pub c: f64,
}

/// Plane `normal . x = offset` in the frame it is fixed to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Plane {
    /// Unit normal.
    pub normal: [f64; 3],
    /// Offset along the normal (m).
    pub offset_m: f64,
}

impl Winch {
    /// Cable per motor revolution (m): `sqrt((pi d)^2 + p^2) / gear_ratio`
    /// (Jin et al. 2018, equation 1, with the angle in revolutions of the drum).
    #[must_use]
    pub fn cable_per_revolution_m(&self) -> f64 {
        (std::f64::consts::PI * self.drum_diameter_m).hypot(self.drum_pitch_m) / self.gear_ratio
    }

    /// Standard deviation of a reading of motor revolutions.
    #[must_use]
    pub fn revolutions_sd(&self) -> f64 {
        (self.length_sd_m / self.cable_per_revolution_m()).abs()
    }
}

impl Robot {
    /// A robot in standard gravity along -z that has nothing but a platform and cables: no home pose, no instruments besides
    /// those of the cables, no limits, no tolerances, no effects.
    #[must_use]
    pub fn new(name: impl Into<String>, platform: Platform, cables: Vec<Cable>) -> Self {
        Self {
            name: name.into(),
            serial_number: None,
            home: None,
            gravity_m_s2: standard_gravity(),
            platform,
            limits: None,
            laser: None,
            inclinometer: None,
            tracker: None,
            cables,
            home_platform: None,
            tolerances: None,
            hypotheses: Vec::new(),
            deviations: Vec::new(),
            effects: Vec::new(),
        }
    }

    /// Label that tells the machine from others: its name, with the serial number if it has one.
    #[must_use]
    pub fn label(&self) -> String {
        match &self.serial_number {
            Some(number) => format!("{} ({number})", self.name),
            None => self.name.clone(),
        }
    }

    /// Everything by which the model deviates from the description: the effects, then the deviations of parts.
    pub fn effects_and_deviations(&self) -> impl Iterator<Item = &EffectSetting> {
        self.effects.iter().chain(&self.deviations)
    }

    /// Number of cables.
    #[must_use]
    pub fn cable_count(&self) -> usize {
        self.cables.len()
    }

    /// Index of the cable called `name`.
    #[must_use]
    pub fn cable_index(&self, name: &str) -> Option<usize> {
        self.cables.iter().position(|cable| cable.name == name)
    }

    /// Gravity in the base frame (m/s^2).
    #[must_use]
    pub fn gravity(&self) -> Vec3 {
        self.gravity_m_s2.into()
    }

    /// Whether every cable has a force sensor.
    #[must_use]
    pub fn has_force_sensors(&self) -> bool {
        self.cables.iter().all(|cable| cable.force_sensor.is_some())
    }

    /// Standard deviation of the static equilibrium, as stated or by default: 1e-4 of the
    /// weight, and that times 0.1 m. `None` if the mass is not given.
    #[must_use]
    pub fn wrench_sd(&self) -> Option<WrenchSd> {
        let weight_n = self.platform.mass_kg? * self.gravity().norm();
        Some(self.platform.wrench_sd.unwrap_or(WrenchSd {
            force_n: 1e-4 * weight_n,
            torque_nm: 1e-5 * weight_n,
        }))
    }
}

//! Content of robot descriptions, and default assumptions for missing values.

use nalgebra::{Rotation3, UnitQuaternion};
use tautline_core::geometry::{Coordinate, Pose, Vec3};
use tautline_core::robot::{
    Cable, CableMaterial, Home, Limits, PartTolerances, PerAxis, Platform, Pulley, Robot, Winch,
};
use tautline_files::{Location, ReadError};
use tautline_session::{Loaded, VersionedFile};

use super::dialect::ForeignRobot;
use super::settings::Settings;

/// Default standard deviation of a length reading (m), typical of good winches.
const LENGTH_SD_M: f64 = 1e-3;
/// Default standard deviation of a coordinate of the home pose (m), typical of a mark on the floor.
pub(super) const POSITION_SD_M: f64 = 1e-3;
/// Default standard deviation of a rotation of the home pose (rad).
pub(super) const ROTATION_SD_RAD: f64 = 1e-3;

/// Geometry of a pulley: the entry point, which stays when the pulley swivels (m, robot frame), the axis about which it
/// swivels, a unit vector in the direction in which the cable arrives, and the radius (m), 0 for an eyelet.
pub(super) struct Guide {
    pub(super) entry_point_m: [f64; 3],
    pub(super) swivel_axis: [f64; 3],
    pub(super) radius_m: f64,
}

impl Guide {
    /// A fixed point, from which the cable leaves in any direction.
    pub(super) fn eyelet(point_m: [f64; 3]) -> Self {
        Self {
            entry_point_m: point_m,
            swivel_axis: [0.0, 0.0, 1.0],
            radius_m: 0.0,
        }
    }
}

/// A cable with known geometry and the default winch and noise that [`robot_of`] reports.
pub(super) fn cable_of(
    name: Option<String>,
    number: usize,
    guide: Guide,
    platform_anchor_m: [f64; 3],
) -> Cable {
    Cable {
        name: name.unwrap_or_else(|| format!("cable-{number}")),
        pulley: Pulley::new(guide.entry_point_m, guide.swivel_axis, guide.radius_m),
        platform_anchor_m,
        winch: Winch {
            drum_diameter_m: std::f64::consts::FRAC_1_PI,
            drum_pitch_m: 0.0,
            gear_ratio: 1.0,
            length_to_pulley_m: 0.0,
            length_sd_m: LENGTH_SD_M,
        },
        cable: CableMaterial::default(),
        force_sensor: None,
    }
}

/// A pose in which angles about the fixed axes x, y, z follow each other (m, rad): roll, pitch, yaw of URDF and SDF.
pub(super) fn pose_of(position_m: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Pose {
    Pose {
        position: position_m.into(),
        orientation: UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    }
}

/// The pose in the base of an object with the pose `inner` in `frame`.
pub(super) fn in_frame(frame: &Pose, inner: &Pose) -> Pose {
    Pose {
        position: frame.transform(&inner.position),
        orientation: frame.orientation * inner.orientation,
    }
}

/// Numbers as they are written in a new text.
pub(super) fn list(values: &[f64], separator: &str) -> String {
    let texts: Vec<String> = values.iter().map(|value| format!("{value:.9}")).collect();
    texts.join(separator)
}

/// A name as it is written in an attribute of XML.
pub(super) fn escaped(name: &str) -> String {
    let name = name.replace('&', "&amp;").replace('"', "&quot;");
    name.replace('<', "&lt;")
}

/// A home pose with the default standard deviations.
pub(super) fn home_at(pose: &Pose) -> Home {
    Home {
        position_m: pose.position.into(),
        orientation_wxyz: pose.orientation_wxyz(),
        position_sd_m: POSITION_SD_M,
        orientation_sd_rad: ROTATION_SD_RAD,
        covariance: None,
    }
}

/// Radius of gyration of a platform whose inertia is unknown (m): simulators need one.
const GYRATION_M: f64 = 0.03;

/// The inertia of a platform of known mass, in the order of [`Platform::inertia_kg_m2`].
pub(super) fn inertia_of(platform: &Platform, mass_kg: f64) -> [f64; 6] {
    let least = mass_kg * GYRATION_M * GYRATION_M;
    platform
        .inertia_kg_m2
        .unwrap_or([least, least, least, 0.0, 0.0, 0.0])
}

/// `CoGiRo` of `models/CoGiRo_cables.xml`.
fn name_of(file: &str) -> String {
    let stem = std::path::Path::new(file)
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    stem.strip_suffix("_cables").unwrap_or(&stem).to_owned()
}

/// Entry points are known across the plane in which a platform moves: nothing depends on them.
pub(super) fn know_normal_to_plane(platform: &Platform, cables: &mut [Cable]) {
    let axes = [Coordinate::X, Coordinate::Y, Coordinate::Z];
    let moves = axes.map(|axis| platform.free.contains(&axis));
    if moves.iter().filter(|moves| **moves).count() == 2 {
        let sd = PerAxis::Each(moves.map(|moves| (!moves).then_some(0.0)));
        for cable in cables {
            cable.pulley.entry_point_sd_m = sd;
        }
    }
}

/// Content of a robot description.
pub(super) struct Description {
    pub(super) platform: Platform,
    pub(super) cables: Vec<Cable>,
    pub(super) home: Option<Home>,
    pub(super) limits: Option<Limits>,
    /// Whether the description states the cable length per revolution.
    pub(super) has_winches: bool,
}

impl Description {
    /// A point that cables of known winches move along some coordinates, whose revolutions may count from the origin.
    pub(super) fn of_point(cables: Vec<Cable>, free: &[Coordinate], is_homed: bool) -> Self {
        let mut platform = Platform::spatial(None);
        platform.free = free.to_vec();
        Self {
            platform,
            cables,
            home: is_homed.then(|| home_at(&Pose::identity())),
            limits: None,
            has_winches: true,
        }
    }
}

/// The robot of a simulator, whose platform has its home pose in the file.
pub(super) fn simulated(
    platform: Platform,
    cables: Vec<Cable>,
    home: &Pose,
    mut notices: Vec<String>,
    settings: Settings<'_>,
) -> Result<ForeignRobot, ReadError> {
    let file = settings.file;
    notices.insert(0, format!("{file}: the pose of the platform in the file is the home pose; state \"home\": null in robot.json if cable lengths are absolute"));
    let description = Description {
        platform,
        cables,
        home: Some(home_at(home)),
        limits: None,
        has_winches: false,
    };
    let read = robot_of(file, description, notices)?;
    Ok(ForeignRobot::new(read, settings.parameters))
}

/// Names of the inertia in the order of [`Platform::inertia_kg_m2`].
pub(super) const INERTIA: [&str; 6] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];

/// A text with the coordinates of a point in place of `{word}`, and of `{word.x}`, `{word.y}` and `{word.z}`.
fn with_point(text: &str, word: &str, point: &[f64], separator: &str) -> String {
    let mut text = text.replace(&format!("{{{word}}}"), &list(point, separator));
    for (axis, value) in ["x", "y", "z"].iter().zip(point) {
        text = text.replace(&format!("{{{word}.{axis}}}"), &list(&[*value], separator));
    }
    text
}

/// The part of a new text for a cable. The columns of a rotation to its swivel axis are `{across}`, `{beside}` and `{swivel}`; the
/// direction of the first two does not matter.
pub(super) fn filled_for(part: &str, separator: &str, number: usize, cable: &Cable) -> String {
    let swivel = Vec3::from(cable.pulley.swivel_axis);
    let turn = Rotation3::face_towards(&swivel, &Vec3::ith(swivel.iamin(), 1.0));
    let mut text = part.to_owned();
    let columns = turn.matrix().column_iter();
    for (word, column) in ["across", "beside", "swivel"].iter().zip(columns) {
        text = with_point(&text, word, column.as_slice(), separator);
    }
    let name = cable.name.strip_prefix("cable-").unwrap_or(&cable.name);
    text = with_point(&text, "entry", &cable.pulley.entry_point_m, separator);
    with_point(&text, "anchor", &cable.platform_anchor_m, separator)
        .replace("{radius}", &list(&[cable.pulley.radius_m], separator))
        .replace("{number}", &number.to_string())
        .replace("{name}", &escaped(&cable.name))
        .replace("{cable}", &escaped(name))
}

/// A new text from its beginning, its part for each cable and its end, with the robot's values for the words in braces.
pub(super) fn filled(parts: [&str; 3], separator: &str, robot: &Robot) -> String {
    let list = |values: &[f64]| list(values, separator);
    let [mut text, of_cable, end] = parts.map(str::to_owned);
    for (number, cable) in (1..).zip(&robot.cables) {
        text += &filled_for(&of_cable, separator, number, cable);
    }
    text += &end;
    let platform = &robot.platform;
    let mass_kg = platform.mass_kg.unwrap_or(1.0);
    for (name, value) in INERTIA.iter().zip(inertia_of(platform, mass_kg)) {
        text = text.replace(&format!("{{{name}}}"), &list(&[value]));
    }
    let home = robot.home.map_or(Pose::identity(), |home| home.pose());
    let (roll, pitch, yaw) = home.orientation.euler_angles();
    with_point(&text, "center", &platform.center_of_mass_m, separator)
        .replace("{mass}", &mass_kg.to_string())
        .replace("{place}", &list(home.position.as_slice()))
        .replace("{turn}", &list(&[roll, pitch, yaw]))
        .replace("{robot}", &escaped(&robot.name))
}

/// The robot of a description, which states no noise.
pub(super) fn robot_of(
    file: &str,
    description: Description,
    mut notices: Vec<String>,
) -> Result<Loaded<Robot>, ReadError> {
    let mut robot = Robot {
        home: description.home,
        limits: description.limits,
        tolerances: Some(PartTolerances::typical()),
        ..Robot::new(name_of(file), description.platform, description.cables)
    };
    let sd_m = Pulley::typical_sd_m(robot.frame_size_m().unwrap_or_default());
    let sd_m = (1e4 * sd_m).round() / 1e4;
    for cable in &mut robot.cables {
        let stated = cable.pulley.entry_point_sd_m.each();
        cable.pulley.entry_point_sd_m = match stated {
            [None, None, None] => PerAxis::known(sd_m),
            stated => PerAxis::Each(stated.map(|sd| sd.or(Some(sd_m)))),
        };
    }
    let (winches, revolution) = match description.has_winches {
        true => ("", ""),
        false => (
            "winches, ",
            "a motor revolution is assumed to wind 1 m of cable, ",
        ),
    };
    let length = if description.has_winches {
        "a length is assumed"
    } else {
        "a length"
    };
    notices.push(format!(
        "{file}: does not state {winches}noise and tolerances of the pulleys: {revolution}{length} to have a standard deviation of {} mm, entry points one of {} mm, and all other parts to have typical tolerances; correct robot.json",
        1e3 * LENGTH_SD_M,
        (1e4 * sd_m).round() / 10.0
    ));
    VersionedFile::check(&robot)
        .map_err(|error| ReadError::new(file, Location::Pointer(error.pointer), error.message))?;
    Ok(Loaded {
        value: robot,
        notices,
    })
}

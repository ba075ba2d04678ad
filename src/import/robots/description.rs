//! What descriptions of robots state, and what they leave to be assumed.

use tautline_core::geometry::Coordinate;
use tautline_core::robot::{
    Cable, CableMaterial, FrameTransform, Home, Limits, PartTolerances, PerAxis, Platform, Pulley,
    Robot, Winch,
};
use tautline_session::{Loaded, Place, ReadError, VersionedFile};

/// Default standard deviation of a length reading (m): what good winches reach.
const LENGTH_SD_M: f64 = 1e-3;
/// Default standard deviation of a coordinate of the home pose (m): what a mark on the floor reaches.
pub(super) const POSITION_SD_M: f64 = 1e-3;
/// Default standard deviation of a rotation of the home pose (rad).
pub(super) const ROTATION_SD_RAD: f64 = 1e-3;

/// Where a cable enters the robot: the point that stays when the pulley swivels (m, robot frame), the axis about which it
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

/// A home pose with the default standard deviations.
pub(super) fn home_at(pose: FrameTransform) -> Home {
    Home {
        position_m: pose.position_m,
        orientation_wxyz: pose.orientation_wxyz,
        position_sd_m: POSITION_SD_M,
        orientation_sd_rad: ROTATION_SD_RAD,
        covariance: None,
    }
}

/// `CoGiRo` of `models/CoGiRo_cables.xml`.
fn name_of(file: &str) -> String {
    let stem = std::path::Path::new(file)
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    stem.strip_suffix("_cables").unwrap_or(&stem).to_owned()
}

/// What descriptions state of a robot.
pub(super) struct Description {
    pub(super) platform: Platform,
    pub(super) cables: Vec<Cable>,
    pub(super) home: Option<Home>,
    pub(super) limits: Option<Limits>,
    /// Whether it states how much cable a revolution winds.
    pub(super) has_winches: bool,
}

impl Description {
    /// A point that cables of known winches move along some coordinates, whose revolutions may count from the origin.
    pub(super) fn of_point(cables: Vec<Cable>, free: &[Coordinate], is_homed: bool) -> Self {
        let origin = FrameTransform {
            position_m: [0.0; 3],
            orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        };
        let mut platform = Platform::spatial(None);
        platform.free = free.to_vec();
        Self {
            platform,
            cables,
            home: is_homed.then(|| home_at(origin)),
            limits: None,
            has_winches: true,
        }
    }
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
        .map_err(|error| ReadError::new(file, Place::Pointer(error.pointer), error.message))?;
    Ok(Loaded {
        value: robot,
        notices,
    })
}

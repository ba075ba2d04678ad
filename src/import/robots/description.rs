//! What descriptions of robots state, and what they leave to be assumed.

use tautline_core::robot::{
    Cable, CableMaterial, Home, Limits, PartTolerances, PerAxis, Platform, Pulley, Robot, Winch,
};
use tautline_session::{Loaded, Place, ReadError, VersionedFile};

/// Default standard deviation of a length reading (m): what good winches reach.
const LENGTH_SD_M: f64 = 1e-3;

/// Where a cable enters the robot: the point that stays when the pulley swivels (m, robot frame), the axis about which it
/// swivels, a unit vector in the direction in which the cable arrives, and the radius (m), 0 for an eyelet.
pub(super) struct Guide {
    pub(super) entry_point_m: [f64; 3],
    pub(super) swivel_axis: [f64; 3],
    pub(super) radius_m: f64,
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
        pulley: Pulley {
            entry_point_m: guide.entry_point_m,
            entry_point_sd_m: PerAxis::default(),
            swivel_axis: guide.swivel_axis,
            swivel_zero: None,
            swivel_sd_rad: None,
            radius_m: guide.radius_m,
        },
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
}

/// The robot of a description, which states no winches and no noise.
pub(super) fn robot_of(
    file: &str,
    description: Description,
    mut notices: Vec<String>,
) -> Result<Loaded<Robot>, ReadError> {
    let mut robot = Robot {
        name: name_of(file),
        home: description.home,
        gravity_m_s2: [0.0, 0.0, -9.806_65],
        platform: description.platform,
        limits: description.limits,
        laser: None,
        inclinometer: None,
        tracker: None,
        cables: description.cables,
        home_platform: None,
        tolerances: Some(PartTolerances::typical()),
        hypotheses: Vec::new(),
        deviations: Vec::new(),
        effects: Vec::new(),
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
    notices.push(format!(
        "{file}: does not state winches, noise and tolerances of the pulleys: a motor revolution is assumed to wind 1 m of cable, a length to have a standard deviation of {} mm, entry points one of {} mm, and all other parts to have typical tolerances; correct robot.json",
        1e3 * LENGTH_SD_M,
        1e3 * sd_m
    ));
    VersionedFile::check(&robot)
        .map_err(|error| ReadError::new(file, Place::Pointer(error.pointer), error.message))?;
    Ok(Loaded {
        value: robot,
        notices,
    })
}

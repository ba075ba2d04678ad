//! Maslow 4 in `maslow.yaml` of FluidNC.
//!
//! Four belts from corners `tl`, `tr`, `bl`, `br` (mm) to the router, which moves in the plane of the corners. Machine coordinates
//! have their origin where the diagonals meet. A belt is shorter than the distance in space by `beltEndExtension` and `armLength`;
//! the lengths of a calibration in the serial log (`CLBM`) are distances in the plane.
//! Source: MaslowCNC/Maslow_4, `MaslowKinematics`.

use tautline_core::geometry::Coordinate;
use tautline_core::robot::{Platform, Robot};
use tautline_session::ReadError;

use super::description::{Description, Guide, cable_of, robot_of};
use super::dialect::{Dialect, ForeignRobot, MM, Numbers, Row};
use super::settings::Settings;

pub(super) static DIALECT: Dialect = Dialect {
    name: "maslow4",
    title: "maslow.yaml of FluidNC",
    is_in,
    read,
    new,
};

const CORNERS: [&str; 4] = ["tl", "tr", "bl", "br"];
const CORNER: [Row; 2] = [
    Row::anchor("kinematics.MaslowKinematics.{cable}X", 0, MM),
    Row::anchor("kinematics.MaslowKinematics.{cable}Y", 1, MM),
];
const EXTENSION: Row = Row::kept(
    "kinematics.MaslowKinematics.beltEndExtension",
    MM,
    Some(30.0),
);
const ARM: Row = Row::kept("kinematics.MaslowKinematics.armLength", MM, Some(123.4));

fn is_in(text: &str) -> bool {
    let settings = Settings::of_yaml("", text);
    settings
        .keys()
        .any(|key| key.starts_with("kinematics.MaslowKinematics."))
}

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let mut numbers = Numbers::of(Settings::of_yaml(file, text));
    let (mut cables, mut corners) = (Vec::new(), Vec::new());
    for (index, name) in CORNERS.iter().enumerate() {
        let at = Some((index, *name));
        let [x, y] = CORNER.map(|row| numbers.get(&row, at));
        let corner = [x?, y?, 0.0];
        cables.push(cable_of(
            Some((*name).to_owned()),
            index + 1,
            Guide::eyelet(corner),
            [0.0; 3],
        ));
        corners.push(corner);
    }
    let beyond_m = numbers.get(&EXTENSION, None)? + numbers.get(&ARM, None)?;
    let [x, y] = crossing(&corners).ok_or_else(|| {
        let key = "kinematics.MaslowKinematics.tlX";
        numbers
            .settings
            .error(key, "found corners on one line, expected a frame")
    })?;
    let mut notices = vec![
        format!(
            "{file}: lengths are from corner to router in the plane of the corners, as in the lines CLBM of a log; a belt is shorter by {:.1} mm (beltEndExtension and armLength)",
            1e3 * beyond_m
        ),
        format!(
            "{file}: the robot has the coordinates of the corners; those of the machine have their origin at ({:.1}, {:.1}) mm",
            1e3 * x,
            1e3 * y
        ),
    ];
    let unused = numbers.unused("kinematics.MaslowKinematics.");
    if !unused.is_empty() {
        let names = unused.iter().filter_map(|key| key.rsplit('.').next());
        notices.push(format!(
            "{file}: left out, as the robot moves in the plane of the corners: {}",
            names.collect::<Vec<_>>().join(", ")
        ));
    }
    let description = Description {
        platform: Platform {
            free: vec![Coordinate::X, Coordinate::Y],
            ..Platform::spatial(None)
        },
        cables,
        home: None,
        limits: None,
        has_winches: true,
    };
    let mut read = robot_of(file, description, notices)?;
    for cable in &mut read.value.cables {
        cable.pulley.entry_point_sd_m = in_plane(cable.pulley.entry_point_sd_m);
    }
    Ok(numbers.described(read.value, read.notices))
}

/// Where the diagonals between opposite corners meet.
fn crossing(corners: &[[f64; 3]]) -> Option<[f64; 2]> {
    let [tl, tr, bl, br] = corners else {
        return None;
    };
    let (a, b) = (
        [tr[0] - bl[0], tr[1] - bl[1]],
        [br[0] - tl[0], br[1] - tl[1]],
    );
    let part = ((tl[0] - bl[0]) * b[1] - (tl[1] - bl[1]) * b[0]) / (a[0] * b[1] - a[1] * b[0]);
    part.is_finite()
        .then(|| [bl[0] + part * a[0], bl[1] + part * a[1]])
}

fn in_plane(
    sd: tautline_core::robot::PerAxis<Option<f64>>,
) -> tautline_core::robot::PerAxis<Option<f64>> {
    let [x, y, _] = sd.each();
    tautline_core::robot::PerAxis::Each([x, y, Some(0.0)])
}

fn new(robot: &Robot) -> Result<String, String> {
    if robot.cable_count() != CORNERS.len() {
        return Err(format!(
            "found {} cables, expected 4 belts of a Maslow",
            robot.cable_count()
        ));
    }
    let mut text = "kinematics:\n  MaslowKinematics:\n".to_owned();
    for (name, cable) in CORNERS.iter().zip(&robot.cables) {
        let [x, y, _] = cable.pulley.entry_point_m.map(|value| 1e3 * value);
        text += &format!("    {name}X: {x:.3}\n    {name}Y: {y:.3}\n");
    }
    Ok(text)
}

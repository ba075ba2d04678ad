//! Maslow 4 in `maslow.yaml` of FluidNC.
//!
//! Four belts from corners `tl`, `tr`, `bl`, `br` (mm) to the router, which moves in the plane of the corners. Machine coordinates
//! have their origin where the diagonals meet. A belt is shorter than the distance in space by `beltEndExtension` and `armLength`;
//! the lengths of a calibration in the serial log (`CLBM`) are distances in the plane.
//! Source: MaslowCNC/Maslow_4, `MaslowKinematics`.

use tautline_core::geometry::Coordinate;
use tautline_core::robot::Robot;
use tautline_files::ReadError;

use super::description::{Description, Guide, cable_of, robot_of};
use super::dialect::{Dialect, ForeignRobot, MM, Setting};
use super::settings::Settings;

pub(super) static DIALECT: Dialect = Dialect {
    name: "maslow4",
    has_winches: true,
    is_in: |text| {
        Settings::of_yaml("", text)
            .text("kinematics.MaslowKinematics")
            .is_some()
    },
    read,
    new_text,
    bodies: None,
};

const CORNERS: [&str; 4] = ["tl", "tr", "bl", "br"];
const CORNER: [Setting; 2] = [
    Setting::point("kinematics.MaslowKinematics.{cable}X", 0, MM),
    Setting::point("kinematics.MaslowKinematics.{cable}Y", 1, MM),
];
const EXTENSION: Setting = Setting::kept("kinematics.MaslowKinematics.beltEndExtension", MM, 30.0);
const ARM: Setting = Setting::kept("kinematics.MaslowKinematics.armLength", MM, 123.4);

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let mut settings = Settings::of_yaml(file, text);
    let mut cables = Vec::new();
    for at in CORNERS.into_iter().enumerate() {
        let [x, y] = CORNER.map(|row| settings.get(&row, at));
        let guide = Guide::eyelet([x?, y?, 0.0]);
        cables.push(cable_of(Some(at.1.to_owned()), at.0, guide, [0.0; 3]));
    }
    let beyond_mm = 1e3 * (settings.get(&EXTENSION, (0, ""))? + settings.get(&ARM, (0, ""))?);
    let [tl, tr, bl, br] = [0, 1, 2, 3].map(|k: usize| cables[k].pulley.entry_point_m);
    // Where the diagonals meet.
    let (a, b) = (
        [tr[0] - bl[0], tr[1] - bl[1]],
        [br[0] - tl[0], br[1] - tl[1]],
    );
    let part = ((tl[0] - bl[0]) * b[1] - (tl[1] - bl[1]) * b[0]) / (a[0] * b[1] - a[1] * b[0]);
    let [x, y] = [0, 1].map(|k| 1e3 * (bl[k] + part * a[k]));
    let mut notices = vec![
        format!(
            "{file}: lengths are from corner to router in the plane of the corners, as in the lines CLBM of a log; a belt is shorter by {beyond_mm:.1} mm (beltEndExtension and armLength)"
        ),
        format!(
            "{file}: the robot has the coordinates of the corners; those of the machine have their origin at ({x:.1}, {y:.1}) mm"
        ),
    ];
    let unused = ["kinematics.MaslowKinematics.", "Maslow_Scale"];
    notices.extend(settings.left_out(&unused, "the robot moves in the plane of the corners"));
    let description = Description::of_point(cables, &Coordinate::ALL[..2], false);
    Ok(ForeignRobot::new(
        robot_of(file, description, notices)?,
        settings.parameters,
    ))
}

fn new_text(robot: &Robot) -> String {
    let mut text = "kinematics:\n  MaslowKinematics:\n".to_owned();
    for (name, cable) in CORNERS.iter().zip(&robot.cables) {
        let [x, y, _] = cable.pulley.entry_point_m.map(|value| 1e3 * value);
        text += &format!("    {name}X: {x:.3}\n    {name}Y: {y:.3}\n");
    }
    text
}

//! The pose plan as a table: `pose,x_m,y_m,z_m,qw,qx,qy,qz`.

use std::collections::HashSet;
use std::io::{BufRead, Result as IoResult, Write};

use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;
use tautline_files::ReadError;

use crate::error::Loaded;
use crate::phases::{PoseColumns, once, read_rows};
use crate::poses::{LABEL, check_plausible, place_fault};
use crate::session::PlannedPose;
use crate::table::{Table, TableWriter};

const POSE: [&str; 7] = ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"];

/// Reads a plan of poses for a robot; `file` is the name for messages. If the platform does not
/// rotate, the orientation may be omitted and is that of the home pose.
///
/// # Errors
/// The first row that is not a pose of this robot, with its line and column.
pub fn read_plan(
    reader: impl BufRead,
    file: &str,
    robot: &Robot,
) -> Result<Loaded<Vec<PlannedPose>>, ReadError> {
    let table = Table::open(reader, file)?;
    let label = table.require(LABEL)?;
    let columns = PoseColumns::find(&table, &POSE)?;
    let rotates = robot.platform.turns();
    let first_of_quaternion = match rotates {
        true => table.require(POSE[3])?,
        false => label,
    };
    let at_home = robot.home.map(|home| home.orientation_wxyz);
    let known = [[LABEL].as_slice(), &POSE].concat();
    let (mut seen, mut lines) = (HashSet::new(), Vec::new());
    let plan = read_rows(table, &known, |row| {
        lines.push(row.line());
        let number = row.integer(label)?;
        once(&mut seen, number, row, label, "label")?;
        let pose = columns.read(row)?;
        let orientation_wxyz = match pose.orientation_wxyz {
            Some(wxyz) => wxyz,
            None if rotates => return Err(row.unexpected(first_of_quaternion, "a number")),
            None => at_home.unwrap_or([1.0, 0.0, 0.0, 0.0]),
        };
        Ok(PlannedPose {
            label: number,
            position_m: pose.position_m,
            orientation_wxyz,
        })
    })?;
    let as_commanded = Measurements {
        labels: plan.value.iter().map(|pose| pose.label).collect(),
        commanded: plan.value.iter().map(|pose| Some(pose.pose())).collect(),
        ..Measurements::default()
    };
    check_plausible(&as_commanded, robot).map_err(|fault| place_fault(fault, file, &lines))?;
    Ok(plan)
}

/// Writes a plan of poses, so that it reads back bit by bit.
///
/// # Errors
/// If the writer fails.
pub fn write_plan(out: impl Write, plan: &[PlannedPose]) -> IoResult<()> {
    let mut table = TableWriter::new(out, &[[LABEL].as_slice(), &POSE].concat())?;
    for pose in plan {
        table.integer(pose.label)?;
        for value in pose.position_m.iter().chain(&pose.orientation_wxyz) {
            table.number(*value)?;
        }
        table.end_row()?;
    }
    table.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::robot::presets;

    fn read(text: &str) -> Result<Loaded<Vec<PlannedPose>>, String> {
        let robot = presets::find("mini").expect("a preset").robot;
        read_plan(text.as_bytes(), "plan.csv", &robot).map_err(|error| error.to_string())
    }

    const HEAD: &str = "pose,x_m,y_m,z_m,qw,qx,qy,qz\n";

    #[test]
    fn a_plan_reads_back() {
        let text = format!("{HEAD}1,0.1,0,0.30000000000000004,1,0,0,0\n7,0,0,0,0.6,0.8,0,0\n");
        let plan = read(&text).expect("a plan").value;
        assert_eq!((plan[1].label, plan[0].position_m[2]), (7, 0.1 + 0.2));
        let mut out = Vec::new();
        write_plan(&mut out, &plan).expect("written");
        assert_eq!(String::from_utf8(out).expect("text"), text);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        for (text, message) in [
            (
                "pose,x_m,y_m,qw,qx,qy,qz\n1,0,0,1,0,0,0\n",
                "plan.csv, line 1, column \"z_m\": missing, expected in the header row",
            ),
            (
                "pose,x_m,y_m,z_m\n1,0,0,0\n",
                "plan.csv, line 1, column \"qw\": missing",
            ),
            (
                &format!("{HEAD}1,0,0,0,,,,\n"),
                "line 2, column \"qw\": found an empty cell, expected a number",
            ),
            (
                &format!("{HEAD}1,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n"),
                "line 3, column \"pose\": found \"1\", expected each label once",
            ),
            (
                &format!("{HEAD}1,0,0,0,1,0,0,0\n\n2,300,0,0,1,0,0,0\n"),
                "line 4, column \"x_m\": found 300 m, far outside the frame",
            ),
        ] {
            let error = read(text).expect_err(message);
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn a_platform_that_does_not_rotate_needs_no_orientation() {
        let mut robot = presets::find("mini").expect("a preset").robot;
        robot.platform.free.retain(|c| c.index() < 3);
        let home = robot.home.map(|home| home.orientation_wxyz);
        let text = "pose,x_m,y_m,z_m\n1,0.1,0,0\n";
        let plan = read_plan(text.as_bytes(), "plan.csv", &robot).expect("a plan");
        assert_eq!(Some(plan.value[0].orientation_wxyz), home);
    }
}

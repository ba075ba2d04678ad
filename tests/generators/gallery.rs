//! The files of docs/gallery: as ten kinds of recorders write them, each imported by the command that docs/GALLERY.md shows.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use nalgebra::Vector3;
use tautline_core::geometry::Pose;
use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::{PerAxis, Tracker, presets};
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_session::write_robot;

/// Rows of the recordings at each pose.
const RESTING: usize = 30;

/// The folder of the files.
#[must_use]
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/gallery")
}

/// The run from which all files are made, of a robot with an external instrument.
///
/// # Errors
/// If the robot cannot be simulated.
pub fn dataset() -> Result<Dataset> {
    let mut robot = presets::find("mini").context("no such preset")?.robot;
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(1e-3),
        orientation_sd_rad: Some(1e-3),
    });
    Ok(simulate(&robot, &SimulationOptions::new(20, 12))?.dataset)
}

/// Format of a table.
struct Style {
    separator: &'static str,
    comma: bool,
    /// Names of winches and forces, with # for the number of the cable.
    winch: &'static str,
    force: &'static str,
    /// Units of a revolution and of 1 N.
    per_rev: f64,
    per_newton: f64,
    /// Number of the first cable.
    first: usize,
}

const PLAIN: Style = Style {
    separator: ",",
    comma: false,
    winch: "rev_#",
    force: "force_#_n",
    per_rev: 1.0,
    per_newton: 1.0,
    first: 1,
};

impl Style {
    fn names(&self, before: &str) -> String {
        let mut names: Vec<String> = Vec::new();
        names.extend((!before.is_empty()).then(|| before.to_owned()));
        for pattern in [self.winch, self.force] {
            let numbers = self.first..self.first + 8;
            let all = numbers.map(|number| pattern.replace('#', &number.to_string()));
            names.extend(all.filter(|name| !name.is_empty()));
        }
        names.join(self.separator)
    }

    /// Numbers of a row, of winches and forces.
    fn numbers(&self, data: &Measurements, row: usize) -> Vec<f64> {
        let rev = data
            .revolutions
            .row(row)
            .iter()
            .map(|rev| rev * self.per_rev);
        let force = data
            .force_n
            .row(row)
            .iter()
            .map(|force| force * self.per_newton);
        match self.force {
            "" => rev.collect(),
            _ => rev.chain(force).collect(),
        }
    }

    fn cells(&self, numbers: &[f64]) -> String {
        let cells = numbers.iter().map(|number| {
            let text = format!("{number:.5}");
            if self.comma {
                text.replace('.', ",")
            } else {
                text
            }
        });
        cells.collect::<Vec<_>>().join(self.separator)
    }

    /// One row for each pose, behind `heading`.
    fn table(&self, heading: &str, before: &str, data: &Measurements) -> String {
        let mut text = format!("{heading}{}\n", self.names(before));
        for row in 0..data.len() {
            let label = match before {
                "" => String::new(),
                _ => format!("{}{}", data.labels[row], self.separator),
            };
            let _ = writeln!(text, "{label}{}", self.cells(&self.numbers(data, row)));
        }
        text
    }
}

/// Numbers at rest for some rows at each pose, with the way between them.
fn recording(style: &Style, data: &Measurements) -> Vec<Vec<f64>> {
    let at = |row: usize| style.numbers(data, row.min(data.len() - 1));
    let rows = (0..data.len()).flat_map(|row| {
        let (here, next) = (at(row), at(row + 1));
        let moving = if row + 1 < data.len() { 10 } else { 0 };
        (0..RESTING + moving).map(move |k| {
            let part = k.saturating_sub(RESTING) as f64 / 10.0;
            let both = here.iter().zip(&next);
            both.map(|(from, to)| from + part * (to - from)).collect()
        })
    });
    rows.collect()
}

/// A recording of 25 Hz with the time in front.
fn timed(style: &Style, heading: &str, clock: &str, data: &Measurements) -> String {
    let mut text = format!("{heading}{}\n", style.names(clock));
    for (k, row) in recording(style, data).iter().enumerate() {
        let row: Vec<f64> = std::iter::once(0.04 * k as f64)
            .chain(row.iter().copied())
            .collect();
        let _ = writeln!(text, "{}", style.cells(&row));
    }
    text
}

/// The platform seen by an instrument elsewhere, turned about the vertical.
fn seen(pose: &Pose) -> Pose {
    let turn = nalgebra::UnitQuaternion::from_euler_angles(0.0, 0.0, 0.9);
    Pose {
        position: turn * pose.position + Vector3::new(1.4, -0.6, 0.8),
        orientation: turn * pose.orientation,
    }
}

fn measured(data: &Measurements, row: usize) -> Pose {
    Pose::from_parts(
        data.tracked_position_m[row],
        data.tracked_orientation_wxyz[row],
    )
}

/// Names and contents of all files of the page.
pub fn files(data: &Measurements) -> Vec<(&'static str, Vec<u8>)> {
    let text = |name: &'static str, text: String| (name, text.into_bytes());
    let german = Style {
        separator: ";",
        comma: true,
        winch: "Winde# Winkel [°]",
        force: "Seilkraft # [N]",
        per_rev: 360.0,
        ..PLAIN
    };
    let codesys = Style {
        separator: ";",
        winch: "GVL.Axis#.fActPosition",
        force: "GVL.Axis#.fForce",
        per_rev: 360.0,
        ..PLAIN
    };
    let zero = Style {
        separator: " ",
        winch: "theta#",
        force: "tension#",
        per_rev: std::f64::consts::TAU,
        first: 0,
        ..PLAIN
    };
    let lab = Style {
        separator: "\t",
        comma: true,
        winch: "Winch# Angle (deg)",
        force: "Load Cell # (N)",
        per_rev: 360.0,
        ..PLAIN
    };
    let ros = Style {
        winch: "position[#]",
        force: "effort_cable[#]",
        per_rev: std::f64::consts::TAU,
        first: 0,
        ..PLAIN
    };
    let kilonewtons = Style {
        winch: "Drum # (rev)",
        force: "Load # (kN)",
        per_newton: 1e-3,
        ..PLAIN
    };
    let counts = Style {
        winch: "enc#",
        force: "",
        per_rev: 4096.0,
        ..PLAIN
    };
    let utf16: Vec<u8> = std::iter::once(0xfeff)
        .chain(
            german
                .table("", "Punkt", data)
                .replace(';', "\t")
                .encode_utf16(),
        )
        .flat_map(u16::to_le_bytes)
        .collect();
    let mut turned = data.clone();
    for row in 0..data.len() {
        let rev = data.revolutions.get(row, 4);
        turned.revolutions.set(row, 4, -rev);
    }
    vec![
        text("scope.csv", scope(data)),
        text("trace.csv", timed(&codesys, "", "Time [s]", data)),
        text("excel.csv", german.table("", "Punkt", data)),
        ("unicode.txt", utf16),
        text(
            "export.csv",
            kilonewtons.table("Calibration of 12 May\n\n", "Point", data),
        ),
        text(
            "daq.csv",
            timed(
                &german,
                "Gerät;DAQ 3\nAbtastrate;25;Hz\nKanäle;16\nDauer;33;s\n\n",
                "Zeit [s]",
                data,
            ),
        ),
        text("times.lvm", labview(&lab, data, true)),
        text("steps.lvm", labview(&lab, data, false)),
        text("numpy.txt", zero.table("# ", "pose", data)),
        text("joints.csv", timed(&ros, "", "time", data)),
        text("motors.csv", motors(data)),
        text("counts.csv", counts.table("", "pose", data)),
        text("angles.csv", angles(data)),
        text("commanded.csv", commanded(data)),
        text("reversed.csv", commanded(&turned)),
        text("winches.csv", PLAIN.table("", "pose", data)),
        text("points.txt", points(data)),
        text("bodies.csv", motive(data)),
        text("markers.csv", nexus(data)),
        text("camera.csv", camera(data)),
    ]
}

/// Export of TwinCAT Scope.
fn scope(data: &Measurements) -> String {
    let names: Vec<String> = (1..=8).map(|k| format!("MAIN.Winch{k}.ActPos")).collect();
    let pairs = |key: &str, value: &dyn Fn(&String) -> String| {
        let cells = names.iter().map(|name| format!("{key}\t{}", value(name)));
        cells.collect::<Vec<_>>().join("\t")
    };
    let mut text = format!(
        "Name\tRun\nFile\tRun.csv\n\n{}\n{}\n{}\n\n",
        pairs("Name", &String::clone),
        pairs("SampleTime[ms]", &|_| "40".into()),
        pairs("Unit", &|_| "rev".into())
    );
    let style = Style { force: "", ..PLAIN };
    for (k, row) in recording(&style, data).iter().enumerate() {
        let cells = row.iter().map(|value| format!("{k}\t{value:.5}"));
        let _ = writeln!(text, "{}", cells.collect::<Vec<_>>().join("\t"));
    }
    text + "EOF\n"
}

/// Text of LabVIEW, with a column of times or without.
fn labview(style: &Style, data: &Measurements, has_times: bool) -> String {
    let columns = if has_times { "One" } else { "No" };
    let many = |value: &str| vec![value; 16].join("\t");
    let mut text = format!(
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n\
         Multi_Headings\tYes\nX_Columns\t{columns}\nTime_Pref\tRelative\n***End_of_Header***\t\n\t\nChannels\t16\n\
         X_Dimension\t{}\nX0\t{}\nDelta_X\t{}\n***End_of_Header***\n{}\tComment\n",
        many("Time"),
        many("0,0"),
        many("0,040000"),
        style.names("X_Value")
    );
    for (k, row) in recording(style, data).iter().enumerate() {
        let time = match has_times {
            true => style.cells(&[0.04 * k as f64]),
            false => String::new(),
        };
        let _ = writeln!(text, "{time}\t{}", style.cells(row));
    }
    text
}

/// A row for each motor.
fn motors(data: &Measurements) -> String {
    let style = Style {
        force: "",
        per_rev: std::f64::consts::TAU,
        ..PLAIN
    };
    let mut text = "type,time,id,position,velocity\n".to_owned();
    for (k, row) in recording(&style, data).iter().enumerate() {
        for (id, position) in row.iter().enumerate() {
            let _ = writeln!(
                text,
                "motor,{:.2},{},{position:.5},0.0",
                0.04 * k as f64,
                id + 1
            );
        }
    }
    text
}

/// Readings with commanded poses, each as the numbers that `cells` makes of it.
fn with_commanded(
    data: &Measurements,
    headings: &str,
    cells: impl Fn(&Pose) -> Vec<f64>,
) -> String {
    let mut text = format!("{},{headings}\n", PLAIN.names("pose"));
    for row in 0..data.len() {
        let pose = data.commanded[row].expect("commanded");
        let numbers = PLAIN.cells(&PLAIN.numbers(data, row));
        let commanded = PLAIN.cells(&cells(&pose));
        let _ = writeln!(text, "{},{numbers},{commanded}", data.labels[row]);
    }
    text
}

/// Commanded poses with Euler angles in degrees, R = Rz Ry Rx.
fn angles(data: &Measurements) -> String {
    let headings = "Cmd X (mm),Cmd Y (mm),Cmd Z (mm),Cmd Roll (deg),Cmd Pitch (deg),Cmd Yaw (deg)";
    with_commanded(data, headings, |pose| {
        let (roll, pitch, yaw) = pose.orientation.euler_angles();
        let position = pose.position.iter().map(|value| 1e3 * value);
        position
            .chain([roll, pitch, yaw].map(f64::to_degrees))
            .collect()
    })
}

/// Commanded poses with quaternions.
fn commanded(data: &Measurements) -> String {
    with_commanded(
        data,
        "x_des,y_des,z_des,q_des0,q_des1,q_des2,q_des3",
        |pose| {
            let position = pose.position.iter().copied();
            position.chain(pose.orientation_wxyz()).collect()
        },
    )
}

/// Points of a laser tracker (mm).
fn points(data: &Measurements) -> String {
    (1..data.len()).step_by(3).fold(String::new(), |text, row| {
        let [x, y, z] = data.tracked_position_m[row].map(|value| 1e3 * value);
        format!("{text}P{} {x:.3} {y:.3} {z:.3}\n", data.labels[row])
    })
}

/// The platform as a rigid body of OptiTrack, y up, a frame for each pose.
fn motive(data: &Measurements) -> String {
    let mut text = "Format Version,1.23,Take Name,Run,Capture Frame Rate,1.0,Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global\n\n\
        ,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n\
        ,Name,Platform,Platform,Platform,Platform,Platform,Platform,Platform\n\
        ,ID,A1,A1,A1,A1,A1,A1,A1\n\
        ,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\n\
        Frame,Time (Seconds),X,Y,Z,W,X,Y,Z\n"
        .to_owned();
    for row in 0..data.len() {
        let pose = seen(&measured(data, row));
        let [w, x, y, z] = pose.orientation_wxyz();
        let at = pose.position;
        let _ = writeln!(
            text,
            "{row},{row}.0,{x:.6},{z:.6},{:.6},{w:.6},{:.6},{:.6},{:.6}",
            -y, at.x, at.z, -at.y
        );
    }
    text
}

/// Markers on the platform by Vicon Nexus (mm), a frame for each pose.
fn nexus(data: &Measurements) -> String {
    const MARKERS: [(&str, [f64; 3]); 4] = [
        ("front", [0.12, 0.03, 0.06]),
        ("left", [-0.05, 0.11, 0.05]),
        ("right", [-0.04, -0.12, 0.04]),
        ("top", [0.02, 0.01, 0.15]),
    ];
    let mut text = "Trajectories\n100\n,,".to_owned();
    MARKERS.iter().for_each(|(name, _)| {
        let _ = write!(text, "robot:{name},,,");
    });
    let _ = write!(
        text,
        "\nFrame,Sub Frame{}\n,{}\n",
        ",X,Y,Z".repeat(4),
        ",mm,mm,mm".repeat(4)
    );
    for row in 0..data.len() {
        let _ = write!(text, "{},0", row + 1);
        for (_, place) in MARKERS {
            let at = seen(&measured(data, row)).transform(&Vector3::from(place));
            let _ = write!(
                text,
                ",{:.3},{:.3},{:.3}",
                1e3 * at.x,
                1e3 * at.y,
                1e3 * at.z
            );
        }
        text.push('\n');
    }
    text
}

/// Poses of a camera in its own frame, beside the winches, without commanded poses.
fn camera(data: &Measurements) -> String {
    let mut text = format!(
        "{},cam_x,cam_y,cam_z,cam_qw,cam_qx,cam_qy,cam_qz\n",
        PLAIN.names("pose")
    )
    .replace("cam_", "meas_")
    .replace("meas_x,meas_y,meas_z", "meas_x_m,meas_y_m,meas_z_m");
    for row in 0..data.len() {
        let pose = seen(&measured(data, row));
        let all: Vec<f64> = pose
            .position
            .iter()
            .copied()
            .chain(pose.orientation_wxyz())
            .collect();
        let numbers = PLAIN.cells(&PLAIN.numbers(data, row));
        let _ = writeln!(text, "{},{numbers},{}", data.labels[row], PLAIN.cells(&all));
    }
    text
}

/// Writes the files, and the robot whose name the commands use.
///
/// # Errors
/// If the robot cannot be simulated, or a file cannot be written.
pub fn write(folder: &Path) -> Result<()> {
    let dataset = dataset()?;
    std::fs::create_dir_all(folder)?;
    write_robot(&folder.join("robot.json"), &dataset.robot)?;
    for (name, content) in files(&dataset.measurements) {
        std::fs::write(folder.join(name), content)?;
    }
    Ok(())
}

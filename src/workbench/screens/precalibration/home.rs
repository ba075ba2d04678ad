//! Home platform: home pose from six distances.

use egui::Ui;
use tautline_core::geometry::Pose;
use tautline_core::instrument::HomeMeasurement;
use tautline_core::robot::{Home, HomePlatform};
use tautline_session::{HomeReading, PhaseData};

use super::home_picture;
use super::home_poses::{self, PoseInput};
use crate::screens::bench_panel::{Bench, TableInput, decimals_for, or_dash};
use crate::theme;
use crate::widgets::{Cell, Numbers, RowField, Rows, RowsEdit, TableColumn, UiExt, table};
use tautline_workflow::precalibration::Table;

const SENSOR: RowField = RowField::new("Sensor", "", 0).accepting(
    |value| value.fract() == 0.0 && (1.0..=6.0).contains(&value),
    "a sensor from 1 to 6",
);

/// Input of the part.
#[derive(Debug, Default)]
pub struct HomeInput {
    table: TableInput,
    pose: PoseInput,
}

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>, input: &mut HomeInput) {
    if !bench.session().phases.home_poses.is_empty() {
        home_poses::mean(ui, bench);
    }
    platform(ui, bench, &mut input.table);
    home_poses::show(ui, bench, &mut input.pose);
}

/// Draws the home platform and its readings.
fn platform(ui: &mut Ui, bench: &mut Bench<'_>, input: &mut TableInput) {
    let Some(platform) = &bench.robot().home_platform else {
        ui.neutral("The description of this robot has no home platform, so distances cannot be converted to a pose. Add home_platform with six sensors and three planes to its robot.json and reopen it. Or measure the home pose with another instrument.");
        return;
    };
    bench.import(ui, Table::Home, &mut input.path);
    let calibration = bench.calibration;
    match &calibration.home {
        None => {
            ui.muted("The home pose appears here. Place the platform on its home reference, read the six distance sensors, repeatedly if possible, and import the readings or type them below.");
        }
        Some(Err(message)) => ui.bad(&format!("{message}.")),
        Some(Ok(measured)) => {
            judge(ui, platform, measured);
            pose(ui, bench, measured);
            // With other measurements only the mean of all is applied.
            if bench.session().phases.home_poses.is_empty() {
                let proposal = &calibration.with_home;
                bench.propose(ui, proposal, "Apply pose", "apply measured home pose");
            }
        }
    }
    ui.section("The six sensors");
    home_picture::show(ui, bench, platform);
    if let Some(Ok(measured)) = &calibration.home {
        sensors(ui, measured);
    }
    readings(ui, bench, platform, input);
}

fn judge(ui: &mut Ui, platform: &HomePlatform, measured: &HomeMeasurement) {
    let outside = measured.sensors.iter().enumerate();
    let outside = outside.filter(|(_, sensor)| !sensor.in_range);
    let mut all_inside = true;
    for (k, sensor) in outside {
        all_inside = false;
        let mean = sensor.mean_m * 1e3;
        ui.doubtful(&format!(
            "Sensor {} reads {mean:.1} mm, outside its range of 40 to 300 mm. Check its mounting and its voltage.",
            k + 1
        ));
    }
    for (k, (sensor, repeats)) in platform.sensors.iter().zip(&measured.sensors).enumerate() {
        // From five readings the standard deviation is known to a factor of about 1.5.
        if repeats.count >= 5 && repeats.sd_m > 3.0 * sensor.sd_m {
            let (spread, stated) = (repeats.sd_m * 1e3, sensor.sd_m * 1e3);
            ui.doubtful(&format!(
                "Readings of sensor {} scatter by {spread:.2} mm, more than three times the {stated:.2} mm given in robot.json.",
                k + 1
            ));
            all_inside = false;
        }
    }
    let worst = measured.fix.position_sd_m.into_iter().fold(0.0, f64::max) * 1e3;
    if all_inside {
        ui.good(&format!(
            "The six distances determine the platform position to {worst:.2} mm."
        ));
    }
}

fn pose(ui: &mut Ui, bench: &Bench<'_>, measured: &HomeMeasurement) {
    let (p, r) = (measured.fix.position_sd_m, measured.fix.orientation_sd_rad);
    let sd = [p[0], p[1], p[2], r[0], r[1], r[2]];
    let (new, repeated) = (&measured.fix.platform_in_base, measured.repeatability);
    pose_table(ui, bench.robot().home, "Measured", new, sd, Some(repeated));
    if measured.repeatability.is_none() {
        ui.muted("Repeatability needs the same number of readings of all six sensors, at least two each.");
    }
}

/// The home pose of the robot beside another one with its standard deviations (m, rad), and the repeatability where it can be known.
pub(super) fn pose_table(
    ui: &mut Ui,
    now: Option<Home>,
    title: &str,
    new: &Pose,
    sd: [f64; 6],
    repeated: Option<Option<[f64; 6]>>,
) {
    let titles = ["Current", title, "±"].into_iter();
    let titles = titles.chain(repeated.map(|_| "Repeatability"));
    let columns = titles.map(|title| TableColumn::number(title, ""));
    let columns = [TableColumn::words("Home pose")].into_iter().chain(columns);
    let now = now.map(|home| coordinates(&home.pose()));
    let numbers = [now, Some(coordinates(new)), Some(sd)];
    let names = ["x (mm)", "y (mm)", "z (mm)", "rx (°)", "ry (°)", "rz (°)"];
    let row = |(k, name): (usize, &str)| {
        let shown = if k < 3 { 1e3 } else { 1f64.to_degrees() };
        let digits = decimals_for(sd[k] * shown, 2, 4);
        let numbers = numbers.into_iter().chain(repeated);
        let numbers = numbers.map(|of| or_dash(of.map(|of| of[k] * shown), digits));
        [Cell::new(name)].into_iter().chain(numbers).collect()
    };
    let rows: Vec<Vec<Cell>> = names.into_iter().enumerate().map(row).collect();
    table(ui, &columns.collect::<Vec<_>>(), &rows, None);
}

/// Position (m) and rotation vector (rad).
fn coordinates(pose: &Pose) -> [f64; 6] {
    let (p, r) = (pose.position, pose.orientation.scaled_axis());
    [p.x, p.y, p.z, r.x, r.y, r.z]
}

fn sensors(ui: &mut Ui, measured: &HomeMeasurement) {
    let columns = [
        TableColumn::words("Sensor"),
        TableColumn::number("Readings", ""),
        TableColumn::number("Mean", "mm"),
        TableColumn::number("Std. dev.", "mm"),
        TableColumn::words("Range"),
    ];
    let palette = theme::of(ui);
    let rows: Vec<Vec<Cell>> = measured
        .sensors
        .iter()
        .enumerate()
        .map(|(k, sensor)| {
            let state = if sensor.in_range {
                Cell::new("in range").coloured(palette.good)
            } else {
                Cell::new("out of range").coloured(palette.warning)
            };
            vec![
                Cell::new((k + 1).to_string()),
                Cell::new(sensor.count.to_string()),
                Cell::new(format!("{:.2}", sensor.mean_m * 1e3)),
                or_dash(Some(sensor.sd_m * 1e3).filter(|sd| sd.is_finite()), 2),
                state,
            ]
        })
        .collect();
    table(ui, &columns, &rows, None);
}

/// Field of the readings: in volts if the sensors have curves, otherwise in millimetres.
fn reading_field(platform: &HomePlatform) -> RowField {
    let in_volts = platform.sensors.iter().any(|sensor| sensor.curve.is_some());
    let in_metres = platform.sensors.iter().any(|sensor| sensor.curve.is_none());
    match (in_volts, in_metres) {
        (true, true) => RowField::new("Reading", "V or m", 4),
        (true, false) => RowField::new("Reading", "V", 4),
        _ => RowField::millimetres("Reading", 3),
    }
}

fn readings(ui: &mut Ui, bench: &mut Bench<'_>, platform: &HomePlatform, input: &mut TableInput) {
    ui.section("Readings");
    let list = &bench.session().phases.home;
    let numbers: Vec<Numbers> = list.iter().map(numbers).collect();
    let editor = Rows {
        noun: "Reading",
        fields: &[SENSOR, reading_field(platform)],
        rows: &numbers,
        remarks: ("", ""),
        remark: &[],
    };
    bench.edit_rows(ui, &editor, &mut input.rows, change);
}

fn numbers(reading: &HomeReading) -> Numbers {
    [
        Some(reading.sensor as f64 + 1.0),
        Some(reading.reading),
        None,
    ]
}

fn change(phases: &mut PhaseData, edit: RowsEdit) {
    edit.apply(
        &mut phases.home,
        |_| true,
        numbers,
        |[sensor, reading, _]| {
            Some(HomeReading {
                sensor: sensor? as usize - 1,
                reading: reading?,
            })
        },
    );
}

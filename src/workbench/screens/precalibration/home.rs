//! Home platform: the home pose from six distances.

use egui::Ui;
use tautline_core::geometry::Pose;
use tautline_core::instrument::HomeMeasurement;
use tautline_core::robot::HomePlatform;
use tautline_session::{HomeReading, PhaseData};

use super::{Typed, home_picture};
use crate::screens::desk::{Desk, decimals_for, or_dash};
use crate::theme;
use crate::widgets::{
    Cell, Column, Numbers, RowField, Rows, RowsEdit, Verdict, muted, rows, section, table, verdict,
};
use tautline_workflow::precalibration::Table;

const SENSOR: RowField = RowField {
    title: "Sensor",
    unit: "",
    per_si: 1.0,
    decimals: 0,
    optional: false,
    accepts: |value| value.fract() == 0.0 && (1.0..=6.0).contains(&value),
    expects: "a sensor from 1 to 6",
};

/// Draws the part.
pub fn show(ui: &mut Ui, desk: &mut Desk<'_>, typed: &mut Typed) {
    let Some(platform) = &desk.robot().home_platform else {
        verdict(
            ui,
            Verdict::Neutral,
            "The description of this robot has no home platform, so that distances cannot be turned into a pose. Add home_platform with six sensors and three planes to its robot.json and open that again; until then the home pose of the drawing is used.",
        );
        return;
    };
    desk.import(ui, Table::Home, &mut typed.path);
    let calibration = desk.calibration;
    match &calibration.home {
        None => muted_help(ui),
        Some(Err(message)) => verdict(ui, Verdict::Bad, &format!("{message}.")),
        Some(Ok(measured)) => {
            judge(ui, platform, measured);
            pose(ui, desk, measured);
            let proposal = &calibration.with_home;
            desk.propose(ui, proposal, "Use this pose", "use measured home pose");
        }
    }
    section(ui, "The six sensors");
    home_picture::show(ui, desk, platform);
    if let Some(Ok(measured)) = &calibration.home {
        sensors(ui, measured);
    }
    readings(ui, desk, platform, typed);
}

fn muted_help(ui: &mut Ui) {
    muted(
        ui,
        "The home pose appears here. Put the platform on its home reference, read the six distance sensors, several times if you can, and import the readings or type them below.",
    );
}

fn judge(ui: &mut Ui, platform: &HomePlatform, measured: &HomeMeasurement) {
    let outside = measured.sensors.iter().enumerate();
    let outside = outside.filter(|(_, sensor)| !sensor.in_range);
    let mut all_inside = true;
    for (k, sensor) in outside {
        all_inside = false;
        let mean = sensor.mean_m * 1e3;
        let text = format!(
            "Sensor {} says {mean:.1} mm, outside the 40 to 300 mm that it measures. Check its mounting and its voltage.",
            k + 1
        );
        verdict(ui, Verdict::Doubtful, &text);
    }
    for (k, (sensor, repeats)) in platform.sensors.iter().zip(&measured.sensors).enumerate() {
        // Five readings or more tell a spread to a factor of about 1.5.
        if repeats.count >= 5 && repeats.sd_m > 3.0 * sensor.sd_m {
            let (spread, stated) = (repeats.sd_m * 1e3, sensor.sd_m * 1e3);
            let text = format!(
                "Sensor {} spreads by {spread:.2} mm, more than three times the {stated:.2} mm that robot.json states.",
                k + 1
            );
            verdict(ui, Verdict::Doubtful, &text);
            all_inside = false;
        }
    }
    let worst = measured.fix.position_sd_m.into_iter().fold(0.0, f64::max) * 1e3;
    if all_inside {
        let text = format!("The six distances fix the platform to {worst:.2} mm.");
        verdict(ui, Verdict::Good, &text);
    }
}

fn pose(ui: &mut Ui, desk: &Desk<'_>, measured: &HomeMeasurement) {
    let columns = [
        Column::words("Home pose"),
        Column::number("In the robot", ""),
        Column::number("Measured", ""),
        Column::number("±", ""),
        Column::number("Repeatability", ""),
    ];
    let now = desk.robot().home.map(|home| coordinates(&home.pose()));
    let new = coordinates(&measured.fix.platform_in_base);
    let sd: Vec<f64> = measured
        .fix
        .position_sd_m
        .iter()
        .chain(&measured.fix.orientation_sd_rad)
        .copied()
        .collect();
    let names = ["x (mm)", "y (mm)", "z (mm)", "rx (°)", "ry (°)", "rz (°)"];
    let rows: Vec<Vec<Cell>> = names
        .into_iter()
        .enumerate()
        .map(|(k, name)| {
            let shown = if k < 3 { 1e3 } else { 1f64.to_degrees() };
            let digits = decimals_for(sd[k] * shown, 2, 4);
            let number = |value: f64| format!("{:.digits$}", value * shown);
            let repeated = measured.repeatability.map(|r| r[k] * shown);
            vec![
                Cell::new(name),
                or_dash(now.map(|now| now[k] * shown), digits),
                Cell::new(number(new[k])),
                Cell::new(number(sd[k])),
                or_dash(repeated, digits),
            ]
        })
        .collect();
    table(ui, &columns, &rows, None);
    if measured.repeatability.is_none() {
        muted(
            ui,
            "For the repeatability read all six sensors the same number of times, twice at least.",
        );
    }
}

/// Position (m) and rotation vector (rad).
fn coordinates(pose: &Pose) -> [f64; 6] {
    let (p, r) = (pose.position, pose.orientation.scaled_axis());
    [p.x, p.y, p.z, r.x, r.y, r.z]
}

fn sensors(ui: &mut Ui, measured: &HomeMeasurement) {
    let columns = [
        Column::words("Sensor"),
        Column::number("Readings", ""),
        Column::number("Mean", "mm"),
        Column::number("Spread", "mm"),
        Column::words("Range"),
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

/// What a reading is: volts if the sensors have curves, else millimetres at the screen.
fn reading_field(platform: &HomePlatform) -> RowField {
    let in_volts = platform.sensors.iter().any(|sensor| sensor.curve.is_some());
    let in_metres = platform.sensors.iter().any(|sensor| sensor.curve.is_none());
    let (unit, per_si) = match (in_volts, in_metres) {
        (true, true) => ("V or m", 1.0),
        (true, false) => ("V", 1.0),
        _ => ("mm", 1e3),
    };
    RowField {
        title: "Reading",
        unit,
        per_si,
        decimals: if per_si > 1.0 { 3 } else { 4 },
        optional: false,
        accepts: f64::is_finite,
        expects: "a number",
    }
}

fn readings(ui: &mut Ui, desk: &mut Desk<'_>, platform: &HomePlatform, typed: &mut Typed) {
    section(ui, "Readings");
    let list = &desk.session().phases.home;
    let numbers: Vec<Numbers> = list
        .iter()
        .map(|row| [Some(row.sensor as f64 + 1.0), Some(row.reading), None])
        .collect();
    let editor = Rows {
        noun: "Reading",
        fields: &[SENSOR, reading_field(platform)],
        rows: &numbers,
        remarks: ("", ""),
        remark: &[],
    };
    if let Some(edit) = rows(ui, &editor, &mut typed.rows) {
        desk.edit_rows("reading", edit, change);
    }
}

fn change(phases: &mut PhaseData, edit: RowsEdit) {
    let list = &mut phases.home;
    let sensor = |number: f64| number as usize - 1;
    match edit {
        RowsEdit::Set(row, column, Some(value)) => match (list.get_mut(row), column) {
            (Some(reading), 0) => reading.sensor = sensor(value),
            (Some(reading), _) => reading.reading = value,
            (None, _) => {}
        },
        RowsEdit::Add(rows) => list.extend(rows.into_iter().filter_map(|row| {
            Some(HomeReading {
                sensor: sensor(row[0]?),
                reading: row[1]?,
            })
        })),
        RowsEdit::Remove(row) if row < list.len() => {
            list.remove(row);
        }
        _ => {}
    }
}

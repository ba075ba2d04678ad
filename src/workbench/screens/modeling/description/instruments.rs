//! Instruments: force sensors, laser, inclinometer, external instrument.

use egui::Ui;
use tautline_core::robot::{
    ForceSensor, Inclinometer, Laser, PerAxis, Robot, TargetPlane, Tracker,
};

use super::field::{CommonNumber, NumberField, change, grid, of_part, one, optional, three};
use crate::screens::bench_panel::Bench;
use crate::widgets::{UiExt, checkbox};

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>) {
    ui.section("Instruments");
    forces(ui, bench);
    laser(ui, bench);
    inclinometer(ui, bench);
    tracker(ui, bench);
}

/// Check box for an instrument of the robot.
fn has(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    name: &str,
    mut now: bool,
    set: impl FnOnce(&mut Robot, bool),
) {
    if checkbox(ui, &mut now, name).changed() {
        let verb = if now { "add" } else { "remove" };
        let what = format!("{verb} {}", name.to_lowercase());
        change(bench, &what, |robot| set(robot, now));
    }
}

fn forces(ui: &mut Ui, bench: &mut Bench<'_>) {
    let first = bench.robot().cables.first();
    let sensor = first.and_then(|cable| cable.force_sensor);
    let now = sensor.is_some();
    has(ui, bench, "Force sensors", now, |robot, is_there| {
        for cable in &mut robot.cables {
            cable.force_sensor = is_there.then_some(ForceSensor {
                tension_gain: 1.0,
                bias_n: 0.0,
                tension_sd_n: 1.0,
            });
        }
    });
    let Some(sensor) = sensor else {
        return;
    };
    let fields: [CommonNumber<'_, ForceSensor>; 2] = [
        (
            NumberField::new("Reading per tension", "", 4),
            sensor.tension_gain,
            |sensor, value| sensor.tension_gain = value,
        ),
        (
            NumberField::new("Noise of a tension", "N", 2),
            sensor.tension_sd_n,
            |sensor, value| sensor.tension_sd_n = value,
        ),
    ];
    grid(ui, "fields of the force sensors", |ui| {
        for (field, value, set) in fields {
            one(ui, bench, &field, value, |robot, value| {
                let sensors = robot.cables.iter_mut();
                sensors
                    .filter_map(|cable| cable.force_sensor.as_mut())
                    .for_each(|sensor| set(sensor, value));
            });
        }
    });
}

fn laser(ui: &mut Ui, bench: &mut Bench<'_>) {
    let laser = bench.robot().laser;
    has(ui, bench, "Laser", laser.is_some(), |robot, is_there| {
        robot.laser = is_there.then(|| downward(robot));
    });
    let Some(laser) = laser else {
        return;
    };
    let part: fn(&mut Robot) -> Option<&mut Laser> = |robot| robot.laser.as_mut();
    grid(ui, "fields of the laser", |ui| {
        let field = NumberField::millimetres("Origin of the beam", 1);
        let set = of_part(part, |laser, value| laser.origin_m = value);
        three(ui, bench, &field, laser.origin_m, set);
        let field = NumberField::millimetres("Noise of a distance", 3);
        let set = of_part(part, |laser, value| laser.sd_m = value);
        one(ui, bench, &field, laser.sd_m, set);
        let plane = laser.target_plane;
        let field = NumberField::millimetres("Target plane at", 1);
        let set = of_part(part, |laser, value| laser.target_plane.offset_m = value);
        one(ui, bench, &field, plane.offset_m, set);
        let field = NumberField::millimetres("Plane known to", 1);
        let set = of_part(part, |laser, value| laser.target_plane.offset_sd_m = value);
        optional(ui, bench, &field, plane.offset_sd_m, set);
    });
}

/// Laser along gravity towards a plane below all pulleys.
fn downward(robot: &Robot) -> Laser {
    let gravity = robot.gravity();
    let down = gravity
        .try_normalize(1e-9)
        .map_or([0.0, 0.0, -1.0], Into::into);
    let normal = down.map(|coordinate: f64| -coordinate);
    let height = |point: [f64; 3]| (0..3).map(|axis| point[axis] * normal[axis]).sum::<f64>();
    let heights = robot.cables.iter().map(|c| height(c.pulley.entry_point_m));
    let home = robot.home.map_or(0.0, |home| height(home.position_m));
    let lowest = heights.fold(f64::INFINITY, f64::min).min(home - 0.5);
    Laser {
        origin_m: [0.0; 3],
        direction: down,
        sd_m: 5e-4,
        target_plane: TargetPlane {
            normal,
            offset_m: lowest,
            offset_sd_m: Some(0.01),
        },
    }
}

fn inclinometer(ui: &mut Ui, bench: &mut Bench<'_>) {
    let inclinometer = bench.robot().inclinometer;
    let now = inclinometer.is_some();
    has(ui, bench, "Inclinometer", now, |robot, is_there| {
        robot.inclinometer = is_there.then_some(Inclinometer { sd_rad: 1e-3 });
    });
    if let Some(inclinometer) = inclinometer {
        grid(ui, "fields of the inclinometer", |ui| {
            let field = NumberField::degrees("Noise of an angle", 4);
            one(ui, bench, &field, inclinometer.sd_rad, |robot, value| {
                robot.inclinometer = Some(Inclinometer { sd_rad: value });
            });
        });
    }
}

fn tracker(ui: &mut Ui, bench: &mut Bench<'_>) {
    let tracker = bench.robot().tracker;
    let now = tracker.is_some();
    has(ui, bench, "External instrument", now, |robot, is_there| {
        robot.tracker = is_there.then_some(Tracker {
            position_sd_m: PerAxis::Same(5e-4),
            orientation_sd_rad: None,
        });
    });
    let Some(tracker) = tracker else {
        return;
    };
    let part: fn(&mut Robot) -> Option<&mut Tracker> = |robot| robot.tracker.as_mut();
    grid(ui, "fields of the external instrument", |ui| {
        if let PerAxis::Same(sd_m) = tracker.position_sd_m {
            let field = NumberField::millimetres("Noise of a position", 3);
            let set = of_part(part, |tracker, value| {
                tracker.position_sd_m = PerAxis::Same(value);
            });
            one(ui, bench, &field, sd_m, set);
        }
        let field = NumberField::degrees("Noise of an orientation", 4);
        let set = of_part(part, |tracker, value| tracker.orientation_sd_rad = value);
        optional(ui, bench, &field, tracker.orientation_sd_rad, set);
    });
}

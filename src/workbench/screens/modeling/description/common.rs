//! Platform and home pose.

use egui::Ui;
use tautline_core::geometry::Coordinate;
use tautline_core::robot::{Home, Robot};

use super::field::{NumberField, change, grid, of_part, one, optional, three};
use crate::screens::bench_panel::Bench;
use crate::widgets::{UiExt, checkbox};

pub(super) fn platform(ui: &mut Ui, bench: &mut Bench<'_>) {
    ui.section("Platform");
    let platform = &bench.robot().platform;
    grid(ui, "fields of the platform", |ui| {
        let field = NumberField::new("Mass", "kg", 3);
        optional(ui, bench, &field, platform.mass_kg, |robot, value| {
            robot.platform.mass_kg = value;
        });
        let field = NumberField::millimetres("Centre of mass", 1);
        let centre_m = platform.center_of_mass_m;
        three(ui, bench, &field, centre_m, |robot, value| {
            robot.platform.center_of_mass_m = value;
        });
    });
    ui.horizontal_wrapped(|ui| {
        ui.muted("Moves along and about");
        for coordinate in Coordinate::ALL {
            let mut is_free = platform.free.contains(&coordinate);
            let name = ["x", "y", "z", "rx", "ry", "rz"][coordinate.index()];
            let response = checkbox(ui, &mut is_free, name);
            if response.on_hover_text(coordinate.describe()).changed() {
                let what = format!("change {}", coordinate.describe());
                change(bench, &what, |robot| {
                    let wanted = |one: &Coordinate| match *one == coordinate {
                        true => is_free,
                        false => platform.free.contains(one),
                    };
                    let free = Coordinate::ALL.into_iter().filter(wanted);
                    robot.platform.free = free.collect();
                });
            }
        }
    });
}

pub(super) fn home(ui: &mut Ui, bench: &mut Bench<'_>) {
    ui.section("Home pose");
    let home = bench.robot().home;
    let mut has_home = home.is_some();
    if checkbox(ui, &mut has_home, "Encoders read zero at a home pose").changed() {
        change(bench, "choose a home pose", |robot| {
            robot.home = has_home.then(|| default_home(robot));
        });
    }
    let Some(home) = home else {
        return;
    };
    let part: fn(&mut Robot) -> Option<&mut Home> = |robot| robot.home.as_mut();
    grid(ui, "fields of the home pose", |ui| {
        let field = NumberField::millimetres("Position", 1);
        let set = of_part(part, |home, value| home.position_m = value);
        three(ui, bench, &field, home.position_m, set);
        let field = NumberField::millimetres("Position known to", 3);
        let set = of_part(part, |home, value| {
            (home.position_sd_m, home.covariance) = (value, None);
        });
        one(ui, bench, &field, home.position_sd_m, set);
        let field = NumberField::degrees("Orientation known to", 4);
        let set = of_part(part, |home, value| {
            (home.orientation_sd_rad, home.covariance) = (value, None);
        });
        one(ui, bench, &field, home.orientation_sd_rad, set);
    });
}

/// Home pose in the middle of the pulleys.
fn default_home(robot: &Robot) -> Home {
    let count = robot.cables.len().max(1) as f64;
    let mean = |axis: usize| {
        let entries = robot.cables.iter().map(|c| c.pulley.entry_point_m[axis]);
        entries.sum::<f64>() / count
    };
    Home {
        position_m: [mean(0), mean(1), mean(2)],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        position_sd_m: 1e-3,
        orientation_sd_rad: 1e-3,
        covariance: None,
    }
}

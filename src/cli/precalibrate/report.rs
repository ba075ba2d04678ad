//! Human-readable form of a precalibration.

use tautline_core::instrument::{FORCE_RESIDUAL_LIMIT_N, WINCH_RESIDUAL_LIMIT_M};
use tautline_workflow::precalibration::{
    ElongationResult, ForceResult, HomeResult, Precalibration, WinchResult,
};

use crate::output::say;
use crate::table::{self, mm};

/// Prints all fits.
pub fn print(result: &Precalibration) {
    if !result.winches.is_empty() {
        print_winches(&result.winches);
    }
    if !result.force_sensors.is_empty() {
        print_force_sensors(&result.force_sensors);
    }
    if let Some(home) = &result.home {
        print_home(home);
    }
    if let Some(elongation) = &result.elongation {
        print_elongation(elongation);
    }
}

fn print_winches(winches: &[WinchResult]) {
    table::rows(winches).print(&[
        ("Winch", &|one| one.cable.clone()),
        ("pairs", &|one| one.pairs.to_string()),
        ("mm per rev", &|one| mm(one.cable_per_revolution_m, 4)),
        ("sd", &|one| mm(one.cable_per_revolution_sd_m, 4)),
        ("drawing", &|one| mm(one.nominal_cable_per_revolution_m, 4)),
        ("offset mm", &|one| mm(one.offset_m, 3)),
        ("sd", &|one| mm(one.offset_sd_m, 3)),
        ("largest residual mm", &|one| mm(one.largest_residual_m, 4)),
        ("verdict", &|one| verdict(one.passed)),
    ]);
    let passed = winches.iter().filter(|winch| winch.passed).count();
    let limit = WINCH_RESIDUAL_LIMIT_M * 1e3;
    say!(
        "{} within {limit} mm",
        share(passed, winches.len(), "winch")
    );
}

fn print_force_sensors(sensors: &[ForceResult]) {
    table::rows(sensors).print(&[
        ("Force sensor", &|one| one.cable.clone()),
        ("pairs", &|one| one.pairs.to_string()),
        ("gain", &|one| format!("{:.5}", one.tension_gain)),
        ("sd", &|one| format!("{:.5}", one.tension_gain_sd)),
        ("bias N", &|one| format!("{:.3}", one.bias_n)),
        ("sd", &|one| format!("{:.3}", one.bias_sd_n)),
        ("largest residual N", &|one| {
            format!("{:.3}", one.largest_residual_n)
        }),
        ("verdict", &|one| verdict(one.passed)),
    ]);
    let passed = sensors.iter().filter(|sensor| sensor.passed).count();
    let count = share(passed, sensors.len(), "force sensor");
    say!("{count} within {FORCE_RESIDUAL_LIMIT_N} N");
}

fn print_home(home: &HomeResult) {
    let mut rows = table::numbers(&["Home pose", "value", "sd", "repeatability"]);
    for (k, name) in ["x mm", "y mm", "z mm"].into_iter().enumerate() {
        let repeatability = home.position_repeatability_m;
        let cells = [
            name.to_owned(),
            mm(home.position_m[k], 3),
            mm(home.position_sd_m[k], 3),
            repeatability.map_or("-".to_owned(), |r| mm(r[k], 3)),
        ];
        table::push(&mut rows, &cells);
    }
    let degrees = |radians: f64| format!("{:.4}", radians.to_degrees());
    let pose = tautline_core::geometry::Pose::from_parts([0.0; 3], home.orientation_wxyz);
    let turned = pose.orientation.scaled_axis();
    for (k, name) in ["rx °", "ry °", "rz °"].into_iter().enumerate() {
        let repeatability = home.orientation_repeatability_rad;
        let cells = [
            name.to_owned(),
            degrees(turned[k]),
            degrees(home.orientation_sd_rad[k]),
            repeatability.map_or("-".to_owned(), |r| degrees(r[k])),
        ];
        table::push(&mut rows, &cells);
    }
    say!("{rows}");
    say!(
        "largest residual of the six distances: {:.1e} mm",
        home.largest_residual_m * 1e3
    );
    for sensor in home.sensors.iter().filter(|sensor| !sensor.in_range) {
        let (number, mean) = (sensor.sensor, mm(sensor.mean_m, 1));
        say!("sensor {number}: {mean} mm is outside the measuring range");
    }
}

fn print_elongation(elongation: &ElongationResult) {
    table::rows(&elongation.degrees).print(&[
        ("Elongation surface", &|one| {
            let chosen = one.degree == elongation.surface.degree;
            let mark = if chosen { " (chosen)" } else { "" };
            format!("degree {}{mark}", one.degree)
        }),
        ("cross-validated error mm", &|one| {
            (one.error_m).map_or("too few points".to_owned(), |e| mm(e, 4))
        }),
    ]);
    let surface = &elongation.surface;
    say!(
        "{} measurements, lengths {:.3} to {:.3} m, tensions {:.1} to {:.1} N",
        elongation.points,
        surface.length_center_m - surface.length_scale_m,
        surface.length_center_m + surface.length_scale_m,
        surface.tension_center_n - surface.tension_scale_n,
        surface.tension_center_n + surface.tension_scale_n
    );
    say!(
        "residual sd {} mm, largest residual {} mm",
        mm(surface.residual_sd_m, 4),
        mm(elongation.largest_residual_m, 4)
    );
}

fn verdict(passed: bool) -> String {
    if passed { "passed" } else { "FAILED" }.to_owned()
}

fn share(passed: usize, count: usize, noun: &str) -> String {
    let ending = match noun {
        _ if count == 1 => "",
        "winch" => "es",
        _ => "s",
    };
    format!("{passed} of {count} {noun}{ending}")
}

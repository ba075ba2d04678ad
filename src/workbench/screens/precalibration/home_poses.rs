//! Home poses measured by instruments other than the home platform, and the mean of all.

use egui::{TextEdit, Ui};
use egui_material_icons::icons;
use tautline_session::HomePose;
use tautline_workflow::wording::units::mm;
use tautline_workflow::wording::{count, p_value};

use crate::model::edit::Edit;
use crate::screens::bench_panel::Bench;
use crate::theme::GRID;
use crate::widgets::{
    Cell, PoseFields, TableColumn, UiExt, icon_only, name_text_field, parse_number, primary, table,
};

use super::home::pose_table;

/// p-value of the spread below which the stated standard deviations are doubted.
const DOUBTFUL: f64 = 0.01;

/// Input of the next measurement.
#[derive(Debug, Default)]
pub struct PoseInput {
    pose: PoseFields,
    /// Standard deviations of the position (mm) and of the rotation (degrees).
    sds: [String; 2],
}

/// Draws the measurements and the fields for another one.
pub fn show(ui: &mut Ui, bench: &mut Bench<'_>, input: &mut PoseInput) {
    let home = bench.robot().home;
    ui.section("Measured by another instrument");
    ui.muted("Drive home, measure the pose of the platform there, and repeat: random differences average out.");
    list(ui, bench);
    let response = input.pose.show(ui, "Home", false);
    let by_default = bench
        .session()
        .phases
        .home_poses
        .last()
        .map(|last| (last.position_sd_m, last.orientation_sd_rad))
        .or(home.map(|home| (home.position_sd_m, home.orientation_sd_rad)));
    let sds = deviations(ui, &mut input.sds, by_default);
    let measured = input.pose.pose().and_then(|pose| {
        let (position_sd_m, orientation_sd_rad) = sds?;
        Ok(HomePose {
            position_m: pose.position_m,
            orientation_wxyz: pose
                .orientation_wxyz
                .or(home.map(|home| home.orientation_wxyz))
                .unwrap_or([1.0, 0.0, 0.0, 0.0]),
            position_sd_m,
            orientation_sd_rad,
        })
    });
    let entered = response.left && ui.input(|i| i.key_pressed(egui::Key::Enter));
    let pressed = primary(ui, "Add measurement", measured.is_ok()).clicked();
    match measured {
        Ok(pose) if pressed || entered => {
            input.pose = PoseFields::default();
            change(bench, "add home measurement", |poses| poses.push(pose));
        }
        Err(problem) if !input.pose.is_empty() => {
            ui.muted(&format!("{problem}."));
        }
        _ => {}
    }
}

fn list(ui: &mut Ui, bench: &mut Bench<'_>) {
    let poses = &bench.session().phases.home_poses;
    if poses.is_empty() {
        return;
    }
    let columns = [
        TableColumn::words("Measurement"),
        TableColumn::number("x", "mm"),
        TableColumn::number("y", "mm"),
        TableColumn::number("z", "mm"),
        TableColumn::number("±", "mm"),
    ];
    let rows: Vec<Vec<Cell>> = (1..)
        .zip(poses)
        .map(|(number, pose): (usize, &HomePose)| {
            let mut cells = vec![Cell::new(number.to_string())];
            cells.extend(pose.position_m.map(|v| Cell::new(mm(v, 3))));
            cells.push(Cell::new(mm(pose.position_sd_m, 3)));
            cells
        })
        .collect();
    table(ui, &columns, &rows, None);
    let last = poses.len();
    if icon_only(ui, icons::ICON_DELETE, "Remove the last measurement", true).clicked() {
        let what = format!("remove home measurement {last}");
        change(bench, &what, |poses| {
            poses.pop();
        });
    }
}

/// Fields for the standard deviations of a measurement (m, rad); empty ones repeat those of the last.
fn deviations(
    ui: &mut Ui,
    texts: &mut [String; 2],
    by_default: Option<(f64, f64)>,
) -> Result<(f64, f64), String> {
    let shown = by_default.map(|(m, rad)| [m * 1e3, rad.to_degrees()]);
    let names = ["Home position ±", "Home rotation ±"];
    ui.horizontal_wrapped(|ui| {
        for (k, (text, unit)) in texts.iter_mut().zip(["mm", "degrees"]).enumerate() {
            ui.muted("±");
            let hint = shown.map_or_else(String::new, |shown| format!("{:.4}", shown[k]));
            let field = TextEdit::singleline(text).hint_text(hint);
            let field = ui.add(field.desired_width(15.0 * GRID));
            name_text_field(&field, names[k], text);
            ui.muted(unit);
        }
    });
    let typed = |k: usize| -> Result<f64, String> {
        let text = texts[k].trim();
        let value = match shown.filter(|_| text.is_empty()) {
            Some(shown) => shown[k],
            None => parse_number(text).map_err(|problem| format!("{}: {problem}", names[k]))?,
        };
        if value.is_finite() && value > 0.0 {
            return Ok(value);
        }
        Err(format!("{}: expected a number greater than 0", names[k]))
    };
    Ok((typed(0)? * 1e-3, typed(1)?.to_radians()))
}

fn change(bench: &mut Bench<'_>, what: &str, change: impl FnOnce(&mut Vec<HomePose>)) {
    let mut phases = bench.session().phases.clone();
    change(&mut phases.home_poses);
    let edit = Edit::SetPhases(Box::new(phases), what.to_owned());
    bench.outbox.send(edit);
}

/// Draws the mean of all measurements and the step that applies it.
pub fn mean(ui: &mut Ui, bench: &mut Bench<'_>) {
    let calibration = bench.calibration;
    let Some(average) = &calibration.home_average else {
        return;
    };
    let worst_mm = average.sd().0.into_iter().fold(0.0, f64::max) * 1e3;
    let number = count(average.count, "measurement");
    match average.p_value() {
        Some(p) if p < DOUBTFUL => {
            ui.doubtful(&format!(
                "The {number} of the home pose differ more than their standard deviations say ({}).",
                p_value(p)
            ));
        }
        _ => {
            ui.good(&format!(
                "{number} of the home pose: position to {worst_mm:.3} mm."
            ));
        }
    }
    let sd = std::array::from_fn(|k| average.covariance[(k, k)].sqrt());
    pose_table(ui, bench.robot().home, "Mean", &average.pose, sd, None);
    bench.propose(
        ui,
        &calibration.with_home,
        "Apply pose",
        "apply measured home pose",
    );
}

//! Pulleys: radius, swivel axis, and their state at the shown pose.

use egui::Ui;
use tautline_core::geometry::Vec3;
use tautline_core::kinematics::{CableState, inverse_kinematics};
use tautline_core::robot::Robot;

use super::{pose, pulley_picture};
use crate::model::command::ViewCommand;
use crate::model::edit::Edit;
use crate::screens::bench_panel::{Bench, or_dash};
use crate::views::pulley_inspector;
use crate::widgets::{Cell, Entered, Number, TableColumn, UiExt, number, table};
use tautline_workflow::wording::units::fixed;

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>) {
    let chosen = bench.selection.cable;
    let chosen = chosen
        .filter(|cable| *cable < bench.robot().cable_count())
        .unwrap_or(0);
    let shown = pose::shown(bench);
    let states = shown
        .as_ref()
        .map(|shown| inverse_kinematics(bench.robot(), &shown.pose));
    match (&shown, &states) {
        (Some(shown), Some(Ok(_))) => {
            let name = &shown.name;
            ui.muted(&format!(
                "Wrap and swivel angle at {name}. Select a pose to see others."
            ));
        }
        (_, Some(Err(error))) => ui.bad(&format!("{error}.")),
        _ => {
            ui.muted("Wrap and swivel angle appear here once a pose is selected: this robot has no home pose.");
        }
    }
    let states = states.and_then(Result::ok);
    overview(ui, bench, chosen, states.as_deref());
    ui.section(&format!("Pulley of {}", bench.cable_name(chosen)));
    let name = bench.cable_name(chosen).to_owned();
    pulley_inspector::button(ui, chosen, &name, bench.outbox);
    fields(ui, bench, chosen);
    if let Some(state) = states.as_ref().and_then(|states| states.get(chosen)) {
        pulley_picture::show(ui, bench.robot(), chosen, state);
    }
}

fn overview(ui: &mut Ui, bench: &mut Bench<'_>, chosen: usize, states: Option<&[CableState]>) {
    let columns = [
        TableColumn::words("Cable"),
        TableColumn::number("Radius", "mm"),
        TableColumn::number("Swivel axis", "x, y, z"),
        TableColumn::number("Wrap", "°"),
        TableColumn::number("Swivel", "°"),
    ];
    let cables = bench.robot().cables.iter().enumerate();
    let rows: Vec<Vec<Cell>> = cables
        .map(|(k, cable)| {
            let state = states.and_then(|states| states.get(k));
            let axis = cable.pulley.swivel_axis.map(|part| fixed(part, 2));
            let wrap = state.map(|state| state.wrap_rad.to_degrees());
            let swivel = state.and_then(|state| state.swivel_rad);
            vec![
                bench.cable_cell(ui, k),
                Cell::new(format!("{:.2}", cable.pulley.radius_m * 1e3)),
                Cell::new(axis.join(", ")),
                or_dash(wrap, 1),
                or_dash(swivel.map(f64::to_degrees), 1),
            ]
        })
        .collect();
    let touched = table(ui, &columns, &rows, Some(chosen));
    if let Some(cable) = touched.double_clicked {
        bench.outbox.send(ViewCommand::Inspect(Some(cable)));
    } else if let Some(cable) = touched.clicked {
        bench.select_cable(cable);
    }
}

fn fields(ui: &mut Ui, bench: &mut Bench<'_>, chosen: usize) {
    let Some(cable) = bench.robot().cables.get(chosen) else {
        return;
    };
    let pulley = cable.pulley;
    ui.horizontal(|ui| {
        ui.label("Radius");
        let field = Number::of("Pulley radius", pulley.radius_m * 1e3, 3, "mm", 72.0);
        let entered = number(ui, &field);
        let what = format!("change pulley radius of {}", cable.name);
        change(bench, entered, what, |robot, value| {
            if value < 0.0 {
                return Err(format!(
                    "Pulley radius: found {value} mm, expected 0 for an eyelet or more."
                ));
            }
            if let Some(cable) = robot.cables.get_mut(chosen) {
                cable.pulley.radius_m = value * 1e-3;
            }
            Ok(())
        });
    });
    ui.horizontal(|ui| {
        ui.label("Swivel axis").on_hover_text(
            "Direction of the incoming cable in the base frame; normalised to unit length.",
        );
        for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
            let name = format!("Swivel axis {name}");
            let field = Number::of(&name, pulley.swivel_axis[k], 4, "", 64.0);
            let entered = number(ui, &field);
            let what = format!("change swivel axis of {}", cable.name);
            change(bench, entered, what, |robot, value| {
                turn(robot, chosen, k, value)
            });
        }
    });
}

/// Sets a component of the axis and normalises it.
fn turn(robot: &mut Robot, cable: usize, coordinate: usize, value: f64) -> Result<(), String> {
    let Some(cable) = robot.cables.get_mut(cable) else {
        return Ok(());
    };
    let mut axis = cable.pulley.swivel_axis;
    axis[coordinate] = value;
    let unit = Vec3::from(axis).try_normalize(1e-6).ok_or(
        "Swivel axis: found 0 in all three coordinates, expected a direction. Set another coordinate first.",
    )?;
    cable.pulley.swivel_axis = unit.into();
    Ok(())
}

/// Applies an entry, or rejects it.
fn change(
    bench: &mut Bench<'_>,
    entered: Option<Entered>,
    what: String,
    change: impl FnOnce(&mut Robot, f64) -> Result<(), String>,
) {
    let value = match entered {
        Some(Entered::Value(value)) => value,
        Some(Entered::Wrong(message)) => return bench.refuse(message),
        Some(Entered::Nothing) | None => return,
    };
    let mut robot = bench.robot().clone();
    let changed = change(&mut robot, value).and_then(|()| {
        let checked = robot.check();
        checked.map_err(|error| format!("This value makes the robot invalid: {error}."))
    });
    match changed {
        Ok(()) => bench.outbox.send(Edit::SetRobot(Box::new(robot), what)),
        Err(message) => bench.refuse(message),
    }
}

//! Fields of the description; the whole robot is checked while typing.

use egui::{Grid, Ui};
use tautline_core::robot::Robot;

use crate::model::edit::Edit;
use crate::screens::bench_panel::Bench;
use crate::theme::GRID;
use crate::widgets::{Entered, Number, number_checked};

/// Width of a field, and of one of three (points).
const WIDTH: f32 = 84.0;
const OF_THREE: f32 = 62.0;

/// Number of the description.
pub struct NumberField<'a> {
    pub name: &'a str,
    /// Display unit.
    pub unit: &'a str,
    /// Display units per SI unit.
    pub per_si: f64,
    /// Number of decimals.
    pub decimals: usize,
    /// Whether the field may be empty.
    optional: bool,
}

impl<'a> NumberField<'a> {
    /// Length in millimetres.
    pub const fn millimetres(name: &'a str, decimals: usize) -> Self {
        Self {
            per_si: 1e3,
            ..Self::new(name, "mm", decimals)
        }
    }

    /// Number in an SI unit.
    pub const fn degrees(name: &'a str, decimals: usize) -> Self {
        Self {
            per_si: 180.0 / std::f64::consts::PI,
            ..Self::new(name, "°", decimals)
        }
    }

    pub const fn new(name: &'a str, unit: &'a str, decimals: usize) -> Self {
        Self {
            name,
            unit,
            per_si: 1.0,
            decimals,
            optional: false,
        }
    }
}

/// Number of every cable or part of a cable: field, value, setter.
pub type CommonNumber<'a, T> = (NumberField<'a>, f64, fn(&mut T, f64));

pub fn grid(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui)) {
    Grid::new(name)
        .num_columns(2)
        .spacing([3.0 * GRID, GRID])
        .show(ui, add);
}

/// Grid row with one optional number; `None` if empty.
pub fn optional(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    field: &NumberField<'_>,
    value: Option<f64>,
    set: impl Fn(&mut Robot, Option<f64>),
) {
    let optional = NumberField {
        optional: true,
        ..*field
    };
    line(ui, bench, &optional, value, &set);
}

/// Grid row with one number.
pub fn one(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    field: &NumberField<'_>,
    value: f64,
    set: impl Fn(&mut Robot, f64),
) {
    line(ui, bench, field, Some(value), &|robot, value| {
        set(robot, value.unwrap_or_default());
    });
}

fn line(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    field: &NumberField<'_>,
    value: Option<f64>,
    set: &dyn Fn(&mut Robot, Option<f64>),
) {
    ui.label(field.name);
    ui.horizontal(|ui| cell(ui, bench, field, value, WIDTH, set));
    ui.end_row();
}

/// Grid row with x, y and z.
pub fn three(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    field: &NumberField<'_>,
    value: [f64; 3],
    set: impl Fn(&mut Robot, [f64; 3]),
) {
    ui.label(field.name);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = GRID;
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let name = format!("{} {axis}", field.name);
            // The unit is shown once, after the last field.
            let of_axis = NumberField {
                name: &name,
                unit: if k == 2 { field.unit } else { "" },
                ..*field
            };
            let set = |robot: &mut Robot, typed: Option<f64>| {
                let mut changed = value;
                changed[k] = typed.unwrap_or_default();
                set(robot, changed);
            };
            cell(ui, bench, &of_axis, Some(value[k]), OF_THREE, &set);
        }
    });
    ui.end_row();
}

fn cell(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    field: &NumberField<'_>,
    value: Option<f64>,
    width: f32,
    set: &dyn Fn(&mut Robot, Option<f64>),
) {
    let robot = bench.robot();
    let with = |typed: Option<f64>| {
        let mut changed = robot.clone();
        set(&mut changed, typed.map(|typed| typed / field.per_si));
        changed
    };
    let check = |typed: f64| {
        let checked = with(Some(typed)).check();
        checked.map_err(|error| error.to_string())
    };
    let value = value.map(|value| value * field.per_si);
    let shown = Number::of(field.name, value, field.decimals, field.unit, width);
    let typed = match number_checked(ui, &shown.optional(field.optional), &check) {
        Some(Entered::Value(typed)) => Some(typed),
        Some(Entered::Nothing) => None,
        Some(Entered::Wrong(message)) => return bench.refuse(message),
        None => return,
    };
    let what = format!("change {}", field.name.to_lowercase());
    put(bench, with(typed), &what);
}

/// Replaces the robot of the session, or rejects an invalid one.
pub fn put(bench: &mut Bench<'_>, robot: Robot, what: &str) {
    match robot.check() {
        Ok(()) if robot == *bench.robot() => {}
        Ok(()) => {
            let edit = Edit::SetRobot(Box::new(robot), what.to_owned());
            bench.outbox.send(edit);
        }
        Err(error) => bench.refuse(format!("This makes the robot invalid: {error}.")),
    }
}

/// Changes the robot, unless it becomes invalid.
pub fn change(bench: &mut Bench<'_>, what: &str, change: impl FnOnce(&mut Robot)) {
    let mut robot = bench.robot().clone();
    change(&mut robot);
    put(bench, robot, what);
}

/// Changes an optional part of the robot.
pub fn of_part<P, T>(
    part: fn(&mut Robot) -> Option<&mut P>,
    set: impl Fn(&mut P, T),
) -> impl Fn(&mut Robot, T) {
    move |robot, value| {
        if let Some(part) = part(robot) {
            set(part, value);
        }
    }
}

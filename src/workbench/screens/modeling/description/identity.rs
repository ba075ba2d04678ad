//! Name and serial number of the robot.

use egui::{TextEdit, Ui};
use tautline_core::robot::Robot;

use super::field::{change, grid};
use crate::screens::bench_panel::Bench;
use crate::widgets::UiExt;

/// Width of a text field (points).
const WIDTH: f32 = 240.0;

/// Text being typed, until the field is left.
#[derive(Debug, Default)]
pub struct Drafts {
    name: Option<String>,
    serial_number: Option<String>,
}

pub(super) fn show(ui: &mut Ui, bench: &mut Bench<'_>, drafts: &mut Drafts) {
    ui.section("Robot");
    let robot = bench.robot();
    let serial_number = robot.serial_number.clone().unwrap_or_default();
    grid(ui, "identity of the robot", |ui| {
        let name = robot.name.clone();
        text(
            ui,
            bench,
            "Name",
            (name, &mut drafts.name),
            |robot, typed| {
                robot.name = typed;
            },
        );
        let draft = (serial_number, &mut drafts.serial_number);
        text(ui, bench, "Serial number", draft, |robot, typed| {
            robot.serial_number = (!typed.is_empty()).then_some(typed);
        });
    });
}

/// Row with a text that changes the robot when its field is left.
fn text(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    name: &str,
    (value, draft): (String, &mut Option<String>),
    set: impl FnOnce(&mut Robot, String),
) {
    let label = ui.label(name);
    let mut shown = draft.take().unwrap_or(value);
    let field = ui.add(TextEdit::singleline(&mut shown).desired_width(WIDTH));
    let field = field.labelled_by(label.id);
    if field.has_focus() {
        *draft = Some(shown);
    } else if field.lost_focus() {
        let what = format!("change the {}", name.to_lowercase());
        change(bench, &what, |robot| set(robot, shown.trim().to_owned()));
    }
    ui.end_row();
}

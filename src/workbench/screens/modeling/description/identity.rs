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
        let draft = &mut drafts.name;
        text(ui, bench, "Name", &robot.name, draft, |robot, typed| {
            robot.name = typed;
        });
        let (name, draft) = ("Serial number", &mut drafts.serial_number);
        text(ui, bench, name, &serial_number, draft, |robot, typed| {
            robot.serial_number = (!typed.is_empty()).then_some(typed);
        });
    });
}

/// Row with a text that changes the robot when its field is left.
fn text(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    name: &str,
    value: &str,
    draft: &mut Option<String>,
    set: impl FnOnce(&mut Robot, String),
) {
    let label = ui.label(name);
    let mut shown = draft.take().unwrap_or_else(|| value.to_owned());
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

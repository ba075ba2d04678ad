//! New robot from an empty table, in which the operator enters every number.

use egui::{DragValue, Frame, Margin, Role, ScrollArea, TextEdit, Ui, WidgetInfo};

use super::cable_table::CableTable;
use super::description::cables::{self, FocusedCell};
use crate::model::command::{Command, FileCommand, Outbox, ViewCommand};
use crate::model::phase::Screen;
use crate::theme::GRID;
use crate::widgets::{UiExt, primary};

const MOST_CABLES: usize = 64;
const USUAL_CABLES: usize = 8;

#[derive(Debug)]
pub struct Draft {
    name: String,
    table: CableTable,
    focused: FocusedCell,
}

impl Default for Draft {
    fn default() -> Self {
        let mut table = CableTable {
            names: Vec::new(),
            cells: Vec::new(),
        };
        table.resize(USUAL_CABLES);
        Self {
            name: "New robot".to_owned(),
            table,
            focused: None,
        }
    }
}

pub(crate) fn show(ui: &mut Ui, draft: &mut Draft, back: Screen, outbox: &mut Outbox) {
    let frame = Frame::new().inner_margin(Margin::same(3 * GRID as i8));
    let area = ScrollArea::vertical().auto_shrink(false);
    let contents = |ui: &mut Ui| {
        ui.heading("New robot from an empty table");
        ui.muted("Type the numbers or paste them from a spreadsheet. Platform, home pose and instruments come afterwards, under Modeling, Description.");
        ui.add_space(2.0 * GRID);
        name_and_count(ui, draft);
        ui.section("Cables");
        match cables::grid(ui, &draft.table, &mut draft.focused, true) {
            Some(Ok((table, _))) => draft.table = table,
            Some(Err(message)) => outbox.send(Command::Refuse(message)),
            None => {}
        }
        cables::hints(ui);
        ui.add_space(2.0 * GRID);
        finish(ui, draft, back, outbox);
    };
    area.show(ui, |ui| frame.show(ui, contents));
}

fn name_and_count(ui: &mut Ui, draft: &mut Draft) {
    ui.horizontal(|ui| {
        ui.label("Name");
        let field = ui.add(TextEdit::singleline(&mut draft.name).desired_width(200.0));
        field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Name of the robot"));
        ui.add_space(3.0 * GRID);
        let mut count = draft.table.names.len();
        ui.label("Number of cables");
        let response = ui.add(DragValue::new(&mut count).range(1..=MOST_CABLES));
        response.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, "Number of cables"));
        if response.changed() {
            draft.table.resize(count);
        }
    });
}

/// Missing numbers, or the button that creates the session.
fn finish(ui: &mut Ui, draft: &mut Draft, back: Screen, outbox: &mut Outbox) {
    let missing = draft.table.missing();
    let has_name = !draft.name.trim().is_empty();
    if !missing.is_empty() {
        ui.doubtful("Still missing:");
        for text in &missing {
            ui.muted(text);
        }
    }
    if !has_name {
        ui.doubtful("The robot needs a name.");
    }
    let is_complete = missing.is_empty() && has_name;
    let (used, left) = ui
        .horizontal(|ui| {
            let used = primary(ui, "Use this robot", is_complete).clicked();
            (used, ui.button("Cancel").clicked())
        })
        .inner;
    if left {
        outbox.send(ViewCommand::Go(back));
    }
    if used {
        match draft.table.to_robot(draft.name.trim()) {
            Ok(robot) => outbox.send(FileCommand::NewRobot(Box::new(robot))),
            Err(message) => outbox.send(Command::Refuse(message)),
        }
    }
}

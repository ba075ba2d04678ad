//! The panel of the phase Measuring: which poses, the controller, the run.

mod asking;
pub mod controller;
mod outlook;
mod poses;
mod readings;
mod run;
mod table;

use egui::{DragValue, Ui};
use egui_material_icons::icons;
use tautline_session::PlannedPose;

use crate::model::Memo;
use crate::model::Model;
use crate::model::command::Outbox;
use crate::model::command::{Command, Export, FileCommand, PLANNING, RobotCommand, ViewCommand};
use crate::model::phase::{Phase, Screen};
use crate::theme::GRID;
use crate::widgets::{Verdict, heading, icon_button, muted, primary, section, verdict};
use tautline_workflow::planning::missing;

/// State of the panel between frames.
#[derive(Debug)]
pub struct PanelState {
    /// Number of poses to plan.
    poses: usize,
    /// Standard deviation of the entry points that is good enough (mm).
    target_mm: f64,
    /// The plan of which it was asked what to expect, and the id of its session.
    asked: Option<(u64, Vec<PlannedPose>)>,
    /// Rows of the table of poses, of a document and its revision.
    rows: Memo<(u64, u64), Vec<poses::Row>>,
    /// The pose that the table was scrolled to last.
    scrolled_to: Option<i64>,
    /// The laser distance that is typed.
    typed: asking::Typed,
    /// Whether the matrix of faults is shown.
    shows_faults: bool,
}

impl Default for PanelState {
    fn default() -> Self {
        Self {
            poses: 25,
            target_mm: 1.0,
            asked: None,
            rows: Memo::default(),
            scrolled_to: None,
            typed: asking::Typed::default(),
            shows_faults: false,
        }
    }
}

/// What is to be done next; its button is the primary one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::screens) enum Next {
    Plan,
    Connect,
    Arm,
    Start,
    Identify,
    Nothing,
}

/// A button that is the primary one if it is the next step.
pub(in crate::screens) fn step_button(
    ui: &mut Ui,
    text: &str,
    is_next: bool,
    enabled: bool,
) -> bool {
    if is_next {
        return primary(ui, text, enabled).clicked();
    }
    let button = egui::Button::new(text).min_size(egui::vec2(0.0, 28.0));
    ui.add_enabled(enabled, button).clicked()
}

fn next(model: &Model) -> Next {
    let Some(open) = &model.open else {
        return Next::Nothing;
    };
    let session = open.session();
    if model.link.is_busy() {
        Next::Nothing
    } else if session.plan.is_empty() && session.measurements.is_empty() {
        Next::Plan
    } else if missing(session) == 0 {
        Next::Identify
    } else if model.link.lost().is_some() {
        Next::Nothing
    } else if !model.link.is_connected() {
        Next::Connect
    } else if !model.link.is_armed() {
        Next::Arm
    } else {
        Next::Start
    }
}

/// Draws the panel.
pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    heading(ui, "Measuring");
    muted(
        ui,
        "The robot visits poses that determine its pulleys well; at each it stops and all sensors are read.",
    );
    ask(model, panel, outbox);
    instruments(ui, model);
    let next = next(model);
    plan(ui, model, panel, outbox, next);
    controller::show(ui, model, outbox, next);
    run::show(ui, model, panel, outbox, next);
    table::show(ui, model, panel, outbox);
    if next == Next::Identify {
        ui.add_space(2.0 * GRID);
        if primary(ui, "Go to identification", true).clicked() {
            let screen = Screen::Phase(Phase::Identification);
            outbox.send(ViewCommand::Go(screen));
        }
    }
}

/// Requests the prediction for a plan that was stored with the session, once.
fn ask(model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let Some(open) = &model.open else {
        return;
    };
    let plan = &open.session().plan;
    let was_asked = panel.asked.as_ref();
    let was_asked = was_asked.is_some_and(|(of, asked)| *of == open.id() && asked == plan);
    let is_busy = model.link.is_busy() || model.tasks.runs(PLANNING);
    let has_poses = plan.iter().any(|pose| pose.label != 0);
    if model.outlook.is_none() && !was_asked && has_poses && !is_busy {
        panel.asked = Some((open.id(), plan.clone()));
        outbox.send(RobotCommand::Expect);
    }
}

/// Warns of instruments that the robot lacks.
fn instruments(ui: &mut Ui, model: &Model) {
    let Some(open) = &model.open else {
        return;
    };
    let robot = &open.session().robot;
    if robot.laser.is_none() {
        verdict(
            ui,
            Verdict::Doubtful,
            "This robot has no laser distance sensor. Without it the height of the platform and the size of the frame \
             are poorly determined. Mount one and add it to the robot description, or expect large standard deviations.",
        );
    }
    if !robot.has_force_sensors() {
        verdict(
            ui,
            Verdict::Doubtful,
            "This robot has no force sensors: elongation and sag of the cables are not corrected.",
        );
    }
    if robot.home.is_none() {
        verdict(
            ui,
            Verdict::Bad,
            "This robot has no home pose, so revolutions have no reference. Measure its home platform first.",
        );
    }
}

fn plan(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox, next: Next) {
    section(ui, "Poses to measure");
    let planning = model.tasks.runs(PLANNING);
    let free = !planning && !model.link.is_busy();
    ui.horizontal(|ui| {
        let label = ui.label("Number");
        let poses = DragValue::new(&mut panel.poses).range(1..=500);
        ui.add(poses).labelled_by(label.id);
        if step_button(ui, "Plan poses", next == Next::Plan, free) {
            let poses = panel.poses;
            outbox.send(RobotCommand::Plan(poses));
        }
        if planning {
            if ui.button("Cancel").clicked() {
                outbox.send(Command::CancelTask(PLANNING));
            }
            ui.spinner();
        }
    });
    ui.horizontal_wrapped(|ui| {
        if icon_button(ui, icons::ICON_UPLOAD_FILE, "Import plan…", free).clicked() {
            outbox.send(FileCommand::AskOpen);
        }
        let planned = model
            .open
            .as_ref()
            .is_some_and(|d| !d.session().plan.is_empty());
        if icon_button(ui, icons::ICON_DOWNLOAD, "Export plan…", planned).clicked() {
            outbox.send(RobotCommand::AskExport(Export::Plan));
        }
        let connected = model.link.is_connected() && free;
        let add = icon_button(ui, icons::ICON_ADD_LOCATION, "Add current pose", connected);
        let add = add.on_hover_text("Adds the last commanded pose");
        if add
            .on_disabled_hover_text("Connect the controller first; not available during a run")
            .clicked()
        {
            outbox.send(RobotCommand::AddCurrent);
        }
    });
    outlook::show(ui, model, panel);
}

//! Panel of the phase Measuring: poses, controller, run.

mod asking;
pub mod controller;
mod distances;
pub(in crate::screens) mod motion;
mod outlook;
mod poses;
mod readings;
mod run;
mod table;
mod until;

use egui::{Button, DragValue, Ui};
use egui_material_icons::icons;
use tautline_core::planning::USUAL_POSES;
use tautline_session::PlannedPose;

use crate::model::command::Outbox;
use crate::model::command::{Command, Export, FileCommand, PLANNING, RobotCommand};
use crate::model::next_step::no_home;
use crate::model::{Memo, Model, OpenSession};
use crate::widgets::{UiExt, icon_button};
use tautline_workflow::clock;
use tautline_workflow::report::overdue;

/// State of the panel between frames.
#[derive(Debug)]
pub struct PanelState {
    /// Number of poses to plan.
    pub poses: usize,
    /// Goal for the standard deviation of the entry points (mm).
    goal_mm: f64,
    /// Plan for which a prediction was requested, and the id of its session.
    asked: Option<(u64, Vec<PlannedPose>)>,
    /// Rows of the table of poses, by session and revision.
    rows: Memo<(u64, u64), Vec<poses::PoseRow>>,
    /// Number of measured poses of a plan, by session, revision and length of the plan.
    done: Memo<(u64, u64, usize), usize>,
    /// Pose to which the table was scrolled last.
    scrolled_to: Option<i64>,
    /// Typed laser distance.
    typed: asking::DistanceInput,
    /// Whether the matrix of faults is open.
    shows_faults: bool,
    until: until::UntilState,
    distances: distances::DistancesInput,
}

impl Default for PanelState {
    fn default() -> Self {
        Self {
            poses: USUAL_POSES,
            goal_mm: 1.0,
            asked: None,
            rows: Memo::default(),
            done: Memo::default(),
            scrolled_to: None,
            typed: asking::DistanceInput::default(),
            shows_faults: false,
            until: until::UntilState::default(),
            distances: distances::DistancesInput::default(),
        }
    }
}

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    ui.heading("Measuring");
    if model.link.is_under_way() {
        // While the robot moves, nothing else needs attention.
        return run::under_way(ui, model, panel, outbox);
    }
    ui.muted("The robot visits poses that determine its pulleys well; at each it stops and all sensors are read.");
    ask(model, panel, outbox);
    instruments(ui, model);
    plan(ui, model, panel, outbox);
    controller::show(ui, model, outbox);
    run::show(ui, model, panel, outbox);
    ui.scope(|ui| table::show(ui, model, panel, outbox));
    distances::show(ui, model, &mut panel.distances, outbox);
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
    let has_poses = plan.iter().any(|pose| pose.label != 0) && !open.decides_on_poses();
    if model.outlook.is_none() && !was_asked && has_poses && !is_busy {
        panel.asked = Some((open.id(), plan.clone()));
        outbox.send(RobotCommand::Expect);
    }
}

/// Warns of instruments that the robot lacks, and of overdue calibrations.
fn instruments(ui: &mut Ui, model: &Model) {
    let Some(open) = &model.open else {
        return;
    };
    let robot = &open.session().robot;
    let used = &open.session().settings.certificate.instruments;
    let instruments = match used.is_empty() {
        true => &model.preferences.report.instruments,
        false => used,
    };
    for text in overdue(instruments, clock::now()) {
        ui.doubtful(&text);
    }
    if robot.laser.is_none() {
        ui.doubtful("This robot has no laser distance sensor. Without it the height of the platform and the size of the frame \
             are poorly determined. Mount one and add it to the robot description, or expect large standard deviations.");
    }
    if !robot.has_force_sensors() {
        ui.doubtful(
            "This robot has no force sensors: elongation and sag of the cables are not corrected.",
        );
    }
    if let Some(problem) = no_home(open) {
        ui.bad(&problem.text);
    }
}

fn plan(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    ui.section("Poses to measure");
    until::settings(ui, model, &mut panel.until, outbox);
    let open = model.open.as_ref();
    if open.is_some_and(OpenSession::decides_on_poses) {
        return;
    }
    let planning = model.tasks.runs(PLANNING);
    let free = !planning && !model.link.is_busy();
    ui.horizontal(|ui| {
        let label = ui.label("Number");
        let poses = DragValue::new(&mut panel.poses).range(1..=500);
        ui.add(poses).labelled_by(label.id);
        if ui.add_enabled(free, Button::new("Plan poses")).clicked() {
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
        let planned = open.is_some_and(|open| !open.session().plan.is_empty());
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

/// Name of a cable; empty without a session.
fn name_of(model: &Model, cable: usize) -> &str {
    let open = model.open.as_ref();
    let cable = open.and_then(|d| d.session().robot.cables.get(cable));
    cable.map_or("", |cable| cable.name.as_str())
}

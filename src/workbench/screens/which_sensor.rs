//! *Which sensor?*: sliders for sensors and number of poses, with the expected accuracy.

use egui::{Button, Grid, Rangef, ScrollArea, Slider, TextEdit, Ui};
use tautline_core::robot::{Robot, presets};
use tautline_study::which_sensor::{Advisor, Answer, MOST_POSES, Question};
use tautline_workflow::plot::Selection;
use tautline_workflow::plot::figure::{Axis, Curve, Figure, Ink, Marker, Point, Series};
use tautline_workflow::wording::units::{fixed, significant};

use crate::model::Model;
use crate::model::command::{AskedRobot, Outbox, SIMULATING, StudyCommand, ViewCommand};
use crate::theme::GRID;
use crate::views::plots::small;
use crate::widgets::{UiExt, checkbox, form};

#[derive(Debug, Default)]
pub struct PanelState {
    asked: Option<SensorQuestion>,
}

/// Robot with the last question and its answer.
#[derive(Debug)]
struct SensorQuestion {
    robot: Robot,
    advisor: Result<Advisor, String>,
    question: Option<Question>,
    answer: Option<(Question, Result<Answer, String>)>,
    /// Typed folder of the study.
    folder: String,
}

impl SensorQuestion {
    fn new(robot: Robot) -> Self {
        let advisor = Advisor::new(&robot);
        Self {
            question: advisor.as_ref().ok().map(Advisor::question),
            advisor,
            robot,
            answer: None,
            folder: "which-sensor".to_owned(),
        }
    }
}

/// Smallest and greatest height of a plot (points).
const PLOT: Rangef = Rangef {
    min: 190.0,
    max: 360.0,
};
/// Width of the screen (points) below which the answer is below the sliders.
const NARROW: f32 = 720.0;
/// Width of the column of sliders, and of the folder's name in it (points).
const SLIDERS: f32 = 300.0;
const FOLDER: f32 = 190.0;

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let session = model.open.as_ref().map(|open| open.session());
    let Some(robot) = session
        .map(|session| session.robot.clone())
        .or_else(|| presets::find("mini").map(|mini| mini.robot))
    else {
        return;
    };
    let known = panel.asked.take().filter(|asked| asked.robot == robot);
    let asked = panel
        .asked
        .insert(known.unwrap_or_else(|| SensorQuestion::new(robot)));
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        egui::Frame::new().inner_margin(4.0 * GRID).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.heading("Which sensor?");
                ui.muted(&format!("for {}", asked.robot.name));
                if ui.button("Back").clicked() {
                    outbox.send(ViewCommand::Go(model.previous_screen()));
                }
            });
            ui.muted("The position error to expect once the identified values are at the controller: root mean square over the workspace. Standard deviations are 1 sd.");
            ui.add_space(2.0 * GRID);
            let running = model.tasks.runs(SIMULATING);
            contents(ui, asked, running, outbox);
        });
    });
}

fn contents(ui: &mut Ui, asked: &mut SensorQuestion, running: bool, outbox: &mut Outbox) {
    if asked.question.is_none() {
        if let Err(error) = &asked.advisor {
            ui.bad(error);
        }
        return;
    }
    let height = ui.available_height();
    let is_narrow = ui.available_width() < NARROW;
    if is_narrow {
        asking(ui, asked, running, outbox);
        ui.add_space(2.0 * GRID);
    }
    ui.horizontal_top(|ui| {
        if !is_narrow {
            ui.vertical(|ui| {
                ui.set_width(SLIDERS);
                asking(ui, asked, running, outbox);
            });
            ui.add_space(4.0 * GRID);
        }
        let (Ok(advisor), Some(question)) = (&asked.advisor, &asked.question) else {
            return;
        };
        let known = asked.answer.take();
        let known = known.filter(|(answered, _)| answered == question);
        let (_, answer) = asked
            .answer
            .insert(known.unwrap_or_else(|| (*question, advisor.answer(question))));
        ui.vertical(|ui| match answer {
            Ok(answer) => answered(ui, question, answer, height),
            Err(error) => {
                ui.bad(error);
            }
        });
    });
}

fn asking(ui: &mut Ui, asked: &mut SensorQuestion, running: bool, outbox: &mut Outbox) {
    if let Some(question) = &mut asked.question {
        sliders(ui, &asked.robot, question);
    }
    simulation(ui, asked, running, outbox);
}

/// Step that starts a study of the question in a folder.
fn simulation(ui: &mut Ui, asked: &mut SensorQuestion, running: bool, outbox: &mut Outbox) {
    ui.add_space(2.0 * GRID);
    ui.section("Simulation");
    let Some(question) = asked.question else {
        return;
    };
    let draft = || {
        Box::new(AskedRobot {
            robot: asked.robot.clone(),
            question,
        })
    };
    let label = ui.label("Folder of the study");
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut asked.folder).desired_width(FOLDER);
        ui.add(field).labelled_by(label.id);
        if ui.button("Browse…").clicked() {
            outbox.send(StudyCommand::Browse(draft()));
        }
    });
    let is_named = !asked.folder.trim().is_empty();
    let button = ui.add_enabled(is_named && !running, Button::new("Simulate"));
    if button.clicked() {
        let folder = asked.folder.trim().into();
        outbox.send(StudyCommand::Simulate(draft(), folder));
    }
    ui.muted("Simulates 400 calibrations for each combination of laser and number of poses, and writes a report. To add faults or \
         other robots, edit the study.toml in this folder and use the command study.");
}

/// Largest value of all sliders, in their units.
const MOST: f64 = 10.0;

fn sliders(ui: &mut Ui, robot: &Robot, question: &mut Question) {
    ui.section("Instruments");
    form("which sensor").show(ui, |ui| {
        if let Some(laser) = robot.laser {
            let sd_m = &mut question.laser_sd_m;
            optional(ui, "Laser", sd_m, laser.sd_m, 0.02, "mm");
        }
        let label = ui.label("Poses");
        ui.add(Slider::new(&mut question.poses, 3..=MOST_POSES).logarithmic(true))
            .labelled_by(label.id);
        ui.end_row();
        if robot.home.is_some_and(|home| home.position_sd_m > 0.0) {
            let label = ui.label("Home position");
            slider(ui, label.id, &mut question.home_sd_m, 0.005, "mm");
            ui.end_row();
        }
        let sd_rad = &mut question.inclinometer_sd_rad;
        optional(ui, "Inclinometer", sd_rad, 1e-3, 0.02, "mrad");
    });
}

/// Optional instrument with its default description.
fn optional(ui: &mut Ui, name: &str, value: &mut Option<f64>, usual: f64, least: f64, unit: &str) {
    let mut is_there = value.is_some();
    let label = checkbox(ui, &mut is_there, name);
    match (is_there, value.is_some()) {
        (true, false) => *value = Some(usual),
        (false, true) => *value = None,
        _ => {}
    }
    match value {
        Some(value) => slider(ui, label.id, value, least, unit),
        None => {
            ui.muted("none");
        }
    }
    ui.end_row();
}

fn slider(ui: &mut Ui, label: egui::Id, value: &mut f64, least: f64, unit: &str) {
    let mut shown = *value * 1e3;
    let slider = Slider::new(&mut shown, least..=MOST)
        .logarithmic(true)
        .suffix(format!(" {unit}"));
    let slider = slider.custom_formatter(|value, _| significant(value, 2));
    if ui.add(slider).labelled_by(label).changed() {
        *value = shown / 1e3;
    }
}

/// Answer in words, numbers and plots, with this total height.
fn answered(ui: &mut Ui, question: &Question, answer: &Answer, height: f32) {
    let top = ui.cursor().min.y;
    ui.section("Answer");
    ui.label(answer.sentence(question));
    if let Some(entry_m) = answer.entry_m {
        ui.muted(&format!(
            "Entry points: {} mm along each axis.",
            significant(1e3 * entry_m, 2)
        ));
    }
    ui.add_space(GRID);
    // Number of decimals that shows two digits of the smallest error.
    let errors = answer.changes.iter().filter_map(|(_, error)| *error);
    let least = errors.fold(f64::INFINITY, f64::min);
    let decimals = (1.0 - (1e3 * least).log10().floor()).clamp(0.0, 6.0) as usize;
    Grid::new("changes")
        .num_columns(2)
        .spacing([4.0 * GRID, GRID])
        .show(ui, |ui| {
            for (what, error) in &answer.changes {
                ui.label(format!("With {what}"));
                let text = error.map_or_else(
                    || "open".to_owned(),
                    |error| format!("{} mm", fixed(1e3 * error, decimals)),
                );
                ui.label(text);
                ui.end_row();
            }
        });
    ui.add_space(2.0 * GRID);
    let at = |x: f64| answer.position_m.map(|error| (x, error));
    let plots = if question.laser_sd_m.is_some() {
        2.0
    } else {
        1.0
    };
    let left = height - (ui.cursor().min.y - top) - plots * ui.spacing().item_spacing.y;
    let each = PLOT.clamp(left / plots);
    if let Some(sd_m) = question.laser_sd_m {
        let line = answer
            .over_laser
            .iter()
            .map(|(sd, error)| (1e3 * sd, *error));
        let figure = figure("Laser, 1 sd", "mm", line, at(1e3 * sd_m));
        let name = "Position error over the laser";
        small::show(ui, name, &figure, each, Selection::default());
    }
    let line = answer
        .over_poses
        .iter()
        .map(|(poses, error)| (*poses as f64, *error));
    let figure = figure("Poses", "", line, at(question.poses as f64));
    let name = "Position error over the number of poses";
    small::show(ui, name, &figure, each, Selection::default());
}

/// Plot with logarithmic axes, with a mark at the position of the sliders.
fn figure(
    label: &str,
    unit: &'static str,
    line: impl Iterator<Item = (f64, Option<f64>)>,
    marked: Option<(f64, f64)>,
) -> Figure {
    let axis = |label: &str, unit| Axis {
        is_logarithmic: true,
        ..Axis::new(label, unit)
    };
    let place = |x: f64, error: f64| [x.log10(), (1e3 * error).log10()];
    let points = marked.map(|(x, error)| {
        let [x, y] = place(x, error);
        Point::new(x, y)
    });
    Figure {
        x: axis(label, unit),
        y: axis("Position error", "mm"),
        curves: vec![Curve {
            name: String::new(),
            ink: Ink::Accent,
            dashed: false,
            points: line
                .filter_map(|(x, error)| Some(place(x, error?)))
                .collect(),
        }],
        series: vec![Series::new(
            "now",
            Ink::Warning,
            Marker::Diamond,
            points.into_iter().collect(),
        )],
        ..Figure::default()
    }
}

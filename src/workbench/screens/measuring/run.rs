//! The measuring run: buttons, progress, warnings.

use egui::{Button, CollapsingHeader, ScrollArea, Ui};
use egui_material_icons::icons;

use super::{PanelState, name_of};
use super::{asking, motion, readings, until};
use crate::model::Model;
use crate::model::command::Outbox;
use crate::model::command::{FileCommand, RobotCommand, ViewCommand};
use crate::model::link::LinkRequest;
use crate::model::link::{RunLog, RunStep};
use crate::model::messages::full_sentence;
use crate::model::next_step::failed_save;
use crate::theme::{self, GRID};
use crate::widgets::{UiExt, Verdict, icon_button};
use tautline_workflow::identification::RESIDUAL;
use tautline_workflow::wording::count_are;
use tautline_workflow::wording::units::signed;

/// Number of poses whose deviation from the prediction is listed.
const LISTED: usize = 4;

pub(super) fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let Some(open) = &model.open else {
        return;
    };
    let session = open.session();
    let missing = open.missing().len();
    let begun = !session.measurements.is_empty();
    let until = &session.settings.until;
    if session.plan.is_empty()
        && !until.enabled
        && model.link.run.is_none()
        && !model.link.is_connected()
    {
        return;
    }
    ui.section("Measuring run");
    if model.link.is_measuring() {
        buttons(ui, model, outbox);
        progress(ui, model, panel, outbox);
    } else {
        let undecidable = model.undecidable();
        let has_poses = match until.enabled {
            true => undecidable.is_none(),
            false => missing > 0,
        };
        let ready = model.link.is_armed() && has_poses && !model.link.is_busy();
        let text = if begun {
            "Continue measuring"
        } else {
            "Start measuring"
        };
        if missing > 0 || until.enabled {
            if ui.add_enabled(ready, Button::new(text)).clicked() {
                outbox.send(RobotCommand::Start);
            }
            if !model.link.is_armed() {
                ui.muted("Connect and arm the controller first.");
            } else if let Some(why) = undecidable {
                ui.muted(why);
            } else if begun && !until.enabled {
                ui.muted(&format!(
                    "{} not measured yet.",
                    count_are(missing, "planned pose")
                ));
            }
        } else if begun {
            ui.good("All planned poses are measured.");
        }
    }
    pending(ui, model, outbox);
    until::known(ui, model, &mut panel.until);
    if let Some(run) = &model.link.run {
        outcome(ui, run, outbox);
        surprises(ui, model, run);
    }
    warnings(ui, model, outbox);
    readings::show(ui, model, outbox);
}

/// Draws a run while the robot moves.
pub(super) fn under_way(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    buttons(ui, model, outbox);
    motion::position(ui, model);
    until::known(ui, model, &mut panel.until);
    motion::tensions(ui, model);
    progress(ui, model, panel, outbox);
    pending(ui, model, outbox);
    if let Some(run) = &model.link.run {
        surprises(ui, model, run);
    }
    warnings(ui, model, outbox);
}

fn buttons(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let Some(run) = &model.link.run else {
        return;
    };
    let (paused, current) = (run.paused.is_some(), run.current);
    ui.horizontal_wrapped(|ui| {
        if paused {
            let ready = model.link.is_armed();
            if ui.add_enabled(ready, Button::new("Resume")).clicked() {
                outbox.send(LinkRequest::Resume);
            }
        } else if icon_button(ui, icons::ICON_PAUSE, "Pause", true).clicked() {
            outbox.send(LinkRequest::Pause);
        }
        let skip = icon_button(ui, icons::ICON_SKIP_NEXT, "Skip pose", true);
        if skip.clicked() {
            outbox.send(LinkRequest::Skip);
        }
        let last = run.last_measured();
        let repeat = icon_button(ui, icons::ICON_REPLAY, "Repeat last pose", last.is_some());
        if let Some(label) = last.filter(|_| repeat.clicked()) {
            outbox.send(RobotCommand::Repeat(label));
        }
    });
    if let Some(reason) = &run.paused {
        let kind = if reason.contains("operator") {
            Verdict::Neutral
        } else {
            Verdict::Doubtful
        };
        ui.verdict(kind, &full_sentence(&format!("Waiting: {reason}")));
        if reason.contains("laser") {
            ui.muted("Clear the beam path and clean the target, then resume: the pose is approached again. Or skip it.");
        }
    } else if current.is_none() && run.until.is_none() {
        ui.muted("Starting.");
    }
}

fn progress(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let Some(run) = &model.link.run else {
        return;
    };
    let doing = match run.paused {
        Some(_) => RunStep::Nothing,
        None => model.link.live().doing,
    };
    if !matches!(doing, RunStep::Asking { .. }) {
        asking::forget(panel);
    }
    match doing {
        RunStep::Settling { rates, limits, .. } => readings::settling(ui, rates, limits),
        RunStep::Asking { label, expected_m } => asking::show(ui, panel, outbox, label, expected_m),
        _ => {}
    }
}

/// Measured pose that could not be stored.
fn pending(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let Some(problem) = failed_save(model) else {
        return;
    };
    ui.bad(&problem.text);
    if ui.button("Retry save").clicked() {
        outbox.send(RobotCommand::RetrySave);
    }
}

fn outcome(ui: &mut Ui, run: &RunLog, outbox: &mut Outbox) {
    let Some(Err(why)) = &run.ended else {
        return;
    };
    let next = match run.restarted {
        true => "Further measurements form a new series.",
        false => "The run can be continued.",
    };
    ui.doubtful(&format!(
        "The run ended after {}: {} Measured poses are kept. {next}",
        run.measured_in_words(),
        full_sentence(why)
    ));
    if run.restarted && ui.button("Begin a new series").clicked() {
        outbox.send(FileCommand::NewSeries(Vec::new()));
    }
}

/// Deviations of the last poses from the prediction, if the model predicts them.
fn surprises(ui: &mut Ui, model: &Model, run: &RunLog) {
    if run.surprises.is_empty() {
        return;
    }
    ui.section("Last poses");
    ui.muted(&format!("{RESIDUAL}:"));
    for surprise in run.surprises.iter().rev().take(LISTED) {
        let lengths = surprise.lengths_m.iter().enumerate();
        let worst = lengths
            .filter(|(_, off)| off.is_finite())
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        ui.horizontal_wrapped(|ui| {
            let place = match surprise.label {
                0 => "Home".to_owned(),
                label => format!("Pose {label}"),
            };
            ui.label(place);
            if let Some((cable, off_m)) = worst {
                ui.muted("length");
                ui.label(signed(off_m * 1e3, 1));
                ui.muted("mm on");
                readings::cable_mark(ui, cable, name_of(model, cable));
            }
            if let Some(laser_m) = surprise.laser_m {
                ui.muted("laser");
                ui.label(signed(laser_m * 1e3, 1));
                ui.muted("mm");
            }
        });
    }
}

/// Warnings, latest first, each with its cable.
fn warnings(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let Some(run) = model.link.run.as_ref().filter(|r| !r.warnings.is_empty()) else {
        return;
    };
    let title = match run.warnings.len() {
        1 => "1 warning".to_owned(),
        count => format!("{count} warnings"),
    };
    let mut chosen = None;
    let header = CollapsingHeader::new(egui::RichText::new(title).color(theme::of(ui).warning));
    header
        .id_salt("warnings")
        .default_open(true)
        .show(ui, |ui| {
            ScrollArea::vertical()
                .id_salt("list of warnings")
                .max_height(30.0 * GRID)
                .show(ui, |ui| {
                    for warning in run.warnings.iter().rev() {
                        ui.horizontal_top(|ui| {
                            if let Some(cable) = warning.cable
                                && readings::cable_link(ui, cable, name_of(model, cable))
                            {
                                chosen = Some(cable);
                            }
                            ui.wrapped(&warning.text);
                        });
                    }
                });
        });
    if let Some(cable) = chosen {
        outbox.send(ViewCommand::Select(model.selection.with_cable(cable)));
    }
}

//! Choice of the two sessions: by path, file dialog, or from a list.

use std::path::PathBuf;

use egui::{Align, Button, Label, Layout, RichText, Ui, vec2};
use egui_material_icons::icons;
use tautline_session::{Session, Timestamp};

use super::PanelState;
use crate::model::Model;
use crate::model::command::{CompareCommand, Outbox, ReportCommand, ViewCommand};
use crate::model::comparison::{SessionSource, Side};
use crate::theme::{self, GRID};
use crate::widgets::{icon_button, named, path_field};
use tautline_workflow::report::ReportFormat;
use tautline_workflow::samples::{self, Sample};
use tautline_workflow::wording::{recent_facts, session_facts};

/// Height of a row and width of the name before it (points).
const ROW: f32 = 7.0 * GRID;
const NAME: f32 = 5.0 * GRID;

/// Width (points) below which the title is short.
const NARROW: f32 = 560.0;

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    ui.horizontal(|ui| {
        let is_narrow = ui.available_width() < NARROW;
        ui.heading(if is_narrow {
            "Compare"
        } else {
            "Compare two sessions"
        });
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if icon_button(ui, icons::ICON_ARROW_BACK, "Back", true).clicked() {
                outbox.send(ViewCommand::Go(model.previous_screen()));
            }
            let is_compared = matches!(model.comparison.result(), Some(Ok(_)));
            let name = "Save report…";
            if icon_button(ui, icons::ICON_DESCRIPTION, name, is_compared).clicked() {
                outbox.send(ReportCommand::AskSave(ReportFormat::FOR_PAPER));
            }
            let is_any = Side::ALL
                .iter()
                .any(|side| model.comparison.source(*side).is_some());
            if icon_button(ui, icons::ICON_SWAP_VERT, "Swap A and B", is_any).clicked() {
                panel.paths.swap(0, 1);
                outbox.send(CompareCommand::Swap);
            }
        });
    });
    for side in Side::ALL {
        ui.add_space(GRID);
        let size = vec2(ui.available_width(), ROW);
        let layout = Layout::left_to_right(Align::Center);
        ui.allocate_ui_with_layout(size, layout, |ui| row(ui, model, panel, side, outbox));
    }
}

fn row(ui: &mut Ui, model: &Model, panel: &mut PanelState, side: Side, outbox: &mut Outbox) {
    let name = RichText::new(side.name()).font(theme::strong(16.0));
    let colour = theme::of(ui).accent;
    let label = Label::new(name.color(colour));
    ui.add_sized(vec2(NAME, ROW), label);
    match model.comparison.source(side) {
        Some(source) => {
            let path = &mut panel.paths[side as usize];
            chosen(ui, model, path, side, source, outbox);
        }
        None => choose(ui, model, panel, side, outbox),
    }
}

fn chosen(
    ui: &mut Ui,
    model: &Model,
    path: &mut String,
    side: Side,
    source: &SessionSource,
    outbox: &mut Outbox,
) {
    if named(ui.button("Change"), &format!("Change {}", side.name())).clicked() {
        // The path remains, for editing.
        if let SessionSource::File(chosen) = source {
            *path = chosen.display().to_string();
        }
        outbox.send(CompareCommand::Clear(side));
    }
    let run = match model.comparison.result() {
        Some(Ok(compared)) => Some(&compared.runs[side as usize]),
        _ => None,
    };
    let open = model.open.as_ref().map(|open| open.session());
    let known = run.map(|run| (&run.name, run.measured, run.fit.dataset.robot.label()));
    let known = known.or(open
        .filter(|_| *source == SessionSource::Open)
        .map(identity));
    if let Some((name, ..)) = known {
        ui.label(RichText::new(name).font(theme::strong(13.0)));
    }
    let place = match source {
        SessionSource::Open => "the open session".to_owned(),
        SessionSource::File(path) => path.display().to_string(),
    };
    let place = match known {
        Some((_, measured, robot)) => {
            format!(
                "{}, {place}",
                session_facts(measured, Some(&robot), None, None)
            )
        }
        None => place,
    };
    let place = RichText::new(place).color(theme::of(ui).muted);
    ui.add(Label::new(place).truncate());
}

/// Name of a session, time of its last measurement, and its robot.
fn identity(session: &Session) -> (&String, Option<Timestamp>, String) {
    (&session.name, session.measured(), session.robot.label())
}

fn choose(ui: &mut Ui, model: &Model, panel: &mut PanelState, side: Side, outbox: &mut Outbox) {
    let name = side.name();
    let path = &mut panel.paths[side as usize];
    let hint = "Path of a session or a dataset folder, or drop it on the window";
    let width = (ui.available_width() - 420.0).clamp(160.0, 560.0);
    let entered = path_field(ui, &format!("Path of {name}"), hint, path, width);
    let typed = !path.trim().is_empty();
    let take = named(
        ui.add_enabled(typed, Button::new("Use")),
        &format!("Use {name}"),
    );
    if (take.clicked() || entered) && typed {
        let source = SessionSource::File(PathBuf::from(path.trim()));
        outbox.send(CompareCommand::Choose(side, source));
    }
    let browse = icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true);
    if named(browse, &format!("Browse for {name}")).clicked() {
        outbox.send(CompareCommand::Ask(side));
    }
    let menu = ui.menu_button("Known sessions", |ui| {
        known(ui, model, &mut panel.samples, side, outbox);
    });
    named(menu.response, &format!("Known sessions for {name}"));
}

/// Menu of the open session, recent ones and samples.
fn known(
    ui: &mut Ui,
    model: &Model,
    samples: &mut Option<Vec<Sample>>,
    side: Side,
    outbox: &mut Outbox,
) {
    let samples = samples.get_or_insert_with(|| samples::find(&samples::places()));
    let recent = model.preferences.recent().iter();
    let recent = recent.filter(|recent| recent.exists());
    let open = model.open.iter().map(|open| {
        let (name, measured, robot) = identity(open.session());
        let facts = session_facts(measured, Some(&robot), None, open.path());
        (name.clone(), format!("open, {facts}"), SessionSource::Open)
    });
    let recent = recent.map(|recent| {
        let source = SessionSource::File(recent.path().to_owned());
        (recent.name.clone(), recent_facts(recent), source)
    });
    let samples = samples.iter().filter(|sample| !sample.is_record);
    let samples = samples.map(|sample| {
        let source = SessionSource::File(sample.session.clone());
        (sample.title.clone(), "sample".to_owned(), source)
    });
    let all: Vec<_> = open.chain(recent).chain(samples).collect();
    if all.is_empty() {
        ui.label("Sessions appear here once they were saved or opened.");
    }
    for (name, facts, source) in all {
        let place = match &source {
            SessionSource::File(path) => path.display().to_string(),
            SessionSource::Open => String::new(),
        };
        let button = Button::new(&name).shortcut_text(facts);
        if ui.add(button).on_hover_text(place).clicked() {
            outbox.send(CompareCommand::Choose(side, source));
            ui.close();
        }
    }
}

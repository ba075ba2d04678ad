//! Lines about files and the program.

use egui::Key;

use super::super::state::State;
use super::{CONTROL, CONTROL_SHIFT, Item, Menu, item};
use crate::model::command::{
    Command, CompareCommand, FileCommand, RecordCommand, RecordingCommand, ReportCommand,
    ViewCommand,
};
use crate::model::phase::Screen;
use tautline_workflow::report::ReportFormat;
use tautline_workflow::templates::Template;
use tautline_workflow::wording::recent_facts;

/// Most sessions that the menu offers to open again.
const RECENT: usize = 5;

fn file(title: impl Into<String>, command: impl Into<Command>) -> Item {
    item(Menu::File, title, command)
}

/// Sessions that are offered to be opened again.
fn recent(state: &State) -> Vec<Item> {
    let recent = state.model.preferences.recent().iter().take(RECENT);
    recent
        .map(|session| {
            let open = FileCommand::Open(session.path().to_owned());
            let title = format!("{} ({})", session.name, recent_facts(session));
            file(title, open).within("Open recent")
        })
        .collect()
}

pub fn lines(state: &State) -> Vec<Item> {
    let open = state.model.open.is_some();
    let session = state.model.open.as_ref().map(|open| open.session());
    let measured = session.is_some_and(|session| !session.measurements.is_empty());
    let is_compared = matches!(state.model.comparison.result(), Some(Ok(_)));
    let has_report = match state.model.screen {
        Screen::Compare => is_compared,
        Screen::Record => state.model.record.open().is_some(),
        _ => open,
    };
    let mut items = vec![
        file("Try the demo robot", FileCommand::TryDemo),
        file("Open…", FileCommand::AskOpen).keys(CONTROL, Key::O),
        file("Import…", RecordingCommand::Show),
    ];
    items.extend(recent(state));
    items.extend([
        file("Compare two sessions", CompareCommand::Show),
        file("Record of a robot", RecordCommand::Show),
        file("Save", FileCommand::Save)
            .keys(CONTROL, Key::S)
            .when(open),
        file("Save as…", FileCommand::AskSaveAs)
            .keys(CONTROL_SHIFT, Key::S)
            .when(open),
        file(
            "Save report as HTML…",
            ReportCommand::AskSave(ReportFormat::Html),
        )
        .when(has_report),
        file(
            match ReportFormat::Pdf.is_available() {
                true => "Save report as PDF…",
                false => "Save report as PDF (left out of this build)",
            },
            ReportCommand::AskSave(ReportFormat::Pdf),
        )
        .when(has_report && ReportFormat::Pdf.is_available()),
        file(
            "New series of this session",
            FileCommand::NewSeries(Vec::new()),
        )
        .when(measured),
        file("Close session", FileCommand::Close)
            .keys(CONTROL, Key::W)
            .when(open),
        file("Quit", FileCommand::Quit).keys(CONTROL, Key::Q),
    ]);
    let new = Template::ALL.map(|template| {
        let new = FileCommand::New(template);
        file(template.title(), new).within("New robot")
    });
    let blank = file("Empty table", ViewCommand::Go(Screen::NewRobot)).within("New robot");
    items.splice(3..3, new.into_iter().chain([blank]));
    items
}

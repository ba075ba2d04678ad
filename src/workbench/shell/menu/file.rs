//! Menu items for files and the program.

use egui::Key;

use super::super::state::AppState;
use super::{CONTROL, CONTROL_SHIFT, Menu, MenuItem};
use crate::model::command::{
    CompareCommand, FileCommand, RecordCommand, RecordingCommand, ReportCommand, ViewCommand,
};
use crate::model::phase::Screen;
use tautline_workflow::report::ReportFormat;
use tautline_workflow::templates::Template;
use tautline_workflow::wording::recent_facts;

/// Largest number of recent sessions in the menu.
const RECENT: usize = 5;
const GROUP: &str = "Open recent";

/// Menu items of recent sessions.
fn recent(state: &AppState) -> Vec<MenuItem> {
    let recent = state.model.preferences.recent().iter().take(RECENT);
    let recent = recent.map(|session| {
        let open = FileCommand::Open(session.path().to_owned());
        let title = format!("{} ({})", session.name, recent_facts(session));
        Menu::File.line(title, true, open).within(GROUP)
    });
    let mut items: Vec<MenuItem> = recent.collect();
    if items.is_empty() {
        // Keeps the position of the items below.
        let none = Menu::File.line("No session yet", false, FileCommand::AskOpen);
        items.push(none.within(GROUP));
    }
    items
}

pub fn lines(state: &AppState) -> Vec<MenuItem> {
    let open = state.model.open.is_some();
    let measured = state.model.measured().is_some();
    let is_compared = matches!(state.model.comparison.result(), Some(Ok(_)));
    let has_report = match state.model.screen {
        Screen::Compare => is_compared,
        Screen::Record => state.model.record.open().is_some(),
        _ => open,
    };
    let file =
        |title: &str, enabled, command: FileCommand| Menu::File.line(title, enabled, command);
    let report =
        |title, enabled, format| Menu::File.line(title, enabled, ReportCommand::AskSave(format));
    let pdf = ReportFormat::Pdf.is_available();
    let is_of_session = matches!(state.model.screen, Screen::Phase(_));
    let pdf_title = match pdf {
        true => "Save report as PDF…",
        false => "Save report as PDF (not in this build)",
    };
    let new = |template: Template| {
        file(template.title(), true, FileCommand::New(template)).within("New robot")
    };
    let blank = ViewCommand::Go(Screen::NewRobot);
    let mut items = vec![
        file("Try the demo robot", true, FileCommand::TryDemo),
        file("Open…", true, FileCommand::AskOpen).keys(CONTROL, Key::O),
        Menu::File.line("Import…", true, RecordingCommand::Show),
    ];
    items.extend(Template::ALL.map(new));
    items.push(
        Menu::File
            .line("Empty table", true, blank)
            .within("New robot"),
    );
    items.extend(recent(state));
    items.extend([
        Menu::File
            .line("Compare two sessions", true, CompareCommand::Show)
            .first(),
        Menu::File.line("Record of a robot", true, RecordCommand::Show),
        file("Save", open, FileCommand::Save)
            .keys(CONTROL, Key::S)
            .first(),
        file("Save as…", open, FileCommand::AskSaveAs).keys(CONTROL_SHIFT, Key::S),
        report("Save report as HTML…", has_report, ReportFormat::Html),
        report(pdf_title, has_report && pdf, ReportFormat::Pdf),
        report(
            "Save digital certificate (DCC)…",
            has_report && is_of_session,
            ReportFormat::Dcc,
        ),
        file(
            "New series of this session",
            measured,
            FileCommand::NewSeries(Vec::new()),
        ),
        file("Close session", open, FileCommand::Close)
            .keys(CONTROL, Key::W)
            .first(),
        file("Quit", true, FileCommand::Quit).keys(CONTROL, Key::Q),
    ]);
    items
}

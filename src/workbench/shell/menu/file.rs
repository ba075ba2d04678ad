//! Lines about files and the program.

use egui::Key;

use super::super::state::State;
use super::{CONTROL, CONTROL_SHIFT, Item, Menu, item, keys};
use crate::model::command::{
    CompareCommand, FileCommand, RecordCommand, RecordingCommand, ReportCommand, ViewCommand,
};
use crate::model::phase::Screen;
use tautline_workflow::report::ReportFormat;
use tautline_workflow::templates::Template;
use tautline_workflow::wording::recent_facts;

/// Most sessions that the menu offers to open again.
const RECENT: usize = 5;
/// Sessions that are offered to be opened again.
fn recent(state: &State) -> Vec<Item> {
    let recent = state.model.preferences.recent().iter().take(RECENT);
    recent
        .map(|session| {
            let open = FileCommand::Open(session.path().to_owned());
            let title = format!("{} ({})", session.name, recent_facts(session));
            item(Menu::File, title, None, true, open).within("Open recent")
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
        item(
            Menu::File,
            "Try the demo robot",
            None,
            true,
            FileCommand::TryDemo,
        ),
        item(
            Menu::File,
            "Open…",
            keys(CONTROL, Key::O),
            true,
            FileCommand::AskOpen,
        ),
        item(Menu::File, "Import…", None, true, RecordingCommand::Show),
    ];
    items.extend(recent(state));
    items.extend([
        item(
            Menu::File,
            "Compare two sessions",
            None,
            true,
            CompareCommand::Show,
        ),
        item(
            Menu::File,
            "Record of a robot",
            None,
            true,
            RecordCommand::Show,
        ),
        item(
            Menu::File,
            "Save",
            keys(CONTROL, Key::S),
            open,
            FileCommand::Save,
        ),
        item(
            Menu::File,
            "Save as…",
            keys(CONTROL_SHIFT, Key::S),
            open,
            FileCommand::AskSaveAs,
        ),
        item(
            Menu::File,
            "Save report as HTML…",
            None,
            has_report,
            ReportCommand::AskSave(ReportFormat::Html),
        ),
        item(
            Menu::File,
            match ReportFormat::Pdf.is_available() {
                true => "Save report as PDF…",
                false => "Save report as PDF (left out of this build)",
            },
            None,
            has_report && ReportFormat::Pdf.is_available(),
            ReportCommand::AskSave(ReportFormat::Pdf),
        ),
        item(
            Menu::File,
            "New series of this session",
            None,
            measured,
            FileCommand::NewSeries(Vec::new()),
        ),
        item(
            Menu::File,
            "Close session",
            keys(CONTROL, Key::W),
            open,
            FileCommand::Close,
        ),
        item(
            Menu::File,
            "Quit",
            keys(CONTROL, Key::Q),
            true,
            FileCommand::Quit,
        ),
    ]);
    let new = Template::ALL.map(|template| {
        let new = FileCommand::New(template);
        item(Menu::File, template.title(), None, true, new).within("New robot")
    });
    let blank = item(
        Menu::File,
        "Empty table",
        None,
        true,
        ViewCommand::Go(Screen::NewRobot),
    )
    .within("New robot");
    items.splice(3..3, new.into_iter().chain([blank]));
    items
}

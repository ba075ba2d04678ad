//! Lines about files and the program.

use egui::Key;

use super::super::state::State;
use super::{CONTROL, CONTROL_SHIFT, Item, Menu, item, keys};
use crate::model::command::{CompareCommand, FileCommand, RecordingCommand, ReportCommand};
use crate::model::phase::Screen;
use tautline_workflow::report::ReportFormat;
use tautline_workflow::templates::Template;

/// Most sessions that the menu offers to open again.
const RECENT: usize = 5;
/// Sessions that are offered to be opened again.
fn recent(state: &State) -> Vec<Item> {
    let recent = state.model.preferences.recent().iter();
    recent
        .take(RECENT)
        .map(|session| {
            item(
                Menu::File,
                format!("Open recent: {}", session.name),
                None,
                true,
                FileCommand::Open(session.path().to_owned()),
            )
        })
        .collect()
}

/// All of them.
pub fn lines(state: &State) -> Vec<Item> {
    let open = state.model.open.is_some();
    let session = state.model.open.as_ref().map(|open| open.session());
    let measured = session.is_some_and(|session| !session.measurements.is_empty());
    let is_compared = matches!(state.model.comparison.result(), Some(Ok(_)));
    let has_report = match state.model.screen {
        Screen::Compare => is_compared,
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
            "Save report as PDF…",
            None,
            has_report,
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
        let title = format!("New robot: {}", template.title().to_lowercase());
        item(Menu::File, title, None, true, FileCommand::New(template))
    });
    items.splice(3..3, new);
    items
}

//! The window that connects: which controller, where it is, its symbols, the laser.

mod draft;
mod entry;
mod field;
mod laser;
mod symbols;
mod test_line;

use egui::{Grid, Id, Modal, ScrollArea, Ui};
use egui_material_icons::icons;
use tautline_session::{AdsMapping, Connection, ControllerKind, LaserSettings, LastConnection};

use self::draft::{Field, Part, Present, Problems};
use self::field::line;
use self::symbols::SymbolRows;
use crate::model::command::{CHECKING, RobotCommand, Setup};
use crate::model::edit::Edit;
use crate::shell::State;
use crate::theme::GRID;
use crate::widgets::{TabOf, Verdict, heading, icon_button, muted, primary, tab_row, verdict};

pub use draft::Draft;

/// Width of the window (points), where there is room.
const WIDTH: f32 = 920.0;
/// Height around what scrolls (points).
const AROUND: f32 = 210.0;

/// Draws the window while it is open.
pub fn show(ui: &mut Ui, state: &mut State) {
    let Some(mut draft) = state.panels.connect.take() else {
        return;
    };
    let open = state.model.open.as_ref();
    let Some(present) = open
        .filter(|open| open.id() == draft.session_id)
        .map(|open| Present::of(open.session()))
    else {
        return;
    };
    let mut open = true;
    let modal = Modal::new(Id::unique("connect")).show(ui.ctx(), |ui| {
        let room = ui.ctx().content_rect().size();
        ui.set_width(WIDTH.min(room.x - 12.0 * GRID));
        heading(ui, "Connect to a controller");
        tabs(ui, &mut draft);
        let settings = draft.settings(&present);
        let problems = settings.as_ref().err().cloned().unwrap_or_default();
        let height = (room.y - AROUND).clamp(80.0, 480.0);
        ScrollArea::both()
            .id_salt(draft.part.title())
            .auto_shrink([false, false])
            .max_height(height)
            .show(ui, |ui| part(ui, state, &mut draft, (&present, &problems)));
        ui.add_space(GRID);
        open = footer(ui, state, &mut draft, settings, &present);
    });
    if open && !modal.should_close() {
        state.panels.connect = Some(draft);
    }
}

fn tabs(ui: &mut Ui, draft: &mut Draft) {
    let is_ads = draft.kind == ControllerKind::Ads;
    if !is_ads && draft.part == Part::Symbols {
        draft.part = Part::Controller;
    }
    let tabs = [Part::Controller, Part::Symbols, Part::Laser].map(|part| TabOf {
        value: part,
        title: part.title(),
        missing: (part == Part::Symbols && !is_ads)
            .then_some("Only a Beckhoff controller has symbols"),
    });
    tab_row(ui, "More", &tabs, &mut draft.part);
    ui.separator();
}

fn part(
    ui: &mut Ui,
    state: &mut State,
    draft: &mut Draft,
    (present, problems): (&Present, &Problems),
) {
    match draft.part {
        Part::Controller => controller(ui, state, draft, (present, problems)),
        Part::Symbols => symbols(ui, state, draft, (present, problems)),
        Part::Laser => {
            let busy = state.model.link.is_connected() || state.model.link.connecting;
            draft.laser.show(ui, problems, busy);
        }
    }
}

fn controller(
    ui: &mut Ui,
    state: &mut State,
    draft: &mut Draft,
    (present, problems): (&Present, &Problems),
) {
    for (kind, text) in [
        (ControllerKind::Simulated, "Simulated robot"),
        (ControllerKind::Recording, "Recording"),
        (ControllerKind::Ads, "Beckhoff controller (ADS)"),
    ] {
        ui.radio_value(&mut draft.kind, kind, text);
    }
    ui.add_space(GRID);
    let grid = |name| {
        Grid::new(name)
            .num_columns(2)
            .spacing([3.0 * GRID, 1.5 * GRID])
    };
    match draft.kind {
        ControllerKind::Simulated => {
            let text = match present.is_demo {
                true => "The robot of the demonstration: its hidden fault is in what it reads.",
                false => {
                    "A robot that moves as its description says. What it reads is not of the real robot."
                }
            };
            wrapped(ui, text);
        }
        ControllerKind::Recording => {
            let text = "A dataset folder with robot.json and poses.csv is played back. It knows the recorded poses alone, \
                        and nothing can be written to it.";
            wrapped(ui, text);
            grid("recording").show(ui, |ui| {
                let hint = "Path of the dataset";
                line(
                    ui,
                    ("Folder", hint),
                    &mut draft.folder,
                    problems.of(Field::Folder),
                );
                line(
                    ui,
                    ("Speed", "1"),
                    &mut draft.speed,
                    problems.of(Field::Speed),
                );
            });
            if icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true).clicked() {
                state.outbox.send(RobotCommand::Setup(Setup::PickRecording));
            }
        }
        ControllerKind::Ads => {
            grid("ads").show(ui, |ui| {
                for (name, hint, text, field) in [
                    ("Host", "192.168.0.5", &mut draft.host, Field::Host),
                    ("Port", "48898", &mut draft.port, Field::Port),
                    (
                        "AMS Net ID",
                        "192.168.0.5.1.1",
                        &mut draft.net_id,
                        Field::NetId,
                    ),
                    ("AMS port", "851", &mut draft.ams_port, Field::AmsPort),
                    ("Longest wait (s)", "1", &mut draft.timeout, Field::Timeout),
                ] {
                    line(ui, (name, hint), text, problems.of(field));
                }
            });
            wrapped(
                ui,
                "The controller needs a route to this computer, and the program of docs/ADS.md or symbols of its own. \
                 Nothing moves and nothing is written before it is armed.",
            );
        }
    }
}

fn wrapped(ui: &mut Ui, text: &str) {
    let colour = crate::theme::of(ui).muted;
    let text = egui::RichText::new(text).color(colour);
    ui.add(egui::Label::new(text).wrap());
}

fn symbols(
    ui: &mut Ui,
    state: &mut State,
    draft: &mut Draft,
    (present, problems): (&Present, &Problems),
) {
    let robot = &present.robot;
    let was_own = draft.own;
    ui.radio_value(&mut draft.own, false, "The names of the sample program");
    ui.radio_value(&mut draft.own, true, "Names of one's own");
    if was_own && !draft.own {
        draft.symbols = SymbolRows::of(&AdsMapping::default_for(robot), robot);
    }
    let mut unused = Problems::default();
    let place = draft.place(&mut unused);
    let mapping = draft.symbols.mapping(robot, &mut unused);
    let checking = state.model.tasks.runs(CHECKING);
    let free = !state.model.link.is_connected() && !state.model.link.connecting && !checking;
    ui.horizontal_wrapped(|ui| {
        let can = free && place.is_some() && mapping.is_some();
        let check = icon_button(ui, icons::ICON_FACT_CHECK, "Check symbols", can);
        let check = check
            .on_hover_text(
                "Connects, looks every symbol up and ends the connection; nothing is written",
            )
            .on_disabled_hover_text(
                "Needs a host and a Net ID, names without mistakes, and no connection",
            );
        if let (true, Some(place), Some(mapping)) = (check.clicked(), &place, &mapping) {
            let order = Setup::Check(Box::new((place.clone(), mapping.clone())));
            state.outbox.send(RobotCommand::Setup(order));
        }
        if icon_button(ui, icons::ICON_UPLOAD_FILE, "Import names…", true).clicked() {
            state.outbox.send(RobotCommand::Setup(Setup::AskImport));
        }
        let export = icon_button(ui, icons::ICON_DOWNLOAD, "Export names…", mapping.is_some());
        if let (true, Some(mapping)) = (export.clicked(), mapping) {
            let order = Setup::AskExport(Box::new(mapping));
            state.outbox.send(RobotCommand::Setup(order));
        }
        if checking {
            ui.spinner();
        }
    });
    if let Some((kind, text)) = draft.symbols.summary() {
        verdict(ui, kind, &text);
    }
    if let Some(text) = problems.of(Field::Symbols) {
        verdict(
            ui,
            Verdict::Bad,
            &tautline_workflow::wording::sentence(&format!("{text}.")),
        );
    }
    let own = draft.own;
    draft.symbols.show(ui, own, problems);
}

/// Why it cannot connect, and its buttons; whether it stays open.
fn footer(
    ui: &mut Ui,
    state: &mut State,
    draft: &mut Draft,
    settings: Result<(Connection, LaserSettings), Problems>,
    present: &Present,
) -> bool {
    let busy = state.model.link.is_busy();
    let why = match &settings {
        _ if state.model.link.connecting => Some("Connecting…".to_owned()),
        _ if busy => {
            Some("A run is under way: end it before another controller is connected.".to_owned())
        }
        Err(problems) => problems.first().map(|(field, text)| {
            let place = field.part().title();
            format!("Not ready to connect: {place}: {text}.")
        }),
        Ok(_) => None,
    };
    match (&why, &draft.refused) {
        (Some(text), _) => verdict(ui, Verdict::Neutral, text),
        (None, Some(text)) => verdict(ui, Verdict::Bad, text),
        (None, None) => {
            muted(ui, "The settings are kept in the session.");
        }
    }
    let mut open = true;
    ui.horizontal(|ui| {
        let connect = primary(ui, "Connect", why.is_none()).clicked();
        let keep = ui.add_enabled(
            settings.is_ok() && !busy,
            egui::Button::new("Keep settings"),
        );
        let keep = keep.clicked();
        if let (true, Ok((connection, laser))) = (connect || keep, settings) {
            keep_settings(state, present, connection, laser);
            draft.refused = None;
            if connect {
                draft.connects = true;
                draft.laser.release();
                state.outbox.send(RobotCommand::Connect);
            }
            open = connect;
        }
        if ui.button("Cancel").clicked() {
            open = false;
        }
    });
    open
}

/// Stores the settings in the session, and for the next one in the preferences.
fn keep_settings(
    state: &mut State,
    present: &Present,
    connection: Connection,
    laser: LaserSettings,
) {
    let reached = LastConnection {
        place: connection.place.clone(),
        laser: laser.clone(),
    };
    if !connection.is_empty() && state.model.preferences.last_connection != reached {
        state
            .model
            .change_preferences(|preferences| preferences.last_connection = reached);
    }
    if connection != present.connection || laser != present.laser {
        let settings = Box::new((connection, laser));
        state.outbox.send(Edit::SetConnection(settings));
    }
}

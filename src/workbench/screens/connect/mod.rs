//! Connection dialog: kind and address of the controller, its symbols, the laser.

mod draft;
mod entry;
mod field;
mod laser;
mod names;
mod problems;
mod symbols;
mod test_line;

use egui::{ScrollArea, Ui};
use egui_material_icons::icons;
use tautline_link::opcua::{HAS_KEYRING, Password, PasswordStoreError};
use tautline_session::{Connection, ControllerKind, LaserSettings, OpcUaPolicy, OpcUaSecurity};
use tautline_workflow::controllers::PASSWORD;
use tautline_workflow::wording::sentence;

use self::draft::{PresentSettings, SignIn};
use self::field::{file, line, secret};
use self::names::default_names;
use self::problems::{DialogTab, FieldId, Problems};
use self::symbols::SymbolRows;
use crate::model::command::{CHECKING, Outbox, RobotCommand, Setup, UserFile};
use crate::model::messages::full_sentence;
use crate::model::{ConnectionRequest, Model};
use crate::theme::{self, GRID};
use crate::widgets::{
    TabOf, UiExt, checkbox, choice, combo_box, form, icon_button, modal, primary, tab_row,
};

pub use draft::Draft;

/// Width of the dialog (points), if it fits.
const WIDTH: f32 = 920.0;
/// Height outside of the scrolled area (points).
const AROUND: f32 = 210.0;

/// Carries out the request of a command.
pub fn apply(dialog: &mut Option<Box<Draft>>, request: ConnectionRequest, model: &Model) {
    let Some(open) = &model.open else {
        return;
    };
    match (request, dialog.as_mut()) {
        (ConnectionRequest::Open, _) => {
            let draft = Draft::of(
                open.session(),
                open.id(),
                &model.preferences.last_connection,
            );
            *dialog = Some(Box::new(draft));
        }
        (ConnectionRequest::Close, _) => *dialog = None,
        (ConnectionRequest::Connected, _) => drop(dialog.take_if(|draft| draft.connects)),
        (ConnectionRequest::Refuse(text), Some(draft)) => {
            draft.refused = Some(text);
            draft.connects = false;
        }
        (ConnectionRequest::AskTrust(server), draft) => {
            let connects = draft.as_ref().is_none_or(|draft| draft.connects);
            // The dialog opens for the question if it was closed.
            let draft = dialog.get_or_insert_with(|| {
                let last = &model.preferences.last_connection;
                Box::new(Draft::of(open.session(), open.id(), last))
            });
            draft.untrusted = Some((server, connects));
            draft.connects = false;
        }
        (ConnectionRequest::SetFolder(folder), Some(draft)) => {
            draft.folder = folder.display().to_string();
        }
        (ConnectionRequest::SetUserFile(which, path), Some(draft)) => {
            draft.set_user_file(which, &path);
        }
        (ConnectionRequest::ShowChecked(checked), Some(draft)) => {
            draft.names_mut().rows.checked = Some(checked);
        }
        (ConnectionRequest::UseSymbols(mapping), Some(draft)) => {
            draft.use_symbols(&mapping, &open.session().robot);
        }
        (_, None) => {}
    }
}

/// Draws the dialog while it is open.
pub fn show(ui: &mut Ui, model: &Model, dialog: &mut Option<Box<Draft>>, outbox: &mut Outbox) {
    let Some(mut draft) = dialog.take() else {
        return;
    };
    let Some(present) = model
        .open
        .as_ref()
        .filter(|open| open.id() == draft.session_id)
        .map(|open| PresentSettings::of(open.session()))
    else {
        return;
    };
    let (is_open, is_left) = modal(ui, "connect", WIDTH, |ui| {
        let room = ui.ctx().content_rect().height();
        ui.heading("Connect to a controller");
        tabs(ui, &mut draft);
        let settings = draft.settings(&present);
        draft.problems = settings.as_ref().err().cloned().unwrap_or_default();
        let height = (room - AROUND).clamp(80.0, 480.0);
        ScrollArea::both()
            .id_salt(draft.part.title())
            .auto_shrink([false, false])
            .max_height(height)
            .show(ui, |ui| match draft.part {
                DialogTab::Controller => controller(ui, &mut draft, present.is_demo, outbox),
                DialogTab::Symbols => symbols(ui, model, &mut draft, &present, outbox),
                DialogTab::Laser => {
                    let busy = model.link.is_connected() || model.link.connecting;
                    draft.laser.show(ui, &draft.problems, busy);
                }
            });
        ui.add_space(GRID);
        footer(ui, model, &mut draft, settings, outbox)
    });
    if is_open && !is_left {
        *dialog = Some(draft);
    }
}

fn tabs(ui: &mut Ui, draft: &mut Draft) {
    let has_symbols = matches!(draft.kind, ControllerKind::Ads | ControllerKind::OpcUa);
    if !has_symbols && draft.part == DialogTab::Symbols {
        draft.part = DialogTab::Controller;
    }
    let tabs = [DialogTab::Controller, DialogTab::Symbols, DialogTab::Laser].map(|part| TabOf {
        value: part,
        title: part.title(),
        missing: (part == DialogTab::Symbols && !has_symbols)
            .then_some("Only a real controller has symbols"),
    });
    tab_row(ui, "More", &tabs, &mut draft.part);
    ui.separator();
}

fn controller(ui: &mut Ui, draft: &mut Draft, is_demo: bool, outbox: &mut Outbox) {
    for (kind, text) in [
        (ControllerKind::Simulated, "Simulated robot"),
        (ControllerKind::Recording, "Recording"),
        (ControllerKind::Ads, "Beckhoff controller (ADS)"),
        (ControllerKind::OpcUa, "Controller with OPC UA"),
    ] {
        choice(ui, &mut draft.kind, kind, text);
    }
    ui.add_space(GRID);

    match draft.kind {
        ControllerKind::Simulated => {
            let text = match is_demo {
                true => "Demo robot. A fault is hidden in its readings.",
                false => "A robot that moves as its description says. Its readings are simulated.",
            };
            wrapped(ui, text);
        }
        ControllerKind::Recording => {
            let text = "A dataset folder with robot.json and poses.csv is played back. It knows the recorded poses alone, \
                        and nothing can be written to it.";
            wrapped(ui, text);
            form("recording").show(ui, |ui| {
                line(ui, &draft.problems, FieldId::Folder, &mut draft.folder);
                line(ui, &draft.problems, FieldId::Speed, &mut draft.speed);
            });
            if icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true).clicked() {
                outbox.send(RobotCommand::Setup(Setup::PickRecording));
            }
        }
        ControllerKind::Ads => {
            form("ads").show(ui, |ui| {
                line(ui, &draft.problems, FieldId::Host, &mut draft.host);
                line(ui, &draft.problems, FieldId::Port, &mut draft.port);
                line(ui, &draft.problems, FieldId::NetId, &mut draft.net_id);
                line(ui, &draft.problems, FieldId::AmsPort, &mut draft.ams_port);
                line(ui, &draft.problems, FieldId::Timeout, &mut draft.timeout);
            });
            wrapped(
                ui,
                "The controller needs a route to this computer, and the program of docs/ADS.md or symbols of its own. \
                 Nothing moves and nothing is written before it is armed.",
            );
        }
        ControllerKind::OpcUa => opcua(ui, draft, outbox),
    }
}

fn opcua(ui: &mut Ui, draft: &mut Draft, outbox: &mut Outbox) {
    form("opcua").show(ui, |ui| {
        line(ui, &draft.problems, FieldId::Url, &mut draft.url);
        let all = &OpcUaSecurity::ALL;
        chosen(ui, "Security", &mut draft.security, all, None);
        let problem = draft.problems.of(FieldId::Policy);
        chosen(ui, "Policy", &mut draft.policy, &OpcUaPolicy::ALL, problem);
        user(ui, draft, outbox);
        line(
            ui,
            &draft.problems,
            FieldId::UrlTimeout,
            &mut draft.url_timeout,
        );
    });
    if draft.security == Some(OpcUaSecurity::None) {
        let text = "Not encrypted: everybody on the network can read and change the messages.";
        ui.neutral(text);
    }
    wrapped(
        ui,
        "By default, the best security that the server offers is used. A session keeps the name or the paths, never a password or a key. docs/OPC-UA.md says what the controller has to allow. Nothing moves and nothing is written before it is armed.",
    );
}

/// Grid rows for the authentication of the user.
fn user(ui: &mut Ui, draft: &mut Draft, outbox: &mut Outbox) {
    ui.label("Sign in");
    ui.horizontal_wrapped(|ui| {
        for (sign_in, text) in [
            (SignIn::Anonymous, "Anonymous"),
            (SignIn::Name, "Name and password"),
            (SignIn::Certificate, "Certificate"),
        ] {
            choice(ui, &mut draft.sign_in, sign_in, text);
        }
    });
    ui.end_row();
    match draft.sign_in {
        SignIn::Anonymous => {}
        SignIn::Name => {
            line(ui, &draft.problems, FieldId::User, &mut draft.user);
            let hint = format!("{PASSWORD}, or kept");
            secret(ui, ("Password", &hint), draft.password.text_mut());
            keeping(ui, draft, outbox);
        }
        SignIn::Certificate => {
            let (problems, field) = (&draft.problems, FieldId::UserCertificate);
            if file(
                ui,
                problems,
                field,
                "Choose certificate…",
                &mut draft.certificate,
            ) {
                let pick = Setup::PickUserFile(UserFile::Certificate);
                outbox.send(RobotCommand::Setup(pick));
            }
            if file(
                ui,
                problems,
                FieldId::UserKey,
                "Choose key…",
                &mut draft.key,
            ) {
                outbox.send(RobotCommand::Setup(Setup::PickUserFile(UserFile::Key)));
            }
        }
    }
}

/// Grid row for passwords stored on this computer.
fn keeping(ui: &mut Ui, draft: &mut Draft, outbox: &mut Outbox) {
    ui.label("");
    ui.horizontal_wrapped(|ui| {
        let missing = PasswordStoreError::NotBuilt.to_string();
        ui.add_enabled_ui(HAS_KEYRING, |ui| {
            let text = "Remember the password on this computer";
            checkbox(ui, &mut draft.keeps_password, text)
                .on_hover_text("In the keyring of the desktop, once the controller has accepted it")
                .on_disabled_hover_text(full_sentence(&missing));
        });
        let account = draft.account().filter(|_| HAS_KEYRING);
        let forget = egui::Button::new("Forget it");
        let forget = ui.add_enabled(account.is_some(), forget);
        let forget = forget
            .on_hover_text("Removes the password of this user from the keyring of the desktop")
            .on_disabled_hover_text(match HAS_KEYRING {
                true => "Needs an address and a user".to_owned(),
                false => full_sentence(&missing),
            });
        if let (true, Some(account)) = (forget.clicked(), account) {
            draft.password = Password::default();
            draft.keeps_password = false;
            outbox.send(RobotCommand::Setup(Setup::ForgetPassword(account)));
        }
    });
    ui.end_row();
}

/// Grid row with a choice from all values, or the best one offered by the server.
fn chosen<T: Copy + PartialEq + std::fmt::Display>(
    ui: &mut Ui,
    name: &str,
    value: &mut Option<T>,
    all: &[T],
    problem: Option<&str>,
) {
    const BEST: &str = "The best that the server offers";
    ui.label(name);
    ui.vertical(|ui| {
        let text = value.map_or_else(|| BEST.to_owned(), |value| value.to_string());
        let list = egui::ComboBox::from_id_salt(name).width(240.0);
        combo_box(ui, list, &format!("{name}: {text}"), &text, |ui| {
            ui.selectable_value(value, None, BEST);
            for known in all.iter().rev() {
                ui.selectable_value(value, Some(*known), known.to_string());
            }
        });
        if let Some(problem) = problem {
            ui.bad(&sentence(&format!("{problem}.")));
        }
    });
    ui.end_row();
}

fn wrapped(ui: &mut Ui, text: &str) {
    let colour = theme::of(ui).muted;
    let text = egui::RichText::new(text).color(colour);
    ui.wrapped(text);
}

fn symbols(
    ui: &mut Ui,
    model: &Model,
    draft: &mut Draft,
    present: &PresentSettings,
    outbox: &mut Outbox,
) {
    let robot = &present.robot;
    let kind = draft.kind;
    let names = draft.names_mut();
    let was_custom = names.is_custom;
    choice(
        ui,
        &mut names.is_custom,
        false,
        "Names of the sample program",
    );
    choice(ui, &mut names.is_custom, true, "Custom names");
    if was_custom && !names.is_custom {
        names.rows = SymbolRows::of(&default_names(kind, robot), robot);
    }
    let mut unused = Problems::default();
    let mapping = names.rows.mapping(robot, &mut unused);
    let settings = draft.settings(present);
    let checking = model.tasks.runs(CHECKING);
    let free = !model.link.is_connected() && !model.link.connecting && !checking;
    ui.horizontal_wrapped(|ui| {
        let can = free && settings.is_ok();
        let check = icon_button(ui, icons::ICON_FACT_CHECK, "Check symbols", can);
        let check = check
            .on_hover_text(
                "Connects, looks every symbol up and ends the connection; nothing is written",
            )
            .on_disabled_hover_text("Needs an address, valid names, and no connection");
        if let (true, Ok((connection, _))) = (check.clicked(), settings) {
            outbox.send(RobotCommand::Setup(draft.use_password()));
            let setup = Setup::Check(Box::new(connection));
            outbox.send(RobotCommand::Setup(setup));
        }
        if icon_button(ui, icons::ICON_UPLOAD_FILE, "Import names…", true).clicked() {
            outbox.send(RobotCommand::Setup(Setup::AskImport));
        }
        let export = icon_button(ui, icons::ICON_DOWNLOAD, "Export names…", mapping.is_some());
        if let (true, Some(mapping)) = (export.clicked(), mapping) {
            let setup = Setup::AskExport(Box::new(mapping));
            outbox.send(RobotCommand::Setup(setup));
        }
        if checking {
            ui.spinner();
        }
    });
    if let Some((kind, text)) = draft.names().rows.summary() {
        ui.verdict(kind, &text);
    }
    if let Some(text) = draft.problems.of(FieldId::Symbols) {
        ui.bad(&sentence(&format!("{text}.")));
    }
    let problems = std::mem::take(&mut draft.problems);
    let names = draft.names_mut();
    names.rows.show(ui, names.is_custom, &problems);
}

/// Question whether the certificate of the server is trusted.
fn trust(ui: &mut Ui, draft: &mut Draft, can: bool, outbox: &mut Outbox) {
    let Some((server, connects)) = &draft.untrusted else {
        return;
    };
    let connects = *connects;
    ui.bad(&full_sentence(&server.to_string()));
    let button = egui::Button::new("Trust this certificate");
    let button = ui.add_enabled(can, button);
    if button
        .on_hover_text("Only if the server itself shows the same fingerprint")
        .clicked()
    {
        outbox.send(RobotCommand::Setup(Setup::Trust(server.clone())));
        draft.untrusted = None;
        if connects {
            draft.connects = true;
            outbox.send(RobotCommand::Connect);
        }
    }
}

/// Footer: reason why connecting is not possible, and buttons; returns whether the dialog stays open.
fn footer(
    ui: &mut Ui,
    model: &Model,
    draft: &mut Draft,
    settings: Result<(Connection, LaserSettings), Problems>,
    outbox: &mut Outbox,
) -> bool {
    let busy = model.link.is_busy();
    let why = match &settings {
        _ if model.link.connecting => Some("Connecting…".to_owned()),
        _ if busy => {
            Some("A run is under way: end it before another controller is connected.".to_owned())
        }
        Err(problems) => problems.first().map(|(field, text)| {
            let place = field.part().title();
            format!("Not ready to connect: {place}: {text}.")
        }),
        Ok(_) => None,
    };
    trust(ui, draft, why.is_none(), outbox);
    match (&why, &draft.refused) {
        (Some(text), _) => ui.neutral(text),
        (None, Some(text)) => ui.bad(text),
        (None, None) => {
            ui.muted("The settings are saved in the session.");
        }
    }
    let mut open = true;
    ui.horizontal(|ui| {
        let connect = primary(ui, "Connect", why.is_none()).clicked();
        let save = egui::Button::new("Save settings");
        let save = ui.add_enabled(settings.is_ok() && !busy, save).clicked();
        if let (true, Ok(settings)) = (connect || save, settings) {
            outbox.send(RobotCommand::Setup(Setup::Save(Box::new(settings))));
            draft.refused = None;
            draft.untrusted = None;
            outbox.send(RobotCommand::Setup(draft.use_password()));
            if connect {
                draft.connects = true;
                draft.laser.release();
                outbox.send(RobotCommand::Connect);
            }
            open = connect;
        }
        if ui.button("Cancel").clicked() {
            open = false;
        }
    });
    open
}

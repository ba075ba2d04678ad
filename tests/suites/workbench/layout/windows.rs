//! Menus, and windows above the screen.

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_workbench::model::command::Answer;
use tautline_workbench::model::command::Setup;
use tautline_workbench::model::command::{
    FileCommand, IdentificationCommand, ReportCommand, RobotCommand, ViewCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::manual::Page;
use tautline_workbench::shell::App;
use tautline_workflow::report::ReportFormat;

use super::checks::check_dialog;
use crate::measured::{Measured, give};

/// A command that opens a window, and one that closes it.
fn by_commands(
    harness: &mut Harness<'_, App>,
    what: &str,
    [open, close]: [tautline_workbench::model::command::Command; 2],
) {
    let send = |command: &tautline_workbench::model::command::Command| {
        let command = command.clone();
        move |harness: &mut Harness<'_, App>| {
            harness.state_mut().state.outbox.send(command.clone());
            harness.step();
        }
    };
    let (mut open, mut close) = (send(&open), send(&close));
    check_dialog(harness, what, [&mut open, &mut close]);
}

#[test]
fn long_menus_fit() {
    let mut harness = Measured::mini(6, &[]).opened();
    for name in ["File", "View"] {
        let mut open = |harness: &mut Harness<'_, App>| {
            harness.get_by_role_and_label(Role::Button, name).click();
            harness.run_ok();
        };
        let mut close = |harness: &mut Harness<'_, App>| {
            harness.key_press(egui::Key::Escape);
            harness.run_ok();
        };
        check_dialog(&mut harness, name, [&mut open, &mut close]);
    }
}

#[test]
fn every_window_above_the_screen_fits() {
    let measured = Measured::mini(8, &[]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, Edit::Rename("Another name".into()));
    for (what, open, close) in [
        (
            "command palette",
            ViewCommand::Palette(true).into(),
            ViewCommand::Palette(false).into(),
        ),
        (
            "log",
            ViewCommand::Log(true).into(),
            ViewCommand::Log(false).into(),
        ),
        (
            "manual",
            ViewCommand::Manual(Some(Page::Numbers)).into(),
            ViewCommand::Manual(None).into(),
        ),
        (
            "about",
            ViewCommand::About(true).into(),
            ViewCommand::About(false).into(),
        ),
        (
            "report",
            ReportCommand::AskSave(ReportFormat::Pdf).into(),
            ReportCommand::Cancel.into(),
        ),
        (
            "unsaved changes",
            FileCommand::Close.into(),
            FileCommand::Answer(Answer::Cancel).into(),
        ),
    ] {
        by_commands(&mut harness, what, [open, close]);
    }
    let parts: [(&str, &[&str]); 5] = [
        ("recording", &["Recording"]),
        ("controller", &["Beckhoff controller (ADS)"]),
        ("other controller", &["Controller with OPC UA"]),
        (
            "symbols",
            &["Beckhoff controller (ADS)", "Symbols", "Custom names"],
        ),
        ("laser", &["Laser source", "From a device at a serial port"]),
    ];
    for (what, presses) in parts {
        let mut open = |harness: &mut Harness<'_, App>| {
            let state = &mut harness.state_mut().state;
            state.outbox.send(RobotCommand::Setup(Setup::Open));
            // A window takes its size before it is seen.
            for _ in 0..4 {
                harness.step();
            }
            for name in presses {
                harness.get_by_label(name).click_accesskit();
                harness.step();
                harness.step();
            }
        };
        let mut close = |harness: &mut Harness<'_, App>| {
            let state = &mut harness.state_mut().state;
            state.outbox.send(RobotCommand::Setup(Setup::Close));
            harness.step();
        };
        check_dialog(&mut harness, what, [&mut open, &mut close]);
    }
    let mut open = |harness: &mut Harness<'_, App>| {
        harness
            .state_mut()
            .state
            .outbox
            .send(FileCommand::AskSaveAs);
        harness.step();
    };
    let mut close = |harness: &mut Harness<'_, App>| {
        harness.key_press(egui::Key::Escape);
        harness.step();
    };
    check_dialog(&mut harness, "save as", [&mut open, &mut close]);
}

//! Actions that disconnect an armed controller ask first.

use egui_kittest::kittest::Queryable;
use tautline_workbench::model::command::{Command, FileCommand, RobotCommand};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::link::LinkRequest;
use tautline_workflow::samples;
use tautline_workflow::templates::Template;

use crate::demo::Bench;

const QUESTION: &str = "Disconnect the armed robot?";

/// An armed controller of a session without unsaved changes.
fn armed() -> Bench {
    let mut bench = Bench::demo(3);
    bench.give(RobotCommand::ConnectAndArm);
    bench.wait("arming", |state| state.model.link.is_armed());
    let path = bench.folder.path().join("session.json");
    bench.give(FileCommand::SaveAs(path));
    bench.settle("a file");
    bench
}

fn is_asked(bench: &mut Bench, question: &str) -> bool {
    bench.harness.run_ok();
    bench.harness.query_by_label(question).is_some()
}

#[test]
fn nothing_disconnects_an_armed_controller_without_a_question() {
    let sample = samples::find(&samples::places()).remove(0).session;
    let mut bench = armed();
    let leaves: [Command; 7] = [
        FileCommand::Close.into(),
        FileCommand::Quit.into(),
        FileCommand::New(Template::Suspended).into(),
        FileCommand::Open(sample).into(),
        FileCommand::TryDemo.into(),
        RobotCommand::Connect.into(),
        LinkRequest::Disconnect.into(),
    ];
    for leave in leaves {
        let what = format!("{leave:?}");
        let id = bench.state().model.open.as_ref().map(|open| open.id());
        bench.give(leave);
        bench.settle("a question");
        assert!(is_asked(&mut bench, QUESTION), "{what}");
        bench.press("Cancel");
        let model = &bench.state().model;
        assert!(model.link.is_armed(), "{what}");
        assert_eq!(model.open.as_ref().map(|open| open.id()), id, "{what}");
    }
    bench.give(LinkRequest::Disconnect);
    assert!(is_asked(&mut bench, QUESTION));
    bench.press("Disconnect");
    bench.wait("the end", |state| !state.model.link.is_connected());
    bench.give(RobotCommand::Connect);
    bench.wait("a connection", |state| state.model.link.is_connected());
    bench.give(LinkRequest::Disconnect);
    bench.wait("the end", |state| !state.model.link.is_connected());
}

#[test]
fn unsaved_changes_and_an_armed_controller_are_one_question() {
    let mut bench = armed();
    bench.give(Edit::Rename("Another name".into()));
    bench.give(FileCommand::Close);
    assert!(is_asked(&mut bench, "Save the changes?"));
    let armed = bench.harness.query_all_by_label_contains("is armed");
    assert!(armed.count() > 0);
    bench.press("Save");
    bench.wait("the start screen", |state| state.model.open.is_none());
    bench.wait("the end", |state| !state.model.link.is_connected());
}

//! The thread of the controller breaks down.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use tautline_session::find_unsaved_sessions;
use tautline_workbench::model::command::RobotCommand;
use tautline_workbench::model::phase::Phase;
use tautline_workbench::shell::AppState;

use crate::demo::Bench;

fn measured(state: &AppState) -> usize {
    let document = state.model.open.as_ref();
    document.map_or(0, |d| d.session().measurements.len())
}

/// Lets the controller's thread panic the next time it wakes the window: what it calls then is not the program's own.
fn break_down(bench: &Bench) {
    let is_due = Arc::new(AtomicBool::new(true));
    bench.harness.ctx.set_request_repaint_callback(move |_| {
        let is_controller = thread::current().name() == Some("controller");
        assert!(
            !(is_controller && is_due.swap(false, Ordering::Relaxed)),
            "the thread of the controller is made to panic"
        );
    });
}

#[test]
fn a_panic_in_the_controller_thread_is_reported_and_loses_nothing() {
    let mut bench = Bench::demo(3);
    bench.go(Phase::Measuring);
    bench.give(RobotCommand::Plan(6));
    bench.settle("a plan");
    bench.connect_and_arm();
    bench.press("Start measuring");
    bench.wait("three poses", |state| measured(state) >= 3);
    break_down(&bench);
    let told = |state: &AppState| {
        let all = state.model.messages.all().iter();
        all.filter(|message| message.text.contains("internal error"))
            .count()
    };
    bench.wait("the end of the connection", |state| {
        !state.model.link.is_connected() && told(state) == 2
    });
    let messages = bench.state().model.messages.all();
    let texts: Vec<&str> = messages.iter().map(|m| m.text.as_str()).collect();
    assert!(
        texts.iter().any(
            |text| text.starts_with("Measuring ended after") && text.contains("internal error")
        ),
        "{texts:?}"
    );
    assert!(
        bench.state().model.caught_panic.is_none(),
        "the window goes on"
    );
    let kept = bench.session().measurements.clone();
    assert!(kept.len() >= 3);
    // The measured poses are in the recovery folder, too.
    let left = find_unsaved_sessions(&bench.state().model.folders.recovery()).expect("readable");
    let on_disk = left.first().map(|left| left.poses);
    assert!(left.is_empty() || on_disk >= Some(3), "{on_disk:?}");
    bench.connect_and_arm();
    bench.press("Continue measuring");
    bench.wait("all poses", |state| !state.model.link.is_measuring());
    let all = &bench.session().measurements;
    assert_eq!(all.len(), 7, "home and six poses");
    let rows: Vec<usize> = (0..kept.len()).collect();
    assert_eq!(all.select(&rows).labels, kept.labels);
    assert_eq!(all.select(&rows).laser_m, kept.laser_m);
}

//! Stop: one button at one place with a key of its own, and what is seen afterwards; the live scope before.

use egui::{Key, Modifiers, Rect};
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{IdentificationCommand, RobotCommand, ViewCommand};
use tautline_workbench::model::link::Doing;
use tautline_workbench::model::phase::Phase;
use tautline_workbench::shell::State;
use tautline_workbench::views::robot_3d::scene::Shown;

use crate::demo::Bench;

/// A few frames: while the robot moves there is always another one.
fn step(bench: &mut Bench) {
    for _ in 0..3 {
        bench.harness.step();
    }
}

/// Where the button is, and whether it can be pressed.
fn button(bench: &mut Bench) -> (Rect, bool) {
    step(bench);
    let node = bench.harness.get_by_label("Stop the robot");
    (node.rect(), !node.accesskit_node().is_disabled())
}

fn shown(bench: &mut Bench) -> Shown {
    step(bench);
    let scene = bench.state().views.robot_3d.scene();
    scene.expect("it is drawn").shown
}

/// A run on its way to a pose.
fn moving(bench: &mut Bench) {
    bench.go(Phase::Measuring);
    bench.give(RobotCommand::Speed(5.0));
    bench.give(RobotCommand::Plan(5));
    bench.settle("a plan");
    bench.connect_and_arm();
    bench.press("Start measuring");
    bench.wait("a pose on the way", |state| {
        let run = state.model.link.run.as_ref();
        let is_second = run.is_some_and(|run| run.current == Some(2));
        is_second && state.model.link.live().doing == Doing::Moving
    });
}

fn ended(state: &State) -> bool {
    !state.model.link.is_measuring()
}

#[test]
fn stop_has_one_place_and_a_key_and_shows_where_the_robot_is() {
    let mut bench = Bench::demo(3);
    let (place, enabled) = button(&mut bench);
    assert!(!enabled, "nothing can move");
    moving(&mut bench);
    // Slower than real, so that it is on its way until it is stopped.
    bench.give(RobotCommand::Speed(0.05));
    for phase in Phase::ALL {
        bench.go(phase);
        assert_eq!(button(&mut bench), (place, true), "{phase:?}");
    }
    // The key works while something is typed.
    bench.give(ViewCommand::Palette(true));
    bench.harness.key_press_modifiers(Modifiers::NONE, Key::F12);
    bench.harness.step();
    bench.wait("the end", ended);
    bench.give(ViewCommand::Palette(false));
    assert_eq!(shown(&mut bench), Shown::Stopped);
    let live = bench.state().model.live_platform.clone().expect("a place");
    assert!(live.is_stopped && !live.trail.is_empty());
    let plan = &bench.session().plan;
    let away = plan
        .iter()
        .map(|pose| (pose.pose().position - live.pose.position).norm());
    assert!(
        away.fold(f64::INFINITY, f64::min) > 1e-4,
        "it is between poses"
    );
    // A pose that is chosen is shown; a new run shows the robot again.
    bench.give(ViewCommand::Select(Selection::pose(0)));
    assert_ne!(shown(&mut bench), Shown::Stopped);
    bench.go(Phase::Measuring);
    bench.press("Continue measuring");
    bench.wait("the robot", |state| state.model.live_platform.is_some());
    assert_eq!(shown(&mut bench), Shown::Live);
    bench.press("Stop the robot");
    bench.wait("the end", ended);
    assert_eq!(shown(&mut bench), Shown::Stopped);
}

#[test]
fn the_scope_comes_with_a_run_and_goes_with_its_result() {
    let mut bench = Bench::demo(3);
    let has = |bench: &Bench, name: &str| bench.harness.query_by_label(name).is_some();
    moving(&mut bench);
    step(&mut bench);
    for name in ["Tensions", "Speed", "Laser", "Revolutions"] {
        let name = format!("Live: {name}");
        assert!(has(&bench, &name), "{name}");
    }
    let readings = |bench: &Bench| {
        let link = &bench.state().model.link;
        link.scope(|scope| scope.readings()).expect("it records")
    };
    let before = readings(&bench);
    bench.wait("readings", |state| {
        let now = state.model.link.scope(|scope| scope.readings());
        now.is_some_and(|now| now > before + 20)
    });
    bench.give(RobotCommand::Speed(60.0));
    bench.wait("all poses", ended);
    assert!(
        has(&bench, "Live: Tensions"),
        "it stays until there is a result"
    );
    bench.give(IdentificationCommand::Identify);
    bench.settle("an identification");
    bench.harness.run_ok();
    assert!(!has(&bench, "Live: Tensions"));
    assert!(has(&bench, "Plot: Residuals"), "what was there before");
}

//! The timeline of the measured poses, and plots side by side.

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_session::{PlotArea, Preferences};
use tautline_workbench::model::command::{IdentificationCommand, ViewCommand};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::App;
use tautline_workbench::views::robot_3d::scene::ShownPose;

use crate::measured::{Measured, give, press};
use crate::support::settle;

fn pose(harness: &Harness<'_, App>) -> Option<i64> {
    harness.state().state.model.selection.pose
}

fn shown(harness: &Harness<'_, App>) -> ShownPose {
    let scene = harness.state().state.views.robot_3d.scene();
    scene.expect("it is drawn").shown
}

fn identified(poses: usize) -> Harness<'static, App> {
    let mut harness = Measured::mini(poses, &[]).opened();
    give(&mut harness, IdentificationCommand::Identify);
    let go = ViewCommand::Go(Screen::Phase(Phase::Identification));
    give(&mut harness, go);
    harness
}

#[test]
fn poses_are_stepped_through_by_keys_pointer_and_buttons() {
    let mut harness = identified(9);
    let line = harness.get_by_label("Pose timeline").rect();
    harness.hover_at(line.center());
    harness.run_ok();
    for (key, expected) in [
        (Key::ArrowRight, 0),
        (Key::ArrowRight, 1),
        (Key::End, 9),
        (Key::ArrowRight, 9),
        (Key::ArrowLeft, 8),
        (Key::Home, 0),
    ] {
        harness.key_press(key);
        harness.run_ok();
        assert_eq!(pose(&harness), Some(expected), "{key:?}");
        assert_eq!(shown(&harness), ShownPose::Fitted(expected), "{key:?}");
    }
    assert!(harness.query_all_by_label("Home").next().is_some());
    let last = egui::pos2(line.max.x - 2.0, line.center().y);
    harness.hover_at(last);
    harness.drag_at(last);
    harness.drop_at(last);
    harness.run_ok();
    assert_eq!(pose(&harness), Some(9));
    press(&mut harness, "Previous pose");
    assert_eq!(pose(&harness), Some(8));
    harness.get_by_label_contains("Pose 8, 8 of 9");
}

#[test]
fn playback_restarts_at_the_first_pose_and_stops_at_the_last() {
    let mut harness = identified(4);
    give(&mut harness, ViewCommand::Select(Default::default()));
    harness.get_by_label("Play poses").click();
    // A step of the harness is a quarter of a second.
    let mut seen = Vec::new();
    for _ in 0..40 {
        harness.step();
        if pose(&harness).is_some() && seen.last() != pose(&harness).as_ref() {
            seen.extend(pose(&harness));
        }
    }
    assert_eq!(seen, [0, 1, 2, 3, 4]);
    harness.get_by_label("Play poses");
}

/// A step of the harness is a quarter of a second, in which a recording of 20 Hz has five samples.
#[test]
fn a_recording_is_played_as_fast_as_it_was_made_and_plotted_over_time() {
    let mut harness = Measured::in_motion(6.0).opened();
    let go = ViewCommand::Go(Screen::Phase(Phase::Identification));
    give(&mut harness, go);
    let labels = {
        let open = harness.state().state.model.open.as_ref();
        open.expect("it is open")
            .session()
            .measurements
            .labels
            .clone()
    };
    harness.get_by_label("Play poses").click();
    let mut seen: Vec<usize> = Vec::new();
    for _ in 0..40 {
        harness.step();
        let place = pose(&harness).and_then(|pose| labels.iter().position(|one| *one == pose));
        let Some(place) = place else { continue };
        if seen.last() != Some(&place) {
            seen.push(place);
        }
    }
    assert_eq!(
        (seen[0], seen.last()),
        (0, Some(&(labels.len() - 1))),
        "{seen:?}"
    );
    let steps = seen.windows(2).map(|pair| pair[1] - pair[0]);
    assert!(steps.clone().all(|step| step <= 6), "{seen:?}");
    assert!(steps.filter(|step| *step == 5).count() > 15, "{seen:?}");
    harness.get_by_label("Play poses");
    if harness.query_by_label("Over time").is_none() {
        press(&mut harness, "More plots");
    }
    press(&mut harness, "Over time");
    let views = &harness.state().state.views;
    let (title, range) = views.plots.range("course").expect("it is drawn");
    assert_eq!(title, "Time (s)");
    assert!(
        range[0] <= 0.0 && range[1] >= 6.0 && range[1] < 8.0,
        "{range:?}"
    );
}

#[test]
fn plots_side_by_side_move_together_and_are_restored() {
    let mut harness = identified(12);
    press(&mut harness, "Plot layout");
    press(&mut harness, "Two plots");
    let rect = |harness: &Harness<'_, App>, name: &str| harness.get_by_label(name).rect();
    let [left, right] = ["Plot: Residuals", "Plot: Tensions"].map(|name| rect(&harness, name));
    assert!(left.max.x < right.min.x, "{left:?} {right:?}");
    assert!((left.width() - right.width()).abs() < 2.0);
    let range = |harness: &mut Harness<'_, App>, kind: &str| {
        let views = &harness.state().state.views;
        views.plots.range(kind).expect("it is drawn")
    };
    let (title, before) = range(&mut harness, "tensions");
    assert_eq!(title, "Pose");
    let from = left.center();
    harness.hover_at(from);
    harness.drag_at(from);
    harness.run_ok();
    harness.hover_at(from + egui::vec2(40.0, 0.0));
    harness.run_ok();
    harness.drop_at(from + egui::vec2(40.0, 0.0));
    harness.run_ok();
    let both = ["residuals", "tensions"];
    let [(_, dragged), (_, followed)] = both.map(|tab| range(&mut harness, tab));
    assert!(dragged[0] < before[0] - 0.2, "{dragged:?} {before:?}");
    assert_eq!(dragged, followed);
    press(&mut harness, "Plot layout");
    press(&mut harness, "Four plots");
    for name in ["Plot: By variable", "Plot: Distances"] {
        let below = rect(&harness, name);
        assert!(below.min.y > rect(&harness, "Plot: Residuals").max.y);
    }
    settle(&mut harness);
    let file = harness.state().state.model.folders.preferences();
    let kept = Preferences::load(&file).value.plots;
    assert!(matches!(&kept.area, Some(PlotArea::Column(rows)) if rows.len() == 2));
}

//! Panels: plots that dock and detach, parts that are maximised, edges that are gripped, arrangements that are kept.

use egui::{Key, Pos2, Rect, Role, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_session::{PlotArea, Plots, Preferences};
use tautline_workbench::model::command::{IdentificationCommand, ViewCommand};
use tautline_workbench::model::part::ScreenPart;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::App;
use tautline_workbench::views::plots::Panes;

use crate::measured::{Measured, give, press};
use crate::support::settle;

fn identified() -> Harness<'static, App> {
    let mut harness = Measured::mini(12, &[]).opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(
        &mut harness,
        ViewCommand::Go(Screen::Phase(Phase::Identification)),
    );
    harness
}

fn rect(harness: &Harness<'_, App>, name: &str) -> Rect {
    harness.get_by_label(name).rect()
}

fn drag(harness: &mut Harness<'_, App>, from: Pos2, to: Pos2) {
    harness.hover_at(from);
    harness.run_ok();
    harness.drag_at(from);
    harness.run_ok();
    for share in [0.3, 0.7, 1.0] {
        harness.hover_at(from.lerp(to, share));
        harness.step();
        harness.step();
    }
    harness.drop_at(to);
    harness.run_ok();
    settle(harness);
}

fn kept(harness: &Harness<'_, App>) -> Plots {
    let file = harness.state().state.model.folders.preferences();
    Preferences::load(&file).value.plots
}

#[test]
fn a_tab_that_is_dragged_to_the_side_docks_there_and_stays_there() {
    let mut harness = identified();
    let plot = rect(&harness, "Plot: Residuals");
    let tab = harness.get_by_role_and_label(Role::Button, "Tensions");
    let from = tab.rect().center();
    drag(&mut harness, from, plot.right_center() - vec2(4.0, 0.0));
    let [left, right] = ["Plot: Residuals", "Plot: Tensions"].map(|name| rect(&harness, name));
    assert!(left.max.x < right.min.x, "{left:?} {right:?}");
    let kept = kept(&harness);
    assert!(
        matches!(&kept.area, Some(PlotArea::Row(places)) if places.len() == 2),
        "{kept:?}"
    );
    harness.state_mut().state.views.plots = Panes::of(&kept);
    settle(&mut harness);
    assert_eq!(rect(&harness, "Plot: Tensions"), right, "as it was kept");

    // The edge between them is gripped some points beside it.
    let edge = 0.5 * (left.max.x + right.min.x) + 6.0;
    let at = Pos2::new(edge, left.center().y);
    drag(&mut harness, at, at - vec2(80.0, 0.0));
    let narrower = rect(&harness, "Plot: Residuals");
    assert!(
        narrower.width() < left.width() - 60.0,
        "{narrower:?} {left:?}"
    );
}

#[test]
fn edges_of_panels_are_gripped_without_aiming() {
    let mut harness = identified();
    // Within the margin of the panel; beyond it the pointer turns the robot.
    for (beside, by) in [(2.0, 30.0), (7.0, -30.0)] {
        let view = rect(&harness, "3D view");
        let at = Pos2::new(view.max.x + beside, view.center().y);
        drag(&mut harness, at, at + vec2(by, 0.0));
        let now = rect(&harness, "3D view");
        assert!(
            (now.max.x - view.max.x).abs() > 20.0,
            "{beside}: {view:?} {now:?}"
        );
    }
}

#[test]
fn a_plot_has_a_window_of_its_own_until_it_is_docked_again() {
    let mut harness = identified();
    press(&mut harness, "Plot layout");
    press(&mut harness, "Open Residuals in a window");
    assert_eq!(kept(&harness).detached, ["residuals"]);
    let plot = rect(&harness, "Plot: Residuals");
    assert!(plot.width() > 400.0 && plot.height() > 200.0, "{plot:?}");
    // The next plot is in its place.
    assert_eq!(harness.get_all_by_label_contains("Plot: ").count(), 2);
    give(&mut harness, ViewCommand::Maximise(Some(ScreenPart::Panel)));
    rect(&harness, "Plot: Residuals");
    give(&mut harness, ViewCommand::Maximise(None));
    press(&mut harness, "Dock");
    assert_eq!(kept(&harness).detached, Vec::<String>::new());
    assert_eq!(harness.get_all_by_label_contains("Plot: ").count(), 1);
}

#[test]
fn every_part_is_maximised_and_restored() {
    let mut harness = identified();
    let [view, plot] = ["3D view", "Plot: Residuals"].map(|name| rect(&harness, name));
    press(&mut harness, "Maximise Residuals");
    assert!(rect(&harness, "Plot: Residuals").height() > 2.0 * plot.height());
    assert!(
        harness
            .query_by_role_and_label(Role::Canvas, "3D view")
            .is_none()
    );
    press(&mut harness, "Restore panels");
    assert_eq!(rect(&harness, "Plot: Residuals"), plot);
    press(&mut harness, "Maximise the 3D view");
    let large = harness
        .get_by_role_and_label(Role::Canvas, "3D view")
        .rect();
    assert!(large.area() > 1.8 * view.area(), "{large:?} {view:?}");
    assert!(harness.query_by_label("Plot: Residuals").is_none());
    for (key, part) in [
        (Key::F8, Some(ScreenPart::Plots)),
        (Key::F9, Some(ScreenPart::Panel)),
        (Key::F7, Some(ScreenPart::Robot)),
        (Key::F6, None),
    ] {
        harness.key_press(key);
        harness.run_ok();
        settle(&mut harness);
        assert_eq!(harness.state().state.model.maximised, part, "{key:?}");
    }
    // A maximised part does not hide a part that has to be seen.
    give(&mut harness, ViewCommand::Maximise(Some(ScreenPart::Panel)));
    give(&mut harness, ViewCommand::Inspect(Some(2)));
    assert_eq!(harness.state().state.model.maximised, None);
}

#[test]
fn a_second_plot_by_variable_stands_beside_the_first() {
    let mut harness = identified();
    press(&mut harness, "By variable");
    press(&mut harness, "Plot layout");
    press(&mut harness, "Another plot by variable");
    press(&mut harness, "By variable 2");
    rect(&harness, "Plot: By variable");
    press(&mut harness, "Plot layout");
    press(&mut harness, "Close By variable 2");
    assert!(harness.query_by_label("By variable 2").is_none());
}

#[test]
fn all_plots_over_poses_show_the_same_poses_wherever_they_are() {
    let mut harness = identified();
    press(&mut harness, "Plot layout");
    press(&mut harness, "Four plots");
    press(&mut harness, "Plot layout");
    press(&mut harness, "Open Tensions in a window");
    // The window does not reach down to it.
    let from = rect(&harness, "Plot: Distances").center() + vec2(0.0, 20.0);
    drag(&mut harness, from, from + vec2(30.0, 0.0));
    let plots = &harness.state().state.views.plots;
    let ranges = ["residuals", "tensions", "laser"].map(|tab| {
        let (title, range) = plots.range(tab).expect("it is drawn");
        assert_eq!(title, "Pose");
        range
    });
    assert!(ranges[0][0] < 0.0, "{ranges:?}");
    assert_eq!([ranges[1], ranges[2]], [ranges[0]; 2]);
}

#[test]
fn what_is_zoomed_belongs_to_its_session() {
    let mut harness = identified();
    let range = |harness: &mut Harness<'_, App>| {
        let plots = &harness.state().state.views.plots;
        plots.range("residuals").expect("it is drawn").1
    };
    let whole = range(&mut harness);
    let from = rect(&harness, "Plot: Residuals").center();
    drag(&mut harness, from, from + vec2(60.0, 0.0));
    assert!(range(&mut harness)[0] < whole[0] - 0.2);
    let other = Measured::mini(12, &[]);
    give(
        &mut harness,
        tautline_workbench::model::command::FileCommand::Open(other.beside("mini")),
    );
    press(&mut harness, "Do not save");
    give(&mut harness, IdentificationCommand::Identify);
    give(
        &mut harness,
        ViewCommand::Go(Screen::Phase(Phase::Identification)),
    );
    assert_eq!(range(&mut harness), whole);
}

#[test]
fn four_plots_can_be_read_in_a_small_window() {
    let mut harness = identified();
    press(&mut harness, "Plot layout");
    press(&mut harness, "Four plots");
    for name in ["Residuals", "Tensions", "By variable", "Distances"] {
        let plot = rect(&harness, &format!("Plot: {name}"));
        assert!(
            plot.width() > 250.0 && plot.height() > 100.0,
            "{name}: {plot:?}"
        );
    }
}

//! Nothing is clipped and nothing overlaps: every screen, in windows from 1024 x 640 to 2560 x 1440 pixels, dark and light,
//! at 100 and 200 %, with robots of 4, 8 and 16 cables. Sizes, themes, scales and numbers of cables meet in pairs: every
//! level of each with every level of each other, not all four at a time.

mod checks;
mod windows;

use egui::{Rect, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_workbench::model::command::{
    CompareCommand, FileCommand, IdentificationCommand, RecordingCommand, ViewCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::part::ScreenPart;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::App;
use tautline_workflow::templates::Template;

use crate::measured::{Measured, give};
use crate::support::settle;
use crate::tables::Bench;
use checks::{SIZES, check, check_in, check_with, faults_at_the_bottom, in_pairs, once, seen};

#[test]
fn the_start_screen_fits() {
    let mut harness = crate::support::workbench();
    settle(&mut harness);
    check(&mut harness, "start");
}

/// The bar with a long name that is not saved, and a robot that can move.
#[test]
fn the_bar_at_the_top_fits() {
    let mut bench = crate::demo::Bench::demo(3);
    bench.go(Phase::Measuring);
    bench.connect_and_arm();
    let name = "Demo robot after the repair of the third winch";
    bench.give(Edit::Rename(name.into()));
    for (_, size, scale) in in_pairs() {
        let harness = &mut bench.harness;
        harness.set_pixels_per_point(scale);
        harness.step();
        harness.set_size(size / scale);
        harness.step();
        harness.step();
        let mut parts: Vec<(&str, Rect)> = [
            "File",
            "Help",
            "Undo: rename",
            "Redo",
            "Command palette",
            "Stop the robot",
        ]
        .iter()
        .map(|part| {
            (
                *part,
                harness
                    .get_all_by_label_contains(part)
                    .next()
                    .expect("there")
                    .rect(),
            )
        })
        .collect();
        let rest = [name, "not saved"].into_iter();
        parts.extend(rest.filter_map(|part| Some((part, harness.query_by_label(part)?.rect()))));
        for (k, (a, rect)) in parts.iter().enumerate() {
            assert!(
                harness.ctx.content_rect().contains_rect(*rect),
                "{a}: {rect:?}"
            );
            for (b, other) in &parts[k + 1..] {
                let common = rect.intersect(*other);
                assert!(
                    !common.is_positive(),
                    "{size:?} at {scale}: {a} and {b}: {common:?}"
                );
            }
        }
    }
}

/// No phase is scrolled out of sight.
#[test]
fn the_rail_shows_all_phases() {
    let mut harness = Measured::mini(6, &[]).opened();
    check_with(&mut harness, "rail", &in_pairs(), &mut |harness| {
        let window = harness.ctx.content_rect();
        let bar = harness.get_by_label("Show the log").rect();
        let room = window.with_max_y(bar.min.y);
        let phases = Phase::ALL.map(|phase| {
            let name = format!("Phase {}: {}", phase.number(), phase.title());
            let rect = harness.get_by_label(&name).rect();
            (!room.contains_rect(rect)).then(|| format!("{name} at {rect:?}"))
        });
        phases.into_iter().flatten().collect()
    });
}

/// The bar with a long message and a controller that is connected.
#[test]
fn the_bar_at_the_bottom_fits() {
    let mut bench = crate::demo::Bench::demo(3);
    bench.go(Phase::Measuring);
    bench.connect_and_arm();
    let messages = &mut bench.harness.state_mut().state.model.messages;
    messages.warning("measured.csv, line 1048: the tension of the eighth cable is larger than any that the robot can bear.");
    check_with(
        &mut bench.harness,
        "bar at the bottom",
        &in_pairs(),
        &mut |harness| {
            harness.step();
            faults_at_the_bottom(harness)
        },
    );
}

#[test]
fn every_phase_fits() {
    let measured = Measured::mini(30, &[("winch_scale", "cable-3", &[("scale", 0.02)])]);
    let mut harness = measured.opened();
    for command in [
        IdentificationCommand::Identify,
        IdentificationCommand::Diagnose,
    ] {
        harness.state_mut().state.outbox.send(command);
        settle(&mut harness);
    }
    for step in Phase::ALL {
        harness
            .state_mut()
            .state
            .outbox
            .send(ViewCommand::Go(Screen::Phase(step)));
        settle(&mut harness);
        check(&mut harness, step.title());
    }
    harness.state_mut().state.outbox.send(CompareCommand::Show);
    settle(&mut harness);
    check(&mut harness, "compare");
}

#[test]
fn every_phase_fits_with_few_and_many_cables() {
    for cables in [4, 16] {
        let mut harness = Measured::with_cables(cables, 12).opened();
        give(&mut harness, IdentificationCommand::Identify);
        for step in Phase::ALL {
            give(&mut harness, ViewCommand::Go(Screen::Phase(step)));
            let what = format!("{} with {cables} cables", step.title());
            check_in(&mut harness, &what, &once());
        }
        give(&mut harness, ViewCommand::Inspect(Some(cables - 1)));
        let what = format!("inspector with {cables} cables");
        check_in(&mut harness, &what, &once());
    }
}

#[test]
fn the_inspector_and_the_statistics_fit() {
    let mut harness = Measured::mini(12, &[]).opened();
    give(&mut harness, IdentificationCommand::Identify);
    let go = ViewCommand::Go(Screen::Phase(Phase::Identification));
    give(&mut harness, go);
    give(&mut harness, ViewCommand::Inspect(Some(2)));
    check(&mut harness, "inspector");
    give(&mut harness, ViewCommand::Inspect(None));
    for part in ScreenPart::ALL {
        give(&mut harness, ViewCommand::Maximise(Some(part)));
        if part == ScreenPart::Plots {
            harness.set_pixels_per_point(1.0);
            harness.set_size(SIZES[2]);
            harness.run_ok();
            crate::measured::press(&mut harness, "Statistics");
        }
        check(&mut harness, &format!("{part:?} maximised"));
        if part == ScreenPart::Plots {
            crate::measured::press(&mut harness, "Statistics of: Readings");
            crate::measured::press(&mut harness, "Values");
            harness.key_press(egui::Key::Escape);
            harness.run_ok();
            check(&mut harness, "values maximised");
        }
    }
}

#[test]
fn a_comparison_fits() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, b] = ["before.json", "after.json"].map(|name| folder.path().join(name));
    crate::compare::write(&a, "mini", 0.0, 1);
    crate::compare::write(&b, "mini", -0.01, 3);
    let mut harness = crate::support::workbench();
    give(&mut harness, CompareCommand::Show);
    crate::compare::take(&mut harness, "A", &a);
    crate::compare::take(&mut harness, "B", &b);
    harness.get_by_label_contains("1 pulley has moved");
    check(&mut harness, "comparison");
}

#[test]
fn the_import_fits() {
    let mut harness = Measured::mini(6, &[]).opened();
    harness
        .state_mut()
        .state
        .outbox
        .send(RecordingCommand::Show);
    settle(&mut harness);
    check(&mut harness, "import without a file");
    let folder = tautline_validation::generators::your_data::folder();
    for name in ["mistakes.csv", "points.txt", "capture.csv"] {
        let path = folder.join(name);
        give(&mut harness, RecordingCommand::Read(path));
    }
    check(&mut harness, "import");
}

#[test]
fn the_description_of_a_new_robot_fits() {
    let mut harness = crate::support::workbench();
    give(&mut harness, FileCommand::New(Template::Facade));
    check(&mut harness, "description");
}

#[test]
fn plots_beside_each_other_fit() {
    let measured = Measured::mini(12, &[]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    let go = ViewCommand::Go(Screen::Phase(Phase::Identification));
    give(&mut harness, go);
    for arrangement in ["Two plots", "Four plots"] {
        harness.set_pixels_per_point(1.0);
        harness.set_size(SIZES[1]);
        harness.run_ok();
        crate::measured::press(&mut harness, "Plot layout");
        crate::measured::press(&mut harness, arrangement);
        check(&mut harness, arrangement);
    }
}

/// Numbers of the table of cables that are cut off at its sides or in their fields.
fn cut_numbers(harness: &Harness<'_, App>) -> Vec<String> {
    let cells = seen(harness).into_iter();
    let cut = cells
        .filter(|part| part.is_number_of_a_cable())
        .filter(|part| part.is_cut_at_the_side() || part.is_too_narrow(harness));
    cut.map(|part| format!("{part:?}")).collect()
}

#[test]
fn the_tolerances_fit() {
    let mut bench = Bench::with_robot(|robot| {
        robot["tolerances"] = serde_json::json!({
            "winch_scale": {"cable-3": 1e-3, "default": 2e-4},
            "cable_creep": 1.234e-5
        });
    });
    give(
        &mut bench.harness,
        ViewCommand::Go(Screen::Phase(Phase::Modeling)),
    );
    bench.open("Tolerances");
    check(&mut bench.harness, "tolerances");
}

/// No number is cut off, wherever the table was scrolled to, and also where the numbers are long.
#[test]
fn the_table_of_cables_shows_whole_numbers() {
    let mut bench = Bench::with_robot(|robot| {
        for cable in robot["cables"].as_array_mut().expect("cables") {
            for axis in 0..3 {
                let point = &mut cable["pulley"]["entry_point_m"][axis];
                *point = serde_json::json!(100.0 * point.as_f64().expect("a number") - 0.012_34);
            }
        }
    });
    for screen in [Screen::Phase(Phase::Modeling), Screen::NewRobot] {
        give(&mut bench.harness, ViewCommand::Go(screen));
        if screen != Screen::NewRobot {
            bench.open("Description");
        }
        let mut reached = 0;
        let find = &mut |harness: &mut Harness<'_, App>| {
            let mut found = Vec::new();
            let mut columns = Vec::new();
            let names = harness.query_all_by_role_and_label(Role::Label, "cable-8");
            names.last().expect("the last row").scroll_to_me();
            harness.run_ok();
            for cell in [
                "Weight of cable-8",
                "Pulley z of cable-8",
                "Gear ratio of cable-8",
            ] {
                found.extend(cut_numbers(harness));
                harness
                    .get_by_role_and_label(Role::TextInput, cell)
                    .scroll_to_me();
                harness.run_ok();
                let shown = seen(harness);
                let is_shown = shown.iter().any(|part| part.is_named(cell));
                columns.push(is_shown);
            }
            found.extend(cut_numbers(harness));
            reached += columns.iter().filter(|shown| **shown).count();
            found
        };
        check_with(&mut bench.harness, "table of cables", &in_pairs(), find);
        assert_eq!(reached, 3 * in_pairs().len(), "every column can be reached");
    }
}

//! The table of statistics: readings with their reliability, values with their intervals; sorted, filtered, copied.

use egui::OutputCommand;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::IdentificationCommand;
use tautline_workbench::shell::App;
use tautline_workflow::identification::{reading_statistics, value_statistics};

use crate::measured::{Measured, document, give, press};

fn opened() -> Harness<'static, App> {
    let measured = Measured::mini(20, &[]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    if harness.query_by_label("Statistics").is_none() {
        press(&mut harness, "More plots");
    }
    press(&mut harness, "Statistics");
    harness
}

/// The copied table: one line for each row, below the headings.
fn copied(harness: &mut Harness<'_, App>) -> Vec<Vec<String>> {
    harness.get_by_label("Copy table").click();
    harness.step();
    let commands = harness.output().platform_output.commands.iter();
    let text = commands.rev().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    harness.run_ok();
    let text = text.expect("something is copied");
    let line = |line: &str| line.split('\t').map(str::to_owned).collect();
    text.lines().map(line).collect()
}

#[test]
fn all_readings_are_listed_sorted_filtered_and_copied() {
    let mut harness = opened();
    let all = copied(&mut harness);
    let statistics = {
        let fit = document(&harness).fit().expect("a fit");
        reading_statistics(fit)
    };
    assert_eq!(all.len(), 1 + statistics.len());
    assert_eq!(all[0][5], "Redundancy");
    for (line, one) in all[1..].iter().zip(&statistics) {
        assert_eq!(line[0], one.pose.to_string());
        let redundancy: f64 = line[5].parse().expect("a number");
        let known = one.redundancy.expect("determined");
        assert!((redundancy - known).abs() < 1e-3, "{line:?}");
    }

    press(&mut harness, "Sort by redundancy");
    let column = |lines: &[Vec<String>]| -> Vec<f64> {
        let cells = lines[1..].iter().map(|line| line[5].parse());
        cells.map(|cell| cell.expect("a number")).collect()
    };
    assert!(column(&copied(&mut harness)).is_sorted());
    press(&mut harness, "Sort by redundancy, sorted, smallest first");
    assert!(column(&copied(&mut harness)).is_sorted_by(|a, b| a >= b));

    let field = harness.get_by_label("Filter the table");
    field.focus();
    harness.run_ok();
    harness
        .get_by_label("Filter the table")
        .type_text("length cable-3");
    harness.run_ok();
    let few = copied(&mut harness);
    assert!(few.len() > 15 && few.len() < all.len() / 8);
    assert!(few[1..].iter().all(|line| line[1] == "Length of cable-3"));
    let count = format!("{} of {} rows", few.len() - 1, statistics.len());
    harness.get_by_label(&count);
}

#[test]
fn a_click_on_a_row_selects_its_pose_and_its_cable_everywhere() {
    let mut harness = opened();
    let mut lines = copied(&mut harness).into_iter();
    let is_of_cable = |line: &Vec<String>| line[1].starts_with("Tension of cable");
    let first = lines.find(is_of_cable).expect("tensions at home");
    let label = first.join(", ").replace('-', "\u{2212}");
    // Names of cables keep their hyphen.
    let label = label.replace("cable\u{2212}", "cable-");
    harness.get_by_label(&label).click();
    harness.run_ok();
    let pose = first[0].parse().expect("a pose");
    let selection = harness.state().state.model.selection;
    assert_eq!(selection.pose, Some(pose));
    assert!(selection.cable.is_some());
    assert_ne!(selection, Selection::default());
}

#[test]
fn a_narrow_table_is_leafed_through_and_keeps_the_names_of_its_rows() {
    let mut harness = opened();
    harness.set_size(egui::vec2(1024.0, 640.0));
    harness.run_ok();
    let heads = |harness: &Harness<'_, App>| -> Vec<bool> {
        let names = ["pose", "reading", "residual", "on pulley"];
        let is_seen = |name: &&str| harness.query_by_label(&format!("Sort by {name}")).is_some();
        names.iter().map(is_seen).collect()
    };
    assert_eq!(heads(&harness), [true, true, true, false]);
    for _ in 0..8 {
        let right = harness.get_by_label("Columns to the right");
        if right.accesskit_node().is_disabled() {
            break;
        }
        right.click();
        harness.run_ok();
    }
    assert_eq!(heads(&harness), [true, true, false, true]);
    press(&mut harness, "Columns to the left");
    assert!(harness.query_by_label("Sort by on pulley").is_none());
    assert_eq!(copied(&mut harness)[0].len(), 10, "all columns are copied");
}

#[test]
fn values_have_their_intervals() {
    let mut harness = opened();
    press(&mut harness, "Statistics of: Readings");
    press(&mut harness, "Values");
    let lines = copied(&mut harness);
    let statistics = {
        let fit = document(&harness).fit().expect("a fit");
        value_statistics(fit)
    };
    assert_eq!(lines.len(), 1 + statistics.len());
    assert_eq!(lines[0][7], "95 % interval");
    for (line, one) in lines[1..].iter().zip(&statistics) {
        let ends: Vec<f64> = line[7]
            .split(" to ")
            .map(|end| end.parse().expect("a number"))
            .collect();
        let value: f64 = line[3].parse().expect("a number");
        assert!(ends[0] <= value && value <= ends[1], "{line:?}, {one:?}");
    }
}

//! One residual, one sign, one name: the doctor's plot, the plots below, the 3D view and the list of suspicious readings
//! show the same number for every kind of reading.

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_core::diagnosis::Quantity;
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{IdentificationCommand, ReportCommand, ViewCommand};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::model::plot_preparation::residuals;
use tautline_workbench::shell::App;
use tautline_workbench::views::robot_3d::drawing::CableColour;
use tautline_workflow::diagnosis::dependences::figures;
use tautline_workflow::identification::{RESIDUAL, group_of, reading_name, reading_statistics};
use tautline_workflow::report::ReportFormat;
use tautline_workflow::wording::sentence;
use tautline_workflow::wording::units::signed;

use crate::measured::{Measured, document, give, press};
use crate::support::{settle, type_into};

/// Largest difference between two fits of the same model (standard deviations): each ends where the next step would gain
/// almost nothing.
const SAME: f64 = 1e-3;

#[test]
fn the_doctor_the_plots_the_view_and_the_list_show_the_same_residuals() {
    let mut kinds = Vec::new();
    let mut kinds_listed = std::collections::BTreeSet::new();
    for effect in [
        ("winch_scale", "cable-3", &[("scale", 0.02)][..]),
        ("force_bias", "cable-3", &[("bias", 25.0)][..]),
        ("laser_scale", "", &[("scale", 0.05)][..]),
    ] {
        let measured = Measured::mini(40, &[effect]);
        let mut harness = measured.opened();
        give(&mut harness, IdentificationCommand::Identify);
        give(&mut harness, IdentificationCommand::Diagnose);
        let open = document(&harness);
        let fit = open.fit().expect("a fit");
        let diagnosed = open.diagnosis().expect("a diagnosis");
        for (index, figure) in figures(diagnosed) {
            let found = &diagnosed.diagnosis.discrepancies[index];
            kinds.push(found.quantity);
            assert_eq!(
                figure.y.title(),
                format!("{RESIDUAL} (standard deviations)")
            );
            let shown = residuals(fit, found.quantity, found.cable);
            let labels = &fit.dataset.measurements.labels;
            let points = figure.series[0].points();
            assert!(points.len() > 30, "{:?}", found.quantity);
            for point in points {
                let pose = point.pose.expect("a pose");
                let mut same = shown.iter().filter(|(row, _)| labels[*row] == pose);
                assert!(
                    same.any(|(_, value)| (value - point.y).abs() < SAME),
                    "{:?} at pose {pose}: {}",
                    found.quantity,
                    point.y
                );
            }
        }
        // The table of statistics has them all, tensions as well.
        for one in reading_statistics(fit) {
            let shown = residuals(fit, one.quantity, one.cable);
            let labels = &fit.dataset.measurements.labels;
            let mut same = shown.iter().filter(|(row, _)| labels[*row] == one.pose);
            let Some(normalised) = one.normalised else {
                continue;
            };
            assert!(same.any(|(_, value)| *value == normalised), "{}", one.name);
            kinds_listed.insert(one.quantity);
        }
        // The 3D view has the largest of the lengths of each pose, with its sign.
        let view = &harness.state().state.views.robot_3d;
        let scene = view.scene().expect("a scene");
        for pose in scene.measured.iter().filter(|pose| pose.residual.is_some()) {
            let lengths = (0..8).flat_map(|cable| residuals(fit, Quantity::Length, Some(cable)));
            let own =
                lengths.filter(|(row, _)| fit.dataset.measurements.labels[*row] == pose.label);
            let largest = own
                .map(|(_, value)| value)
                .max_by(|a, b| a.abs().total_cmp(&b.abs()));
            assert_eq!(pose.residual, largest, "pose {}", pose.label);
        }
        // The list of suspicious readings, in words.
        for reading in fit.suspects.iter().flatten() {
            let Some((quantity, cable)) = group_of(reading.kind) else {
                continue;
            };
            let shown = residuals(fit, quantity, cable);
            let (_, value) = shown
                .iter()
                .find(|(row, _)| *row == reading.row)
                .expect("there");
            let words = format!("off by {value:+.1} standard deviations");
            assert!(fit.suspect_line(reading).ends_with(&words), "{words}");
        }
    }
    let listed = [Quantity::Length, Quantity::Tension, Quantity::Laser];
    assert!(
        kinds_listed.into_iter().eq(listed),
        "every kind of reading of MINI"
    );
    for quantity in [Quantity::Length, Quantity::Tension] {
        assert!(kinds.contains(&quantity), "{quantity:?} is among {kinds:?}");
    }
}

/// Content of a plot as it is saved: name of the series, pose and value.
fn saved(harness: &mut Harness<'_, App>, tab: &str, measured: &Measured) -> Vec<Shown> {
    if harness.query_by_role_and_label(Role::Button, tab).is_none() {
        press(harness, "More plots");
    }
    let found = harness.query_all_by_role_and_label(Role::Button, tab);
    found.last().expect("a tab").click_accesskit();
    harness.step();
    settle(harness);
    if tab == "Tensions" {
        let inner = harness.query_all_by_role_and_label(Role::Button, "Residuals");
        let lowest = inner.max_by(|a, b| a.rect().min.y.total_cmp(&b.rect().min.y));
        lowest
            .expect("tensions or their residuals")
            .click_accesskit();
        harness.step();
        settle(harness);
    }
    let path = measured.beside(&format!("{tab}.csv"));
    press(harness, "Save plot");
    press(harness, "Table (CSV)");
    let name = path.display().to_string();
    type_into(harness, Role::TextInput, "Path of the file", &name);
    press(harness, "Save");
    settle(harness);
    let text = std::fs::read_to_string(&path).expect("the file");
    let line = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let value = cells[3].parse().expect("a number");
        (
            cells[0].to_owned(),
            cells[1].parse().expect("a pose"),
            value,
        )
    };
    text.lines().skip(1).map(line).collect()
}

type Shown = (String, i64, f64);

/// The words and numbers of a page, separated by bars.
fn plain(html: &str) -> String {
    let mut text = String::new();
    for part in html.split('<') {
        let words = part.split_once('>').map_or(part, |(_, words)| words).trim();
        if !words.is_empty() {
            text += words;
            text.push('|');
        }
    }
    text.replace('\u{2212}', "-")
}

#[test]
fn the_plots_below_and_the_report_show_the_residuals_of_the_table() {
    let winch = ("winch_scale", "cable-3", &[("scale", 0.02)][..]);
    let mut kinds = 0;
    for (measured, tabs) in [
        (
            Measured::mini(30, &[winch]),
            &["Residuals", "Distances", "Tensions"][..],
        ),
        (Measured::tracked(20), &["Residuals", "Tracker"][..]),
    ] {
        let mut harness = measured.opened();
        give(&mut harness, IdentificationCommand::Identify);
        let phase = ViewCommand::Go(Screen::Phase(Phase::Identification));
        give(&mut harness, phase);
        let fit = document(&harness).fit().cloned().expect("a fit");
        let table = reading_statistics(&fit);
        for tab in tabs {
            let (quantity, in_newtons) = match *tab {
                "Distances" => (Quantity::Laser, false),
                "Tensions" => (Quantity::Tension, true),
                "Tracker" => (Quantity::TrackerPosition, false),
                _ => (Quantity::Length, false),
            };
            let shown = saved(&mut harness, tab, &measured);
            assert!(shown.len() >= 20, "{tab}: {}", shown.len());
            for (name, pose, value) in shown {
                let own = table.iter().filter(|one| {
                    let of = one.cable.map(|cable| &fit.dataset.robot.cables[cable].name);
                    one.quantity == quantity && one.pose == pose && of.is_none_or(|of| *of == name)
                });
                let mut values = own.filter_map(|one| match in_newtons {
                    true => Some(one.residual),
                    false => one.normalised,
                });
                let is_same = |other: f64| (other - value).abs() <= 1e-3 * value.abs().max(1e-3);
                assert!(values.any(is_same), "{tab}, {name} at pose {pose}: {value}");
            }
            kinds += 1;
        }
        let path = measured.beside("report.html");
        give(&mut harness, ReportCommand::AskSave(ReportFormat::Html));
        let typed = path.display().to_string();
        type_into(&mut harness, Role::TextInput, "Path of the file", &typed);
        press(&mut harness, "Save report");
        settle(&mut harness);
        let report = plain(&std::fs::read_to_string(&path).expect("a report"));
        for reading in fit.suspects.iter().flatten().take(3) {
            let name = sentence(&reading_name(&fit.dataset.robot, reading.kind));
            let pose = fit.dataset.measurements.labels[reading.row];
            let size = signed(reading.normalised().expect("a residual"), 1);
            let row = format!("|{name}|{pose}|{size}|");
            assert!(report.contains(&row), "{row}");
        }
    }
    assert_eq!(kinds, 5);
}

#[test]
fn choosing_a_finding_sets_the_plot_the_colours_and_the_selection() {
    let measured = Measured::mini(40, &[("winch_scale", "cable-3", &[("scale", 0.02)])]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, IdentificationCommand::Diagnose);
    assert!(harness.query_by_label("Plot: By variable").is_none());
    press(&mut harness, "Show the residuals of finding 1");
    let state = &harness.state().state;
    assert_eq!(state.model.selection, Selection::cable(2));
    assert_eq!(state.views.robot_3d.options.colour, CableColour::Residual);
    harness.get_by_label_contains("Plot: By variable");
}

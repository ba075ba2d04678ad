//! One residual, one sign, one name: the doctor's plot, the plots below, the 3D view and the list of suspicious readings
//! show the same number for every kind of reading.

use egui_kittest::kittest::Queryable;
use tautline_core::diagnosis::Quantity;
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::IdentificationCommand;
use tautline_workbench::model::plot_preparation::residuals;
use tautline_workbench::views::robot_3d::drawing::CableColour;
use tautline_workflow::identification::{RESIDUAL, group_of, reading_statistics};

use crate::measured::{Measured, document, give, press};

/// How far two fits of the same model may be from each other (standard deviations): they end where the next step gains
/// nothing worth taking.
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
        let figures = &harness.state().state.model.identification.figures;
        for (index, figure) in figures {
            let found = &diagnosed.diagnosis.discrepancies[*index];
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

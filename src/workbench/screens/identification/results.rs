//! Results of the identification.

use std::sync::Arc;

use egui::Ui;
use nalgebra::Vector3;
use tautline_core::estimation::{ParameterId, Solution};

use super::rows::{deviation, heads, millimetres, row};
use super::{Panel, doctor, identify, suspects};
use crate::model::Selection;
use crate::model::command::{IDENTIFYING, ViewCommand};
use crate::model::next_step::of_fit;
use crate::theme::{self, GRID};
use crate::views::pulley_inspector;
use crate::widgets::{Cell, UiExt, Verdict, checkbox};
use tautline_workflow::identification::{
    FitVerdict, Identification, entry_point_covariance, entry_point_sd,
};
use tautline_workflow::wording::units::with_sd;
use tautline_workflow::wording::{p_value, ratio, sentence};

pub fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    let Some(fit) = panel.open.fit().cloned() else {
        return;
    };
    ui.section("Result");
    if !panel.open.fit_is_current() && !panel.model.tasks.runs(IDENTIFYING) {
        ui.doubtful("The inputs have changed: identify again.");
    }
    adequacy(ui, panel, &fit);
    if panel.open.fit_is_current() && !panel.open.diagnosis_is_current() {
        doctor::ask(ui, panel);
    }
    published(ui, &fit);
    pulleys(ui, panel, &fit);
    others(ui, &fit);
    if !fit.open.is_empty() {
        ui.section("Not determined by the data");
        for open in &fit.open {
            ui.doubtful(&format!("{}.", sentence(&open.sentence)));
        }
    }
    suspects::show(ui, panel, &fit);
}

/// Verdict on the fit, with the one before the last change.
pub fn adequacy(ui: &mut Ui, panel: &Panel<'_>, fit: &Identification) {
    let solution = &fit.solution;
    let wrong = match panel.open.fit_is_current() {
        true => Verdict::Bad,
        false => Verdict::Neutral,
    };
    for problem in of_fit(panel.model, panel.open, fit) {
        ui.verdict(wrong, &problem.text);
    }
    let explains = FitVerdict::of(solution.p_value());
    let kind = match explains {
        FitVerdict::Adequate => Verdict::Good,
        FitVerdict::Doubtful | FitVerdict::NoiseOverstated => Verdict::Doubtful,
        FitVerdict::Inadequate | FitVerdict::Untested => Verdict::Neutral,
    };
    if explains == FitVerdict::Inadequate {
        ui.muted("The standard deviations are valid only if it does.");
    } else {
        ui.verdict(kind, &format!("{}.", sentence(explains.words())));
    }
    if let Some(missed) = fit.residual_ratio() {
        let before = panel.model.identification.before.as_ref();
        let text = format!(
            "The residuals are {} times the expected noise.",
            ratio(missed)
        );
        let test = solution
            .p_value()
            .map_or_else(String::new, |p| format!(", {}", p_value(p)));
        let tip = format!(
            "Chi-square {:.1} for {:.0} degrees of freedom{test}; a correct model gives about 1.",
            solution.chi2, solution.degrees_of_freedom
        );
        ui.muted(&text).on_hover_text(tip);
        if let Some((before, old)) = before.and_then(|before| Some((before, before.missed?))) {
            ui.muted(&format!(
                "Before: {} times (chi-square {:.1} for {:.0} degrees of freedom, now {:.1} for {:.0}). Last change: {}.",
                ratio(old),
                before.chi2,
                before.degrees_of_freedom,
                solution.chi2,
                solution.degrees_of_freedom,
                before.what
            ));
        }
    }
}

fn published(ui: &mut Ui, fit: &Identification) {
    match &fit.published {
        None => {}
        Some(Err(error)) => ui.doubtful(&format!("{}: it cannot be compared.", sentence(error))),
        Some(Ok(published)) => {
            let solution = &published.poses.solution;
            let missed = (solution.chi2 / solution.degrees_of_freedom.max(1.0)).sqrt();
            let end = if published.converged() {
                ""
            } else {
                " It did not converge."
            };
            ui.doubtful(&format!(
                "The published method leaves residuals of {} times the expected noise.{end} It takes some coordinates as given and applies no weights: for comparison only.",
                ratio(missed)
            ));
        }
    }
}

/// Displacement of an entry point, with its standard deviation along that direction; `None` if it is not determined.
fn moved(solution: &Solution, cable: usize, way: Vector3<f64>) -> (f64, Option<f64>) {
    let along = way.try_normalize(0.0).unwrap_or_else(Vector3::x);
    // Parameters that were not estimated are exact.
    let variance = entry_point_covariance(solution, cable)
        .map_or(0.0, |covariance| (covariance * along).dot(&along));
    let sd = solution.covariance.as_ref();
    (way.norm(), sd.map(|_| variance.max(0.0).sqrt()))
}

fn pulleys(ui: &mut Ui, panel: &mut Panel<'_>, fit: &Arc<Identification>) {
    ui.add_space(2.0 * GRID);
    ui.horizontal(|ui| {
        ui.label(egui::RichText::new("Pulleys").font(theme::strong(13.0)));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Max), |ui| {
            checkbox(ui, &mut panel.memory.show_axes, "Show axes");
        });
    });
    let compared = match &fit.published {
        Some(Ok(published)) => Some(&published.result.entry_points_m),
        _ => None,
    };
    let mut shares = vec![5.0, 4.0, 4.0];
    let mut titles = vec!["Cable", "Moved (mm)", "± (mm)"];
    if compared.is_some() {
        shares.push(5.0);
        titles.push("Published (mm)");
    }
    heads(ui, &shares, &titles);
    for (index, cable) in panel.open.session().robot.cables.iter().enumerate() {
        let nominal = Vector3::from(cable.pulley.entry_point_m);
        let entry_points = &fit.solution.globals.entry_points;
        let Some(found) = entry_points.get(index).map(|p| Vector3::from(*p)) else {
            return;
        };
        let (size, sd) = moved(&fit.solution, index, found - nominal);
        let selected = panel.model.selection.cable == Some(index);
        let mut cells = vec![
            Cell::new(format!("{}  {}", index + 1, cable.name))
                .coloured(theme::of(ui).cable(index)),
            Cell::new(millimetres(size, sd)),
            Cell::new(deviation(sd)),
        ];
        let other = compared
            .and_then(|points| points.get(index))
            .map(|p| Vector3::from(*p));
        if let Some(other) = other {
            cells.push(Cell::new(millimetres((other - nominal).norm(), sd)));
        }
        let name = format!(
            "Cable {}: moved {} mm, standard deviation {} mm",
            index + 1,
            millimetres(size, sd),
            deviation(sd)
        );
        let line = row(ui, &shares, &cells, Some(selected), &name);
        if line.double_clicked() {
            panel.outbox.send(ViewCommand::Inspect(Some(index)));
        } else if line.clicked() {
            let selection = if selected {
                Selection::default()
            } else {
                Selection::cable(index)
            };
            panel.outbox.send(ViewCommand::Select(selection));
        }
        if panel.memory.show_axes || selected {
            axes(ui, &fit.solution, index, [nominal, found], other);
        }
        if selected {
            pulley_inspector::button(ui, index, &cable.name, panel.outbox);
        }
    }
    ui.muted("Moved: distance from the nominal position. ±: standard deviation in that direction. Double-click a pulley to inspect it.");
}

/// Coordinates of a pulley.
fn axes(
    ui: &mut Ui,
    solution: &Solution,
    cable: usize,
    [nominal, found]: [Vector3<f64>; 2],
    published: Option<Vector3<f64>>,
) {
    let mut shares = vec![1.6, 3.5, 3.5, 3.5, 2.6];
    let mut titles = vec!["mm", "Nominal", "Identified", "Difference", "±"];
    if published.is_some() {
        shares.push(3.6);
        titles.push("Published");
    }
    heads(ui, &shares, &titles);
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        let sd = entry_point_sd(solution, cable, axis);
        let number = |value: f64| millimetres(value, sd);
        let difference = found[axis] - nominal[axis];
        let mut texts = vec![
            number(nominal[axis]),
            number(found[axis]),
            format!(
                "{}{}",
                if difference > 0.0 { "+" } else { "" },
                number(difference)
            ),
            deviation(sd),
        ];
        texts.extend(published.map(|point| number(point[axis])));
        let name = format!("Cable {} {letter}: {}", cable + 1, texts.join(", "));
        let mut cells = vec![Cell::new(letter).coloured(theme::of(ui).muted)];
        cells.extend(texts.into_iter().map(Cell::new));
        row(ui, &shares, &cells, None, &name);
    }
}

/// Changes of home pose and target plane, with standard deviations.
fn others(ui: &mut Ui, fit: &Identification) {
    let robot = &fit.dataset.robot;
    let globals = &fit.solution.globals;
    let home = robot.home.map(|home| globals.home.difference(&home.pose()));
    let plane = robot
        .laser
        .map(|laser| globals.plane_offset_m - laser.target_plane.offset_m);
    let parameters = fit.solution.parameters.iter().enumerate();
    let lines: Vec<(String, String)> = parameters
        .filter_map(|(index, parameter)| {
            let change = match parameter.id {
                ParameterId::Home(coordinate) => home?[coordinate.index()],
                ParameterId::PlaneOffset => plane?,
                _ => return None,
            };
            let sd = fit.solution.standard_deviation(index).unwrap_or(f64::NAN);
            Some((
                sentence(&parameter.name),
                with_sd(change, sd, parameter.unit),
            ))
        })
        .collect();
    if lines.is_empty() {
        return;
    }
    ui.section(match plane {
        Some(_) => "Home pose and target plane: change",
        None => "Home pose: change",
    });
    identify::pair(ui, "home and plane", &lines);
}

//! Predicted accuracy of the planned poses.

use std::collections::HashSet;

use egui::{CollapsingHeader, DragValue, Ui};
use tautline_core::planning::DesignCriteria;
use tautline_session::Session;

use super::PanelState;
use crate::model::command::EXPECTING;
use crate::model::{Model, Selection};
use crate::theme::GRID;
use crate::views::plots::small;
use crate::widgets::{UiExt, Verdict, fault_button, fault_window};
use tautline_workflow::isolability::{IsolabilityTable, SEEN};
use tautline_workflow::planning::PlanSummary;
use tautline_workflow::plot::figure::{Axis, Curve, Figure, Ink, Marker, Point, Series};

/// Draws the prediction, and whether it is reached.
pub(super) fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState) {
    let Some(open) = &model.open else {
        return;
    };
    let session = open.session();
    if session.plan.is_empty() {
        if session.measurements.is_empty() {
            ui.muted("No poses are planned yet. A plan predicts how accurately the pulleys will be identified.");
        }
        return;
    }
    let outlook = match model.outlook.as_ref().map(|outlook| &outlook.result) {
        Some(Ok(outlook)) => outlook,
        Some(Err(why)) => {
            ui.neutral(&format!(
                "The accuracy of this plan cannot be predicted: {why}."
            ));
            return;
        }
        None if model.tasks.runs(EXPECTING) => {
            ui.busy("Predicting the accuracy of this plan.");
            return;
        }
        None => return,
    };
    let key = (open.id(), open.revision(), outlook.poses.len());
    let done = *panel.done.get(key, || done(outlook, session));
    let words = words(outlook);
    let kind = match outlook.expected.mean_m {
        Some(sd_m) if sd_m * 1e3 <= panel.goal_mm => Verdict::Good,
        Some(_) => Verdict::Neutral,
        None => Verdict::Doubtful,
    };
    ui.verdict(kind, &words);
    let unchecked = session.robot.unchecked_tensions().map(str::to_owned);
    let gains = outlook.home.sentence().into_iter();
    let gains = gains.chain(outlook.tape.clone());
    for sentence in unchecked.into_iter().chain(gains) {
        ui.muted(&sentence);
    }
    if let Some(table) = &outlook.isolability {
        faults(ui, table, &mut panel.shows_faults);
    }
    goal(ui, &mut panel.goal_mm);
    course(ui, outlook, done, panel.goal_mm);
    enough(ui, outlook, panel.goal_mm, done);
    CollapsingHeader::new("Show details").show(ui, |ui| details(ui, outlook));
}

/// Summary of the detectable faults, and their matrix in a separate window.
fn faults(ui: &mut Ui, table: &IsolabilityTable, is_shown: &mut bool) {
    ui.horizontal(|ui| {
        fault_button(ui, is_shown).on_hover_text(table.summary());
        let seen = table.kinds.iter().filter(|kind| kind.detection[0] >= SEEN);
        let seen = seen.count();
        ui.muted(&format!(
            "{seen} of {} kinds of fault would be seen",
            table.kinds.len()
        ));
    });
    fault_window(ui, table, is_shown);
}

/// Number of planned poses that are measured and not excluded, without the home pose.
fn done(outlook: &PlanSummary, session: &Session) -> usize {
    let planned = outlook.poses.iter().map(|pose| pose.label);
    let mut open_yet: HashSet<i64> = planned.filter(|label| *label != 0).collect();
    let of_plan = open_yet.len();
    let excluded = session.excluded();
    // Plans are short, while there may be very many measurements.
    let measured = session.measurements.labels.iter();
    for label in measured.filter(|label| !excluded.contains(label)) {
        open_yet.remove(label);
    }
    of_plan - open_yet.len()
}

fn words(outlook: &PlanSummary) -> String {
    let Some(sd_m) = outlook.expected.mean_m else {
        return "These poses do not determine all coordinates of the pulleys: plan more poses."
            .into();
    };
    let random = outlook.random.mean_m.map_or_else(String::new, |random_m| {
        format!(", {:.1} times better than random poses", random_m / sd_m)
    });
    format!(
        "Expected standard deviation of the pulleys: {:.2} mm{random}.",
        sd_m * 1e3
    )
}

fn goal(ui: &mut Ui, goal_mm: &mut f64) {
    ui.horizontal(|ui| {
        let label = ui.label("Goal");
        let field = DragValue::new(goal_mm)
            .range(0.01..=100.0)
            .speed(0.05)
            .max_decimals(2)
            .suffix(" mm");
        ui.add(field).labelled_by(label.id);
    });
}

/// Largest number of marked poses in the plot of the predicted standard deviation.
const MARKED: usize = 60;

/// Predicted standard deviation over the number of poses: for the whole plan, and for the poses measured so far.
fn course(ui: &mut Ui, outlook: &PlanSummary, done: usize, goal_mm: f64) {
    let figure = course_figure(&outlook.after_m, done, goal_mm);
    if figure.curves.iter().all(|curve| curve.points.len() < 2) {
        return;
    }
    let name = "Expected standard deviation over poses";
    small::show(ui, name, &figure, 34.0 * GRID, Selection::default());
}

fn course_figure(after_m: &[Option<f64>], done: usize, goal_mm: f64) -> Figure {
    let known = after_m.iter().enumerate();
    let known = known.filter_map(|(poses, sd_m)| Some((poses, sd_m.filter(|sd| *sd > 0.0)?)));
    let known: Vec<(usize, f64)> = known
        .map(|(poses, sd_m)| (poses, (sd_m * 1e3).log10()))
        .collect();
    // Of very many poses only as many are marked as can be distinguished, including the first and the last.
    let last = after_m.len().saturating_sub(1);
    let every = after_m.len().div_ceil(MARKED).max(1);
    let is_shown = |poses: usize| poses < MARKED || poses.is_multiple_of(every) || poses == last;
    let expected = known.iter().filter(|(poses, _)| is_shown(*poses));
    let expected = expected.map(|(poses, sd)| [*poses as f64, *sd]).collect();
    let step = done.div_ceil(MARKED).max(1);
    let measured = known
        .iter()
        .filter(|(poses, _)| (1..=done).contains(poses) && (done - poses).is_multiple_of(step));
    let points = measured
        .map(|(poses, sd)| Point::new(*poses as f64, *sd))
        .collect();
    let ends = [0.0, after_m.len().saturating_sub(1) as f64];
    let line = |name: &str, ink: Ink, dashed: bool, points: Vec<[f64; 2]>| Curve {
        name: name.to_owned(),
        ink,
        dashed,
        points,
    };
    let goal = ends.map(|poses| [poses, goal_mm.log10()]).to_vec();
    Figure {
        x: Axis::whole("Poses"),
        y: Axis {
            is_logarithmic: true,
            ..Axis::new("Standard deviation", "mm")
        },
        series: vec![Series::new("measured", Ink::Accent, Marker::Circle, points)],
        curves: vec![
            line("expected", Ink::Muted, false, expected),
            line("goal", Ink::Good, true, goal),
        ],
        ..Figure::default()
    }
}

/// Message once the goal is reached.
fn enough(ui: &mut Ui, outlook: &PlanSummary, goal_mm: f64, done: usize) {
    let sd_m = outlook.after_m.get(done).copied().flatten();
    let all = outlook.after_m.len().saturating_sub(1);
    if let Some(sd_mm) = sd_m
        .map(|sd_m| sd_m * 1e3)
        .filter(|_| done > 0 && done < all)
    {
        if sd_mm <= goal_mm {
            ui.good(&format!(
                "Goal reached: after {done} poses the standard deviation is {sd_mm:.2} mm. You may stop here."
            ));
        } else {
            ui.muted(&format!("After {done} of {all} poses: {sd_mm:.2} mm."));
        }
    }
}

/// Predicted standard deviation (m) of a plan.
type Criterion = fn(&DesignCriteria) -> Option<f64>;

fn details(ui: &mut Ui, outlook: &PlanSummary) {
    let travel = format!("{:.1}", outlook.travel_m);
    ui.value("Travel distance", &travel, "m");
    ui.muted("These poses / the same number of random poses:");
    let metres: [(&str, Criterion); 3] = [
        ("A-optimality: mean of the coordinates", |c| c.mean_m),
        ("E-optimality: worst direction", |c| c.worst_m),
        ("I-optimality: platform position after adjustment", |c| {
            c.platform_m
        }),
    ];
    for (name, of) in metres {
        let [planned, random] = [&outlook.expected, &outlook.random].map(|criteria| {
            let undetermined = || "undetermined".to_owned();
            of(criteria).map_or_else(undetermined, |m| format!("{:.2}", m * 1e3))
        });
        ui.value(name, &format!("{planned} / {random}"), "mm");
    }
    let [planned, random] = [&outlook.expected, &outlook.random].map(|criteria| criteria.log_det);
    let name = "D-optimality: log determinant of the information";
    ui.value(name, &format!("{planned:.1} / {random:.1}"), "");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_measured_part_of_the_curve_grows_with_the_poses() {
        let after_m = [None, Some(8e-3), Some(4e-3), Some(2e-3), Some(1e-3)];
        for done in 0..=4 {
            let figure = course_figure(&after_m, done, 2.0);
            assert_eq!(figure.series[0].points().len(), done);
            assert_eq!(figure.curves[0].points.len(), 4);
            assert_eq!(
                figure.curves[1].points,
                [[0.0, 2.0_f64.log10()], [4.0, 2.0_f64.log10()]]
            );
        }
        let many: Vec<_> = (1..=10_000).map(|k| Some(1.0 / f64::from(k))).collect();
        let figure = course_figure(&many, 7001, 2.0);
        let [points, line] = [
            figure.series[0].points().len(),
            figure.curves[0].points.len(),
        ];
        assert!(
            points <= MARKED && line <= 2 * MARKED + 2,
            "{points} {line}"
        );
        assert_eq!(figure.series[0].points().last().map(|p| p.x), Some(7001.0));
        assert_eq!(figure.curves[0].points.last().map(|p| p[0]), Some(9999.0));
        let all = course_figure(&after_m, 4, 2.0);
        let last = all.series[0].points()[3];
        assert!(
            (last.x - 4.0).abs() + last.y.abs() < 1e-12,
            "1 mm after 4 poses"
        );
    }
}

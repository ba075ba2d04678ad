//! Comparison of two sessions: have pulleys moved, or is the difference noise?

mod chooser;
mod others;
mod pulleys;

use std::sync::Arc;

use egui::{CentralPanel, Panel, ScrollArea, Spinner, Ui};

use crate::model::command::{COMPARING, CompareCommand, Outbox, ViewCommand};
use crate::model::comparison::{Compared, SessionSource};
use crate::model::part::ScreenPart;
use crate::model::{Model, OpenSession};
use crate::theme::GRID;
use crate::views::ViewStates;
use crate::views::plots::{residuals_of_both, small};
use crate::views::robot_3d::scene::{Scene, SceneInputs};
use crate::views::robot_3d::show_beside;
use crate::widgets::{UiExt, Verdict, one_part, panel_frame};
use tautline_workflow::comparison::{unexplained, verdict as in_words};
use tautline_workflow::plot::figure::Figure;
use tautline_workflow::samples::Sample;

#[derive(Debug, Default)]
pub struct PanelState {
    paths: [String; 2],
    /// Available sample sessions, looked up once.
    samples: Option<Vec<Sample>>,
    /// Part shown in a small window.
    part: ScreenPart,
    /// Comparison drawn last.
    drawn: Option<ComparisonView>,
}

/// Comparison prepared for drawing.
#[derive(Debug)]
struct ComparisonView {
    compared: Arc<Compared>,
    /// Both geometries.
    scene: Arc<Scene>,
    /// Residuals of the cable lengths of both.
    residuals: Figure,
}

impl ComparisonView {
    fn new(compared: &Arc<Compared>) -> Self {
        let fits = compared.runs.each_ref().map(|run| run.fit.as_ref());
        let [first, _] = fits;
        let subject = SceneInputs {
            fit: Some(first),
            ..SceneInputs::new(&first.dataset.robot, &first.dataset.measurements)
        };
        Self {
            scene: Arc::new(subject.scene().compared(&compared.comparison)),
            residuals: residuals_of_both(fits),
            compared: Arc::clone(compared),
        }
    }
}

/// Width of the window (points) below which one part is shown at a time.
const COMPACT: f32 = 900.0;
/// Parts, and their titles in a small window.
const PARTS: [(ScreenPart, &str); 3] = [
    (ScreenPart::Panel, "Differences"),
    (ScreenPart::Robot, "3D view"),
    (ScreenPart::Plots, "Residuals"),
];

pub fn show(
    ui: &mut Ui,
    model: &Model,
    panel: &mut PanelState,
    views: &mut ViewStates,
    outbox: &mut Outbox,
) {
    Panel::top("compared sessions")
        .frame(panel_frame(ui))
        .show(ui, |ui| chooser::show(ui, model, panel, outbox));
    match model.comparison.result() {
        Some(Ok(compared)) => {
            let known = panel.drawn.take();
            let known = known.filter(|drawn| Arc::ptr_eq(&drawn.compared, compared));
            let drawn = known.unwrap_or_else(|| {
                views.compared_3d.look_anew();
                ComparisonView::new(compared)
            });
                let draw = |ui: &mut Ui, part: ScreenPart| match part {
                    ScreenPart::Panel => differences(ui, model, &drawn, views, outbox),
                    ScreenPart::Robot => robots(ui, model, &drawn, views, outbox),
                    ScreenPart::Plots => residuals(ui, model, &drawn, outbox),
                };
                if ui.available_width() < COMPACT {
                    one_part(ui, &mut panel.part, PARTS, draw);
                } else {
                    wide(ui, draw);
                }
            panel.drawn = Some(drawn);
        }
        Some(Err(error)) => {
            ui.add_space(6.0 * GRID);
            ui.horizontal(|ui| {
                ui.add_space(3.0 * GRID);
                ui.bad(error);
            });
        }
        None if model.tasks.runs(COMPARING) => {
            ui.centered_and_justified(|ui| ui.add(Spinner::new()));
        }
        None => ui.empty("Choose two sessions of the same robot, such as before and after a repair. The comparison shows which pulleys have moved and what is only noise."),
    }
}

/// All parts side by side.
fn wide(ui: &mut Ui, mut draw: impl FnMut(&mut Ui, ScreenPart)) {
    let side = panel_frame(ui);
    Panel::right("differences")
        .frame(side)
        .default_size(600.0)
        .size_range(420.0..=760.0)
        .show(ui, |ui| draw(ui, ScreenPart::Panel));
    Panel::bottom("residuals of both")
        .frame(side)
        .default_size(230.0)
        .size_range(140.0..=500.0)
        .show(ui, |ui| draw(ui, ScreenPart::Plots));
    CentralPanel::no_frame().show(ui, |ui| draw(ui, ScreenPart::Robot));
}

fn robots(
    ui: &mut Ui,
    model: &Model,
    drawn: &ComparisonView,
    views: &mut ViewStates,
    outbox: &mut Outbox,
) {
    let (view, hovered) = (&mut views.compared_3d, &mut views.hovered);
    show_beside(ui, &drawn.scene, model.selection, view, hovered, outbox);
}

/// Panel on the right: the verdict, then all differences.
fn differences(
    ui: &mut Ui,
    model: &Model,
    drawn: &ComparisonView,
    views: &mut ViewStates,
    outbox: &mut Outbox,
) {
    let compared = &drawn.compared;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let comparison = &compared.comparison;
        let kind = if comparison.is_different() {
            Verdict::Doubtful
        } else {
            Verdict::Good
        };
        ui.verdict(kind, &in_words(comparison));
        for sentence in unexplained(comparison, ["A", "B"]) {
            ui.bad(&sentence);
        }
        if is_outdated(model, compared) {
            ui.doubtful("The open session was changed since it was compared.");
            if ui.button("Compare again").clicked() {
                outbox.send(CompareCommand::Again);
            }
        }
        if let Some(cable) = pulleys::show(ui, model, comparison, outbox) {
            views.compared_3d.frame(cable);
        }
        others::show(ui, compared);
        ui.add_space(4.0 * GRID);
    });
}

fn is_outdated(model: &Model, compared: &Compared) -> bool {
    let inputs = model.open.as_ref().map(OpenSession::inputs);
    let mut runs = compared.runs.iter();
    runs.any(|run| run.source == SessionSource::Open && run.inputs != inputs)
}

fn residuals(ui: &mut Ui, model: &Model, drawn: &ComparisonView, outbox: &mut Outbox) {
    ui.horizontal_wrapped(|ui| {
        ui.section("Residuals of the lengths");
        ui.muted("A filled, B as rings, each over its own poses");
    });
    let height = ui.available_height().max(80.0);
    let name = "Plot: residuals of both sessions";
    if let Some(selection) = small::show(ui, name, &drawn.residuals, height, model.selection) {
        outbox.send(ViewCommand::Select(selection));
    }
}

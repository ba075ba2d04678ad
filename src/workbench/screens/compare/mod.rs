//! Two sessions side by side: have pulleys moved, or is it noise?

mod chooser;
mod others;
mod pulleys;

use std::sync::Arc;

use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Spinner, Ui};

use crate::model::command::{COMPARING, CompareCommand, ViewCommand};
use crate::model::comparison::{Compared, Side, Source};
use crate::screens::Part;
use crate::shell::State;
use crate::theme::{self, GRID};
use crate::views::plots::small;
use crate::widgets::{Verdict, empty, muted, section, verdict};
use tautline_workflow::comparison::{unexplained, verdict as in_words};
use tautline_workflow::samples::Sample;

/// What the comparison remembers.
#[derive(Debug, Default)]
pub struct PanelState {
    sources: [Option<Source>; 2],
    /// What is typed.
    paths: [String; 2],
    /// The last comparison, or why there is none.
    result: Option<Result<Arc<Compared>, String>>,
    /// The last one there was, whose identifications are used again.
    known: Option<Arc<Compared>>,
    number: u64,
    /// Sample sessions that are there; looked up once.
    samples: Option<Vec<Sample>>,
}

impl PanelState {
    /// What was chosen.
    #[must_use]
    pub fn source(&self, side: Side) -> Option<&Source> {
        self.sources[side as usize].as_ref()
    }

    /// Chooses a session.
    pub fn choose(&mut self, side: Side, source: Source) {
        self.sources[side as usize] = Some(source);
    }

    /// Forgets what was chosen; its path stays to be changed.
    pub fn clear(&mut self, side: Side) {
        if let Some(Source::File(path)) = self.sources[side as usize].take() {
            self.paths[side as usize] = path.display().to_string();
        }
        self.begin();
    }

    /// Exchanges the two.
    pub fn swap(&mut self) {
        self.sources.swap(0, 1);
        self.paths.swap(0, 1);
    }

    /// Begins a comparison: the number of its result.
    pub fn begin(&mut self) -> u64 {
        self.result = None;
        self.number += 1;
        self.number
    }

    /// Whether a result of this number is waited for.
    #[must_use]
    pub fn expects(&self, number: u64) -> bool {
        self.number == number
    }

    /// Takes a result.
    pub fn take(&mut self, result: Result<Arc<Compared>, String>) {
        if let Ok(compared) = &result {
            self.known = Some(Arc::clone(compared));
        }
        self.result = Some(result);
    }

    /// The last comparison there was.
    #[must_use]
    pub fn known(&self) -> Option<&Arc<Compared>> {
        self.known.as_ref()
    }
}

/// Width of the window (points) below which one part is shown at a time.
const COMPACT: f32 = 900.0;

/// Draws the comparison.
pub fn show(ui: &mut Ui, state: &mut State) {
    let side = Frame::new()
        .fill(theme::of(ui).panel)
        .inner_margin(Margin::same(3 * GRID as i8));
    Panel::top("compared sessions")
        .frame(side)
        .show(ui, |ui| chooser::show(ui, state));
    match state.panels.compare.result.clone() {
        Some(Ok(compared)) if ui.available_width() < COMPACT => compact(ui, state, &compared),
        Some(Ok(compared)) => {
            Panel::right("differences")
                .frame(side)
                .default_size(600.0)
                .size_range(420.0..=760.0)
                .show(ui, |ui| differences(ui, state, &compared));
            Panel::bottom("residuals of both")
                .frame(side)
                .default_size(230.0)
                .size_range(140.0..=500.0)
                .show(ui, |ui| residuals(ui, state, &compared));
            CentralPanel::no_frame().show(ui, |ui| robots(ui, state, &compared));
        }
        Some(Err(error)) => {
            ui.add_space(6.0 * GRID);
            ui.horizontal(|ui| {
                ui.add_space(3.0 * GRID);
                verdict(ui, Verdict::Bad, &error);
            });
        }
        None if state.model.tasks.runs(COMPARING) => {
            ui.centered_and_justified(|ui| ui.add(Spinner::new()));
        }
        None => empty(
            ui,
            "Choose two sessions of the same robot, such as before and after a repair. Here it is told which pulleys have moved and what is only noise.",
        ),
    }
}

/// One part at a time, where the window has no room for all of them.
fn compact(ui: &mut Ui, state: &mut State, compared: &Compared) {
    let side = Frame::new()
        .fill(theme::of(ui).panel)
        .inner_margin(Margin::same(3 * GRID as i8));
    Panel::top("parts of the comparison")
        .frame(side)
        .show(ui, |ui| {
            ui.horizontal(|ui| {
                for (part, title) in [
                    (Part::Panel, "Differences"),
                    (Part::Robot, "3D view"),
                    (Part::Plots, "Residuals"),
                ] {
                    ui.selectable_value(&mut state.panels.part, part, title);
                }
            });
        });
    CentralPanel::no_frame()
        .frame(side)
        .show(ui, |ui| match state.panels.part {
            Part::Panel => differences(ui, state, compared),
            Part::Robot => robots(ui, state, compared),
            Part::Plots => residuals(ui, state, compared),
        });
}

/// Both robots in 3D.
fn robots(ui: &mut Ui, state: &mut State, compared: &Compared) {
    let view = &mut state.views.compared_3d;
    let (scene, selection) = (&compared.scene, state.model.selection);
    if let Some(selection) = view.show(ui, scene, selection, &mut state.views.hovered) {
        state.outbox.send(ViewCommand::Select(selection));
    }
}

/// The panel at the right: the verdict, then everything that differs.
fn differences(ui: &mut Ui, state: &mut State, compared: &Compared) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let comparison = &compared.comparison;
        let kind = if comparison.is_different() {
            Verdict::Doubtful
        } else {
            Verdict::Good
        };
        verdict(ui, kind, &in_words(comparison));
        for sentence in unexplained(comparison, ["A", "B"]) {
            verdict(ui, Verdict::Bad, &sentence);
        }
        if is_outdated(state, compared) {
            verdict(
                ui,
                Verdict::Doubtful,
                "The open session was changed since it was compared.",
            );
            if ui.button("Compare again").clicked() {
                state.outbox.send(CompareCommand::Again);
            }
        }
        pulleys::show(ui, state, comparison);
        others::show(ui, compared);
        ui.add_space(4.0 * GRID);
    });
}

fn is_outdated(state: &State, compared: &Compared) -> bool {
    let inputs = state
        .model
        .open
        .as_ref()
        .map(crate::model::OpenSession::inputs);
    let mut runs = compared.runs.iter();
    runs.any(|run| run.source == Source::Open && run.inputs != inputs)
}

/// The residuals of both sessions.
fn residuals(ui: &mut Ui, state: &mut State, compared: &Compared) {
    ui.horizontal(|ui| {
        section(ui, "Residuals of the lengths");
        muted(ui, "A filled, B as rings, each over its own poses");
    });
    let height = ui.available_height().max(80.0);
    let name = "Plot: residuals of both sessions";
    let figure = &compared.residuals;
    if let Some(selection) = small::show(ui, name, figure, height, state.model.selection) {
        state.outbox.send(ViewCommand::Select(selection));
    }
}

//! Plots below the 3D view, and small plots for panels.

mod bar;
mod choices;
mod dock;
mod hit;
mod kind;
mod list;
mod picture;
mod print;
mod scope;
mod screen;
pub(crate) mod small;
mod sources;
mod statistics;
mod view;

use std::sync::Arc;

use egui::{Id, Spinner, Ui};

use crate::model::command::{Format, Outbox, PlotCommand, ViewCommand};
use crate::model::edit::Edit;
use crate::model::open_session::Diagnosed;
use crate::model::plot_preparation::{Preparation, Prepared, same};
use crate::model::{Model, OpenSession, Selection};
use crate::widgets::UiExt;
use choices::VariableChoice;
pub use dock::Panes;
use dock::PlotId;
pub(crate) use dock::{show, show_detached};
pub(crate) use kind::PlotKind;
use kind::{Content, PlotOptions, PlotSource, Unavailable};
pub(crate) use list::{PLOTS, find};
pub(crate) use sources::residuals::of_both as residuals_of_both;
use tautline_workflow::identification::Identification;
use tautline_workflow::plot::Figure;
use view::{PlotEvent, PlotInput, PlotView};

/// State of a plot.
#[derive(Debug)]
pub(crate) struct PlotState {
    kind: &'static PlotKind,
    /// Number among plots of the same kind.
    copy: u8,
    options: PlotOptions,
    statistics: statistics::Statistics,
    scope: scope::ScopeState,
    /// Session of the zoom and the cursors.
    session: Option<u64>,
    view: PlotView,
    /// Number of option changes; each one resets the zoom.
    arrangement: u64,
    figure: Option<(FigureOf, KnownFigure)>,
    generation: u64,
    /// Data prepared by a task.
    preparation: Option<Preparation>,
    /// Format of a requested file.
    saving: Option<Format>,
    is_hovered: bool,
}

/// Figure with the view that shows all of it.
#[derive(Debug, Clone)]
struct KnownFigure {
    figure: Arc<Figure>,
    whole: [[f64; 2]; 2],
}

/// Inputs of a figure.
#[derive(Debug, Clone)]
struct FigureOf {
    session: (u64, u64),
    options: PlotOptions,
    fit: Option<Arc<Identification>>,
    diagnosed: Option<Arc<Diagnosed>>,
    prepared: Option<Arc<Prepared>>,
}

impl PartialEq for FigureOf {
    fn eq(&self, other: &Self) -> bool {
        self.session == other.session
            && self.options == other.options
            && same(self.fit.as_ref(), other.fit.as_ref())
            && same(self.diagnosed.as_ref(), other.diagnosed.as_ref())
            && same(self.prepared.as_ref(), other.prepared.as_ref())
    }
}

/// Draws a plot of a session, without its tabs; `hovered` is the selection under the pointer, in all views.
fn pane(
    ui: &mut Ui,
    model: &Model,
    plots: &mut PlotState,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    let Some(open) = &model.open else {
        return;
    };
    let figure = match plots.kind.content {
        Content::Figure(figure) => figure,
        Content::Scope => return scope::show(ui, model, &mut plots.scope),
        Content::Statistics => {
            return match ((plots.kind.missing)(open), open.fit()) {
                (None, Some(fit)) => {
                    let state = &mut plots.statistics;
                    statistics::show(ui, fit, state, model.selection, hovered, outbox);
                }
                (why, _) => ui.empty(why.unwrap_or_default()),
            };
        }
    };
    match plots.figure(open, figure) {
        Ok(figure) => plot(ui, model, open, plots, &figure, hovered, outbox),
        Err(Unavailable::Empty(why)) => ui.empty(why),
        Err(Unavailable::Failed(why)) => failed(ui, plots, &why),
        Err(Unavailable::Unprepared) => {
            outbox.send(PlotCommand::Prepare);
            ui.centered_and_justified(|ui| ui.add(Spinner::new()));
        }
    }
}

fn failed(ui: &mut Ui, plots: &mut PlotState, why: &str) {
    ui.bad(&format!("The plot cannot be prepared: {why}."));
    if ui.button("Try again").clicked() {
        plots.preparation = None;
    }
}

fn plot(
    ui: &mut Ui,
    model: &Model,
    open: &OpenSession,
    plots: &mut PlotState,
    KnownFigure { figure, whole }: &KnownFigure,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    bar::options(ui, model, open, plots, figure, outbox);
    let title = plots.kind.title;
    let id = (title, plots.copy, plots.session, plots.arrangement);
    let input = PlotInput {
        name: &format!("Plot: {title}"),
        id: Id::unique(id),
        figure,
        generation: plots.generation,
        whole: *whole,
        selection: model.selection,
        size: ui.available_size(),
        link: Some(Id::unique((plots.session, figure.x.title()))),
        is_docked: true,
        can_be_saved: true,
        is_explained: false,
    };
    let output = plots.view.show(ui, &input);
    for event in output.events {
        match event {
            PlotEvent::Selected(selection) => outbox.send(ViewCommand::Select(selection)),
            PlotEvent::Excluded(pose) => outbox.send(toggled(open, pose)),
            PlotEvent::Save(format) => plots.saving = Some(format),
        }
    }
    if output.hovered.is_some() || plots.is_hovered {
        *hovered = output.hovered.unwrap_or_default();
    }
    plots.is_hovered = output.hovered.is_some();
}

fn toggled(open: &OpenSession, pose: i64) -> Edit {
    if open.session().excluded().contains(&pose) {
        Edit::Include(pose)
    } else {
        Edit::Exclude(pose)
    }
}

impl PlotState {
    fn of(PlotId { kind, copy }: PlotId) -> Self {
        Self {
            kind,
            copy,
            options: PlotOptions::default(),
            statistics: statistics::Statistics::default(),
            scope: scope::ScopeState::default(),
            session: None,
            view: PlotView::default(),
            arrangement: 0,
            figure: None,
            generation: 0,
            preparation: None,
            saving: None,
            is_hovered: false,
        }
    }

    /// Prepared data, if any.
    fn prepared(&self) -> Option<&Arc<Prepared>> {
        self.preparation.as_ref()?.result.as_ref().ok()
    }

    /// Resets state that belongs to other results.
    fn settle(&mut self, open: &OpenSession) {
        // Zoom and cursors belong to a session.
        if self.session.replace(open.id()) != Some(open.id()) {
            self.view = PlotView::default();
        }
        let (fit, diagnosed) = (open.fit(), open.diagnosis());
        let is_old = |preparation: &Preparation| !preparation.is_of(fit, diagnosed);
        if self.preparation.as_ref().is_some_and(is_old) {
            self.preparation = None;
        }
        if let Some(prepared) = self.prepared() {
            let known = self.options.choice;
            let known = known.filter(|choice| choice.values(prepared).is_some());
            self.options.choice =
                known.or_else(|| VariableChoice::first(prepared, diagnosed.map(Arc::as_ref)));
        }
    }

    /// Figure, recomputed only if its inputs have changed.
    fn figure(
        &mut self,
        open: &OpenSession,
        compute: fn(&PlotSource<'_>) -> Result<Figure, Unavailable>,
    ) -> Result<KnownFigure, Unavailable> {
        if let Some(why) = (self.kind.missing)(open) {
            return Err(Unavailable::Empty(why));
        }
        let key = FigureOf {
            session: (open.id(), open.revision()),
            options: self.options,
            fit: open.fit().cloned(),
            diagnosed: open.diagnosis().cloned(),
            prepared: self.prepared().cloned(),
        };
        if let Some((of, figure)) = &self.figure
            && *of == key
        {
            return Ok(figure.clone());
        }
        let figure = Arc::new(compute(&PlotSource {
            open,
            options: self.options,
            preparation: self.preparation.as_ref(),
        })?);
        self.generation += 1;
        // Other options change the range of the plot.
        let before = self.figure.as_ref().map(|(of, _)| of.options);
        if before.is_some_and(|before| before != key.options) {
            self.view = PlotView::default();
            self.arrangement += 1;
        }
        let known = KnownFigure {
            whole: figure.whole(),
            figure,
        };
        self.figure = Some((key, known.clone()));
        Ok(known)
    }
}

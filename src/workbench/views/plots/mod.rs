//! Plots below the 3D view, and small plots for panels.

mod bar;
mod dock;
mod hit;
mod print;
mod scope;
mod screen;
pub mod small;
mod sources;
mod statistics;
mod tab;
mod view;

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::{Id, Spinner, Ui};

use crate::model::command::{Format, Outbox, PlotCommand, ViewCommand};
use crate::model::edit::Edit;
use crate::model::open_session::Diagnosed;
use crate::model::plot_preparation::{Preparation, Prepared, same};
use crate::model::{Model, OpenSession, Selection};
use crate::widgets::{Verdict, empty, verdict};
use dock::PlotId;
pub use dock::{Panes, show, show_detached};
use sources::course::Reading;
use sources::residuals::Unit;
pub use sources::residuals::of_both as residuals_of_both;
use sources::tensions::Shown as Tensions;
use sources::variable::Choice;
pub use tab::Tab;
use tautline_workflow::identification::Identification;
use tautline_workflow::plot::Figure;
use view::{PlotEvent, PlotInput, PlotView};

/// A plot that is being saved.
#[derive(Debug)]
struct Saving {
    format: Format,
    path: String,
}

/// State of one plot among several.
#[derive(Debug, Default)]
pub struct PlotState {
    tab: Tab,
    unit: Unit,
    tensions: Tensions,
    course: Reading,
    choice: Option<Choice>,
    elongation: Option<usize>,
    statistics: statistics::Statistics,
    /// Distinguishes plots that show the same.
    copy: u8,
    /// The session that the views belong to.
    session: Option<u64>,
    views: BTreeMap<Tab, PlotView>,
    /// Counts changes of the options, with each of which everything is shown again.
    arrangement: u64,
    figure: Option<(FigureOf, Arc<Figure>)>,
    generation: u64,
    /// What a task computed for the plots.
    pub preparation: Option<Preparation>,
    saving: Option<Saving>,
    is_hovered: bool,
    scope: scope::ScopeState,
}

/// What a figure depends on.
#[derive(Debug, Clone)]
struct FigureOf {
    session: (u64, u64),
    options: (Tab, Unit, Tensions, Reading, Option<Choice>, Option<usize>),
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

/// Draws one of the plots of a session, without its tabs; `hovered` is what is under the pointer, in all views.
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
    if plots.tab == Tab::Statistics
        && let Some(fit) = open.fit()
    {
        let shared = (model.selection, hovered);
        statistics::show(ui, fit, &mut plots.statistics, shared, outbox);
        return;
    }
    if plots.tab == Tab::Scope {
        return scope::show(ui, model, &mut plots.scope);
    }
    match plots.figure(open) {
        Ok(figure) => plot(ui, model, plots, &figure, hovered, outbox),
        Err(Unavailable::Empty(why)) => empty(ui, why),
        Err(Unavailable::Failed(why)) => failed(ui, plots, &why),
        Err(Unavailable::Unprepared) => {
            outbox.send(PlotCommand::Prepare);
            ui.centered_and_justified(|ui| ui.add(Spinner::new()));
        }
    }
}

/// Why there is no figure.
enum Unavailable {
    /// There are no data.
    Empty(&'static str),
    /// A task has to prepare it first.
    Unprepared,
    /// The task could not.
    Failed(String),
}

fn failed(ui: &mut Ui, plots: &mut PlotState, why: &str) {
    verdict(
        ui,
        Verdict::Bad,
        &format!("The plot cannot be prepared: {why}."),
    );
    if ui.button("Try again").clicked() {
        plots.preparation = None;
    }
}

fn plot(
    ui: &mut Ui,
    model: &Model,
    plots: &mut PlotState,
    figure: &Arc<Figure>,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    bar::options(ui, model, plots, figure, outbox);
    let title = plots.tab.title();
    let id = (title, plots.copy, plots.session, plots.arrangement);
    let input = PlotInput {
        name: &format!("Plot: {title}"),
        id: Id::unique(id),
        figure,
        generation: plots.generation,
        whole: figure.whole(),
        selection: model.selection,
        size: ui.available_size(),
        link: Some(Id::unique((plots.session, figure.x.title()))),
        is_docked: true,
    };
    let output = plots.views.entry(plots.tab).or_default().show(ui, &input);
    for event in output.events {
        match event {
            PlotEvent::Selected(selection) => outbox.send(ViewCommand::Select(selection)),
            PlotEvent::Excluded(pose) => outbox.send(toggled(model.open.as_ref(), pose)),
            PlotEvent::Save(format) => plots.begin_saving(format),
        }
    }
    if output.hovered.is_some() || plots.is_hovered {
        *hovered = output.hovered.unwrap_or_default();
    }
    plots.is_hovered = output.hovered.is_some();
}

fn toggled(open: Option<&OpenSession>, pose: i64) -> Edit {
    if open.is_some_and(|open| open.session().excluded().contains(&pose)) {
        Edit::Include(pose)
    } else {
        Edit::Exclude(pose)
    }
}

impl PlotState {
    /// A plot that was not shown yet.
    fn of(PlotId { tab, copy }: PlotId) -> Self {
        Self {
            tab,
            copy,
            ..Self::default()
        }
    }

    /// Asks for the file of the plot.
    fn begin_saving(&mut self, format: Format) {
        let path = format!("plot.{}", format.ending());
        self.saving = Some(Saving { format, path });
    }

    /// What a task prepared, if it did.
    fn prepared(&self) -> Option<&Arc<Prepared>> {
        self.preparation.as_ref()?.result.as_ref().ok()
    }

    /// Forgets what belongs to other results.
    fn settle(&mut self, open: &OpenSession) {
        // What is zoomed or measured with cursors belongs to its session.
        if self.session.replace(open.id()) != Some(open.id()) {
            self.views.clear();
        }
        let (fit, diagnosed) = (open.fit(), open.diagnosis());
        let is_old = |preparation: &Preparation| !preparation.is_of(fit, diagnosed);
        if self.preparation.as_ref().is_some_and(is_old) {
            self.preparation = None;
        }
        if let Some(prepared) = self.prepared() {
            let known = self
                .choice
                .filter(|choice| choice.values(prepared).is_some());
            self.choice = known.or_else(|| Choice::first(prepared, diagnosed.map(Arc::as_ref)));
        }
    }

    /// The figure of the present tab, computed again only if what it depends on has changed.
    fn figure(&mut self, open: &OpenSession) -> Result<Arc<Figure>, Unavailable> {
        if let Some(why) = self.tab.missing(open) {
            return Err(Unavailable::Empty(why));
        }
        let key = FigureOf {
            session: (open.id(), open.revision()),
            options: (
                self.tab,
                self.unit,
                self.tensions,
                self.course,
                self.choice,
                self.elongation,
            ),
            fit: open.fit().cloned(),
            diagnosed: open.diagnosis().cloned(),
            prepared: self.prepared().cloned(),
        };
        if let Some((of, figure)) = &self.figure
            && *of == key
        {
            return Ok(Arc::clone(figure));
        }
        let figure = Arc::new(self.compute(open)?);
        self.generation += 1;
        // The same plot of something else has another range.
        let is_other = self
            .figure
            .as_ref()
            .is_some_and(|(of, _)| of.options.0 == key.options.0 && of.options != key.options);
        if is_other {
            self.views.remove(&self.tab);
            self.arrangement += 1;
        }
        self.figure = Some((key, Arc::clone(&figure)));
        Ok(figure)
    }

    fn compute(&self, open: &OpenSession) -> Result<Figure, Unavailable> {
        let excluded = open.session().excluded();
        let nothing = Unavailable::Empty("Nothing is identified.");
        let prepared = || match self.preparation.as_ref().map(|p| &p.result) {
            Some(Ok(prepared)) => Ok(prepared),
            Some(Err(why)) => Err(Unavailable::Failed(why.clone())),
            None => Err(Unavailable::Unprepared),
        };
        Ok(match self.tab {
            Tab::Variable => {
                let prepared = prepared()?;
                let choice = self
                    .choice
                    .ok_or(Unavailable::Empty("No variable changes over these poses."))?;
                let diagnosed = open.diagnosis().map(Arc::as_ref);
                sources::variable::figure(prepared, diagnosed, choice, excluded)
            }
            Tab::BeforeAfter => sources::before_after::figure(prepared()?),
            Tab::Scope => return Err(nothing),
            Tab::Elongation => sources::elongation::figure(open.session(), self.elongation),
            Tab::Residuals => {
                sources::residuals::lengths(open.fit().ok_or(nothing)?, self.unit, excluded)
            }
            Tab::Laser => {
                sources::residuals::laser(open.fit().ok_or(nothing)?, self.unit, excluded)
            }
            Tab::External => {
                sources::residuals::external(open.fit().ok_or(nothing)?, self.unit, excluded)
            }
            Tab::Tensions => {
                sources::tensions::figure(open.fit().ok_or(nothing)?, self.tensions, excluded)
            }
            Tab::Course => sources::course::figure(open.session(), self.course),
            Tab::Convergence => sources::convergence::figure(open.fit().ok_or(nothing)?),
            Tab::Correlation => sources::correlation::figure(open.fit().ok_or(nothing)?),
            Tab::Statistics => return Err(nothing),
        })
    }
}

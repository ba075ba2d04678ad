//! The kinds of plots: one static in a file of its own each, one line in the list.

use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use egui::Ui;
use tautline_workflow::identification::Identification;
use tautline_workflow::plot::Figure;

use super::PlotState;
use super::sources::{
    before_after, convergence, correlation, course, elongation, external, laser, residuals,
    tensions, variable,
};
use super::{scope, statistics};
use crate::model::command::Outbox;
use crate::model::open_session::Diagnosed;
use crate::model::plot_preparation::{Preparation, Prepared};
use crate::model::{Model, OpenSession, Selection};

/// All kinds, from the left.
pub static PLOTS: [&PlotKind; 12] = [
    &residuals::PLOT,
    &variable::PLOT,
    &laser::PLOT,
    &tensions::PLOT,
    &external::PLOT,
    &convergence::PLOT,
    &correlation::PLOT,
    &elongation::PLOT,
    &before_after::PLOT,
    &course::PLOT,
    &statistics::PLOT,
    &scope::PLOT,
];

pub struct PlotKind {
    /// Name in preferences.
    pub(crate) id: &'static str,
    /// Label in the window.
    pub(crate) title: &'static str,
    /// Why there is nothing to show, if there is not.
    pub(crate) missing: fn(&OpenSession) -> Option<&'static str>,
    /// Adds the choices above the plot; they are menus if there is little room.
    pub(crate) options: fn(&mut Ui, &mut PlotState, &OpenSession, bool),
    pub(crate) content: Content,
}

/// What a plot shows below its options.
pub(crate) enum Content {
    Figure(fn(&Source<'_>) -> Result<Figure, Unavailable>),
    /// A view of its own, with what is under the pointer in all views.
    Own(fn(&mut Ui, &Model, &mut PlotState, &mut Selection, &mut Outbox)),
}

/// Why there is no figure.
#[derive(Debug)]
pub(crate) enum Unavailable {
    Empty(&'static str),
    /// A task has to prepare it first.
    Unprepared,
    /// The task failed.
    Failed(String),
}

/// Choices above the plots.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct PlotOptions {
    pub(crate) unit: residuals::Unit,
    pub(crate) tensions: tensions::Shown,
    pub(crate) course: course::Reading,
    pub(crate) choice: Option<variable::Choice>,
    pub(crate) elongation: Option<usize>,
}

/// What figures are made from.
pub(crate) struct Source<'a> {
    pub(crate) open: &'a OpenSession,
    pub(crate) options: PlotOptions,
    pub(crate) preparation: Option<&'a Preparation>,
}

impl<'a> Source<'a> {
    pub(crate) fn fit(&self) -> Result<&'a Arc<Identification>, Unavailable> {
        let nothing = Unavailable::Empty("Nothing is identified.");
        self.open.fit().ok_or(nothing)
    }

    pub(crate) fn diagnosed(&self) -> Option<&'a Diagnosed> {
        self.open.diagnosis().map(Arc::as_ref)
    }

    pub(crate) fn excluded(&self) -> &'a BTreeSet<i64> {
        self.open.session().excluded()
    }

    pub(crate) fn prepared(&self) -> Result<&'a Prepared, Unavailable> {
        match self.preparation.map(|preparation| &preparation.result) {
            Some(Ok(prepared)) => Ok(prepared),
            Some(Err(why)) => Err(Unavailable::Failed(why.clone())),
            None => Err(Unavailable::Unprepared),
        }
    }
}

/// For plots without choices.
pub(crate) fn no_options(_: &mut Ui, _: &mut PlotState, _: &OpenSession, _: bool) {}

/// The kind with this name in preferences.
#[must_use]
pub fn find(id: &str) -> Option<&'static PlotKind> {
    PLOTS.into_iter().find(|kind| kind.id == id)
}

impl PlotKind {
    fn place(&self) -> Option<usize> {
        PLOTS.iter().position(|kind| kind.id == self.id)
    }
}

impl PartialEq for PlotKind {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for PlotKind {}

impl PartialOrd for PlotKind {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for PlotKind {
    fn cmp(&self, other: &Self) -> Ordering {
        self.place().cmp(&other.place())
    }
}

impl fmt::Debug for PlotKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id)
    }
}

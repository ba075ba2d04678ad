//! Kind of a plot: name, options and content.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use egui::Ui;
use tautline_workflow::identification::Identification;
use tautline_workflow::plot::Figure;

use super::choices::{CourseReading, ResidualUnit, TensionsShown, VariableChoice};
use crate::model::OpenSession;
use crate::model::open_session::Diagnosed;
use crate::model::plot_preparation::{Preparation, Prepared};

pub(crate) struct PlotKind {
    /// Name in preferences.
    pub(crate) id: &'static str,
    /// Label in the window.
    pub(crate) title: &'static str,
    /// Reason why there are no data, if so.
    pub(crate) missing: fn(&OpenSession) -> Option<&'static str>,
    /// Draws the options above the plot, as menus in a narrow plot.
    pub(crate) options: fn(&mut Ui, &mut PlotOptions, &OptionsInput<'_>),
    pub(crate) content: Content,
}

/// Content of a plot below its options.
pub(crate) enum Content {
    Figure(fn(&PlotSource<'_>) -> Result<Figure, Unavailable>),
    /// Table of statistics.
    Statistics,
    /// Live readings of the controller.
    Scope,
}

/// Inputs of the options.
pub(crate) struct OptionsInput<'a> {
    pub(crate) open: &'a OpenSession,
    pub(crate) prepared: Option<&'a Prepared>,
    /// Whether options are drawn as menus.
    pub(crate) is_narrow: bool,
}

/// Reason why there is no figure.
#[derive(Debug)]
pub(crate) enum Unavailable {
    Empty(&'static str),
    /// A task has to prepare the data first.
    Unprepared,
    /// The task failed.
    Failed(String),
}

/// Options above the plots.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct PlotOptions {
    pub(crate) unit: ResidualUnit,
    pub(crate) tensions: TensionsShown,
    pub(crate) course: CourseReading,
    pub(crate) choice: Option<VariableChoice>,
    pub(crate) elongation: Option<usize>,
}

/// Inputs of figures.
pub(crate) struct PlotSource<'a> {
    pub(crate) open: &'a OpenSession,
    pub(crate) options: PlotOptions,
    pub(crate) preparation: Option<&'a Preparation>,
}

impl<'a> PlotSource<'a> {
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

/// For plots without options.
pub(crate) fn no_options(_: &mut Ui, _: &mut PlotOptions, _: &OptionsInput<'_>) {}

impl PartialEq for PlotKind {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for PlotKind {}

impl fmt::Debug for PlotKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id)
    }
}

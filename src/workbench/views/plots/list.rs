//! All kinds of plots, in order.

use std::cmp::Ordering;

use super::kind::PlotKind;
use super::sources::{
    before_after, convergence, correlation, course, distances, elongation, external, residuals,
    tensions, variable,
};
use super::{scope, statistics};

/// All kinds, from the left.
pub(crate) static PLOTS: [&PlotKind; 12] = [
    &residuals::PLOT,
    &variable::PLOT,
    &distances::PLOT,
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

/// Kind with this name in the preferences.
pub(crate) fn find(id: &str) -> Option<&'static PlotKind> {
    PLOTS.into_iter().find(|kind| kind.id == id)
}

impl PlotKind {
    fn place(&self) -> Option<usize> {
        PLOTS.iter().position(|kind| kind.id == self.id)
    }
}

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

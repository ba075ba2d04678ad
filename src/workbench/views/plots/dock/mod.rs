//! Plots as docked tabs or in separate windows; those with the same x axis are zoomed and panned together.

mod plot_id;
mod tabs;
mod tree;
mod windows;

use std::collections::{BTreeMap, BTreeSet, HashSet};

use egui::Ui;
use egui_tiles::Behavior as _;
use tautline_core::diagnosis::Quantity;
use tautline_core::measurement::Variable;
use tautline_session::{PlotArea, Plots};

use super::{PLOTS, PlotOptions, PlotState, VariableChoice, scope, sources};
use crate::model::command::Outbox;
use crate::model::part::ScreenPart;
use crate::model::plot_preparation::Preparation;
use crate::model::{Model, Selection};
use crate::widgets::UiExt;
use tabs::{Dock, DockRequest};
use tree::{Preset, Tree};

pub(crate) use plot_id::PlotId;
pub(crate) use windows::show_detached;

/// Width (points) below which only one plot is shown at a time.
const NARROW: f32 = 560.0;

/// State of the plots.
pub struct Panes {
    docked: Tree,
    /// Same plots as tabs of one area, for a small or maximised area.
    single: Tree,
    detached: BTreeSet<PlotId>,
    plots: BTreeMap<PlotId, PlotState>,
    /// Plots hidden by the live scope, restored when it closes: in `docked` and in `single`.
    before_scope: [Option<PlotId>; 2],
    /// Arrangement stored in the preferences.
    known: Plots,
}

impl Default for Panes {
    fn default() -> Self {
        Self::of(&Plots::default())
    }
}

impl Panes {
    /// Plots as arranged in the preferences.
    #[must_use]
    pub fn of(plots: &Plots) -> Self {
        let detached = plots.detached.iter().filter_map(|name| PlotId::named(name));
        let detached: BTreeSet<PlotId> = detached.collect();
        let mut all: BTreeSet<PlotId> = PLOTS.map(PlotId::first).into();
        all.extend(&detached);
        all.extend(plots.area.iter().flat_map(named));
        let docked: Vec<PlotId> = all.difference(&detached).copied().collect();
        let usual = Preset::One.area(&docked);
        let mut panes = Self {
            docked: tree::tree(
                "docked plots",
                plots.area.as_ref().unwrap_or(&usual),
                &docked,
            ),
            single: tree::tree("plots in one place", &usual, &docked),
            detached,
            plots: all.iter().map(|id| (*id, PlotState::of(*id))).collect(),
            before_scope: [None; 2],
            known: Plots::default(),
        };
        panes.known = panes.now();
        panes
    }

    /// Present arrangement, for the preferences.
    fn now(&self) -> Plots {
        let mut area = tree::area(&self.docked);
        if let (Some(area), Some(before)) = (&mut area, self.before_scope[0]) {
            // A scope that opened automatically is not part of the arrangement.
            restore(area, before);
        }
        Plots {
            area,
            detached: self.detached.iter().map(|id| id.name()).collect(),
        }
    }

    /// Arrangement to store in the preferences, if it has changed.
    fn changed(&mut self) -> Option<Plots> {
        let now = self.now();
        (self.known != now).then(|| {
            self.known = now.clone();
            now
        })
    }

    /// Passes prepared data to all plots.
    pub(crate) fn prepared(&mut self, preparation: &Preparation) {
        for plot in self.plots.values_mut() {
            plot.preparation = Some(preparation.clone());
        }
    }

    /// Shows residuals of a quantity along a variable, in a plot by variable that is visible, otherwise in the first
    /// one.
    pub(crate) fn show_along(
        &mut self,
        quantity: Quantity,
        cable: Option<usize>,
        variable: Variable,
    ) {
        let mut shown = tree::shown(&self.docked).into_iter();
        let shown = shown.find(|id| id.kind == &sources::variable::PLOT);
        let id = shown.unwrap_or(PlotId::first(&sources::variable::PLOT));
        if let Some(plot) = self.plots.get_mut(&id) {
            plot.options.choice = Some(VariableChoice {
                quantity,
                cable,
                variable,
            });
        }
        self.bring_forward(id);
    }

    /// Brings a plot to the front of its area; returns the plot that was there, in `docked` and in `single`.
    fn bring_forward(&mut self, id: PlotId) -> [Option<PlotId>; 2] {
        [&mut self.docked, &mut self.single].map(|tree| tree::bring_forward(tree, id))
    }

    /// Shows the live scope, unless it is visible already.
    pub(crate) fn show_scope(&mut self) {
        let scope = PlotId::first(&scope::PLOT);
        let before = self.bring_forward(scope);
        for (kept, before) in self.before_scope.iter_mut().zip(before) {
            *kept = before.filter(|id| *id != scope).or(*kept);
        }
    }

    /// Restores the plot that an automatically opened scope has hidden.
    pub(crate) fn leave_scope(&mut self) {
        let scope = PlotId::first(&scope::PLOT);
        let before = std::mem::take(&mut self.before_scope);
        for (tree, before) in [&mut self.docked, &mut self.single].into_iter().zip(before) {
            if let Some(before) = before.filter(|_| tree::shown(tree).contains(&scope)) {
                tree::bring_forward(tree, before);
            }
        }
    }

    /// Range along x of the first plot of a kind, given by its name, with the title of the axis.
    #[must_use]
    pub fn range(&self, kind: &str) -> Option<(String, [f64; 2])> {
        let plot = self.plots.get(&PlotId::named(kind)?)?;
        let (_, known) = plot.figure.as_ref()?;
        Some((known.figure.x.title(), plot.view.drawn?.scale.view[0]))
    }

    /// Number of plots on top of each other.
    #[must_use]
    pub fn rows(&self) -> usize {
        tree::area(&self.docked).map_or(1, |area| rows(&area))
    }

    fn apply(&mut self, wish: DockRequest) {
        match wish {
            DockRequest::Show(id) => {
                self.bring_forward(id);
            }
            DockRequest::Detach(id) => {
                self.remove(id);
                self.detached.insert(id);
            }
            DockRequest::Another(of) => {
                let free = (1..u8::MAX).map(|copy| PlotId { copy, ..of });
                let mut free = free.filter(|id| !self.plots.contains_key(id));
                if let Some(id) = free.next() {
                    let choice = self.plots.get(&of).and_then(|plot| plot.options.choice);
                    let preparation = self.plots.get(&of).and_then(|p| p.preparation.clone());
                    let options = PlotOptions {
                        choice,
                        ..PlotOptions::default()
                    };
                    let plot = PlotState {
                        options,
                        preparation,
                        ..PlotState::of(id)
                    };
                    self.plots.insert(id, plot);
                    self.dock(id);
                }
            }
            DockRequest::Close(id) => {
                self.remove(id);
                self.plots.remove(&id);
            }
            DockRequest::Arrange(preset) => {
                let all = self.plots.keys().filter(|id| !self.detached.contains(id));
                let all: Vec<PlotId> = all.copied().collect();
                self.docked = tree::tree("docked plots", &preset.area(&all), &all);
                self.before_scope[0] = None;
            }
        }
    }

    fn remove(&mut self, id: PlotId) {
        for tree in [&mut self.docked, &mut self.single] {
            tree::remove(tree, id);
        }
    }

    fn dock(&mut self, id: PlotId) {
        self.detached.remove(&id);
        for tree in [&mut self.docked, &mut self.single] {
            tree::add(tree, id);
        }
    }
}

fn named(area: &PlotArea) -> Vec<PlotId> {
    match area {
        PlotArea::Tabs { plots, .. } => plots.iter().filter_map(|n| PlotId::named(n)).collect(),
        PlotArea::Row(shares) | PlotArea::Column(shares) => {
            shares.iter().flat_map(|share| named(&share.area)).collect()
        }
    }
}

fn rows(area: &PlotArea) -> usize {
    match area {
        PlotArea::Tabs { .. } => 1,
        PlotArea::Row(shares) => shares.iter().map(|s| rows(&s.area)).max().unwrap_or(1),
        PlotArea::Column(shares) => shares.iter().map(|s| rows(&s.area)).sum(),
    }
}

/// Brings a plot to the front of its area, in place of the live scope.
fn restore(area: &mut PlotArea, plot: PlotId) {
    match area {
        PlotArea::Tabs { plots, shown } => {
            if shown.as_deref() == Some(scope::PLOT.id) && plots.contains(&plot.name()) {
                *shown = Some(plot.name());
            }
        }
        PlotArea::Row(shares) | PlotArea::Column(shares) => {
            for share in shares {
                restore(&mut share.area, plot);
            }
        }
    }
}

/// Draws the docked plots; `hovered` is the selection under the pointer, in all views.
pub(crate) fn show(
    ui: &mut Ui,
    model: &Model,
    panes: &mut Panes,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    let Some(open) = &model.open else {
        ui.empty("Plots appear here once a session is open.");
        return;
    };
    let area = ui.available_rect_before_wrap();
    // While the robot moves, the live scope uses the whole area.
    let is_single = model.maximised == Some(ScreenPart::Plots)
        || area.width() < NARROW
        || model.link.is_under_way();
    for plot in panes.plots.values_mut() {
        plot.settle(open);
    }
    let mut dock = Dock {
        model,
        open,
        plots: &mut panes.plots,
        hovered,
        outbox,
        area,
        hidden: HashSet::new(),
        wish: None,
    };
    let tree = match is_single {
        true => &mut panes.single,
        false => &mut panes.docked,
    };
    if tree.is_empty() {
        ui.empty("All plots are in windows of their own.");
    } else {
        let dragged = tree.dragged_id(ui.ctx());
        let places = tree::substitute(tree, |kind| (kind.missing)(open).is_none());
        tree.ui(&mut dock, ui);
        tree::restore(tree, &places);
        if let Some(dragged) = dragged.filter(|_| ui.input(|input| input.pointer.any_released())) {
            tree::untangle(tree, dragged);
            tree.simplify(&dock.simplification_options());
        }
    }
    if let Some(wish) = dock.wish {
        panes.apply(wish);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scope_that_came_by_itself_is_not_kept_and_goes() {
        let mut panes = Panes::default();
        panes.show_scope();
        assert_eq!(panes.changed(), None);
        assert_eq!(tree::shown(&panes.docked), [PlotId::first(&scope::PLOT)]);
        panes.leave_scope();
        assert_eq!(
            tree::shown(&panes.docked),
            [PlotId::first(&sources::residuals::PLOT)]
        );
        assert_eq!(panes.changed(), None);
    }

    #[test]
    fn an_arrangement_is_restored_with_copies_and_detached_plots() {
        let mut panes = Panes::default();
        let variable = PlotId::first(&sources::variable::PLOT);
        panes.apply(DockRequest::Another(variable));
        assert_eq!(panes.rows(), 1);
        panes.apply(DockRequest::Arrange(Preset::Four));
        assert_eq!(panes.rows(), 2);
        panes.apply(DockRequest::Arrange(Preset::Two));
        panes.apply(DockRequest::Detach(PlotId::first(
            &sources::distances::PLOT,
        )));
        let kept = panes.changed().expect("it has changed");
        assert_eq!(kept.detached, ["laser"]);
        let mut restored = Panes::of(&kept);
        assert_eq!(restored.changed(), None);
        assert_eq!(restored.now(), kept);
        let copy = PlotId {
            copy: 1,
            ..variable
        };
        assert!(restored.plots.contains_key(&copy));
        restored.dock(PlotId::first(&sources::distances::PLOT));
        restored.apply(DockRequest::Close(copy));
        assert!(!restored.plots.contains_key(&copy) && restored.detached.is_empty());
    }
}

//! Tree of the areas of docked plots, and its form in the preferences.

use std::collections::BTreeSet;

use egui::Id;
use egui_tiles::{Container, ContainerKind, Linear, LinearDir, Tabs, Tile, TileId, Tiles};
use tautline_session::{PlotArea, PlotShare};

use super::super::{PlotKind, scope, sources};
use super::PlotId;

/// Areas of plots.
pub(crate) type Tree = egui_tiles::Tree<PlotId>;

/// Plots that are visible in presets, from the upper left.
static FIRST: [&PlotKind; 4] = [
    &sources::residuals::PLOT,
    &sources::tensions::PLOT,
    &sources::variable::PLOT,
    &sources::distances::PLOT,
];

/// Preset arrangement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Preset {
    /// One plot.
    One,
    /// Two side by side.
    Two,
    /// Two rows of two.
    Four,
}

impl Preset {
    pub(crate) const ALL: [Self; 3] = [Self::One, Self::Two, Self::Four];

    /// Label in the window.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::One => "One plot",
            Self::Two => "Two plots",
            Self::Four => "Four plots",
        }
    }

    /// Arranges these plots.
    pub(crate) fn area(self, plots: &[PlotId]) -> PlotArea {
        let count = match self {
            Self::One => return tabs(plots.to_vec()),
            Self::Two => 2,
            Self::Four => 4,
        };
        let first = FIRST[..count].iter().map(|kind| PlotId::first(kind));
        let first: Vec<PlotId> = first.filter(|plot| plots.contains(plot)).collect();
        let mut places: Vec<Vec<PlotId>> = first.iter().map(|plot| vec![*plot]).collect();
        places.resize(count, Vec::new());
        // The scope opens automatically: it is the first of the others.
        let mut others: Vec<PlotId> = plots.to_vec();
        others.retain(|plot| !first.contains(plot));
        others.sort_by_key(|plot| plot.kind != &scope::PLOT);
        for (k, plot) in others.into_iter().enumerate() {
            places[k % count].push(plot);
        }
        places.retain(|place| !place.is_empty());
        let mut rows: Vec<PlotArea> = places
            .chunks(2)
            .map(|row| PlotArea::Row(equal(row.iter().cloned().map(tabs))))
            .collect();
        match rows.len() {
            1 => rows.remove(0),
            _ => PlotArea::Column(equal(rows.into_iter())),
        }
    }
}

fn tabs(plots: Vec<PlotId>) -> PlotArea {
    PlotArea::Tabs {
        shown: plots.first().map(|plot| plot.name()),
        plots: plots.into_iter().map(PlotId::name).collect(),
    }
}

fn equal(areas: impl Iterator<Item = PlotArea>) -> Vec<PlotShare> {
    areas.map(|area| PlotShare { share: 1.0, area }).collect()
}

/// Tree of an area with these plots; those that the area does not name are added as tabs of its first area.
pub(crate) fn tree(name: &str, area: &PlotArea, plots: &[PlotId]) -> Tree {
    let mut tiles = Tiles::default();
    let mut wanted: BTreeSet<PlotId> = plots.iter().copied().collect();
    let root = insert(&mut tiles, area, &mut wanted);
    let mut tree = match root {
        Some(root) => Tree::new(Id::unique(name), root, tiles),
        None => Tree::empty(Id::unique(name)),
    };
    for plot in plots.iter().filter(|plot| wanted.contains(*plot)) {
        add(&mut tree, *plot);
    }
    tree
}

fn insert(
    tiles: &mut Tiles<PlotId>,
    area: &PlotArea,
    wanted: &mut BTreeSet<PlotId>,
) -> Option<TileId> {
    let (dir, shares) = match area {
        PlotArea::Tabs { plots, shown } => {
            let plots = plots.iter().filter_map(|name| PlotId::named(name));
            let plots: Vec<PlotId> = plots.filter(|plot| wanted.remove(plot)).collect();
            let children: Vec<TileId> = plots.iter().map(|plot| tiles.insert_pane(*plot)).collect();
            let is_shown = |plot: &PlotId| shown.as_ref() == Some(&plot.name());
            let shown = plots.iter().position(is_shown).unwrap_or(0);
            let active = *children.get(shown)?;
            let mut tabs = Tabs::new(children);
            tabs.set_active(active);
            return Some(tiles.insert_container(tabs));
        }
        PlotArea::Row(shares) => (LinearDir::Horizontal, shares),
        PlotArea::Column(shares) => (LinearDir::Vertical, shares),
    };
    let mut linear = Linear::new(dir, Vec::new());
    for PlotShare { share, area } in shares {
        if let Some(child) = insert(tiles, area, wanted) {
            linear.children.push(child);
            linear.shares.set_share(child, *share as f32);
        }
    }
    (!linear.children.is_empty()).then(|| tiles.insert_container(linear))
}

/// Docks a plot as a tab of the first area, in front.
pub(crate) fn add(tree: &mut Tree, plot: PlotId) {
    let tile = tree.tiles.insert_pane(plot);
    let Some(first) = first_tabs(tree, tree.root) else {
        tree.root = Some(tree.tiles.insert_tab_tile(vec![tile]));
        return;
    };
    if let Some(Tile::Container(Container::Tabs(tabs))) = tree.tiles.get_mut(first) {
        tabs.add_child(tile);
        tabs.set_active(tile);
    }
}

fn first_tabs(tree: &Tree, tile: Option<TileId>) -> Option<TileId> {
    match tree.tiles.get_container(tile?)? {
        Container::Tabs(_) => tile,
        other => other
            .children()
            .find_map(|child| first_tabs(tree, Some(*child))),
    }
}

/// Removes a plot.
pub(crate) fn remove(tree: &mut Tree, plot: PlotId) {
    if let Some(tile) = tree.tiles.find_pane(&plot) {
        tree.remove_recursively(tile);
    }
}

/// Brings a plot to the front of its area; returns the one that was there.
pub(crate) fn bring_forward(tree: &mut Tree, plot: PlotId) -> Option<PlotId> {
    let tile = tree.tiles.find_pane(&plot)?;
    let parent = tree.tiles.parent_of(tile)?;
    let Some(Tile::Container(Container::Tabs(tabs))) = tree.tiles.get_mut(parent) else {
        return None;
    };
    let before = tabs.active.replace(tile)?;
    tree.tiles.get_pane(&before).copied()
}

/// Area, its chosen plot, and the one shown instead.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SubstitutedTab {
    place: TileId,
    chosen: TileId,
    shown: TileId,
}

/// Shows other plots in place of those without data: the residuals, whose message explains how to get data, otherwise
/// the first with data. The live scope, which always has data, opens automatically.
pub(crate) fn substitute(
    tree: &mut Tree,
    has_data: impl Fn(&'static PlotKind) -> bool,
) -> Vec<SubstitutedTab> {
    let instead = |tabs: &Tabs| {
        let plot = |tile: &TileId| tree.tiles.get_pane(tile).map(|plot| plot.kind);
        let chosen = tabs.active?;
        if plot(&chosen).is_none_or(|kind| kind == &sources::residuals::PLOT || has_data(kind)) {
            return None;
        }
        let others = tabs.children.iter();
        let others: Vec<(TileId, &'static PlotKind)> =
            others.filter_map(|t| Some((*t, plot(t)?))).collect();
        let residuals = others
            .iter()
            .find(|(_, kind)| *kind == &sources::residuals::PLOT);
        let shows =
            |(_, kind): &&(TileId, &'static PlotKind)| *kind != &scope::PLOT && has_data(kind);
        let (seen, _) = residuals.or_else(|| others.iter().find(shows))?;
        Some((chosen, *seen))
    };
    let places = tree.tiles.iter().filter_map(|(place, tile)| match tile {
        Tile::Container(Container::Tabs(tabs)) => {
            let (chosen, shown) = instead(tabs)?;
            Some(SubstitutedTab {
                place: *place,
                chosen,
                shown,
            })
        }
        _ => None,
    });
    let places: Vec<SubstitutedTab> = places.collect();
    for tab in &places {
        set_active(tree, tab.place, tab.shown);
    }
    places
}

/// Brings the chosen plots to the front again, unless others were chosen meanwhile.
pub(crate) fn restore(tree: &mut Tree, places: &[SubstitutedTab]) {
    for tab in places {
        let Some(Tile::Container(Container::Tabs(tabs))) = tree.tiles.get(tab.place) else {
            continue;
        };
        if tabs.active == Some(tab.shown) && tabs.children.contains(&tab.chosen) {
            set_active(tree, tab.place, tab.chosen);
        }
    }
}

fn set_active(tree: &mut Tree, place: TileId, plot: TileId) {
    if let Some(Tile::Container(Container::Tabs(tabs))) = tree.tiles.get_mut(place) {
        tabs.set_active(plot);
    }
}

/// After a plot was dropped at the side of a tab among others, divides the area of all tabs instead of only that tab.
pub(crate) fn untangle(tree: &mut Tree, dragged: TileId) {
    let divided = |(id, tile): (&TileId, &Tile<PlotId>)| match tile {
        Tile::Container(Container::Tabs(tabs)) => {
            let is_divided = |child: &&TileId| {
                let kind = tree.tiles.get_container(**child).map(Container::kind);
                kind.is_some_and(|kind| kind != ContainerKind::Tabs)
            };
            Some((*id, *tabs.children.iter().find(is_divided)?))
        }
        _ => None,
    };
    let Some((place, inner)) = tree.tiles.iter().find_map(divided) else {
        return;
    };
    let children = tree.tiles.get_container(inner).map(Container::children_vec);
    let plot = children.into_iter().flatten().find(|id| *id != dragged);
    let Some(plot) = plot else {
        return;
    };
    let parent = tree.tiles.parent_of(place);
    let mut exchange = |container: TileId, old: TileId, new: TileId| {
        if let Some(Tile::Container(container)) = tree.tiles.get_mut(container) {
            let is_exchanged = container.replace_child(old, new).is_some();
            if let (true, Container::Tabs(tabs)) = (is_exchanged, container) {
                tabs.set_active(new);
            }
        }
    };
    exchange(place, inner, plot);
    exchange(inner, plot, place);
    match parent {
        Some(parent) => exchange(parent, place, inner),
        None => tree.root = Some(inner),
    }
}

/// Visible plots.
pub(crate) fn shown(tree: &Tree) -> Vec<PlotId> {
    let active = tree.active_tiles();
    let panes = active.iter().filter_map(|tile| tree.tiles.get_pane(tile));
    panes.copied().collect()
}

/// Arrangement of a tree, for the preferences.
pub(crate) fn area(tree: &Tree) -> Option<PlotArea> {
    area_of(tree, tree.root?)
}

fn area_of(tree: &Tree, tile: TileId) -> Option<PlotArea> {
    let name = |tile: &TileId| tree.tiles.get_pane(tile).map(|plot| plot.name());
    let linear = match tree.tiles.get(tile)? {
        Tile::Pane(plot) => return Some(tabs(vec![*plot])),
        Tile::Container(Container::Tabs(tabs)) => {
            return Some(PlotArea::Tabs {
                plots: tabs.children.iter().filter_map(name).collect(),
                shown: tabs.active.as_ref().and_then(name),
            });
        }
        Tile::Container(Container::Linear(linear)) => linear,
        // Grids are not used.
        Tile::Container(Container::Grid(_)) => return None,
    };
    let shares = linear.children.iter().filter_map(|child| {
        Some(PlotShare {
            share: f64::from(linear.shares[*child]),
            area: area_of(tree, *child)?,
        })
    });
    let shares = shares.collect();
    Some(match linear.dir {
        LinearDir::Horizontal => PlotArea::Row(shares),
        LinearDir::Vertical => PlotArea::Column(shares),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::views::plots::PLOTS;

    fn all() -> Vec<PlotId> {
        PLOTS.map(PlotId::first).to_vec()
    }

    #[test]
    fn every_arrangement_has_every_plot_once_and_is_restored_from_preferences() {
        for preset in Preset::ALL {
            let area_before = preset.area(&all());
            let tree = tree("test", &area_before, &all());
            assert_eq!(area(&tree).as_ref(), Some(&area_before), "{preset:?}");
            let mut panes: Vec<PlotId> = tree
                .tiles
                .tiles()
                .filter_map(|tile| match tile {
                    Tile::Pane(plot) => Some(*plot),
                    Tile::Container(_) => None,
                })
                .collect();
            panes.sort_unstable();
            assert_eq!(panes, all());
        }
        let four = tree("test", &Preset::Four.area(&all()), &all());
        let mut seen = shown(&four);
        seen.sort_unstable();
        let mut first = FIRST.map(PlotId::first);
        first.sort_unstable();
        assert_eq!(seen, first);
    }

    #[test]
    fn a_plot_without_data_is_replaced_until_it_has_some() {
        let one = Preset::One.area(&all());
        let mut tree = tree("test", &one, &all());
        let external = PlotId::first(&sources::external::PLOT);
        bring_forward(&mut tree, external);
        let chosen = area(&tree);
        let places = substitute(&mut tree, |kind| kind != &sources::external::PLOT);
        assert_eq!(shown(&tree), [PlotId::first(&sources::residuals::PLOT)]);
        restore(&mut tree, &places);
        assert_eq!(area(&tree), chosen, "preferences keep what was chosen");
        assert!(substitute(&mut tree, |_| true).is_empty());
        // Without the residuals, the first plot with data; a plot chosen meanwhile stays.
        remove(&mut tree, PlotId::first(&sources::residuals::PLOT));
        let places = substitute(&mut tree, |kind| {
            [&sources::elongation::PLOT, &scope::PLOT].contains(&kind)
        });
        assert_eq!(shown(&tree), [PlotId::first(&sources::elongation::PLOT)]);
        bring_forward(&mut tree, PlotId::first(&scope::PLOT));
        restore(&mut tree, &places);
        assert_eq!(shown(&tree), [PlotId::first(&scope::PLOT)]);
        bring_forward(&mut tree, external);
        assert!(substitute(&mut tree, |kind| kind == &scope::PLOT).is_empty());
    }

    #[test]
    fn unknown_double_and_missing_plots_of_preferences_do_no_harm() {
        let place = |plots: &[&str]| PlotShare {
            share: 0.5,
            area: PlotArea::Tabs {
                plots: plots.iter().map(ToString::to_string).collect(),
                shown: Some("weather".into()),
            },
        };
        let stored = PlotArea::Row(vec![
            place(&["weather"]),
            place(&["laser", "laser"]),
            place(&["laser", "residuals"]),
        ]);
        let restored = tree("test", &stored, &all());
        let Some(PlotArea::Row(places)) = area(&restored) else {
            panic!("a row");
        };
        let plots: Vec<&Vec<String>> = places
            .iter()
            .filter_map(|place| match &place.area {
                PlotArea::Tabs { plots, .. } => Some(plots),
                _ => None,
            })
            .collect();
        assert_eq!(plots.len(), 2);
        assert_eq!(plots[0].len() + plots[1].len(), PLOTS.len());
        assert_eq!(
            (plots[0][0].as_str(), plots[1][0].as_str()),
            ("laser", "residuals")
        );
        assert!(area(&tree("test", &PlotArea::Row(Vec::new()), &all())).is_some());
    }
}

//! Live scope: readings of the controller as they arrive, and their rates compared with the limits of standstill.

use egui::{Align, Id, Rect, Ui, UiBuilder, vec2};
use tautline_workflow::plot::figure::{Axis, Band, Curve, Figure, Ink};
use tautline_workflow::plot::round::round_up;
use tautline_workflow::wording::cable_label;

use super::view::{PlotInput, PlotView};
use crate::model::link::scope::{Channel, Extent, Reading, SPAN_S, Scope};
use crate::model::{Memo, Model};
use crate::theme::{self, GRID};
use crate::views::plots::kind::{Content, PlotKind, no_options};
use crate::widgets::UiExt;

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "scope",
    title: "Live scope",
    // The scope itself states what it waits for.
    missing: |_| None,
    options: no_options,
    content: Content::Scope,
};

/// Displayed decades of the rates, as multiples of the limit at standstill.
const DECADES: [f64; 2] = [-2.0, 3.0];
/// Smallest size of one of several graphs (points).
const LEAST: egui::Vec2 = egui::Vec2::new(220.0, 104.0);
/// Longest interval between two readings connected by a line (s).
const CONNECTED_S: f64 = 0.45;

/// Content of a graph of the scope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Graph {
    /// Tensions of all cables.
    #[default]
    Tensions,
    /// Laser distance.
    Laser,
    /// Revolutions of all winches.
    Revolutions,
    /// Rates of change.
    Speed,
}

impl Graph {
    const ALL: [Self; 4] = [Self::Tensions, Self::Speed, Self::Laser, Self::Revolutions];

    fn title(self) -> &'static str {
        match self {
            Self::Tensions => "Tensions",
            Self::Laser => "Laser",
            Self::Revolutions => "Revolutions",
            Self::Speed => "Speed",
        }
    }
}

/// Graph with its figure and the range along y.
#[derive(Debug)]
struct ScopeGraph {
    graph: Graph,
    figure: Figure,
    y: [f64; 2],
}

/// State of the scope between frames.
#[derive(Debug, Default)]
pub(crate) struct ScopeState {
    /// Graph shown if there is no room for all.
    chosen: Graph,
    /// Graphs, by time interval and selected cable.
    graphs: Memo<(i64, Option<usize>), Vec<ScopeGraph>>,
    views: [PlotView; Graph::ALL.len()],
}

pub(super) fn show(ui: &mut Ui, model: &Model, state: &mut ScopeState) {
    let moment = model.link.scope(Scope::moment).flatten();
    let Some(key) = moment.map(|moment| (moment, model.selection.cable)) else {
        let text = "Readings of the controller appear here as they come: tensions, laser, revolutions, and how fast \
                    they change.";
        return ui.empty(text);
    };
    let cable = model.selection.cable;
    let link = &model.link;
    let graphs = state.graphs.get(key, || {
        link.scope(|scope| graphs(scope, cable)).unwrap_or_default()
    });
    let rows = graphs.len().div_ceil(2).max(1) as f32;
    let room = ui.available_size() - vec2(0.0, 6.0 * GRID);
    let cell = vec2(room.x / 2.0, room.y / rows);
    let fits_all = cell.x >= LEAST.x && cell.y >= LEAST.y;
    head(ui, model, fits_all, graphs, &mut state.chosen);
    let shown = match (fits_all, cell.x >= LEAST.x) {
        (true, _) => Graph::ALL.to_vec(),
        // The rates are always visible if there is room for two.
        (false, true) if state.chosen != Graph::Speed => vec![state.chosen, Graph::Speed],
        (false, true) => vec![Graph::Tensions, Graph::Speed],
        (false, false) => vec![state.chosen],
    };
    let shown: Vec<_> = graphs
        .iter()
        .filter(|one| shown.contains(&one.graph))
        .collect();
    let whole = ui.available_rect_before_wrap();
    let columns = shown.len().clamp(1, 2);
    let lines = shown.len().div_ceil(columns).max(1);
    let size = whole.size() / vec2(columns as f32, lines as f32);
    for (place, one) in shown.into_iter().enumerate() {
        let at = vec2((place % columns) as f32, (place / columns) as f32) * size;
        let rect = Rect::from_min_size(whole.min + at, size);
        let mut inner = ui.new_child(UiBuilder::new().id_salt(place).max_rect(rect));
        let input = PlotInput {
            name: &format!("Live: {}", one.graph.title()),
            id: Id::unique(("live scope", one.graph as u8)),
            figure: &one.figure,
            generation: key.0.unsigned_abs(),
            whole: [[-SPAN_S, 0.0], one.y],
            selection: model.selection,
            size,
            link: Some(Id::unique("live scope")),
            is_docked: false,
            can_be_saved: false,
            is_explained: false,
        };
        state.views[one.graph as usize].show(&mut inner, &input);
    }
    ui.advance_cursor_after_rect(whole);
}

/// Current operation, and the choice of a graph if there is no room for all.
fn head(ui: &mut Ui, model: &Model, fits_all: bool, graphs: &[ScopeGraph], chosen: &mut Graph) {
    ui.horizontal(|ui| {
        if !fits_all {
            for ScopeGraph { graph, .. } in graphs {
                ui.selectable_value(chosen, *graph, graph.title());
            }
        }
        let doing = model.link.doing().unwrap_or_else(|| {
            let is_stopped = model.link.is_stopped && model.link.is_connected();
            if is_stopped { "Stopped" } else { "Idle" }.to_owned()
        });
        let words = [Some(doing), model.link.time_left()];
        let words: Vec<String> = words.into_iter().flatten().collect();
        ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
            let words = egui::RichText::new(words.join(", ")).color(theme::of(ui).muted);
            ui.add(egui::Label::new(words).truncate());
        });
    });
}

/// Graphs for which a robot has readings.
fn graphs(scope: &Scope, cable: Option<usize>) -> Vec<ScopeGraph> {
    let graphs = Graph::ALL.map(|graph| {
        let figure = figure(scope, graph, cable);
        let y = along_y(graph, &figure);
        ScopeGraph { graph, figure, y }
    });
    let has_readings =
        |shown: &ScopeGraph| shown.figure.curves.iter().any(|c| !c.points.is_empty());
    graphs.into_iter().filter(has_readings).collect()
}

fn figure(scope: &Scope, graph: Graph, selected: Option<usize>) -> Figure {
    let y = match graph {
        Graph::Tensions => Axis::new("Tension", "N"),
        Graph::Laser => Axis::new("Laser distance", "mm"),
        Graph::Revolutions => Axis::new("Revolutions", ""),
        Graph::Speed => Axis::logarithmic("Speed", "limit = 1"),
    };
    let mut figure = Figure {
        x: Axis::new("Time", "s"),
        y,
        ..Figure::default()
    };
    match graph {
        Graph::Tensions => cables(&mut figure, scope, selected, Channel::Tension),
        Graph::Revolutions => cables(&mut figure, scope, selected, Channel::Revolutions),
        Graph::Laser => {
            let points = line(scope.extents(Channel::Laser), |metres| metres * 1e3);
            figure.curves.push(Curve::new("", Ink::Accent, points));
        }
        Graph::Speed => {
            let inks = [Ink::Accent, Ink::Warning, Ink::Muted];
            for (reading, ink) in Reading::ALL.into_iter().zip(inks) {
                let name = match reading {
                    Reading::Length => "Lengths",
                    Reading::Tension => "Tensions",
                    Reading::Laser => "Laser",
                };
                let decade = |speed: f64| speed.log10().clamp(DECADES[0], DECADES[1]);
                let points = line(scope.extents(Channel::Speed(reading)), decade);
                if !points.is_empty() {
                    figure.curves.push(Curve::new(name, ink, points));
                }
            }
            figure.bands.push(Band::new("still", [DECADES[0], 0.0]));
        }
    }
    figure
}

/// Line for each cable, in its colour; if a cable is selected, the others fade.
fn cables(
    figure: &mut Figure,
    scope: &Scope,
    selected: Option<usize>,
    channel: fn(usize) -> Channel,
) {
    let selected = selected.filter(|index| *index < scope.cables());
    let others = (0..scope.cables()).filter(|index| Some(*index) != selected);
    // The line drawn last is on top.
    for index in others.chain(selected) {
        let ink = match selected {
            Some(selected) if selected != index => Ink::Muted,
            _ => Ink::Cable(index),
        };
        let points = line(scope.extents(channel(index)), |value| value);
        let name = scope.names().nth(index).unwrap_or_default();
        figure
            .curves
            .push(Curve::new(cable_label(index, name), ink, points));
    }
}

/// Line through minima and maxima, interrupted where nothing was read.
fn line(extents: impl Iterator<Item = Extent>, shown: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for Extent { time_s, values } in extents {
        let [mut first, mut second] = values.map(&shown);
        if let Some([before_s, before]) = points.last().copied() {
            if time_s - before_s > CONNECTED_S {
                points.push([f64::NAN, f64::NAN]);
            } else if (before - second).abs() < (before - first).abs() {
                (first, second) = (second, first);
            }
        }
        points.push([time_s, first]);
        if second != first {
            points.push([time_s, second]);
        }
    }
    points
}

/// Range along y: fixed for the rates, otherwise rounded outwards so that it rarely changes.
fn along_y(graph: Graph, figure: &Figure) -> [f64; 2] {
    if graph == Graph::Speed {
        return DECADES;
    }
    let values = figure.curves.iter().flat_map(|curve| &curve.points);
    let values = values.map(|[_, value]| *value).filter(|v| v.is_finite());
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    let least = match graph {
        Graph::Tensions => 4.0,
        Graph::Laser => 1.0,
        Graph::Revolutions | Graph::Speed => 0.1,
    };
    round_around([low, high], least)
}

/// Range of round numbers around another, with a smallest width.
fn round_around([low, high]: [f64; 2], least: f64) -> [f64; 2] {
    if low > high {
        return [0.0, least];
    }
    let step = round_up((high - low).max(least) / 4.0);
    let (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
    if high - low < least {
        return [low - step, high + step];
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_round_and_hold_everything() {
        for range in [[3.1, 97.0], [-0.4, -0.39], [120.0, 120.0], [0.0, 1e-7]] {
            let [low, high] = round_around(range, 1.0);
            assert!(low <= range[0] && high >= range[1], "{range:?}");
            assert!(high - low >= 1.0 && high - low <= 2.0 * (range[1] - range[0]).max(3.0));
            // Slightly different values do not change the range.
            let inside = [low + 0.2 * (high - low), high - 0.2 * (high - low)];
            let again = round_around(inside, 1.0);
            assert!(again[0] >= low && again[1] <= high);
        }
        assert_eq!(
            round_around([f64::INFINITY, f64::NEG_INFINITY], 1.0),
            [0.0, 1.0]
        );
    }

    #[test]
    fn a_line_keeps_extremes_and_shows_gaps() {
        let extent = |time_s: f64, values: [f64; 2]| Extent { time_s, values };
        let extents = [
            extent(-3.0, [1.0, 1.0]),
            extent(-2.9, [1.0, 5.0]),
            extent(-2.8, [4.0, 6.0]),
            extent(-1.0, [2.0, 2.0]),
        ];
        let points = line(extents.into_iter(), |value| value);
        let y: Vec<f64> = points.iter().map(|[_, y]| *y).collect();
        assert_eq!(y[..5], [1.0, 1.0, 5.0, 4.0, 6.0]);
        assert!(y[5].is_nan());
        assert_eq!(y[6], 2.0);
    }
}

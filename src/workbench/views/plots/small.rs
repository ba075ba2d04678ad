//! Plots in panels: fixed height, zoom by Ctrl and wheel, by a box or along an axis; a click selects.

use std::sync::Arc;

use egui::mutex::Mutex;
use egui::{Id, Sense, Ui, Vec2, vec2};
use tautline_workflow::plot::Figure;
use tautline_workflow::plot::draw::{TEXT, legend};
use tautline_workflow::plot::figure::Axis;

use super::screen::{Screen, colours, text_width};
use super::view::{PlotEvent, PlotInput, PlotView};
use crate::model::Selection;
use crate::model::command::PlotFile;
use crate::theme::{self, GRID};

/// Draws a figure over the full width of a panel, `height` points high; `name` is its accessible name. Returns cable
/// and pose of a clicked point; both empty if a click beside all points, or Escape, clears the selection.
pub(crate) fn show(
    ui: &mut Ui,
    name: &str,
    figure: &Figure,
    height: f32,
    selection: Selection,
) -> Option<Selection> {
    let size = vec2(ui.available_width(), height);
    let plot = SmallPlot {
        name,
        figure,
        generation: ui.ctx().cumulative_pass_nr(),
        size,
        link: None,
        is_explained: false,
    };
    let (_, events) = draw(ui, &plot, selection);
    events.into_iter().find_map(|event| match event {
        PlotEvent::Selected(selection) => Some(selection),
        _ => None,
    })
}

/// One of several plots that are zoomed and panned together along x.
pub(crate) struct SmallPlot<'a> {
    /// Accessible name.
    pub(crate) name: &'a str,
    pub(crate) figure: &'a Figure,
    /// Number that changes with the figure.
    pub(crate) generation: u64,
    pub(crate) size: Vec2,
    /// Name of the link between the plots.
    pub(crate) link: Option<&'a str>,
    /// Whether the legend is above the plots, see [`legend_of`].
    pub(crate) is_explained: bool,
}

/// Draws the common legend of several plots.
pub(crate) fn legend_of(ui: &mut Ui, figure: &Figure, selection: Selection) {
    let bare = Figure {
        y: Axis::default(),
        ..figure.clone()
    };
    let size = vec2(ui.available_width(), TEXT + 2.0 * GRID);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let mut canvas = Screen::new(ui.painter_at(rect));
    for entry in legend(&bare, rect, &text_width(ui.painter())) {
        entry.draw(&mut canvas, &colours(theme::of(ui)), selection, true);
    }
}

/// Interaction with a plot.
#[derive(Debug, Default)]
pub(crate) struct PlotResponse {
    pub(crate) is_clicked: bool,
    /// Requested file, with the suffix of its name.
    pub(crate) saved: Option<(&'static str, PlotFile)>,
}

/// Draws one of several linked plots; its menu saves it.
pub(crate) fn show_linked(ui: &mut Ui, plot: &SmallPlot<'_>, selection: Selection) -> PlotResponse {
    let (view, events) = draw(ui, plot, selection);
    let mut asked = PlotResponse::default();
    for event in events {
        match event {
            PlotEvent::Selected(_) => asked.is_clicked = true,
            PlotEvent::Save(format) => {
                let view = view.lock();
                let file = view.file(ui, plot.name, plot.figure, selection, format);
                asked.saved = file.map(|file| (format.ending(), file));
            }
            PlotEvent::Excluded(_) => {}
        }
    }
    asked
}

type KeptView = Arc<Mutex<PlotView>>;

fn draw(ui: &mut Ui, plot: &SmallPlot<'_>, selection: Selection) -> (KeptView, Vec<PlotEvent>) {
    let id = ui.make_persistent_id(plot.name);
    let kept = ui.data(|data| data.get_temp::<KeptView>(id));
    let view = kept.unwrap_or_default();
    let input = PlotInput {
        name: plot.name,
        id: id.with("plot"),
        figure: plot.figure,
        generation: plot.generation,
        whole: plot.figure.whole(),
        selection,
        size: plot.size,
        link: plot.link.map(Id::unique),
        is_docked: false,
        can_be_saved: plot.link.is_some(),
        is_explained: plot.is_explained,
    };
    let output = view.lock().show(ui, &input);
    ui.data_mut(|data| data.insert_temp(id, Arc::clone(&view)));
    (view, output.events)
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;
    use crate::theme;
    use tautline_workflow::plot::figure::{Axis, Band, Curve, Ink, Point, Series};

    fn figure() -> Figure {
        let point = |pose: i64| Point {
            pose: Some(pose),
            sd: [0.0, 0.02],
            ..Point::new(pose as f64, -0.05)
        };
        Figure {
            x: Axis::new("Length", "m"),
            y: Axis::new("Residual", "mm"),
            bands: vec![Band::new("within 0.1 mm", [-0.1, 0.1])],
            series: vec![Series::of_cable(2, "cable-3", (0..5).map(point).collect())],
            curves: vec![Curve::new("fit", Ink::Text, vec![[0.0, -0.1], [4.0, 0.1]])],
            has_zero_line: true,
            ..Figure::default()
        }
    }

    #[test]
    fn a_click_on_a_point_selects_its_cable_and_pose_and_escape_clears_them() {
        let mut harness = Harness::builder()
            .with_size(vec2(320.0, 180.0))
            .build_ui_state(
                |ui, (clicked, id): &mut (Option<Selection>, Option<Id>)| {
                    theme::install(ui.ctx());
                    *id = Some(ui.make_persistent_id("Winch 3").with("plot"));
                    let selection = clicked.unwrap_or_default();
                    let found = show(ui, "Winch 3", &figure(), 160.0, selection);
                    *clicked = found.or(*clicked);
                },
                (None, None),
            );
        harness.run();
        let rect = harness.get_by_label("Winch 3").rect();
        let id = harness.state().1.expect("drawn");
        let memory = egui_plot::PlotMemory::load(&harness.ctx, id).expect("drawn");
        let scale = super::super::view::scale_of(&memory.transform());
        assert!(rect.contains_rect(scale.rect), "{scale:?} in {rect:?}");
        let place = scale.place(2.0, -0.05);
        harness.hover_at(place);
        harness.drag_at(place);
        harness.drop_at(place);
        harness.run();
        let expected = Selection {
            cable: Some(2),
            pose: Some(2),
        };
        assert_eq!(harness.state().0, Some(expected));
        harness.hover_at(place);
        harness.run();
        harness.key_press(egui::Key::Escape);
        harness.run();
        assert_eq!(harness.state().0, Some(Selection::default()));
    }
}

//! View of a figure with `egui_plot`, which provides axes, grid, panning, zoom, box zoom and linked axes. Added are
//! readings with bars, thinned to the screen resolution, a legend beside the title, and cursors A and B.

mod axes;
mod cursors;
mod items;
mod saved;

use std::cell::RefCell;
use std::collections::BTreeSet;

use egui::{
    Align2, Id, Key, Popup, Pos2, Rect, Response, Role, Sense, Shape, Ui, UiBuilder, Vec2,
    WidgetInfo, vec2,
};
use tautline_workflow::plot::draw::{TEXT, legend, right_margin};
use tautline_workflow::plot::figure::Series;
use tautline_workflow::plot::heat::colour_scale;
use tautline_workflow::plot::scale::Scale;
use tautline_workflow::plot::table::csv;
use tautline_workflow::plot::{Canvas, Colours, Figure, Stroke};

use super::hit::{Hit, cell_words, nearest, selects, words};
use super::screen::{Screen, colours, text_width};
use crate::model::command::Format;
use crate::model::{Memo, Selection};
use crate::theme::{self, GRID};
pub(crate) use axes::scale_of;
use axes::{arranged, zoom_by_wheel};
pub(crate) use cursors::CursorColumn;
use items::{DrawnPoints, ShapesKey};

/// State of a plot between frames, except the zoom, which `egui_plot` stores by the id of the plot.
#[derive(Debug, Default)]
pub(crate) struct PlotView {
    /// Names of the series, curves, bands and histograms hidden by the legend.
    hidden: BTreeSet<String>,
    /// Positions of the cursors A and B along x, at readings, while shown.
    pub(crate) cursors: Option<[f64; 2]>,
    grabbed: Option<usize>,
    resets: bool,
    /// Geometry of the last frame.
    pub(crate) drawn: Option<PlotExtent>,
    /// Cached shapes of the heat map.
    heat: RefCell<Memo<ShapesKey, Vec<Shape>>>,
    /// Cached shapes of the points.
    points: RefCell<Memo<ShapesKey, DrawnPoints>>,
    menu: Selection,
}

/// Axis scale, rectangle of the data, and size of the whole plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlotExtent {
    pub(crate) scale: Scale,
    pub(crate) size: Vec2,
}

/// An interaction with a plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PlotEvent {
    Selected(Selection),
    /// Exclude a pose, or include it again.
    Excluded(i64),
    Save(Format),
}

/// Inputs of a plot in a frame.
pub(crate) struct PlotInput<'a> {
    /// Accessible name.
    pub(crate) name: &'a str,
    /// Id to which the zoom belongs.
    pub(crate) id: Id,
    pub(crate) figure: &'a Figure,
    /// Number that changes with the figure.
    pub(crate) generation: u64,
    /// Displayed range without zoom.
    pub(crate) whole: [[f64; 2]; 2],
    pub(crate) selection: Selection,
    pub(crate) size: Vec2,
    /// Id of plots that are zoomed and panned together along x.
    pub(crate) link: Option<Id>,
    /// Whether the plot is docked: the wheel zooms and poses can be excluded. In a panel the wheel scrolls the panel.
    pub(crate) is_docked: bool,
    /// Whether the menu has entries for saving.
    pub(crate) can_be_saved: bool,
    /// Whether the legend is above the linked plots.
    pub(crate) is_explained: bool,
}

#[derive(Debug, Default)]
pub(crate) struct PlotOutput {
    pub(crate) events: Vec<PlotEvent>,
    /// Selection under the pointer, while it is over the plot.
    pub(crate) hovered: Option<Selection>,
}

impl PlotView {
    /// Resets the zoom in the next frame.
    pub(crate) fn reset(&mut self) {
        self.resets = true;
    }

    /// Figure without the items hidden by the legend.
    pub(crate) fn visible(&self, figure: &Figure) -> Figure {
        let mut visible = figure.clone();
        visible.series.retain(|one| !self.is_hidden(figure, one));
        visible
            .curves
            .retain(|one| !self.hidden.contains(&one.name));
        visible.ribbons.retain(|one| !self.hidden.contains(&one.of));
        visible.bands.retain(|one| !self.hidden.contains(&one.name));
        visible
            .columns
            .retain(|one| !self.hidden.contains(&one.name));
        visible
    }

    /// Whether a series is hidden: by its own entry, or by that of its cable or set if it has none.
    fn is_hidden(&self, figure: &Figure, series: &Series) -> bool {
        let of_set = series.name.split_once(": ").map(|(set, _)| set);
        let of_cable = figure.series.iter().find(|one| {
            series.short.is_empty() && one.cable == series.cable && one.cable.is_some()
        });
        self.hidden.contains(&series.name)
            || of_set.is_some_and(|set| self.hidden.contains(set))
            || of_cable.is_some_and(|one| self.hidden.contains(&one.name))
    }

    pub(crate) fn show(&mut self, ui: &mut Ui, input: &PlotInput<'_>) -> PlotOutput {
        let (outer, whole) = ui.allocate_exact_size(input.size, Sense::hover());
        whole.widget_info(|| WidgetInfo::labeled(Role::Image, true, input.name));
        if !ui.is_rect_visible(outer) {
            return PlotOutput::default();
        }
        let palette = theme::of(ui);
        let colours = colours(palette);
        let figure = input.figure;
        let top = self.head(ui, input, outer.shrink2(vec2(GRID, 0.5 * GRID)), &colours);
        let right = right_margin(figure, &text_width(ui.painter()));
        let inner = Rect::from_min_max(
            Pos2::new(outer.min.x + GRID, top + GRID),
            outer.max - vec2(right + GRID, 0.5 * GRID),
        );
        let grabbed = self.grab(ui, outer);
        let mut inside = ui.new_child(UiBuilder::new().max_rect(inner).id_salt(input.id));
        inside.visuals_mut().extreme_bg_color = palette.ground;
        let resets = std::mem::take(&mut self.resets);
        let view = &*self;
        let response =
            arranged(input, inner, &colours)
                .allow_drag(!grabbed)
                .show(&mut inside, |plot| {
                    if resets {
                        plot.set_auto_bounds(true);
                    } else if input.is_docked {
                        zoom_by_wheel(plot, inner);
                    }
                    view.add_items(plot, input, &colours);
                });
        let scale = scale_of(&response.transform);
        self.drawn = Some(PlotExtent {
            scale,
            size: outer.size(),
        });
        let response = response.response;
        let mut canvas = Screen::new(ui.painter_at(outer));
        if let Some(heat) = &figure.heat {
            colour_scale(&mut canvas, heat, scale.rect, &colours);
        }
        if let Some(cursors) = self.cursors {
            for (x, name) in cursors.into_iter().zip(["A", "B"]) {
                let at = Pos2::new(scale.x(x), scale.rect.min.y) + vec2(0.75 * GRID, 0.5 * GRID);
                if scale.rect.contains(at) {
                    canvas.text(at, Align2::LEFT_TOP, name, TEXT, palette.accent);
                }
            }
        }
        let under = response.hover_pos().filter(|_| !grabbed);
        let hit = under.and_then(|at| {
            let hit = nearest(figure, &scale, at, input.selection)?;
            (!self.is_hidden(figure, &figure.series[hit.series])).then_some(hit)
        });
        if let Some(hit) = hit {
            let point = figure.series[hit.series].points()[hit.point];
            let stroke = Stroke::new(1.5, palette.text);
            canvas.ring(scale.place(point.x, point.y), 5.5, stroke);
        }
        drop(canvas);
        if grabbed && let Some(at) = ui.input(|input| input.pointer.latest_pos()) {
            self.move_cursor(figure, scale.values(at)[0]);
        }
        self.respond(ui, &response, input, &scale, hit)
    }

    /// Draws the title of the y axis and the legend, whose entries show and hide items; returns the lower edge.
    fn head(&mut self, ui: &Ui, input: &PlotInput<'_>, rect: Rect, colours: &Colours) -> f32 {
        let figure = input.figure;
        let mut canvas = Screen::new(ui.painter_at(rect));
        let title = figure.y.title();
        canvas.text(rect.min, Align2::LEFT_TOP, &title, TEXT, colours.text);
        let mut bottom = rect.min.y + TEXT + GRID;
        let entries = match input.is_explained {
            true => Vec::new(),
            false => legend(figure, rect, &text_width(ui.painter())),
        };
        for entry in entries {
            let id = input.id.with(("legend", &entry.name, &entry.text));
            let response = ui.interact(entry.rect, id, Sense::click());
            let name = format!("Series {}", entry.name);
            if response.clicked() && !self.hidden.remove(&entry.name) {
                self.hidden.insert(entry.name.clone());
            }
            let is_shown = !self.hidden.contains(&entry.name);
            response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, is_shown, &name));
            entry.draw(&mut canvas, colours, input.selection, is_shown);
            bottom = bottom.max(entry.rect.max.y);
            response.on_hover_text(format!("{}: click to hide or show", entry.name));
        }
        bottom
    }

    fn respond(
        &mut self,
        ui: &Ui,
        response: &Response,
        input: &PlotInput<'_>,
        scale: &Scale,
        hit: Option<Hit>,
    ) -> PlotOutput {
        let mut output = PlotOutput::default();
        let figure = input.figure;
        let under = response.hover_pos();
        let selected = hit.map(|hit| selects(figure, hit));
        output.hovered = under.map(|_| selected.unwrap_or_default());
        let cell = under.map(|at| scale.values(at));
        if let Some(hit) = hit {
            let text = words(figure, hit, scale);
            response.clone().on_hover_text_at_pointer(text);
        } else if let Some(text) = cell.and_then(|at| cell_words(figure, at)) {
            response.clone().on_hover_text_at_pointer(text);
        }
        if response.clicked() {
            let cable = figure
                .heat
                .as_ref()
                .zip(cell)
                .and_then(|(heat, [x, y])| *heat.cables.get(heat.cell(x, y)?.1)?);
            let selection = selected.or(cable.map(Selection::cable));
            output
                .events
                .push(PlotEvent::Selected(selection.unwrap_or_default()));
        }
        if response.secondary_clicked() {
            self.menu = selected.unwrap_or(input.selection);
            output.events.extend(selected.map(PlotEvent::Selected));
        }
        let has_menu = self.context_menu(response, input, scale, &mut output.events);
        if response.contains_pointer() && !has_menu {
            let pressed = |key| ui.input(|input| input.key_pressed(key));
            if let Some(pose) = input.selection.pose
                && input.is_docked
                && pressed(Key::Delete)
            {
                output.events.push(PlotEvent::Excluded(pose));
            }
            if !input.selection.is_empty() && pressed(Key::Escape) {
                output
                    .events
                    .push(PlotEvent::Selected(Selection::default()));
            }
        }
        output
    }

    fn context_menu(
        &mut self,
        response: &Response,
        input: &PlotInput<'_>,
        scale: &Scale,
        events: &mut Vec<PlotEvent>,
    ) -> bool {
        let menu = Popup::context_menu(response).show(|ui| {
            let pose = self.menu.pose.filter(|pose| *pose != 0 && input.is_docked);
            if let Some(pose) = pose
                && ui
                    .button(format!("Exclude or include pose {pose}"))
                    .clicked()
            {
                events.push(PlotEvent::Excluded(pose));
            }
            if ui.button("Reset view").clicked() {
                self.resets = true;
            }
            if ui.button("Copy values").clicked() {
                ui.ctx()
                    .copy_text(csv(&self.visible(input.figure), scale.view));
            }
            for format in Format::ALL.into_iter().filter(|_| input.can_be_saved) {
                if ui.button(format!("Save as {}", format.title())).clicked() {
                    events.push(PlotEvent::Save(format));
                }
            }
        });
        menu.is_some()
    }
}

#[cfg(test)]
mod tests {
    use egui::{Event, Modifiers, OutputCommand, PointerButton};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use tautline_workflow::plot::figure::{Axis, Curve, Ink, Point};

    use super::*;

    fn figure() -> Figure {
        let point = |pose: i64, offset: f64| Point {
            pose: Some(pose),
            ..Point::new(pose as f64, (pose % 3) as f64 + offset)
        };
        let series = |cable: usize, offset: f64| {
            let points = (1..=9).map(|pose| point(pose, offset)).collect();
            Series::of_cable(cable, format!("cable-{}", cable + 1), points)
        };
        Figure {
            x: Axis::whole("Pose"),
            y: Axis::new("Residual", "mm"),
            series: vec![series(0, 0.0), series(1, 5.0)],
            curves: vec![Curve::new("fit", Ink::Text, vec![[1.0, 0.0], [9.0, 7.0]])],
            ..Figure::default()
        }
    }

    struct Seen {
        view: PlotView,
        events: Vec<PlotEvent>,
        selection: Selection,
    }

    fn harness() -> Harness<'static, Seen> {
        let show = |ui: &mut Ui, seen: &mut Seen| {
            if ui.ctx().cumulative_pass_nr() == 0 {
                // Fonts are available from the next frame on.
                theme::install(ui.ctx());
                return;
            }
            let figure = figure();
            let input = PlotInput {
                name: "Plot",
                id: Id::unique("tested plot"),
                figure: &figure,
                generation: 1,
                whole: figure.whole(),
                selection: seen.selection,
                size: ui.available_size(),
                link: None,
                is_docked: true,
                can_be_saved: true,
                is_explained: false,
            };
            seen.events.extend(seen.view.show(ui, &input).events);
        };
        let seen = Seen {
            view: PlotView::default(),
            events: Vec::new(),
            selection: Selection::default(),
        };
        let mut harness = Harness::builder()
            .with_size(vec2(640.0, 240.0))
            .with_step_dt(1.0 / 60.0)
            .build_ui_state(show, seen);
        harness.run();
        harness
    }

    fn scale(harness: &Harness<'_, Seen>) -> Scale {
        harness.state().view.drawn.expect("drawn").scale
    }

    fn drag(harness: &mut Harness<'_, Seen>, button: PointerButton, from: Pos2, to: Pos2) {
        harness.hover_at(from);
        harness.run_ok();
        let press = |pos, pressed| Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers: Modifiers::NONE,
        };
        harness.event(press(from, true));
        harness.run_ok();
        for share in [0.04, 0.5, 1.0] {
            harness.hover_at(from.lerp(to, share));
            harness.run_ok();
        }
        harness.event(press(to, false));
        harness.run_ok();
    }

    fn click(harness: &mut Harness<'_, Seen>, at: Pos2) {
        harness.hover_at(at);
        harness.drag_at(at);
        harness.drop_at(at);
        harness.run_ok();
    }

    #[test]
    fn a_click_selects_the_point_and_escape_clears_the_selection() {
        let mut harness = harness();
        assert!(harness.get_by_label("Plot").rect().is_positive());
        let at = scale(&harness).place(4.0, 1.0);
        click(&mut harness, at);
        let expected = Selection {
            cable: Some(0),
            pose: Some(4),
        };
        assert_eq!(harness.state().events, [PlotEvent::Selected(expected)]);
        harness.state_mut().selection = expected;
        harness.hover_at(at);
        harness.run_ok();
        harness.key_press(Key::Escape);
        harness.run_ok();
        let cleared = PlotEvent::Selected(Selection::default());
        assert_eq!(harness.state().events.last(), Some(&cleared));
    }

    #[test]
    fn the_menu_copies_the_values_that_are_seen() {
        let mut harness = harness();
        let pos = scale(&harness).rect.center();
        harness.hover_at(pos);
        harness.run_ok();
        for pressed in [true, false] {
            harness.event(Event::PointerButton {
                pos,
                button: PointerButton::Secondary,
                pressed,
                modifiers: Modifiers::NONE,
            });
        }
        harness.run_ok();
        harness.get_by_label("Copy values").click();
        harness.step();
        let commands = harness.output().platform_output.commands.iter();
        let text = commands.rev().find_map(|command| match command {
            OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
        let lines = text.expect("something is copied").lines().count();
        assert_eq!(lines, 1 + 2 * 9 + 2, "headings, two series, a curve");
    }

    #[test]
    fn dragging_moves_a_box_zooms_and_a_double_click_resets() {
        let mut harness = harness();
        let whole = scale(&harness);
        let at = whole.place(4.0, 1.0);
        drag(
            &mut harness,
            PointerButton::Primary,
            at,
            at + vec2(60.0, 0.0),
        );
        let moved = scale(&harness);
        assert!(moved.view[0][0] < whole.view[0][0] - 0.5, "{moved:?}");
        assert!((moved.view[1][0] - whole.view[1][0]).abs() < 1e-6);
        harness.state_mut().view.reset();
        harness.run_ok();
        assert_eq!(scale(&harness).view, whole.view);
        let corners = [whole.place(3.0, 4.0), whole.place(6.0, 1.0)];
        drag(
            &mut harness,
            PointerButton::Secondary,
            corners[0],
            corners[1],
        );
        let [x, y] = scale(&harness).view;
        for (seen, drawn) in [(x, [3.0, 6.0]), (y, [1.0, 4.0])] {
            assert!((seen[0] - drawn[0]).abs() < 0.3 && (seen[1] - drawn[1]).abs() < 0.3);
        }
        let pos = whole.rect.center();
        harness.hover_at(pos);
        harness.run_ok();
        for pressed in [true, false, true, false] {
            harness.event(Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            });
        }
        harness.run_ok();
        assert_eq!(scale(&harness).view, whole.view);
    }

    #[test]
    fn dragging_an_axis_zooms_along_it() {
        let mut harness = harness();
        let whole = scale(&harness);
        let below = Pos2::new(whole.rect.center().x, whole.rect.max.y + 6.0);
        drag(
            &mut harness,
            PointerButton::Primary,
            below,
            below + vec2(30.0, 0.0),
        );
        let [x, y] = scale(&harness).view;
        assert!(
            x[1] - x[0] < 0.9 * (whole.view[0][1] - whole.view[0][0]),
            "{x:?}"
        );
        assert!((y[0] - whole.view[1][0]).abs() < 1e-9);
    }

    #[test]
    fn an_entry_of_the_legend_switches_its_series_off_and_on() {
        let mut harness = harness();
        let at = scale(&harness).place(4.0, 1.0);
        for shown in [false, true] {
            harness.get_by_label("Series cable-1").click();
            harness.run_ok();
            let view = &harness.state().view;
            let names = view.visible(&figure()).series.into_iter().map(|s| s.name);
            assert_eq!(
                names.collect::<Vec<_>>().contains(&"cable-1".to_owned()),
                shown
            );
            click(&mut harness, at);
            let event = harness.state().events.last().copied();
            let is_hit = |event| matches!(event, PlotEvent::Selected(found) if !found.is_empty());
            assert_eq!(event.is_some_and(is_hit), shown);
        }
        harness.get_by_label("Series fit").click();
        harness.run_ok();
        assert!(harness.state().view.visible(&figure()).curves.is_empty());
    }

    #[test]
    fn cursors_snap_to_readings_and_read_all_series() {
        let mut harness = harness();
        harness.state_mut().view.switch_cursors(&figure());
        harness.run_ok();
        let before = scale(&harness);
        let [a, b] = harness.state().view.cursors.expect("cursors");
        assert_eq!([a.fract(), b.fract()], [0.0; 2]);
        let at = Pos2::new(before.x(a), before.rect.center().y);
        let to = Pos2::new(before.x(5.2), at.y);
        drag(&mut harness, PointerButton::Primary, at, to);
        assert_eq!(harness.state().view.cursors, Some([5.0, b]));
        assert_eq!(scale(&harness).view, before.view, "the view stays");
        let columns = harness.state().view.readings(&figure()).expect("columns");
        let of = |k: usize| (columns[k].title.as_str(), columns[k].values.each_ref());
        assert_eq!(of(0).0, "Pose");
        assert_eq!(of(0).1[0], "5");
        assert_eq!((of(1).0, of(2).0), ("cable-1", "cable-2"));
        assert_eq!((of(1).1[0].as_str(), of(2).1[0].as_str()), ("2.00", "7.00"));
        assert_eq!(columns[1].unit, "mm");
    }
}

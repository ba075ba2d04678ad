//! A figure that can be zoomed, moved, clicked and measured with two cursors.

use egui::{Align2, Context, Key, Popup, Response, Role, Sense, Theme, Ui, WidgetInfo, vec2};
use tautline_workflow::plot::draw::TEXT;
use tautline_workflow::plot::figure::{Point, Series};
use tautline_workflow::plot::scale::{Scale, readable};
use tautline_workflow::plot::{Canvas, Colours, Figure, Layout, Plot, Stroke, VisiblePoints};

use super::dense::{PictureTexture, picture};
use super::hit::{Hit, cell_words, nearest, selects, words};
use super::screen::{Screen, colours, text_width};
use super::sources::{POSE, TIME};
use crate::model::{Memo, Selection};
use crate::theme::{self, GRID};

/// Points of the wheel that zoom by a factor of e.
const WHEEL: f64 = 240.0;
/// Distance at which a cursor is grabbed (points of the screen).
const GRAB: f32 = 6.0;

/// State of a plot between frames.
#[derive(Debug, Default)]
pub struct Panel {
    /// What is shown, if not everything.
    view: Option<[[f64; 2]; 2]>,
    /// Places of the cursors A and B along x as shares of the width, while they are shown.
    pub cursors: Option<[f64; 2]>,
    grabbed: Option<usize>,
    /// The view that shows everything.
    whole: Memo<u64, [[f64; 2]; 2]>,
    seen: Memo<SeenOf, VisiblePoints>,
    /// Very many points as a picture, and where it belongs.
    dense: Memo<(SeenOf, Theme), Option<PictureTexture>>,
    /// What was drawn last, for files.
    pub drawn: Option<Layout>,
    /// What the context menu is about.
    menu: Selection,
}

#[derive(Debug, Clone, PartialEq)]
struct SeenOf {
    figure: u64,
    scale: Scale,
    selection: Selection,
    pixels_per_point: f32,
}

/// An interaction with a plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Done {
    /// Selected something, or nothing.
    Selected(Selection),
    /// Asked to exclude a pose, or to include it again.
    Excluded(i64),
}

/// A plot of this frame.
pub struct Shown<'a> {
    /// Its accessible name.
    pub name: &'a str,
    /// What it shows.
    pub figure: &'a Figure,
    /// Changes with the figure.
    pub generation: u64,
    /// What is selected.
    pub selection: Selection,
}

/// Interactions of a frame.
#[derive(Debug, Default)]
pub struct Frame {
    /// What the operator changed.
    pub done: Vec<Done>,
    /// What is under the pointer, while it is over the plot.
    pub hovered: Option<Selection>,
}

impl Panel {
    /// Shows everything again.
    pub fn reset(&mut self) {
        self.view = None;
    }

    /// The range along x that is shown, if not everything.
    #[must_use]
    pub fn along(&self) -> Option<[f64; 2]> {
        self.view.map(|view| view[0])
    }

    /// Shows this range along x, or everything.
    pub fn follow(&mut self, range: Option<[f64; 2]>) {
        self.view = range.and_then(|range| {
            let y = self
                .view
                .or(self.drawn.as_ref().map(|layout| layout.scale.view));
            Some([range, y?[1]])
        });
    }

    /// Draws the plot in the space that is left.
    pub fn show(&mut self, ui: &mut Ui, shown: &Shown<'_>) -> Frame {
        let (outer, response) =
            ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, shown.name));
        let whole = outer.shrink2(vec2(GRID, 0.5 * GRID));
        let painter = ui.painter_at(outer);
        let everything = *self.whole.get(shown.generation, || shown.figure.whole());
        let arrange = |view| Layout::new(shown.figure, view, whole, &text_width(&painter));
        let mut layout = arrange(self.view.unwrap_or(everything));
        self.navigate(ui, &response, &layout.scale);
        if let Some(view) = self.view.filter(|view| *view != layout.scale.view) {
            layout = arrange(view);
        }
        let scale = layout.scale;
        let key = SeenOf {
            figure: shown.generation,
            scale,
            selection: shown.selection,
            pixels_per_point: ui.ctx().pixels_per_point(),
        };
        let pixels_per_point = key.pixels_per_point;
        let palette = theme::of(ui);
        let plot = Plot {
            figure: shown.figure,
            layout: &layout,
            seen: self.seen.get(key.clone(), || {
                VisiblePoints::new(shown.figure, &scale, shown.selection, pixels_per_point)
            }),
            selection: shown.selection,
            colours: &colours(palette),
        };
        let mut canvas = Screen::new(painter);
        match self.dense.get((key, ui.theme()), || dense(ui.ctx(), &plot)) {
            Some(PictureTexture { texture, rect }) => {
                plot.draw_behind(&mut canvas);
                canvas.picture(texture.id(), *rect);
                plot.draw_before(&mut canvas);
            }
            None => plot.draw(&mut canvas),
        }
        let under = response.hover_pos();
        let hit = under.and_then(|at| nearest(shown.figure, &scale, at, shown.selection));
        if let Some(hit) = hit {
            let point = shown.figure.series[hit.series].points()[hit.point];
            let at = scale.place(point.x, point.y);
            canvas.ring(at, 5.5, Stroke::new(1.5, palette.text));
        }
        draw_pose(&mut canvas, shown, &scale, palette);
        self.draw_cursors(&mut canvas, ui, &scale);
        drop(canvas);
        let frame = self.respond(ui, &response, shown, &layout, hit);
        self.drawn = Some(layout);
        frame
    }

    /// The plot as drawn last, in other colours.
    pub fn plot<'a>(
        &'a mut self,
        ui: &Ui,
        figure: &'a Figure,
        generation: u64,
        selection: Selection,
        colours: &'a Colours,
    ) -> Option<Plot<'a>> {
        let layout = self.drawn.as_ref()?;
        let pixels_per_point = ui.ctx().pixels_per_point();
        let key = SeenOf {
            figure: generation,
            scale: layout.scale,
            selection,
            pixels_per_point,
        };
        let see = || VisiblePoints::new(figure, &layout.scale, selection, pixels_per_point);
        Some(Plot {
            figure,
            layout,
            seen: self.seen.get(key, see),
            selection,
            colours,
        })
    }

    fn navigate(&mut self, ui: &Ui, response: &Response, scale: &Scale) {
        if let Some(at) = response.hover_pos() {
            let (wheel, pinch) =
                ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = (f64::from(wheel) / WHEEL).exp() * f64::from(pinch);
            if factor != 1.0 {
                // Over an axis only that axis is zoomed.
                let along_x = at.x >= scale.rect.min.x;
                let along_y = at.y <= scale.rect.max.y;
                let of = |is_zoomed: bool| if is_zoomed { factor } else { 1.0 };
                self.view = Some(scale.zoomed(at, [of(along_x), of(along_y)]));
            }
        }
        if response.drag_started_by(egui::PointerButton::Primary) {
            let from = ui.input(|input| input.pointer.press_origin());
            self.grabbed = from.and_then(|at| self.cursor_at(at.x, scale));
        }
        if response.dragged_by(egui::PointerButton::Primary) {
            let by = response.drag_delta();
            match (self.grabbed, &mut self.cursors) {
                (Some(k), Some(cursors)) => {
                    let share = cursors[k] + f64::from(by.x / scale.rect.width());
                    cursors[k] = share.clamp(0.0, 1.0);
                }
                _ => self.view = Some(scale.moved(by)),
            }
        }
        if response.drag_stopped() {
            self.grabbed = None;
        }
        if response.double_clicked() {
            self.reset();
        }
    }

    fn cursor_at(&self, x: f32, scale: &Scale) -> Option<usize> {
        let place = |share: f64| scale.rect.min.x + share as f32 * scale.rect.width();
        let cursors = self.cursors?;
        (0..2).find(|k| (place(cursors[*k]) - x).abs() <= GRAB)
    }

    fn draw_cursors(&self, canvas: &mut Screen, ui: &Ui, scale: &Scale) {
        let palette = theme::of(ui);
        for (share, name) in self.cursors.iter().flatten().zip(["A", "B"]) {
            let ends = scale.upright(scale.rect.min.x + *share as f32 * scale.rect.width());
            canvas.line(&ends, Stroke::new(1.25, palette.accent), false);
            let at = ends[0] + vec2(0.75 * GRID, 0.5 * GRID);
            canvas.text(at, Align2::LEFT_TOP, name, TEXT, palette.accent);
        }
    }

    /// Values at the cursors and their differences, in words.
    #[must_use]
    pub fn reading(&self, figure: &Figure, selection: Selection) -> Option<String> {
        let scale = &self.drawn.as_ref()?.scale;
        let [low, high] = scale.view[0];
        let [a, b] = self.cursors?.map(|share| low + share * (high - low));
        let number = |value: f64, axis: usize| readable(value, scale.view[axis]);
        let text = format!(
            "A {}, B {}, B \u{2212} A {} {}",
            number(a, 0),
            number(b, 0),
            number(b - a, 0),
            figure.x.unit
        );
        let mut text = text.trim_end().to_owned();
        // Of the selected cable, or of the first points there are.
        let chosen = figure
            .series
            .iter()
            .find(|s| s.cable.is_some() && s.cable == selection.cable);
        if let Some(series) = chosen.or(figure.series.first())
            && let (Some(at_a), Some(at_b)) = (closest(series, a), closest(series, b))
        {
            text += &format!(
                "; {}: {}, {}, B \u{2212} A {} {}",
                series.name,
                number(at_a, 1),
                number(at_b, 1),
                number(at_b - at_a, 1),
                figure.y.unit
            );
        }
        Some(text)
    }

    fn respond(
        &mut self,
        ui: &Ui,
        response: &Response,
        shown: &Shown<'_>,
        layout: &Layout,
        hit: Option<Hit>,
    ) -> Frame {
        let scale = &layout.scale;
        let mut frame = Frame::default();
        let under = response.hover_pos();
        let selected = hit.map(|hit| selects(shown.figure, hit));
        frame.hovered = under.map(|_| selected.unwrap_or_default());
        let entry = under.and_then(|at| layout.legend.iter().find(|entry| entry.rect.contains(at)));
        let cell = under.map(|at| scale.values(at));
        if let Some(hit) = hit {
            response
                .clone()
                .on_hover_text_at_pointer(words(shown.figure, hit, scale));
        } else if let Some(text) = cell.and_then(|at| cell_words(shown.figure, at)) {
            response.clone().on_hover_text_at_pointer(text);
        }
        if response.clicked() {
            let cable = entry.and_then(|entry| entry.cable).or_else(|| {
                let heat = shown.figure.heat.as_ref()?;
                let [x, y] = cell?;
                *heat.cables.get(heat.cell(x, y)?.1)?
            });
            let selection = selected.or(cable.map(Selection::cable));
            frame
                .done
                .push(Done::Selected(selection.unwrap_or_default()));
        }
        if response.secondary_clicked() {
            self.menu = selected.unwrap_or(shown.selection);
            if let Some(selected) = selected {
                frame.done.push(Done::Selected(selected));
            }
        }
        let menu = self.menu;
        Popup::context_menu(response).show(|ui| {
            let pose = menu.pose.filter(|pose| *pose != 0);
            let text = |pose: i64| format!("Exclude or include pose {pose}");
            if let Some(pose) = pose
                && ui.button(text(pose)).clicked()
            {
                frame.done.push(Done::Excluded(pose));
                ui.close();
            }
            if ui.button("Reset view").clicked() {
                self.reset();
                ui.close();
            }
        });
        if let Some(pose) = shown.selection.pose.filter(|_| response.hovered())
            && ui.input(|input| input.key_pressed(Key::Delete))
        {
            frame.done.push(Done::Excluded(pose));
        }
        frame
    }
}

/// Very many points as a texture.
fn dense(context: &Context, plot: &Plot<'_>) -> Option<PictureTexture> {
    let most = context.input(|input| input.max_texture_side);
    let picture = picture(plot, context.pixels_per_point(), most)?;
    Some(PictureTexture::new(context, picture))
}

/// A line at the selected pose, where poses or their times stand along x.
fn draw_pose(canvas: &mut Screen, shown: &Shown<'_>, scale: &Scale, palette: &theme::Palette) {
    let Some(pose) = shown.selection.pose else {
        return;
    };
    let points = shown.figure.series.iter().flat_map(|s| s.points());
    let mut of_pose = points.filter(|point| point.pose == Some(pose));
    let [low, high] = scale.view[0];
    let x = of_pose.next().map(|point| point.x);
    let is_along = [POSE, TIME].contains(&shown.figure.x.label.as_str());
    if let Some(x) = x.filter(|x| is_along && (low..=high).contains(x)) {
        canvas.line(
            &scale.upright(scale.x(x)),
            Stroke::new(1.0, palette.muted),
            false,
        );
    }
}

/// Height of the point nearest to a place along x.
fn closest(series: &Series, x: f64) -> Option<f64> {
    let points = series.points();
    let after = points.partition_point(|point| point.x < x);
    let around = points.get(after.saturating_sub(1)..(after + 1).min(points.len()))?;
    let away = |point: &&Point| (point.x - x).abs();
    around
        .iter()
        .min_by(|a, b| away(a).total_cmp(&away(b)))
        .map(|point| point.y)
}

#[cfg(test)]
mod tests {
    use egui::{Pos2, vec2};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;
    use tautline_workflow::plot::figure::Axis;

    fn figure() -> Figure {
        let point = |pose: i64| Point {
            pose: Some(pose),
            ..Point::new(pose as f64, (pose % 3) as f64)
        };
        Figure {
            x: Axis::new("Pose", ""),
            y: Axis::new("Residual", "mm"),
            series: vec![Series::of_cable(1, "cable-2", (1..=9).map(point).collect())],
            ..Figure::default()
        }
    }

    type Seen = (Panel, Vec<Done>);

    fn harness() -> Harness<'static, Seen> {
        let show = |ui: &mut Ui, (panel, done): &mut Seen| {
            if ui.ctx().cumulative_pass_nr() == 0 {
                // Fonts are there from the next frame on.
                theme::install(ui.ctx());
                return;
            }
            let shown = Shown {
                name: "Plot",
                figure: &figure(),
                generation: 1,
                selection: Selection::default(),
            };
            done.extend(panel.show(ui, &shown).done);
        };
        let mut harness = Harness::builder()
            .with_size(vec2(640.0, 240.0))
            .build_ui_state(show, Seen::default());
        harness.run();
        harness
    }

    fn scale(harness: &Harness<'_, Seen>) -> Scale {
        harness.state().0.drawn.as_ref().expect("drawn").scale
    }

    fn drag(harness: &mut Harness<'_, Seen>, from: Pos2, to: Pos2) {
        harness.hover_at(from);
        harness.drag_at(from);
        harness.run_ok();
        harness.hover_at(to);
        harness.run_ok();
        harness.drop_at(to);
        harness.run_ok();
    }

    #[test]
    fn a_click_selects_the_point_and_dragging_moves_the_view() {
        let mut harness = harness();
        assert!(harness.get_by_label("Plot").rect().is_positive());
        let before = scale(&harness);
        let at = before.place(4.0, 1.0);
        harness.hover_at(at);
        harness.drag_at(at);
        harness.drop_at(at);
        harness.run_ok();
        let expected = Selection {
            cable: Some(1),
            pose: Some(4),
        };
        assert_eq!(harness.state().1, [Done::Selected(expected)]);
        drag(&mut harness, at, at + vec2(60.0, 0.0));
        let after = scale(&harness);
        assert!(after.view[0][0] < before.view[0][0] - 0.5);
        assert!((after.view[1][0] - before.view[1][0]).abs() < 1e-9);
        harness.state_mut().0.reset();
        harness.run_ok();
        assert_eq!(scale(&harness).view, before.view);
    }

    #[test]
    fn a_cursor_is_dragged_instead_of_the_view() {
        let mut harness = harness();
        harness.state_mut().0.cursors = Some([0.25, 0.75]);
        harness.run_ok();
        let before = scale(&harness);
        let at = Pos2::new(
            before.rect.min.x + 0.25 * before.rect.width(),
            before.rect.center().y,
        );
        drag(&mut harness, at, at + vec2(0.25 * before.rect.width(), 0.0));
        let [a, b] = harness.state().0.cursors.expect("cursors");
        assert!((a - 0.5).abs() < 0.02 && b == 0.75, "{a} {b}");
        assert_eq!(scale(&harness).view, before.view);
        let text = harness.state().0.reading(&figure(), Selection::default());
        assert!(text.is_some_and(|text| text.contains("B \u{2212} A") && text.contains("mm")));
    }
}

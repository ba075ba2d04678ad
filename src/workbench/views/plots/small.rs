//! Small plots for panels: fixed height, no zoom; labels under the pointer, clicks select.

use egui::{Rect, Role, Sense, Ui, WidgetInfo, vec2};

use tautline_workflow::plot::{Figure, Layout, Plot, VisiblePoints};

use super::hit::{nearest, selects, words};
use super::screen::{Screen, colours, text_width};
use crate::model::Selection;
use crate::theme;

/// Draws a figure over the whole width of a panel, `height` points high; `name` is its accessible name. Gives what a
/// click on a point selects: its cable and pose, where it has them.
///
/// ```text
/// let figure = Figure {
///     x: Axis::new("Length", "m"),
///     y: Axis::new("Residual", "mm"),
///     series: vec![Series::of_cable(0, "cable-1", points)],
///     bands: vec![Band { name: "within 0.1 mm".into(), y: [-0.1, 0.1] }],
///     curves: vec![Curve { name: "fit".into(), ink: Ink::Text, dashed: false, points: line }],
///     has_zero_line: true,
///     ..Figure::default()
/// };
/// if let Some(selection) = small::show(ui, "Residuals of winch 1", &figure, 160.0, state.selection) {
///     state.outbox.send(ViewCommand::Select(selection));
/// }
/// ```
pub fn show(
    ui: &mut Ui,
    name: &str,
    figure: &Figure,
    height: f32,
    selection: Selection,
) -> Option<Selection> {
    let size = vec2(ui.available_width(), height);
    let (whole, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
    if !ui.is_rect_visible(whole) {
        return None;
    }
    let painter = ui.painter_at(whole);
    let layout = Layout::new(figure, figure.whole(), inside(whole), &text_width(&painter));
    let scale = &layout.scale;
    let plot = Plot {
        figure,
        layout: &layout,
        seen: &VisiblePoints::new(figure, scale, selection, ui.ctx().pixels_per_point()),
        selection,
        colours: &colours(theme::of(ui)),
    };
    plot.draw(&mut Screen::new(painter));
    let hit = nearest(figure, scale, response.hover_pos()?, selection)?;
    let clicked = response.clicked();
    response.on_hover_text_at_pointer(words(figure, hit, scale));
    clicked.then(|| selects(figure, hit))
}

fn inside(whole: Rect) -> Rect {
    whole.shrink2(vec2(1.0, 2.0))
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;
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
            bands: vec![Band {
                name: "within 0.1 mm".into(),
                y: [-0.1, 0.1],
            }],
            series: vec![Series::of_cable(2, "cable-3", (0..5).map(point).collect())],
            curves: vec![Curve {
                name: "fit".into(),
                ink: Ink::Text,
                dashed: false,
                points: vec![[0.0, -0.1], [4.0, 0.1]],
            }],
            has_zero_line: true,
            ..Figure::default()
        }
    }

    #[test]
    fn a_click_on_a_point_selects_its_cable_and_pose() {
        let mut harness = Harness::builder()
            .with_size(vec2(320.0, 180.0))
            .build_ui_state(
                |ui, clicked: &mut Option<Selection>| {
                    theme::install(ui.ctx());
                    let found = show(ui, "Winch 3", &figure(), 160.0, Selection::default());
                    *clicked = found.or(*clicked);
                },
                None,
            );
        harness.run();
        let rect = harness.get_by_label("Winch 3").rect();
        let width = |text: &str| 6.0 * text.len() as f32;
        let layout = Layout::new(&figure(), figure().whole(), inside(rect), &width);
        let scale = layout.scale;
        assert!(rect.contains_rect(scale.rect), "{layout:?} in {rect:?}");
        let place = scale.place(2.0, -0.05);
        harness.hover_at(place);
        harness.drag_at(place);
        harness.drop_at(place);
        harness.run();
        let expected = Selection {
            cable: Some(2),
            pose: Some(2),
        };
        assert_eq!(*harness.state(), Some(expected));
    }
}

//! Picture of a pulley to scale, seen perpendicular to its plane.

use std::f32::consts::PI;

use egui::{Pos2, Rect, Role, Sense, Shape, Stroke, TextStyle, Ui, Vec2, WidgetInfo};
use tautline_core::geometry::Vec3;
use tautline_core::kinematics::CableState;
use tautline_core::robot::Robot;

use crate::theme::{self, GRID};
use crate::widgets::UiExt;

/// Height of the picture (points).
const HEIGHT: f32 = 208.0;
/// Extent of the picture around the wheel, in radii to each side.
const REACH: f32 = 2.1;

/// Draws wheel, incoming cable, wrap and free cable. The swivel axis is vertical; it points down if the cable comes
/// from above.
pub fn show(ui: &mut Ui, robot: &Robot, index: usize, state: &CableState) {
    let Some(cable) = robot.cables.get(index) else {
        return;
    };
    let radius_mm = cable.pulley.radius_m * 1e3;
    if radius_mm <= 0.0 {
        ui.muted("This cable runs through an eyelet, without wrap.");
        return;
    }
    let size = Vec2::new(ui.available_width(), HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let wrap = state.wrap_rad as f32;
    let name = format!("Picture of the pulley of {}", cable.name);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    let palette = theme::of(ui);
    ui.painter().rect_filled(rect, 4.0, palette.ground);
    let axis = Vec3::from(cable.pulley.swivel_axis);
    let up = if axis.dot(&robot.gravity()) > 0.0 {
        1.0
    } else {
        -1.0
    };
    let view = View::of(rect, up);
    wheel(ui, &view, wrap);
    cables(ui, &view, rect, wrap, palette.cable(index));
    let font = TextStyle::Small.resolve(ui.style());
    let corner = rect.left_top() + Vec2::splat(2.0 * GRID);
    let wrapped_mm = radius_mm * state.wrap_rad;
    let wrap_deg = state.wrap_rad.to_degrees();
    let free_mm = state.free_length_m * 1e3;
    let painter = ui.painter();
    for (line, text) in [
        format!("radius {radius_mm:.2} mm"),
        format!("wrap {wrap_deg:.1}°, {wrapped_mm:.2} mm"),
        format!("then {free_mm:.1} mm to the platform"),
    ]
    .into_iter()
    .enumerate()
    {
        let galley = painter.layout_no_wrap(text, font.clone(), palette.muted);
        // Readable even if the cable runs behind it.
        let place = corner + Vec2::new(0.0, 4.0 * GRID * line as f32);
        let rect = Rect::from_min_size(place, galley.size());
        painter.rect_filled(rect, 0.0, palette.ground);
        painter.galley(rect.min, galley, palette.muted);
    }
    response.on_hover_text("The pulley in its plane, to scale. Dashed: the swivel axis, along which the cable comes from the drum. Arc: the wrapped cable.");
}

/// Transformation from radii about the centre of the wheel to the screen.
struct View {
    centre: Pos2,
    radius: f32,
    up: f32,
}

impl View {
    fn of(rect: Rect, up: f32) -> Self {
        Self {
            centre: rect.center() + Vec2::new(4.0 * GRID, 0.0),
            radius: rect.height() / (2.0 * REACH),
            up,
        }
    }

    /// Point at a distance `across` from the swivel axis and `along` it in the direction of travel, in radii.
    fn at(&self, across: f32, along: f32) -> Pos2 {
        self.centre + Vec2::new(across, self.up * along) * self.radius
    }

    /// Point of the rim at a wrap angle.
    fn rim(&self, wrap: f32) -> Pos2 {
        self.at(-wrap.cos(), wrap.sin())
    }
}

fn wheel(ui: &Ui, view: &View, wrap: f32) {
    let palette = theme::of(ui);
    let painter = ui.painter();
    let stroke = Stroke::new(1.5, palette.ghost);
    painter.circle(view.centre, view.radius - 1.5, palette.panel, stroke);
    painter.circle_filled(view.centre, 3.0, palette.muted);
    for angle in [0.0, wrap] {
        let spoke = [view.centre, view.rim(angle)];
        painter.line_segment(spoke, Stroke::new(1.0, palette.line));
    }
    let axis = [view.at(-1.0, -REACH), view.at(-1.0, REACH)];
    let dashes = Shape::dashed_line(&axis, Stroke::new(1.0, palette.muted), 4.0, 4.0);
    painter.extend(dashes);
}

fn cables(ui: &Ui, view: &View, rect: Rect, wrap: f32, colour: egui::Color32) {
    let painter = ui.painter().with_clip_rect(rect);
    let thin = Stroke::new(2.0, colour);
    painter.line_segment([view.at(-1.0, -REACH), view.at(-1.0, 0.0)], thin);
    let steps = (wrap / PI * 48.0).ceil().max(1.0);
    let arc = (0..=steps as usize).map(|k| view.rim(wrap * k as f32 / steps));
    painter.add(Shape::line(arc.collect(), Stroke::new(4.0, colour)));
    // The free cable leaves tangentially.
    let exit = view.rim(wrap);
    let (sin, cos) = wrap.sin_cos();
    let direction = Vec2::new(sin, view.up * cos);
    painter.arrow(exit, direction * 1.4 * view.radius, thin);
}

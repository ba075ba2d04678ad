//! Projection of a pulley along an axis, in millimetres: nominal and identified position, displacement and 95 % region.

use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, StrokeKind, Ui, Vec2,
    WidgetInfo, pos2, vec2,
};
use nalgebra::{Matrix2, Matrix3, Vector2};
use tautline_core::geometry::Vec3;

use super::region::{boundary, region};
use crate::theme::{self, Palette};
use crate::views::robot_3d::camera::{Directions, StandardView};
use tautline_workflow::identification::{IdentifiedPulley, PulleyInspection};
use tautline_workflow::plot::round::round_down;
use tautline_workflow::wording::units::significant;

/// Directions of view.
pub const SIDES: [StandardView; 3] = [StandardView::Front, StandardView::Side, StandardView::Top];
/// Free space around the content of an inset, as a factor.
const MARGIN: f64 = 1.3;
/// Approximate number of grid lines across an inset.
const LINES: f64 = 9.0;
/// Text size (points).
const SMALL: f32 = 11.0;

/// Content of an inset, in millimetres to the right and up from the nominal position.
#[derive(Debug, Clone, PartialEq)]
pub struct Inset {
    side: StandardView,
    /// Names of the axes to the right and up.
    axes: [String; 2],
    found: Vector2<f64>,
    /// Long and short semi-axis of the 95 % region of the identified position, if known.
    region: Option<[Vector2<f64>; 2]>,
    /// Semi-axes of the 95 % region of the drawing, about the nominal position.
    prior: Option<[Vector2<f64>; 2]>,
    /// Largest acceptable displacement from the drawing.
    tolerance: Option<f64>,
}

/// Axes to the right and up in a view (base frame).
fn axes(side: StandardView, directions: &Directions) -> [Vec3; 2] {
    let [right, away, up] = [0, 1, 2].map(|k| directions.column(k).into_owned());
    match side {
        StandardView::Side => [away, up],
        StandardView::Top => [right, away],
        StandardView::Front | StandardView::Isometric => [right, up],
    }
}

/// Name of a direction along an axis of the base frame.
fn name(direction: &Vec3) -> String {
    let axis = direction.iamax();
    let sign = if direction[axis] < 0.0 { "-" } else { "" };
    format!("{sign}{}", ["x", "y", "z"][axis])
}

impl Inset {
    /// Projection of a pulley for a direction of view.
    pub fn new(
        side: StandardView,
        directions: &Directions,
        inspection: &PulleyInspection,
        found: &IdentifiedPulley,
        tolerance_m: Option<f64>,
    ) -> Self {
        let axes = axes(side, directions);
        let flat = |v: &Vec3| Vector2::new(axes[0].dot(v), axes[1].dot(v)) * 1e3;
        let flattened =
            |whole: Matrix3<f64>| Matrix2::from_fn(|i, k| axes[i].dot(&(whole * axes[k])) * 1e6);
        let drawn = match inspection.prior_sd_m {
            [Some(x), Some(y), Some(z)] => Some([x, y, z].map(|sd| sd * sd)),
            // A coordinate without a tolerance in the drawing is unlimited.
            _ => None,
        };
        let drawn = drawn.map(|variances| Matrix3::from_diagonal(&Vec3::from(variances)));
        Self {
            side,
            axes: axes.each_ref().map(name),
            found: flat(&(found.entry_m - inspection.nominal_m)),
            region: found.covariance.and_then(|whole| region(&flattened(whole))),
            prior: drawn.and_then(|whole| region(&flattened(whole))),
            tolerance: tolerance_m.map(|metres| 1e3 * metres),
        }
    }

    /// Extent of both positions and the region from their middle, to the right or up (mm).
    fn reach(&self) -> f64 {
        let middle = self.found / 2.0;
        let [a, b] = self.region.unwrap_or_default();
        let half = |k: usize| a[k].hypot(b[k]);
        (0..2).fold(0.0, |reach: f64, k| reach.max(middle[k].abs() + half(k)))
    }
}

/// Common scale of all insets, in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Distance from the middle of an inset to its edges.
    half: f64,
    /// Spacing of the grid lines.
    grid: f64,
}

impl Scale {
    /// Scale at which the content of all insets fits.
    pub fn of(insets: &[Inset]) -> Self {
        let reach = insets.iter().map(Inset::reach).fold(0.0, f64::max);
        let half = (MARGIN * reach).max(0.02);
        Self {
            half,
            grid: round_down(2.0 * half / LINES * 2.0),
        }
    }

    /// Spacing of the grid lines, in words.
    pub fn grid_words(self) -> String {
        format!("{} mm", significant(self.grid, 2))
    }
}

/// Transformation from millimetres of an inset to the screen.
struct InsetTransform {
    rect: Rect,
    middle: Vector2<f64>,
    per_mm: f64,
}

impl InsetTransform {
    fn at(&self, point: Vector2<f64>) -> Pos2 {
        let d = (point - self.middle) * self.per_mm;
        self.rect.center() + vec2(d.x as f32, -d.y as f32)
    }
}

/// Draws an inset, with `colour` and `name` of the cable.
pub fn show(ui: &mut Ui, inset: &Inset, scale: Scale, size: f32, colour: Color32, name: &str) {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(size), Sense::hover());
    let title = inset.side.title();
    response.widget_info(|| {
        let label = format!(
            "{title} view of the pulley of {name}, grid {}",
            scale.grid_words()
        );
        WidgetInfo::labeled(Role::Image, true, label)
    });
    let palette = theme::of(ui);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, palette.ground);
    let place = InsetTransform {
        rect,
        middle: inset.found / 2.0,
        per_mm: f64::from(size) / (2.0 * scale.half),
    };
    bands(&painter, &place, inset, palette);
    grid(&painter, &place, scale, palette);
    if let Some(semi_axes) = inset.region {
        ellipse(&painter, &place, inset.found, semi_axes, colour);
    }
    places(&painter, &place, inset, colour, palette);
    words(&painter, rect, inset, palette);
    painter.rect_stroke(
        rect,
        4.0,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
}

fn grid(painter: &Painter, place: &InsetTransform, scale: Scale, palette: &Palette) {
    for axis in 0..2 {
        let (low, high) = (
            place.middle[axis] - scale.half,
            place.middle[axis] + scale.half,
        );
        let first = (low / scale.grid).ceil() as i64;
        let last = (high / scale.grid).floor() as i64;
        for k in first..=last {
            let mut ends = [Vector2::repeat(0.0); 2];
            for (end, across) in ends.iter_mut().zip([-scale.half, scale.half]) {
                end[axis] = k as f64 * scale.grid;
                end[1 - axis] = place.middle[1 - axis] + across;
            }
            // The lines through the nominal position are its axes.
            let colour = if k == 0 {
                palette.ghost
            } else {
                palette.line.gamma_multiply(0.7)
            };
            painter.line_segment(ends.map(|end| place.at(end)), Stroke::new(1.0, colour));
        }
    }
}

/// 95 % region of the drawing and tolerance, around the nominal position.
fn bands(painter: &Painter, place: &InsetTransform, inset: &Inset, palette: &Palette) {
    let nominal = Vector2::zeros();
    if let Some(semi_axes) = inset.prior {
        let points = boundary(nominal, semi_axes).into_iter();
        let points: Vec<Pos2> = points.map(|point| place.at(point)).collect();
        let edge = Stroke::new(1.0, palette.ghost.gamma_multiply(0.6));
        let fill = palette.ghost.gamma_multiply(0.18);
        painter.add(Shape::convex_polygon(points, fill, edge));
    }
    if let Some(tolerance) = inset.tolerance {
        let radius = (tolerance * place.per_mm) as f32;
        painter.circle_stroke(place.at(nominal), radius, Stroke::new(1.5, palette.good));
    }
}

fn ellipse(
    painter: &Painter,
    place: &InsetTransform,
    centre: Vector2<f64>,
    semi_axes: [Vector2<f64>; 2],
    colour: Color32,
) {
    let points: Vec<Pos2> = boundary(centre, semi_axes)
        .into_iter()
        .map(|point| place.at(point))
        .collect();
    let edge = Stroke::new(1.5, colour);
    painter.add(Shape::convex_polygon(
        points,
        colour.gamma_multiply(0.25),
        edge,
    ));
}

fn places(
    painter: &Painter,
    place: &InsetTransform,
    inset: &Inset,
    colour: Color32,
    palette: &Palette,
) {
    let [nominal, found] = [Vector2::zeros(), inset.found].map(|p| place.at(p));
    let way = found - nominal;
    if way.length() > 9.0 {
        let direction = way.normalized();
        let begin = nominal + direction * 5.0;
        let end = found - direction * 3.5;
        let stroke = Stroke::new(2.0, palette.text);
        painter.line_segment([begin, end], stroke);
        let head = direction * way.length().min(9.0) * 0.8;
        let across = vec2(-head.y, head.x) * 0.4;
        for side in [across, -across] {
            painter.line_segment([end, end - head + side], stroke);
        }
    }
    painter.circle_stroke(nominal, 5.0, Stroke::new(2.0, palette.muted));
    painter.circle_filled(found, 3.5, colour);
}

/// Name of the view and directions of its axes.
fn words(painter: &Painter, rect: Rect, inset: &Inset, palette: &Palette) {
    let font = FontId::proportional(SMALL);
    let write = |at: Pos2, anchor: Align2, text: &str, colour: Color32| {
        let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), colour);
        let place = anchor.anchor_size(at, galley.size());
        painter.rect_filled(
            place.expand2(vec2(2.0, 0.0)),
            2.0,
            palette.ground.gamma_multiply(0.8),
        );
        painter.galley(place.min, galley, colour);
    };
    write(
        rect.left_top() + vec2(6.0, 4.0),
        Align2::LEFT_TOP,
        inset.side.title(),
        palette.text,
    );
    let corner = pos2(rect.left() + 10.0, rect.bottom() - 10.0);
    for (name, direction) in inset.axes.iter().zip([Vec2::X, -Vec2::Y]) {
        let axis = name.trim_start_matches('-');
        let colour = palette.axes[["x", "y", "z"].iter().position(|a| *a == axis).unwrap_or(0)];
        painter.line_segment(
            [corner, corner + direction * 20.0],
            Stroke::new(2.0, colour),
        );
        let at = corner + direction * 27.0;
        write(at, Align2::CENTER_CENTER, name, palette.text);
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    use super::*;

    fn inset(side: StandardView, factor: &Matrix3<f64>, by: Vec3) -> Inset {
        let inspection = PulleyInspection {
            cable: 0,
            name: "cable-1".into(),
            radius_m: 0.018,
            nominal_m: Vec3::new(0.5, -0.2, 1.0),
            identified: None,
            prior_sd_m: [Some(1e-3), Some(1e-3), Some(2e-3)],
        };
        let found = IdentifiedPulley {
            entry_m: inspection.nominal_m + by,
            covariance: Some(factor * factor.transpose()),
            coordinates: [0, 1, 2].map(|k| tautline_workflow::identification::PulleyCoordinate {
                change_m: by[k],
                sd_m: Some(1e-4),
                prior_sd_m: None,
            }),
            correlations: Vec::new(),
        };
        Inset::new(
            side,
            &Directions::identity(),
            &inspection,
            &found,
            Some(2e-3),
        )
    }

    /// Whether a point is inside a polygon: an odd number of its sides cross the ray to the right.
    fn is_inside(polygon: &[Vector2<f64>], p: &Vector2<f64>) -> bool {
        let crossed = (0..polygon.len()).filter(|k| {
            let (a, b) = (polygon[*k], polygon[(k + 1) % polygon.len()]);
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        });
        crossed.count() % 2 == 1
    }

    /// Random positions from the covariance lie in the drawn region 95 times in 100.
    #[test]
    fn the_region_holds_95_of_100_drawn_places() {
        const DRAWN: usize = 20_000;
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let factor = Matrix3::new(4e-4, 0.0, 0.0, 3e-4, 1e-4, 0.0, -2e-4, 2e-4, 6e-4);
        let by = Vec3::new(1e-3, -2e-3, 5e-4);
        let drawn: Vec<Vec3> = (0..DRAWN)
            .map(|_| by + factor * Vec3::from_fn(|_, _| random.sample::<f64, _>(StandardNormal)))
            .collect();
        // Coordinates by view, written independently of the code under test.
        for (side, columns) in [
            (StandardView::Front, [0, 2]),
            (StandardView::Side, [1, 2]),
            (StandardView::Top, [0, 1]),
        ] {
            let inset = inset(side, &factor, by);
            let polygon = boundary(inset.found, inset.region.expect("a region"));
            let inside = drawn.iter().filter(|p| {
                is_inside(
                    &polygon,
                    &(Vector2::new(p[columns[0]], p[columns[1]]) * 1e3),
                )
            });
            let share = inside.count() as f64 / DRAWN as f64;
            // The polygon of 72 sides is smaller by 0.02 %; the limit is six standard deviations of the share (0.0015
            // each), exceeded less than once in a hundred million times.
            assert!((share - 0.95).abs() < 0.0095, "{side:?}: {share}");
        }
    }

    #[test]
    fn the_drawing_and_the_tolerance_lie_around_the_nominal_place() {
        let by = Vec3::new(5e-3, 0.0, -1e-3);
        for (side, sds) in [
            (StandardView::Front, [1.0, 2.0]),
            (StandardView::Side, [1.0, 2.0]),
            (StandardView::Top, [1.0, 1.0]),
        ] {
            let inset = inset(side, &(Matrix3::identity() * 1e-4), by);
            let axes = inset.prior.expect("the drawing says how sure it is");
            for (k, sd) in sds.into_iter().enumerate() {
                let reach = axes[0][k].hypot(axes[1][k]);
                assert!((reach - sd * 5.991_f64.sqrt()).abs() < 1e-9, "{side:?}");
            }
            assert_eq!(inset.tolerance, Some(2.0));
        }
    }

    #[test]
    fn one_scale_shows_everything_in_all_views() {
        let factor = Matrix3::from_diagonal(&Vec3::new(1e-4, 3e-4, 2e-3));
        let insets = SIDES.map(|side| inset(side, &factor, Vec3::new(5e-3, 0.0, -1e-3)));
        let scale = Scale::of(&insets);
        for inset in &insets {
            let middle = inset.found / 2.0;
            let region = boundary(inset.found, inset.region.expect("a region"));
            for point in region.iter().chain([&Vector2::zeros(), &inset.found]) {
                assert!((point - middle).amax() < scale.half, "{:?}", inset.side);
            }
        }
        let lines = 2.0 * scale.half / scale.grid;
        assert!((4.0..25.0).contains(&lines), "{lines}");
    }

    #[test]
    fn the_views_are_those_of_the_camera() {
        for gravity in [Vec3::new(0.0, 0.0, -9.8), Vec3::new(0.0, -9.8, 0.0)] {
            let directions = crate::views::robot_3d::camera::directions(gravity);
            for side in SIDES {
                let corners = [Vec3::zeros(), Vec3::repeat(1.0)];
                let camera =
                    crate::views::robot_3d::camera::Camera::new(directions, side, &corners, 1.0);
                let [right, up, _] = camera.axes();
                let [x, y] = axes(side, &directions);
                assert!(
                    (right - x).norm() < 1e-12 && (up - y).norm() < 1e-12,
                    "{side:?}"
                );
            }
        }
    }
}

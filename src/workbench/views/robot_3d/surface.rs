//! Nearest surface of a drawing along a line of sight.

use tautline_core::geometry::Vec3;

use super::camera::Ray;
use super::drawing::Drawing;
use super::parts::SolidPart;

/// First intersection of a line of sight with the drawing (m), including translucent parts.
#[must_use]
pub fn met(drawing: &Drawing, ray: &Ray) -> Option<Vec3> {
    let parts = drawing.solids.iter().chain(&drawing.glass);
    let nearest = parts.filter_map(|part| distance(part, ray));
    let nearest = nearest.min_by(f64::total_cmp)?;
    Some(ray.origin + ray.direction * nearest)
}

/// Distance along a line of sight to the first triangle of a part (m).
fn distance(part: &SolidPart, ray: &Ray) -> Option<f64> {
    let triangles = part.triangles().into_iter();
    let met = triangles.filter_map(|corners| triangle(ray, corners));
    met.min_by(f64::total_cmp)
}

/// Distance to a triangle, from either side (Moeller and Trumbore 1997).
fn triangle(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<f64> {
    let (along, across) = (b - a, c - a);
    let p = ray.direction.cross(&across);
    let determinant = along.dot(&p);
    let inverse = determinant.recip();
    let from = ray.origin - a;
    let u = from.dot(&p) * inverse;
    let q = from.cross(&along);
    let v = ray.direction.dot(&q) * inverse;
    let distance = across.dot(&q) * inverse;
    let is_met = determinant != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0;
    is_met.then_some(distance)
}

#[cfg(test)]
mod tests {
    use three_d::Srgba;

    use super::*;

    #[test]
    fn a_line_of_sight_meets_the_nearest_face_of_a_box() {
        let corner = |k: usize| {
            Vec3::from_fn(|axis, _| {
                if k >> axis & 1 == 0 {
                    -1.0
                } else {
                    1.0 + axis as f64
                }
            })
        };
        let part = SolidPart::cuboid(&std::array::from_fn(corner), Srgba::WHITE);
        for (origin, direction, expected) in [
            ([-5.0, 0.3, 0.2], [1.0, 0.0, 0.0], Some(4.0)),
            ([5.0, 0.3, 0.2], [-1.0, 0.0, 0.0], Some(4.0)),
            ([0.0, 0.5, 9.0], [0.0, 0.0, -1.0], Some(6.0)),
            ([0.1, 0.5, 0.2], [0.0, 1.0, 0.0], Some(1.5)),
            ([-5.0, 2.1, 0.2], [1.0, 0.0, 0.0], None),
            ([-5.0, 0.3, 0.2], [-1.0, 0.0, 0.0], None),
        ] {
            let ray = Ray {
                origin: origin.into(),
                direction: direction.into(),
            };
            let found = distance(&part, &ray);
            match (found, expected) {
                (Some(found), Some(expected)) => {
                    assert!((found - expected).abs() < 1e-6, "{origin:?}: {found}");
                }
                (found, expected) => assert_eq!(found, expected, "{origin:?}"),
            }
        }
    }
}

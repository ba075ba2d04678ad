//! Triangles of solid parts.

use std::f64::consts::TAU;

use egui::Color32;
use nalgebra::Matrix3;
use tautline_core::geometry::Vec3;

use super::scene::Wheel;

/// Segments of round parts.
const SEGMENTS: usize = 36;
/// Profile of a pulley: distance from the axis and along it, in radii. The rim ends just below the cable's centre
/// line, so that the cable is seen to lie on it.
const PROFILE: [[f64; 2]; 12] = [
    [0.96, -0.13],
    [0.96, 0.13],
    [0.80, 0.13],
    [0.74, 0.05],
    [0.30, 0.05],
    [0.25, 0.15],
    [0.12, 0.15],
    [0.12, -0.15],
    [0.25, -0.15],
    [0.30, -0.05],
    [0.74, -0.05],
    [0.80, -0.13],
];

/// Triangles with a normal and a colour at every corner.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Triangles {
    /// Corners, three per triangle (m).
    pub positions: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Red, green, blue, opacity.
    pub colours: Vec<[f32; 4]>,
}

/// A vector as the graphics card takes it.
#[must_use]
pub fn single(v: &Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// A colour as the graphics card takes it, without gamma.
#[must_use]
pub fn rgba(colour: Color32, opacity: f32) -> [f32; 4] {
    let [r, g, b, _] = colour.to_array().map(|c| f32::from(c) / 255.0);
    [r, g, b, opacity]
}

/// Two unit vectors that make a right-handed frame with `axis`.
fn across(axis: &Vec3) -> [Vec3; 2] {
    let first = axis.cross(&Vec3::ith(axis.iamin(), 1.0)).normalize();
    [first, axis.cross(&first)]
}

/// For each segment of a circle about `axis`, unit vectors from its centre to both ends.
fn spokes(axis: &Vec3) -> impl Iterator<Item = [Vec3; 2]> + use<> {
    let [x, y] = across(axis);
    let spoke = move |k: usize| {
        let (sin, cos) = (TAU * k as f64 / SEGMENTS as f64).sin_cos();
        x * cos + y * sin
    };
    (0..SEGMENTS).map(move |k| [spoke(k), spoke(k + 1)])
}

impl Triangles {
    fn corner(&mut self, position: &Vec3, normal: &Vec3, colour: [f32; 4]) {
        self.positions.push(single(position));
        self.normals.push(single(normal));
        self.colours.push(colour);
    }

    /// Four corners in order, with one normal each.
    fn patch(&mut self, corners: [Vec3; 4], normals: [Vec3; 4], colour: [f32; 4]) {
        for k in [0, 1, 2, 0, 2, 3] {
            self.corner(&corners[k], &normals[k], colour);
        }
    }

    /// A box; bit k of the index chooses the upper end along its axis k.
    pub fn cuboid(&mut self, corners: &[Vec3; 8], colour: [f32; 4]) {
        for face in [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ] {
            let corners = face.map(|k| corners[k]);
            let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            let normal = normal.try_normalize(0.0).unwrap_or_default();
            self.patch(corners, [normal; 4], colour);
        }
    }

    /// A member of square section between two points.
    pub fn beam(&mut self, [from, to]: [Vec3; 2], width_m: f64, colour: [f32; 4]) {
        let Some(axis) = (to - from).try_normalize(0.0) else {
            return;
        };
        let [x, y] = across(&axis).map(|v| v * (width_m / 2.0));
        // Half a width longer: corners of the frame are closed.
        let (from, to) = (from - axis * (width_m / 2.0), to + axis * (width_m / 2.0));
        let corners = std::array::from_fn(|k| {
            let sign = |bit: usize| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
            (if k >> 2 == 0 { from } else { to }) + x * sign(0) + y * sign(1)
        });
        self.cuboid(&corners, colour);
    }

    /// A pulley at its size.
    pub fn wheel(&mut self, wheel: &Wheel, colour: [f32; 4]) {
        for (k, [r0, h0]) in PROFILE.iter().enumerate() {
            let [r1, h1] = PROFILE[(k + 1) % PROFILE.len()];
            // Across the edge of the profile, outwards.
            let slope = Vec3::new(h1 - h0, r0 - r1, 0.0).normalize();
            for spokes in spokes(&wheel.normal) {
                let at = |spoke: &Vec3, r: f64, h: f64| {
                    wheel.centre + (spoke * r + wheel.normal * h) * wheel.radius_m
                };
                let normals = spokes.map(|spoke| spoke * slope.x + wheel.normal * slope.y);
                self.patch(
                    [
                        at(&spokes[0], *r0, *h0),
                        at(&spokes[1], *r0, *h0),
                        at(&spokes[1], r1, h1),
                        at(&spokes[0], r1, h1),
                    ],
                    [normals[0], normals[1], normals[1], normals[0]],
                    colour,
                );
            }
        }
    }

    /// The image of the unit sphere under `shape`, about `centre` (m).
    pub fn ellipsoid(&mut self, centre: &Vec3, shape: &Matrix3<f64>, colour: [f32; 4]) {
        let rings = SEGMENTS / 2;
        let on_sphere = |ring: usize, segment: usize| {
            let (sin_ring, cos_ring) = (TAU * ring as f64 / (2 * rings) as f64).sin_cos();
            let (sin, cos) = (TAU * segment as f64 / SEGMENTS as f64).sin_cos();
            Vec3::new(sin_ring * cos, sin_ring * sin, cos_ring)
        };
        // Normals of the image go with the inverse transpose: the cofactors.
        let turned = shape
            .transpose()
            .try_inverse()
            .unwrap_or_else(Matrix3::identity);
        for ring in 0..rings {
            for segment in 0..SEGMENTS {
                let points = [
                    on_sphere(ring, segment),
                    on_sphere(ring + 1, segment),
                    on_sphere(ring + 1, segment + 1),
                    on_sphere(ring, segment + 1),
                ];
                let normals = points.map(|p| (turned * p).try_normalize(0.0).unwrap_or_default());
                self.patch(points.map(|p| centre + shape * p), normals, colour);
            }
        }
    }

    /// A cone with its tip at `tip`, opening against `direction` (unit vector).
    pub fn cone(&mut self, tip: &Vec3, direction: &Vec3, length_m: f64, colour: [f32; 4]) {
        let base = tip - direction * length_m;
        let radius = 0.32 * length_m;
        for [a, b] in spokes(direction) {
            let normal = |spoke: &Vec3| (spoke + direction * 0.32).normalize();
            self.corner(tip, &normal(&(a + b)), colour);
            self.corner(&(base + a * radius), &normal(&a), colour);
            self.corner(&(base + b * radius), &normal(&b), colour);
            self.corner(&base, &-direction, colour);
            self.corner(&(base + b * radius), &-direction, colour);
            self.corner(&(base + a * radius), &-direction, colour);
        }
    }

    /// A disc.
    pub fn disc(&mut self, centre: &Vec3, normal: &Vec3, radius_m: f64, colour: [f32; 4]) {
        for [a, b] in circle(centre, normal, radius_m) {
            for corner in [centre, &a, &b] {
                self.corner(corner, normal, colour);
            }
        }
    }
}

/// Sides of a circle about `centre` (m).
#[must_use]
pub fn circle(centre: &Vec3, normal: &Vec3, radius_m: f64) -> Vec<[Vec3; 2]> {
    let sides = spokes(normal);
    sides
        .map(|ends| ends.map(|spoke| centre + spoke * radius_m))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(triangles: &Triangles, inside: &Vec3) {
        assert_eq!(triangles.positions.len() % 3, 0);
        for k in 0..triangles.positions.len() {
            let normal = Vec3::from(triangles.normals[k].map(f64::from));
            assert!((normal.norm() - 1.0).abs() < 1e-6);
            let outwards = Vec3::from(triangles.positions[k].map(f64::from)) - inside;
            assert!(outwards.dot(&normal) > 0.0, "{k}");
        }
    }

    #[test]
    fn normals_point_outwards() {
        let centre = Vec3::new(1.0, 2.0, 3.0);
        let mut triangles = Triangles::default();
        let shape = Matrix3::new(0.3, 0.0, 0.0, 0.1, 0.2, 0.0, 0.0, 0.0, 0.1);
        triangles.ellipsoid(&centre, &shape, [1.0; 4]);
        triangles.beam([centre - Vec3::x(), centre + Vec3::x()], 0.1, [1.0; 4]);
        check(&triangles, &centre);
    }

    #[test]
    fn a_wheel_ends_below_the_centre_line_of_the_cable() {
        let wheel = Wheel {
            entry: Vec3::zeros(),
            centre: Vec3::new(0.2, 0.0, 0.0),
            normal: Vec3::y(),
            radius_m: 0.2,
        };
        let mut triangles = Triangles::default();
        triangles.wheel(&wheel, [1.0; 4]);
        let farthest = triangles.positions.iter().map(|p| {
            let p = Vec3::from(p.map(f64::from)) - wheel.centre;
            p.x.hypot(p.z)
        });
        let rim = farthest.fold(0.0, f64::max);
        assert!((rim - 0.96 * 0.2).abs() < 1e-6, "{rim}");
    }
}

//! Triangles of solid parts.

use std::f64::consts::{PI, TAU};

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

/// Triangles between vertices with a normal and a colour each. Vertices are shared: where the processor draws, each of them
/// is a good part of what a triangle costs.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Triangles {
    /// Vertices (m).
    pub positions: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Red, green, blue, opacity.
    pub colours: Vec<[f32; 4]>,
    /// The vertices of each triangle.
    pub indices: Vec<[u32; 3]>,
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

/// Unit vectors from the centre of a circle about `axis` to the ends of its segments, the last of which is the first.
fn spokes(axis: &Vec3) -> [Vec3; SEGMENTS + 1] {
    let [x, y] = across(axis);
    std::array::from_fn(|k| {
        let (sin, cos) = (TAU * k as f64 / SEGMENTS as f64).sin_cos();
        x * cos + y * sin
    })
}

impl Triangles {
    /// Adds a vertex; gives its index.
    fn vertex(&mut self, position: &Vec3, normal: &Vec3, colour: [f32; 4]) -> u32 {
        self.positions.push(single(position));
        self.normals.push(single(normal));
        self.colours.push(colour);
        // Far fewer than four thousand million are drawn.
        (self.positions.len() - 1) as u32
    }

    /// The corners of all triangles (m).
    pub fn corners(&self) -> impl Iterator<Item = [[f32; 3]; 3]> {
        let position = |index: u32| self.positions[index as usize];
        self.indices.iter().map(move |three| three.map(position))
    }

    /// Two triangles between four vertices in order.
    fn patch(&mut self, [a, b, c, d]: [u32; 4]) {
        self.indices.extend([[a, b, c], [a, c, d]]);
    }

    /// A grid of vertices, with patches between those of neighbouring rows; a vertex is a position and a normal.
    fn grid<const N: usize>(
        &mut self,
        rows: impl IntoIterator<Item = [(Vec3, Vec3); N]>,
        colour: [f32; 4],
    ) {
        let mut before: Option<[u32; N]> = None;
        for row in rows {
            let row = row.map(|(position, normal)| self.vertex(&position, &normal, colour));
            if let Some(before) = before {
                for k in 1..N {
                    self.patch([before[k - 1], row[k - 1], row[k], before[k]]);
                }
            }
            before = Some(row);
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
            let corners = corners.map(|corner| self.vertex(&corner, &normal, colour));
            self.patch(corners);
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
        let spokes = spokes(&wheel.normal);
        for (k, [r0, h0]) in PROFILE.iter().enumerate() {
            let [r1, h1] = PROFILE[(k + 1) % PROFILE.len()];
            // Across the edge of the profile, outwards.
            let slope = Vec3::new(h1 - h0, r0 - r1, 0.0).normalize();
            let rows = spokes.iter().map(|spoke| {
                let normal = spoke * slope.x + wheel.normal * slope.y;
                let at =
                    |r: f64, h: f64| wheel.centre + (spoke * r + wheel.normal * h) * wheel.radius_m;
                [(at(*r0, *h0), normal), (at(r1, h1), normal)]
            });
            self.grid(rows, colour);
        }
    }

    /// The image of the unit sphere under `shape`, about `centre` (m).
    pub fn ellipsoid(&mut self, centre: &Vec3, shape: &Matrix3<f64>, colour: [f32; 4]) {
        const RINGS: usize = SEGMENTS / 2;
        // Normals of the image go with the inverse transpose: the cofactors.
        let turned = shape
            .transpose()
            .try_inverse()
            .unwrap_or_else(Matrix3::identity);
        let rows = spokes(&Vec3::z()).map(|spoke| {
            let on_sphere: [Vec3; RINGS + 1] = std::array::from_fn(|ring| {
                let (sin, cos) = (PI * ring as f64 / RINGS as f64).sin_cos();
                spoke * sin + Vec3::z() * cos
            });
            on_sphere.map(|p| {
                let normal = (turned * p).try_normalize(0.0).unwrap_or_default();
                (centre + shape * p, normal)
            })
        });
        self.grid(rows, colour);
    }

    /// A cone with its tip at `tip`, opening against `direction` (unit vector).
    pub fn cone(&mut self, tip: &Vec3, direction: &Vec3, length_m: f64, colour: [f32; 4]) {
        let base = tip - direction * length_m;
        let radius = 0.32 * length_m;
        let spokes = spokes(direction);
        let rows = spokes.iter().map(|spoke| {
            let normal = (spoke + direction * 0.32).normalize();
            [(*tip, normal), (base + spoke * radius, normal)]
        });
        self.grid(rows, colour);
        let rim = spokes.map(|spoke| base + spoke * radius);
        self.fan(&base, rim, &-direction, colour);
    }

    pub fn disc(&mut self, centre: &Vec3, normal: &Vec3, radius_m: f64, colour: [f32; 4]) {
        let rim = spokes(normal).map(|spoke| centre + spoke * radius_m);
        self.fan(centre, rim, normal, colour);
    }

    /// Triangles from a centre to a rim.
    fn fan<const N: usize>(
        &mut self,
        centre: &Vec3,
        rim: [Vec3; N],
        normal: &Vec3,
        colour: [f32; 4],
    ) {
        let centre = self.vertex(centre, normal, colour);
        let rim = rim.map(|place| self.vertex(&place, normal, colour));
        let sides = rim.windows(2).map(|side| [centre, side[0], side[1]]);
        self.indices.extend(sides);
    }
}

/// Sides of a circle about `centre` (m).
#[must_use]
pub fn circle(centre: &Vec3, normal: &Vec3, radius_m: f64) -> Vec<[Vec3; 2]> {
    let places = spokes(normal).map(|spoke| centre + spoke * radius_m);
    places.windows(2).map(|side| [side[0], side[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(triangles: &Triangles, inside: &Vec3) {
        let vertices = triangles.positions.len() as u32;
        assert!(
            triangles
                .indices
                .as_flattened()
                .iter()
                .all(|k| *k < vertices)
        );
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

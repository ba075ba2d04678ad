//! Solid parts: shapes of unit size with their transformations.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use egui::{Color32, Rgba};
use nalgebra::{Matrix3, Matrix4, Point3};
use tautline_core::geometry::Vec3;
use three_d::{CpuMesh, Indices, Positions, Srgba};

use super::scene::Wheel;

/// Number of segments of round parts.
const SEGMENTS: u32 = 36;
/// Profile of a pulley: distance from the axis and position along it, in radii. The rim ends just below the cable's
/// centre line, so that the cable is visible on it.
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

/// Shape of unit size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// From -1 to 1 along each axis.
    Cube,
    Sphere,
    /// From its base, a unit circle perpendicular to the first axis, to its tip at 1 along it.
    Cone,
    /// Perpendicular to the third axis.
    Disc,
    /// Pulley about the first axis.
    Wheel,
}

/// Triangles of all shapes.
static MESHES: LazyLock<[CpuMesh; Shape::ALL.len()]> = LazyLock::new(|| {
    [
        CpuMesh {
            uvs: None,
            tangents: None,
            ..CpuMesh::cube()
        },
        CpuMesh::sphere(SEGMENTS / 2),
        CpuMesh::cone(SEGMENTS),
        CpuMesh::circle(SEGMENTS),
        wheel(),
    ]
});

impl Shape {
    /// All shapes, in the order of their numbers.
    pub const ALL: [Self; 5] = [
        Self::Cube,
        Self::Sphere,
        Self::Cone,
        Self::Disc,
        Self::Wheel,
    ];

    /// Triangles of the shape.
    #[must_use]
    pub fn mesh(self) -> &'static CpuMesh {
        &MESHES[self as usize]
    }
}

/// Profile rotated about the first axis.
fn wheel() -> CpuMesh {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for (k, from) in PROFILE.iter().enumerate() {
        let first = positions.len() as u32;
        for segment in 0..SEGMENTS {
            let (sin, cos) = (TAU * f64::from(segment) / f64::from(SEGMENTS)).sin_cos();
            let ends = [*from, PROFILE[(k + 1) % PROFILE.len()]];
            positions.extend(ends.map(|[r, h]| three_d::vec3(h, r * cos, r * sin)));
            let [here, next] = [segment, (segment + 1) % SEGMENTS].map(|k| first + 2 * k);
            indices.extend([here, next, next + 1, here, next + 1, here + 1]);
        }
    }
    let mut mesh = CpuMesh {
        positions: Positions::F64(positions),
        indices: Indices::U32(indices),
        ..CpuMesh::default()
    };
    mesh.compute_normals();
    mesh
}

/// Solid part: a shape with its transformation and colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidPart {
    pub shape: Shape,
    /// Transformation of the unit shape to the base frame (m).
    pub base_from_shape: Matrix4<f64>,
    pub colour: Srgba,
}

/// Colour of a part for three-d, which converts sRGB to linear for the shaders: the inverse conversion makes it equal
/// to the colours of lines and points.
#[must_use]
pub fn paint(colour: Color32, opacity: f32) -> Srgba {
    let coded = |c: u8| Rgba::from_rgb(f32::from(c) / 255.0, 0.0, 0.0).to_srgba_unmultiplied()[0];
    let [r, g, b, _] = colour.to_array();
    let opacity = (255.0 * opacity).round() as u8;
    Srgba::new(coded(r), coded(g), coded(b), opacity)
}

/// Two unit vectors that form a right-handed frame with `axis`.
fn across(axis: &Vec3) -> [Vec3; 2] {
    let first = axis.cross(&Vec3::ith(axis.iamin(), 1.0)).normalize();
    [first, axis.cross(&first)]
}

impl SolidPart {
    /// Part whose shape has the axes `axes` (m) about `centre` (m).
    fn new(shape: Shape, axes: [Vec3; 3], centre: &Vec3, colour: Srgba) -> Self {
        let [x, y, z] = axes.map(|axis| axis.push(0.0));
        let base_from_shape = Matrix4::from_columns(&[x, y, z, centre.push(1.0)]);
        Self {
            shape,
            base_from_shape,
            colour,
        }
    }

    /// Corners of its triangles (m).
    #[must_use]
    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        let mesh = self.shape.mesh();
        let to_base = |p: &three_d::Vector3<f64>| {
            let [x, y, z] = (*p).into();
            self.base_from_shape
                .transform_point(&Point3::new(x, y, z))
                .coords
        };
        let places: Vec<Vec3> = mesh.positions.to_f64().iter().map(to_base).collect();
        let mut triangles = Vec::new();
        mesh.for_each_triangle(|a, b, c| triangles.push([a, b, c].map(|k| places[k])));
        triangles
    }

    /// Box; bit k of the index selects the upper end along its axis k.
    #[must_use]
    pub fn cuboid(corners: &[Vec3; 8], colour: Srgba) -> Self {
        let axes = [1, 2, 4].map(|k| (corners[k] - corners[0]) / 2.0);
        let centre = (corners[0] + corners[7]) / 2.0;
        Self::new(Shape::Cube, axes, &centre, colour)
    }

    /// Beam of square section between two points; `None` if they coincide.
    #[must_use]
    pub fn beam([from, to]: [Vec3; 2], width_m: f64, colour: Srgba) -> Option<Self> {
        let axis = (to - from).try_normalize(0.0)?;
        let [x, y] = across(&axis).map(|v| v * (width_m / 2.0));
        // Longer by half a width, to close the corners of the frame.
        let half = (to - from + axis * width_m) / 2.0;
        let centre = (from + to) / 2.0;
        Some(Self::new(Shape::Cube, [x, y, half], &centre, colour))
    }

    /// Pulley to scale.
    #[must_use]
    pub fn wheel(wheel: &Wheel, colour: Srgba) -> Self {
        let [x, y] = across(&wheel.normal);
        let axes = [wheel.normal, x, y].map(|v| v * wheel.radius_m);
        Self::new(Shape::Wheel, axes, &wheel.centre, colour)
    }

    /// Image of the unit sphere under `shape`, about `centre` (m).
    #[must_use]
    pub fn ellipsoid(centre: &Vec3, shape: &Matrix3<f64>, colour: Srgba) -> Self {
        let axes = std::array::from_fn(|k| shape.column(k).into_owned());
        Self::new(Shape::Sphere, axes, centre, colour)
    }

    /// Cone with its tip at `tip`, opening against `direction` (unit vector), and its base.
    #[must_use]
    pub fn cone(tip: &Vec3, direction: &Vec3, length_m: f64, colour: Srgba) -> [Self; 2] {
        let base = tip - direction * length_m;
        let radius_m = 0.32 * length_m;
        let [x, y] = across(direction).map(|v| v * radius_m);
        let axes = [direction * length_m, x, y];
        [
            Self::new(Shape::Cone, axes, &base, colour),
            Self::disc(&base, &-direction, radius_m, colour),
        ]
    }

    /// Edges of a disc.
    pub fn rim(&self) -> impl Iterator<Item = [Vec3; 2]> + use<> {
        let triangles = self.triangles().into_iter();
        triangles.map(|[_, from, to]| [from, to])
    }

    #[must_use]
    pub fn disc(centre: &Vec3, normal: &Vec3, radius_m: f64, colour: Srgba) -> Self {
        let [x, y] = across(normal).map(|v| v * radius_m);
        Self::new(Shape::Disc, [x, y, *normal], centre, colour)
    }
}

#[cfg(test)]
mod tests {
    use three_d::InnerSpace;

    use super::*;

    #[test]
    fn triangles_turn_about_their_normals() {
        for shape in Shape::ALL {
            let mesh = shape.mesh();
            let normals = mesh.normals.as_ref().expect("normals");
            let places = mesh.positions.to_f32();
            mesh.for_each_triangle(|a, b, c| {
                let turned = (places[b] - places[a]).cross(places[c] - places[a]);
                for normal in [a, b, c].map(|k| normals[k]) {
                    assert!((normal.magnitude() - 1.0).abs() < 1e-6, "{shape:?}");
                    let is_flat = turned.magnitude() < 1e-6;
                    assert!(is_flat || turned.dot(normal) > 0.0, "{shape:?}");
                }
            });
        }
    }

    #[test]
    fn shaders_get_the_colour_itself() {
        for c in 0..=255 {
            let coded = paint(Color32::from_rgb(c, c, c), 0.5).to_linear_srgb();
            assert!((coded.x - f32::from(c) / 255.0).abs() < 1.2 / 255.0, "{c}");
            assert!((coded.w - 0.5).abs() < 1.0 / 255.0);
        }
    }

    #[test]
    fn a_wheel_ends_below_the_centre_line_of_the_cable() {
        let wheel = Wheel {
            entry: Vec3::zeros(),
            centre: Vec3::new(0.2, 0.0, 0.0),
            normal: Vec3::y(),
            radius_m: 0.2,
        };
        let triangles = SolidPart::wheel(&wheel, Srgba::WHITE).triangles();
        let away = triangles.as_flattened().iter().map(|p| p - wheel.centre);
        let rim = away.map(|p| p.x.hypot(p.z)).fold(0.0, f64::max);
        assert!((rim - 0.96 * 0.2).abs() < 1e-6, "{rim}");
    }
}

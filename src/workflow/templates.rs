//! Template robots: common machines of any size, whose numbers are then corrected individually.

use tautline_core::geometry::Coordinate;
use tautline_core::robot::{
    Cable, CableMaterial, ForceSensor, FrameTransform, Home, Laser, Limits, PartTolerances,
    PerAxis, Platform, Pulley, Robot, TargetPlane, TensionLimits, Tracker, Winch, WorkspaceLimits,
};

/// Standard gravity (m/s^2).
const GRAVITY: f64 = 9.80665;

/// A common machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Template {
    /// Eight cables, four from above and four from below: fully constrained.
    Spatial,
    /// Eight cables from above, two at each corner; gravity keeps them taut.
    Suspended,
    /// Four cables in a vertical plane.
    Planar,
    /// Four lines to a point: three from the floor, one from above.
    Hangprinter,
    /// Eight cables in two layers in front of a wall.
    Facade,
}

/// Entry point, swivel axis and platform anchor of a cable.
type Placed = ([f64; 3], [f64; 3], [f64; 3]);

/// Parts of a template at a given size.
struct Parts {
    /// Entry points, swivel axes and platform anchors (m), cable by cable.
    cables: Vec<Placed>,
    free: Vec<Coordinate>,
    home_m: [f64; 3],
    /// Half the extent of the workspace (m).
    half_extent_m: [f64; 3],
    half_rotation_rad: f64,
    /// Smallest, reference and largest tension, relative to the weight of the platform.
    tension: [f64; 3],
    /// Distance from the platform's origin to its lower side (m).
    bottom_m: f64,
}

impl Template {
    /// All templates.
    pub const ALL: [Self; 5] = [
        Self::Spatial,
        Self::Suspended,
        Self::Planar,
        Self::Hangprinter,
        Self::Facade,
    ];

    /// The template with this name in commands.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|template| template.name() == name)
    }

    /// Name in commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Spatial => "spatial",
            Self::Suspended => "suspended",
            Self::Planar => "planar",
            Self::Hangprinter => "hangprinter",
            Self::Facade => "facade",
        }
    }

    /// Title to display.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Spatial => "Eight cables, spatial",
            Self::Suspended => "Eight cables, suspended",
            Self::Planar => "Four cables, planar",
            Self::Hangprinter => "Hangprinter",
            Self::Facade => "Facade",
        }
    }

    /// Summary in one line.
    #[must_use]
    pub fn summary(self) -> &'static str {
        match self {
            Self::Spatial => "four cables from above and four from below, fully constrained",
            Self::Suspended => "two cables at each upper corner, gravity keeps them taut",
            Self::Planar => "four cables in a vertical plane, x and y lie in it",
            Self::Hangprinter => {
                "three lines from the floor, one from above, a point without rotation"
            }
            Self::Facade => "eight cables in two layers in front of a wall",
        }
    }

    /// Usual width, depth and height (m).
    #[must_use]
    pub fn usual_size_m(self) -> [f64; 3] {
        match self {
            Self::Spatial => [2.0, 1.6, 1.6],
            Self::Suspended => [10.0, 8.0, 6.0],
            Self::Planar => [3.0, 0.2, 2.0],
            Self::Hangprinter => [3.0, 3.0, 2.5],
            Self::Facade => [12.0, 1.6, 10.0],
        }
    }

    /// A machine with the given width, depth and height between its pulleys (m); everything else is typical of its size.
    #[must_use]
    pub fn robot(self, size_m: [f64; 3]) -> Robot {
        let parts = match self {
            Self::Spatial => spatial(size_m),
            Self::Suspended => suspended(size_m),
            Self::Planar => planar(size_m),
            Self::Hangprinter => hangprinter(size_m),
            Self::Facade => facade(size_m),
        };
        let size = size_m.into_iter().fold(0.0, f64::max);
        let mass_kg = tidy(4.0 * size);
        let mut robot = Robot {
            name: self.title().to_owned(),
            home: Some(Home {
                position_m: millimetres(parts.home_m),
                orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
                position_sd_m: tidy(1e-4 * size),
                orientation_sd_rad: 1e-3,
                covariance: None,
            }),
            gravity_m_s2: [0.0, 0.0, -GRAVITY],
            platform: Platform {
                free: parts.free.clone(),
                ..Platform::spatial(Some(mass_kg))
            },
            limits: Some(limits(&parts, mass_kg * GRAVITY)),
            laser: Some(downward(parts.bottom_m, size)),
            inclinometer: None,
            tracker: None,
            cables: cables(&parts, size, mass_kg * GRAVITY),
            home_platform: None,
            tolerances: Some(PartTolerances::typical()),
            hypotheses: Vec::new(),
            deviations: Vec::new(),
            effects: Vec::new(),
        };
        match self {
            Self::Planar => lay_in_plane(&mut robot, size_m),
            Self::Hangprinter => measured_by_camera(&mut robot),
            _ => {}
        }
        robot
    }
}

/// A number with two significant digits, as is usual for assumptions.
fn tidy(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// Whole millimetres.
fn millimetres(point: [f64; 3]) -> [f64; 3] {
    point.map(|value| (1e3 * value).round() / 1e3)
}

/// Corners of a rectangle in order.
const CORNERS: [[f64; 2]; 4] = [[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];

fn spatial([width, depth, height]: [f64; 3]) -> Parts {
    let mut cables = Vec::new();
    for (level, vertical) in [(0.0, -1.0), (height, 1.0)] {
        for [x, y] in CORNERS {
            // The upper cables cross: with all anchors on the lines to their pulleys, nothing would constrain the rotation
            // about z.
            cables.push((
                [0.5 * width * x, 0.5 * depth * y, level],
                [0.0, 0.0, vertical],
                [
                    -0.06 * width * x * vertical,
                    0.06 * depth * y,
                    -0.06 * height * vertical,
                ],
            ));
        }
    }
    Parts {
        cables,
        free: Coordinate::ALL.to_vec(),
        home_m: [0.0, 0.0, 0.5 * height],
        half_extent_m: [0.2 * width, 0.2 * depth, 0.2 * height],
        half_rotation_rad: 0.15,
        tension: [0.4, 1.6, 8.0],
        bottom_m: 0.07 * height,
    }
}

fn suspended([width, depth, height]: [f64; 3]) -> Parts {
    let mut cables = Vec::new();
    for [x, y] in CORNERS {
        // Two cables per corner, crossed so that they also constrain the orientation.
        cables.push((
            [0.5 * width * x, 0.47 * depth * y, height],
            [0.0, 0.0, 1.0],
            [0.03 * width * x, -0.03 * depth * y, 0.05 * height],
        ));
        cables.push((
            [0.48 * width * x, 0.5 * depth * y, height],
            [0.0, 0.0, 1.0],
            [-0.03 * width * x, 0.03 * depth * y, -0.05 * height],
        ));
    }
    Parts {
        cables,
        free: Coordinate::ALL.to_vec(),
        home_m: [0.0, 0.0, 0.3 * height],
        half_extent_m: [0.2 * width, 0.2 * depth, 0.15 * height],
        half_rotation_rad: 0.05,
        tension: [0.05, 0.3, 2.5],
        bottom_m: 0.06 * height,
    }
}

fn planar([width, _, height]: [f64; 3]) -> Parts {
    let corner = |[x, y]: [f64; 2]| {
        (
            [0.5 * width * x, 0.5 * height * y, 0.0],
            [0.0, y, 0.0],
            [0.04 * width * x, -0.04 * height * y, 0.0],
        )
    };
    Parts {
        cables: CORNERS.map(corner).to_vec(),
        free: vec![Coordinate::X, Coordinate::Y, Coordinate::Rz],
        home_m: [0.0; 3],
        half_extent_m: [0.23 * width, 0.22 * height, 0.0],
        half_rotation_rad: 0.1,
        tension: [0.4, 1.6, 8.0],
        bottom_m: 0.05 * height,
    }
}

fn hangprinter([width, depth, height]: [f64; 3]) -> Parts {
    let radius = [0.5 * width, 0.5 * depth];
    let low = [-90.0_f64, 30.0, 150.0].map(|degrees| {
        let angle = degrees.to_radians();
        (
            [radius[0] * angle.cos(), radius[1] * angle.sin(), 0.0],
            [0.0, 0.0, 1.0],
            [0.0; 3],
        )
    });
    let above = ([0.0, 0.0, height], [0.0, 0.0, -1.0], [0.0; 3]);
    Parts {
        cables: low.into_iter().chain([above]).collect(),
        free: vec![Coordinate::X, Coordinate::Y, Coordinate::Z],
        home_m: [0.0, 0.0, 0.3 * height],
        half_extent_m: [0.12 * width, 0.12 * depth, 0.12 * height],
        half_rotation_rad: 0.0,
        tension: [0.2, 0.8, 8.0],
        bottom_m: 0.0,
    }
}

fn facade([width, depth, height]: [f64; 3]) -> Parts {
    let mut cables = Vec::new();
    for layer in [-1.0, 1.0] {
        for [x, z] in CORNERS {
            // Each layer crosses from top to bottom, which constrains the rotation in the plane of the wall.
            cables.push((
                [
                    0.5 * width * x,
                    0.5 * depth * layer,
                    0.5 * height * (1.0 + z),
                ],
                [0.0, 0.0, z],
                [0.06 * width * x, 0.25 * depth * layer, -0.05 * height * z],
            ));
        }
    }
    Parts {
        cables,
        free: Coordinate::ALL.to_vec(),
        home_m: [0.0, 0.0, 0.5 * height],
        half_extent_m: [0.2 * width, 0.05 * depth, 0.2 * height],
        half_rotation_rad: 0.02,
        tension: [0.3, 1.2, 8.0],
        bottom_m: 0.06 * height,
    }
}

fn limits(parts: &Parts, weight_n: f64) -> Limits {
    let [lower_n, reference_n, upper_n] = parts.tension.map(|times| tidy(times * weight_n));
    Limits {
        workspace: Some(WorkspaceLimits {
            center: FrameTransform {
                position_m: millimetres(parts.home_m),
                orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
            },
            half_extent_m: millimetres(parts.half_extent_m),
            half_rotation_rad: parts.half_rotation_rad,
        }),
        tension: Some(TensionLimits {
            lower_n,
            reference_n,
            upper_n,
        }),
    }
}

/// Cables, pulleys and winches typical of the size (m) and weight.
fn cables(parts: &Parts, size: f64, weight_n: f64) -> Vec<Cable> {
    let winch = Winch {
        drum_diameter_m: tidy(0.03 + 0.012 * size),
        drum_pitch_m: tidy(0.002 + 2e-4 * size),
        gear_ratio: 1.0,
        length_to_pulley_m: tidy(0.5 * size),
        length_sd_m: tidy(3e-5 + 2e-5 * size),
    };
    let material = CableMaterial {
        axial_stiffness_n: Some(tidy(4e4 * size)),
        weight_n_per_m: if size > 5.0 { tidy(0.02 * size) } else { 0.0 },
        elongation_surface: None,
    };
    let sensor = ForceSensor {
        tension_gain: 1.0,
        bias_n: 0.0,
        tension_sd_n: tidy((0.01 * weight_n).max(0.5)),
    };
    let cable = |(k, (entry, axis, anchor)): (usize, &Placed)| Cable {
        name: format!("cable-{}", k + 1),
        pulley: Pulley {
            entry_point_m: millimetres(*entry),
            entry_point_sd_m: PerAxis::known(tidy(Pulley::typical_sd_m(size))),
            swivel_axis: *axis,
            swivel_zero: None,
            swivel_sd_rad: None,
            radius_m: tidy(0.012 + 0.003 * size),
        },
        platform_anchor_m: millimetres(*anchor),
        winch,
        cable: material.clone(),
        force_sensor: Some(sensor),
    };
    parts.cables.iter().enumerate().map(cable).collect()
}

/// A laser below the platform that points to the floor.
fn downward(bottom_m: f64, size: f64) -> Laser {
    Laser {
        origin_m: millimetres([0.0, 0.0, -bottom_m]),
        direction: [0.0, 0.0, -1.0],
        sd_m: tidy(2e-4 + 5e-5 * size),
        target_plane: TargetPlane {
            normal: [0.0, 0.0, 1.0],
            offset_m: 0.0,
            offset_sd_m: Some(tidy(3e-3 + 5e-4 * size)),
        },
    }
}

/// In a vertical plane y points up, and coordinates normal to the plane are known.
fn lay_in_plane(robot: &mut Robot, [_, _, height]: [f64; 3]) {
    robot.gravity_m_s2 = [0.0, -GRAVITY, 0.0];
    if let Some(laser) = &mut robot.laser {
        laser.origin_m = [0.0, laser.origin_m[2], 0.0];
        laser.direction = [0.0, -1.0, 0.0];
        laser.target_plane.normal = [0.0, 1.0, 0.0];
        laser.target_plane.offset_m = millimetres([-0.55 * height, 0.0, 0.0])[0];
    }
    for cable in &mut robot.cables {
        let [sd, ..] = cable.pulley.entry_point_sd_m.each();
        cable.pulley.entry_point_sd_m = PerAxis::Each([sd, sd, Some(0.0)]);
    }
}

/// A Hangprinter has eyelets, no force sensors and no laser; a camera measures its position.
fn measured_by_camera(robot: &mut Robot) {
    robot.laser = None;
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(1e-3),
        orientation_sd_rad: None,
    });
    if let Some(home) = &mut robot.home {
        home.orientation_sd_rad = 0.0;
    }
    for cable in &mut robot.cables {
        cable.pulley.radius_m = 0.0;
        cable.force_sensor = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::simulation::{SimulationOptions, TensionRange, simulate};

    #[test]
    fn every_template_is_a_possible_robot_that_can_be_held_and_measured_at_any_size() {
        for template in Template::ALL {
            for scale in [0.5, 1.0, 3.0] {
                let size = template.usual_size_m().map(|side| scale * side);
                let robot = template.robot(size);
                let name = template.name();
                robot
                    .check()
                    .unwrap_or_else(|error| panic!("{name}: {error}"));
                let home = robot.home.expect("a home pose").pose();
                let tensions = TensionRange::of(&robot).tensions(&robot, &home);
                assert!(
                    tensions.expect("tensions").is_some(),
                    "{name} times {scale}"
                );
                let simulated = simulate(&robot, &SimulationOptions::new(8, 1));
                let simulated = simulated.unwrap_or_else(|error| panic!("{name}: {error}"));
                assert_eq!(simulated.dataset.measurements.len(), 9, "{name}");
            }
        }
    }

    #[test]
    fn pulleys_are_as_far_apart_as_was_said() {
        for template in Template::ALL {
            let robot = template.robot([4.0, 2.0, 3.0]);
            let range = |axis: usize| {
                let values = robot.cables.iter().map(|c| c.pulley.entry_point_m[axis]);
                let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
                    (l.min(v), h.max(v))
                });
                high - low
            };
            // Three anchors of a Hangprinter lie on an ellipse, 120 degrees apart.
            let expected = match template {
                Template::Planar => [4.0, 3.0, 0.0],
                Template::Hangprinter => [2.0 * 3.0_f64.sqrt(), 1.5, 3.0],
                Template::Suspended => [4.0, 2.0, 0.0],
                _ => [4.0, 2.0, 3.0],
            };
            for axis in 0..3 {
                let found = range(axis);
                assert!(
                    (found - expected[axis]).abs() < 2e-3,
                    "{template:?}: {found}"
                );
            }
        }
    }
}

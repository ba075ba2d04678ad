//! Random robots: 2 to 12 cables, planar, point or spatial platforms, 0.5 to 100 m, any sensors.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use tautline_core::geometry::{Coordinate, Pose, Vec3};
use tautline_core::robot::{
    Cable, CableMaterial, ForceSensor, Home, Inclinometer, Laser, PerAxis, Platform, Pulley, Robot,
    TargetPlane, Tracker, Winch,
};
use tautline_core::simulation::{TensionRange, Workspace};

use crate::tables::simulated::log_uniform;

/// How a platform moves and how many cables hold it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// A point in a vertical plane that hangs on two cables, as the pen of a plotter.
    Plotter,
    /// A point in a vertical plane.
    PointInPlane,
    /// A body in a vertical plane.
    Planar,
    /// A point in space.
    Point,
    /// A body in space.
    Spatial,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Plotter,
        Self::PointInPlane,
        Self::Planar,
        Self::Point,
        Self::Spatial,
    ];

    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Plotter => "plotter",
            Self::PointInPlane => "point in a plane",
            Self::Planar => "planar",
            Self::Point => "point",
            Self::Spatial => "spatial",
        }
    }

    fn free(self) -> Vec<Coordinate> {
        let [x, y, z, _, pitch, _] = Coordinate::ALL;
        match self {
            Self::Plotter | Self::PointInPlane => vec![x, z],
            Self::Planar => vec![x, z, pitch],
            Self::Point => vec![x, y, z],
            Self::Spatial => Coordinate::ALL.to_vec(),
        }
    }

    /// Fewest and most cables.
    fn cables(self) -> [usize; 2] {
        match self {
            Self::Plotter => [2, 2],
            Self::PointInPlane => [3, 6],
            Self::Planar => [4, 8],
            Self::Point => [4, 12],
            Self::Spatial => [7, 12],
        }
    }

    fn is_in_plane(self) -> bool {
        !matches!(self, Self::Point | Self::Spatial)
    }
}

/// A robot with what its simulation needs.
#[derive(Debug, Clone)]
pub struct RandomRobot {
    /// How it moves.
    pub kind: Kind,
    /// Whether the strain at the mean tension exceeds 0.03 %.
    pub is_soft: bool,
    /// The description.
    pub robot: Robot,
    /// Poses that it is measured at.
    pub workspace: Workspace,
    /// Tensions of its cables.
    pub tension: TensionRange,
}

/// Strain at the mean tension from which cables are soft.
const SOFT: f64 = 3e-4;

/// The robot of a seed.
#[must_use]
pub fn random_robot(seed: u64) -> RandomRobot {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let rng = &mut rng;
    let kind = Kind::ALL[rng.random_range(0..Kind::ALL.len())];
    let [fewest, most] = kind.cables();
    let count = rng.random_range(fewest..=most);
    let size_m = log_uniform([0.5, 100.0], rng);
    let mass_kg = log_uniform([0.3, 3.0], rng) * (1.0 + size_m);
    let weight_n = mass_kg * 9.80665;
    let pretension = if kind == Kind::Plotter {
        0.7
    } else {
        log_uniform([0.5, 3.0], rng)
    };
    let reference_n = pretension * weight_n;
    let strain = log_uniform([2e-5, 2e-3], rng);
    let length_sd_m = log_uniform([3e-5, 3e-4], rng) * size_m;
    let has_forces = rng.random_bool(0.6);
    let sags = has_forces && rng.random_bool(0.3);
    let radius_m = if rng.random_bool(0.3) {
        0.0
    } else {
        0.015 * size_m.powf(0.7)
    };
    let anchors_m = if matches!(kind, Kind::Planar | Kind::Spatial) {
        0.08 * size_m
    } else {
        0.0
    };
    let entry_sd = Pulley::typical_sd_m(size_m);
    let force_sensor = has_forces.then_some(ForceSensor {
        tension_gain: if rng.random_bool(0.5) { 1.0 } else { 2.0 },
        bias_n: 0.0,
        tension_sd_n: log_uniform([2e-3, 4e-2], rng) * reference_n,
    });
    let has_swivels = radius_m > 0.0 && !kind.is_in_plane() && rng.random_bool(0.2);
    let cable = |(index, (entry, anchor)): (usize, ([f64; 3], [f64; 3]))| Cable {
        name: format!("cable-{}", index + 1),
        pulley: Pulley {
            entry_point_sd_m: if kind.is_in_plane() {
                PerAxis::Each([Some(entry_sd), Some(0.0), Some(entry_sd)])
            } else {
                PerAxis::known(entry_sd)
            },
            swivel_zero: has_swivels.then_some([1.0, 0.0, 0.0]),
            swivel_sd_rad: has_swivels.then_some(2e-3),
            ..Pulley::new(entry, axis_at(kind, entry), radius_m)
        },
        platform_anchor_m: anchor,
        winch: Winch {
            drum_diameter_m: 0.04 * size_m.powf(0.5),
            drum_pitch_m: 0.002 * size_m.powf(0.5),
            gear_ratio: size_m.powf(0.5),
            length_to_pulley_m: 0.4 * size_m,
            length_sd_m,
        },
        cable: CableMaterial {
            axial_stiffness_n: Some(reference_n / strain),
            weight_n_per_m: if sags { 0.005 * weight_n / size_m } else { 0.0 },
            elongation_surface: None,
        },
        force_sensor,
    };
    let geometry = geometry(rng, kind, (count, size_m), anchors_m);
    let cables = geometry.into_iter().enumerate().map(cable).collect();
    let platform = Platform {
        free: kind.free(),
        ..Platform::spatial(Some(mass_kg))
    };
    let mut robot = Robot::new(format!("random-{seed}"), platform, cables);
    let home_sd_m = 2e-4 * size_m;
    robot.home = rng.random_bool(0.75).then_some(Home {
        position_m: [0.0; 3],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        position_sd_m: home_sd_m,
        orientation_sd_rad: 1e-3,
        covariance: None,
    });
    let instrument = rng.random_range(0..4);
    robot.laser = (instrument & 1 > 0).then_some(Laser {
        origin_m: [0.0, 0.0, -0.5 * anchors_m],
        direction: [0.0, 0.0, -1.0],
        sd_m: 2e-4 * size_m.powf(0.5),
        target_plane: TargetPlane {
            normal: [0.0, 0.0, 1.0],
            offset_m: -0.6 * size_m,
            offset_sd_m: Some(2e-3 * size_m.powf(0.5)),
        },
    });
    let turns = matches!(kind, Kind::Planar | Kind::Spatial);
    robot.tracker = (instrument & 2 > 0).then_some(Tracker {
        position_sd_m: PerAxis::Same(1e-4 * size_m.powf(0.5)),
        orientation_sd_rad: (turns && rng.random_bool(0.5)).then_some(1e-3),
    });
    let inclined = kind == Kind::Spatial && rng.random_bool(0.3);
    robot.inclinometer = inclined.then_some(Inclinometer { sd_rad: 5e-4 });
    let half = if kind == Kind::Plotter { 0.25 } else { 0.2 } * size_m;
    RandomRobot {
        kind,
        is_soft: strain > SOFT,
        workspace: Workspace {
            centre: Pose::identity(),
            half_extent_m: [half, if kind.is_in_plane() { 0.0 } else { half }, half],
            half_rotation_rad: if turns { 0.12 } else { 0.0 },
        },
        tension: TensionRange {
            lower_n: 0.05 * reference_n,
            reference_n,
            upper_n: 12.0 * reference_n.max(weight_n),
        },
        robot,
    }
}

/// The swivel axis of a pulley: across the plane, else vertical.
fn axis_at(kind: Kind, entry: [f64; 3]) -> [f64; 3] {
    if kind.is_in_plane() {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, entry[2].signum()]
    }
}

/// Entry points and anchors (m) of `count` cables in a frame of a size (m).
fn geometry(
    rng: &mut impl Rng,
    kind: Kind,
    (count, size_m): (usize, f64),
    anchors_m: f64,
) -> Vec<([f64; 3], [f64; 3])> {
    let jitter = |rng: &mut dyn Rng, by: f64| by * (2.0 * rng.random::<f64>() - 1.0);
    let turn = if kind == Kind::Plotter {
        0.0
    } else {
        rng.random::<f64>()
    };
    (0..count)
        .map(|index| {
            let share = (index as f64 + turn + jitter(rng, 0.15)) / count as f64;
            let angle = std::f64::consts::TAU * share;
            let (sine, cosine) = angle.sin_cos();
            let half = 0.5 * size_m * (1.0 + jitter(rng, 0.1));
            if kind == Kind::Plotter {
                let side = if index == 0 { -1.0 } else { 1.0 };
                return ([side * half, 0.0, 0.5 * size_m], [0.0; 3]);
            }
            if kind.is_in_plane() {
                // Crossed anchors hold the rotation.
                let across = if index % 2 == 0 { 1.0 } else { -1.0 };
                let along = Vec3::new(cosine, 0.0, sine) * 0.6;
                let side = Vec3::new(-sine, 0.0, cosine) * across;
                let anchor = (along + side) * anchors_m;
                return ([half * cosine, 0.0, half * sine], anchor.into());
            }
            let level = if index % 2 == 0 { 1.0 } else { -1.0 };
            let entry = [half * cosine, half * sine, 0.45 * size_m * level];
            let twist = 0.8 * if index % 4 < 2 { 1.0 } else { -1.0 };
            let (s, c) = (angle + twist).sin_cos();
            let anchor = [anchors_m * c, anchors_m * s, -0.6 * anchors_m * level];
            (entry, anchor)
        })
        .collect()
}

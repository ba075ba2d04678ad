//! Random robots and poses for the tests of this folder.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::geometry::{Coordinate, Pose, Twist, Vec3};
use crate::robot::{Cable, CableMaterial, Platform, Pulley, Robot, Winch};

/// Kind of platform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PlatformKind {
    Spatial,
    Planar,
    PointMass,
}

pub(crate) fn generator(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

pub(crate) fn uniform(rng: &mut ChaCha8Rng, scale: f64) -> Vec3 {
    Vec3::from_fn(|_, _| rng.random_range(-scale..scale))
}

pub(crate) fn direction(rng: &mut ChaCha8Rng) -> Vec3 {
    loop {
        let v = uniform(rng, 1.0);
        if v.norm() > 0.1 && v.norm() < 1.0 {
            return v.normalize();
        }
    }
}

pub(crate) fn cable(name: &str, entry: Vec3, axis: Vec3, radius_m: f64, anchor: Vec3) -> Cable {
    Cable {
        name: name.into(),
        pulley: Pulley::new(entry.into(), axis.into(), radius_m),
        platform_anchor_m: anchor.into(),
        winch: Winch {
            drum_diameter_m: 0.04,
            drum_pitch_m: 0.002,
            gear_ratio: 1.0,
            length_to_pulley_m: 0.6,
            length_sd_m: 5e-5,
        },
        cable: CableMaterial::default(),
        force_sensor: None,
    }
}

pub(crate) fn robot(free: &[Coordinate], cables: Vec<Cable>) -> Robot {
    let platform = Platform {
        free: free.to_vec(),
        center_of_mass_m: [0.005, -0.003, 0.01],
        ..Platform::spatial(Some(2.5))
    };
    Robot::new("sample", platform, cables)
}

const CORNERS: [[f64; 3]; 8] = [
    [1.0, -1.0, -1.0],
    [-1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [-1.0, -1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];

/// Eight cables on a box like MINI's (Table 1 of Jin et al. 2018), platform anchors crossed.
pub(crate) fn spatial(radius_m: f64) -> Robot {
    let cables = CORNERS.iter().enumerate().map(|(i, corner)| {
        let c = Vec3::from(*corner);
        let entry = if c.z < 0.0 {
            c.component_mul(&Vec3::new(0.5, 0.378, 0.4415))
        } else {
            c.component_mul(&Vec3::new(0.5315, 0.345, 0.4415))
        };
        let anchor = c.component_mul(&Vec3::new(0.06, 0.045, -0.05));
        cable(
            &format!("cable-{}", i + 1),
            entry,
            Vec3::new(0.0, 0.0, -c.z.signum()),
            radius_m,
            anchor,
        )
    });
    robot(&Coordinate::ALL, cables.collect())
}

/// Four cables in the plane z = 0 with freedom x, y, rz; swivel axes normal to the frame's sides.
pub(crate) fn planar(radius_m: f64) -> Robot {
    let cables = CORNERS[..4].iter().enumerate().map(|(i, corner)| {
        let c = Vec3::new(corner[0], corner[1], 0.0);
        let entry = c.component_mul(&Vec3::new(0.8, 0.6, 0.0));
        let anchor = c.component_mul(&Vec3::new(0.1, -0.05, 0.0));
        let axis = Vec3::new(0.0, -corner[1], 0.0);
        cable(&format!("cable-{}", i + 1), entry, axis, radius_m, anchor)
    });
    let free = [Coordinate::X, Coordinate::Y, Coordinate::Rz];
    robot(&free, cables.collect())
}

/// A point mass under four pulleys at one height.
pub(crate) fn point_mass(radius_m: f64) -> Robot {
    let cables = CORNERS[4..].iter().enumerate().map(|(i, corner)| {
        let entry = Vec3::new(corner[0] * 1.5, corner[1], 2.0);
        let axis = -Vec3::z();
        let name = format!("cable-{}", i + 1);
        cable(&name, entry, axis, radius_m, Vec3::zeros())
    });
    let free = [Coordinate::X, Coordinate::Y, Coordinate::Z];
    robot(&free, cables.collect())
}

pub(crate) fn of_kind(kind: PlatformKind, radius_m: f64) -> Robot {
    match kind {
        PlatformKind::Spatial => spatial(radius_m),
        PlatformKind::Planar => planar(radius_m),
        PlatformKind::PointMass => point_mass(radius_m),
    }
}

/// A robot with `count` cables anywhere, eyelets and pulleys mixed, whose cables all have a path at
/// the pose that comes with it.
pub(crate) fn anywhere(rng: &mut ChaCha8Rng, free: &[Coordinate], count: usize) -> (Robot, Pose) {
    let twist = Twist::from_fn(|_, _| rng.random_range(-0.4..0.4));
    let pose = Pose::identity().perturbed(&twist);
    let mut cables = Vec::new();
    while cables.len() < count {
        let radius_m = if rng.random_range(0.0..1.0) < 0.3 {
            0.0
        } else {
            rng.random_range(0.01..0.1)
        };
        let entry = direction(rng) * rng.random_range(1.0..3.0);
        let name = format!("cable-{}", cables.len() + 1);
        let anchor = uniform(rng, 0.3);
        let mut one = cable(&name, entry, direction(rng), radius_m, anchor);
        one.pulley.swivel_zero = Some(direction(rng).into());
        let sound = super::inverse_kinematics(&robot(free, vec![one.clone()]), &pose);
        // Away from the swivel axis, where the curvature makes finite differences useless.
        let offset = pose.transform(&anchor) - entry;
        let across = offset.cross(&Vec3::from(one.pulley.swivel_axis)).norm();
        if sound.is_ok() && across > 0.2 {
            cables.push(one);
        }
    }
    (robot(free, cables), pose)
}

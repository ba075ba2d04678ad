//! Effects that reach every port, and robots with every instrument, for the derivative tests.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::cable::ElongationSurface;
use crate::effect::{
    BoundEffect, CableContext, CablePorts, Dual, Effect, EffectParameter, EffectRequest,
    PlatformContext, PlatformPorts, Scope, Search, every_effect as catalogue,
};
use crate::estimation::{Globals, Method, Problem, residuals_at};
use crate::geometry::{Coordinate, Pose, Twist};
use crate::kinematics::samples::{anywhere, generator};
use crate::measurement::{Dataset, Grid, Measurements, Rates};
use crate::robot::{
    ForceSensor, Home, Inclinometer, Laser, PerAxis, Robot, TargetPlane, Tracker, WrenchSd,
};

const ANY: EffectParameter = EffectParameter::new("any", "1", 1.0, [0.0, 1.0]);

/// Moves every port of a cable, each by one parameter of about unit size.
static EVERY_CABLE_PORT: Effect = Effect {
    id: "every_cable_port",
    scope: Scope::Cable,
    parameters: &[ANY; 16],
    change_cable: change_every_cable_port,
    ..Effect::NEUTRAL
};

fn change_every_cable_port(p: &[Dual], _: &CableContext, ports: &mut CablePorts) {
    ports.paid += p[0] * 0.1;
    ports.tension += p[1] * 10.0;
    ports.strain += p[2] * 1e-3;
    ports.compliance += p[3] * 1e-5;
    ports.weight += p[4] * 0.3;
    ports.radius += p[5] * 0.01;
    let [x, y, z] = ports.axis;
    // The axis turns by the rotation vector 0.3 p: to first order it stays a unit vector.
    let turned = [
        p[7] * z - p[8] * y,
        p[8] * x - p[6] * z,
        p[6] * y - p[7] * x,
    ];
    for k in 0..3 {
        ports.axis[k] += turned[k] * 0.3;
        ports.entry_shift[k] += p[9 + k] * 0.1;
        ports.anchor[k] += p[12 + k] * 0.1;
    }
    ports.swivel_offset += p[15];
}

/// Moves every port of the platform.
static EVERY_PLATFORM_PORT: Effect = Effect {
    id: "every_platform_port",
    scope: Scope::Robot,
    parameters: &[ANY; 25],
    change_platform: change_every_platform_port,
    ..Effect::NEUTRAL
};

fn change_every_platform_port(p: &[Dual], _: &PlatformContext, ports: &mut PlatformPorts) {
    ports.mass += p[0];
    ports.laser_gain += p[1];
    ports.laser_bias += p[2];
    for k in 0..3 {
        ports.center_of_mass[k] += p[3 + k] * 0.1;
        ports.laser_direction[k] += p[6 + k] * 0.3;
        ports.target_normal[k] += p[9 + k] * 0.3;
        ports.inclination_offset[k] += p[12 + k];
        ports.tracker_point[k] += p[16 + k] * 0.1;
        ports.tracker_shift[k] += p[19 + k] * 0.1;
        ports.tracker_turn[k] += p[22 + k] * 0.3;
    }
    ports.tracker_delay += p[15] * 0.1;
}

/// The port effects on the first and last cable, and the whole catalogue on the first.
pub fn every_effect(robot: &Robot) -> Vec<BoundEffect> {
    let on = |cable: usize| BoundEffect {
        effect: &EVERY_CABLE_PORT,
        cables: vec![cable],
        targeted: true,
        values: vec![0.0; 16],
    };
    let mut effects = vec![on(0)];
    effects.extend((robot.cable_count() > 1).then(|| on(robot.cable_count() - 1)));
    effects.push(BoundEffect {
        effect: &EVERY_PLATFORM_PORT,
        cables: Vec::new(),
        targeted: false,
        values: vec![0.0; 25],
    });
    for effect in catalogue().filter(|e| e.is_estimable()) {
        // The label of a pose is given: the last one, or one before it, from which only the last is.
        let label = match effect.search() {
            Search::AtPose(_) => 2.0,
            _ => 1.5,
        };
        let discrete = effect.parameters().iter().filter(|p| p.discrete);
        let request = EffectRequest {
            effect: effect.id().to_owned(),
            cables: (effect.scope() == Scope::Cable)
                .then(|| "cable-1".to_owned())
                .into_iter()
                .collect(),
            values: discrete.map(|p| (p.name.to_owned(), label)).collect(),
        };
        for mut bound in request.bind(robot).unwrap() {
            let parameters = effect.parameters().iter();
            let values = bound.values.iter_mut().zip(parameters);
            for (value, parameter) in values.filter(|(_, p)| !p.discrete) {
                let [low, high] = parameter.typical;
                *value = 0.7 * low + 0.3 * high;
            }
            effects.push(bound);
        }
    }
    effects
}

/// Traits of a random robot.
#[derive(Debug, Clone, Copy)]
pub struct Traits {
    pub free: &'static [Coordinate],
    pub cables: usize,
    /// Readings count from a home pose.
    pub home: bool,
    pub sags: bool,
    pub surface: bool,
    pub seed: u64,
}

const SURFACE_DEGREE: usize = 3;

fn surface(rng: &mut ChaCha8Rng) -> ElongationSurface {
    ElongationSurface {
        degree: SURFACE_DEGREE,
        length_center_m: 2.5,
        length_scale_m: 2.5,
        tension_center_n: 50.0,
        tension_scale_n: 50.0,
        coefficients: (0..10).map(|_| rng.random_range(-2e-3..2e-3)).collect(),
        residual_sd_m: 1e-5,
    }
}

/// A random robot with every instrument, and poses with readings that its model predicts: the lengths
/// exactly, so that weights that change with the pose do not show in the derivatives.
pub fn sample(traits: Traits) -> (Dataset, Vec<Pose>) {
    let mut rng = generator(traits.seed);
    let (mut robot, pose) = anywhere(&mut rng, traits.free, traits.cables);
    let mut poses = Vec::new();
    for _ in 0..3 {
        let mut twist = Twist::zeros();
        for coordinate in traits.free {
            twist[coordinate.index()] = rng.random_range(-0.03..0.03);
        }
        poses.push(pose.perturbed(&twist));
    }
    robot.home = traits.home.then(|| Home {
        position_m: poses[0].position.into(),
        orientation_wxyz: poses[0].orientation_wxyz(),
        position_sd_m: 1e-3,
        orientation_sd_rad: 1e-3,
        covariance: None,
    });
    // So uncertain an equilibrium that its whitening does not depend on the pose: the tensions' part
    // of its variance is below 1e-8.
    robot.platform.wrench_sd = Some(WrenchSd {
        force_n: 1e5,
        torque_nm: 1e5,
    });
    robot.laser = Some(Laser {
        origin_m: [0.02, -0.03, -0.05],
        direction: [0.0, 0.6, -0.8],
        sd_m: 3e-4,
        target_plane: TargetPlane {
            normal: [0.0, 0.0, 1.0],
            offset_m: -1.0,
            offset_sd_m: None,
        },
    });
    robot.inclinometer = Some(Inclinometer { sd_rad: 2e-3 });
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Each([1e-3, 2e-3, 3e-3]),
        orientation_sd_rad: Some(1e-3),
    });
    for cable in &mut robot.cables {
        cable.pulley.swivel_sd_rad = Some(5e-3);
        cable.cable.axial_stiffness_n = Some(rng.random_range(1e4..1e5));
        cable.cable.weight_n_per_m = if traits.sags { 0.5 } else { 0.0 };
        cable.cable.elongation_surface = traits.surface.then(|| surface(&mut rng));
        cable.force_sensor = Some(ForceSensor {
            tension_gain: 2.0,
            bias_n: 0.5,
            tension_sd_n: 1.0,
        });
    }
    let measurements = readings(&mut rng, traits, &poses);
    (
        Dataset {
            robot,
            measurements,
        },
        poses,
    )
}

fn readings(rng: &mut ChaCha8Rng, traits: Traits, poses: &[Pose]) -> Measurements {
    let rows = poses.len();
    let mut grid = |low: f64, high: f64| {
        let mut grid = Grid::missing(rows, traits.cables);
        for row in 0..rows {
            for cable in 0..traits.cables {
                grid.set(row, cable, rng.random_range(low..high));
            }
        }
        grid
    };
    let (revolutions, length_m) = if traits.home {
        (grid(0.0, 0.1), Grid::default())
    } else {
        (Grid::default(), grid(1.0, 2.0))
    };
    let force_n = grid(60.0, 120.0);
    let swivel_rad = grid(-0.3, 0.3);
    let turned = |pose: &Pose| pose.perturbed(&Twist::new(0.1, 0.2, -0.1, 0.2, -0.3, 0.1));
    Measurements {
        labels: (0..).take(rows).collect(),
        revolutions,
        length_m,
        force_n,
        swivel_rad,
        time_s: (0..rows).map(|k| 500.0 * k as f64).collect(),
        temperature_c: (0..rows).map(|k| 20.0 + 2.0 * k as f64).collect(),
        laser_m: vec![0.4; rows],
        inclination_rad: vec![[0.1, -0.2, 0.3]; rows],
        tracked_position_m: poses.iter().map(|p| turned(p).position.into()).collect(),
        tracked_orientation_wxyz: poses.iter().map(|p| turned(p).orientation_wxyz()).collect(),
        ..Measurements::default()
    }
}

/// Lets the samples be of a recording in motion.
pub fn set_in_motion(dataset: &mut Dataset, seed: u64) {
    let mut rng = generator(seed);
    let (rows, cables) = (dataset.measurements.len(), dataset.robot.cable_count());
    let mut grid = |size: f64| {
        let mut grid = Grid::missing(rows, cables);
        for (row, cable) in (0..rows).flat_map(|row| (0..cables).map(move |cable| (row, cable))) {
            grid.set(row, cable, rng.random_range(-size..size));
        }
        grid
    };
    dataset.robot.platform.inertia_kg_m2 = Some([0.1, 0.2, 0.15, 0.02, -0.01, 0.03]);
    dataset.measurements.rates = Some(Rates {
        length: [grid(0.1), grid(0.2)],
        force: [grid(10.0), grid(50.0)],
        laser: vec![[0.2, -0.3]; rows],
        tracked: vec![
            [
                Twist::new(0.2, -0.1, 0.3, 0.4, -0.2, 0.5),
                Twist::new(-0.4, 0.3, 0.5, -0.6, 0.2, 0.7),
            ];
            rows
        ],
        ..Rates::default()
    });
}

/// Sets the length readings to what the problem with `effects` predicts at `poses`.
pub fn set_lengths(dataset: &mut Dataset, poses: &[Pose], effects: &[BoundEffect]) {
    let rows: Vec<usize> = (0..poses.len()).collect();
    // Newton steps on a nearly linear relation: each gains two digits at least.
    for _ in 0..12 {
        let residuals = {
            let mut problem = Problem::new(dataset).unwrap().with_method(Method::Joint);
            problem.free_effects = effects.to_vec();
            residuals_at(&problem, &Globals::nominal(&problem), &rows, poses)
        };
        let data = &mut dataset.measurements;
        for (row, residual) in residuals.iter().enumerate() {
            for (index, cable) in dataset.robot.cables.iter().enumerate() {
                let step = residual.length_m[index];
                if data.revolutions.is_empty() {
                    let length = data.length_m.get(row, index);
                    data.length_m.set(row, index, length + step);
                } else {
                    let revolutions = data.revolutions.get(row, index);
                    let step = step / cable.winch.cable_per_revolution_m();
                    data.revolutions.set(row, index, revolutions + step);
                }
            }
        }
    }
}

//! The parameters common to all poses: identity, unit and prior.

use super::problem::{Geometry, Globals, Problem};
use crate::geometry::{Coordinate, Twist};

/// Which quantity a parameter is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ParameterId {
    /// Component of a cable's entry point (m).
    EntryPoint {
        /// Index of the cable.
        cable: usize,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// Offset of the laser's target plane (m).
    PlaneOffset,
    /// Coordinate of the home pose (m or rad).
    Home(Coordinate),
    /// Error of a cable's tension reading at home (N).
    HomeTension {
        /// Index of the cable.
        cable: usize,
    },
    /// Parameter of a free effect.
    Effect {
        /// Index among the free effects.
        effect: usize,
        /// Index among its parameters.
        parameter: usize,
    },
}

/// One estimated parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Which quantity it is.
    pub id: ParameterId,
    /// Name for a reader: `cable-3 entry point x`.
    pub name: String,
    /// SI unit.
    pub unit: &'static str,
    /// Standard deviation of the prior; `None` if nothing is known.
    pub prior_sd: Option<f64>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// The parameters of a problem; those with a prior standard deviation of 0 are not among them.
pub(super) fn parameters_of(problem: &Problem<'_>) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    if problem.geometry == Geometry::Estimated {
        push_entry_points(problem, &mut parameters);
        push_plane(problem, &mut parameters);
        push_home(problem, &mut parameters);
    }
    // The noise of these data, whatever the geometry: the home row enters every row of a cable.
    push_home_tensions(problem, &mut parameters);
    if problem.geometry == Geometry::Estimated {
        push_effects(problem, &mut parameters);
    }
    parameters.retain(|parameter| parameter.prior_sd != Some(0.0));
    parameters
}

fn push_entry_points(problem: &Problem<'_>, parameters: &mut Vec<Parameter>) {
    for (cable, description) in problem.dataset.robot.cables.iter().enumerate() {
        let sd = description.pulley.entry_point_sd_m.each();
        for (axis, label) in AXES.iter().enumerate() {
            parameters.push(Parameter {
                id: ParameterId::EntryPoint { cable, axis },
                name: format!("{} entry point {label}", description.name),
                unit: "m",
                prior_sd: sd[axis],
            });
        }
    }
}

fn push_plane(problem: &Problem<'_>, parameters: &mut Vec<Parameter>) {
    let measured = problem
        .dataset
        .measurements
        .laser_m
        .iter()
        .any(|d| d.is_finite());
    if let (Some(laser), true) = (&problem.dataset.robot.laser, measured) {
        parameters.push(Parameter {
            id: ParameterId::PlaneOffset,
            name: "target plane offset".to_owned(),
            unit: "m",
            prior_sd: laser.target_plane.offset_sd_m,
        });
    }
}

fn push_home(problem: &Problem<'_>, parameters: &mut Vec<Parameter>) {
    let robot = &problem.dataset.robot;
    let (Some(home), false) = (
        &robot.home,
        problem.dataset.measurements.revolutions.is_empty(),
    ) else {
        return;
    };
    for coordinate in robot.platform.freedom().coordinates() {
        let translation = coordinate.index() < 3;
        parameters.push(Parameter {
            id: ParameterId::Home(*coordinate),
            name: format!("home pose, {}", coordinate.describe()),
            unit: if translation { "m" } else { "rad" },
            prior_sd: Some(if translation {
                home.position_sd_m
            } else {
                home.orientation_sd_rad
            }),
        });
    }
}

fn push_home_tensions(problem: &Problem<'_>, parameters: &mut Vec<Parameter>) {
    let robot = &problem.dataset.robot;
    if robot.home.is_none() || problem.dataset.measurements.revolutions.is_empty() {
        return;
    }
    let has_home_force = problem.home_row().is_some_and(|row| {
        problem
            .dataset
            .measurements
            .force_n
            .row(row)
            .iter()
            .any(|f| f.is_finite())
    });
    if !(problem.has_latent_tension() && has_home_force) {
        return;
    }
    for (cable, description) in problem.dataset.robot.cables.iter().enumerate() {
        if let Some(sensor) = description.force_sensor {
            parameters.push(Parameter {
                id: ParameterId::HomeTension { cable },
                name: format!("{} tension reading error at home", description.name),
                unit: "N",
                prior_sd: Some(sensor.tension_sd_n),
            });
        }
    }
}

fn push_effects(problem: &Problem<'_>, parameters: &mut Vec<Parameter>) {
    let robot = &problem.dataset.robot;
    for (effect, bound) in problem.free_effects.iter().enumerate() {
        let on = match bound.cables.as_slice() {
            [cable] if bound.targeted => format!(" of {}", robot.cables[*cable].name),
            _ => String::new(),
        };
        for (parameter, description) in bound.effect.parameters().iter().enumerate() {
            parameters.push(Parameter {
                id: ParameterId::Effect { effect, parameter },
                name: format!("{} {}{on}", bound.effect.id(), description.name),
                unit: description.unit,
                // What is given and not estimated counts as known exactly.
                prior_sd: Some(if description.discrete {
                    0.0
                } else {
                    description.prior_sd
                }),
            });
        }
    }
}

impl Globals {
    /// Adds a step, one entry per parameter.
    pub(super) fn step(&mut self, problem: &Problem<'_>, parameters: &[Parameter], step: &[f64]) {
        let held = problem.held_effects.len();
        let mut home = Twist::zeros();
        for (parameter, delta) in parameters.iter().zip(step) {
            match parameter.id {
                ParameterId::EntryPoint { cable, axis } => self.entry_points[cable][axis] += delta,
                ParameterId::PlaneOffset => self.plane_offset_m += delta,
                ParameterId::Home(coordinate) => home[coordinate.index()] = *delta,
                ParameterId::HomeTension { cable } => self.home_tension_error_n[cable] += delta,
                ParameterId::Effect { effect, parameter } => {
                    self.effects[held + effect].values[parameter] += delta;
                }
            }
        }
        self.home = self.home.perturbed(&home);
    }

    /// Present deviation of each parameter from the centre of its prior.
    pub(super) fn deviations(&self, problem: &Problem<'_>, parameters: &[Parameter]) -> Vec<f64> {
        let nominal = Self::nominal(problem);
        let held = problem.held_effects.len();
        let home = self.home.difference(&nominal.home);
        let deviation = |parameter: &Parameter| match parameter.id {
            ParameterId::EntryPoint { cable, axis } => {
                self.entry_points[cable][axis] - nominal.entry_points[cable][axis]
            }
            ParameterId::PlaneOffset => self.plane_offset_m - nominal.plane_offset_m,
            ParameterId::Home(coordinate) => home[coordinate.index()],
            ParameterId::HomeTension { cable } => self.home_tension_error_n[cable],
            // A free effect starts where the request puts it; its prior is centred at no effect.
            ParameterId::Effect { effect, parameter } => {
                let bound = &self.effects[held + effect];
                bound.values[parameter] - bound.effect.parameters()[parameter].neutral
            }
        };
        parameters.iter().map(deviation).collect()
    }
}

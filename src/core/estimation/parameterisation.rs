//! Parameters of a problem with their priors, and the update of their values by a step.

use super::globals::Globals;
use super::parameter::{Parameter, ParameterId};
use super::problem::{Geometry, Problem};
use crate::effect::{BoundEffect, Search};
use crate::geometry::{Pose, Twist};

const AXES: [&str; 3] = ["x", "y", "z"];

impl Problem<'_> {
    /// The parameters that are estimated besides the poses, in the order of the columns of each design, covariance and
    /// information matrix. Parameters with a prior standard deviation of 0 are known and not among them.
    #[must_use]
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = Vec::new();
        if self.geometry == Geometry::Estimated {
            push_entry_points(self, &mut parameters);
            push_plane(self, &mut parameters);
            push_home(self, &mut parameters);
        }
        // The noise of these data is estimated even if the geometry is held: the home row enters every row of a cable.
        push_home_tensions(self, &mut parameters);
        if self.geometry == Geometry::Estimated {
            push_effects(self, &mut parameters);
            push_deviations(self, &mut parameters);
        }
        parameters.retain(|parameter| parameter.prior_sd != Some(0.0));
        parameters
    }
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
    let distances = &problem.dataset.measurements.laser_m;
    let measured = distances.iter().any(|d| d.is_finite());
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
    let covariance = home.covariance();
    for coordinate in robot.platform.freedom().coordinates() {
        let k = coordinate.index();
        parameters.push(Parameter {
            id: ParameterId::Home(*coordinate),
            name: format!("home pose, {}", coordinate.describe()),
            unit: if k < 3 { "m" } else { "rad" },
            prior_sd: Some(covariance[(k, k)].sqrt()),
        });
    }
}

fn push_home_tensions(problem: &Problem<'_>, parameters: &mut Vec<Parameter>) {
    let robot = &problem.dataset.robot;
    if robot.home.is_none() || problem.dataset.measurements.revolutions.is_empty() {
        return;
    }
    let forces = &problem.dataset.measurements.force_n;
    let is_read = |row| forces.row(row).iter().any(|f| f.is_finite());
    let is_assumed = problem.assumes_tensions();
    if !(problem.has_latent_tension() && (is_assumed || problem.home_row().is_some_and(is_read))) {
        return;
    }
    let what = if is_assumed {
        "tension above the assumed one"
    } else {
        "tension reading error"
    };
    for (cable, description) in robot.cables.iter().enumerate() {
        if let Some(sd) = problem.tension_sd_n(cable) {
            parameters.push(Parameter {
                id: ParameterId::HomeTension { cable },
                name: format!("{} {what} at home", description.name),
                unit: "N",
                prior_sd: Some(sd),
            });
        }
    }
}

/// Name of a parameter of an effect: `Winch scale of cable-3`.
fn effect_parameter_name(problem: &Problem<'_>, bound: &BoundEffect, parameter: usize) -> String {
    let robot = &problem.dataset.robot;
    let on = match bound.cables.as_slice() {
        [cable] if bound.targeted => format!(" of {}", robot.cables[*cable].name),
        _ => String::new(),
    };
    let all = bound.effect.parameters();
    // If an effect has only one parameter, its own name identifies it.
    let which = match all.len() {
        1 => String::new(),
        _ => format!(", {}", all[parameter].name.replace('_', " ")),
    };
    format!("{}{on}{which}", bound.effect.title())
}

fn push_effects(problem: &Problem<'_>, parameters: &mut Vec<Parameter>) {
    for (effect, bound) in problem.free_effects.iter().enumerate() {
        for (parameter, description) in bound.effect.parameters().iter().enumerate() {
            parameters.push(Parameter {
                id: ParameterId::Effect { effect, parameter },
                name: effect_parameter_name(problem, bound, parameter),
                unit: description.unit,
                // A discrete parameter is given and counts as known exactly.
                prior_sd: Some(if description.discrete {
                    0.0
                } else {
                    description.prior_sd_in(&problem.dataset.robot)
                }),
            });
        }
    }
}

fn push_deviations(problem: &Problem<'_>, parameters: &mut Vec<Parameter>) {
    for (deviation, of) in problem.deviations.iter().enumerate() {
        let all = of.bound.effect.parameters().iter().zip(&of.prior_sd);
        for (parameter, (description, sd)) in all.enumerate() {
            let name = effect_parameter_name(problem, &of.bound, parameter);
            // The deviation of a wave has two amplitudes, each with a phase of its own.
            let part = match of.bound.effect.search() {
                Search::Wave { phase, .. } if of.bound.values[phase] == 0.0 => ", sine",
                Search::Wave { .. } => ", cosine",
                _ => "",
            };
            parameters.push(Parameter {
                id: ParameterId::Deviation {
                    deviation,
                    parameter,
                },
                name: format!("deviation: {name}{part}"),
                unit: description.unit,
                prior_sd: Some(*sd),
            });
        }
    }
}

impl Globals {
    /// Nominal values of a problem.
    #[must_use]
    pub fn nominal(problem: &Problem<'_>) -> Self {
        let robot = &problem.dataset.robot;
        let entry = robot.cables.iter().map(|c| c.pulley.entry_point_m);
        let mut effects = problem.held_effects.clone();
        effects.extend(problem.free_effects.iter().cloned());
        let mut deviations = problem.held_deviations.clone();
        deviations.extend(problem.deviations.iter().map(|d| d.bound.clone()));
        Self {
            entry_points: entry.collect(),
            plane_offset_m: Self::nominal_plane_offset(problem),
            home: Self::nominal_home(problem),
            home_tension_error_n: vec![0.0; robot.cable_count()],
            effects,
            deviations,
        }
    }

    /// The home pose as described.
    pub(super) fn nominal_home(problem: &Problem<'_>) -> Pose {
        let home = problem.dataset.robot.home;
        home.map_or_else(Pose::identity, |home| home.pose())
    }

    fn nominal_plane_offset(problem: &Problem<'_>) -> f64 {
        let laser = problem.dataset.robot.laser;
        laser.map_or(0.0, |laser| laser.target_plane.offset_m)
    }

    /// Adds a step with one entry per parameter.
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
                ParameterId::Deviation {
                    deviation,
                    parameter,
                } => {
                    let held = problem.held_deviations.len();
                    self.deviations[held + deviation].values[parameter] += delta;
                }
            }
        }
        self.home = self.home.perturbed(&home);
    }

    /// Deviation of the present value of each parameter from the centre of its prior.
    pub(super) fn deviations(&self, problem: &Problem<'_>, parameters: &[Parameter]) -> Vec<f64> {
        let robot = &problem.dataset.robot;
        let held = problem.held_effects.len();
        let home = self.home.difference(&Self::nominal_home(problem));
        let deviation = |parameter: &Parameter| match parameter.id {
            ParameterId::EntryPoint { cable, axis } => {
                self.entry_points[cable][axis] - robot.cables[cable].pulley.entry_point_m[axis]
            }
            ParameterId::PlaneOffset => self.plane_offset_m - Self::nominal_plane_offset(problem),
            ParameterId::Home(coordinate) => home[coordinate.index()],
            ParameterId::HomeTension { cable } => self.home_tension_error_n[cable],
            // A free effect starts where the request puts it; its prior is centred at its neutral value.
            ParameterId::Effect { effect, parameter } => {
                let bound = &self.effects[held + effect];
                bound.values[parameter] - bound.effect.parameters()[parameter].neutral
            }
            ParameterId::Deviation {
                deviation,
                parameter,
            } => {
                let bound = &self.deviations[problem.held_deviations.len() + deviation];
                bound.values[parameter] - problem.deviations[deviation].bound.values[parameter]
            }
        };
        parameters.iter().map(deviation).collect()
    }
}

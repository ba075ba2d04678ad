//! The home row: unstrained lengths at home, and the readings taken there.

use super::evaluator::{Evaluator, Layout};
use super::globals::Globals;
use super::observation::ObservationKind as Kind;
use super::parameter::{Parameter, ParameterId};
use super::problem::Problem;

/// Linearisation of the home row at given values of the common parameters.
#[derive(Debug, Clone)]
pub(super) struct HomeRow {
    /// Unstrained length of each cable at home (m).
    pub lengths: Vec<f64>,
    /// Derivative of each length with respect to the parameters it depends on.
    pub length_gradients: Vec<Vec<(usize, f64)>>,
    /// Whitened residuals of the other home readings.
    pub residuals: Vec<f64>,
    /// Their derivatives with respect to all parameters, row by row.
    pub gradients: Vec<f64>,
    /// Loss of these rows.
    pub loss: f64,
    /// Number of measured rows among them.
    pub readings: f64,
}

/// Column of a parameter before the mapping of columns, if it has one.
pub(super) fn direct_column(
    id: &ParameterId,
    layout: &Layout,
    problem: &Problem<'_>,
) -> Option<usize> {
    match *id {
        ParameterId::EntryPoint { cable, axis } => Some(layout.cable_column(cable) + axis),
        ParameterId::PlaneOffset => Some(layout.plane_column()),
        ParameterId::Effect { effect, parameter } => layout.column_of_effect(effect, parameter),
        ParameterId::Deviation {
            deviation,
            parameter,
        } => layout.column_of_effect(problem.free_effects.len() + deviation, parameter),
        ParameterId::Home(_) | ParameterId::HomeTension { .. } => None,
    }
}

impl HomeRow {
    /// Evaluates the home row.
    pub fn evaluate(
        evaluator: &mut Evaluator<'_, f64>,
        problem: &Problem<'_>,
        globals: &Globals,
        parameters: &[Parameter],
        huber: Option<f64>,
    ) -> Self {
        evaluator.set_globals(globals, None);
        evaluator.set_single_pose(&globals.home);
        let layout = evaluator.layout.clone();
        let wrench_sd = std::array::from_fn(|k| evaluator.wrench_variance(k).sqrt());
        let equations = evaluator.equations_at(0);
        let lengths = equations.residual[..layout.cables].to_vec();
        let length_gradients = (0..layout.cables)
            .map(|cable| length_gradient(equations, &layout, problem, parameters, cable))
            .collect();
        let loss = match huber {
            Some(limit) => {
                let lengths: f64 = loss_of(&lengths, limit);
                equations.weigh_down_outliers(&layout, limit) - lengths
            }
            None => equations.residual[layout.cables..]
                .iter()
                .map(|r| r * r)
                .sum(),
        };
        let rows = layout.rows - layout.cables;
        let mut gradients = Vec::with_capacity(rows * parameters.len());
        for row in layout.cables..layout.rows {
            for parameter in parameters {
                let slope = row_derivative(
                    equations,
                    &layout,
                    problem,
                    &wrench_sd,
                    (row, &parameter.id),
                );
                gradients.push(slope);
            }
        }
        Self {
            lengths,
            length_gradients,
            residuals: equations.residual[layout.cables..].to_vec(),
            gradients,
            loss,
            readings: equations.present[layout.cables..].iter().sum(),
        }
    }

    /// Reference lengths of absolute readings: the run-in lengths from drum to pulley.
    pub fn absolute(problem: &Problem<'_>) -> Self {
        let cables = &problem.dataset.robot.cables;
        Self {
            lengths: cables.iter().map(|c| c.winch.length_to_pulley_m).collect(),
            length_gradients: vec![Vec::new(); cables.len()],
            residuals: Vec::new(),
            gradients: Vec::new(),
            loss: 0.0,
            readings: 0.0,
        }
    }
}

fn loss_of(residuals: &[f64], limit: f64) -> f64 {
    let loss = |r: &f64| {
        let size = r.abs();
        if size > limit {
            limit * (2.0 * size - limit)
        } else {
            size * size
        }
    };
    residuals.iter().map(loss).sum()
}

type HomeEquations = super::evaluator::Equations<f64>;

/// Nonzero derivatives of the unstrained length of a cable at home.
fn length_gradient(
    equations: &HomeEquations,
    layout: &Layout,
    problem: &Problem<'_>,
    parameters: &[Parameter],
    cable: usize,
) -> Vec<(usize, f64)> {
    let derivative = |id: &ParameterId| match *id {
        ParameterId::EntryPoint { cable: other, axis } if other == cable => {
            equations.length_by_cable[cable][axis]
        }
        ParameterId::Home(coordinate) => equations.by_pose[cable][coordinate.index()],
        ParameterId::HomeTension { cable: other } if other == cable => {
            equations.length_by_tension[cable]
        }
        ParameterId::Effect { .. } | ParameterId::Deviation { .. } => {
            direct_column(id, layout, problem).map_or(0.0, |column| {
                equations.by_effect_column(layout, cable, column)
            })
        }
        _ => 0.0,
    };
    parameters
        .iter()
        .enumerate()
        .map(|(k, parameter)| (k, derivative(&parameter.id)))
        .filter(|(_, value)| *value != 0.0)
        .collect()
}

/// Derivative of a row that is not a length row with respect to a parameter.
fn row_derivative(
    equations: &HomeEquations,
    layout: &Layout,
    problem: &Problem<'_>,
    wrench_sd: &[f64; 6],
    (row, id): (usize, &ParameterId),
) -> f64 {
    let column = direct_column(id, layout, problem);
    match (id, layout.kinds[row], column) {
        (ParameterId::Home(coordinate), ..) => equations.by_pose[row][coordinate.index()],
        (ParameterId::HomeTension { cable }, Kind::Equilibrium(axis), _) => {
            let k = axis.index();
            equations.structure[*cable][k] / wrench_sd[k] * equations.present[row]
        }
        (_, Kind::Equilibrium(axis), Some(column)) => {
            equations.equilibrium_by_column[column][axis.index()]
        }
        (ParameterId::Effect { .. } | ParameterId::Deviation { .. }, _, Some(column)) => {
            equations.by_effect_column(layout, row, column)
        }
        (ParameterId::PlaneOffset, Kind::Laser, _) => equations.laser_by_plane,
        (ParameterId::EntryPoint { cable, axis }, Kind::Swivel(own), _) if *cable == own => {
            equations.swivel_by_cable[own][*axis]
        }
        _ => 0.0,
    }
}

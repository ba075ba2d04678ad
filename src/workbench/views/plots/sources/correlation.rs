//! Correlations of the parameters of a fit, those of a pulley together.

use tautline_core::estimation::{Parameter, ParameterId};

use tautline_workflow::identification::Identification;
use tautline_workflow::plot::figure::{Axis, ColourScale, Figure, HeatMap};

/// Cable that a parameter belongs to.
fn cable_of(parameter: &Parameter) -> Option<usize> {
    match parameter.id {
        ParameterId::EntryPoint { cable, .. } | ParameterId::HomeTension { cable } => Some(cable),
        _ => None,
    }
}

fn group_of(parameter: &Parameter) -> String {
    match parameter.id {
        ParameterId::EntryPoint { cable, .. } => format!("{}", cable + 1),
        ParameterId::HomeTension { .. } => "tensions at home".into(),
        ParameterId::PlaneOffset => "laser".into(),
        ParameterId::Home(_) => "home pose".into(),
        ParameterId::Effect { .. } => "effects".into(),
    }
}

/// The correlations as a heat map; empty where the data do not determine them.
#[must_use]
pub fn figure(fit: &Identification) -> Figure {
    let Some(correlations) = fit.solution.correlations() else {
        return Figure::default();
    };
    let parameters = &fit.solution.parameters;
    let count = parameters.len();
    let edges: Vec<f64> = (0..=count).map(|k| k as f64).collect();
    // The first row is at the top, as in a matrix.
    let down: Vec<f64> = edges.iter().map(|edge| edge - count as f64).collect();
    let row_of = |k: usize| count - 1 - k;
    let mut values = Vec::with_capacity(count * count);
    for row in 0..count {
        values.extend((0..count).map(|column| correlations[(row_of(row), column)]));
    }
    let names: Vec<String> = parameters.iter().map(|p| p.name.clone()).collect();
    let mut groups: Vec<(f64, String)> = Vec::new();
    let mut start = 0;
    for end in 1..=count {
        if end == count || group_of(&parameters[end]) != group_of(&parameters[start]) {
            groups.push((0.5 * (start + end) as f64, group_of(&parameters[start])));
            start = end;
        }
    }
    // Upwards, as ticks are.
    let upwards = groups.iter().rev().map(|(at, name)| (-at, name.clone()));
    let mut y = Axis::new(
        "Correlations of the parameters (numbers: entry points of the pulleys)",
        "",
    );
    y.names = upwards.collect();
    Figure {
        x: Axis {
            names: groups,
            ..Axis::new("Parameter", "")
        },
        y,
        heat: Some(HeatMap {
            x: edges,
            y: down,
            values,
            shades: ColourScale::Diverging(1.0),
            axis: Axis::new("Correlation", ""),
            names: [names.clone(), names.into_iter().rev().collect()],
            cables: parameters.iter().rev().map(cable_of).collect(),
        }),
        ..Figure::default()
    }
}

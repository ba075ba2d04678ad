//! Correlations of the parameters of a fit, grouped by pulley.

use tautline_core::estimation::{Parameter, ParameterId};

use crate::views::plots::kind::{Content, PlotKind, no_options};
use tautline_workflow::identification::Identification;
use tautline_workflow::plot::figure::{Axis, ColourScale, Figure, HeatMap};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "correlation",
    title: "Correlation",
    missing: |open| match open.fit() {
        Some(fit) if fit.solution.covariance.is_some() => None,
        Some(_) => {
            Some("The readings do not determine all parameters, so there are no correlations.")
        }
        None => Some("Correlations of the parameters appear here after identification."),
    },
    options: no_options,
    content: Content::Figure(|source| Ok(figure(source.fit()?))),
};

/// Cable of a parameter.
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
        ParameterId::Deviation { .. } => "parts".into(),
    }
}

/// Correlations as a heat map; empty if the data do not determine them.
pub(crate) fn figure(fit: &Identification) -> Figure {
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
    // In ascending order, like ticks.
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use tautline_core::estimation::{Control, Method};
    use tautline_core::robot::presets;
    use tautline_core::simulation::{SimulationOptions, TensionRange, simulate};
    use tautline_workflow::identification::{IdentificationRequest, identify};
    use tautline_workflow::plot::draw::drawing;
    use tautline_workflow::plot::drawing::Shape;

    use super::*;
    use crate::theme;
    use crate::views::plots::screen::colours;

    /// Names without room are omitted, but not those of the cables.
    #[test]
    fn every_cable_has_its_number_on_both_axes_of_a_small_plot() {
        let robot = presets::find("mini").expect("a preset").robot;
        let options = SimulationOptions {
            tension: Some(TensionRange::of(&robot)),
            ..SimulationOptions::new(12, 3)
        };
        let run = simulate(&robot, &options).expect("measurements");
        let request = IdentificationRequest::new(run.dataset, Method::Joint, &[]);
        let request = request.expect("a request");
        let fit = identify(&request, &mut |_| Control::Continue).expect("a fit");
        let colours = colours(theme::palette(egui::Theme::Dark));
        let drawn = drawing("", &figure(&fit), [620.0, 230.0], 1.0, &colours);
        // Names along x are at the bottom, those along y on the left.
        let mut along: [BTreeSet<String>; 2] = Default::default();
        for shape in &drawn.shapes {
            if let Shape::Text { at, text, .. } = shape {
                let is_below = at[1] > 0.85 * drawn.size[1];
                along[usize::from(!is_below)].insert(text.clone());
            }
        }
        for cable in 1..=8 {
            for names in &along {
                assert!(names.contains(&cable.to_string()), "{cable} in {names:?}");
            }
        }
    }
}

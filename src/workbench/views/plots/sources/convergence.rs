//! Chi-square after each step of an identification.

use crate::views::plots::kind::{Content, PlotKind, no_options};
use tautline_workflow::identification::Identification;
use tautline_workflow::plot::figure::{Axis, Curve, Figure, Ink, Marker, Point, Series};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "convergence",
    title: "Convergence",
    missing: |open| {
        let has_steps = open.fit().is_some_and(|fit| !fit.steps.is_empty());
        (!has_steps).then_some("The convergence of the identification appears here.")
    },
    options: no_options,
    content: Content::Figure(|source| Ok(figure(source.fit()?))),
};

/// The way of a fit to its solution.
#[must_use]
pub fn figure(fit: &Identification) -> Figure {
    let steps = fit.steps.iter().enumerate();
    let places: Vec<[f64; 2]> = steps
        .filter(|(_, loss)| **loss > 0.0)
        .map(|(k, loss)| [(k + 1) as f64, loss.log10()])
        .collect();
    let points = places.iter().map(|[x, y]| Point::new(*x, *y)).collect();
    let expected = fit.solution.degrees_of_freedom;
    let last = places.last().map_or(1.0, |place| place[0]);
    let mut curves = vec![Curve {
        name: String::new(),
        ink: Ink::Accent,
        dashed: false,
        points: places,
    }];
    if expected > 0.0 {
        curves.push(Curve {
            name: "expected: degrees of freedom".into(),
            ink: Ink::Good,
            dashed: true,
            points: vec![[1.0, expected.log10()], [last, expected.log10()]],
        });
    }
    Figure {
        x: Axis::whole("Step"),
        y: Axis {
            is_logarithmic: true,
            ..Axis::new("Chi-square", "")
        },
        series: vec![Series::new(
            "chi-square",
            Ink::Accent,
            Marker::Circle,
            points,
        )],
        curves,
        ..Figure::default()
    }
}

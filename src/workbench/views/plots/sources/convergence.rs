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

/// Chi-square over the steps of a fit.
pub(crate) fn figure(fit: &Identification) -> Figure {
    let steps = fit.steps.iter().enumerate();
    let places: Vec<[f64; 2]> = steps
        .filter(|(_, loss)| **loss > 0.0)
        .map(|(k, loss)| [(k + 1) as f64, loss.log10()])
        .collect();
    let points = places.iter().map(|[x, y]| Point::new(*x, *y)).collect();
    let expected = fit.solution.degrees_of_freedom;
    let last = places.last().map_or(1.0, |place| place[0]);
    let mut curves = vec![Curve::new("", Ink::Accent, places)];
    if expected > 0.0 {
        let ends = [1.0, last].map(|x| [x, expected.log10()]);
        curves.push(Curve {
            dashed: true,
            ..Curve::new("expected: degrees of freedom", Ink::Good, ends.into())
        });
    }
    Figure {
        x: Axis::whole("Step"),
        y: Axis::logarithmic("Chi-square", ""),
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

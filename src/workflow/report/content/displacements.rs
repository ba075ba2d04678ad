//! Displacements of the pulleys from the drawing, as drawings.

use tautline_session::DecisionRule;

use crate::identification::{Identification, PulleyInspection};
use crate::report::deviations::{Deviation, coordinates, views};
use crate::report::document::{Block, Section};
use crate::report::tolerance::Conformity;
use crate::wording::units::significant;

/// The displacement of each pulley; those outside the tolerance are highlighted.
pub fn deviations(fit: &Identification, judged: Option<(DecisionRule, f64)>) -> Vec<Deviation> {
    let cables = 0..fit.dataset.robot.cable_count();
    let pulleys = cables.filter_map(|k| PulleyInspection::of(&fit.dataset.robot, Some(fit), k));
    let deviation = |pulley: PulleyInspection| {
        let mut deviation = Deviation {
            from: pulley.nominal_m,
            by: pulley.displacement_m()?,
            covariance: pulley.identified?.covariance,
            is_marked: false,
        };
        deviation.is_marked = judged.is_some_and(|(rule, tolerance_m)| {
            deviation.conformity(rule, tolerance_m) == Conformity::Outside
        });
        Some(deviation)
    };
    pulleys.filter_map(deviation).collect()
}

/// Three views, and the coordinates with their intervals.
pub fn drawn(fit: &Identification, judged: Option<(DecisionRule, f64)>, section: &mut Section) {
    let pulleys = deviations(fit, judged);
    let tolerance_m = judged.map(|(_, tolerance_m)| tolerance_m);
    draw(&pulleys, "on the drawing", tolerance_m, section);
}

/// The same for any displacements; `before` states the positions that they start from.
pub fn draw(pulleys: &[Deviation], before: &str, tolerance_m: Option<f64>, section: &mut Section) {
    let (views, magnification) = views(pulleys);
    section.heading("Displacements of the pulleys");
    let scale = match magnification > 1.0 {
        true => format!("{} times", significant(magnification, 2)),
        false => "not".to_owned(),
    };
    section.note(format!("Rings: where the pulleys are {before}. Arrows: displacements, {scale} magnified. Numbers: cables."));
    section.blocks.push(Block::Plots(views));
    section
        .blocks
        .push(Block::Plots(vec![coordinates(pulleys, tolerance_m)]));
}

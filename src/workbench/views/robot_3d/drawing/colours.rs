//! Colours of cables and displacements.

use egui::Color32;
use tautline_session::Stage;

use super::options::{ArrowColour, CableColour};
use crate::theme::Palette;
use crate::views::robot_3d::scene::{CableView, Displacement, Scene, Significance};
use tautline_workflow::report::tolerance::Conformity;

#[must_use]
pub fn cable_colour(
    cable: &CableView,
    index: usize,
    by: CableColour,
    range: Option<[f64; 2]>,
    palette: &Palette,
) -> Color32 {
    match by {
        CableColour::Own => palette.cable(index),
        CableColour::Tension => match (cable.tension_n, range) {
            (Some(tension), Some([low, high])) => {
                let span = (high - low).max(f64::MIN_POSITIVE);
                tension_colour(((tension - low) / span) as f32, palette)
            }
            _ => palette.ghost,
        },
        CableColour::Residual => cable
            .residual
            .map_or(palette.ghost, |r| palette.residual(r.value())),
    }
}

/// Colour at a share of the range of tensions.
#[must_use]
pub fn tension_colour(share: f32, palette: &Palette) -> Color32 {
    palette
        .ghost
        .lerp_to_gamma(palette.warning, share.clamp(0.0, 1.0))
}

/// Smallest and largest tension (N), if any is known.
#[must_use]
pub fn tension_range(scene: &Scene) -> Option<[f64; 2]> {
    let tensions = scene.cables.iter().filter_map(|cable| cable.tension_n);
    let (low, high) = tensions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
        (low.min(t), high.max(t))
    });
    (low <= high).then_some([low, high])
}

#[must_use]
pub fn significance_colour(significance: Significance, palette: &Palette) -> Color32 {
    match significance {
        Significance::Unknown => palette.ghost,
        Significance::Noise => palette.muted,
        Significance::Unclear => palette.accent,
        Significance::Clear => palette.warning,
    }
}

/// Colour at a share of the longest displacement.
#[must_use]
pub fn length_colour(share: f32, palette: &Palette) -> Color32 {
    palette
        .muted
        .lerp_to_gamma(palette.warning, share.clamp(0.0, 1.0))
}

/// Length of the longest displacement (m), if there is one.
#[must_use]
pub fn longest_m(scene: &Scene) -> Option<f64> {
    let moved = scene.cables.iter().filter_map(|cable| cable.moved.as_ref());
    let longest = moved.map(|moved| moved.by.norm()).fold(0.0, f64::max);
    (longest > 0.0).then_some(longest)
}

/// Colour of a conformity with a tolerance.
#[must_use]
pub fn conformity_colour(conformity: Conformity, palette: &Palette) -> Color32 {
    match conformity {
        Conformity::Within => palette.good,
        Conformity::Undecided => palette.warning,
        Conformity::Outside => palette.bad,
    }
}

/// Colour of a displacement in a scene.
#[must_use]
pub fn arrow_colour(
    moved: &Displacement,
    by: ArrowColour,
    scene: &Scene,
    palette: &Palette,
) -> Color32 {
    match by {
        ArrowColour::Tolerance => {
            let tolerance_m = scene.tolerance_m.unwrap_or(f64::INFINITY);
            let conformity = moved.conformity(scene.decision_rule, tolerance_m);
            conformity_colour(conformity, palette)
        }
        ArrowColour::Significance => significance_colour(moved.significance(), palette),
        ArrowColour::Length => {
            let share = moved.by.norm() / longest_m(scene).unwrap_or(1.0);
            length_colour(share as f32, palette)
        }
    }
}

/// Colour of errors of position before or after the adjustment.
#[must_use]
pub fn error_colour(stage: Stage, palette: &Palette) -> Color32 {
    match stage {
        Stage::Before => palette.warning,
        Stage::After => palette.good,
    }
}

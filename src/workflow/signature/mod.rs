//! The image of an effect in the residuals: of every effect for a robot, as a gallery for comparison, and of one hypothesis in
//! measured readings.
//!
//! An identification moves geometry and poses so that residuals become small, and so hides a part of every effect. The images
//! show the remaining part: the residuals of an identification that does not know the effect.

mod gallery;
mod image;
mod report;
mod stage;
mod trial;

use tautline_core::effect::{BoundEffect, Hypothesis, HypothesisNotAdded, Search};
use tautline_core::robot::Robot;

pub use gallery::{Gallery, Signature};
pub use image::Image;
pub use report::{gallery_document, write_gallery};
pub use trial::{Placement, Trial, try_hypothesis};

use crate::wording::list;
use crate::wording::units::{quantity, unit_of};

/// Makes a hypothesis known to a robot, in place of one with the same identifier.
///
/// # Errors
/// If the robot knows too many.
pub fn replace_hypothesis(
    robot: &mut Robot,
    hypothesis: &Hypothesis,
) -> Result<(), HypothesisNotAdded> {
    let is_other = |text: &String| {
        let known = Hypothesis::parse(text);
        known.is_ok_and(|known| known.id() != hypothesis.id())
    };
    robot.hypotheses.retain(is_other);
    robot.add_hypothesis(hypothesis)
}

/// The size of an effect in words: its parameters as distances from the neutral values, of a wave the amplitude alone.
#[must_use]
pub fn size_in_words(bound: &BoundEffect) -> String {
    let parameters = bound.effect.parameters().iter().zip(&bound.values);
    let sized = parameters.filter(|(parameter, _)| !parameter.discrete);
    let sizes = sized.map(|(parameter, value)| {
        let unit = unit_of(parameter.name, parameter.unit);
        quantity(value - parameter.neutral, unit)
    });
    let sizes: Vec<String> = sizes.collect();
    match bound.effect.search() {
        // The phase of a wave is not a size.
        Search::Wave { .. } => sizes.first().cloned().unwrap_or_default(),
        Search::Exchange => "swapped at all poses".to_owned(),
        _ => list(&sizes),
    }
}

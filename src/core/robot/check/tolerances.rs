//! Tolerances of the parts.

use super::super::part_tolerances::OTHER_CABLES;
use super::super::{PartTolerances, Robot, Tolerance};
use super::Checked;
use super::field::Object;
use crate::effect::{Effect, Scope, every_effect, find};

/// Checks the stated tolerances of a robot.
pub(super) fn check(robot: &Robot, object: &Object) -> Checked {
    let Some(PartTolerances::Stated(stated)) = &robot.tolerances else {
        return Ok(());
    };
    object.not_negative("factor", stated.factor)?;
    for (id, tolerance) in &stated.effects {
        let Some(effect) = find(id) else {
            let message = format!(
                "found no effect of this name, expected one of the catalogue such as \"{}\"",
                nearest_effect(id)
            );
            return object.fail(id, message);
        };
        if !effect.has_tolerance() {
            let message = "found an effect that sound parts do not have, expected none or one that lasts, such as \"winch_scale\"";
            return object.fail(id, message);
        }
        match tolerance {
            Tolerance::Same(sd) => object.not_negative(id, *sd)?,
            Tolerance::ByCable(_) if effect.scope() == Scope::Robot => {
                let message =
                    "found an object, expected one number: the effect concerns the whole robot";
                return object.fail(id, message);
            }
            Tolerance::ByCable(by_cable) => {
                let own = object.child(id);
                for (cable, sd) in by_cable {
                    if cable != OTHER_CABLES && robot.cable_index(cable).is_none() {
                        let message =
                            format!("found {cable:?}, expected the name of a cable or \"default\"");
                        return object.fail(id, message);
                    }
                    own.not_negative(cable, *sd)?;
                }
            }
        }
    }
    Ok(())
}

/// The effect with a tolerance whose identifier is closest to a text.
fn nearest_effect(text: &str) -> &'static str {
    let with_tolerance = every_effect().filter(|effect| effect.has_tolerance());
    let likeness = |effect: &Effect| strsim::jaro_winkler(text, effect.id());
    let nearest = with_tolerance.max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    nearest.map_or("winch_scale", |effect| effect.id())
}

//! Relations between causes, whatever their sizes: whether two are the same, and whether one accounts for another.

use super::calibration::DISTINCT_PERIODS;
use super::report::Cause;
use crate::effect::{BoundEffect, Effect, Search};

/// Index of the parameter that places an effect: the pose of an event, the row of a distance, or the period of a wave.
pub(super) fn place_parameter(effect: &Effect) -> Option<usize> {
    match effect.search() {
        Search::FromPose(k)
        | Search::AtPose(k)
        | Search::AtDistance(k)
        | Search::Wave {
            period: Some(k), ..
        } => Some(k),
        _ => None,
    }
}

/// Label of the pose of an event, row of a distance, or period of a wave (m); NaN for other effects.
pub(super) fn place_of(bound: &BoundEffect) -> f64 {
    place_parameter(bound.effect).map_or(f64::NAN, |k| bound.values[k])
}

/// Whether two places of an effect are the same: for waves about the same period, for steps poses that are at most `most_steps`
/// apart. Effects without a place always agree.
pub(super) fn is_same_place(effect: &Effect, one: f64, other: f64, most_steps: f64) -> bool {
    match effect.search() {
        Search::Wave {
            period: Some(_), ..
        } => (one / other).max(other / one) < DISTINCT_PERIODS,
        Search::FromPose(_) => (one - other).abs() <= most_steps,
        Search::AtPose(_) | Search::AtDistance(_) => one == other,
        _ => true,
    }
}

/// Whether two effects are the same, taking the scale of one winch and the scale of all winches as the same.
pub(super) fn is_same_kind(one: &Effect, other: &Effect) -> bool {
    let scale = |effect: &Effect| matches!(effect.id(), "winch_scale" | "winch_scale_common");
    std::ptr::eq(one, other) || scale(one) && scale(other)
}

/// Whether two causes have the same effect and targets, ignoring the pose of an event or the period of a wave.
pub(super) fn is_same_effect_and_targets(one: &Cause, other: &Cause) -> bool {
    let mut pairs = one.instances.iter().zip(&other.instances);
    one.instances.len() == other.instances.len() && pairs.all(|(a, b)| a.has_target_of(b))
}

/// Whether two causes with the same effect have places at most `most_steps` apart.
fn is_near(one: &Cause, other: &Cause, most_steps: f64) -> bool {
    let [a, b] = [one, other].map(|cause| place_of(&cause.instances[0]));
    is_same_place(one.effect(), a, b, most_steps)
}

/// Whether two causes have the same effect and targets, events the same pose, and waves about the same period.
pub(super) fn is_same_cause(one: &Cause, other: &Cause) -> bool {
    is_same_effect_and_targets(one, other) && is_near(one, other, 0.0)
}

/// Whether two sets consist of the same causes, in any order.
pub(super) fn is_same_set(one: &[Cause], other: &[Cause]) -> bool {
    let contains = |causes: &[Cause], cause: &Cause| causes.iter().any(|c| is_same_cause(c, cause));
    one.len() == other.len() && one.iter().all(|cause| contains(other, cause))
}

/// Whether one cause covers another: on the same cables or more, with an event at the same reading, a step at most one
/// pose away or a wave of about the same period.
pub(super) fn covers(one: &Cause, other: &Cause) -> bool {
    let whole = |one: &Cause, other: &Cause| {
        one.cables().is_empty() && other.instances.len() == one.instances[0].cables.len()
    };
    // A value for all cables covers a value for each, and vice versa.
    if is_same_kind(one.effect(), other.effect()) && (whole(one, other) || whole(other, one)) {
        return true;
    }
    let (a, b) = (one.cables(), other.cables());
    let more = a.len() > 1 && !b.is_empty() && b.iter().all(|cable| a.contains(cable));
    std::ptr::eq(one.effect(), other.effect()) && is_near(one, other, 1.0) && (a == b || more)
}

/// Whether a cause is the effect of a family on just one of its cables.
pub(super) fn is_family_member(cause: &Cause, family: &Cause) -> bool {
    let cables = family.cables();
    family.instances.len() > 1
        && std::ptr::eq(cause.effect(), family.effect())
        && cause.effect().pose_parameter().is_none()
        && cause.cables().len() == 1
        && cause.cables().iter().all(|cable| cables.contains(cable))
}

/// Whether a set accounts for a cause, either by one of its causes or by several of the same effect on single cables.
pub(super) fn is_covered_by(set: &[Cause], cause: &Cause) -> bool {
    let is_same = |one: &&Cause| {
        std::ptr::eq(one.effect(), cause.effect()) && cause.effect().pose_parameter().is_none()
    };
    let together: Vec<usize> = set.iter().filter(is_same).flat_map(Cause::cables).collect();
    let cables = cause.cables();
    // A common value plus a deviation of one cable is not the same as a value for each cable.
    let is_more = |one: &Cause| is_family_member(one, cause) && !covers(one, cause);
    let has_more = set.iter().any(is_more);
    let is_each = |one: &Cause| !has_more || std::ptr::eq(one.effect(), cause.effect());
    set.iter().any(|one| covers(one, cause) && is_each(one))
        || cables.len() > 1 && cables.iter().all(|cable| together.contains(cable))
}

//! Merges causes of the same effect on several cables into one with fewer parameters.

use super::fit::Fit;
use super::report::Cause;
use crate::effect::{BoundEffect, Search};

/// Replaces causes of the same effect on several single cables by one with a common value; `None` if there are none.
pub(super) fn merge_common_values(fit: &Fit<'_>) -> Option<Vec<Cause>> {
    if let Some(causes) = merge_part_of_family(fit) {
        return Some(causes);
    }
    let is_single = |cause: &Cause| match cause.instances.as_slice() {
        [bound] => {
            bound.targeted && bound.cables.len() == 1 && bound.effect.search() == Search::Direct
        }
        _ => false,
    };
    let singles = || fit.causes.iter().filter(|c| is_single(c));
    let same = |one: &Cause, other: &Cause| std::ptr::eq(one.effect(), other.effect());
    let several = |cause: &&Cause| singles().filter(|c| same(c, cause)).count() > 1;
    let effect = singles().find(several)?;
    let members: Vec<&Cause> = singles().filter(|c| same(c, effect)).collect();
    let mut cables: Vec<usize> = members.iter().flat_map(|c| c.cables()).collect();
    cables.sort_unstable();
    let bound = &members[0].instances[0];
    let mean = |k: usize| {
        let values = members.iter().map(|c| c.instances[0].values[k]);
        values.sum::<f64>() / members.len() as f64
    };
    let common = BoundEffect {
        effect: bound.effect,
        cables,
        targeted: true,
        values: (0..bound.values.len()).map(mean).collect(),
    };
    let others = fit
        .causes
        .iter()
        .filter(|c| !(is_single(c) && same(c, effect)));
    let common = Cause {
        instances: vec![common],
    };
    Some(others.cloned().chain([common]).collect())
}

/// Replaces a family in which some cables have about the same value and the others almost none by one cause with a
/// common value on those cables.
fn merge_part_of_family(fit: &Fit<'_>) -> Option<Vec<Cause>> {
    for (place, cause) in fit.causes.iter().enumerate() {
        let first = &cause.instances[0];
        if cause.instances.len() < 2 || first.values.len() != 1 {
            continue;
        }
        let neutral = first.effect.parameters()[0].neutral;
        let value = |bound: &BoundEffect| bound.values[0] - neutral;
        let values = || cause.instances.iter().map(value);
        let largest = values().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        let shares = |bound: &&BoundEffect| value(bound) / largest > 0.5;
        let some: Vec<&BoundEffect> = cause.instances.iter().filter(shares).collect();
        if some.len() < 2 || some.len() == cause.instances.len() {
            continue;
        }
        let mean = some.iter().map(|b| b.values[0]).sum::<f64>() / some.len() as f64;
        let common = BoundEffect {
            effect: first.effect,
            cables: some.iter().flat_map(|b| b.cables.clone()).collect(),
            targeted: true,
            values: vec![mean],
        };
        let mut causes = fit.causes.clone();
        causes[place] = Cause {
            instances: vec![common],
        };
        return Some(causes);
    }
    None
}

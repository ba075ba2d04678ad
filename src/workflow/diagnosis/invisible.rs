//! Effects that the data cannot reveal, in groups.

use tautline_core::diagnosis::Invisible;

use super::Diagnosed;
use crate::wording::units::{range, unit_of};

/// Parameters of one effect, in one unit, that the data cannot reveal.
struct Group<'a> {
    effect: &'static str,
    unit: &'static str,
    is_targeted: bool,
    members: Vec<&'a Invisible>,
}

/// Effects that the data cannot reveal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Undetectable {
    /// Effects with their smallest detectable size.
    pub sized: Vec<String>,
    /// Effects that are not detectable at any size.
    pub never: Vec<&'static str>,
}

/// Heading of the effects that have a detectable size.
pub const HIDDEN: &str = "These poses cannot reveal the following faults at their typical sizes. Smallest detectable size:";

impl Diagnosed {
    /// Effects that the data cannot reveal.
    #[must_use]
    pub fn hidden_effects(&self) -> Undetectable {
        let groups = groups(&self.diagnosis.invisible);
        let has_size = |group: &&Group<'_>| group.sizes().next().is_some();
        let (sized, never): (Vec<_>, Vec<_>) = groups.iter().partition(has_size);
        let mut never: Vec<_> = never.iter().map(|group| group.title()).collect();
        never.dedup();
        Undetectable {
            sized: sized.iter().map(|group| self.line(group)).collect(),
            never,
        }
    }

    /// The same as lines of text; empty if there are none.
    #[must_use]
    pub fn invisible_lines(&self) -> Vec<String> {
        let hidden = self.hidden_effects();
        if hidden.sized.is_empty() && hidden.never.is_empty() {
            return Vec::new();
        }
        let mut lines = vec![HIDDEN.to_owned()];
        lines.extend(hidden.sized.iter().map(|line| format!("   {line}")));
        if !hidden.never.is_empty() {
            lines.push(format!(
                "   Not detectable at any size: {}",
                hidden.never.join(", ")
            ));
        }
        lines
    }

    fn line(&self, group: &Group<'_>) -> String {
        let least = group.sizes().fold(f64::INFINITY, f64::min);
        let most = group.sizes().fold(f64::NEG_INFINITY, f64::max);
        let never = match group.members.len() - group.sizes().count() {
            0 => String::new(),
            some => format!(" (not detectable on {some} of {})", group.members.len()),
        };
        let sizes = range([least, most], group.unit);
        format!("{}{}: {sizes}{never}", group.title(), self.cables_of(group))
    }

    /// The cables of a group in brackets, after a space.
    fn cables_of(&self, group: &Group<'_>) -> String {
        let mut cables: Vec<String> = Vec::new();
        for cable in group.members.iter().flat_map(|m| self.targets(&m.cause)) {
            if !cables.contains(&cable) {
                cables.push(cable);
            }
        }
        let words = self.cables(&group.members[0].cause, &cables);
        words.map_or_else(String::new, |words| format!(" ({words})"))
    }
}

impl Group<'_> {
    fn title(&self) -> &'static str {
        self.members[0].cause.effect().title()
    }

    /// Smallest detectable sizes.
    fn sizes(&self) -> impl Iterator<Item = f64> {
        let sizes = self.members.iter().filter_map(|m| m.smallest_visible);
        sizes.map(f64::abs).filter(|size| size.is_finite())
    }
}

fn groups(invisible: &[Invisible]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for one in invisible {
        let effect = one.cause.effect().id();
        let (parameter, unit) = one.parameter;
        let unit = unit_of(parameter, unit);
        let is_targeted = !one.cause.cables().is_empty();
        let is_same = |group: &&mut Group<'_>| {
            group.effect == effect && group.unit == unit && group.is_targeted == is_targeted
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => group.members.push(one),
            None => groups.push(Group {
                effect,
                unit,
                is_targeted,
                members: vec![one],
            }),
        }
    }
    groups
}

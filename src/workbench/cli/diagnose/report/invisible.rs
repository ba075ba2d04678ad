//! What the data cannot show, condensed.

use tautline_core::diagnosis::Invisible;

use super::Diagnosed;
use super::words::count;
use crate::cli::units::{range, unit_of};

/// All that is invisible of one effect, in one unit.
struct Group<'a> {
    title: &'static str,
    effect: &'static str,
    unit: &'static str,
    members: Vec<&'a Invisible>,
}

impl Diagnosed<'_> {
    /// One line per effect, and one for those that no size would show.
    pub fn invisible_lines(&self) -> Vec<String> {
        let groups = groups(&self.diagnosis.invisible);
        let (sized, never): (Vec<_>, Vec<_>) = groups
            .iter()
            .partition(|group| group.sizes().next().is_some());
        let mut lines = Vec::new();
        if !groups.is_empty() {
            lines.push(
                "These poses do not show the following faults at their usual sizes. Smallest size that would show:"
                    .to_owned(),
            );
        }
        lines.extend(sized.iter().map(|group| self.line(group)));
        if !never.is_empty() {
            let mut titles: Vec<_> = never.iter().map(|group| group.title).collect();
            titles.dedup();
            lines.push(format!("   None would show: {}", titles.join(", ")));
        }
        lines
    }

    fn line(&self, group: &Group<'_>) -> String {
        let least = group.sizes().fold(f64::INFINITY, f64::min);
        let most = group.sizes().fold(f64::NEG_INFINITY, f64::max);
        let mut cables: Vec<String> = Vec::new();
        for member in &group.members {
            for name in self.targets(&member.cause) {
                if !cables.contains(&name) {
                    cables.push(name);
                }
            }
        }
        let on = match cables.len() {
            0 => String::new(),
            1 => format!(" ({})", cables[0]),
            all if all == self.robot().cable_count() => " (every cable)".to_owned(),
            several => format!(" ({})", count(several, "cable")),
        };
        let hidden = group.members.len() - group.sizes().count();
        let never = match hidden {
            0 => String::new(),
            some => format!(" ({some} of {} at no size)", group.members.len()),
        };
        let sizes = range([least, most], group.unit);
        format!("   {}{on}: {sizes}{never}", group.title)
    }
}

impl Group<'_> {
    /// Smallest visible sizes.
    fn sizes(&self) -> impl Iterator<Item = f64> {
        let sizes = self.members.iter().filter_map(|m| m.smallest_visible);
        sizes.map(f64::abs).filter(|size| size.is_finite())
    }
}

fn groups(invisible: &[Invisible]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for one in invisible {
        let effect = one.cause.effect();
        let (parameter, unit) = one.parameter;
        let unit = unit_of(parameter, unit);
        let is_same = |group: &&mut Group<'_>| group.effect == effect.id() && group.unit == unit;
        match groups.iter_mut().find(is_same) {
            Some(group) => group.members.push(one),
            None => groups.push(Group {
                title: effect.title(),
                effect: effect.id(),
                unit,
                members: vec![one],
            }),
        }
    }
    groups
}
